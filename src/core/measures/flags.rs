//! Flags: aspects whose predicted probability of a false belief reaches a threshold, and the false belief episodes that
//! flags detect in time.
//!
//! An episode counts if the false belief caused two or more errors; the episode is detected if its aspect is flagged
//! after the belief became false and before the third error (the estimate from before a press is before that press). A
//! false flag is a flag on an aspect that is believed right. There is one threshold for locations and one for recipes.
//! The chosen thresholds detect most episodes with at most [`MOST_FALSE_FLAGS`], and with aspects flagged at most
//! `MOST_WRONGLY_FLAGGED` of the time while the aspects are believed right; among equal thresholds, those with the
//! fewest false flags are chosen. Thresholds are evaluated on trials of other participants than those on whose trials the
//! thresholds were chosen: given thresholds on the trials that are named, else by cross-fitting, in which the trials of each
//! half of the participants are evaluated with the thresholds of the other half, and the counts are added. A participant's
//! trials are never in both halves, since the same person errs alike in all of them.

use serde::Serialize;

use super::detection::{BeliefsBeforePress, TrialBeliefs};

/// Largest share of (press, aspect) pairs with a right belief that may be flagged.
pub(crate) const MOST_WRONGLY_FLAGGED: f64 = 0.05;
/// Largest number of false flags (on aspects that are believed right) per `PER_PRESSES` presses of the human.
pub const MOST_FALSE_FLAGS: f64 = 0.7;
/// The unit of the rate of false flags, in presses of the human.
pub(crate) const PER_PRESSES: f64 = 20.0;
/// Least number of errors of a false belief episode that counts for detection.
const ERRORS: u32 = 2;
/// A false belief episode must be flagged before the error with this number to count as detected.
const BEFORE_ERROR: u32 = 3;
const CANDIDATES: usize = 200;

/// Predicted probability of a false belief from which on an aspect is flagged, for locations and for recipes.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct FlagThresholds {
    /// Flag threshold of the predicted probability for locations.
    pub locations: f64,
    /// Flag threshold of the predicted probability for recipes.
    pub recipes: f64,
}

/// How flag thresholds are chosen.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ThresholdChoice<'a> {
    /// These thresholds, which were chosen on recordings of other participants.
    Given(FlagThresholds),
    /// By cross-fitting; holds the index of the participant of each trial.
    CrossFitted(&'a [usize]),
}

/// The trials on which flag thresholds were chosen.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum ThresholdSource {
    /// Thresholds were chosen on other recordings than the evaluated ones.
    OtherRecordings,
    /// Cross-fitting: the trials of each half of the participants are evaluated with the thresholds of the other half.
    OtherHalf,
    /// Thresholds were chosen on the trials of the only participant, and are not evaluated: no other participant is there.
    OneParticipant,
}

/// Detections and false alarms of flags on aspects that are probably believed wrong.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct FlagPerformance {
    /// Number of false belief episodes with two or more errors.
    pub episodes: Option<u64>,
    /// Share of the false belief episodes with two or more errors that were flagged in time.
    pub flagged_before_third_error: Option<f64>,
    /// Number of flags on aspects that were believed right, per 20 presses of the human.
    pub false_flags_per_20_actions: Option<f64>,
    /// Share of (press, aspect) pairs with a right belief that were flagged.
    pub wrongly_flagged: Option<f64>,
    /// The flag thresholds; with [`ThresholdSource::OtherHalf`] the thresholds that all trials together give.
    pub thresholds: Option<FlagThresholds>,
    /// The trials on which the thresholds were chosen.
    pub thresholds_from: Option<ThresholdSource>,
}

/// The indices of the aspects that are locations, and of those that are recipes; each group has a flag threshold of its
/// own.
pub type AspectGroups = [Vec<usize>; 2];

/// A false belief episode about an aspect, as a range of presses.
struct Episode {
    trial: usize,
    aspect: usize,
    /// The presses before which a flag detects the episode in time.
    in_time: std::ops::RangeInclusive<usize>,
}

/// Numbers of detections and false flags.
#[derive(Clone, Copy, Debug, Default)]
struct FlagCounts {
    presses: usize,
    episodes: usize,
    caught: usize,
    false_flags: usize,
    wrongly: usize,
    right: usize,
}

impl FlagPerformance {
    /// Evaluates flags on trials, with thresholds that are chosen in this way. With one participant, the rates of
    /// cross-fitted thresholds are `None`.
    pub fn from_trials(trials: &[TrialBeliefs], groups: &AspectGroups, choice: ThresholdChoice) -> FlagPerformance {
        let all: Vec<&TrialBeliefs> = trials.iter().collect();
        if !is_known(&all) {
            return FlagPerformance::default();
        }
        let (thresholds, counts, from) = match choice {
            ThresholdChoice::Given(thresholds) => {
                let counts = FlagCounts::from_trials(&all, groups, thresholds);
                (thresholds, counts, ThresholdSource::OtherRecordings)
            }
            ThresholdChoice::CrossFitted(participants) => {
                let thresholds = best_thresholds(&all, groups);
                let Some(halves) = halves(trials, participants) else {
                    return FlagPerformance {
                        episodes: Some(FlagCounts::from_trials(&all, groups, thresholds).episodes as u64),
                        thresholds: Some(thresholds),
                        thresholds_from: Some(ThresholdSource::OneParticipant),
                        ..FlagPerformance::default()
                    };
                };
                let counts = [0, 1].map(|one| {
                    FlagCounts::from_trials(&halves[one], groups, best_thresholds(&halves[1 - one], groups))
                });
                (thresholds, counts[0].plus(counts[1]), ThresholdSource::OtherHalf)
            }
        };
        let share = |part: usize, all: usize| (all > 0).then(|| part as f64 / all as f64);
        FlagPerformance {
            episodes: Some(counts.episodes as u64),
            flagged_before_third_error: share(counts.caught, counts.episodes),
            false_flags_per_20_actions: share(counts.false_flags, counts.presses).map(|rate| PER_PRESSES * rate),
            wrongly_flagged: share(counts.wrongly, counts.right),
            thresholds: Some(thresholds),
            thresholds_from: Some(from),
        }
    }
}

impl FlagCounts {
    fn from_trials(trials: &[&TrialBeliefs], groups: &AspectGroups, thresholds: FlagThresholds) -> FlagCounts {
        let presses = trials.iter().map(|trial| trial.len()).sum();
        let mut counts = FlagCounts { presses, ..FlagCounts::default() };
        for (group, threshold) in groups.iter().zip([thresholds.locations, thresholds.recipes]) {
            let episodes: Vec<Episode> = group.iter().flat_map(|&aspect| harmful(trials, aspect)).collect();
            counts = counts.plus(FlagCounts::from_threshold(trials, group, &episodes, threshold));
        }
        counts
    }

    fn plus(self, other: FlagCounts) -> FlagCounts {
        FlagCounts {
            presses: self.presses + other.presses,
            episodes: self.episodes + other.episodes,
            caught: self.caught + other.caught,
            false_flags: self.false_flags + other.false_flags,
            wrongly: self.wrongly + other.wrongly,
            right: self.right + other.right,
        }
    }
}

/// The trials with presses in two halves of the participants, of whom every second one is in the other half; `None` with
/// fewer than two participants.
fn halves<'a>(trials: &'a [TrialBeliefs], participants: &[usize]) -> Option<[Vec<&'a TrialBeliefs>; 2]> {
    let with_presses = || trials.iter().zip(participants).filter(|(trial, _)| !trial.is_empty());
    let mut there: Vec<usize> = with_presses().map(|(_, &participant)| participant).collect();
    there.sort_unstable();
    there.dedup();
    let half = |parity: usize| -> Vec<&TrialBeliefs> {
        let is_in = |participant: usize| there.binary_search(&participant).is_ok_and(|rank| rank % 2 == parity);
        with_presses().filter(|&(_, &participant)| is_in(participant)).map(|(trial, _)| trial).collect()
    };
    (there.len() >= 2).then(|| [half(0), half(1)])
}

/// Whether beliefs and estimates are known before every press of the trials; false without presses.
fn is_known(trials: &[&TrialBeliefs]) -> bool {
    let mut presses = trials.iter().flat_map(|trial| trial.iter()).peekable();
    presses.peek().is_some() && presses.all(|press| press.held.is_some() && press.estimate.is_some())
}

/// The flag thresholds that are best on these trials; `None` if beliefs or estimates are not known.
pub fn chosen_thresholds(trials: &[TrialBeliefs], groups: &AspectGroups) -> Option<FlagThresholds> {
    let all: Vec<&TrialBeliefs> = trials.iter().collect();
    is_known(&all).then(|| best_thresholds(&all, groups))
}

/// The flag thresholds that detect most episodes within the allowed numbers of false flags.
fn best_thresholds(trials: &[&TrialBeliefs], groups: &AspectGroups) -> FlagThresholds {
    let presses: usize = trials.iter().map(|trial| trial.len()).sum();
    let wrongly = allowed_wrongly(trials, groups);
    let outcomes = groups.each_ref().map(|group| -> Vec<(f64, FlagCounts)> {
        let episodes: Vec<Episode> = group.iter().flat_map(|&aspect| harmful(trials, aspect)).collect();
        let tried = candidates(trials, group, wrongly).into_iter();
        tried.map(|one| (one, FlagCounts::from_threshold(trials, group, &episodes, one))).collect()
    });
    let false_flags = (MOST_FALSE_FLAGS * presses as f64 / PER_PRESSES) as usize;
    let best = best_pair(&outcomes[0], &outcomes[1], [false_flags, wrongly]);
    // If no pair of thresholds stays within the allowed numbers of false flags, nothing is flagged.
    best.unwrap_or(FlagThresholds { locations: f64::INFINITY, recipes: f64::INFINITY })
}

/// The thresholds with most detections within the allowed numbers of false flags and wrongly flagged pairs, from those
/// that were tried for locations and for recipes.
fn best_pair(
    locations: &[(f64, FlagCounts)],
    recipes: &[(f64, FlagCounts)],
    allowed: [usize; 2],
) -> Option<FlagThresholds> {
    let pairs = locations.iter().flat_map(|(locations, one)| {
        let with = move |(recipes, other): &(f64, FlagCounts)| {
            (FlagThresholds { locations: *locations, recipes: *recipes }, one.plus(*other))
        };
        recipes.iter().map(with)
    });
    let fitting = pairs.filter(|(_, both)| both.false_flags <= allowed[0] && both.wrongly <= allowed[1]);
    let best = fitting.max_by_key(|(_, both)| (both.caught, std::cmp::Reverse(both.false_flags)));
    best.map(|(thresholds, _)| thresholds)
}

/// Allowed number of flagged (press, aspect) pairs with a right belief.
fn allowed_wrongly(trials: &[&TrialBeliefs], groups: &AspectGroups) -> usize {
    let right = groups.iter().map(|group| while_right(trials, group).count()).sum::<usize>();
    (MOST_WRONGLY_FLAGGED * right as f64) as usize
}

/// Candidates for the flag threshold, the strictest first: thresholds that flag at most `allowed` pairs with a right
/// belief.
fn candidates(trials: &[&TrialBeliefs], group: &[usize], allowed: usize) -> Vec<f64> {
    let mut right: Vec<f64> = while_right(trials, group).collect();
    right.sort_by(|a, b| b.total_cmp(a));
    let allowed = allowed.min(right.len().saturating_sub(1));
    // A threshold just above the score at a rank flags at most as many pairs as the rank says, also with tied scores.
    let above = |index: usize| right.get(index).map(|p| p.next_up());
    let steps = CANDIDATES.min(allowed + 1);
    let mut tried: Vec<f64> =
        (0..steps).filter_map(|step| above(step * allowed / steps.max(2).saturating_sub(1))).collect();
    tried.dedup();
    if tried.is_empty() { vec![0.0] } else { tried }
}

/// The predicted probability of a false belief by which an aspect is flagged: without an estimate it never is.
fn score(press: &BeliefsBeforePress, aspect: usize) -> f64 {
    press.p_false(aspect).unwrap_or(0.0)
}

/// Predicted probabilities of a false belief of all (press, aspect) pairs with a right belief.
fn while_right<'a>(trials: &'a [&'a TrialBeliefs], group: &'a [usize]) -> impl Iterator<Item = f64> + 'a {
    let is_right = |press: &BeliefsBeforePress, aspect: usize| press.is_wrong(aspect) == Some(false);
    trials.iter().flat_map(|trial| trial.iter()).flat_map(move |press| {
        group.iter().filter(move |&&aspect| is_right(press, aspect)).map(move |&aspect| score(press, aspect))
    })
}

/// The false belief episodes of an aspect that caused enough errors to count.
fn harmful(trials: &[&TrialBeliefs], aspect: usize) -> Vec<Episode> {
    let mut episodes = Vec::new();
    for (trial, presses) in trials.iter().enumerate() {
        let mut at = 0;
        for run in presses.chunk_by(|a, b| a.is_wrong(aspect) == b.is_wrong(aspect)) {
            let first = at;
            at += run.len();
            if run[0].is_wrong(aspect) != Some(true) {
                continue;
            }
            let errors: Vec<usize> = (first..at)
                .filter(|&index| presses[index].errs_about.iter().any(|about| about.index() == aspect))
                .collect();
            if errors.len() as u32 >= ERRORS {
                let last = errors.get(BEFORE_ERROR as usize - 1).copied().unwrap_or(at - 1);
                episodes.push(Episode { trial, aspect, in_time: first..=last });
            }
        }
    }
    episodes
}

impl FlagCounts {
    /// What one threshold gives in one group of aspects, without the number of presses.
    fn from_threshold(trials: &[&TrialBeliefs], group: &[usize], episodes: &[Episode], threshold: f64) -> FlagCounts {
        let is_flagged = |press: &BeliefsBeforePress, aspect: usize| score(press, aspect) >= threshold;
        let is_caught = |episode: &&Episode| {
            trials[episode.trial][episode.in_time.clone()].iter().any(|press| is_flagged(press, episode.aspect))
        };
        let caught = episodes.iter().filter(is_caught).count();
        let mut outcome = FlagCounts { episodes: episodes.len(), caught, ..FlagCounts::default() };
        for presses in trials {
            for &aspect in group {
                let mut before = false;
                for press in presses.iter() {
                    let flagged = is_flagged(press, aspect);
                    if press.is_wrong(aspect) == Some(false) {
                        outcome.right += 1;
                        outcome.wrongly += usize::from(flagged);
                        outcome.false_flags += usize::from(flagged && !before);
                    }
                    before = flagged;
                }
            }
        }
        outcome
    }
}
