//! Observations: the evidence by which the belief filter updates its estimate, one observation at a time.

use crate::base::time::SessionTime;
use crate::gaze::GazeSample;
use crate::kitchen::{ButtonId, LocationId, Press, State};

/// Largest number of presses that the display proposes at a time.
pub(crate) const MOST_PROPOSED: usize = 5;

/// Presses of the human that the display proposes, the next one first; none by default.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct ProposedPresses([Option<ButtonId>; MOST_PROPOSED]);

impl ProposedPresses {
    /// A proposal with the first `MOST_PROPOSED` of these presses.
    pub fn new(presses: impl IntoIterator<Item = ButtonId>) -> ProposedPresses {
        let mut all = ProposedPresses::default();
        all.0.iter_mut().zip(presses).for_each(|(place, press)| *place = Some(press));
        all
    }

    /// The press that the display proposes next; `None` without a proposal.
    pub fn next(&self) -> Option<ButtonId> {
        self.0[0]
    }

    /// Accounts for a press of the human: the proposal moves on if it proposed this press, and ends otherwise.
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

/// One observation: a piece of evidence with its session time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Observation {
    /// Session time of the observation.
    pub time: SessionTime,
    /// The observed evidence about the human's belief.
    pub what: ObservedEvidence,
}

/// Kinds of evidence about the human's belief. A `state` in such evidence is the true state, which the display shows.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ObservedEvidence {
    /// The trial starts; the human knows the state of the kitchen.
    Started {
        /// The state of the kitchen at the start of the trial.
        state: State,
    },
    /// A gaze sample, taken by the tracker at this session time.
    Gaze {
        /// The gaze sample, in display coordinates.
        sample: GazeSample,
        /// Session time at which the tracker took the sample.
        taken: SessionTime,
    },
    /// The eye tracker finds the display in its view (true), or does not any more (false).
    DisplayInView(bool),
    /// One of the agents pressed a button.
    Pressed(Press),
    /// The display changes without a press, for instance because an order appears or disappears.
    Displayed {
        /// The state that the display shows from now on.
        state: State,
    },
    /// A signal reveals something about a location: an order's dish and recipe, or the content of another location.
    Told {
        /// The location that the signal is about.
        location: LocationId,
    },
    /// The signal leaves the display. Where signals take no time to be read, this event makes no difference.
    EndedSignal,
    /// The display proposes presses. A proposal reveals nothing about contents and recipes; it changes what the next
    /// presses reveal about beliefs.
    Proposed(ProposedPresses),
    /// The trial is paused: nothing is read or forgotten until it resumes.
    Paused,
    /// The trial resumes after a pause.
    Resumed,
    /// The task is frozen for a probe, and the kitchen is not on the display.
    Frozen,
    /// The task continues where it was frozen: nothing was seen and nothing forgotten meanwhile.
    Thawed {
        /// Duration for which the task stood still.
        by: SessionTime,
        /// Bit set of the locations about which the probe asked questions.
        asked: u32,
        /// Probability that the human looks at a location because a question was about it.
        teaches: f64,
    },
}
