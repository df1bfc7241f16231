//! Command `tomcom tournament`: simulates the same trials with several communication concepts, and compares them.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use sha2::{Digest, Sha256};

use super::clock::monotonic_ns;
use tomcom_core::communication::concept::ConceptName;
use tomcom_core::communication::settings::{ConceptSpec, ShadowMode};
use tomcom_devices::external::LocalMinds;
use tomcom_session::files::SessionSetup;
use tomcom_session::headless::{AdviceTime, Outside, SimulationShard};
use tomcom_session::log::RecordingError;
use tomcom_session::settings::Condition;
use tomcom_study::files::simulated_trials::{SimulationRequest, each_trial};
use tomcom_study::files::tournament_files::{keep, kept};
use tomcom_study::kept_cost::KeptCost;
use tomcom_study::parallel;
use tomcom_study::pass::contest;
use tomcom_study::tournament::{Contestant, KeptFigures, Tournament};

/// What a tournament simulates.
#[derive(Clone, Debug)]
pub struct TournamentRequest {
    /// Settings of the session, without a plan.
    pub files: SessionSetup,
    /// The concepts, each once.
    pub concepts: Vec<ConceptSpec>,
    pub trials: u64,
    pub shard: SimulationShard,
    /// Folder of the recordings, with a folder for each concept.
    pub out: PathBuf,
}

/// Longest part of a command line in the name of a folder, in characters.
const LONGEST_NAME: usize = 60;

/// The folder of a concept's recordings: its label without what a file name cannot have.
fn folder_name(concept: &ConceptSpec) -> String {
    let plain = |letter: char| if letter.is_ascii_alphanumeric() { letter } else { '-' };
    let mut name: String = concept.label().chars().map(plain).collect();
    if name.len() > LONGEST_NAME {
        // All of a long command line is in its checksum.
        let digest: String = Sha256::digest(concept.label()).iter().take(4).map(|byte| format!("{byte:02x}")).collect();
        name = format!("{}-{digest}", &name[..LONGEST_NAME]);
    }
    match concept {
        ConceptSpec::Own(_) => name,
        ConceptSpec::External(_) => format!("external-{}", name.trim_matches('-')),
    }
}

impl TournamentRequest {
    /// Two concepts whose recordings would be in one folder.
    pub fn twice(&self) -> Option<&ConceptSpec> {
        let names: Vec<String> = self.concepts.iter().map(folder_name).collect();
        (0..names.len()).find(|&index| names[..index].contains(&names[index])).map(|index| &self.concepts[index])
    }

    /// The concepts that are simulated: the unassisted trials are the reference of every difference.
    fn simulated(&self) -> Vec<ConceptSpec> {
        let none = ConceptSpec::Own(ConceptName::None);
        let others = self.concepts.iter().filter(|concept| **concept != none).cloned();
        [none.clone()].into_iter().chain(others).collect()
    }

    /// Steps of work: each trial is simulated and read.
    pub fn steps(&self) -> u64 {
        2 * self.simulated().len() as u64
            * self.simulation(&ConceptSpec::Own(ConceptName::None)).own_trials().count() as u64
    }

    fn simulation(&self, concept: &ConceptSpec) -> SimulationRequest {
        let mut files = self.files.clone();
        let spec = &mut files.spec;
        spec.trial.condition = match concept.name() {
            ConceptName::None => Condition::None,
            _ => Condition::Assistant,
        };
        (spec.assistant.concept, spec.assistant.shadow) = (concept.clone(), ShadowMode::Off);
        SimulationRequest { files, trials: self.trials, shard: self.shard, out: self.out.join(folder_name(concept)) }
    }

    /// Simulates the trials of a concept that have no recording yet, and reads them all.
    fn contestant(&self, concept: &ConceptSpec, done: &(impl Fn() + Sync)) -> Result<Contestant, RecordingError> {
        let outside = Outside { minds: &LocalMinds, now_ns: monotonic_ns };
        let (mut recordings, mut found): (Vec<(PathBuf, Option<AdviceTime>)>, u64) = (Vec::new(), 0);
        each_trial(&self.simulation(concept), outside, done, |trial| {
            recordings.push((trial.folder, trial.advice));
            found += u64::from(trial.found);
            Ok(())
        })?;
        let read = |cost: &mut KeptCost, (folder, advice): &(PathBuf, Option<AdviceTime>)| read(folder, *advice, cost);
        let trials = parallel::each_with(&recordings, KeptCost::default, read, done);
        let trials = trials.into_iter().collect::<Result<Vec<_>, RecordingError>>()?;
        Ok(Contestant { label: concept.label().to_string(), trials, found })
    }
}

/// Reads a recording, and keeps beside it what its log does not have. `advice`: the computing time, if it was simulated just
/// now.
fn read(
    folder: &Path,
    advice: Option<AdviceTime>,
    cost: &mut KeptCost,
) -> Result<(contest::ContestTrial, Option<KeptFigures>), RecordingError> {
    let before = kept(folder).filter(|_| advice.is_none());
    let trial = contest::read(folder, before.and_then(|kept| kept.useful_signals), cost)?;
    let (questions, computing_ns) = match (advice, before) {
        (Some(advice), _) => (advice.questions, advice.total_ns),
        (None, Some(kept)) => (kept.questions, kept.computing_ns),
        // A run was cut off between the simulation and here: the computing time is lost.
        (None, None) => (0, 0),
    };
    let figures = KeptFigures { questions, computing_ns, useful_signals: trial.useful };
    if before != Some(figures) {
        keep(folder, &figures)?;
    }
    Ok((trial, Some(figures)))
}

/// Simulates the trials of all concepts on all processors, and compares them. Trials whose complete recordings exist are read
/// instead. `done` is called after each step.
///
/// # Errors
/// A recording cannot be written or read, or its folder holds another recording.
pub fn run(request: &TournamentRequest, done: impl Fn() + Sync) -> Result<Tournament, RecordingError> {
    let all = request.simulated();
    let contestants = all.iter().map(|concept| request.contestant(concept, &done));
    let contestants = contestants.collect::<Result<Vec<Contestant>, RecordingError>>()?;
    let shown: Vec<Contestant> = contestants
        .iter()
        .zip(&all)
        .filter(|(_, concept)| request.concepts.contains(concept))
        .map(|(contestant, _)| contestant.clone())
        .collect();
    let kitchen = Arc::new(request.files.kitchen.kitchen.clone());
    Ok(Tournament::new(request.files.spec.seed, &shown, &contestants[0], &kitchen))
}
