//! Export and import of raters' codes and of two raters' consensus codes, as one table.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

use super::codes::CodedRecording;
use tomcom_core::measures::raters::{ErrorCauseCode, RaterCodes};
use tomcom_core::measures::raters::RaterConsensus;
use tomcom_session::files::file_error::FileResult;
use tomcom_session::log::RecordingError;
use tomcom_session::log::rater_codes::{self, RaterCodeRow};
use tomcom_session::log::{RecordingLock, RecordingWriteError, consensus_file};
use tomcom_session::person_code;

/// Advice in error messages on how the table names a rater.
const RATER: &str = "a rater's code of a letter and up to 15 letters, digits, - and _, never a name; or two codes such as \
                     R1+R2, for the consensus of these raters";

/// Author of a row of the table of codes: one rater, or two raters with a consensus, in the order of the alphabet.
#[derive(Debug, PartialEq, Eq, PartialOrd, Ord)]
enum RowAuthor {
    Rater(String),
    Pair([String; 2]),
}

impl RowAuthor {
    fn parse(text: &str) -> Option<RowAuthor> {
        let is_code = |text: &str| person_code::fault(text).is_none();
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

/// Codes in a table that can be imported into recordings.
#[derive(Debug)]
pub struct ImportableCodes {
    file: PathBuf,
    text: String,
    /// Rows of the table, each with the index of its recording and its author; consensus codes last, since the codes of
    /// single raters can stand in later rows of the table.
    rows: Vec<(usize, RowAuthor, RaterCodeRow)>,
    /// Raters in the table of whom none of the recordings has codes yet: perhaps somebody who was typed wrong.
    pub new_raters: Vec<String>,
    /// Number of codes of these recordings that the table changes, by rater, or by consensus such as `R1+R2`.
    pub changed: BTreeMap<String, u64>,
    /// Raters of whom the recordings have codes.
    pub known_raters: Vec<String>,
}

/// Reads a table of codes of these recordings.
///
/// # Errors
/// The file cannot be read, a row does not refer to an error of these recordings or names no rater, or two raters differ
/// in capital letters only.
pub fn read(recordings: &[CodedRecording], file: &Path) -> FileResult<ImportableCodes> {
    let (text, rows) = rater_codes::read_export(file)?;
    let wrong =
        |row: &RaterCodeRow, found: String, remedy: &str| rater_codes::wrong_line(file, &text, row.line, found, remedy);
    let names: Vec<String> = recordings.iter().map(CodedRecording::name).collect();
    let known: BTreeSet<&str> = recordings.iter().flat_map(|one| one.codes.keys().map(String::as_str)).collect();
    let (mut imported, mut new, mut changed) = (Vec::new(), BTreeSet::new(), BTreeMap::new());
    for row in rows {
        let Some(index) = names.iter().position(|name| *name == row.recording) else {
            let found = format!("the recording \"{}\"", row.recording);
            let remedy = format!("one of the recordings that were given: {}", names.join(", "));
            return Err(wrong(&row, found, &remedy));
        };
        let Some(author) = RowAuthor::parse(&row.rater) else {
            return Err(wrong(&row, format!("the rater \"{}\"", row.rater), RATER));
        };
        if let Some((found, remedy)) = recordings[index].codable.fault(row.press, &row.code) {
            return Err(wrong(&row, found, &remedy));
        }
        if let RowAuthor::Rater(rater) = &author {
            let others = known.iter().copied().chain(new.iter().map(String::as_str));
            if let Some(other) = person_code::differing_in_case(rater, others) {
                let found = format!("the rater \"{rater}\", beside the rater {other}");
                return Err(wrong(&row, found, "one rater, or raters whose codes differ in more than capital letters"));
            }
            if !known.contains(rater.as_str()) {
                new.insert(rater.clone());
            }
        }
        if let Some((name, before)) = recordings[index].code_by(&author, row.press)
            && *before != row.code
        {
            *changed.entry(name).or_default() += 1;
        }
        imported.push((index, author, row));
    }
    imported.sort_by_key(|(_, author, _)| matches!(author, RowAuthor::Pair(_)));
    let known_raters = known.into_iter().map(str::to_string).collect();
    let new_raters = new.into_iter().collect();
    Ok(ImportableCodes { file: file.to_path_buf(), text, rows: imported, new_raters, changed, known_raters })
}

impl ImportableCodes {
    /// Adds the codes to those of the recordings. No row is imported if one of them is invalid, or if another program
    /// codes as one of the raters: the codes of a rater are always replaced as a whole. Returns the number of rows.
    ///
    /// # Errors
    /// A consensus is of raters who have not coded, or contradicts a code that both raters gave; another program codes
    /// as one of the raters; or a folder is not writable.
    pub fn import(&self, recordings: &mut [CodedRecording]) -> Result<u64, RecordingError> {
        let authors: BTreeSet<(usize, &RowAuthor)> =
            self.rows.iter().map(|(index, author, _)| (*index, author)).collect();
        let locked = |(index, author): &(usize, &RowAuthor)| author.lock(&recordings[*index].folder);
        let _locks = authors.iter().map(locked).collect::<Result<Vec<RecordingLock>, _>>()?;
        for index in authors.iter().map(|(index, _)| *index).collect::<BTreeSet<usize>>() {
            recordings[index].read_codes()?;
        }
        for (index, author, row) in &self.rows {
            if let Err((found, remedy)) = recordings[*index].add(author, row) {
                return Err(rater_codes::wrong_line(&self.file, &self.text, row.line, found, &remedy).into());
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
        Ok(self.rows.len() as u64)
    }
}

impl CodedRecording {
    /// The code that an author has given to a press so far, with the author's name in tables.
    fn code_by(&self, author: &RowAuthor, press: u64) -> Option<(String, &ErrorCauseCode)> {
        match author {
            RowAuthor::Rater(rater) => Some((rater.clone(), self.codes.get(rater)?.0.get(&press)?)),
            RowAuthor::Pair(raters) => {
                let consensus = self.consensus.as_ref().filter(|consensus| consensus.raters == *raters)?;
                Some((consensus.name(), &consensus.settled.get(&press)?.code))
            }
        }
    }

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
        if let Some(rater) = new.without_codes(own.each_ref()) {
            let remedy = "raters who have both coded errors of this recording, each alone".to_string();
            return Err((
                format!("a consensus of {}, while {rater} has coded nothing", new.raters.join(" and ")),
                remedy,
            ));
        }
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
pub fn export(recordings: &[CodedRecording], file: &Path) -> Result<u64, RecordingError> {
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
