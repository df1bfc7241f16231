//! What the human seems unaware of by its gaze alone, between the events after which the assistant is asked anyway.
//!
//! Two rules, both on P(truth), the estimated probability that an aspect is believed right, of an aspect about which a signal can be sent:
//!
//! - P(truth) fell below 0.5 by a gaze sample, after it was at least 0.6 since the last request.
//! - A location changed without the human, P(truth) is below 0.5, and in a second of known gaze since the change nobody looked at it:
//!   the change was looked past. At most once for a change.

use super::session_state::Session;
use crate::base::time::SessionTime;
use crate::gaze::GazeSample;
use crate::kitchen::state::MAX_LOCATIONS;
use crate::kitchen::{AspectId, AspectKind, LocationId};
use crate::measures::sequences::FALSE_BELOW;
use crate::mind::dirichlet::DirichletBelief;

/// P(truth) from which an aspect counts as believed right again after it was below [`FALSE_BELOW`].
const RIGHT_FROM: f64 = 0.6;
/// Known gaze since a change after which it counts as looked past, in seconds.
const LOOKED_PAST_S: f64 = 1.0;

/// What the gaze has told since the last request for advice.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct GazeAwareness {
    /// Bit set of the aspects that have been believed right since the last request.
    right: u32,
    /// Known gaze in the trial so far, in seconds.
    gazed_s: f64,
    /// Time of the last usable sample.
    sampled: SessionTime,
    /// By location.
    changes: [WatchedChange; MAX_LOCATIONS],
    /// The aspect that the human seems unaware of, until the next request.
    unaware: Option<AspectId>,
}

/// The last change of a location.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct WatchedChange {
    /// When it changed.
    at: SessionTime,
    /// Known gaze in the trial before the change, in seconds.
    gazed_s: f64,
    /// Whether the assistant was asked because the change was looked past.
    is_asked: bool,
}

impl GazeAwareness {
    /// The aspect of which the human seems unaware since the last gaze sample, if the assistant has not been asked since.
    pub fn unaware(&self) -> Option<AspectId> {
        self.unaware
    }

    /// Takes a request for advice into account: what is believed wrong now is no news.
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

    /// Takes a gaze sample into account that has just been applied to session and estimate. `can_be_told`: whether a signal about the
    /// aspect can be sent.
    pub fn looked(
        &mut self,
        session: &Session,
        belief: &DirichletBelief,
        sample: &GazeSample,
        can_be_told: impl Fn(AspectId) -> bool,
    ) {
        let (perception, now) = (&session.spec.human.perception, session.time);
        let covered_s = now.secs_since(self.sampled).min(perception.max_sample_s);
        self.sampled = now;
        for (change, &at) in self.changes.iter_mut().zip(&session.changed_at) {
            if change.at != at {
                *change = WatchedChange { at, gazed_s: self.gazed_s, is_asked: false };
            }
        }
        self.gazed_s += perception.known_share(sample.confidence) * covered_s;
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
