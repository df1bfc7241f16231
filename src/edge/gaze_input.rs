//! Messages of eye trackers of all kinds on their way into the session.

use std::net::IpAddr;
use std::time::Instant;

use crate::gaze::GazeSample;
use crate::session::tracker::TrackerRecording;

/// Capacity of the queue of tracker messages.
pub const WAITING: usize = 4096;

/// A message of a tracker. Points are in fractions of the wall display, origin at the top left.
#[derive(Clone, Debug, PartialEq)]
pub enum GazeNews {
    /// A sample, with the time at which it was taken if the clocks have been compared.
    Sample(GazeSample, Option<Instant>),
    /// Number of malformed messages, lines or samples.
    Malformed(u64),
    /// A sample with this in place of a time.
    WrongTime(f64),
    /// Number of rejected senders: connections and datagrams that are not a tracker's.
    Rejected(u64),
    /// Senders were rejected that nobody let in.
    Refused {
        /// Address of the last one.
        from: IpAddr,
        /// Why that one was rejected.
        why: SenderRefusal,
        /// How many since the last such message.
        senders: u64,
    },
    /// Number of messages dropped because the queue was full.
    Overrun(u64),
    /// A tracker's program started to send; its clock may differ from before.
    Began,
    /// A tracker's program responds, with its name.
    Connected(String),
    /// A tracker's program no longer responds.
    Lost(String),
    /// The tracker sees the display by its tags, or not any more.
    SeesDisplay(bool),
    /// The tracker sees surfaces with these names, and not the display's.
    OtherSurfaces(Vec<String>),
    /// The tracker's clock was set.
    ClockSet {
        /// By how much it went ahead, in seconds; negative: back.
        by_s: f64,
        /// When it was last found as it was before.
        known_at: Instant,
    },
    /// What became of the recording that the tracker's program makes of the trial.
    Recording(TrackerRecording),
    /// A finished fixation.
    Fixation(TrackerFixation),
    /// Onset or offset of a blink.
    Blink {
        /// Closed; false: opened.
        is_onset: bool,
        /// The tracker's confidence, 0 to 1.
        confidence: f64,
        /// When.
        taken: SampleTime,
    },
}

/// Why a sender of gaze at another computer is not let in.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SenderRefusal {
    /// The session lists addresses, and not this one.
    Unlisted,
    /// It sent something else than the pairing code.
    Unpaired,
    /// The pairing code was wrong.
    WrongCode,
    /// The pairing code was not checked: too many wrong ones came before.
    Locked,
}

impl SenderRefusal {
    /// The reason in words: "gaze from ADDRESS is rejected: …".
    pub fn words(self) -> &'static str {
        match self {
            SenderRefusal::Unlisted => "gaze_from does not list it",
            SenderRefusal::Unpaired => "it does not begin with the pairing code",
            SenderRefusal::WrongCode => "the pairing code is wrong",
            SenderRefusal::Locked => "no code is checked for a while, after wrong ones",
        }
    }
}

/// A time on the tracker's clock and on ours.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SampleTime {
    /// On the tracker's clock, in nanoseconds.
    pub device_ns: u64,
    /// On this computer's clock, if the clocks were compared.
    pub at: Option<Instant>,
}

/// A fixation detected by a tracker.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TrackerFixation {
    /// Position on the display, if it was there.
    pub at: Option<[f64; 2]>,
    /// How long it was, in milliseconds.
    pub duration_ms: f64,
    /// How far its samples are spread, in degrees.
    pub dispersion_deg: f64,
    /// The tracker's confidence, 0 to 1.
    pub confidence: f64,
    /// When it began.
    pub began: SampleTime,
}
