//! Where a replay stands: position, speed, and how a key moves it.

use crate::base::time::SessionTime;
use crate::history::landmark::ReplayLandmark;

/// The speeds of a replay, as multiples of real time; infinity is as fast as it goes.
pub const SPEEDS: [f64; 8] = [0.25, 0.5, 1.0, 2.0, 4.0, 16.0, 64.0, f64::INFINITY];

/// What a key asks of a replay.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ReplayKey {
    PlayPause,
    /// To the next or the last event that is no gaze sample.
    StepForward,
    StepBack,
    /// To the next or the last moment of this kind.
    On(ReplayLandmark),
    BackTo(ReplayLandmark),
    /// Ten seconds on or back.
    SeekForward,
    SeekBack,
    Faster,
    Slower,
    ToStart,
    /// Behind the event of this number.
    ToEvent(u64),
    /// To the end; a followed recording stays at its growing end.
    ToEnd,
}

/// Where a replay stands.
#[derive(Clone, Debug, PartialEq)]
pub struct Playback {
    /// What is replayed, for the head line.
    pub name: String,
    pub playing: bool,
    /// An index into [`SPEEDS`].
    pub speed: usize,
    /// The time of the last event that is known.
    pub length: SessionTime,
    /// Events applied so far, and known in all.
    pub event: usize,
    pub events: usize,
    /// The recording grows: it is watched while it is made.
    pub follows: bool,
    /// The recording ends without its end event.
    pub cut: bool,
    /// Somebody still writes it, and it is not followed.
    pub running: bool,
    /// It was left out of the analysis after it was closed.
    pub excluded: bool,
}

impl Playback {
    /// A replay that stands at its beginning.
    pub fn new(name: String) -> Playback {
        Playback {
            name,
            playing: false,
            speed: 2,
            length: SessionTime::ZERO,
            event: 0,
            events: 0,
            follows: false,
            cut: false,
            running: false,
            excluded: false,
        }
    }

    /// The speed in words: "2x", "0.25x", "max".
    pub fn speed_label(&self) -> String {
        let speed = SPEEDS[self.speed.min(SPEEDS.len() - 1)];
        if speed.is_finite() { format!("{speed}x") } else { "max".to_string() }
    }
}
