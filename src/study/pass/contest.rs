//! One recording of a tournament: its figures, and how well assistant and external concept know the participant's beliefs.

use std::collections::VecDeque;
use std::path::Path;

use crate::analysis::trial_summary::TrialSummary;
use crate::kept_cost::KeptCost;
use crate::pass::sweep::useful_signals;
use crate::statistics::mean;
use tomcom_core::kitchen::Kitchen;
use tomcom_core::measures::detection::{CALIBRATED, CALIBRATION_BINS, Calibration, EstimateBeforePress};
use tomcom_core::measures::detection::{aspect_groups, auc};
use tomcom_core::measures::sequences::FALSE_BELOW;
use tomcom_session::Event;
use tomcom_session::external::{MindRole, told_truth};
use tomcom_session::files::file_error::FileResult;
use tomcom_session::log::LogReader;
use tomcom_session::replay::RecordingReplay;

/// Probabilities that the participant's beliefs are false, each with whether the belief was false, by state aspect.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct BeliefScores(Vec<(usize, f64, bool)>);

impl BeliefScores {
    fn add(&mut self, p_false: impl IntoIterator<Item = Option<f64>>, held: &[f64]) {
        let told = p_false.into_iter().zip(held).enumerate();
        self.0.extend(told.filter_map(|(aspect, (p_false, held))| Some((aspect, p_false?, *held < FALSE_BELOW))));
    }

    /// Area under the ROC curve, the mean of locations and recipes; and expected calibration error: as of the belief
    /// estimate.
    pub fn scored<'a>(kitchen: &Kitchen, trials: impl Iterator<Item = &'a BeliefScores>) -> (Option<f64>, Option<f64>) {
        let all: Vec<(usize, f64, bool)> = trials.flat_map(|trial| trial.0.iter().copied()).collect();
        let of = |group: &Vec<usize>| {
            let scores = all.iter().filter(|(aspect, ..)| group.contains(aspect));
            auc(&scores.map(|&(_, p_false, is_false)| (p_false, is_false)).collect::<Vec<_>>())
        };
        let area = mean(aspect_groups(kitchen).iter().filter_map(of));
        let predictions = all.iter().map(|&(_, p_false, is_false)| (p_false, is_false));
        (area, Calibration::from_predictions(predictions, CALIBRATED, CALIBRATION_BINS).ece)
    }
}

/// What a tournament needs of a recording.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ContestTrial {
    pub summary: TrialSummary,
    /// Presses that errors cost.
    pub lost: i64,
    /// `None` if not judged.
    pub useful: Option<u64>,
    /// How the external concept introduced itself.
    pub name: Option<String>,
    pub faults: u64,
    pub late: u64,
    /// Of the program's estimate.
    pub own: BeliefScores,
    /// Of the external concept.
    pub told: BeliefScores,
    /// Why the trial was aborted.
    pub failed: Option<String>,
}

/// Reads a recording. `useful`: the number of useful signals, if it is known; else it is found out, which takes about as
/// long as the simulation.
pub fn read(recording: &Path, useful: Option<u64>, kept: &mut KeptCost) -> FileResult<ContestTrial> {
    let log = LogReader::open(recording)?;
    let kitchen = log.kitchen.clone();
    let mut replay = RecordingReplay::over(log, kept.take(&kitchen));
    // The log has the estimates.
    replay.follower = replay.follower.without_estimate();
    let (mut found, mut estimates) = (ContestTrial::default(), VecDeque::new());
    let (mut held, mut pressed): (Option<Vec<f64>>, Option<Vec<Option<f64>>>) = (None, None);
    while let Some(replayed) = replay.step()? {
        if let Some(press) = replayed.change.human_press() {
            let told = replay.session().external.beliefs.get(&MindRole::Concept);
            pressed = told.map(|told| told_truth(&kitchen, press.before, told));
        }
        match &replayed.stamped.event {
            Event::ParticipantBelieves(witness) => {
                held = Some(witness.aspects.iter().map(|aspect| aspect.p_truth).collect());
            }
            Event::BeliefEstimated(witness) => {
                estimates.push_back(witness.clone());
                let Some(held) = held.take() else { continue };
                found.own.add(EstimateBeforePress::from_witness(witness).p_false.into_iter().map(Some), &held);
                if let Some(told) = pressed.take() {
                    found.told.add(told.into_iter().map(|truth| truth.map(|truth| 1.0 - truth)), &held);
                }
            }
            _ => {}
        }
    }
    let follower = replay.follower;
    found.summary = TrialSummary::from_follower(&follower);
    found.lost = follower.judged.iter().map(|press| i64::from(press.verdict.regret.max(0))).sum();
    let external = &follower.session.external;
    (found.name, found.faults, found.late) =
        (external.names.get(&MindRole::Concept).cloned(), external.faults, external.late);
    found.failed = follower.session.aborted.clone();
    kept.keep(&kitchen, follower.cost);
    found.useful = match (useful, found.summary.signals) {
        _ if found.failed.is_some() => None,
        (None, 0) => Some(0),
        (Some(useful), _) => Some(useful),
        (None, _) => useful_signals(recording, estimates, kept.take(&kitchen))?,
    };
    Ok(found)
}
