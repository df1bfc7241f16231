//! Which parameters a fit has, and what it says about recordings of different human models.

use tomcom_core::mind::fitting::HumanModelParameter;
use tomcom_core::mind::model::HumanModel;
use tomcom_core::mind::model::{PAPER_2021, PLAIN};
use tomcom_session::log::rule;
use tomcom_study::analysis::fitting::{FitSettings, choose, describe};
use tomcom_study::fit::{FitTrials, fit};
use tomcom_study::gathered::GatheredRecordings;

use crate::support::*;

#[test]
fn a_fit_has_the_parameters_that_its_model_uses() {
    let chosen = |model: &HumanModel| choose(&[], model).expect("parameters");
    assert_eq!(chosen(&PLAIN), HumanModelParameter::USUAL);
    assert_eq!(chosen(&PAPER_2021), [HumanModelParameter::Tau, HumanModelParameter::RadiusDeg]);
    let refused = [
        (HumanModelParameter::ReadingRateHz, "reading_rate_hz is not used with observation = \"sample\""),
        (HumanModelParameter::Capture, "capture is not used with marginalised = false"),
        (HumanModelParameter::RecipeHalfLifeS, "recipe_half_life_s = 1e18 is outside of 5 to 20000"),
        (HumanModelParameter::Lapse, "lapse = 1e-6 is outside of 0.001 to 0.5"),
        (HumanModelParameter::Foresight, "foresight = 1.0000 is outside of 0.001 to 0.999"),
    ];
    for (parameter, why) in refused {
        let (found, _) = choose(&[HumanModelParameter::Tau, parameter], &PAPER_2021).expect_err(why);
        assert!(found.starts_with(why), "{found}");
        assert_eq!(choose(&[parameter, parameter], &PLAIN), Ok(vec![parameter]));
    }
}

#[test]
fn a_fit_says_which_recordings_were_made_with_which_model() {
    let root = empty_folder("fit");
    let mut paths = Vec::new();
    for (name, model, tau) in
        [("a", PAPER_2021, 4.0), ("b", PLAIN, 4.0), ("c", PLAIN, 3.0), ("d", PAPER_2021, 4.0), ("e", PLAIN, 5.0)]
    {
        let mut files = session_file("default");
        files.spec.robot.arm = ArmKind::Timed;
        files.spec.trial.presses = 6;
        files.spec.human = model;
        files.spec.human.decision.tau = tau;
        simulate_into(files, 1, &root.join(name));
        paths.push(root.join(name));
    }
    rule(&root.join("e/seed1-S001"), true, "the tracker slipped").expect("excluded");
    let trials = FitTrials::read(&GatheredRecordings::find(&paths).expect("recordings"), false).expect("trials");
    let plan = FitSettings { parameters: choose(&[], &trials.model).expect("parameters"), start: None, most_tries: 1 };
    let told = describe(&fit(&trials, &plan, || {}));
    println!("{told}");
    assert!(told.contains("before: the parameters of the first recording (paper-2021)"), "{told}");
    let line = |begin: &str| told.lines().find_map(|line| line.strip_prefix(begin)).unwrap_or_else(|| panic!("{told}"));
    assert!(line("made with plain: ").ends_with("fit/b/seed1-S001"), "{told}");
    assert!(line("made with plain with decision.tau = 3.0, not 4.0: ").ends_with("fit/c/seed1-S001"), "{told}");
    assert!(line("left out of the analysis: ").ends_with("fit/e/seed1-S001: excluded: the tracker slipped"), "{told}");
    assert!(told.starts_with("3 recordings, ") && !told.contains("fit/d"), "{told}");
    assert_eq!(line("not fitted: reading_rate_hz"), " is not used with observation = \"sample\"");
}
