//! Annotations as subtitles (WebVTT), which players show over the first film.

use super::{RecordingAnnotations, on_one_line};

/// How a file begins that this program wrote.
pub const UNTOUCHED: &str = "WEBVTT written by tomcom export";

/// The text of the file.
pub fn text(annotations: &RecordingAnnotations) -> String {
    let mut cues: Vec<(u64, u64, String)> = Vec::new();
    for tier in &annotations.tiers {
        for annotation in &tier.annotations {
            let begin = annotation.begin.ms();
            cues.push((begin, annotation.end.ms().max(begin + 1), format!("{}: {}", tier.name, annotation.words)));
        }
    }
    cues.sort();
    let cue = |(begin, end, words): &(u64, u64, String)| {
        format!("{} --> {}\n{}\n\n", clock(*begin), clock(*end), plain(words))
    };
    format!("{UNTOUCHED}\n\n{}", cues.iter().map(cue).collect::<String>())
}

/// `00:01:02.345`.
fn clock(ms: u64) -> String {
    let (seconds, ms) = (ms / 1000, ms % 1000);
    format!("{:02}:{:02}:{:02}.{ms:03}", seconds / 3600, seconds / 60 % 60, seconds % 60)
}

/// On one line, without what the format takes for its own signs.
fn plain(words: &str) -> String {
    on_one_line(words).replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;")
}
