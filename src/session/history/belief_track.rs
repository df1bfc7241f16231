//! History of the belief estimate, at the resolution that screens need.

use std::sync::Arc;

use crate::Session;
use tomcom_core::base::time::SessionTime;
use tomcom_core::kitchen::{AspectId, Kitchen, State};
use tomcom_core::measures::sequences::FALSE_BELOW;
use tomcom_core::mind::dirichlet::DirichletBelief;

/// Least time between two snapshots that differ little.
const STEP_S: f64 = 0.2;
/// Change of a P(truth), the estimated probability of an aspect's true value, for which a snapshot is kept at once.
const JUMP: f64 = 0.1;

/// Longest period that the console's chart of a state aspect shows.
pub const SHOWN_S: f64 = 60.0;

/// Estimate of the participant's belief about one state aspect.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AspectBeliefSnapshot {
    /// Index of the value most probably believed.
    pub believes: u8,
    /// Expected probability of that value.
    pub p: f32,
    /// Expected probability of the true value.
    pub p_truth: f32,
    /// Index of the wrong value most probably believed.
    pub wrong: u8,
    /// Expected probability of that value.
    pub p_wrong: f32,
}

impl AspectBeliefSnapshot {
    pub fn is_false(self) -> bool {
        f64::from(self.p_truth) < FALSE_BELOW
    }
}

#[derive(Clone, Debug, PartialEq)]
pub struct BeliefSnapshot {
    pub time: SessionTime,
    /// Whether only gaze samples came since the previous snapshot.
    by_gaze: bool,
    /// By state aspect. Copies share it, since a replay and its screen both keep the whole history.
    pub held: Arc<[AspectBeliefSnapshot]>,
    /// Start of the present false belief about each state aspect.
    wrong_since: Arc<[Option<SessionTime>]>,
}

impl BeliefSnapshot {
    /// `state`: the kitchen's true state at that time.
    pub fn new(
        kitchen: &Kitchen,
        state: State,
        belief: &DirichletBelief,
        time: SessionTime,
        by_gaze: bool,
    ) -> BeliefSnapshot {
        let held = |index: usize| {
            let of_aspect = &belief.aspects[index];
            let (mean, aspect) = (of_aspect.mean(), AspectId(index as u8));
            let (believes, truth) = (of_aspect.most_likely(), kitchen.true_value(state, aspect));
            let others = (0..mean.len()).filter(|&value| value != truth);
            let wrong = others.reduce(|best, value| if mean[value] > mean[best] { value } else { best });
            let wrong = wrong.unwrap_or(truth);
            AspectBeliefSnapshot {
                believes: believes as u8,
                p: mean[believes] as f32,
                p_truth: belief.p_truth(kitchen, state, aspect) as f32,
                wrong: wrong as u8,
                p_wrong: mean[wrong] as f32,
            }
        };
        let held: Arc<[AspectBeliefSnapshot]> = (0..kitchen.aspects.len()).map(held).collect();
        let wrong_since = held.iter().map(|held| held.is_false().then_some(time)).collect();
        BeliefSnapshot { time, by_gaze, held, wrong_since }
    }
}

/// In the order of time.
#[derive(Clone, Debug, Default)]
pub struct BeliefHistory {
    moments: Vec<BeliefSnapshot>,
}

impl BeliefHistory {
    /// Adds a snapshot, unless only gaze samples with little effect came since the previous one; returns whether it was
    /// added.
    pub fn note(&mut self, mut moment: BeliefSnapshot) -> bool {
        if let Some(last) = self.moments.last().filter(|_| moment.by_gaze) {
            let mut pairs = last.held.iter().zip(moment.held.iter());
            let is_news = pairs.any(|(then, now)| f64::from((now.p_truth - then.p_truth).abs()) >= JUMP);
            // In a pause the estimate stands although gaze samples come.
            if !is_news && (moment.time.secs_since(last.time) < STEP_S || moment.held == last.held) {
                return false;
            }
        }
        if let Some(last) = self.moments.last() {
            let pairs = moment.wrong_since.iter().zip(last.wrong_since.iter());
            moment.wrong_since = pairs.map(|(since, earlier)| since.and(*earlier).or(*since)).collect();
        }
        self.moments.push(moment);
        true
    }

    /// Removes snapshots older than `kept_s` on the trial's clock, so that memory does not grow with the session.
    pub fn forget(&mut self, session: &Session, now: SessionTime, kept_s: f64) {
        let old = self.moments.partition_point(|moment| session.age(moment.time, now).as_secs_f64() > kept_s);
        // Old snapshots are removed in batches; the last snapshot before the limit stays, since that estimate still
        // holds at the limit.
        if old > 2 * (self.moments.len() - old) {
            self.moments.drain(..old.min(self.moments.len() - 1));
        }
    }

    /// Makes this history the first `number` snapshots of another history of the same session.
    pub fn follow(&mut self, other: &BeliefHistory, number: usize) {
        self.moments.truncate(number);
        let known = self.moments.len();
        self.moments.extend_from_slice(&other.moments[known..number]);
    }

    /// Up to and including a time.
    pub fn until(&self, time: SessionTime) -> &[BeliefSnapshot] {
        &self.moments[..self.moments.partition_point(|moment| moment.time <= time)]
    }
}

/// Start of the present false belief about a state aspect.
pub fn wrong_since(moments: &[BeliefSnapshot], aspect: usize) -> Option<SessionTime> {
    moments.last()?.wrong_since[aspect]
}

/// P(truth) of one state aspect at evenly spaced times over the last `seconds` of the trial's clock, which stands before
/// the start, in a pause and after the end of the trial; `None` before the trial's start and before the first snapshot.
pub fn course(
    moments: &[BeliefSnapshot],
    aspect: usize,
    session: &Session,
    now: SessionTime,
    seconds: f64,
    columns: usize,
) -> Vec<Option<f64>> {
    let clock_s = session.trial_clock(now).as_secs_f64();
    let at = |column: usize| {
        let back_s = seconds * (columns - 1 - column) as f64 / columns.max(2) as f64;
        let is_as_old = |moment: &BeliefSnapshot| session.age(moment.time, now).as_secs_f64() >= back_s;
        let last = moments[..moments.partition_point(is_as_old)].last();
        last.filter(|_| clock_s >= back_s).map(|moment| f64::from(moment.held[aspect].p_truth))
    };
    (0..columns).map(at).collect()
}
