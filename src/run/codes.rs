//! `tomcom codes`: raters' codes of errors, and the agreement between raters.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use serde::Serialize;

use super::error::RunError;
use super::replay::Replay;
use crate::base::words::count;
use crate::edge::file_error::FileResult;
use crate::edge::log::rater_codes;
use crate::measures::cause_codes::{Agreement, AgreementTable, Codable, Codes};
use crate::session::settings::{ParticipantKind, is_code};

/// A recording with the codes of its errors.
#[derive(Clone, Debug)]
pub struct CodedRecording {
    /// The recording's folder.
    pub folder: PathBuf,
    /// The errors that can be coded, and where they can lie.
    pub codable: Codable,
    /// Codes by rater.
    pub codes: BTreeMap<String, Codes>,
    /// True causes, for a simulated participant.
    pub known: Option<Codes>,
}

impl CodedRecording {
    /// Reads a recording and the codes beside it.
    ///
    /// # Errors
    /// The recording cannot be read, or a file with codes is damaged.
    pub fn open(recording: &Path) -> FileResult<CodedRecording> {
        let mut replay = Replay::open(recording)?;
        if replay.session().spec.participant.kind != ParticipantKind::Simulated {
            replay = replay.without_causes();
        }
        replay.run()?;
        let judged = &replay.follower.judged;
        let kitchen = &replay.session().kitchen;
        let is_known = !judged.is_empty() && judged.iter().all(|press| press.belief_known);
        let folder = replay.log().folder().to_path_buf();
        let codable = Codable::from_presses(kitchen, judged);
        Ok(CodedRecording {
            codes: rater_codes::read_all(&folder, &codable)?,
            codable,
            known: is_known.then(|| Codes::known(kitchen, judged)),
            folder,
        })
    }

    /// The name of its folder.
    pub fn name(&self) -> String {
        let resolved = self.folder.canonicalize().unwrap_or_else(|_| self.folder.clone());
        resolved.file_name().unwrap_or_default().to_string_lossy().into_owned()
    }
}

/// Output of `tomcom codes`.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct CodesSummary {
    /// The recordings with what each rater has coded.
    pub recordings: Vec<CodedRecordingSummary>,
    /// Agreement of each pair of raters with common errors.
    pub agreements: Vec<RaterPairSummary>,
    /// Agreement of each rater with the true causes of simulated participants.
    pub known: Vec<RaterPairSummary>,
}

/// Summary of one recording.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct CodedRecordingSummary {
    /// The name of the recording's folder.
    pub recording: String,
    /// Number of errors.
    pub errors: u64,
    /// Number of errors coded by each rater.
    pub coded: BTreeMap<String, u64>,
}

/// Agreement of two raters.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct RaterPairSummary {
    /// The first rater.
    pub of: String,
    /// The second rater, or "simulation" for what a simulated participant believed.
    pub with: String,
    /// How far they agree, over all recordings together.
    #[serde(flatten)]
    pub agreement: Agreement,
}

impl CodesSummary {
    /// Summary of recordings.
    pub fn from_recordings(recordings: &[CodedRecording]) -> CodesSummary {
        let mut pairs: BTreeMap<(String, String), AgreementTable> = BTreeMap::new();
        let mut known: BTreeMap<String, AgreementTable> = BTreeMap::new();
        for one in recordings {
            for (index, (of, codes)) in one.codes.iter().enumerate() {
                for (with, other) in one.codes.iter().skip(index + 1) {
                    pairs.entry((of.clone(), with.clone())).or_default().add(codes, other);
                }
                if let Some(truth) = &one.known {
                    known.entry(of.clone()).or_default().add(codes, truth);
                }
            }
        }
        let recording = |one: &CodedRecording| CodedRecordingSummary {
            recording: one.name(),
            errors: one.codable.errors.len() as u64,
            coded: one.codes.iter().map(|(rater, codes)| (rater.clone(), codes.0.len() as u64)).collect(),
        };
        let pair = |((of, with), table): ((String, String), AgreementTable)| RaterPairSummary {
            of,
            with,
            agreement: table.agreement(),
        };
        CodesSummary {
            recordings: recordings.iter().map(recording).collect(),
            agreements: pairs.into_iter().map(pair).collect(),
            known: known.into_iter().map(|(of, table)| pair(((of, "simulation".to_string()), table))).collect(),
        }
    }
}

/// Imports the rows of a file into the recordings, in addition to existing codes. Nothing is written if a row is invalid.
///
/// # Errors
/// The file cannot be read, a row does not refer to an error of these recordings, or a folder is not writable.
pub fn import(recordings: &mut [CodedRecording], file: &Path) -> Result<u64, RunError> {
    let (text, rows) = rater_codes::read_export(file)?;
    let mut changed = vec![Vec::new(); recordings.len()];
    let names: Vec<String> = recordings.iter().map(CodedRecording::name).collect();
    for row in &rows {
        let wrong = |found: String, remedy: &str| rater_codes::wrong_line(file, &text, row.line, found, remedy);
        let Some(index) = names.iter().position(|name| *name == row.recording) else {
            let found = format!("the recording \"{}\"", row.recording);
            let remedy = format!("a recording that was named: {}", names.join(", "));
            return Err(wrong(found, &remedy).into());
        };
        let one = &mut recordings[index];
        if !is_code(&row.rater) {
            let remedy = "a code of 1 to 32 letters, digits, - and _; never a name";
            return Err(wrong(format!("the rater \"{}\"", row.rater), remedy).into());
        }
        if let Some((found, remedy)) = one.codable.fault(row.press, &row.code) {
            return Err(wrong(found, &remedy).into());
        }
        one.codes.entry(row.rater.clone()).or_default().0.insert(row.press, row.code.clone());
        changed[index].push(row.rater.clone());
    }
    for (one, mut raters) in recordings.iter().zip(changed) {
        raters.sort();
        raters.dedup();
        for rater in raters {
            rater_codes::write(&one.folder, &rater, &one.codes[&rater])?;
        }
    }
    Ok(rows.len() as u64)
}

/// Writes all codes of the recordings into a file.
///
/// # Errors
/// The file cannot be written.
pub fn export(recordings: &[CodedRecording], file: &Path) -> Result<u64, RunError> {
    let mut rows = Vec::new();
    for one in recordings {
        for (rater, codes) in &one.codes {
            rows.extend(codes.0.iter().map(|(press, code)| rater_codes::CodeRow {
                line: 0,
                recording: one.name(),
                rater: rater.clone(),
                press: *press,
                code: code.clone(),
            }));
        }
    }
    rater_codes::write_export(file, &rows)?;
    Ok(rows.len() as u64)
}

/// The summary as text.
pub fn describe(figures: &CodesSummary) -> String {
    let mut text = String::new();
    for one in &figures.recordings {
        let coded: Vec<String> = one.coded.iter().map(|(rater, number)| format!("{rater} {number}")).collect();
        let coded = match coded.is_empty() {
            true => "no rater has coded this recording yet".to_string(),
            false => format!("coded: {}", coded.join(", ")),
        };
        text += &format!("{}: {}, {coded}\n", one.recording, count(one.errors, "error", "errors"));
    }
    let number = |value: Option<f64>| value.map_or("-".to_string(), |value| format!("{value:.2}"));
    for pair in figures.agreements.iter().chain(&figures.known) {
        let Agreement { errors, same_cause, kappa_cause, beliefs, same_aspect, kappa_aspect } = pair.agreement;
        text += &format!(
            "{} and {}: the same cause for {same_cause} of {errors} errors (kappa {}), the same wrong belief for \
             {same_aspect} of {beliefs} (kappa {})\n",
            pair.of,
            pair.with,
            number(kappa_cause),
            number(kappa_aspect),
        );
    }
    text
}
