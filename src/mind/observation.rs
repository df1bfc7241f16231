//! What the estimate of a belief is made from. One observation is the unit of work.

use crate::base::time::SessionTime;
use crate::gaze::GazeSample;
use crate::kitchen::{LocationId, Press, State};

/// Something that happened, and when.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Observation {
    pub time: SessionTime,
    pub what: Observed,
}

/// What happened. States are what is true, and what the display shows.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Observed {
    /// The trial starts, and the human knows what the kitchen looks like.
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
    /// The display shows this from now on without anybody having pressed: orders come and go.
    Displayed {
        state: State,
    },
    /// A signal about a location: an order's dish and recipe, or what lies at another location.
    Told {
        location: LocationId,
    },
    /// The trial stands still, and goes on: nothing is read or forgotten between.
    Paused,
    Resumed,
}
