//! State of a replay: position, speed, and its keys.

use crate::base::time::SessionTime;
use crate::history::landmark::ReplayLandmark;

/// Speeds of a replay as multiples of real time; infinity for as fast as possible.
pub const SPEEDS: [f64; 8] = [0.25, 0.5, 1.0, 2.0, 4.0, 16.0, 64.0, f64::INFINITY];

/// A key of the replay.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ReplayKey {
    /// Play or pause.
    PlayPause,
    /// Go to the next event that is not a gaze sample.
    StepForward,
    /// Go to the previous event that is not a gaze sample.
    StepBack,
    /// Go to the next landmark of this kind.
    On(ReplayLandmark),
    /// Go to the previous landmark of this kind.
    BackTo(ReplayLandmark),
    /// Go ten seconds forward.
    SeekForward,
    /// Go ten seconds back.
    SeekBack,
    /// Play at the next higher speed.
    Faster,
    /// Play at the next lower speed.
    Slower,
    /// Go to the beginning, before the first event.
    ToStart,
    /// Go to the position after the event with this sequence number.
    ToEvent(u64),
    /// Go to this session time.
    ToTime(SessionTime),
    /// Go to the end; a followed recording stays at its growing end.
    ToEnd,
}

/// State of a replay.
#[derive(Clone, Debug, PartialEq)]
pub struct Playback {
    /// Name of the recording, for the head line.
    pub name: String,
    /// The replay moves on by itself.
    pub playing: bool,
    /// An index into [`SPEEDS`].
    pub speed: usize,
    /// Time of the last known event.
    pub length: SessionTime,
    /// Number of events applied so far.
    pub event: usize,
    /// Number of events known in all.
    pub events: usize,
    /// Whether the recording is followed while it is made.
    pub follows: bool,
    /// Whether the recording was cut off (no end event).
    pub cut: bool,
    /// Whether the recording is still being written but not followed.
    pub running: bool,
    /// Whether the recording was excluded from the analysis after it was closed.
    pub excluded: bool,
}

impl Playback {
    /// A replay at its beginning.
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
