//! What a session reads from a file of recorded gaze, for the checks before a trial and on a computer.

use super::{GazeSample, MIN_CONFIDENCE};
use crate::base::words::count;

/// Time without a sample that counts as a gap, in seconds.
pub const GAP_S: f64 = 1.0;

/// Numbers about the gaze that a session reads from a file.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct RecordedGazeSummary {
    /// Number of gaze samples that are replayed.
    pub samples: u64,
    /// Number of samples on the display whose confidence is enough for the belief estimate.
    pub usable: u64,
    /// Time from the first to the last sample, in seconds.
    pub seconds: f64,
    /// Number of gaps: times of more than [`GAP_S`] without a sample.
    pub gaps: u64,
    /// Duration of the longest gap, in seconds.
    pub longest_gap_s: f64,
    /// Number of samples without a confidence; they have the one that the settings give them.
    pub without_confidence: u64,
    /// Number of lines that are no samples.
    pub malformed: u64,
    /// What is wrong in the first malformed line, with the line's number.
    pub first_malformed: Option<String>,
    /// What was odd in the file and how it was read: steps of the clock, times in another unit.
    pub remarks: Vec<String>,
}

impl RecordedGazeSummary {
    /// The summary of these samples, each with its time in seconds; what else was found in the file is added.
    pub fn from_samples(samples: &[(f64, GazeSample)]) -> RecordedGazeSummary {
        let mut summary = RecordedGazeSummary { samples: samples.len() as u64, ..RecordedGazeSummary::default() };
        let is_usable = |sample: &GazeSample| sample.is_on_display() && sample.confidence >= MIN_CONFIDENCE;
        summary.usable = samples.iter().filter(|(_, sample)| is_usable(sample)).count() as u64;
        let (mut first_s, mut last_s) = (f64::INFINITY, f64::NEG_INFINITY);
        for (at_s, _) in samples {
            let gap_s = at_s - last_s;
            if gap_s.is_finite() && gap_s > GAP_S {
                summary.gaps += 1;
                summary.longest_gap_s = summary.longest_gap_s.max(gap_s);
            }
            (first_s, last_s) = (first_s.min(*at_s), last_s.max(*at_s));
        }
        if summary.samples > 0 {
            summary.seconds = last_s - first_s;
        }
        summary
    }

    /// The numbers in words: samples, seconds, gaps, malformed lines.
    pub fn words(&self) -> String {
        let mut words = format!("{} in {:.1} s", count(self.samples, "sample", "samples"), self.seconds);
        if self.usable < self.samples {
            words += &format!(", {} of them on the display with enough confidence", self.usable);
        }
        words += &match self.gaps {
            0 => format!("; no gap of more than {GAP_S:.0} s"),
            gaps => format!(
                "; {} of more than {GAP_S:.0} s, the longest of {:.1} s",
                count(gaps, "gap", "gaps"),
                self.longest_gap_s
            ),
        };
        if self.without_confidence > 0 {
            words += &format!("; {} without confidence", count(self.without_confidence, "sample", "samples"));
        }
        if self.malformed > 0 {
            words += &format!("; {}", count(self.malformed, "malformed line", "malformed lines"));
            words += &self.first_malformed.as_ref().map_or(String::new(), |first| format!(" ({first})"));
        }
        words
    }
}
