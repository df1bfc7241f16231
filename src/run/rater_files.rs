//! Opens and saves the codes of one rater, or of two raters who settle their differences, for the console.

use super::error::ReviewError;
use super::seekable_replay::SeekableReplay;
use crate::console::coding::{CodingRaters, RaterSession};
use tomcom_core::measures::raters::{CodableErrors, RaterCodes, RaterConsensus};
use tomcom_session::error_list::ListedError;
use tomcom_session::files::file_error::FileError;
use tomcom_session::log::{RecordingWriteError, consensus_file, rater_codes};
use tomcom_session::person_code;

/// The coding session of one rater, with the codes that the rater gave earlier.
///
/// # Errors
/// A file with codes is damaged.
pub(super) fn of_rater(film: &SeekableReplay, rater: &str) -> Result<RaterSession, ReviewError> {
    let follower = &film.replay.follower;
    let codable = CodableErrors::from_presses(&follower.session.kitchen, &follower.judged);
    let mut all = rater_codes::read_all(film.replay.log().folder(), &codable)?;
    if let Some(other) = person_code::differing_in_case(rater, all.keys().map(String::as_str)) {
        let found = format!("the rater {rater}, beside codes of the rater {other}");
        let remedy = format!("--rater {other}, or a code that differs in more than capital letters");
        return Err(FileError::from_finding(film.replay.log().folder(), found, remedy).into());
    }
    let codes = all.remove(rater).unwrap_or_default();
    let party = CodingRaters::Rater(rater.to_string());
    let mut session = RaterSession::new(party, ListedError::all(follower), codes);
    let is_complete = |codes: &RaterCodes| codable.errors.iter().all(|press| codes.0.contains_key(press));
    session.finished = all.into_iter().filter(|(_, codes)| is_complete(codes)).map(|(rater, _)| rater).collect();
    Ok(session)
}

/// The session of two raters who settle their disagreements. Codes on which the raters agree become consensus codes.
///
/// # Errors
/// A rater has coded nothing, other raters have settled this recording, a file is damaged, or the folder cannot be
/// written to.
pub(super) fn of_pair(film: &SeekableReplay, raters: [&str; 2]) -> Result<RaterSession, ReviewError> {
    let (log, follower) = (film.replay.log(), &film.replay.follower);
    let codable = CodableErrors::from_presses(&follower.session.kitchen, &follower.judged);
    let mut all = rater_codes::read_all(log.folder(), &codable)?;
    let new = RaterConsensus::new(raters[0], raters[1]);
    rater_codes::check_named(log.folder(), &new.raters, &all.keys().cloned().collect())?;
    let before = consensus_file::read(log.folder(), &codable)?;
    if let Some(other) = before.as_ref().filter(|before| before.raters != new.raters) {
        let found = format!("the consensus of {}", other.raters.join(" and "));
        let remedy = format!("--settle {}; or delete {} first", other.raters.join(" "), consensus_file::CONSENSUS_NAME);
        return Err(FileError::from_finding(log.folder(), found, remedy).into());
    }
    let own = new.raters.clone().map(|rater| all.remove(&rater).unwrap_or_default());
    let mut consensus = before.unwrap_or(new).with_agreed(own.each_ref());
    let open = own[0].disagreements(&own[1]);
    let errors: Vec<ListedError> =
        ListedError::all(follower).into_iter().filter(|error| open.contains(&error.press)).collect();
    let current = consensus.current(own.each_ref()).0.into_iter();
    let codes = RaterCodes(current.filter(|(press, _)| open.contains(press)).collect());
    // The session's codes have the errors that the raters can still change; the consensus has the others.
    consensus.settled.retain(|press, _| !codes.0.contains_key(press));
    let session = RaterSession::new(CodingRaters::Pair { consensus, own }, errors, codes);
    save(film, &session)?;
    Ok(session)
}

/// Message when a recording is opened for raters: at which error the session begins, and which codes changed since the
/// errors were settled.
pub(super) fn opening_words(session: &RaterSession) -> String {
    let name = session.name();
    let Some(open) = session.first_open() else {
        return format!("{name}: {}", session.next_step().unwrap_or_default());
    };
    let first = match session.party {
        CodingRaters::Pair { .. } => "to be settled",
        CodingRaters::Rater(_) => "without a code",
    };
    let begins = format!("error {} is the first {first}", session.errors[open].error);
    let reopened = match &session.party {
        CodingRaters::Pair { consensus, own } => consensus.changed(own.each_ref()),
        CodingRaters::Rater(_) => Vec::new(),
    };
    let mut changed: Vec<&str> = reopened.iter().map(|changed| changed.rater.as_str()).collect();
    changed.dedup();
    match changed.is_empty() {
        true => format!("{name}: {}; {begins}", session.progress()),
        false => format!(
            "{name}: {}; settled errors are open again, since {} changed codes",
            session.progress(),
            changed.join(" and ")
        ),
    }
}

/// Message when the raters have left the recording: what they coded, and where it is saved. Saves codes that could not
/// be saved before.
///
/// # Errors
/// The folder cannot be written to.
pub(super) fn closing_words(film: &SeekableReplay, session: &RaterSession) -> Result<String, RecordingWriteError> {
    if !session.is_saved {
        save(film, session)?;
    }
    let folder = film.replay.log().folder().display();
    Ok(format!("{}: {}; all codes are saved in {folder}", session.name(), session.progress()))
}

/// Saves the raters' codes beside the log.
///
/// # Errors
/// The folder cannot be written to.
pub(super) fn save(film: &SeekableReplay, session: &RaterSession) -> Result<(), RecordingWriteError> {
    let folder = film.replay.log().folder();
    match &session.party {
        CodingRaters::Rater(rater) => rater_codes::write(folder, rater, &session.codes),
        CodingRaters::Pair { consensus, own } => {
            consensus_file::write(folder, &consensus.clone().with_decided(&session.codes, own.each_ref()))
        }
    }
}
