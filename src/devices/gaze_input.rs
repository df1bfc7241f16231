//! Messages that eye trackers of all kinds send to the session.

use std::net::IpAddr;
use std::time::Instant;

use tomcom_core::gaze::GazeSample;
use tomcom_core::gaze::device_clock::StampFault;
use tomcom_session::tracker::TrackerRecording;

/// Largest number of tracker messages that wait for the session.
pub const WAITING: usize = 4096;

/// Largest amount of a time on a tracker's clock, in seconds: nanoseconds of it still are a 64-bit number (292 years).
pub const MAX_SECONDS: f64 = 9.2e9;

/// A message from an eye tracker to the session. Points are in fractions of the wall display, origin at the top left.
#[derive(Clone, Debug, PartialEq)]
pub enum TrackerMessage {
    /// Gaze sample, with the instant at which it was taken; `None`: it counts as taken when it is recorded. A sample of
    /// unknown time that may have waited to be read counts as taken when it can have arrived first. The sample's
    /// confidence is NaN if the tracker did not tell it.
    Sample(GazeSample, Option<Instant>),
    Malformed(u64),
    /// A gaze sample's time stamp is too large to be a time: it is this number.
    WrongTime(f64),
    /// Senders are rejected: they send no gaze, or are not admitted.
    Rejected {
        from: IpAddr,
        why: GazeSenderRejection,
        /// Number of senders that were rejected for the first time since the last message of this kind.
        senders: u64,
    },
    Overrun(u64),
    /// The time stamps of a sender cannot be used for this fault; `None`: they are those of a clock.
    Stamps(Option<StampFault>),
    /// The program of an eye tracker responds; its name and version.
    Connected(String),
    /// The program of an eye tracker no longer responds, for this reason.
    Lost(String),
    /// A sender whose lines were read has closed its connection; others may be there.
    Closed,
    SeesDisplay(bool),
    /// The tracker detects surfaces with these names, but not the display's surface.
    OtherSurfaces(Vec<String>),
    /// Several streams, described by these texts, could be the tracker's; none: no longer several.
    SeveralStreams(Vec<String>),
    ClockSet {
        /// Step of the tracker's clock in seconds; negative if the clock was set back.
        by_s: f64,
        /// Instant before the step at which the tracker's clock was last found unchanged.
        known_at: Instant,
    },
    Recording(TrackerRecording),
    Fixation(TrackerFixation),
    Blink {
        is_onset: bool,
        /// Confidence of the tracker in the blink, 0 to 1.
        confidence: f64,
        taken: TrackerTime,
    },
}

/// Why a gaze sender is rejected.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum GazeSenderRejection {
    Unlisted,
    Unpaired,
    WrongCode,
    /// The pairing code was not checked, because too many wrong ones came before.
    Locked,
    /// The text begins with a byte order mark of UTF-8.
    ByteOrderMark,
    /// The text is encoded as UTF-16.
    Utf16,
    HttpRequest,
    /// The text begins with this, and not with a JSON object.
    NoObject(String),
    /// Objects follow one another without a line break, or no line break came in time.
    NoLineBreak,
    /// The first line is longer than this number of bytes.
    LongLine(usize),
    /// Nothing came within this time of connecting, in seconds.
    Silent(u64),
    /// Datagrams of this other address are read, which sent a gaze sample first.
    OtherSender(IpAddr),
    Crowded,
    /// The connection had not sent a gaze sample for longer than all others, when a new one needed room.
    GaveWay,
}

impl GazeSenderRejection {
    /// The reason for the rejection in words, to complete "gaze from ADDRESS is rejected: …".
    pub fn words(&self) -> String {
        match self {
            GazeSenderRejection::Unlisted => "gaze_from does not list this address".to_string(),
            GazeSenderRejection::Unpaired => "its first line is not the pairing code".to_string(),
            GazeSenderRejection::WrongCode => "the pairing code is wrong".to_string(),
            GazeSenderRejection::Locked => "after wrong pairing codes no code is checked for a while".to_string(),
            GazeSenderRejection::ByteOrderMark => "its text begins with a byte order mark".to_string(),
            GazeSenderRejection::Utf16 => "its text is UTF-16".to_string(),
            GazeSenderRejection::HttpRequest => "it is an HTTP request, as of a web page".to_string(),
            GazeSenderRejection::NoObject(start) => format!("its data begin with \"{start}\", no JSON object"),
            GazeSenderRejection::NoLineBreak => "no line break ends its first line".to_string(),
            GazeSenderRejection::LongLine(bytes) => format!("its first line is longer than {bytes} bytes"),
            GazeSenderRejection::Silent(seconds) => format!("it connected and sent nothing for {seconds} s"),
            GazeSenderRejection::OtherSender(other) => format!("{other} sent first, and its datagrams are read"),
            GazeSenderRejection::Crowded => "as many connections as there may be send gaze".to_string(),
            GazeSenderRejection::GaveWay => "silent for longest, it gave way to a new connection".to_string(),
        }
    }

    /// What to do, so that the sender is not rejected.
    pub fn remedy(&self) -> &'static str {
        match self {
            GazeSenderRejection::Unlisted => "add the address to gaze_from under [participant]",
            GazeSenderRejection::Unpaired | GazeSenderRejection::WrongCode => {
                "let the sender send the pairing code first: {\"pair\": \"CODE\"} as its first line"
            }
            GazeSenderRejection::Locked => "wait, and let the sender send the right pairing code",
            GazeSenderRejection::ByteOrderMark => {
                "let the sender write UTF-8 without a byte order mark (in Python \"utf-8\", not \"utf-8-sig\")"
            }
            GazeSenderRejection::Utf16 => "let the sender write UTF-8",
            GazeSenderRejection::HttpRequest => "send lines of JSON over TCP or UDP, without HTTP",
            GazeSenderRejection::NoObject(_) => {
                "send a line of JSON for each sample: {\"x\": 0 to 1, \"y\": 0 to 1, \"confidence\": 0 to 1}"
            }
            GazeSenderRejection::NoLineBreak => "let the sender end each sample with a line break",
            GazeSenderRejection::LongLine(_) => "send one line for each sample, with x, y, confidence and t only",
            GazeSenderRejection::Silent(_) => "let the sender connect when it has gaze to send",
            GazeSenderRejection::OtherSender(_) => {
                "end the other sender and wait for 5 s, or set gaze_senders = \"any\" under [participant]"
            }
            GazeSenderRejection::Crowded | GazeSenderRejection::GaveWay => "end senders that are not needed",
        }
    }
}

/// Time of a tracker's event, on the tracker's clock and on this computer's.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TrackerTime {
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
