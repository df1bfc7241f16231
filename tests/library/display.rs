//! The participant's display: what is told to the page, in which words, and what may never be.

use std::time::Instant;

use tomcom::run::live::display::PageEvent;
use tomcom_core::communication::signals;
use tomcom_core::robot::SafetyMode;
use tomcom_devices::display::PageInput;
use tomcom_devices::sight::page_language::DisplayWords;
use tomcom_devices::sight::{DisplayStage, TrialClockState, scene, sight, time_left};
use tomcom_session::files::LanguageFile;
use tomcom_session::files::parse::parse;
use tomcom_session::protocol::StudyPhase;
use tomcom_session::wall_display::{DisplayEvent, DisplaySpec, RobotDepiction};

use crate::support::*;

const SESSIONS: [&str; 2] = ["sessions/default.toml", "sessions/burger.toml"];

/// A session file of the project, with an inference that is coarse and quick.
pub(super) fn files(path: &str) -> SessionSetup {
    let mut files = read_session(Path::new(path)).expect("a session file of the project");
    let inference = &mut files.spec.human.inference;
    (inference.beliefs, inference.states, inference.max_beliefs) = (16, 8, 32);
    files
}

pub(super) fn engine(files: SessionSetup) -> SessionEngine {
    engine_of(files, 0)
}

/// Lets a session run until its trial is over, or so many seconds; after each step the wizard does something, and somebody
/// looks at what the page is told.
fn run(
    engine: &mut SessionEngine,
    seconds: f64,
    mut wizard: impl FnMut(u32, &Session) -> Option<Event>,
    mut look: impl FnMut(&Session),
) {
    let mut advisor = engine.session().spec.asks_assistant().then(|| engine.advisor());
    let give = |engine: &mut SessionEngine, event| drop(engine.input(engine.session().time, event));
    give(engine, Event::TrialStarted);
    let end = at(seconds);
    for step in 0.. {
        for question in engine.take_questions() {
            if let Some(advisor) = &mut advisor {
                let advice = Event::Advised(advisor.answer(&question));
                give(engine, advice);
            }
        }
        if let Some(event) = wizard(step, engine.session()) {
            give(engine, event);
        }
        look(engine.session());
        if !engine.session().is_running() || engine.session().time > end {
            return;
        }
        engine.fire();
    }
}

/// Every text in a JSON value, with the name of its field.
fn texts(value: &Value, field: &str, found: &mut Vec<(String, String)>) {
    match value {
        Value::String(text) => found.push((field.to_string(), text.clone())),
        Value::Array(values) => values.iter().for_each(|value| texts(value, field, found)),
        Value::Object(fields) => {
            for (name, value) in fields {
                found.push(("field".to_string(), name.clone()));
                texts(value, name, found);
            }
        }
        _ => {}
    }
}

/// Lists of names in a JSON value.
fn lists(value: &Value, found: &mut Vec<Vec<String>>) {
    match value {
        Value::Array(values) => {
            found.push(values.iter().filter_map(|value| value.as_str().map(str::to_string)).collect());
            values.iter().for_each(|value| lists(value, found));
        }
        Value::Object(fields) => fields.values().for_each(|value| lists(value, found)),
        _ => {}
    }
}

/// Whether a list has all items of a dish of the menu.
fn has_recipe(kitchen: &Kitchen, list: &[String]) -> bool {
    kitchen.dishes.iter().any(|dish| {
        let items = &kitchen.content(dish.stack()).items;
        items.iter().all(|item| list.contains(&kitchen.content(*item).name))
    })
}

/// Fields of what the page is told.
const FIELDS: &str = "clock probe tutorial why reason about stage practice contents served presses \
                      intention robot_does signal cue question item stack dish number at effective \
                      location storage recipe highlight next order items target checks";

/// Holds a sight against the session: every text in it is one that the participant may see now, and nothing else.
pub(super) fn check(session: &Session) {
    let (kitchen, now) = (&session.kitchen, sight(session));
    let value = serde_json::to_value(&now).expect("a sight is JSON");
    let mut found = Vec::new();
    texts(&value, "", &mut found);
    // A reason is one of the page's words, at a location: neither a content nor a recipe.
    let words = DisplayWords::for_display(&session.spec.display).of_page();
    let on_display = |name: &String| {
        let places = (0..kitchen.locations.len()).map(|index| tomcom_core::kitchen::LocationId(index as u8));
        places.into_iter().any(|place| {
            let aspect = tomcom_core::kitchen::AspectId::of_location(place);
            let label = &kitchen.aspects[aspect.index()].labels[kitchen.true_value(session.state, aspect)];
            let is_order = kitchen.orders.contains(&place);
            let items = if is_order { &[][..] } else { &kitchen.content(session.state.content(place)).items[..] };
            label == name || items.iter().any(|item| kitchen.content(*item).name == *name)
        })
    };
    for (field, text) in &found {
        let is_fine = match field.as_str() {
            "field" => FIELDS.split(' ').any(|known| known == text),
            "stage" => true,
            "clock" => session.spec.display.clock && ["goes", "stands"].contains(&text.as_str()),
            "reason" => words.contains_key(&format!("why {text}")),
            "robot_does" => words.contains_key(&format!("robot {}", text.replace('_', " "))),
            "contents" => ["empty", "served"].contains(&text.as_str()),
            "item" | "stack" | "dish" => on_display(text),
            "items" => value.pointer("/signal/recipe").is_some(),
            _ => false,
        };
        assert!(is_fine, "{field}: {text} in {value}");
    }
    // A recipe is told by the signal about its order alone, and only while that is shown.
    let recipe = value.pointer("/signal/recipe/items").is_some();
    let asked = matches!(session.shown.as_ref().map(|shown| &shown.signal), Some(Signal::ShowRecipe(_)));
    assert!(!recipe || asked, "{value}");
    let mut all = Vec::new();
    lists(&value, &mut all);
    assert!(recipe || !all.iter().any(|list| has_recipe(kitchen, list)), "a recipe in {value}");
    let intends = session.robot.intention.is_some() && session.spec.display.intention;
    assert!(now.intention.is_none() || intends, "{value}");
}

#[test]
fn the_page_is_told_what_may_be_seen_and_nothing_else() {
    for path in SESSIONS {
        for condition in [Condition::Assistant, Condition::Wizard] {
            let mut files = files(path);
            files.spec.trial.condition = condition;
            // Whatever is worth anything is said, so that there are signals to look at.
            files.spec.assistant.cost_of_communication = 0.0;
            files.spec.display.clock = condition == Condition::Wizard;
            // With both arms: nothing of them is to be seen.
            files.spec.robot.arm = if condition == Condition::Wizard { ArmKind::Timed } else { ArmKind::Physics };
            let mut engine = engine(files);
            let signals = signals(&engine.session().kitchen.clone(), engine.session().highlights());
            let contents = engine.session().kitchen.contents.len();
            let (mut told, mut looked) = (0, 0);
            let wizard = |step: u32, session: &Session| match step % 41 {
                7 | 23 if condition == Condition::Wizard => {
                    let signal = signals[(step as usize / 16) % signals.len()].1.clone();
                    Some(Event::SignalShown { by: Sender::Wizard, signal, offer: None })
                }
                // Whatever lies there: complete stacks, too, on the menu and not.
                13 => {
                    let content = &session.kitchen.contents[(step as usize * 7) % contents];
                    let location = session.kitchen.location(session.kitchen.board).name.clone();
                    Some(Event::KitchenCorrected { location, content: content.name.clone() })
                }
                17 => Some(Event::Marker { note: "overlooked the pot".to_string(), observer: Some("O1".to_string()) }),
                _ => None,
            };
            run(&mut engine, 50.0, wizard, |session| {
                check(session);
                looked += 1;
                told += usize::from(sight(session).signal.is_some());
            });
            assert!(looked > 100 && told > 0, "{path}, {condition:?}: {looked} messages, {told} with a signal");
        }
    }
}

#[test]
fn the_scene_tells_no_recipe_and_no_wizards_keys() {
    for path in SESSIONS {
        let engine = engine(files(path));
        let kitchen = engine.session().kitchen.clone();
        let value = serde_json::to_value(scene(engine.session())).expect("a scene is JSON");
        let mut all = Vec::new();
        lists(&value, &mut all);
        assert!(!all.iter().any(|list| has_recipe(&kitchen, list)), "a recipe in {value}");
        let mut found = Vec::new();
        texts(&value, "", &mut found);
        let said = |word: &str| found.iter().any(|(_, text)| text.contains(word));
        for word in ["variant", "belief", "signal", "advi", "recommend", "deviation", "cost", "seed", "P01"] {
            assert!(!said(word), "{word} in the scene");
        }
        assert_eq!(value["tags"].as_array().map(Vec::len), Some(4));
    }
}

#[test]
fn the_robots_intention_is_shown_where_the_session_says_so() {
    let mut shown = [0, 0];
    for allowed in [false, true] {
        let mut files = files(SESSIONS[0]);
        files.spec.display.intention = allowed;
        let mut engine = engine(files);
        let count = |session: &Session| shown[usize::from(allowed)] += usize::from(sight(session).intention.is_some());
        run(&mut engine, 60.0, |_, _| None, count);
    }
    assert!(shown[0] == 0 && shown[1] > 10, "{shown:?}");
}

#[test]
fn phases_of_a_plan_are_those_of_the_display() {
    let mut files = files("sessions/study.toml");
    files.spec.participant.kind = ParticipantKind::Display;
    files.spec.participant.gaze = GazeSource::Mouse;
    files.spec.display.questionnaire = AnswerDevice::Display;
    let study = files.study().expect("a plan");
    // The second trial of somebody: trial, questionnaire, here twice, debriefing of the wizard.
    let wanted = WantedRecording { participant: 0, slot: 2, attempt: 1, instructed: true };
    let (mut spec, trial) = study.settings(wanted);
    let phases = &mut spec.step.as_mut().expect("a step of the plan").phases;
    phases.insert(2, phases[1].clone());
    let kitchen = Arc::new(files.kitchen.kitchen);
    let mut engine = SessionEngine::new(kitchen.clone(), spec, trial, CostToGo::new(kitchen.clone()));
    let give = |engine: &mut SessionEngine, event: Event| {
        let outcome = engine.input(engine.session().time, event.clone());
        assert_eq!(outcome.refused, None, "{event:?}");
    };
    let phase = |phase, number| Event::Protocol(ProtocolEvent::PhaseStarted { phase, number });
    let stage = |engine: &SessionEngine| sight(engine.session()).stage;
    assert_eq!(stage(&engine), DisplayStage::Welcome);
    give(&mut engine, phase(StudyPhase::Trial, 1));
    assert_eq!(stage(&engine), DisplayStage::Ready);
    give(&mut engine, Event::TrialStarted);
    assert_eq!(stage(&engine), DisplayStage::Running);
    give(&mut engine, Event::TrialPaused);
    assert_eq!(stage(&engine), DisplayStage::Paused);
    give(&mut engine, Event::TrialEnded { reason: TrialEndReason::Wizard });
    assert_eq!(stage(&engine), DisplayStage::Over);
    for (number, then) in [(2, DisplayStage::MoreQuestions), (3, DisplayStage::Answered)] {
        give(&mut engine, phase(StudyPhase::Questionnaire, number));
        assert_eq!(stage(&engine), DisplayStage::Questionnaire);
        let mut asked = Vec::new();
        while let Some(item) = sight(engine.session()).question.expect("a question").item {
            asked.push(item.clone());
            give(&mut engine, Event::Protocol(ProtocolEvent::ItemAnswered { item, answer: 3_u8.into() }));
        }
        let question = sight(engine.session()).question.expect("a question");
        let is_last = question.number == question.of && asked.last() == question.before.as_ref();
        assert!(asked.len() > 3 && is_last, "{asked:?}");
        give(&mut engine, Event::Protocol(ProtocolEvent::AnswersConfirmed));
        assert_eq!((sight(engine.session()).question, stage(&engine)), (None, then));
    }
    give(&mut engine, phase(StudyPhase::Debriefing, 4));
    assert_eq!(stage(&engine), DisplayStage::Thanks);
    give(&mut engine, Event::SessionEnded);
    assert_eq!(stage(&engine), DisplayStage::Thanks);
    // Whoever leaves before that comes back.
    for slot in [1, 2] {
        let (spec, trial) = study.settings(WantedRecording { slot, ..wanted });
        let mut engine = SessionEngine::new(kitchen.clone(), spec, trial, CostToGo::new(kitchen.clone()));
        give(&mut engine, Event::SessionEnded);
        assert_eq!(stage(&engine), DisplayStage::Over, "slot {slot}");
    }
}

#[test]
fn what_the_display_tells_is_recorded_and_verified() {
    let mut files = files(SESSIONS[0]);
    files.spec.participant.kind = ParticipantKind::Display;
    files.spec.participant.gaze = GazeSource::Mouse;
    let header = LogHeader::new(files.spec.clone(), 0, files.kitchen.layout.clone(), files.kitchen.recipes.clone());
    let folder = empty_folder("display");
    let mut log = LogWriter::create_live(&folder, "2026-03-14", &header).expect("the folder can be written");
    let mut engine = engine(files);
    let press = |button: &str, pressed_s| Event::Press {
        agent: Agent::Human,
        button: button.to_string(),
        at_ns: Some(at(pressed_s)),
        button_box: false,
    };
    let signal = Signal::Highlight("counter".to_string());
    for (seconds, event) in [
        (0.5, Event::Display(DisplayEvent::Connected { width_px: 1920, height_px: 1080 })),
        (1.0, Event::TrialStarted),
        (1.02, Event::Display(DisplayEvent::Drawn { cue: 1, at_ns: at(1.015) })),
        (2.0, press("take rice", 1.98)),
        (3.0, press("cooking_pot", 2.995)),
        (3.5, Event::SignalShown { by: Sender::Wizard, signal, offer: None }),
        (4.0, Event::Display(DisplayEvent::Lost)),
        (5.0, Event::TrialEnded { reason: TrialEndReason::Wizard }),
        (5.0, Event::SessionEnded),
    ] {
        let outcome = engine.input(at(seconds), event);
        assert_eq!(outcome.refused, None);
        outcome.events.iter().for_each(|stamped| log.append(stamped).expect("the log can be written"));
    }
    assert_eq!(sight(engine.session()).presses[0].map(|press| (press.number, press.effective)), Some((2, true)));
    log.flush().expect("the log can be written");
    let path = log.folder().join(LOG_NAME);
    drop(log);
    let text = std::fs::read_to_string(&path).expect("a recording");
    assert!(text.contains(r#""button":"take rice","at_ns":1980000000"#), "{text}");
    assert!(verify(&path).expect("a recording").verified);
}

#[test]
fn every_shape_is_drawn() {
    let art = include_str!("../../src/devices/display/page/art.js");
    for shape in tomcom_core::kitchen::parts::SHAPES {
        assert!(art.contains(&format!("    {shape}(")) || art.contains(&format!("    {shape}: (")), "{shape}");
    }
}

#[test]
fn every_language_has_every_word_of_the_page_and_of_both_kitchens() {
    let read = |language: &str| {
        let path = Path::new("src/devices/sight/languages").join(format!("{language}.toml"));
        let text = std::fs::read_to_string(&path).unwrap_or_else(|error| panic!("{}: {error}", path.display()));
        parse::<LanguageFile>(&path, &text).expect("words").0
    };
    let english = read("en");
    for language in DisplaySpec::LANGUAGES.iter().filter(|language| **language != "en") {
        let own = read(language);
        let mut needed: BTreeSet<String> = english.keys().cloned().collect();
        for path in SESSIONS {
            let kitchen = files(path).kitchen.kitchen;
            let known = kitchen.words.in_language(language).clone();
            let places = kitchen.locations.iter().map(|place| place.name.replace('_', " "));
            let words = kitchen.words.in_language("en").keys().cloned().chain(places).chain([kitchen.title.clone()]);
            needed.extend(words.filter(|word| !known.contains_key(word)));
        }
        let missing: Vec<&String> = needed.iter().filter(|key| !own.contains_key(*key)).collect();
        assert!(missing.is_empty(), "src/devices/sight/languages/{language}.toml has no {missing:?}");
        // A place of a number or a name in the text is one in the translation, too.
        let places = |words: &String| words.matches('#').count();
        let other: Vec<&String> = english.keys().filter(|key| places(&english[*key]) != places(&own[*key])).collect();
        assert!(other.is_empty(), "src/devices/sight/languages/{language}.toml has another number of # in {other:?}");
        assert_eq!(own["language"], **language);
    }
    let words = DisplayWords::for_display(&DisplaySpec { language: "de".to_string(), ..DisplaySpec::default() });
    assert_eq!(words.of_name("assembly_board"), "Arbeitsbrett");
    assert_eq!(words.of_name("toaster"), "toaster");
}

#[test]
fn a_language_may_come_from_a_file() {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("language");
    std::fs::create_dir_all(&folder).expect("a folder");
    let layout = Path::new("layouts/sushi.toml").canonicalize().expect("a layout");
    let session = folder.join("session.toml");
    std::fs::write(folder.join("fr.toml"), "\"language\" = \"fr\"\n\"rice\" = \"riz\"\n").expect("written");
    std::fs::write(&session, format!("layout = {layout:?}\n[display]\nlanguage = \"fr.toml\"\n")).expect("written");
    let files = read_session(&session).expect("a session file");
    let scene = scene(engine(files).session());
    assert_eq!((scene.language.as_str(), scene.storages[0].label.as_str()), ("fr", "riz"));
    // The accessible name of a shelf's button is the language's, too.
    assert!(scene.buttons.iter().any(|knob| knob.name == "take rice" && knob.label == "take riz"));
    std::fs::write(&session, format!("layout = {layout:?}\n[display]\nlanguage = \"fi.toml\"\n")).expect("written");
    let error = format!("{:?}", miette::Report::new(read_session(&session).expect_err("no such file")));
    assert!(error.contains("session.toml:3:") && error.contains("\"en\", \"de\", \"es\""), "{error}");
}

#[test]
fn clock_and_number_of_served_orders_are_shown_where_the_session_says_so() {
    for shown in [false, true] {
        let mut files = files("sessions/default.toml");
        (files.spec.display.clock, files.spec.display.served) = (shown, shown);
        files.spec.trial.seconds = 600.0;
        let mut engine = engine(files);
        let expect = |engine: &SessionEngine, now_s: f64, clock, left_s| {
            let (seen, left) = (sight(engine.session()), time_left(engine.session(), at(now_s)));
            let wanted = shown.then_some(clock).flatten();
            assert_eq!((seen.clock, seen.served), (wanted, shown.then_some(0)), "at {now_s} s");
            assert_eq!(left.map(SessionTime::as_secs_f64), shown.then_some(left_s), "at {now_s} s");
        };
        let give = |engine: &mut SessionEngine, now_s, event| assert_eq!(engine.input(at(now_s), event).refused, None);
        expect(&engine, 1.0, None, 600.0);
        give(&mut engine, 2.0, Event::TrialStarted);
        expect(&engine, 12.0, Some(TrialClockState::Goes), 590.0);
        // It stands in a pause, and goes on from there.
        give(&mut engine, 12.0, Event::TrialPaused);
        expect(&engine, 50.0, Some(TrialClockState::Stands), 590.0);
        give(&mut engine, 62.0, Event::TrialResumed);
        expect(&engine, 72.0, Some(TrialClockState::Goes), 580.0);
        give(&mut engine, 72.0, Event::TrialEnded { reason: TrialEndReason::Wizard });
        expect(&engine, 99.0, Some(TrialClockState::Stands), 580.0);
        let scene = scene(engine.session());
        assert_eq!((scene.clock, scene.served, scene.sound), (shown, shown, false));
    }
    let usual = toml::from_str::<DisplaySpec>("").expect("settings");
    assert!(!usual.served && !usual.clock && !usual.sound);
}

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
        let press = Event::Press { agent: Agent::Human, button: (*button).to_string(), at_ns: None, button_box: false };
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
        ("shape", Some("needs_other_step")),
        ("take nori", Some("hand_full")),
        ("rolling_mat", Some("not_accepted")),
        ("cooking_pot", None),
        ("take salmon", None),
        ("cooking_pot", Some("place_full")),
        ("cutting_board", None),
        ("cook", None),
        ("cook", Some("already_processed")),
        ("take nori", None),
        ("shape", Some("not_processed")),
        ("assembly_board", None),
        ("take nori", None),
        ("assembly_board", Some("not_stacked")),
        ("plate", None),
        ("serve 1", Some("not_served")),
        ("take salmon", None),
        ("assembly_board", Some("needs_other_step")),
        ("counter", None),
        ("assembly_board", None),
        ("trash", None),
        ("counter", None),
        ("assembly_board", None),
        ("take nori", None),
        ("assembly_board", Some("place_full")),
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
fn every_language_has_a_line_for_every_reason_that_names_no_content() {
    for language in DisplaySpec::LANGUAGES {
        let spec = DisplaySpec { language: language.to_string(), ..DisplaySpec::default() };
        let mut lines = DisplayWords::for_display(&spec).of_page();
        lines.retain(|key, _| key.starts_with("why "));
        assert_eq!(lines.len(), 15, "{language}");
        assert!(lines.values().all(|line| line.chars().count() <= 50 && line.ends_with(['.', '。'])), "{lines:?}");
        lines.retain(|_, line| !line.contains('#'));
        let placeless = [
            "already_processed",
            "hand_empty",
            "hand_full",
            "needs_other_step",
            "not_processed",
            "not_processed human_hand",
            "not_served unfinished",
        ];
        let placeless = placeless.map(|reason| format!("why {reason}"));
        assert!(lines.keys().eq(&placeless), "{language}: reasons without their place: {lines:?}");
    }
}

#[test]
fn a_reason_is_a_sentence_that_begins_with_the_place() {
    for path in SESSIONS {
        let kitchen = files(path).kitchen.kitchen;
        for language in ["de", "es", "fr", "it"] {
            let spec = DisplaySpec { language: language.to_string(), ..DisplaySpec::default() };
            let words = DisplayWords::for_display(&spec);
            for place in
                kitchen.locations.iter().filter(|place| place.kind == tomcom_core::kitchen::LocationKind::Place)
            {
                let said = words.in_sentence(&place.name);
                assert_ne!(said, words.of_name(&place.name), "{language}: without an article");
                assert!(said.starts_with(char::is_uppercase), "{language}: {said}");
            }
            for (key, line) in
                words.of_page().iter().filter(|(key, line)| key.starts_with("why ") && line.contains('#'))
            {
                assert!(line.starts_with('#'), "{language}: {key}: {line}");
            }
        }
    }
}

#[test]
fn the_page_says_that_the_robot_is_stopped_also_where_a_real_one_stands() {
    for arm in [RobotDepiction::Hand, RobotDepiction::None] {
        let mut files = files("sessions/default.toml");
        files.spec.display.arm = arm;
        let mut engine = engine(files);
        let mut does = |event: Event| {
            assert_eq!(engine.input(engine.session().time, event).refused, None);
            serde_json::to_value(sight(engine.session())).expect("a sight is JSON")["robot_does"].clone()
        };
        assert_eq!(does(Event::TrialStarted), Value::Null, "it works");
        assert_eq!(does(Event::RobotStopped), "stopped", "{arm:?}");
        assert_ne!(does(Event::RobotResumed), "stopped", "{arm:?}");
        let held = if arm == RobotDepiction::Hand { Value::from("waits") } else { Value::Null };
        assert_eq!(does(Event::RobotHeld { by: Sender::Wizard }), held, "a real robot is seen");
        assert_ne!(does(Event::RobotReleased { by: Sender::Wizard }), "waits", "{arm:?}");
    }
}

#[test]
fn the_page_says_that_the_robot_is_slow_or_waits_and_nothing_about_hands() {
    let mut engine = engine(files("sessions/default.toml"));
    assert_eq!(engine.input(engine.session().time, Event::TrialStarted).refused, None);
    assert!(engine.session().robot.intention.is_some(), "it has set out");
    let says = |session: &Session, mode| {
        let mut session = session.clone();
        session.robot.arm.mode = mode;
        serde_json::to_value(sight(&session)).expect("a sight is JSON")["robot_does"].clone()
    };
    assert_eq!(says(engine.session(), SafetyMode::Reduced), "slow");
    assert_eq!(says(engine.session(), SafetyMode::Safeguard), "waits");
    assert_eq!(says(engine.session(), SafetyMode::Normal), Value::Null);
    assert_eq!(engine.input(engine.session().time, Event::TrialPaused).refused, None);
    assert_eq!(says(engine.session(), SafetyMode::Reduced), Value::Null, "in a pause the arm rests");
}

#[test]
fn a_press_that_is_refused_names_its_button_in_signs_that_can_be_shown() {
    let files = files("sessions/default.toml");
    let session = Session::new(Arc::new(files.kitchen.kitchen), files.spec, 0);
    let refused = |button: &str| {
        let input = PageInput::Press { button: button.to_string(), at: Instant::now() };
        let PageEvent { event, notice } = PageEvent::from_input(input, &session, SessionTime::ZERO);
        assert!(event.is_none(), "{event:?}");
        notice.expect("a notice").1
    };
    assert!(refused("explode").contains("\"explode\""));
    let text = refused(&format!("\u{1b}[2J{}", "x".repeat(5000)));
    assert!(text.contains("[2J") && !text.contains('\u{1b}') && text.len() < 200, "{text}");
}
