//! `tomcom simulate`: whole trials in virtual time, each independent of how many there are.

use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Arc, Mutex};
use std::time::Instant;

use super::engine::Engine;
use super::figures::{SimulationFigures, TrialFigures};
use super::follower::Follower;
use super::{headless, kitchen, options};
use crate::base::words::count;
use crate::communication::settings::Shadow;
use crate::edge::files::{FileError, SessionFiles};
use crate::edge::log::{LogWriter, WriteError, check_simulated, ruling};
use crate::kitchen::Kitchen;
use crate::kitchen::cost_to_go::CostToGo;
use crate::session::settings::{Condition, ParticipantSpec, SessionSpec};
use crate::session::{Header, Stamped};

/// Why trials could not be simulated.
#[derive(Debug, thiserror::Error, miette::Diagnostic)]
pub enum SimulateError {
    #[error(transparent)]
    #[diagnostic(transparent)]
    File(#[from] Box<FileError>),
    #[error(transparent)]
    #[diagnostic(transparent)]
    Recording(#[from] WriteError),
}

/// What to simulate.
#[derive(Clone, Debug)]
pub struct Simulation {
    pub files: SessionFiles,
    pub trials: u64,
    /// Where the recordings go.
    pub out: PathBuf,
}

/// The settings of a simulated trial without a plan. No wizard is there, so without the assistant it is
/// unassisted; every trial has a participant of its own, with a code of its own.
pub fn settings_of_trial(spec: &SessionSpec, trial: u64) -> SessionSpec {
    let mut spec = spec.clone();
    if spec.trial.condition == Condition::Wizard {
        // Whose shadow the assistant would be.
        (spec.trial.condition, spec.assistant.shadow) = (Condition::None, Shadow::Off);
    }
    spec.participant.code = format!("S{:03}", trial + 1);
    spec
}

/// Simulates the trials on all processors. `done` is called after each trial.
///
/// # Errors
/// A recording that could not be written, another one where it would be, or one with a broken file about its exclusion.
pub fn simulate(simulation: &Simulation, done: impl Fn() + Sync) -> Result<SimulationFigures, SimulateError> {
    let began = Instant::now();
    // Before the first trial, so that none is simulated in vain.
    for trial in 0..simulation.trials {
        let header = header_of_trial(simulation, trial);
        check_simulated(&folder_of_trial(&simulation.out, &header.session), &header)?;
    }
    let kitchen = Arc::new(simulation.files.kitchen.kitchen.clone());
    let mut cost = CostToGo::new(kitchen.clone());
    let plan_lengths = kitchen::plan_lengths(&kitchen, &mut cost);
    let next = AtomicU64::new(0);
    let results = Mutex::new(Vec::new());
    let work = |mut cost: CostToGo| {
        loop {
            let trial = next.fetch_add(1, Ordering::Relaxed);
            if trial >= simulation.trials {
                return;
            }
            let (result, used) = match simulate_trial(simulation, &kitchen, trial, cost) {
                Ok((folder, figures, cost)) => (Ok((folder, figures)), Some(cost)),
                Err(error) => (Err(error), None),
            };
            results.lock().unwrap_or_else(|poisoned| poisoned.into_inner()).push((trial, result));
            done();
            let Some(used) = used else { return };
            cost = used;
        }
    };
    let threads = std::thread::available_parallelism().map_or(1, |count| count.get()).min(simulation.trials as usize);
    std::thread::scope(|scope| {
        for _ in 0..threads.max(1) {
            let cost = cost.clone();
            scope.spawn(|| work(cost));
        }
    });
    let mut results = results.into_inner().unwrap_or_else(|poisoned| poisoned.into_inner());
    results.sort_by_key(|(trial, _)| *trial);
    let results: Vec<(PathBuf, TrialFigures)> =
        results.into_iter().map(|(_, result)| result).collect::<Result<_, WriteError>>()?;
    let folders: Vec<PathBuf> = results.iter().map(|(folder, _)| folder.clone()).collect();
    // The same recording may have been made and excluded before.
    let mut trials = Vec::new();
    for (folder, trial) in results {
        if ruling(&folder).map_err(Box::new)?.is_none_or(|ruling| !ruling.excluded) {
            trials.push(trial);
        }
    }
    let mut figures = SimulationFigures::of(&trials, &plan_lengths);
    figures.excluded = (folders.len() - trials.len()) as u64;
    figures.recordings = folders.iter().map(|folder| folder.display().to_string()).collect();
    figures.wall_s = began.elapsed().as_secs_f64();
    Ok(figures)
}

/// A recording to train a wizard with, of the default kitchen: an unassisted trial of so many seconds, in a folder that is
/// named after them.
///
/// # Errors
/// Those of [`simulate`].
pub fn for_training(seed: u64, seconds: f64, out: &Path) -> Result<Vec<PathBuf>, SimulateError> {
    let mut files = options::session_or_default(None).map_err(Box::new)?;
    (files.spec.plan, files.spec.seed) = (None, seed);
    (files.spec.trial.condition, files.spec.assistant.shadow) = (Condition::None, Shadow::Off);
    (files.spec.trial.seconds, files.spec.trial.orders) = (seconds, None);
    files.spec.participant = ParticipantSpec::default();
    files.spec.check().map_err(|error| {
        Box::new(FileError::at(Path::new("--seconds"), "", None, error.found, error.remedy.to_string()))
    })?;
    // What differs in length is another recording.
    let out = out.join(format!("{seconds}s"));
    let figures = simulate(&Simulation { files, trials: 1, out }, || ())?;
    Ok(figures.recordings.iter().map(PathBuf::from).collect())
}

/// Where the recording of a trial goes; the name does not depend on how many trials there are.
fn folder_of_trial(out: &Path, spec: &SessionSpec) -> PathBuf {
    let period = spec.step.as_ref().and_then(|step| step.period);
    let period = period.map_or(String::new(), |period| format!("-{period}"));
    out.join(format!("seed{}-{}{period}", spec.seed, spec.participant.code))
}

/// The header of a trial: of a plan the trials participant by participant, else each of a participant of its own.
fn header_of_trial(simulation: &Simulation, trial: u64) -> Header {
    let files = &simulation.files.kitchen;
    let (spec, trial) = match simulation.files.study() {
        None => (settings_of_trial(&simulation.files.spec, trial), trial),
        Some(study) => {
            let periods = study.plan.conditions.len() as u64;
            study.simulated((trial / periods) as usize, (trial % periods) as u32 + 1)
        }
    };
    Header::new(spec, trial, files.layout.clone(), files.recipes.clone())
}

fn simulate_trial(
    simulation: &Simulation,
    kitchen: &Arc<Kitchen>,
    trial: u64,
    cost: CostToGo,
) -> Result<(PathBuf, TrialFigures, CostToGo), WriteError> {
    let header = header_of_trial(simulation, trial);
    let folder = folder_of_trial(&simulation.out, &header.session);
    let mut log = LogWriter::create_simulated(&folder, &header)?;
    let mut engine = Engine::new(kitchen.clone(), header.session, header.trial, cost);
    headless::run(&mut engine, |stamped: &Stamped| log.append(stamped))?;
    log.flush()?;
    let follower: Follower = engine.into_follower();
    Ok((folder, TrialFigures::of(&follower), follower.cost))
}

/// The figures for people.
pub fn describe(figures: &SimulationFigures) -> String {
    let each = match (figures.presses_per_order, figures.optimal_presses_per_order) {
        (Some(presses), Some(best)) => format!(", {presses:.1} presses each in the median (at best {best:.1})"),
        _ => String::new(),
    };
    let excluded = match figures.excluded {
        0 => String::new(),
        some => format!("{} excluded, and left out of these figures\n", count(some, "recording is", "recordings are")),
    };
    let share = 100.0 * figures.errors as f64 / figures.human_actions.max(1) as f64;
    format!(
        "{} of simulated participants, {:.0} s simulated in {:.1} s\n\
         presses: {} of the human, {} of the robot\n\
         errors: {} ({share:.1} % of the human's presses)\n\
         {}\n\
         orders served: {}{each}\n\
         {excluded}\
         recordings:\n{}\n",
        count(figures.trials, "trial", "trials"),
        figures.simulated_s,
        figures.wall_s,
        figures.human_actions,
        figures.robot_actions,
        figures.errors,
        figures.beliefs.describe(figures.errors),
        figures.orders_served,
        figures.recordings.iter().map(|path| format!("  {path}")).collect::<Vec<_>>().join("\n"),
    )
}
