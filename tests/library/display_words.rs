//! The words of the participant's display: contents as the kitchen's files word them, and why a press has no effect.

use serde_json::Value;
use tomcom_core::base::time::SessionTime;
use tomcom_core::kitchen::Agent;
use tomcom_devices::sight::page_language::DisplayWords;
use tomcom_devices::sight::{scene, sight};
use tomcom_session::Event;
use tomcom_session::settings::{ArmKind, ParticipantKind};
use tomcom_session::wall_display::DisplaySpec;

use super::display::{check, engine, files};

/// The scene's pictures and storages in a language, by the names of items.
fn worded(session: &str, change: impl Fn(&mut DisplaySpec)) -> impl Fn(&str) -> String {
    let mut files = files(session);
    change(&mut files.spec.display);
    let scene = scene(engine(files).session());
    move |name| scene.items.get(name).or_else(|| scene.dishes.get(name)).expect("an item or a dish").label.clone()
}

#[test]
fn contents_are_worded_as_the_kitchens_files_say_and_the_session_has_the_last_word() {
    let english = worded("sessions/default.toml", |_| ());
    assert_eq!(["rice cooked", "nori", "salmon maki"].map(&english), ["cooked rice", "nori", "salmon maki"]);
    let german = worded("sessions/default.toml", |display| display.language = "de".to_string());
    assert_eq!(["rice cooked", "nori", "salmon maki"].map(&german), ["gekochter Reis", "Nori", "Lachs-Maki"]);
    let burger = worded("sessions/burger.toml", |display| display.language = "de".to_string());
    assert_eq!(["beef grilled", "tomato sliced"].map(&burger), ["gegrilltes Rind", "Tomatenscheiben"]);
    let own = worded("sessions/default.toml", |display| {
        display.language = "de".to_string();
        display.words.insert("rice cooked".to_string(), "Kochreis".to_string());
    });
    assert_eq!(["rice cooked", "rice raw"].map(&own), ["Kochreis", "roher Reis"]);
}

/// What the page is told about the human's press of these buttons, one after the other.
fn reasons(change: impl Fn(&mut DisplaySpec), buttons: &[&str]) -> Vec<Option<String>> {
    let mut files = files("sessions/default.toml");
    files.spec.participant.kind = ParticipantKind::Keyboard;
    files.spec.robot.arm = ArmKind::Timed;
    change(&mut files.spec.display);
    let mut engine = engine(files);
    let mut told = Vec::new();
    assert_eq!(engine.input(SessionTime::ZERO, Event::TrialStarted).refused, None);
    for (index, button) in buttons.iter().enumerate() {
        let press = Event::Press { agent: Agent::Human, button: (*button).to_string(), at_ns: None };
        assert_eq!(engine.input(SessionTime(1_000_000 * (index as u64 + 1)), press).refused, None, "{button}");
        check(engine.session());
        let now = serde_json::to_value(sight(engine.session())).expect("a sight is JSON");
        let why = now.pointer("/presses/0/why/reason").and_then(Value::as_str);
        told.push(why.map(str::to_string));
        assert!(now.pointer("/presses/1/why").is_none(), "the robot gives no reasons");
    }
    told
}

#[test]
fn a_press_without_effect_says_why_unless_the_session_switches_that_off() {
    let presses = [
        ("trash", Some("hand_empty")),
        ("cooking_pot", Some("both_empty")),
        ("cook", Some("place_empty")),
        ("shape", Some("hand_empty")),
        ("serve 2", Some("place_empty")),
        ("take rice", None),
        ("take nori", Some("hand_full")),
        ("rolling_mat", Some("not_accepted")),
        ("cooking_pot", None),
        ("take salmon", None),
        ("cooking_pot", Some("place_full")),
        ("cutting_board", None),
        ("cook", None),
        ("cook", Some("not_processed")),
        ("take nori", None),
        ("assembly_board", None),
        ("take nori", None),
        ("assembly_board", Some("not_stacked")),
        ("plate", None),
        ("serve 1", Some("not_served")),
    ];
    let buttons: Vec<&str> = presses.iter().map(|(button, _)| *button).collect();
    let orders = |told: Vec<Option<String>>| -> Vec<(String, Option<String>)> {
        buttons.iter().map(|button| button.to_string()).zip(told).collect()
    };
    let expected: Vec<(String, Option<String>)> =
        presses.iter().map(|(button, why)| (button.to_string(), why.map(str::to_string))).collect();
    assert_eq!(orders(reasons(|_| (), &buttons)), expected);
    let silent = reasons(|display| display.reasons = false, &buttons);
    assert!(silent.iter().all(Option::is_none), "{silent:?}");
}

#[test]
fn both_languages_have_a_line_for_every_reason_that_names_no_content() {
    for language in DisplaySpec::LANGUAGES {
        let spec = DisplaySpec { language: language.to_string(), ..DisplaySpec::default() };
        let words = DisplayWords::for_display(&spec).of_page();
        let lines: Vec<&String> =
            words.iter().filter(|(key, _)| key.starts_with("why ")).map(|(_, line)| line).collect();
        assert_eq!(lines.len(), 10, "{language}");
        assert!(lines.iter().all(|line| line.chars().count() <= 40 && line.ends_with('.')), "{lines:?}");
    }
}
