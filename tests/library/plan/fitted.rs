//! Parameters of persons: each recording of a plan has those of its participant, and says so.

use std::fs;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use tomcom::base::time::SessionTime;
use tomcom::edge::files::{read_human_model, read_session, write_human_model};
use tomcom::mind::fitted_people::{FittedPeople, HumanModelFile};
use tomcom::mind::fitting::HumanModelParameter;
use tomcom::mind::model::HumanModel;
use tomcom::run::simulate::settings_of_trial;
use tomcom::session::fitted_parameters::ParameterSource;
use tomcom::session::plan::Study;
use tomcom::session::{LogHeader, Session, SessionSpec, preflight_checks};

use super::folder;

/// A study whose human model is this file.
fn study_with(name: &str, human: &str) -> (PathBuf, Study) {
    let folder = folder(name);
    let root = std::env::current_dir().expect("the project's folder");
    fs::write(folder.join("human.toml"), human).expect("a file can be written");
    let text = format!(
        "layout = \"{}/layouts/sushi.toml\"\nhuman_model = \"human.toml\"\n[plan]\nname = \"with-people\"\nparticipants = 3\n\
         conditions = [\"none\", \"tom-com\"]\n",
        root.display()
    );
    let session = folder.join("study.toml");
    fs::write(&session, text).expect("a file can be written");
    let files = read_session(&session).expect("a study");
    let study = files.study().expect("a plan");
    (session, study)
}

const HUMAN: &str = "[decision]\ntau = 4.0\nlapse = 0.05\n\n[people.P02]\ntau = 1.5\nreading_rate_hz = 3.0\n";

#[test]
fn each_participant_has_its_own_parameters_and_the_others_those_of_the_population() {
    let (session, study) = study_with("fitted", HUMAN);
    let simulated = |participant: usize| study.simulated(participant, 1).0;
    let of = |spec: &SessionSpec| {
        (spec.human.decision.tau, spec.human.decision.lapse, spec.human.perception.reading_rate_hz, spec.parameters_of)
    };
    let usual = HumanModel::default().perception.reading_rate_hz;
    assert_eq!(of(&simulated(0)), (4.0, 0.05, usual, Some(ParameterSource::Population)));
    assert_eq!(of(&simulated(1)), (1.5, 0.05, 3.0, Some(ParameterSource::Person)));
    assert_eq!(of(&simulated(2)), of(&simulated(0)));
    // The same outside of a plan, where a trial's participant is not in the file.
    let alone = read_session(&session).expect("a study").spec;
    let alone = SessionSpec { plan: None, ..alone };
    assert_eq!(of(&settings_of_trial(&alone, 1)), of(&simulated(0)));
}

#[test]
fn a_header_has_the_values_in_force_and_nothing_of_the_others() {
    let (_, study) = study_with("fitted-header", HUMAN);
    let (spec, trial) = study.simulated(1, 2);
    let files = tomcom::edge::files::read_kitchen(Path::new("layouts/sushi.toml")).expect("the kitchen");
    let header = LogHeader::new(spec.clone(), trial, files.layout, files.recipes);
    let text = serde_json::to_string(&header).expect("a header");
    assert!(text.contains("\"parameters_of\":\"person\"") && !text.contains("\"people\""), "{text}");
    let read: LogHeader = serde_json::from_str(&text).expect("the header");
    assert_eq!(read.session, spec);
}

#[test]
fn the_digest_covers_the_parameters_of_persons() {
    let digest = |name: &str, human: &str| study_with(name, human).1.digest;
    let first = digest("fitted-digest-1", HUMAN);
    assert_eq!(first, digest("fitted-digest-2", &format!("# another comment\n{HUMAN}")));
    assert_ne!(first, digest("fitted-digest-3", &HUMAN.replace("tau = 1.5", "tau = 1.6")));
    let nobody = HUMAN.split("[people").next().expect("a head");
    assert_ne!(first, digest("fitted-digest-4", nobody));
    // A file without persons is what it was before there were any.
    let population = HumanModelFile::default();
    let path = folder("fitted-digest-5").join("human.toml");
    write_human_model(&path, &population, "Parameters of the human model, fitted to 1 recording").expect("written");
    assert!(!fs::read_to_string(&path).expect("a file").contains("people"));
}

#[test]
fn preflight_says_whose_parameters_are_in_force() {
    let (_, study) = study_with("fitted-preflight", HUMAN);
    let files = tomcom::edge::files::read_kitchen(Path::new("layouts/sushi.toml")).expect("the kitchen");
    let kitchen = Arc::new(files.kitchen);
    let told = |participant: usize| {
        let (spec, trial) = study.simulated(participant, 1);
        let session = Session::new(kitchen.clone(), spec, trial);
        let checks = preflight_checks::participant(&session, SessionTime::ZERO, "c", None);
        checks.into_iter().find(|check| check.name == "human model").map(|check| check.found)
    };
    assert_eq!(told(1).as_deref(), Some("parameters of the person P02, from human.toml"));
    assert_eq!(told(0).as_deref(), Some("parameters of the population: human.toml has none of P01"));
    let (_, without) = study_with("fitted-preflight-2", "[decision]\ntau = 4.0\n");
    let session = Session::new(kitchen.clone(), without.simulated(0, 1).0, 1);
    let checks = preflight_checks::participant(&session, SessionTime::ZERO, "c", None);
    assert!(checks.iter().all(|check| check.name != "human model"), "{checks:?}");
}

#[test]
fn a_file_of_people_is_read_as_it_was_written() {
    let mut people = FittedPeople::default();
    let own = [
        (HumanModelParameter::Tau, 1.25),
        (HumanModelParameter::RecipeHalfLifeS, 61.5),
        (HumanModelParameter::RecipeTruth, 0.7),
    ];
    people.0.insert("P07".to_string(), own.into_iter().collect());
    people.0.insert("seed9821-S001".to_string(), own[..1].iter().copied().collect());
    let file = HumanModelFile { people: Some(people), ..HumanModelFile::default() };
    let path = folder("fitted-file").join("human.toml");
    write_human_model(&path, &file, "Parameters of the human model, fitted to 3 recordings").expect("written");
    assert_eq!(read_human_model(&path).expect("the file"), file);
    let mut model = file.population.clone();
    assert!(file.people.as_ref().is_some_and(|people| people.apply("P07", &mut model)));
    assert_eq!((model.decision.tau, model.prior.recipe_truth), (1.25, 0.7));
    assert!(!file.people.as_ref().is_some_and(|people| people.apply("P08", &mut model)));
}
