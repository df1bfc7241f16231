//! What most tests of the library need: the names that they share, session files, folders, recordings and snapshots.

pub use std::collections::{BTreeMap, BTreeSet};
pub use std::fs;
pub use std::path::{Path, PathBuf};
pub use std::sync::Arc;

pub use rand::RngExt;
pub use serde_json::{Value, json};
use tomcom::console::view::theme::{TerminalBackground, Theme};
use tomcom::console::{ConsoleModel, KeyBindings, KeyFileBindings};
use tomcom::run::files::read_kitchen;
pub use tomcom::run::files::read_session;
pub use tomcom::run::simulate::{SimulationRequest, simulate};
pub use tomcom_core::base::rng::stream;
pub use tomcom_core::base::time::SessionTime;
pub use tomcom_core::communication::concept::ConceptName;
pub use tomcom_core::communication::settings::ShadowMode;
pub use tomcom_core::communication::{Sender, Signal};
pub use tomcom_core::gaze::GazeSample;
pub use tomcom_core::kitchen::cost_to_go::CostToGo;
pub use tomcom_core::kitchen::{
    Agent, AspectId, AspectKind, ButtonId, DishId, Kitchen, LocationId, OrderContent, State,
};
pub use tomcom_session::engine::SessionEngine;
pub use tomcom_session::event::{SignalEndReason, TrialEndReason};
pub use tomcom_session::files::SessionSetup;
pub use tomcom_session::headless::SimulationShard;
pub use tomcom_session::log::{LOG_NAME, LogReader, LogWriter};
pub use tomcom_session::plan::WantedRecording;
pub use tomcom_session::probes::ProbeEvent;
pub use tomcom_session::protocol::ProtocolEvent;
pub use tomcom_session::replay::RecordingReplay;
pub use tomcom_session::settings::{ArmKind, Condition, GazeSource, ParticipantKind, WizardVisibility};
pub use tomcom_session::study_arm::StudyArm;
pub use tomcom_session::verify::verify;
pub use tomcom_session::wall_display::AnswerDevice;
pub use tomcom_session::{Event, LogHeader, Session, SessionSpec, TimestampedEvent, TrialPhase};

/// The kitchen of one of the layouts in `layouts`.
pub fn kitchen(name: &str) -> Arc<Kitchen> {
    match read_kitchen(Path::new(&format!("layouts/{name}.toml"))) {
        Ok(files) => Arc::new(files.kitchen),
        Err(error) => panic!("{error}"),
    }
}

/// One of the session files in `sessions`.
pub fn session_file(name: &str) -> SessionSetup {
    read_session(Path::new(&format!("sessions/{name}.toml"))).unwrap_or_else(|error| panic!("{error}"))
}

/// The settings of a session file that says nothing but its layout.
pub fn default_settings() -> SessionSpec {
    toml::from_str("layout = \"\"").expect("the settings have defaults")
}

/// The engine of a trial of a session.
pub fn engine_of(files: SessionSetup, trial: u64) -> SessionEngine {
    let kitchen = Arc::new(files.kitchen.kitchen);
    SessionEngine::new(kitchen.clone(), files.spec, trial, CostToGo::new(kitchen))
}

/// A live recording of a trial in this folder, and its engine.
pub fn live_recording(files: SessionSetup, trial: u64, out: &Path) -> (LogWriter, SessionEngine) {
    let (layout, recipes) = (files.kitchen.layout.clone(), files.kitchen.recipes.clone());
    let mut header = LogHeader::new(files.spec.clone(), trial, layout, recipes);
    header.started = Some("2026-03-14T09:00:00.000Z".to_string());
    let log = LogWriter::create_live(out, "2026-03-14", &header).expect("the folder can be written");
    (log, engine_of(files, trial))
}

pub fn at(seconds: f64) -> SessionTime {
    SessionTime::from_secs_f64(seconds)
}

/// The console of a session, with colours and all signs on a dark ground.
pub fn console_model(kitchen: &Kitchen, spec: &SessionSpec, size: (u16, u16)) -> ConsoleModel {
    let keys = KeyBindings::live(kitchen, spec, &KeyFileBindings::default()).expect("the layout's keys are free");
    ConsoleModel::new(keys, Theme { colour: true, unicode: true, ground: TerminalBackground::Dark }, size)
}

/// An empty folder for a test.
pub fn empty_folder(path: impl AsRef<Path>) -> PathBuf {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join(path);
    let _ = fs::remove_dir_all(&folder);
    fs::create_dir_all(&folder).expect("a folder");
    folder
}

/// Simulates trials of a session into a folder; their recordings.
pub fn simulate_into(files: SessionSetup, trials: u64, out: &Path) -> Vec<PathBuf> {
    let request = SimulationRequest { files, trials, shard: SimulationShard::WHOLE, out: out.to_path_buf() };
    let made = simulate(&request, || ()).expect("the folder can be written");
    made.recordings.iter().map(PathBuf::from).collect()
}

/// The only recording in a folder.
pub fn only_recording(folder: &Path) -> PathBuf {
    fs::read_dir(folder).expect("a folder").next().expect("a recording").expect("an entry").path()
}

/// Holds a text against `tests/snapshots/THEME__NAME.snap`.
pub fn check_snapshot(theme: &str, name: impl std::fmt::Display, text: impl std::fmt::Display) {
    let mut settings = insta::Settings::clone_current();
    settings.set_snapshot_path("../snapshots");
    settings.set_prepend_module_to_snapshot(false);
    settings.set_omit_expression(true);
    settings.bind(|| insta::assert_snapshot!(format!("{theme}__{name}"), text.to_string()));
}
