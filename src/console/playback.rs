//! State of a replay: position, speed, and the replay's keys.

use tomcom_core::base::time::SessionTime;
use tomcom_session::replay::ReplayLandmark;

/// Speeds of a replay as multiples of real time; infinity for as fast as possible.
pub const SPEEDS: [f64; 8] = [0.25, 0.5, 1.0, 2.0, 4.0, 16.0, 64.0, f64::INFINITY];

/// Action of a replay's keys: play, move, or change the speed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ReplayAction {
    /// Play or pause the replay.
    PlayPause,
    /// Go to the next event of the recording that is not a gaze sample.
    StepForward,
    /// Go to the previous event of the recording that is not a gaze sample.
    StepBack,
    /// Go to the next landmark of this kind, such as an error or a signal.
    On(ReplayLandmark),
    /// Go to the previous landmark of this kind, such as an error or a signal.
    BackTo(ReplayLandmark),
    /// Go ten seconds forward in the recording.
    SeekForward,
    /// Go ten seconds back in the recording.
    SeekBack,
    /// Play the recording at the next higher speed.
    Faster,
    /// Play the recording at the next lower speed.
    Slower,
    /// Go to the beginning of the recording, before its first event.
    ToStart,
    /// Go to the position after the event with this sequence number.
    ToEvent(u64),
    /// Go to this session time of the recording.
    ToTime(SessionTime),
    /// Go to the end of the recording; in a recording that is still being made, stay at its growing end.
    ToEnd,
}

/// State of a replay: its position, its speed, and the recording's state.
#[derive(Clone, Debug, PartialEq)]
pub struct Playback {
    /// Name of the recording, as shown in the head line.
    pub name: String,
    /// Whether the replay is playing, not paused.
    pub playing: bool,
    /// Playback speed, as an index into [`SPEEDS`].
    pub speed: usize,
    /// Session time of the last known event of the recording.
    pub length: SessionTime,
    /// Time on the trial's clock at the end of the recording, as far as it is known.
    pub trial_length: SessionTime,
    /// Number of events of the recording up to the replay's position.
    pub event: usize,
    /// Number of events in the recording, as far as they are known.
    pub events: usize,
    /// Whether the replay follows a recording that is still being made.
    pub follows: bool,
    /// Whether the recording is incomplete: it has no end event.
    pub cut: bool,
    /// Whether the recording is still being made, but the replay does not follow it.
    pub running: bool,
    /// Whether the recording was excluded from the analysis after it was closed.
    pub excluded: bool,
}

impl Playback {
    /// A replay at the beginning of a recording.
    pub fn new(name: String) -> Playback {
        Playback {
            name,
            playing: false,
            speed: 2,
            length: SessionTime::ZERO,
            trial_length: SessionTime::ZERO,
            event: 0,
            events: 0,
            follows: false,
            cut: false,
            running: false,
            excluded: false,
        }
    }

    /// The playback speed in words: "2x", "0.25x", "max".
    pub fn speed_label(&self) -> String {
        let speed = SPEEDS[self.speed.min(SPEEDS.len() - 1)];
        if speed.is_finite() { format!("{speed}x") } else { "max".to_string() }
    }
}
