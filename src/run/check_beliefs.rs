//! `tomcom replay RECORDING... --check-beliefs`: replays recordings for [`crate::analysis::belief_check`].

use std::path::{Path, PathBuf};
use std::sync::Arc;

use super::parallel;
use super::replay::{Replay, SameKitchen, each_once};
use crate::analysis::belief_check::{BeliefCheck, PressViews};
use crate::edge::file_error::FileResult;
use crate::kitchen::Kitchen;
use crate::measures::belief_detection::TrialView;
use crate::measures::flags::Thresholds;

/// Checks the pooled recordings of one kitchen. `done` is called after each recording.
///
/// # Errors
/// A recording that cannot be read or applied, or one of another kitchen.
pub fn check(
    recordings: &[PathBuf],
    thresholds: Option<Thresholds>,
    done: impl Fn() + Sync,
) -> FileResult<BeliefCheck> {
    let BeliefCheckTrials { kitchen, trials } = views(recordings, done)?;
    Ok(BeliefCheck::from_trials(&kitchen, &trials, thresholds))
}

/// Recorded trials of one kitchen.
#[derive(Clone, Debug)]
pub struct BeliefCheckTrials {
    /// The kitchen of all these trials.
    pub kitchen: Arc<Kitchen>,
    /// Trials in the order of the recordings.
    pub trials: Vec<TrialView>,
}

/// Replays recordings on all processors and collects their presses. `done` is called after each recording.
///
/// # Errors
/// Errors of [`check`].
pub fn views(recordings: &[PathBuf], done: impl Fn() + Sync) -> FileResult<BeliefCheckTrials> {
    each_once(recordings)?;
    let results = parallel::each(recordings, |recording| view(recording), done);
    let (mut one_kitchen, mut trials) = (SameKitchen::default(), Vec::new());
    for (result, recording) in results.into_iter().zip(recordings) {
        let (kitchen, trial) = result?;
        one_kitchen.admit(recording, &kitchen)?;
        trials.push(trial);
    }
    Ok(BeliefCheckTrials { kitchen: one_kitchen.kitchen()?, trials })
}

/// The presses of one recording.
fn view(recording: &Path) -> FileResult<(Arc<Kitchen>, TrialView)> {
    let mut replay = Replay::open(recording)?;
    let mut views = PressViews::default();
    while let Some(replayed) = replay.step()? {
        views.add(&replay.follower, &replayed.stamped, &replayed.change);
    }
    Ok((replay.session().kitchen.clone(), views.trial))
}
