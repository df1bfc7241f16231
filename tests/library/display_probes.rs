//! Freeze probes on the participant's display: what the page is told of every question, and what an answer means.

use tomcom_devices::sight::{DisplayStage, probe_left, probe_wording, sight};
use tomcom_session::apply;
use tomcom_session::probes::{ProbeEndReason, ProbeOrigin, ProbeQuestion, ProbeSubject};

use super::display::{engine, files};
use crate::support::*;

const SESSIONS: [&str; 2] = ["sessions/default.toml", "sessions/burger.toml"];

/// A session that is fed with events by hand.
struct Probed {
    session: Session,
    seq: u64,
}

impl Probed {
    /// A running trial with probes, in the middle of which something lies about and a recipe is shown.
    fn running(path: &str, language: &str) -> Probed {
        let mut files = files(path);
        files.spec.participant.kind = ParticipantKind::Display;
        files.spec.display.language = language.to_string();
        files.spec.probes = Some(toml::from_str("confidence = true").expect("settings of probes"));
        let mut engine = engine(files);
        assert_eq!(engine.input(SessionTime::ZERO, Event::TrialStarted).refused, None);
        let mut probed = Probed { session: engine.session().clone(), seq: 1_000 };
        let kitchen = probed.session.kitchen.clone();
        let place = kitchen.location(kitchen.board).name.clone();
        let content = kitchen.content(kitchen.dishes[0].stack()).name.clone();
        probed.at(20.0, Event::KitchenCorrected { location: place, content });
        probed
    }

    fn at(&mut self, seconds: f64, event: Event) {
        let stamped = TimestampedEvent { seq: self.seq, time: at(seconds), event };
        apply(&mut self.session, &stamped).unwrap_or_else(|error| panic!("{error:?}: {stamped:?}"));
        self.seq += 1;
    }

    fn probe(&mut self, seconds: f64, event: ProbeEvent) {
        self.at(seconds, Event::Probe(event));
    }

    fn begin(&mut self, seconds: f64, questions: Vec<ProbeQuestion>) {
        let (origin, uses_estimate) = (ProbeOrigin::Schedule, true);
        self.probe(seconds, ProbeEvent::Begun { probe: 1, origin, uses_estimate, questions });
    }

    fn told(&self) -> Value {
        serde_json::to_value(sight(&self.session)).expect("a sight is JSON")
    }
}

/// The question about an aspect, with its choices from the last to the first.
fn question(kitchen: &Kitchen, aspect: AspectId) -> ProbeQuestion {
    let of = &kitchen.aspects[aspect.index()];
    let about = match of.kind {
        AspectKind::Location(id) => ProbeSubject::Location { location: kitchen.location(id).name.clone() },
        AspectKind::Recipe(dish) => ProbeSubject::Recipe { dish: kitchen.dish(dish).name.clone() },
    };
    ProbeQuestion { about, choices: of.labels.iter().rev().cloned().collect(), inclusion: 0.123_456 }
}

fn every_question(kitchen: &Kitchen) -> Vec<ProbeQuestion> {
    (0..kitchen.aspects.len()).map(|index| question(kitchen, AspectId(index as u8))).collect()
}

fn keys(value: &Value) -> BTreeSet<&str> {
    value.as_object().map_or_else(BTreeSet::new, |fields| fields.keys().map(String::as_str).collect())
}

/// Fields of a probe on the page.
const FIELDS: [&str; 10] =
    ["probe", "question", "of", "text", "about", "choices", "confidence", "limit_s", "late", "closed"];

/// Holds what the page is told during a probe against the question: nothing but question, choices and progress.
fn check(probed: &Probed, asked: Option<&ProbeQuestion>) {
    let (told, kitchen) = (probed.told(), &probed.session.kitchen);
    assert_eq!((&told["stage"], &told["contents"]), (&"probe".into(), &Value::Array(Vec::new())), "{told}");
    assert!(told["signal"].is_null() && told["intention"].is_null() && told["question"].is_null(), "{told}");
    let probe = &told["probe"];
    assert_eq!(keys(probe), FIELDS.into(), "{probe}");
    let text = probe.to_string();
    for word in ["inclusion", "0.123", "estimate", "origin", "schedule", "answer", "true\"", "correct"] {
        assert!(!text.contains(word), "{word} in {text}");
    }
    let choices = probe["choices"].as_array().expect("a list");
    let Some(asked) = asked else { return assert!(choices.is_empty(), "{probe}") };
    let mut last = 0;
    for choice in choices {
        assert_eq!(keys(choice), ["number", "shows", "words"].into(), "{choice}");
        // They stand in the order of the log.
        let number = choice["number"].as_u64().expect("a number") as usize;
        assert!(number > last && number <= asked.choices.len(), "{probe}");
        last = number;
        let name = &asked.choices[number - 1];
        let is_recipe = matches!(asked.about, ProbeSubject::Recipe { .. });
        let shows = keys(&choice["shows"]);
        assert!(is_recipe == shows.contains("recipe"), "{name}: {choice}");
        // Of a dish nothing says what it is made of.
        let is_dish = kitchen.dish_named(name).is_some();
        assert!(is_recipe || !is_dish || choice["shows"] == serde_json::json!({ "dish": name }), "{choice}");
    }
    assert_eq!(choices.len(), asked.choices.len(), "{probe}");
}

#[test]
fn the_page_is_told_the_question_and_nothing_of_the_kitchen() {
    let mut looked = 0;
    for (path, language) in [(SESSIONS[0], "en"), (SESSIONS[0], "de"), (SESSIONS[1], "de")] {
        let mut probed = Probed::running(path, language);
        let before = probed.told();
        assert!(before["probe"].is_null() && before["contents"].as_array().is_some_and(|all| !all.is_empty()));
        let questions = every_question(&probed.session.kitchen.clone());
        probed.begin(30.0, questions.clone());
        check(&probed, None);
        for (index, asked) in questions.iter().enumerate() {
            let (seconds, number) = (31.0 + index as f64 * 0.1, index as u32 + 1);
            probed.probe(seconds, ProbeEvent::Asked { probe: 1, question: number });
            check(&probed, Some(asked));
            let shown = probed.told();
            assert_eq!((&shown["probe"]["question"], &shown["probe"]["of"]), (&number.into(), &questions.len().into()));
            // Whatever is answered, the page is told the same.
            let answers = [None, asked.choices.first().cloned(), asked.choices.last().cloned()];
            let after: Vec<Value> = answers
                .into_iter()
                .map(|answer| {
                    let confidence = answer.as_ref().map(|_| 2);
                    let mut other = Probed { session: probed.session.clone(), seq: probed.seq };
                    let on = AnswerDevice::Display;
                    other.probe(
                        seconds + 0.05,
                        ProbeEvent::Answered { probe: 1, question: number, answer, confidence, on },
                    );
                    if let Some(next) = questions.get(index + 1) {
                        other.probe(seconds + 0.06, ProbeEvent::Asked { probe: 1, question: number + 1 });
                        check(&other, Some(next));
                    }
                    looked += 1;
                    other.told()
                })
                .collect();
            assert!(after.iter().all(|one| *one == after[0]), "the answer shows on the page: {after:?}");
            let (answer, confidence, on) = (None, None, AnswerDevice::Display);
            probed.probe(seconds + 0.05, ProbeEvent::Answered { probe: 1, question: number, answer, confidence, on });
        }
        probed.probe(50.0, ProbeEvent::Closed { probe: 1, reason: ProbeEndReason::Answered });
        check(&probed, None);
        assert_eq!(probed.told()["probe"]["closed"], true);
        probed.probe(53.0, ProbeEvent::Ended { probe: 1 });
        assert_eq!(probed.told(), before, "the display is as it was");
    }
    assert!(looked > 60, "{looked}");
}

#[test]
fn a_pause_hides_the_question_and_stops_its_time() {
    let mut probed = Probed::running(SESSIONS[0], "en");
    let questions = every_question(&probed.session.kitchen.clone());
    probed.begin(30.0, questions[..3].to_vec());
    probed.probe(31.0, ProbeEvent::Asked { probe: 1, question: 1 });
    let left_s = |probed: &Probed, now: f64| probe_left(&probed.session, at(now)).map(SessionTime::as_secs_f64);
    assert_eq!(left_s(&probed, 35.0), Some(8.0));
    let shown = probed.told();
    probed.at(36.0, Event::TrialPaused);
    assert_eq!(sight(&probed.session).stage, DisplayStage::Paused);
    assert_eq!((probed.told()["probe"].is_null(), left_s(&probed, 40.0)), (true, None));
    probed.at(46.0, Event::TrialResumed);
    assert_eq!((probed.told(), left_s(&probed, 46.0)), (shown, Some(7.0)));
    // A question whose time went by is told of with the next one, and one that was answered is not.
    assert_eq!(probed.told()["probe"]["late"], false);
    probed.probe(53.0, ProbeEvent::Asked { probe: 1, question: 2 });
    assert_eq!((&probed.told()["probe"]["late"], left_s(&probed, 54.0)), (&true.into(), Some(11.0)));
    let (answer, confidence, on) = (None, None, AnswerDevice::Display);
    probed.probe(54.0, ProbeEvent::Answered { probe: 1, question: 2, answer, confidence, on });
    probed.probe(54.0, ProbeEvent::Asked { probe: 1, question: 3 });
    assert_eq!(probed.told()["probe"]["late"], false);
    probed.probe(55.0, ProbeEvent::Skipped { probe: 1, reason: "a question".to_string() });
    probed.probe(55.0, ProbeEvent::Closed { probe: 1, reason: ProbeEndReason::Skipped });
    assert_eq!((&probed.told()["probe"]["late"], left_s(&probed, 56.0)), (&false.into(), Some(2.0)));
}

#[test]
fn questions_are_worded_in_the_displays_language() {
    let wording = |path: &str, language: &str, about: &str| {
        let probed = Probed::running(path, language);
        let kitchen = &probed.session.kitchen;
        let aspect = kitchen.aspect_named(about).expect("an aspect");
        probe_wording(&probed.session, &question(kitchen, aspect))
    };
    let asked = |path, language, about| wording(path, language, about).question;
    assert_eq!(asked(SESSIONS[0], "en", "cooking_pot"), "What is in the cooking pot?");
    assert_eq!(asked(SESSIONS[0], "de", "cooking_pot"), "Was ist im Kochtopf?");
    assert_eq!(asked(SESSIONS[0], "en", "recipe of tuna maki"), "What goes into tuna maki?");
    assert_eq!(asked(SESSIONS[0], "de", "recipe of tuna maki"), "Thunfisch-Maki: Was gehört hinein?");
    assert_eq!(asked(SESSIONS[0], "en", "order_2"), "What does order 2 ask for?");
    assert_eq!(asked(SESSIONS[0], "de", "order_2"), "Welches Gericht verlangt Bestellung 2?");
    assert_eq!(asked(SESSIONS[1], "de", "recipe of classic burger"), "Klassischer Burger: Was gehört hinein?");
    assert_eq!(asked(SESSIONS[1], "en", "robot_hand"), "What does the robot hold?");
    assert_eq!(asked(SESSIONS[1], "de", "shelf"), "Was liegt im Regal?");
    // A recipe is worded by its items, also where its stack has the name of another dish.
    let choices = wording(SESSIONS[0], "de", "recipe of tuna maki").choices;
    assert!(choices.contains(&"gekochter Reis + Nori + geschnittener Thunfisch".to_string()), "{choices:?}");
    assert!(choices.iter().all(|choice| choice.matches(" + ").count() == 2), "{choices:?}");
    let choices = wording(SESSIONS[0], "en", "cooking_pot").choices;
    assert!(choices.contains(&"nothing".to_string()) && choices.contains(&"cooked rice".to_string()), "{choices:?}");
    assert_eq!(choices.iter().collect::<BTreeSet<_>>().len(), choices.len(), "each choice has words of its own");
}
