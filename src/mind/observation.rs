//! Observations: the evidence from which the belief filter updates its estimate, one at a time.

use crate::base::time::SessionTime;
use crate::gaze::GazeSample;
use crate::kitchen::{LocationId, Press, State};

/// One piece of evidence with its session time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Observation {
    pub time: SessionTime,
    pub what: Observed,
}

/// Kinds of evidence. A state here is the true state, which the display shows.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Observed {
    /// The trial starts; the human knows the state of the kitchen.
    Started {
        state: State,
    },
    /// A gaze sample, taken by the tracker at this session time.
    Gaze {
        sample: GazeSample,
        taken: SessionTime,
    },
    /// An agent pressed a button.
    Pressed(Press),
    /// The display changes without a press, for instance because an order appears or disappears.
    Displayed {
        state: State,
    },
    /// A signal about a location: an order's dish and recipe, or the content of another location.
    Told {
        location: LocationId,
    },
    /// The trial is paused or resumed; nothing is read or forgotten in between.
    Paused,
    Resumed,
}
