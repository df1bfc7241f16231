//! Command `tomcom replay RECORDING... --check-beliefs`: replays recordings for [`tomcom_study::analysis::belief_check`].

use std::path::{Path, PathBuf};
use std::sync::Arc;

use tomcom_core::kitchen::Kitchen;
use tomcom_core::measures::belief_detection::{EstimateBeforePress, TrialBeliefs, aspect_groups};
use tomcom_core::measures::flags::chosen_thresholds;
use tomcom_session::files::file_error::{FileError, FileResult};
use tomcom_session::replay::{RecordingReplay, SameKitchenCheck};
use tomcom_session::settings::ParticipantKind;
use tomcom_study::analysis::belief_check::{BeliefCheck, TrialBeliefCollector};
use tomcom_study::analysis::probe_figures::ProbeSummary;
use tomcom_study::analysis::probe_record::ProbeCollector;
use tomcom_study::analysis::probe_record::ProbedTrial;
use tomcom_study::gathered::GatheredRecordings;
use tomcom_study::parallel;

/// Checks the belief estimates of recordings in one kitchen. The thresholds for flagging false beliefs are chosen on
/// the recordings `choose_on`, which are not checked, or by cross-fitting if there are none. `done` is called after
/// each recording.
///
/// # Errors
/// A recording cannot be read or replayed; the recordings are of different kitchens; a recording, or a participant, is
/// both checked and in `choose_on`; the beliefs in `choose_on` are not known.
pub fn check(
    recordings: &GatheredRecordings,
    choose_on: &GatheredRecordings,
    done: impl Fn() + Sync,
) -> FileResult<BeliefCheck> {
    let all = recordings.beside(choose_on)?;
    let recordings = &recordings.paths;
    let BeliefCheckTrials { kitchen, mut trials, mut participants, probes } = views(&all, done)?;
    let other = trials.split_off(recordings.len());
    let others = participants.split_off(recordings.len());
    if let Some((code, recording)) = others.iter().zip(&choose_on.paths).find(|(code, _)| participants.contains(code)) {
        let found = format!("a recording of {code}, of whom a recording is checked, too");
        let remedy = "--choose-on with recordings of other participants".to_string();
        return Err(FileError::from_finding(recording, found, remedy));
    }
    let thresholds = match choose_on.paths.first() {
        None => None,
        Some(first) => Some(chosen_thresholds(&other, &aspect_groups(&kitchen)).ok_or_else(|| {
            let found =
                "recordings for the choice of thresholds, in which the participants' beliefs are not known".to_string();
            FileError::from_finding(first, found, "recordings of simulated participants".to_string())
        })?),
    };
    let checked = participants.iter().zip(&probes).filter_map(|(code, probed)| Some((code.as_str(), probed.as_ref()?)));
    let probes = ProbeSummary::from_trials(checked);
    Ok(BeliefCheck::from_trials(&kitchen, &trials, &participants, thresholds, probes))
}

/// Trials of one kitchen whose belief estimates are checked.
#[derive(Clone, Debug)]
pub struct BeliefCheckTrials {
    /// The kitchen that all trials share.
    pub kitchen: Arc<Kitchen>,
    /// The trials' presses with estimates, in the order of the recordings.
    pub trials: Vec<TrialBeliefs>,
    /// Code of the participant of each trial, with the seed in front if the participant is simulated.
    pub participants: Vec<String>,
    /// Freeze probes of each trial; `None` for trials without probes.
    pub probes: Vec<Option<ProbedTrial>>,
}

/// Replays recordings on all processors and collects their presses. `done` is called after each recording.
///
/// # Errors
/// The same errors as those of [`check`].
fn views(recordings: &[PathBuf], done: impl Fn() + Sync) -> FileResult<BeliefCheckTrials> {
    let results = parallel::each(recordings, |recording| view(recording), done);
    let (mut trials, mut participants, mut probes) = (Vec::new(), Vec::new(), Vec::new());
    let mut one_kitchen = SameKitchenCheck::default();
    for (result, recording) in results.into_iter().zip(recordings) {
        let RecordingView { kitchen, trial, participant, probed } = result?;
        one_kitchen.admit(recording, &kitchen)?;
        trials.push(trial);
        participants.push(participant);
        probes.push(probed);
    }
    Ok(BeliefCheckTrials { kitchen: one_kitchen.kitchen()?, trials, participants, probes })
}

/// What the check takes from one recording.
struct RecordingView {
    kitchen: Arc<Kitchen>,
    trial: TrialBeliefs,
    participant: String,
    probed: Option<ProbedTrial>,
}

/// The presses with estimates, and the freeze probes, of one recording.
fn view(recording: &Path) -> FileResult<RecordingView> {
    let mut replay = RecordingReplay::open(recording)?;
    let mut probes = ProbeCollector::default();
    let mut views = TrialBeliefCollector::default();
    while let Some(replayed) = replay.step()? {
        let (follower, seq) = (&replay.follower, replayed.stamped.seq);
        let judged = follower.judged.last().filter(|press| press.seq == seq);
        let estimated = follower.estimated.as_ref().filter(|one| one.press == seq);
        let estimate = estimated.map(|one| EstimateBeforePress::from_witness(&one.witness(&follower.session.kitchen)));
        probes.note(&replayed.stamped, &replayed.change, follower);
        views.add(&follower.session, judged, estimate, &replayed.stamped, &replayed.change);
    }
    let session = replay.session();
    let spec = &session.spec;
    // Simulated participants have the same codes for every seed, so the seed is added to the code.
    let participant = match spec.participant.kind {
        ParticipantKind::Simulated => format!("seed{}-{}", spec.seed, spec.participant.code),
        _ => spec.participant.code.clone(),
    };
    let probed = Some(probes.finish(session)).filter(ProbedTrial::is_any);
    Ok(RecordingView { kitchen: session.kitchen.clone(), trial: views.trial, participant, probed })
}
