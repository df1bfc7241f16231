//! Judges by the gaze alone of which changes the human seems unaware, so that the assistant is asked for advice between
//! the usual events.
//!
//! Two rules hold for an aspect about which a signal can be sent. Both use P(truth), the probability that the estimated
//! belief gives to the true value:
//!
//! - P(truth) fell below 0.5 by a gaze sample, after it was at least 0.6 since the last request for advice.
//! - Somebody other than the human changed a location, P(truth) is below 0.5, and the human did not look at the
//!   location in a second of known gaze since the change: the human looked past the change. Advice is requested at most
//!   once for a change.

use super::session_state::Session;
use crate::base::time::SessionTime;
use crate::gaze::GazeSample;
use crate::kitchen::state::MAX_LOCATIONS;
use crate::kitchen::{AspectId, AspectKind, LocationId};
use crate::measures::sequences::FALSE_BELOW;
use crate::mind::dirichlet::DirichletBelief;

/// Least P(truth) with which a belief about an aspect counts as right again after P(truth) was below [`FALSE_BELOW`].
const RIGHT_FROM: f64 = 0.6;
/// Time of known gaze since a change of a location after which the human counts as having looked past the change, in
/// seconds.
const LOOKED_PAST_S: f64 = 1.0;

/// What the gaze has revealed about the human's awareness since the assistant was last asked for advice.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct UnawarenessDetector {
    /// Bit set of the state aspects about which the belief has been right since the last request for advice.
    right: u32,
    /// Time of known gaze in the trial so far, in seconds.
    gazed_s: f64,
    /// Time at which the last gaze sample was taken.
    sampled: SessionTime,
    /// The last change of each location's content, as far as awareness of that change is concerned.
    changes: [WatchedChange; MAX_LOCATIONS],
    /// The aspect of which the human seems unaware, until the assistant is asked for advice.
    unaware: Option<AspectId>,
}

/// The last change of a location's content, and how much gaze was known before that change.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct WatchedChange {
    /// Session time at which the location changed.
    at: SessionTime,
    /// Time of known gaze in the trial before the change, in seconds.
    gazed_s: f64,
    /// Whether the assistant was already asked for advice because the human looked past the change.
    is_asked: bool,
}

impl UnawarenessDetector {
    /// The state aspect of which the human seems unaware since the last gaze sample, if the assistant has not been
    /// asked for advice since.
    pub fn unaware(&self) -> Option<AspectId> {
        self.unaware
    }

    /// Notes that the assistant was asked for advice: false beliefs that exist now do not cause another request.
    pub fn asked(&mut self, session: &Session, belief: &DirichletBelief) {
        self.unaware = None;
        for index in 0..belief.aspects.len() {
            match belief.p_truth(&session.kitchen, session.state, AspectId(index as u8)) {
                p_truth if p_truth < FALSE_BELOW => self.right &= !(1 << index),
                p_truth if p_truth >= RIGHT_FROM => self.right |= 1 << index,
                _ => {}
            }
        }
    }

    /// Updates the judgement with a gaze sample that has just been applied to session and estimate. `can_be_told` says
    /// whether a signal about an aspect can be sent.
    pub fn looked(
        &mut self,
        session: &Session,
        belief: &DirichletBelief,
        sample: &GazeSample,
        can_be_told: impl Fn(AspectId) -> bool,
    ) {
        let (perception, taken) = (&session.spec.human.perception, sample.taken(session.time));
        let covered_s = taken.secs_since(self.sampled).min(perception.max_sample_s);
        self.sampled = taken;
        let gazed_s = self.gazed_s + perception.known_share(sample.confidence) * covered_s;
        for (change, &at) in self.changes.iter_mut().zip(&session.changed_at) {
            // A sample that was taken before the change is gaze before the change, also if it arrives later.
            let gazed_before_s = if taken < at { gazed_s } else { self.gazed_s };
            if change.at != at {
                *change = WatchedChange { at, gazed_s: gazed_before_s, is_asked: false };
            } else if taken < at {
                change.gazed_s = gazed_before_s;
            }
        }
        self.gazed_s = gazed_s;
        for index in 0..belief.aspects.len() {
            let aspect = AspectId(index as u8);
            let p_truth = belief.p_truth(&session.kitchen, session.state, aspect);
            if p_truth >= RIGHT_FROM {
                self.right |= 1 << index;
            }
            if p_truth >= FALSE_BELOW || !can_be_told(aspect) {
                continue;
            }
            if self.right & 1 << index != 0 {
                self.right &= !(1 << index);
                self.unaware = Some(aspect);
            }
            if let AspectKind::Location(location) = session.kitchen.aspects[index].kind
                && self.is_looked_past(session, location)
            {
                self.changes[location.index()].is_asked = true;
                self.unaware = Some(aspect);
            }
        }
    }

    fn is_looked_past(&self, session: &Session, location: LocationId) -> bool {
        let change = &self.changes[location.index()];
        !change.is_asked && self.gazed_s - change.gazed_s >= LOOKED_PAST_S && session.is_unseen(location)
    }
}
