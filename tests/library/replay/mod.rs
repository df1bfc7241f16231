//! Recordings: the same seed gives the same recording, a recording gives the same session, and what is broken is told.

mod assistants;
mod equality;
mod offers;
mod probes;
mod reading;
mod scenes;
mod winding;

use tomcom_core::communication::{HighlightSet, signals};

use crate::support::*;

/// One session for each kitchen.
const SESSIONS: [&str; 2] = ["default.toml", "burger.toml"];

/// A session file of the project, with an inference that is coarse and quick: what is held against each other here has the
/// same fineness.
fn session(name: &str) -> SessionSetup {
    let mut files = read_session(&Path::new("sessions").join(name)).expect("a session file of the project");
    let inference = &mut files.spec.human.inference;
    (inference.beliefs, inference.states, inference.max_beliefs) = (16, 8, 32);
    files
}

fn folder(name: &str) -> PathBuf {
    empty_folder(format!("replay/{name}"))
}

fn simulated(name: &str, arm: ArmKind, out: &str, trials: u64, seed: u64) -> PathBuf {
    let mut files = session(name);
    files.spec.robot.arm = arm;
    files.spec.seed = seed;
    files.spec.trial.seconds = 120.0;
    let out = folder(out);
    simulate_into(files, trials, &out);
    out
}

/// Whatever wizard, participant and tracker may do, as a seeded mess.
fn anything(kitchen: &Kitchen, random: &mut impl RngExt) -> Event {
    let signals = signals(kitchen, HighlightSet::ALL);
    let buttons = &kitchen.buttons[Agent::Human.index()];
    match random.random_range(0..40) {
        0 => Event::TrialPaused,
        1 | 2 => Event::TrialResumed,
        3 => Event::RobotStopped,
        4 | 5 => Event::RobotResumed,
        6 => Event::Marker { note: "note 1".to_string(), observer: None },
        7 => Event::SignalEnded { reason: SignalEndReason::TakenBack },
        8 => {
            let button = &kitchen.buttons[Agent::Robot.index()];
            let button = button[random.random_range(0..button.len())].name.clone();
            Event::RobotDriven { by: Sender::Wizard, button }
        }
        9 => match random.random_range(0..3) {
            0 => Event::RobotHeld { by: Sender::Wizard },
            1 => Event::RobotReleased { by: Sender::Wizard },
            _ => Event::RobotSkipped { by: Sender::Wizard },
        },
        10 => {
            let location = &kitchen.locations[random.random_range(0..kitchen.locations.len())];
            let content = &kitchen.contents[random.random_range(0..kitchen.contents.len())];
            Event::KitchenCorrected { location: location.name.clone(), content: content.name.clone() }
        }
        11..14 => {
            let (_, signal) = &signals[random.random_range(0..signals.len())];
            Event::SignalShown { by: Sender::Wizard, signal: signal.clone(), offer: None }
        }
        14..24 => {
            let [x, y, confidence] = [1.2, 1.2, 1.0].map(|scale| scale * random.random::<f64>());
            Event::Gaze(GazeSample::new(x, y, confidence))
        }
        _ => {
            let button = buttons[random.random_range(0..buttons.len())].name.clone();
            Event::Press { agent: Agent::Human, button, at_ns: None, button_box: false }
        }
    }
}

/// A session as somebody at keyboard and mouse might have it, recorded; with its log and the engine at its end.
fn by_hand(name: &str, arm: ArmKind, out: &str, seed: u64) -> (PathBuf, SessionEngine) {
    let mut files = session(name);
    files.spec.robot.arm = arm;
    files.spec.participant.kind = ParticipantKind::Keyboard;
    files.spec.participant.gaze = GazeSource::Mouse;
    files.spec.seed = seed;
    let kitchen = Arc::new(files.kitchen.kitchen);
    let header = LogHeader::new(files.spec.clone(), 0, files.kitchen.layout, files.kitchen.recipes);
    let mut log = LogWriter::create_live(&folder(out), "2026-03-14", &header).expect("the folder can be written");
    let mut engine = SessionEngine::new(kitchen.clone(), files.spec, 0, CostToGo::new(kitchen.clone()));
    let mut random = stream(seed, "hand", 0);
    let mut inputs = vec![(0.5, Event::TrialStarted)];
    inputs.extend((0..2000).map(|_| (random.random_range(0.0..0.4), anything(&kitchen, &mut random))));
    inputs.push((1.0, Event::TrialEnded { reason: TrialEndReason::Wizard }));
    inputs.push((1.0, Event::SessionEnded));
    let mut now_s = 0.0;
    for (after_s, event) in inputs {
        now_s += after_s;
        let outcome = engine.input(at(now_s), event);
        outcome.events.iter().for_each(|stamped| log.append(stamped).expect("the log can be written"));
    }
    (log.folder().join(LOG_NAME), engine)
}

/// The two files hold the same bytes.
fn same(a: &Path, b: &Path) {
    let [a_text, b_text] = [a, b].map(|path| fs::read(path).expect("a recording"));
    assert!(a_text == b_text, "{} and {} differ", a.display(), b.display());
}
