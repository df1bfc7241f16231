//! Judges the signals of a running trial as they are sent, for the summary at the trial's end: was the belief that a
//! signal corrects false?
//!
//! The measures of a study look at the whole trial and leave out false beliefs that led to no error
//! ([`tomcom_core::measures::wizard_performance`]); this module judges a signal by the beliefs at the time the signal was
//! sent.

use crate::event::SignalEndReason;
use crate::{Event, Session, TimestampedEvent};
use tomcom_core::communication::recommendation::aspects_told;
use tomcom_core::communication::{Sender, Signal};
use tomcom_core::kitchen::{Agent, AspectId};
use tomcom_core::measures::wizard_performance::LATE_PRESSES;

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct SignalJudgementCounts {
    /// About a false belief.
    pub hits: u64,
    /// About a belief that became right at most [`LATE_PRESSES`] presses of the human before.
    pub late: u64,
    /// About a belief that was right already.
    pub needless: u64,
    /// They also count among the others.
    pub taken_back: u64,
}

impl SignalJudgementCounts {
    pub fn sent(&self) -> u64 {
        self.hits + self.late + self.needless
    }
}

/// Of the belief about one state aspect.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
struct Standing {
    is_false: bool,
    /// Number of the human's presses when it became right.
    corrected: Option<u32>,
}

#[derive(Clone, Debug, Default)]
pub struct SignalJudge {
    beliefs: Vec<Standing>,
    wizard: SignalJudgementCounts,
    assistant: SignalJudgementCounts,
    /// `None` before the trial's first signal, and after the last one was taken back.
    last: Option<Sender>,
}

impl SignalJudge {
    /// By the beliefs noted before the event, which has been applied.
    pub fn judge(&mut self, stamped: &TimestampedEvent, session: &Session) {
        match &stamped.event {
            Event::TrialStarted => *self = SignalJudge::default(),
            // A proposal of presses is not about beliefs, so it is not judged.
            Event::SignalShown { by, signal: Signal::Propose(_), .. } => self.last = Some(*by),
            Event::SignalShown { by, signal, .. } => {
                let told = aspects_told(&session.kitchen, session.state, signal);
                let presses = session.presses[Agent::Human.index()];
                self.last = Some(*by);
                let beliefs = || told.iter().filter_map(|aspect| self.beliefs.get(aspect.index()));
                let is_late = |belief: &Standing| belief.corrected.is_some_and(|at| presses <= at + LATE_PRESSES);
                let (is_hit, is_late) = (beliefs().any(|belief| belief.is_false), beliefs().any(is_late));
                let tally = self.tally_mut(*by);
                match () {
                    () if is_hit => tally.hits += 1,
                    () if is_late => tally.late += 1,
                    () => tally.needless += 1,
                }
            }
            Event::SignalEnded { reason: SignalEndReason::TakenBack } => {
                if let Some(by) = self.last.take() {
                    self.tally_mut(by).taken_back += 1;
                }
            }
            _ => {}
        }
    }

    /// Which beliefs are false now.
    pub fn note(&mut self, session: &Session, is_false: impl Fn(AspectId) -> bool) {
        let presses = session.presses[Agent::Human.index()];
        self.beliefs.resize(session.kitchen.aspects.len(), Standing::default());
        for (index, belief) in self.beliefs.iter_mut().enumerate() {
            let now = is_false(AspectId(index as u8));
            if belief.is_false && !now {
                belief.corrected = Some(presses);
            }
            belief.is_false = now;
        }
    }

    pub fn tally(&self, by: Sender) -> SignalJudgementCounts {
        match by {
            Sender::Wizard => self.wizard,
            Sender::Assistant => self.assistant,
        }
    }

    fn tally_mut(&mut self, by: Sender) -> &mut SignalJudgementCounts {
        match by {
            Sender::Wizard => &mut self.wizard,
            Sender::Assistant => &mut self.assistant,
        }
    }
}
