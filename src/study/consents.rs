//! Reads the consents with which recordings begin, including practice recordings, which are not analysed as trials.

use std::path::Path;

use crate::recorded_consent::RecordedConsent;
use tomcom_session::Event;
use tomcom_session::files::file_error::FileResult;
use tomcom_session::log::LogReader;
use tomcom_session::protocol::ProtocolEvent;

/// The consent with which the recording begins (in its first part); `None` if the recording does not begin with a
/// consent.
///
/// # Errors
/// The recording cannot be read.
pub(super) fn read(recording: &Path) -> FileResult<Option<RecordedConsent>> {
    let mut log = LogReader::open(recording)?;
    let participant = log.header.session.participant.code.clone();
    if let [first, _, ..] = &log.logs()[..] {
        log = LogReader::open(first)?;
    }
    while let Some(line) = log.next_line()? {
        match line.stamped.event {
            Event::Protocol(ProtocolEvent::ConsentGiven { on, digest, .. }) => {
                return Ok(Some(RecordedConsent { participant, on, started: log.header.started.clone(), digest }));
            }
            // Consent is given before the first phase of the recording, or not at all.
            Event::Protocol(ProtocolEvent::PhaseStarted { .. }) | Event::TrialStarted => return Ok(None),
            _ => {}
        }
    }
    Ok(None)
}
