//! Export and import of raters' codes and of two raters' consensus codes, as one table.

use std::collections::BTreeSet;
use std::path::Path;

use super::codes::CodedRecording;
use super::error::RunError;
use crate::edge::log::rater_codes::{self, RaterCodeRow};
use crate::edge::log::{RecordingLock, RecordingWriteError, consensus_file};
use crate::measures::cause_codes::{ErrorCauseCode, RaterCodes};
use crate::measures::consensus::RaterConsensus;
use crate::session::settings::is_code;

/// Advice in error messages on how the table names a rater.
const RATER: &str = "a rater's code of 1 to 32 letters, digits, - and _, never a name; or two codes such as R1+R2, \
                     for the consensus of these raters";

/// Author of a row of the table of codes: one rater, or two raters with a consensus, in the order of the alphabet.
#[derive(Debug, PartialEq, Eq, PartialOrd, Ord)]
enum RowAuthor {
    Rater(String),
    Pair([String; 2]),
}

impl RowAuthor {
    fn parse(text: &str) -> Option<RowAuthor> {
        match text.split_once('+') {
            None => is_code(text).then(|| RowAuthor::Rater(text.to_string())),
            Some((one, other)) => {
                let is_pair = is_code(one) && is_code(other) && one != other;
                is_pair.then(|| RowAuthor::Pair([one.min(other).to_string(), one.max(other).to_string()]))
            }
        }
    }

    /// Takes the right to code as this author the recording in a folder.
    fn lock(&self, folder: &Path) -> Result<RecordingLock, RecordingWriteError> {
        match self {
            RowAuthor::Rater(rater) => RecordingLock::take_for_codes(folder, &[rater]),
            RowAuthor::Pair([one, other]) => RecordingLock::take_for_codes(folder, &[one, other]),
        }
    }
}

/// Imports the rows of a file into the recordings, in addition to existing codes. No row is imported if one of them is
/// invalid, or if another program codes as one of the raters: the codes of a rater are always replaced as a whole.
///
/// # Errors
/// The file cannot be read, a row does not refer to an error of these recordings, a consensus contradicts a code that
/// both raters gave, another program codes as one of the raters, or a folder is not writable.
pub fn import(recordings: &mut [CodedRecording], file: &Path) -> Result<u64, RunError> {
    let (text, rows) = rater_codes::read_export(file)?;
    let wrong =
        |row: &RaterCodeRow, found: String, remedy: &str| rater_codes::wrong_line(file, &text, row.line, found, remedy);
    let names: Vec<String> = recordings.iter().map(CodedRecording::name).collect();
    let mut imported = Vec::new();
    for row in &rows {
        let Some(index) = names.iter().position(|name| *name == row.recording) else {
            let found = format!("the recording \"{}\"", row.recording);
            let remedy = format!("one of the recordings that were given: {}", names.join(", "));
            return Err(wrong(row, found, &remedy).into());
        };
        let Some(author) = RowAuthor::parse(&row.rater) else {
            return Err(wrong(row, format!("the rater \"{}\"", row.rater), RATER).into());
        };
        if let Some((found, remedy)) = recordings[index].codable.fault(row.press, &row.code) {
            return Err(wrong(row, found, &remedy).into());
        }
        imported.push((index, author, row));
    }
    // Consensus codes are added last, since the codes of single raters can stand in later rows of the table.
    imported.sort_by_key(|(_, author, _)| matches!(author, RowAuthor::Pair(_)));
    let authors: BTreeSet<(usize, &RowAuthor)> = imported.iter().map(|(index, author, _)| (*index, author)).collect();
    let locked = |(index, author): &(usize, &RowAuthor)| author.lock(&recordings[*index].folder);
    let _locks = authors.iter().map(locked).collect::<Result<Vec<RecordingLock>, _>>()?;
    for index in authors.iter().map(|(index, _)| *index).collect::<BTreeSet<usize>>() {
        recordings[index].read_codes()?;
    }
    for (index, author, row) in &imported {
        if let Err((found, remedy)) = recordings[*index].add(author, row) {
            return Err(wrong(row, found, &remedy).into());
        }
    }
    for (index, author) in authors {
        let one = &recordings[index];
        match author {
            RowAuthor::Rater(rater) => rater_codes::write(&one.folder, rater, &one.codes[rater])?,
            RowAuthor::Pair(_) => {
                one.consensus.as_ref().map_or(Ok(()), |consensus| consensus_file::write(&one.folder, consensus))?;
            }
        }
    }
    Ok(rows.len() as u64)
}

impl CodedRecording {
    /// Adds the code of a row of the table; returns what was found and what would be right if that is not possible.
    fn add(&mut self, author: &RowAuthor, row: &RaterCodeRow) -> Result<(), (String, String)> {
        match author {
            RowAuthor::Rater(rater) => {
                self.codes.entry(rater.clone()).or_default().0.insert(row.press, row.code.clone());
                Ok(())
            }
            RowAuthor::Pair(raters) => self.settle(raters, row.press, &row.code),
        }
    }

    /// Adds a consensus code of two raters; returns what was found and what would be right if that is not possible.
    fn settle(&mut self, raters: &[String; 2], press: u64, code: &ErrorCauseCode) -> Result<(), (String, String)> {
        let new = RaterConsensus::new(&raters[0], &raters[1]);
        let own = new.raters.clone().map(|rater| self.codes.get(&rater).cloned().unwrap_or_default());
        let consensus = self.consensus.take().unwrap_or_else(|| new.clone());
        if consensus.raters != new.raters {
            let remedy = format!(
                "the consensus of {}, who settled this recording; or delete this consensus first",
                consensus.name()
            );
            return Err((format!("the consensus of {}", new.raters.join(" and ")), remedy));
        }
        let decided = RaterCodes([(press, code.clone())].into());
        let consensus = consensus.with_agreed(own.each_ref()).with_decided(&decided, own.each_ref());
        if let Some(remedy) = consensus.settled.get(&press).and_then(|settled| settled.fault()) {
            return Err((
                format!("press {press} with another cause than the one that both raters gave"),
                remedy.to_string(),
            ));
        }
        self.consensus = Some(consensus);
        Ok(())
    }
}

/// Writes all codes of the recordings into a file: codes of raters, and below them the consensus codes that still hold.
///
/// # Errors
/// The file cannot be written.
pub fn export(recordings: &[CodedRecording], file: &Path) -> Result<u64, RunError> {
    let mut rows = Vec::new();
    for one in recordings {
        let settled = one.consensus.as_ref().map(|consensus| (consensus.name(), one.current(consensus)));
        let own = one.codes.iter().map(|(rater, codes)| (rater.clone(), codes.clone()));
        for (rater, codes) in own.chain(settled) {
            rows.extend(codes.0.into_iter().map(|(press, code)| RaterCodeRow {
                line: 0,
                recording: one.name(),
                rater: rater.clone(),
                press,
                code,
            }));
        }
    }
    rater_codes::write_export(file, &rows)?;
    Ok(rows.len() as u64)
}
