//! Messages that eye trackers of all kinds send to the session.

use std::net::IpAddr;
use std::time::Instant;

use crate::gaze::GazeSample;
use crate::session::tracker::TrackerRecording;

/// Largest number of tracker messages that wait for the session.
pub const WAITING: usize = 4096;

/// Largest amount of a time on a tracker's clock, in seconds: nanoseconds of it still are a 64-bit number (292 years).
pub const MAX_SECONDS: f64 = 9.2e9;

/// A message from an eye tracker to the session. Points are in fractions of the wall display, origin at the top left.
#[derive(Clone, Debug, PartialEq)]
pub enum TrackerMessage {
    /// Gaze sample, with the time at which it was taken if the tracker's clock has been compared with this computer's.
    /// The sample's confidence is NaN if the tracker did not tell it.
    Sample(GazeSample, Option<Instant>),
    /// Number of malformed messages, lines or gaze samples that the tracker sent.
    Malformed(u64),
    /// A gaze sample's time stamp is invalid: it is this number.
    WrongTime(f64),
    /// Number of rejected senders: connections and datagrams that do not come from an eye tracker.
    Rejected(u64),
    /// Senders at other computers were rejected because they are not admitted.
    Refused {
        /// Network address of the last rejected gaze sender.
        from: IpAddr,
        /// Why the last gaze sender was rejected.
        why: GazeSenderRejection,
        /// Number of senders rejected since the last message of this kind.
        senders: u64,
    },
    /// Number of tracker messages dropped because the queue to the session was full.
    Overrun(u64),
    /// A tracker's program started to send; its clock may differ from before.
    Began,
    /// The program of an eye tracker responds; its name and version.
    Connected(String),
    /// The program of an eye tracker no longer responds, for this reason.
    Lost(String),
    /// Whether the tracker detects the display's markers now.
    SeesDisplay(bool),
    /// The tracker detects surfaces with these names, but not the display's surface.
    OtherSurfaces(Vec<String>),
    /// Somebody or something set the tracker's clock.
    ClockSet {
        /// Step of the tracker's clock in seconds; negative if the clock was set back.
        by_s: f64,
        /// Instant before the step at which the tracker's clock was last found unchanged.
        known_at: Instant,
    },
    /// State of the recording that the tracker's program makes of the trial.
    Recording(TrackerRecording),
    /// A finished fixation of the participant's gaze.
    Fixation(TrackerFixation),
    /// Onset or offset of the participant's blink.
    Blink {
        /// Whether the eyes closed (onset); false if the eyes opened (offset).
        is_onset: bool,
        /// Confidence of the tracker in the blink, 0 to 1.
        confidence: f64,
        /// Time of the blink's onset or offset, on the tracker's and this computer's clock.
        taken: TrackerTime,
    },
}

/// Why a gaze sender at another computer is not admitted.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum GazeSenderRejection {
    /// The session lists admitted network addresses, and the sender's is not among them.
    Unlisted,
    /// The sender at another computer has sent something else than the pairing code.
    Unpaired,
    /// The sender at another computer sent a wrong pairing code.
    WrongCode,
    /// The pairing code was not checked, because too many wrong ones came before.
    Locked,
}

impl GazeSenderRejection {
    /// The reason for the rejection in words, to complete "gaze from ADDRESS is rejected: …".
    pub fn words(self) -> &'static str {
        match self {
            GazeSenderRejection::Unlisted => "gaze_from does not list this address",
            GazeSenderRejection::Unpaired => "its first line is not the pairing code",
            GazeSenderRejection::WrongCode => "the pairing code is wrong",
            GazeSenderRejection::Locked => "after wrong pairing codes no code is checked for a while",
        }
    }
}

/// Time of a tracker's event, on the tracker's clock and on this computer's.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TrackerTime {
    /// Time on the tracker's clock, in nanoseconds.
    pub device_ns: i64,
    /// Time on this computer's clock, if the two clocks were compared.
    pub at: Option<Instant>,
}

/// A fixation detected by a tracker.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TrackerFixation {
    /// Position of the fixation in fractions of the display; `None` if the fixation was not on the display.
    pub at: Option<[f64; 2]>,
    /// Duration of the fixation, in milliseconds.
    pub duration_ms: f64,
    /// Spatial dispersion of the fixation's samples, in degrees.
    pub dispersion_deg: f64,
    /// Confidence of the tracker in the fixation, 0 to 1.
    pub confidence: f64,
    /// Time at which the fixation began.
    pub began: TrackerTime,
}
