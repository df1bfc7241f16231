//! Questionnaires with items of every kind: what is an answer, what a log holds, and what the files of the program ask.

use tomcom_session::files::parse::parse;
use tomcom_session::plan::{
    AnswerFormat, ParticipantProgress, PhaseSpec, PlanRecording, Questionnaire, QuestionnaireSpec, RecordingOutcome,
    Study,
};
use tomcom_session::questionnaire::AnswerValue;

use super::assignment::made;
use super::files;
use crate::support::*;

fn shipped(name: &str) -> Questionnaire {
    let path = Path::new("sessions/questionnaires").join(name);
    let questionnaire: Questionnaire =
        parse(&path, &fs::read_to_string(&path).expect("a file")).expect("a questionnaire");
    questionnaire.check().expect("a right one");
    questionnaire
}

fn options(ids: &[&str]) -> AnswerValue {
    AnswerValue::Options(ids.iter().map(|id| id.to_string()).collect())
}

fn text(words: &str) -> AnswerValue {
    AnswerValue::Text(words.to_string())
}

#[test]
fn each_kind_of_item_takes_its_answers_and_no_others() {
    let asked = shipped("demographics.toml");
    let slider = shipped("nasa-tlx.toml");
    let form = |id: &str| asked.form(asked.position(id).expect("an item")).expect("a form");
    let number = AnswerValue::Number;
    for (form, right, wrong) in [
        (form("age"), vec![number(18), number(99)], vec![number(17), number(100), text("30"), options(&[])]),
        (
            form("gender"),
            vec![text("x"), text(&"é".repeat(40))],
            vec![text(" "), text(&"e".repeat(41)), text("a\nb"), number(1)],
        ),
        (form("handedness"), vec![text("left")], vec![text("neither"), options(&["left"]), number(1)]),
        (
            form("vision_aids"),
            vec![options(&[]), options(&["glasses"]), options(&["glasses", "lenses"])],
            vec![
                options(&["glasses", "glasses"]),
                options(&["monocle"]),
                options(&["none", "glasses"]),
                text("glasses"),
            ],
        ),
        (form("robots"), vec![number(1), number(5)], vec![number(0), number(6), number(i64::MIN), text("1")]),
        (
            slider.form(0).expect("a form"),
            vec![number(0), number(5), number(100)],
            vec![number(-5), number(105), number(42), text("5")],
        ),
    ] {
        for answer in right {
            assert_eq!(form.admit(&answer), Ok(()), "{answer:?} for {form:?}");
        }
        for answer in wrong {
            assert!(form.admit(&answer).is_err(), "{answer:?} for {form:?}");
        }
    }
}

#[test]
fn an_option_that_stands_alone_and_the_others_take_each_other_back() {
    let asked = shipped("demographics.toml");
    let form = asked.form(asked.position("vision_aids").expect("an item")).expect("a form");
    let mut given = None;
    for (option, wanted) in [
        (1, vec!["glasses"]),
        (2, vec!["glasses", "lenses"]),
        (0, vec!["none"]),
        (2, vec!["lenses"]),
        (0, vec!["none"]),
        (0, vec![]),
    ] {
        given = form.choose(option, given.as_ref());
        assert_eq!(given, Some(options(&wanted)), "after option {option}");
        assert_eq!(form.admit(given.as_ref().expect("an answer")), Ok(()));
    }
}

#[test]
fn an_answer_in_the_log_is_a_number_a_text_or_a_list() {
    for (answer, json) in [
        (AnswerValue::Number(6), "6"),
        (text("left"), r#""left""#),
        (options(&["glasses", "lenses"]), r#"["glasses","lenses"]"#),
    ] {
        let event = ProtocolEvent::ItemAnswered { item: "one".to_string(), answer };
        let written = serde_json::to_string(&event).expect("JSON");
        assert_eq!(written, format!(r#"{{"what":"item_answered","item":"one","answer":{json}}}"#));
        assert_eq!(serde_json::from_str::<ProtocolEvent>(&written).expect("the same event"), event);
    }
}

#[test]
fn the_questionnaires_ask_the_same_in_both_languages() {
    for name in ["acceptance", "demographics", "nasa-tlx", "sus"] {
        let (english, german) = (shipped(&format!("{name}.toml")), shipped(&format!("{name}.de.toml")));
        assert_eq!((english.language.as_str(), german.language.as_str()), ("en", "de"));
        assert_eq!(
            (&english.name, english.score, english.items.len()),
            (&german.name, german.score, german.items.len())
        );
        for (index, (one, other)) in english.items.iter().zip(&german.items).enumerate() {
            assert_eq!(
                (&one.id, one.kind, &one.about, one.reversed),
                (&other.id, other.kind, &other.about, other.reversed)
            );
            assert_ne!(one.text, other.text, "{}", one.id);
            let ids = |item: &tomcom_session::plan::QuestionnaireItem| {
                item.options.iter().map(|one| one.id.clone()).collect::<Vec<_>>()
            };
            assert_eq!(ids(one), ids(other));
            let shape = |form: Option<AnswerFormat>| match form.expect("a form") {
                AnswerFormat::Scale(scale) => (1, i64::from(scale.points)),
                AnswerFormat::Number { range, .. } => (range[0], range[1]),
                AnswerFormat::Slider { step, .. } => (0, step),
                AnswerFormat::Text { length } => (0, i64::from(length)),
                AnswerFormat::Choice { several, .. } => (0, i64::from(several)),
            };
            assert_eq!(shape(english.form(index)), shape(german.form(index)), "{}", one.id);
        }
    }
}

#[test]
fn the_person_is_asked_before_the_first_trial_and_only_then() {
    let mut files = files();
    let plan = files.spec.plan.as_mut().expect("a plan");
    let spec = |file: &str| QuestionnaireSpec { file: file.to_string(), after: None, before: true };
    plan.questionnaire.insert(0, spec("questionnaires/demographics.toml"));
    files.questionnaires.insert(0, shipped("demographics.toml"));
    let study = files.study().expect("a plan");
    let asked = |slot| {
        let (spec, _) = study.settings(WantedRecording { participant: 0, slot, attempt: 1, instructed: true });
        let phases = spec.step.expect("a step").phases;
        let before = phases.iter().take_while(|phase| **phase != PhaseSpec::Trial).count();
        (phases.len(), before)
    };
    assert_eq!(asked(1), (3, 1), "before the first trial, and what is asked after it");
    assert_eq!(asked(2).1, 0, "not again before the second");
    // Once for each participant: the answers of a recording that is left out, and repeated, are there.
    let mut made = made(&study, 1, 1, RecordingOutcome::Excluded { reason: "the tracker slipped".to_string() });
    made.excluded = Some("the tracker slipped".to_string());
    let phases = |made: &PlanRecording| {
        let made = std::slice::from_ref(made);
        let progress = ParticipantProgress::from_recordings(&study, 0, made).expect("a recording of the plan");
        progress.settings(&study, 1, 2).0.step.expect("a step").phases
    };
    assert_eq!(phases(&made), study_phases(&study), "nobody has answered yet");
    made.answered.insert("demographics".to_string());
    assert_eq!(phases(&made), study_phases(&study)[1..], "without the questions before the trial");
}

/// The phases of the first participant's first trial, with all that is asked.
fn study_phases(study: &Study) -> Vec<PhaseSpec> {
    let (spec, _) = study.settings(WantedRecording { participant: 0, slot: 1, attempt: 2, instructed: true });
    spec.step.expect("a step").phases
}
