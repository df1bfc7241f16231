//! Measures of whole sessions: what is known of the beliefs behind presses, and how a wizard's signals are judged.

use tomcom_core::kitchen::{WeightedWorlds, World};
use tomcom_core::measures::detection::{BeliefsBeforePress, EstimateBeforePress, TrialBeliefs};
use tomcom_core::measures::matching::WINDOW;
use tomcom_core::mind::belief::Belief;
use tomcom_core::mind::choice::ChoiceParameters;
use tomcom_core::mind::{ChoiceModel, RecordedBelief};
use tomcom_people::wizard::WizardKind;
use tomcom_session::follower::SessionFollower;
use tomcom_session::headless;
use tomcom_session::watcher::{SenderComparisonFollower, SenderComparisonSettings};
use tomcom_session::wizard_log::{self, WizardSummary};
use tomcom_study::analysis::comparison_summary::RecordingSenderComparison;
use tomcom_study::analysis::likelihood::PressLogLikelihood;
use tomcom_study::analysis::recording_summary::ExclusionStatus;
use tomcom_study::analysis::trial_summary::{FalseBeliefErrorSummary, TrialSummary};

use crate::support::*;

fn settings(participant: &str) -> SessionSpec {
    let text = format!(
        "layout = \"\"\nseed = 5\n[trial]\ncondition = \"none\"\n[assistant]\nshadow = \"off\"\n[participant]\n{participant}\n"
    );
    toml::from_str(&text).expect("settings of a session")
}

#[test]
fn a_belief_can_be_told_from_its_witness() {
    for layout in ["sushi", "burger"] {
        let kitchen = kitchen(layout);
        let mut engine = SessionEngine::new(kitchen.clone(), settings(""), 0, CostToGo::new(kitchen.clone()));
        let mut witnesses: Vec<RecordedBelief> = Vec::new();
        let mut told = Vec::new();
        let mut replay =
            SessionFollower::new(Session::new(kitchen.clone(), settings(""), 0), CostToGo::new(kitchen.clone()));
        headless::run(&mut engine, |stamped| {
            replay.apply(stamped).expect("what was recorded can be replayed");
            if let Event::ParticipantBelieves(witness) = &stamped.event {
                let state = replay.session.state;
                told.push((state, Belief::of_witness(&kitchen, state, witness).expect("a belief of this kitchen")));
                witnesses.push(witness.clone());
            }
        });
        assert!(told.len() > 100);
        for ((state, belief), witness) in told.iter().zip(&witnesses) {
            for (index, held) in witness.aspects.iter().enumerate() {
                let (id, labels) = (AspectId(index as u8), &kitchen.aspects[index].labels);
                let values = belief.distribution(id);
                assert!((values.iter().sum::<f64>() - 1.0).abs() < 1e-9);
                assert!((belief.p_truth(&kitchen, *state, id) - held.p_truth).abs() < 1e-3, "{held:?}");
                let most = (0..values.len()).fold(0, |best, one| if values[one] > values[best] { one } else { best });
                assert_eq!(labels[most], held.believes);
            }
        }
        // What does not fit is no belief, and brings nothing down.
        let (state, good) = (told[0].0, &witnesses[0]);
        let spoilt = |change: fn(&mut RecordedBelief)| {
            let mut witness = good.clone();
            change(&mut witness);
            Belief::of_witness(&kitchen, state, &witness)
        };
        assert_eq!(spoilt(|witness| witness.aspects.truncate(3)), None);
        assert_eq!(spoilt(|witness| witness.aspects[0].p_truth = f64::NAN), None);
        assert_eq!(spoilt(|witness| witness.aspects[0].p_truth = -0.5), None);
        assert_eq!(spoilt(|witness| witness.aspects[1].values.extend([("a shoe".to_string(), 0.5)])), None);
        // The session that ran and its replay say the same.
        let (ran, replayed) = (engine.into_follower(), replay);
        assert_eq!(TrialSummary::from_follower(&ran), TrialSummary::from_follower(&replayed));
    }
}

#[test]
fn what_nobody_knows_stays_unknown() {
    let kitchen = kitchen("sushi");
    let figures = |participant: &str| {
        let follower = SessionFollower::new(
            Session::new(kitchen.clone(), settings(participant), 0),
            CostToGo::new(kitchen.clone()),
        );
        FalseBeliefErrorSummary::from_trials([&TrialSummary::from_follower(&follower)])
    };
    let nobody = figures("kind = \"keyboard\"\ngaze = \"none\"");
    assert_eq!(nobody, FalseBeliefErrorSummary::default(), "a person tells no beliefs");
    let simulated = figures("");
    assert_eq!((simulated.belief_related_errors, simulated.sequences), (Some(0), Some(0)));
    assert_eq!(simulated.mean_sequence_length, None, "no mean of nothing");
}

#[test]
fn a_human_who_knows_everything_is_fitted_to_the_presses() {
    let kitchen = kitchen("sushi");
    let mut cost = CostToGo::new(kitchen.clone());
    let mut there = kitchen.empty_state();
    there.set_order(kitchen.orders[0], OrderContent::Dish(kitchen.dish_named("salmon maki").expect("a dish")));
    there.set_content(kitchen.hands[Agent::Human.index()], kitchen.content_named("nori").expect("a content"));
    let (board, trash) = (kitchen.board, kitchen.button_named(Agent::Human, "trash").expect("a button"));
    let put = kitchen.button_named(Agent::Human, &kitchen.location(board).name.clone()).expect("a button");
    let press = |button, log_p| BeliefsBeforePress {
        state: there,
        button,
        held: None,
        estimate: Some(EstimateBeforePress { p_false: vec![0.0; kitchen.aspects.len()], log_p }),
        unseen_change: vec![false; kitchen.locations.len()],
        since_change_s: vec![None; kitchen.locations.len()],
        errs_about: Vec::new(),
    };
    // The wise press nine times of ten.
    let of_trial: TrialBeliefs = (0..20).map(|index| press(if index % 10 == 0 { trash } else { put }, -0.1)).collect();
    let trials = vec![of_trial; 5];
    let model = ChoiceParameters::default();
    let found = PressLogLikelihood::from_trials(&kitchen, &mut cost, &model, &trials, &[0, 1, 2, 3, 4], 1);
    let informed = found.informed.expect("presses");
    let best = 0.9 * 0.9_f64.ln() + 0.1 * 0.1_f64.ln();
    assert!(informed < 0.0 && informed <= best + 1e-9, "no better than knowing the shares: {found:?}");
    let truth = WeightedWorlds::certain(World::with_true_recipes(&kitchen, there));
    let unfitted = ChoiceModel::new(&kitchen, &model).probabilities(&mut cost, &truth).press;
    let unfitted = 0.9 * unfitted[put.index()].ln() + 0.1 * unfitted[trash.index()].ln();
    assert!(informed > unfitted, "fitting makes it likelier: {informed} against {unfitted}");
    assert_eq!(found.uniform, Some(-(kitchen.buttons[Agent::Human.index()].len() as f64).ln()));
    let gain = found.gain.expect("an estimate");
    assert!((gain - (-0.1 - informed)).abs() < 1e-9);
    // Trials that are all alike leave no doubt.
    let [from, to] = found.gain_interval.expect("an interval");
    assert!((from - gain).abs() < 1e-9 && (to - gain).abs() < 1e-9);
    assert_eq!(
        PressLogLikelihood::from_trials(&kitchen, &mut cost, &model, &[], &[], 1),
        PressLogLikelihood::default()
    );
}

#[test]
fn a_running_session_judges_the_wizards_signals_as_compare_does() {
    let kitchen = kitchen("sushi");
    let mut spec = settings("");
    spec.trial.condition = Condition::Wizard;
    spec.wizard.kind = WizardKind::Scripted;
    let start = || Session::new(kitchen.clone(), spec.clone(), 0);
    let mut engine = SessionEngine::new(kitchen.clone(), spec.clone(), 0, CostToGo::new(kitchen.clone()));
    // As a live session follows itself.
    let mut live = SessionFollower::new(start(), CostToGo::new(kitchen.clone())).without_causes();
    let request = SenderComparisonSettings { with: Vec::new(), window: WINDOW };
    let mut compare = SenderComparisonFollower::new(start(), CostToGo::new(kitchen.clone()), &request);
    headless::run(&mut engine, |stamped| {
        live.apply(stamped).expect("what was recorded can be replayed");
        compare.apply(stamped).expect("what was recorded can be compared");
    });
    let at_console = WizardSummary::from_follower(&live).measures;
    let compared = RecordingSenderComparison::new("S001".to_string(), compare, ExclusionStatus::default());
    let compared = compared.wizard.expect("a wizard's trial");
    assert_eq!(at_console, compared.measures);
    assert!(at_console.signals > 0 && at_console.episodes > Some(0), "{at_console:?}");
    let printed = wizard_log::describe(&compared);
    for words in at_console.words().expect("a simulated participant's beliefs are known") {
        assert!(printed.contains(&words), "{words} in {printed}");
    }
}
