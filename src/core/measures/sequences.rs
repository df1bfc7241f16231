//! Error sequences and false belief episodes.
//!
//! Errors are related if they come from the same false belief: about one location, or one dish, whose order and recipe
//! count as one. An error sequence consists of related errors at most 3 correct presses apart. Errors from other
//! causes, and slips and races in between, are not correct presses: such presses neither end nor lengthen a sequence.
//! Sequences "whatever the aspect" group all belief related errors; the target of such a sequence is the most frequent
//! target of its errors. The length of a sequence is its number of errors; the recovery time goes from the first error
//! to the first correct press after the last error. A false belief episode lasts from the time at which a belief became
//! false (P(truth) < 0.5) to the correction of the belief, if the false belief caused at least one error.

use std::collections::BTreeSet;

use serde::{Deserialize, Serialize};

use super::attribution::{ErrorCause, FalseBeliefTarget};
use super::errors::JudgedPress;
use crate::base::time::SessionTime;
use crate::kitchen::{AspectId, DishId, Kitchen, LocationId, State};
use crate::mind::belief::Belief;

/// Largest number of correct presses between two errors of a sequence.
pub(crate) const MAX_APART: u32 = 3;
/// A belief is false if its P(truth) is below this value.
pub const FALSE_BELOW: f64 = 0.5;
/// A value is what somebody thinks if the belief gives it at least this probability; of a false belief without such a
/// value they are unsure.
pub const THINKS: f64 = 0.5;

/// An error sequence: related errors with few correct presses between them.
#[derive(Clone, Debug, PartialEq)]
pub struct ErrorSequence {
    /// The target of most of the sequence's errors; of equally frequent targets, the target of the earliest error.
    pub target: FalseBeliefTarget,
    /// The errors of the sequence, as indices of the human's presses.
    pub errors: Vec<usize>,
    /// Session time of the sequence's first error.
    pub began: SessionTime,
    /// Session time of the first correct press after the last error; `None` if the trial ended before.
    pub recovered: Option<SessionTime>,
}

impl ErrorSequence {
    /// The length of the sequence: its number of errors.
    pub fn length(&self) -> u32 {
        self.errors.len() as u32
    }
}

/// The dish or place that a false belief is about: errors with the same subject are related. An error that two false
/// beliefs explain together, or for which two raters name different false beliefs, belongs to the subject of the first
/// false belief.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum FalseBeliefSubject {
    /// A false belief about an ordered dish: about its order or its recipe.
    Dish(DishId),
    /// A false belief about the content of a location, or about an order location that shows no order.
    Place(LocationId),
}

impl FalseBeliefTarget {
    /// The subject of a false belief about this target.
    pub fn subject(self) -> FalseBeliefSubject {
        match self {
            FalseBeliefTarget::Order(_, Some(dish)) | FalseBeliefTarget::Recipe(dish) => FalseBeliefSubject::Dish(dish),
            FalseBeliefTarget::Order(location, None) | FalseBeliefTarget::Place(location) => {
                FalseBeliefSubject::Place(location)
            }
        }
    }
}

/// The sequences of related errors of a trial, in order of their first errors.
pub fn sequences(presses: &[JudgedPress]) -> Vec<ErrorSequence> {
    let subjects: BTreeSet<FalseBeliefSubject> =
        presses.iter().filter_map(|press| Some(target_of(press)?.subject())).collect();
    let of_subject = |subject: FalseBeliefSubject| grouped(presses, move |target| target.subject() == subject);
    let mut all: Vec<ErrorSequence> = subjects.into_iter().flat_map(of_subject).collect();
    all.sort_by_key(|sequence| sequence.errors[0]);
    all
}

/// The error sequences of a trial, whatever aspect the false beliefs are about.
pub fn sequences_any_aspect(presses: &[JudgedPress]) -> Vec<ErrorSequence> {
    grouped(presses, |_| true)
}

/// Target of the false belief behind a belief related error; `None` for other presses.
fn target_of(press: &JudgedPress) -> Option<FalseBeliefTarget> {
    match press.cause {
        Some(ErrorCause::Belief { target, .. }) => Some(target),
        _ => None,
    }
}

fn grouped(presses: &[JudgedPress], counts: impl Fn(FalseBeliefTarget) -> bool) -> Vec<ErrorSequence> {
    let mut done = Vec::new();
    let mut open: Vec<(usize, FalseBeliefTarget)> = Vec::new();
    let (mut apart, mut recovered) = (0, None);
    for (index, press) in presses.iter().enumerate() {
        if let Some(target) = target_of(press).filter(|&target| counts(target)) {
            if apart > MAX_APART {
                done.extend(closed(presses, &open, recovered));
                open.clear();
            }
            open.push((index, target));
            (apart, recovered) = (0, None);
        } else if !press.verdict.error && !press.verdict.race {
            apart += 1;
            recovered = recovered.or(Some(press.time));
        }
    }
    done.extend(closed(presses, &open, recovered));
    done
}

fn closed(
    presses: &[JudgedPress],
    errors: &[(usize, FalseBeliefTarget)],
    recovered: Option<SessionTime>,
) -> Option<ErrorSequence> {
    let (first, mut target) = *errors.first()?;
    let frequency = |one: FalseBeliefTarget| errors.iter().filter(|(_, other)| *other == one).count();
    for &(_, other) in errors {
        if frequency(other) > frequency(target) {
            target = other;
        }
    }
    let errors = errors.iter().map(|(index, _)| *index).collect();
    Some(ErrorSequence { target, errors, began: presses[first].time, recovered })
}

/// A false belief episode: the period from the beginning of a false belief to its correction.
#[derive(Clone, Debug, PartialEq)]
pub struct FalseBeliefEpisode {
    /// The aspect that the false belief is about.
    pub aspect: AspectId,
    /// Session time at which the belief became false.
    pub began: SessionTime,
    /// Session time at which the belief was right again; `None` if the trial ended before.
    pub corrected: Option<SessionTime>,
    /// Number of errors attributed to the episode's false belief.
    pub errors: u32,
}

/// Tracks false belief episodes over a trial.
#[derive(Clone, Debug, Default)]
pub struct FalseBeliefTracker {
    open: Vec<Option<FalseBeliefEpisode>>,
    done: Vec<FalseBeliefEpisode>,
    /// Session time at which the belief was last recorded.
    last: SessionTime,
}

impl FalseBeliefTracker {
    /// Records the belief at a time. `changed_at` contains the time of each location's last change: a belief that was
    /// right when last recorded became false at that time.
    pub fn believed(
        &mut self,
        kitchen: &Kitchen,
        now: SessionTime,
        state: State,
        belief: &Belief,
        changed_at: &[SessionTime],
    ) {
        self.open.resize(kitchen.aspects.len(), None);
        for (index, open) in self.open.iter_mut().enumerate() {
            let aspect = AspectId(index as u8);
            let is_false = belief.p_truth(kitchen, state, aspect) < FALSE_BELOW;
            if is_false && open.is_none() {
                let changed = if index < kitchen.locations.len() { changed_at.get(index).copied() } else { None };
                let began = changed.filter(|&time| time > self.last).unwrap_or(now);
                *open = Some(FalseBeliefEpisode { aspect, began, corrected: None, errors: 0 });
            } else if !is_false && let Some(episode) = open.take() {
                self.done.push(FalseBeliefEpisode { corrected: Some(now), ..episode });
            }
        }
        self.last = now;
    }

    /// Records an error: the error counts for every aspect of its cause about which the belief is false.
    pub fn erred(&mut self, kitchen: &Kitchen, cause: ErrorCause) {
        for aspect in cause.targets().flat_map(|target| target.aspects(kitchen)) {
            if let Some(Some(episode)) = self.open.get_mut(aspect.index()) {
                episode.errors += 1;
            }
        }
    }

    /// All false belief episodes so far, with and without errors, in order of their corrections, open ones last.
    pub fn all(&self) -> impl Iterator<Item = &FalseBeliefEpisode> {
        self.done.iter().chain(self.open.iter().flatten())
    }

    /// The false belief episodes so far that caused at least one error, in order of their corrections, open ones last.
    pub fn harmful(&self) -> impl Iterator<Item = &FalseBeliefEpisode> {
        self.all().filter(|episode| episode.errors > 0)
    }
}

/// Numbers of belief related errors by kind of aspect that the false belief is about, as in the paper.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct BeliefErrorCounts {
    /// Number of errors from a false belief about an order.
    pub orders: u64,
    /// Number of errors from a false belief about a recipe.
    pub recipes: u64,
    /// Number of errors about an ordered dish where order and recipe were both believed wrong, or where it is unknown
    /// which of the two was.
    pub order_or_recipe: u64,
    /// Number of errors from a false belief about the content of any other location.
    pub places: u64,
}

impl BeliefErrorCounts {
    /// Counts the belief related errors among these presses. `episodes` tells whether the belief about an order or
    /// about its recipe was false at the time of an error.
    pub fn from_presses(
        kitchen: &Kitchen,
        presses: &[JudgedPress],
        episodes: &[FalseBeliefEpisode],
    ) -> BeliefErrorCounts {
        let mut counts = BeliefErrorCounts::default();
        for press in presses {
            let Some(ErrorCause::Belief { target, .. }) = press.cause else { continue };
            let is_false = |aspect: AspectId| {
                let is_open = |end| press.time <= end;
                episodes.iter().any(|episode| {
                    episode.aspect == aspect && episode.began <= press.time && episode.corrected.is_none_or(is_open)
                })
            };
            let count = match target {
                FalseBeliefTarget::Place(_) => &mut counts.places,
                FalseBeliefTarget::Recipe(_) => &mut counts.recipes,
                FalseBeliefTarget::Order(_, None) => &mut counts.orders,
                FalseBeliefTarget::Order(location, Some(dish)) => {
                    match (is_false(AspectId::of_location(location)), is_false(kitchen.aspect_of_dish(dish))) {
                        (true, false) => &mut counts.orders,
                        (false, true) => &mut counts.recipes,
                        _ => &mut counts.order_or_recipe,
                    }
                }
            };
            *count += 1;
        }
        counts
    }

    /// Adds two counts of belief related errors.
    pub fn plus(self, other: BeliefErrorCounts) -> BeliefErrorCounts {
        BeliefErrorCounts {
            orders: self.orders + other.orders,
            recipes: self.recipes + other.recipes,
            order_or_recipe: self.order_or_recipe + other.order_or_recipe,
            places: self.places + other.places,
        }
    }
}
