//! The estimated belief over time, as far as a screen shows it.

use crate::base::time::SessionTime;
use crate::kitchen::{AspectId, Kitchen, State};
use crate::measures::sequences::FALSE_BELOW;
use crate::mind::dirichlet::DirichletBelief;

/// Between two moments that are kept, gaze samples that change little are left out for so long, in seconds.
const STEP_S: f64 = 0.2;
/// By so much the probability of a truth changes that is worth a moment of its own.
const JUMP: f64 = 0.1;
/// A change by the gaze is shown for so long, in seconds, if it is at least so large.
const NEWS_S: f64 = 2.0;
const NEWS: f64 = 0.2;

/// No panel shows more of the past than the chart of one aspect, in seconds.
pub const SHOWN_S: f64 = 60.0;

/// What is estimated of one aspect at a moment.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AspectSnapshot {
    /// The value that is expected to be believed most, by index, and how much.
    pub believes: u8,
    pub p: f32,
    /// The expected probability of the truth.
    pub p_truth: f32,
}

impl AspectSnapshot {
    /// Whether it is believed wrong.
    pub fn is_false(self) -> bool {
        f64::from(self.p_truth) < FALSE_BELOW
    }
}

/// The estimate at a moment.
#[derive(Clone, Debug, PartialEq)]
pub struct BeliefSnapshot {
    pub time: SessionTime,
    /// Nothing but gaze came since the moment before.
    by_gaze: bool,
    /// By aspect.
    pub held: Vec<AspectSnapshot>,
    /// By aspect, since when it is believed wrong, if it is.
    wrong_since: Vec<Option<SessionTime>>,
}

impl BeliefSnapshot {
    /// The estimate as it is at this time, while the kitchen is in `state`.
    pub fn new(
        kitchen: &Kitchen,
        state: State,
        belief: &DirichletBelief,
        time: SessionTime,
        by_gaze: bool,
    ) -> BeliefSnapshot {
        let held = |index: usize| {
            let of_aspect = &belief.aspects[index];
            let believes = of_aspect.most_likely();
            AspectSnapshot {
                believes: believes as u8,
                p: of_aspect.mean()[believes] as f32,
                p_truth: belief.p_truth(kitchen, state, AspectId(index as u8)) as f32,
            }
        };
        let held: Vec<AspectSnapshot> = (0..kitchen.aspects.len()).map(held).collect();
        let wrong_since = held.iter().map(|held| held.is_false().then_some(time)).collect();
        BeliefSnapshot { time, by_gaze, held, wrong_since }
    }
}

/// The estimate from moment to moment.
#[derive(Clone, Debug, Default)]
pub struct BeliefHistory {
    moments: Vec<BeliefSnapshot>,
}

impl BeliefHistory {
    /// The moments from which on something is believed wrong that was not before.
    pub fn newly_false(&self) -> impl Iterator<Item = SessionTime> {
        let begins = |moment: &&BeliefSnapshot| moment.wrong_since.contains(&Some(moment.time));
        self.moments.iter().filter(begins).map(|moment| moment.time)
    }

    /// Keeps a moment, unless it is one of many gaze samples that change little.
    pub fn note(&mut self, mut moment: BeliefSnapshot) {
        if let Some(last) = self.moments.last().filter(|_| moment.by_gaze) {
            let pairs = || last.held.iter().zip(&moment.held);
            let is_news = pairs().any(|(then, now)| f64::from((now.p_truth - then.p_truth).abs()) >= JUMP);
            if !is_news && moment.time.secs_since(last.time) < STEP_S {
                return;
            }
        }
        if let Some(last) = self.moments.last() {
            for (since, earlier) in moment.wrong_since.iter_mut().zip(&last.wrong_since) {
                *since = since.and(*earlier).or(*since);
            }
        }
        self.moments.push(moment);
    }

    /// Forgets what no panel shows any more `kept_s` seconds later, so that a long session needs no more memory than a short
    /// one.
    pub fn forget(&mut self, now: SessionTime, kept_s: f64) {
        let old = self.moments.partition_point(|moment| now.secs_since(moment.time) > kept_s);
        // Now and then, and not the last one: it is what holds now.
        if old > 2 * (self.moments.len() - old) {
            self.moments.drain(..old.min(self.moments.len() - 1));
        }
    }

    /// Takes over what another track of the same session has beyond this one.
    pub fn catch_up(&mut self, other: &BeliefHistory) {
        let known = self.moments.len().min(other.moments.len());
        self.moments.extend_from_slice(&other.moments[known..]);
    }
    /// The moments until and with this time.
    pub fn until(&self, time: SessionTime) -> &[BeliefSnapshot] {
        &self.moments[..self.moments.partition_point(|moment| moment.time <= time)]
    }
}

/// The aspects in the order in which they matter at the last of these moments: those believed wrong, the longest first,
/// then the others as they come.
pub fn ranked(moments: &[BeliefSnapshot]) -> Vec<usize> {
    let Some(last) = moments.last() else { return Vec::new() };
    let mut wrong: Vec<(SessionTime, usize)> =
        (0..last.held.len()).filter_map(|aspect| Some((wrong_since(moments, aspect)?, aspect))).collect();
    wrong.sort_unstable();
    let right = (0..last.held.len()).filter(|&aspect| !last.held[aspect].is_false());
    wrong.iter().map(|&(_, aspect)| aspect).chain(right).collect()
}

/// Since when an aspect is believed wrong; `None` if it is not.
pub fn wrong_since(moments: &[BeliefSnapshot], aspect: usize) -> Option<SessionTime> {
    moments.last()?.wrong_since[aspect]
}

/// When the gaze last changed what is believed of an aspect, if that was a moment ago.
pub fn read_at(moments: &[BeliefSnapshot], aspect: usize, now: SessionTime) -> Option<SessionTime> {
    let recent = moments.windows(2).rev().take_while(|pair| now.secs_since(pair[1].time) <= NEWS_S);
    let is_news = |pair: &&[BeliefSnapshot]| {
        let [then, at] = [&pair[0].held[aspect], &pair[1].held[aspect]];
        pair[1].by_gaze && (then.believes != at.believes || f64::from((at.p_truth - then.p_truth).abs()) >= NEWS)
    };
    recent.into_iter().find(is_news).map(|pair| pair[1].time)
}

/// P(truth) of an aspect at so many times, evenly spread over the last `seconds`; nothing before the first moment.
pub fn course(
    moments: &[BeliefSnapshot],
    aspect: usize,
    now: SessionTime,
    seconds: f64,
    columns: usize,
) -> Vec<Option<f64>> {
    let at = |column: usize| {
        let back_s = seconds * (columns - 1 - column) as f64 / columns.max(2) as f64;
        let time = now - SessionTime::from_secs_f64(back_s);
        let index = moments.partition_point(|moment| moment.time <= time);
        let is_there = now.as_secs_f64() >= back_s;
        moments[..index].last().filter(|_| is_there).map(|moment| f64::from(moment.held[aspect].p_truth))
    };
    (0..columns).map(at).collect()
}
