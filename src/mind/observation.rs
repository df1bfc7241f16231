//! Observations: the evidence from which the belief filter updates its estimate, one at a time.

use crate::base::time::SessionTime;
use crate::gaze::GazeSample;
use crate::kitchen::{ButtonId, LocationId, Press, State};

/// Largest number of presses in a proposal.
pub const MOST_PROPOSED: usize = 5;

/// Presses of the human that the display proposes, the next one first; by default none.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct ProposedPresses([Option<ButtonId>; MOST_PROPOSED]);

impl ProposedPresses {
    /// The first [`MOST_PROPOSED`] of these presses.
    pub fn new(presses: impl IntoIterator<Item = ButtonId>) -> ProposedPresses {
        let mut all = ProposedPresses::default();
        all.0.iter_mut().zip(presses).for_each(|(place, press)| *place = Some(press));
        all
    }

    /// The press that is proposed next, if one is.
    pub fn next(&self) -> Option<ButtonId> {
        self.0[0]
    }

    /// A press of the human: the proposal goes on if it was proposed, and is over if it was not.
    pub fn pressed(&mut self, button: ButtonId) {
        match self.next() == Some(button) {
            true => {
                self.0.rotate_left(1);
                self.0[MOST_PROPOSED - 1] = None;
            }
            false => *self = ProposedPresses::default(),
        }
    }
}

/// One piece of evidence with its session time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Observation {
    /// Session time.
    pub time: SessionTime,
    /// What happened.
    pub what: Observed,
}

/// Kinds of evidence. A state here is the true state, which the display shows.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Observed {
    /// The trial starts; the human knows the state of the kitchen.
    Started {
        /// The kitchen at the start.
        state: State,
    },
    /// A gaze sample, taken by the tracker at this session time.
    Gaze {
        /// The sample, in display coordinates.
        sample: GazeSample,
        /// When the tracker took it, in session time.
        taken: SessionTime,
    },
    /// The tracker finds the display in its view, or no longer.
    DisplayInView(bool),
    /// An agent pressed a button.
    Pressed(Press),
    /// The display changes without a press, for instance because an order appears or disappears.
    Displayed {
        /// What the display shows from now on.
        state: State,
    },
    /// A signal about a location: an order's dish and recipe, or the content of another location.
    Told {
        /// The location that the signal is about.
        location: LocationId,
    },
    /// The signal leaves the display. Where signals take no time, it makes no difference.
    SignalOver,
    /// The display proposes presses. That says nothing about contents and recipes; it matters for what the next presses say about beliefs.
    Proposed(ProposedPresses),
    /// The human has not pressed for longer than usual.
    Waited {
        /// Share of its own intervals between presses that are longer.
        longer: f64,
    },
    /// The trial stands still: nothing is read or forgotten until it goes on.
    Paused,
    /// The trial goes on.
    Resumed,
    /// The task stands still for a probe, and the kitchen is off the display.
    Frozen,
    /// The task goes on where it was: nothing was seen and nothing forgotten meanwhile.
    Thawed {
        /// For how long it stood still.
        by: SessionTime,
        /// Bit set of the locations about which questions were asked.
        asked: u32,
        /// Probability that the human looks at one of them because of the question.
        teaches: f64,
    },
}
