//! Command `tomcom replay RECORDING... --offers`: replays recordings for [`tomcom_study::analysis::offer_steadiness`].

use std::path::Path;

use tomcom_session::files::file_error::FileResult;
use tomcom_session::log::LogReader;
use tomcom_session::{Session, apply};
use tomcom_study::analysis::offer_steadiness::{OfferSteadinessSummary, OfferSteadinessSums, OfferSteadinessTally};
use tomcom_study::gathered::GatheredRecordings;
use tomcom_study::parallel;

/// Measures how steady the offers of recordings are. `done` is called after each recording.
///
/// # Errors
/// A recording cannot be read or replayed.
pub fn measure(recordings: &GatheredRecordings, done: impl Fn() + Sync) -> FileResult<OfferSteadinessSummary> {
    let mut sums = OfferSteadinessSums::default();
    for one in parallel::each(&recordings.paths, |recording| tally(recording), done) {
        let (tally, session) = one?;
        sums.add(tally, &session);
    }
    Ok(sums.summary())
}

/// Measures the steadiness of offers in one recording. Since offers depend on the session's state only, no belief
/// estimate is computed.
fn tally(recording: &Path) -> FileResult<(OfferSteadinessTally, Session)> {
    let mut log = LogReader::open(recording)?;
    let mut session = log.session();
    let mut tally = OfferSteadinessTally::new(&session);
    while let Some(line) = log.next_line()? {
        tally.before(&session, line.stamped.time);
        apply(&mut session, &line.stamped).map_err(|error| log.refused(&line, error))?;
        tally.after(&session);
    }
    Ok((tally, session))
}
