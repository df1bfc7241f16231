//! Flags: aspects whose estimated probability of a false belief exceeds a threshold, and the false belief episodes that flags
//! detect in time.
//!
//! An episode counts if it caused two or more errors; it is caught if its aspect is flagged after it became false and
//! before the third error (the estimate from before a press is before that press). A false flag is one that is raised on an
//! aspect that is believed right. There is one threshold for locations and one for recipes. Unless they are given, those
//! are taken that catch most, with at most [`MOST_FALSE_FLAGS`], and aspects flagged at most [`MOST_WRONGLY_FLAGGED`] of the
//! time while they are believed right; of equals those with the fewest false flags.

use serde::Serialize;

use super::press_view::{PressView, TrialView};

/// Largest share of (press, aspect) pairs with a right belief that may be flagged.
pub const MOST_WRONGLY_FLAGGED: f64 = 0.05;
/// Largest number of false flags per [`PER_PRESSES`] presses of the human.
pub const MOST_FALSE_FLAGS: f64 = 0.7;
/// The unit of the rate of false flags, in presses of the human.
pub const PER_PRESSES: f64 = 20.0;
/// Least number of errors of an episode that counts.
const ERRORS: u32 = 2;
/// An episode must be flagged before this error to count as detected.
const BEFORE_ERROR: u32 = 3;
/// Number of thresholds that are tried for each group.
const CANDIDATES: usize = 200;

/// Probabilities of a false belief from which an aspect is flagged.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Thresholds {
    /// The threshold for locations, as a probability.
    pub locations: f64,
    /// The threshold for recipes, as a probability.
    pub recipes: f64,
}

/// Detections and false alarms of flags.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Flags {
    /// Number of false belief episodes with two or more errors.
    pub episodes: Option<u64>,
    /// Share of these episodes that were flagged in time.
    pub flagged_before_third_error: Option<f64>,
    /// Flags on aspects that were believed right, per 20 presses of the human.
    pub false_flags_per_20_actions: Option<f64>,
    /// Share of (press, aspect) pairs with a right belief that were flagged.
    pub wrongly_flagged: Option<f64>,
    /// The thresholds at which all this holds.
    pub thresholds: Option<Thresholds>,
}

/// A period of false belief about an aspect, as a range of presses.
struct Episode {
    trial: usize,
    aspect: usize,
    /// The presses before which a flag is in time.
    in_time: std::ops::RangeInclusive<usize>,
}

/// Result of one threshold for one group.
#[derive(Clone, Copy, Debug, Default)]
struct Outcome {
    threshold: f64,
    caught: usize,
    false_flags: usize,
    wrongly: usize,
    right: usize,
}

impl Flags {
    /// Evaluates flags on trials. `groups` holds the aspects of locations and those of recipes.
    pub fn from_trials(trials: &[TrialView], groups: &[Vec<usize>; 2], thresholds: Option<Thresholds>) -> Flags {
        let presses: Vec<&PressView> = trials.iter().flatten().collect();
        if presses.is_empty() || presses.iter().any(|press| press.held.is_none() || press.estimate.is_none()) {
            return Flags::default();
        }
        let given = thresholds.map(|given| [given.locations, given.recipes]);
        let wrongly = given.map_or_else(|| allowed_wrongly(trials, groups), |_| usize::MAX);
        let (mut episodes, mut outcomes) = (Vec::new(), Vec::new());
        for (index, group) in groups.iter().enumerate() {
            let of_group: Vec<Episode> = group.iter().flat_map(|&aspect| harmful(trials, aspect)).collect();
            let tried = given.map_or_else(|| candidates(trials, group, wrongly), |given| vec![given[index]]);
            outcomes.push(
                tried.iter().map(|&one| Outcome::from_threshold(trials, group, &of_group, one)).collect::<Vec<_>>(),
            );
            episodes.push(of_group.len());
        }
        let false_flags = (MOST_FALSE_FLAGS * presses.len() as f64 / PER_PRESSES) as usize;
        let allowed = [given.map_or(false_flags, |_| usize::MAX), wrongly];
        let best = best_pair(&outcomes[0], &outcomes[1], allowed);
        let Some([location, recipe]) = best else { return Flags::default() };
        let total = episodes.iter().sum::<usize>();
        let (wrongly, right) = (location.wrongly + recipe.wrongly, location.right + recipe.right);
        let false_flags = (location.false_flags + recipe.false_flags) as f64;
        Flags {
            episodes: Some(total as u64),
            flagged_before_third_error: (total > 0).then(|| (location.caught + recipe.caught) as f64 / total as f64),
            false_flags_per_20_actions: Some(PER_PRESSES * false_flags / presses.len() as f64),
            wrongly_flagged: (right > 0).then(|| wrongly as f64 / right as f64),
            thresholds: Some(Thresholds { locations: location.threshold, recipes: recipe.threshold }),
        }
    }
}

/// The pair of outcomes with most detections within the allowed numbers of false flags and of wrongly flagged pairs.
fn best_pair(locations: &[Outcome], recipes: &[Outcome], allowed: [usize; 2]) -> Option<[Outcome; 2]> {
    let pairs = locations.iter().flat_map(|one| recipes.iter().map(move |other| [*one, *other]));
    let false_flags = |pair: &[Outcome; 2]| pair.iter().map(|one| one.false_flags).sum::<usize>();
    let wrongly = |pair: &[Outcome; 2]| pair.iter().map(|one| one.wrongly).sum::<usize>();
    let caught = |pair: &[Outcome; 2]| pair.iter().map(|one| one.caught).sum::<usize>();
    let fitting = pairs.filter(|pair| false_flags(pair) <= allowed[0] && wrongly(pair) <= allowed[1]);
    fitting.max_by(|a, b| caught(a).cmp(&caught(b)).then(false_flags(b).cmp(&false_flags(a))))
}

/// Allowed number of (press, aspect) pairs with a right belief that are flagged.
fn allowed_wrongly(trials: &[TrialView], groups: &[Vec<usize>; 2]) -> usize {
    let right = groups.iter().map(|group| while_right(trials, group).count()).sum::<usize>();
    (MOST_WRONGLY_FLAGGED * right as f64) as usize
}

/// Candidate thresholds, the strictest first: those that flag at most `allowed` pairs with a right belief.
fn candidates(trials: &[TrialView], group: &[usize], allowed: usize) -> Vec<f64> {
    let mut right: Vec<f64> = while_right(trials, group).collect();
    right.sort_by(|a, b| b.total_cmp(a));
    let allowed = allowed.min(right.len().saturating_sub(1));
    // A threshold just above the score at a rank flags at most that many pairs, also with tied scores.
    let above = |index: usize| right.get(index).map(|p| p.next_up());
    let steps = CANDIDATES.min(allowed + 1);
    let mut tried: Vec<f64> =
        (0..steps).filter_map(|step| above(step * allowed / steps.max(2).saturating_sub(1))).collect();
    tried.dedup();
    if tried.is_empty() { vec![0.0] } else { tried }
}

fn p_wrong(press: &PressView, aspect: usize) -> f64 {
    press.estimate.as_ref().map_or(0.0, |estimate| estimate.p_wrong[aspect])
}

/// Estimated probabilities of a false belief for all (press, aspect) pairs with a right belief.
fn while_right<'a>(trials: &'a [TrialView], group: &'a [usize]) -> impl Iterator<Item = f64> + 'a {
    let is_right = |press: &PressView, aspect: usize| press.is_wrong(aspect) == Some(false);
    trials.iter().flatten().flat_map(move |press| {
        group.iter().filter(move |&&aspect| is_right(press, aspect)).map(move |&aspect| p_wrong(press, aspect))
    })
}

/// The episodes of an aspect that count.
fn harmful(trials: &[TrialView], aspect: usize) -> Vec<Episode> {
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

impl Outcome {
    fn from_threshold(trials: &[TrialView], group: &[usize], episodes: &[Episode], threshold: f64) -> Outcome {
        let is_flagged = |press: &PressView, aspect: usize| p_wrong(press, aspect) >= threshold;
        let is_caught = |episode: &&Episode| {
            trials[episode.trial][episode.in_time.clone()].iter().any(|press| is_flagged(press, episode.aspect))
        };
        let caught = episodes.iter().filter(is_caught).count();
        let mut outcome = Outcome { threshold, caught, ..Outcome::default() };
        for presses in trials {
            for &aspect in group {
                let mut before = false;
                for press in presses {
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
