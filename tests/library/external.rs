//! External concepts: programs that answer over pipes and sockets. The programs are lines of `sh`, which every machine has.

use std::io::{BufRead, BufReader, Write};
use std::net::TcpListener;
use std::thread;
use std::time::Duration;

use crate::support::*;
use tomcom::run::tournament::{self, TournamentRequest};
use tomcom_core::communication::settings::{ConceptSpec, ExternalMind};
use tomcom_devices::external::LocalMinds;
use tomcom_session::advisor::AdviceRequest;
use tomcom_session::external::concept::ConceptDialogue;
use tomcom_session::external::participant::ParticipantDialogue;
use tomcom_session::external::{
    DialogueOutcome, ExternalEvent, ExternalMinds, MOST_FAULTS, MindConnection, MindDialogue, MindFault, MindNews,
    MindReader, MindRole, MindWriter, SCHEMA,
};
use tomcom_session::headless::{Outside, run_with};
use tomcom_session::preflight_checks::{self, PreflightVerdict};
use tomcom_session::watcher::{SenderComparisonFollower, SenderComparisonSettings};
use tomcom_study::tournament::{Tournament, describe};

/// An agent in `sh`: `$1` answers the first question, `$2` any other one, where `$id` is the question's number.
fn agent(first: &str, answer: &str) -> String {
    format!(
        "while read -r line; do rest=${{line#*\\\"id\\\":}}; id=${{rest%%,*}}; case $line in \
         *'\"ask\":\"begin\"'*) {first};; *'\"ask\":\"end\"'*) exit 0;; *) {answer};; esac; done"
    )
}

const HELLO: &str = r#"echo '{"id":0,"protocol":1,"name":"test"}'"#;
/// Sends the first signal of a question, as text between the first brackets.
const FIRST: &str = r#"case $line in *'"signals":[]'*) echo "{\"id\":$id}";; *) rest=${line#*\"signals\":\[}; echo "{\"id\":$id,\"send\":${rest%%\}*}},\"reason\":\"first\"}";; esac"#;
const SILENT: &str = r#"echo "{\"id\":$id}""#;

/// A short trial in which an external concept acts.
fn files(seconds: f64, mind: ExternalMind) -> SessionSetup {
    let mut files = session_file("default");
    let spec = &mut files.spec;
    (spec.trial.condition, spec.trial.seconds, spec.robot.arm) = (Condition::Assistant, seconds, ArmKind::Timed);
    (spec.assistant.concept, spec.assistant.shadow) = (ConceptSpec::External(mind), ShadowMode::Off);
    files
}

/// A program that has time: the machine may be busy.
fn patient(command: &str) -> ExternalMind {
    ExternalMind { wait_s: 600.0, ..ExternalMind::new(command) }
}

/// Runs a trial with its program; its events.
fn run_session(setup: SessionSetup, minds: &dyn ExternalMinds) -> (SessionEngine, Vec<Event>) {
    let mut engine = engine_of(setup, 0);
    let mut events = Vec::new();
    let kept: Result<_, ()> = run_with(&mut engine, Outside { minds, now_ns: || 0 }, |stamped| {
        events.push(stamped.event.clone());
        Ok(())
    });
    kept.expect("nothing is written");
    (engine, events)
}

fn run(mind: ExternalMind, minds: &dyn ExternalMinds) -> Vec<Event> {
    run_session(files(30.0, mind), minds).1
}

fn faults(events: &[Event]) -> Vec<(MindFault, String)> {
    let fault = |event: &Event| match event {
        Event::External(ExternalEvent::Fault { fault, found, .. }) => Some((*fault, found.clone())),
        _ => None,
    };
    events.iter().filter_map(fault).collect()
}

fn aborted(events: &[Event]) -> Option<&str> {
    events.iter().find_map(|event| match event {
        Event::TrialAborted { reason } => Some(reason.as_str()),
        _ => None,
    })
}

/// What a scripted program answers to a question.
type Answer = fn(&Value) -> Value;

/// A connection whose answers a function gives, with what it was asked.
#[derive(Debug)]
struct Scripted(Answer);

#[derive(Debug)]
struct ScriptedWriter(std::sync::mpsc::Sender<MindNews>, Answer);

#[derive(Debug)]
struct ScriptedReader(std::sync::mpsc::Receiver<MindNews>);

impl MindWriter for ScriptedWriter {
    fn send(&mut self, line: String) -> Result<(), String> {
        let question: Value = serde_json::from_str(&line).expect("a question is JSON");
        let answer = match question["ask"].as_str() {
            Some("begin") => json!({"id": 0, "protocol": 1, "name": "scripted"}),
            _ => (self.1)(&question),
        };
        self.0.send(MindNews::Line(answer.to_string())).map_err(|_| "nobody listens".to_string())
    }
}

impl MindReader for ScriptedReader {
    fn receive(&mut self, _: Duration) -> MindNews {
        self.0.try_recv().unwrap_or(MindNews::Nothing)
    }
}

impl ExternalMinds for Scripted {
    fn open(&self, _: &ExternalMind) -> Result<MindConnection, String> {
        let (sender, receiver) = std::sync::mpsc::channel();
        let to = Box::new(ScriptedWriter(sender, self.0));
        Ok(MindConnection { to, from: Box::new(ScriptedReader(receiver)) })
    }

    fn sight(&self, session: &Session) -> [Value; 2] {
        LocalMinds.sight(session)
    }
}

/// Sends the first signal of every question.
fn first_signal(question: &Value) -> Value {
    json!({"id": question["id"], "send": question["signals"][0], "reason": "it comes first"})
}

#[test]
fn a_program_acts_and_its_recording_needs_no_program() {
    let out = empty_folder("external-acts");
    let recordings = simulate_into(files(30.0, patient(&agent(HELLO, FIRST))), 2, &out);
    assert_eq!(recordings.len(), 2);
    // The program can have been changed since.
    let setup = files(30.0, patient(&agent(HELLO, FIRST)));
    let again = SimulationRequest { files: setup, trials: 2, shard: SimulationShard::WHOLE, out };
    let again = simulate(&again, || ()).expect("recordings");
    let told = tomcom::run::simulate::describe(&again);
    let earlier = "\n2 trials are of an earlier run; if the program was changed since, delete them\n";
    assert!(told.contains(earlier), "{told}");
    for recording in recordings {
        let log = fs::read_to_string(recording.join(LOG_NAME)).expect("a recording");
        assert!(log.contains(r#""signal_shown","by":"assistant""#), "{log}");
        assert!(log.contains(r#""words":"first""#) && log.contains(r#""name":"test""#), "{log}");
        assert!(!log.contains(r#""fault""#), "{log}");
        let found = verify(&recording).expect("a recording");
        assert!(found.verified, "{:?}", found.difference);
    }
}

#[test]
fn questions_say_what_happened_and_fit_the_schema() {
    fn check(question: &Value) -> Value {
        let schema: Value = serde_json::from_str(SCHEMA).expect("the schema is JSON");
        fits(question, &schema["$defs"]["concept_question"], &schema).unwrap_or_else(|error| panic!("{error}"));
        let estimate: BTreeMap<String, BTreeMap<String, f64>> =
            serde_json::from_value(question["estimate"].clone()).expect("an estimate");
        for (aspect, values) in &estimate {
            let sum: f64 = values.values().sum();
            // Values below 0.01 are left out.
            assert!((0.6..1.01).contains(&sum), "{aspect}: {sum}");
        }
        // The estimate comes back as a belief of its own, with what was left out on the truth.
        let mut belief = question["estimate"].clone();
        for (aspect, values) in estimate {
            let truth = question["state"][&aspect].as_str().expect("a value").to_string();
            let sum: f64 = values.values().sum();
            let told = values.get(&truth).copied().unwrap_or_default() + (1.0 - sum).max(0.0);
            belief[&aspect][&truth] = json!(told.clamp(0.0, 1.0));
        }
        json!({"id": question["id"], "values": vec![2.5; question["signals"].as_array().map_or(0, Vec::len)],
            "belief": belief})
    }
    let mind = ExternalMind { estimate: true, ..ExternalMind::new("scripted") };
    let events = run(mind, &Scripted(check));
    assert_eq!(faults(&events), []);
    let advice = events.iter().filter_map(|event| match event {
        Event::Advised(advice) => Some(advice),
        _ => None,
    });
    let options: Vec<f64> = advice.flat_map(|advice| advice.options.iter().map(|option| option.net)).collect();
    assert!(!options.is_empty() && options.iter().all(|net| *net == 1.0), "{options:?}");
    let believes = |event: &Event| matches!(event, Event::External(ExternalEvent::Believes { role, .. }) if *role == MindRole::Concept);
    assert!(events.iter().any(believes));
}

#[test]
fn what_happened_since_is_told_once() {
    use std::sync::Mutex;
    static SINCE: Mutex<Vec<Value>> = Mutex::new(Vec::new());
    fn note(question: &Value) -> Value {
        let since = question["since"].as_array().expect("a list").iter().cloned();
        SINCE.lock().expect("one thread").extend(since);
        json!({"id": question["id"]})
    }
    let events = run(ExternalMind::new("scripted"), &Scripted(note));
    let since = SINCE.lock().expect("one thread");
    let told = |what: &str| since.iter().filter(|one| one["what"] == what).count();
    let presses = events.iter().filter(|event| matches!(event, Event::Press { .. })).count();
    assert_eq!(told("press"), presses, "every press leads to a question");
    let orders = events.iter().filter(|event| matches!(event, Event::OrderShown { .. })).count();
    assert_eq!(told("order"), orders);
    assert!(told("look") > 5, "{since:?}");
    assert!(since.iter().any(|one| one["by"] == "human" && one["error"].is_boolean()), "{since:?}");
}

/// Whether a value fits a part of the schema: as far as this schema goes.
fn fits(value: &Value, part: &Value, schema: &Value) -> Result<(), String> {
    if let Some(name) = part["$ref"].as_str() {
        return fits(value, &schema["$defs"][name.trim_start_matches("#/$defs/")], schema);
    }
    if let Some(choices) = part["oneOf"].as_array() {
        let fitting = choices.iter().filter(|choice| fits(value, choice, schema).is_ok()).count();
        return if fitting == 1 { Ok(()) } else { Err(format!("{value} fits {fitting} of {part}")) };
    }
    if !part["const"].is_null() && part["const"] != *value {
        return Err(format!("{value}, wanted {}", part["const"]));
    }
    if part["enum"].as_array().is_some_and(|all| !all.contains(value)) {
        return Err(format!("{value}, wanted one of {}", part["enum"]));
    }
    let is_type = |name: &str| match name {
        "string" => value.is_string(),
        "number" => value.is_number(),
        "integer" => value.is_u64(),
        "boolean" => value.is_boolean(),
        "array" => value.is_array(),
        "null" => value.is_null(),
        _ => value.is_object(),
    };
    let fitting = match &part["type"] {
        Value::String(name) => is_type(name),
        Value::Array(names) => names.iter().filter_map(Value::as_str).any(is_type),
        _ => true,
    };
    if !fitting {
        return Err(format!("{value}, wanted {}", part["type"]));
    }
    for item in value.as_array().into_iter().flatten() {
        fits(item, &part["items"], schema)?;
    }
    for (name, inner) in value.as_object().into_iter().flatten() {
        match (&part["properties"][name], &part["additionalProperties"]) {
            (Value::Null, Value::Bool(false)) => return Err(format!("{name} is not in the schema")),
            (Value::Null, Value::Null) => {}
            (Value::Null, other) => fits(inner, other, schema)?,
            (own, _) => fits(inner, own, schema)?,
        }
    }
    for name in part["required"].as_array().into_iter().flatten().filter_map(Value::as_str) {
        if value.get(name).is_none() {
            return Err(format!("{name} is missing in {value}"));
        }
    }
    Ok(())
}

#[test]
fn answers_that_cannot_be_used_count_as_silence() {
    let wrong: [(Answer, MindFault, &str); 6] = [
        (|_| json!("hello"), MindFault::Malformed, "invalid type"),
        (|question| json!({"id": question["id"], "sned": null}), MindFault::Malformed, "unknown field `sned`"),
        (|question| json!({"id": question["id"], "values": [1.0]}), MindFault::Malformed, "1 values; right would be"),
        (|question| json!({"id": question["id"], "send": {"highlight": "moon"}}), MindFault::Malformed, "moon"),
        (
            |question| json!({"id": question["id"], "belief": {"moon": {"cheese": 1.0}}}),
            MindFault::Malformed,
            "moon, which is no aspect",
        ),
        (
            |question| json!({"id": question["id"], "belief": {"order_1": {"none": 0.5}}}),
            MindFault::Malformed,
            "order_1",
        ),
    ];
    for (answer, wanted, words) in wrong {
        let events = run(ExternalMind::new("scripted"), &Scripted(answer));
        let found = faults(&events);
        assert!(found.iter().all(|(fault, found)| *fault == wanted && found.contains(words)), "{found:?}");
        assert!(found.len() > 5, "every question had such an answer: {found:?}");
        assert!(!events.iter().any(|event| matches!(event, Event::Advised(_) | Event::SignalShown { .. })));
        assert_eq!(aborted(&events), None, "the trial went on");
    }
    // An answer to no question is passed over, and the question still waits for its own.
    let events = run(ExternalMind::new("scripted"), &Scripted(|_| json!({"id": 1_000_000})));
    let kinds: Vec<MindFault> = faults(&events).into_iter().map(|(fault, _)| fault).collect();
    assert_eq!(kinds, [MindFault::Unasked, MindFault::Silent]);
    assert!(aborted(&events).is_some_and(|reason| reason.contains("no answer within 10 s")));
}

#[test]
fn programs_that_fail_fail_their_trial() {
    let hang = ExternalMind { wait_s: 0.2, ..ExternalMind::new(agent(HELLO, "sleep 1000")) };
    let endless = agent(HELLO, "yes x | tr -d '\\n'");
    let cases = [
        (patient("echo oh dear >&2; exit 3"), MindFault::Ended, "exit code 3: oh dear"),
        (patient("no-such-program-of-mine"), MindFault::Ended, "exit code 127"),
        (patient(&agent(HELLO, "exit 4")), MindFault::Ended, "exit code 4"),
        (patient(&agent(HELLO, "kill -9 $$")), MindFault::Ended, "it was killed"),
        (hang, MindFault::Silent, "no answer within 0.2 s"),
        (patient(&endless), MindFault::Ended, "a line of more than 1 MB"),
        (patient("head -c 100000000 /dev/zero; sleep 1000"), MindFault::Ended, "a line of more than 1 MB"),
        (patient("echo nonsense; sleep 1000"), MindFault::Malformed, "nonsense"),
        (patient(r#"echo '{"id":0,"protocol":2,"name":"later"}'; sleep 1000"#), MindFault::Malformed, "protocol 2"),
        (patient("tcp://192.0.2.1:9"), MindFault::NotStarted, "another computer"),
        (patient("tcp://nowhere"), MindFault::NotStarted, "tcp://nowhere"),
    ];
    for (mind, wanted, words) in cases {
        let command = mind.external.clone();
        let events = run(mind, &LocalMinds);
        let found = faults(&events);
        assert_eq!(found.len(), 1, "{command}: {found:?}");
        assert!(found[0].0 == wanted && found[0].1.contains(words), "{command}: {found:?}");
        let reason = aborted(&events).unwrap_or_else(|| panic!("{command}: the trial goes on"));
        assert!(reason.contains("external concept"), "{reason}");
        assert!(matches!(events.last(), Some(Event::SessionEnded)));
    }
}

#[test]
fn an_answer_before_the_question_and_a_flood_are_told() {
    // Two answers to each question: nobody asked for the second, which is read before the next answer.
    let twice = patient(&agent(HELLO, &format!("{SILENT}; {SILENT}")));
    let found = faults(&run(twice, &LocalMinds));
    assert!(!found.is_empty() && found.iter().all(|(fault, _)| *fault == MindFault::Unasked), "{found:?}");
    let early = patient(&format!("echo '{{\"id\":7}}'; {}", agent(HELLO, SILENT)));
    let events = run(early, &LocalMinds);
    assert_eq!(faults(&events)[0].0, MindFault::Malformed);
    assert!(aborted(&events).is_some());
    let flood = patient(&agent(HELLO, "yes '{}'"));
    let mut long = files(900.0, flood);
    long.spec.trial.presses = 10_000;
    let (_, events) = run_session(long, &LocalMinds);
    let found = faults(&events);
    assert_eq!(found.len() as u64, MOST_FAULTS + 1);
    assert_eq!(found.last().map(|(fault, _)| *fault), Some(MindFault::GivenUp));
    assert!(aborted(&events).is_some());
}

#[test]
fn a_program_ends_with_its_session_and_so_does_what_it_started() {
    let folder = empty_folder("external-group");
    let pids = folder.join("pids");
    // The grandchild outlives its parent, and neither ends by itself.
    let leaves = format!(
        "sleep 1000 & echo $! $$ > '{}'; trap '' TERM; {}; sleep 1000",
        pids.display(),
        agent(HELLO, SILENT).replace("exit 0", ":")
    );
    let events = run(patient(&leaves), &LocalMinds);
    assert_eq!(faults(&events), []);
    let started = fs::read_to_string(&pids).expect("the program ran");
    for pid in started.split_whitespace() {
        // A killed grandchild takes a moment to end, and stays as a zombie where nobody takes orphans.
        let stat = || fs::read_to_string(format!("/proc/{pid}/stat")).unwrap_or_default();
        while !(stat().is_empty() || stat().contains(") Z ")) {
            thread::sleep(Duration::from_millis(10));
        }
    }
}

#[test]
fn a_program_can_listen_on_a_port() {
    let listener = TcpListener::bind("127.0.0.1:0").expect("a port");
    let address = listener.local_addr().expect("an address");
    let serve = thread::spawn(move || {
        let (socket, _) = listener.accept().expect("the session connects");
        let mut lines = BufReader::new(socket.try_clone().expect("a copy")).lines();
        let mut out = socket;
        while let Some(Ok(line)) = lines.next() {
            let question: Value = serde_json::from_str(&line).expect("JSON");
            let answer = match question["ask"].as_str() {
                Some("begin") => json!({"id": 0, "protocol": 1, "name": "peer"}),
                Some("end") => return true,
                _ => json!({"id": question["id"]}),
            };
            writeln!(out, "{answer}").expect("the session reads");
        }
        false
    });
    let events = run(patient(&format!("tcp://{address}")), &LocalMinds);
    assert_eq!((faults(&events), aborted(&events)), (vec![], None));
    assert!(serve.join().expect("no panic"), "the peer is told the end");
}

#[test]
fn a_comparison_takes_the_answers_from_the_recording() {
    let mut engine = engine_of(files(60.0, ExternalMind::new("scripted")), 0);
    let session = Session::new(engine.session().kitchen.clone(), engine.session().spec.clone(), 0);
    let request = SenderComparisonSettings { with: vec![ConceptName::Tom], window: 5 };
    let mut follower =
        SenderComparisonFollower::new(session, CostToGo::new(engine.session().kitchen.clone()), &request);
    let outside = Outside { minds: &Scripted(first_signal), now_ns: || 0 };
    let mut advised = 0;
    run_with(&mut engine, outside, |stamped| {
        advised += usize::from(matches!(stamped.event, Event::Advised(_)));
        follower.apply(stamped).map(drop)
    })
    .expect("the events fit");
    follower.finish();
    let found = follower.comparison(true);
    let names: Vec<&str> = found.lanes.iter().map(|lane| lane.name.as_str()).collect();
    assert_eq!(names, ["assistant", "external", "tom"]);
    let spoken = found.lanes[1].spoken.len();
    assert!(spoken > 5 && spoken <= advised, "{spoken} signals in {advised} answers");
    let known = found.lanes[1].spoken[0].known.as_ref().expect("a context");
    assert_eq!(known.advice[0].words.as_deref(), Some("it comes first"));
}

#[test]
fn settings_name_a_program_or_a_concept() {
    let read = |text: &str| SessionSpec::from_toml(&format!("layout = \"x.toml\"\n[assistant]\n{text}"));
    let spec = read(r#"concept = { external = "python a.py", estimate = true, wait_s = 3 }"#).expect("an external one");
    let mind = ExternalMind { external: "python a.py".to_string(), estimate: true, wait_s: 3.0 };
    assert_eq!(spec.assistant.concept, ConceptSpec::External(mind));
    let again: SessionSpec = serde_json::from_value(serde_json::to_value(&spec).expect("JSON")).expect("settings");
    assert_eq!(again, spec);
    assert_eq!(read("concept = \"dev\"").expect("one of ours").assistant.concept, ConceptName::Dev);
    for (text, words) in [
        ("concept = \"tomm\"", "unknown variant `tomm`"),
        ("concept = \"external\"", "no program"),
        ("concept = 3", "the name of a concept, or { external"),
        ("concept = { command = \"a\" }", "unknown field `command`"),
        ("concept = { external = \" \" }", "external"),
        ("concept = { external = \"a b\", wait_s = 0 }", "wait_s"),
    ] {
        let error = read(text).expect_err(text).to_string();
        assert!(error.contains(words), "{text}: {error}");
    }
}

#[test]
fn a_tournament_compares_in_pairs_and_goes_on_where_it_was_cut() {
    let out = empty_folder("tournament");
    let mut setup = session_file("default");
    (setup.spec.trial.seconds, setup.spec.robot.arm) = (60.0, ArmKind::Timed);
    let fails = ExternalMind::new("exit 7; /");
    let concepts = vec![
        ConceptName::Tom.into(),
        ConceptSpec::External(patient(&agent(HELLO, FIRST))),
        ConceptSpec::External(fails),
    ];
    let request = |trials, shard| {
        let (files, concepts, out) = (setup.clone(), concepts.clone(), out.clone());
        TournamentRequest { files, concepts, trials, shard, out }
    };
    let run = |shard: SimulationShard| tournament::run(&request(6, shard), || ()).expect("a folder");
    // Two halves, as two computers make them; then all of it, from the recordings.
    let halves = [1, 2].map(|number| run(SimulationShard { number, of: 2 }));
    assert!(halves.iter().all(|half| half.trials == 3));
    let whole = run(SimulationShard::WHOLE);
    assert_eq!(whole.trials, 6);
    let row =
        |found: &Tournament, label: &str| found.concepts.iter().find(|row| row.concept.starts_with(label)).cloned();
    let acts = row(&whole, "while").expect("the program that sends");
    assert_eq!((acts.trials, acts.failed, acts.name.as_deref()), (6, 0, Some("test")));
    let tom = row(&whole, "tom").expect("ToM");
    assert!(acts.signals_per_100.value > tom.signals_per_100.value, "{acts:?}");
    assert!(acts.net_saving_per_100.value < tom.net_saving_per_100.value, "so many signals cost more than they save");
    assert_eq!(acts.computing_ms.is_some(), tom.computing_ms.is_some());
    let broken = row(&whole, "exit 7").expect("the program that ends");
    assert_eq!((broken.trials, broken.failed), (0, 6));
    assert!(whole.failures.iter().any(|failure| failure.contains("exit code 7")), "{:?}", whole.failures);
    // A second time nothing is simulated, and the table is the same; what was simulated before is told.
    assert_eq!(run(SimulationShard::WHOLE), whole);
    assert!(whole.concepts.iter().all(|row| row.found == 6) && halves[0].concepts.iter().all(|row| row.found == 0));
    assert!(describe(&halves[0]).contains("; 3 trials are too few for intervals\n"), "{}", describe(&halves[0]));
    assert!(describe(&whole).contains("; in brackets intervals of 95 %"), "{}", describe(&whole));
    // The unassisted trials are the reference, not a contestant that nobody asked for.
    assert!(row(&whole, "none").is_none() && out.join("none").is_dir());
}

/// A trial with an external participant, without advice.
fn with_participant(seconds: f64) -> SessionSetup {
    let mut setup = session_file("default");
    let spec = &mut setup.spec;
    (spec.trial.condition, spec.trial.seconds, spec.robot.arm) = (Condition::None, seconds, ArmKind::Timed);
    spec.assistant.shadow = ShadowMode::Off;
    (spec.participant.kind, spec.participant.gaze) = (ParticipantKind::External, GazeSource::None);
    spec.participant.external = Some("scripted".to_string());
    spec.check().expect("settings that fit together");
    setup
}

/// Holds what a participant is told against the display's own test, message by message.
#[derive(Debug)]
struct Watched {
    answers: Scripted,
    told: &'static std::sync::Mutex<Vec<Value>>,
}

impl ExternalMinds for Watched {
    fn open(&self, mind: &ExternalMind) -> Result<MindConnection, String> {
        self.answers.open(mind)
    }

    fn sight(&self, session: &Session) -> [Value; 2] {
        crate::display::check(session);
        let [scene, sight] = LocalMinds.sight(session);
        self.told.lock().expect("one thread").push(sight.clone());
        [scene, sight]
    }
}

/// Presses the buttons one after another, every second.
fn presses_in_turn(question: &Value) -> Value {
    let buttons = ["take rice", "cutting_board", "trash"];
    let number = question["id"].as_u64().unwrap_or_default();
    json!({"id": number, "press": buttons[number as usize % buttons.len()], "after_s": 1.0})
}

#[test]
fn a_participant_is_told_what_the_display_shows_and_nothing_else() {
    use std::sync::Mutex;
    static TOLD: Mutex<Vec<Value>> = Mutex::new(Vec::new());
    static ASKED: Mutex<u32> = Mutex::new(0);
    fn answer(question: &Value) -> Value {
        let schema: Value = serde_json::from_str(SCHEMA).expect("the schema is JSON");
        fits(question, &schema["$defs"]["participant_question"], &schema).unwrap_or_else(|error| panic!("{error}"));
        assert_eq!(Some(&question["display"]), TOLD.lock().expect("one thread").last());
        *ASKED.lock().expect("one thread") += 1;
        presses_in_turn(question)
    }
    let mut setup = with_participant(60.0);
    // Signals, advice and estimates are there, and have no way to the participant.
    (setup.spec.trial.condition, setup.spec.assistant.concept) = (Condition::Assistant, ConceptName::Tom.into());
    let (_, events) = run_session(setup, &Watched { answers: Scripted(answer), told: &TOLD });
    assert!(events.iter().any(|event| matches!(event, Event::SignalShown { .. })), "a signal was shown");
    assert!(*ASKED.lock().expect("one thread") > 20);
}

#[test]
fn a_participant_presses_and_its_recording_needs_no_program() {
    let command = agent(HELLO, r#"echo "{\"id\":$id,\"press\":\"trash\",\"after_s\":2}""#);
    let mut setup = with_participant(30.0);
    setup.spec.participant.external = Some(command);
    let recording = simulate_into(setup, 1, &empty_folder("external-presses")).remove(0);
    let log = fs::read_to_string(recording.join(LOG_NAME)).expect("a recording");
    let presses = log.lines().filter(|line| line.contains(r#""kind":"press","agent":"human""#)).count();
    assert!((13..=15).contains(&presses), "one every two seconds, not {presses}");
    let found = verify(&recording).expect("a recording");
    assert!(found.verified, "{:?}", found.difference);
}

#[test]
fn a_participants_told_beliefs_are_known_beliefs() {
    fn answer(question: &Value) -> Value {
        let mut answer = presses_in_turn(question);
        // A mind that holds the first value of everything.
        let kitchen = kitchen("sushi");
        let first = kitchen.aspects.iter().map(|aspect| (aspect.name.clone(), json!({aspect.labels[0].clone(): 1.0})));
        answer["belief"] = Value::Object(first.collect());
        answer
    }
    let (engine, events) = run_session(with_participant(30.0), &Scripted(answer));
    assert_eq!(faults(&events), []);
    let judged = engine.judged();
    assert!(judged.len() > 10 && judged.iter().all(|press| press.belief_known));
    assert!(judged.iter().filter(|press| press.verdict.error).all(|press| press.cause.is_some()));
}

#[test]
fn a_participants_wrong_answers_are_recorded_and_it_waits() {
    let wrong: [(Answer, &str); 3] = [
        (|question| json!({"id": question["id"], "press": "fly"}), "fly, which is no button"),
        (|question| json!({"id": question["id"], "press": "trash", "after_s": -1.0}), "after_s"),
        (|question| json!({"id": question["id"], "belief": {}}), "a belief without"),
    ];
    for (answer, words) in wrong {
        let (_, events) = run_session(with_participant(30.0), &Scripted(answer));
        let found = faults(&events);
        assert!(!found.is_empty() && found.iter().all(|(_, found)| found.contains(words)), "{found:?}");
        assert!(!events.iter().any(|event| matches!(event, Event::Press { agent: Agent::Human, .. })));
        assert_eq!(aborted(&events), None);
    }
    // One that always wants to be asked again at once does not stop the clock.
    let restless = Scripted(|question| json!({"id": question["id"], "after_s": 0.0}));
    let (engine, events) = run_session(with_participant(10.0), &restless);
    assert_eq!((faults(&events), engine.session().is_trial_over()), (vec![], true));
    let mut setup = with_participant(10.0);
    setup.spec.participant.external = Some("echo no; exit 5".to_string());
    let (_, events) = run_session(setup, &LocalMinds);
    assert!(aborted(&events).is_some_and(|reason| reason.contains("external participant")), "{events:?}");
}

#[test]
fn a_participant_that_is_not_waited_for_has_one_question_at_a_time() {
    let mut engine = engine_of(with_participant(30.0), 0);
    let mut dialogue = ParticipantDialogue::new("x y");
    let told = |outcome: DialogueOutcome| match &outcome.events[..] {
        [Event::External(event)] => event.clone(),
        other => panic!("{other:?}"),
    };
    let display = |number: u64| move || json!(number);
    let _ = engine.input(SessionTime::ZERO, Event::TrialStarted);
    let session = engine.session();
    assert_eq!(dialogue.question(session, at(1.0), display(1)), None, "it has not begun");
    let began = told(dialogue.take(session, r#"{"id":0,"protocol":1,"name":"slow"}"#));
    assert_eq!(began, ExternalEvent::Began { role: MindRole::Participant, name: "slow".to_string() });
    assert!(dialogue.question(session, at(1.0), display(1)).is_some_and(|line| line.contains("\"id\":1,")));
    assert_eq!(dialogue.question(session, at(2.0), display(2)), None, "the first question has no answer yet");
    assert_eq!(dialogue.silence(at(10.0)), DialogueOutcome::default());
    assert!(matches!(told(dialogue.silence(at(11.0))), ExternalEvent::Fault { fault: MindFault::Silent, .. }));
    assert_eq!(dialogue.silence(at(12.0)), DialogueOutcome::default(), "told once");
    // Its press is timed from the question, so it is due already.
    assert_eq!(dialogue.take(session, r#"{"id":1,"press":"trash","after_s":2.0}"#), DialogueOutcome::default());
    assert_eq!(dialogue.due(session), Some(at(3.0)));
    assert_eq!(dialogue.question(session, at(13.0), display(3)), None, "a press is under way");
    assert_eq!(dialogue.act(session).len(), 1);
    let twice = told(dialogue.take(session, r#"{"id":1}"#));
    assert!(matches!(twice, ExternalEvent::Fault { fault: MindFault::Unasked, .. }));
    assert!(dialogue.question(session, at(13.0), display(3)).is_some_and(|line| line.contains("\"id\":2,")));
    let over = dialogue.failed(MindFault::Ended, "exit code 1");
    assert!(over.ends && dialogue.due(session).is_none());
    assert_eq!(dialogue.take(session, r#"{"id":2,"press":"trash"}"#), DialogueOutcome::default());
}

#[test]
fn settings_of_an_external_participant_go_together() {
    let read = |text: &str| SessionSpec::from_toml(&format!("layout = \"x.toml\"\n[participant]\n{text}"));
    let right = "kind = \"external\"\nexternal = \"python a.py\"\ngaze = \"none\"";
    assert_eq!(read(right).expect("all three").participant.external.as_deref(), Some("python a.py"));
    for text in [
        "kind = \"external\"\ngaze = \"none\"",
        "external = \"python a.py\"",
        "kind = \"external\"\nexternal = \"a\"\ngaze = \"mouse\"",
        "kind = \"external\"\nexternal = \"\"\ngaze = \"none\"",
    ] {
        let error = read(text).expect_err(text);
        assert_eq!(error.path, "participant.external", "{text}");
    }
}

/// A session with an external concept at the console, with its first questions.
fn asked(mind: ExternalMind, count: usize) -> (ConceptDialogue, Vec<AdviceRequest>) {
    let mut engine = engine_of(files(300.0, mind.clone()), 0);
    let dialogue = ConceptDialogue::new(engine.session(), &mind);
    let _ = engine.input(SessionTime::ZERO, Event::TrialStarted);
    let mut questions = engine.take_questions();
    while questions.len() < count {
        engine.fire();
        questions.extend(engine.take_questions());
    }
    (dialogue, questions)
}

#[test]
fn live_an_answer_after_the_next_question_is_recorded_and_not_used() {
    let (mut dialogue, questions) = asked(ExternalMind::new("x y"), 4);
    assert_eq!(dialogue.take(r#"{"id":0,"protocol":1,"name":"slow"}"#).events.len(), 1);
    let (first, _) = dialogue.question(&questions[0]);
    let (second, _) = dialogue.question(&questions[1]);
    let id = |line: &str| serde_json::from_str::<Value>(line).expect("JSON")["id"].as_u64().expect("a number");
    assert_eq!((id(&first), id(&second)), (1, 2));
    let late = dialogue.take(r#"{"id":1,"reason":"too slow"}"#).events;
    let [Event::External(ExternalEvent::Late { role: MindRole::Concept, for_seq, answer })] = &late[..] else {
        panic!("{late:?}");
    };
    assert_eq!((*for_seq, answer.as_str()), (questions[0].seq, r#"{"id":1,"reason":"too slow"}"#));
    let used = dialogue.take(r#"{"id":2,"reason":"in time"}"#).events;
    assert!(matches!(&used[..], [Event::Advised(advice)] if advice.words.as_deref() == Some("in time")), "{used:?}");
    // A second answer to it is one that nobody asked for.
    let again = dialogue.take(r#"{"id":2}"#).events;
    assert!(matches!(&again[..], [Event::External(ExternalEvent::Fault { fault: MindFault::Unasked, .. })]));
}

#[test]
fn live_a_silence_is_told_once_until_an_answer_comes() {
    let (mut dialogue, questions) = asked(ExternalMind { wait_s: 2.0, ..ExternalMind::new("x y") }, 40);
    dialogue.take(r#"{"id":0,"protocol":1,"name":"mute"}"#);
    let silences = |dialogue: &mut ConceptDialogue, questions: &[AdviceRequest]| -> Vec<Event> {
        questions.iter().flat_map(|question| dialogue.question(question).1).collect()
    };
    let told = silences(&mut dialogue, &questions[..20]);
    assert!(matches!(&told[..], [Event::External(ExternalEvent::Fault { fault: MindFault::Silent, .. })]), "{told:?}");
    assert!(matches!(&dialogue.take(r#"{"id":20}"#).events[..], [Event::Advised(_)]));
    assert_eq!(silences(&mut dialogue, &questions[20..]).len(), 1, "a new silence is told again");
}

#[test]
fn whether_the_program_is_there_is_checked_before_the_trial() {
    let mut engine = engine_of(files(30.0, ExternalMind::new("python my_agent.py")), 0);
    let check = |engine: &SessionEngine| {
        let checks = preflight_checks::participant(engine.session(), SessionTime::ZERO, "g", None);
        let found = checks.into_iter().find(|check| check.name == "concept").expect("a check of the program");
        (found.verdict, found.found)
    };
    assert_eq!(check(&engine), (PreflightVerdict::Warning, "no answer yet of python my_agent.py".to_string()));
    let mut take = |event| {
        let _ = engine.input(SessionTime::ZERO, Event::External(event));
        check(&engine)
    };
    let began = ExternalEvent::Began { role: MindRole::Concept, name: "mine".to_string() };
    assert_eq!(take(began.clone()), (PreflightVerdict::Ok, "mine answers".to_string()));
    let fault = |fault, found: &str| ExternalEvent::Fault { role: MindRole::Concept, fault, found: found.to_string() };
    assert_eq!(take(fault(MindFault::Malformed, "rubbish")).0, PreflightVerdict::Ok, "it can still answer");
    let (verdict, found) = take(fault(MindFault::Ended, "exit code 2: no such file"));
    assert_eq!(verdict, PreflightVerdict::Failed);
    assert_eq!(found, "external concept has ended: exit code 2: no such file");
    assert_eq!(take(began).0, PreflightVerdict::Ok, "a continued recording starts it again");
}

#[test]
fn a_wizard_is_offered_what_a_program_names_with_its_reason() {
    let mut setup = files(60.0, ExternalMind::new("scripted"));
    setup.spec.trial.condition = Condition::Wizard;
    setup.spec.assistant.shadow = ShadowMode::On;
    let (_, events) = run_session(setup, &Scripted(first_signal));
    let offer = |event: &Event| if let Event::OfferOpened(offer) = event { Some(offer.clone()) } else { None };
    let offers: Vec<_> = events.iter().filter_map(offer).collect();
    assert!(!offers.is_empty());
    for offer in offers {
        assert_eq!((offer.worth, offer.words.as_deref()), (None, Some("it comes first")), "{:?}", offer.what);
        assert_eq!(offer.reason, None, "the program's words are the reason");
    }
}
