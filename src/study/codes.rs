//! Command `tomcom codes`: raters' codes of errors, agreement and disagreements between raters, and their consensus; export
//! and import of codes, and of consensus codes, as one table.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

use serde::Serialize;

use crate::analysis::annotations::codes::{self as annotations, AnnotatedCode};
use crate::figures::IdenticalCodes;
use crate::standing::exclusion_status;
use tomcom_core::base::text::{count, decimal, did_you_mean};
use tomcom_core::measures::raters::{
    AgreementTable, CodableErrors, ErrorCauseCode, RaterAgreement, RaterCodes, RaterConsensus, RaterPair, of_most,
};
use tomcom_session::error_list::ListedError;
use tomcom_session::files::file_error::{self, FileResult};
use tomcom_session::history::wording;
use tomcom_session::log::rater_codes::{self, RaterCodeRow};
use tomcom_session::log::{RecordingError, RecordingLock, RecordingWriteError, consensus_file};
use tomcom_session::person_code;
use tomcom_session::replay::RecordingReplay;
use tomcom_session::settings::ParticipantKind;

#[derive(Clone, Debug)]
pub struct CodedRecording {
    pub folder: PathBuf,
    /// The errors of the recording that can be coded, and the false beliefs that can be named as causes.
    pub codable: CodableErrors,
    pub errors: Vec<ListedError>,
    pub codes: BTreeMap<String, RaterCodes>,
    pub consensus: Option<RaterConsensus>,
    pub known: Option<RaterCodes>,
    /// Why its errors never count, in words: practice, or a trial that is left out.
    pub left_out: Option<String>,
}

impl CodedRecording {
    /// Errors: the recording cannot be read, or a file with codes is damaged.
    pub fn open(recording: &Path) -> FileResult<CodedRecording> {
        let mut replay = RecordingReplay::open(recording)?;
        if replay.session().spec.participant.kind != ParticipantKind::Simulated {
            replay = replay.without_causes();
        }
        replay.run()?;
        let judged = &replay.follower.judged;
        let kitchen = &replay.session().kitchen;
        let is_known = !judged.is_empty() && judged.iter().all(|press| press.belief_known);
        let folder = replay.log().folder().to_path_buf();
        let session = &replay.follower.session;
        let is_practice = session.spec.step.as_ref().is_some_and(|step| step.period.is_none());
        let left_out = match is_practice {
            true => Some("practice".to_string()),
            false => exclusion_status(session, replay.log())?.left_out(session, replay.log().ending()),
        };
        let codable = CodableErrors::from_presses(kitchen, judged);
        Ok(CodedRecording {
            codes: rater_codes::read_all(&folder, &codable)?,
            consensus: consensus_file::read(&folder, &codable)?,
            codable,
            errors: ListedError::all(&replay.follower),
            known: is_known.then(|| RaterCodes::known(kitchen, judged)),
            left_out,
            folder,
        })
    }

    /// Reads the codes beside the recording again. Errors: a file with codes is damaged.
    pub(super) fn read_codes(&mut self) -> FileResult<()> {
        self.codes = rater_codes::read_all(&self.folder, &self.codable)?;
        self.consensus = consensus_file::read(&self.folder, &self.codable)?;
        Ok(())
    }

    pub fn name(&self) -> String {
        let resolved = self.folder.canonicalize().unwrap_or_else(|_| self.folder.clone());
        resolved.file_name().unwrap_or_default().to_string_lossy().into_owned()
    }

    /// The consensus codes that still hold because the raters have not changed their own codes.
    pub fn current(&self, consensus: &RaterConsensus) -> RaterCodes {
        let none = RaterCodes::default();
        consensus.current(consensus.raters.each_ref().map(|rater| self.codes.get(rater).unwrap_or(&none)))
    }

    fn identical(&self) -> Vec<IdenticalCodes> {
        let (raters, errors) = (self.codes.keys(), self.codable.errors.len());
        let pairs = raters.clone().enumerate().flat_map(|(index, one)| {
            raters.clone().skip(index + 1).map(|other| RaterPair::named(&self.codes, &[one.clone(), other.clone()]))
        });
        let identical = pairs.filter(|pair| pair.is_identical(errors));
        let told =
            |pair: RaterPair| IdenticalCodes { recording: self.name(), raters: pair.name(), errors: errors as u64 };
        identical.map(told).collect()
    }

    fn settled(&self) -> Option<ConsensusSummary> {
        let consensus = self.consensus.as_ref()?;
        let none = RaterCodes::default();
        let own = consensus.raters.each_ref().map(|rater| self.codes.get(rater).unwrap_or(&none));
        let [of, with] = consensus.raters.clone();
        let agreed = consensus.agreed() as u64;
        let shared = consensus.current(own).0.len() as u64;
        let missing = consensus.without_codes(own).map(str::to_string);
        let changed = if missing.is_some() { Vec::new() } else { consensus.changed(own) };
        let stale = changed.into_iter().map(|changed| ChangedRaterCode {
            error: self.codable.errors.partition_point(|&press| press < changed.press) as u64 + 1,
            press: changed.press,
            rater: changed.rater,
        });
        let errors = self.codable.errors.len() as u64;
        let (settled, open) = (shared.saturating_sub(agreed), errors - shared);
        Some(ConsensusSummary { of, with, agreed, settled, open, missing, stale: stale.collect() })
    }

    fn disagreements(&self, of: (&String, &RaterCodes), with: (&String, &RaterCodes)) -> Vec<RaterDisagreement> {
        let differ = of.1.disagreements(with.1);
        let is_pairs =
            |consensus: &&RaterConsensus| consensus.raters.contains(of.0) && consensus.raters.contains(with.0);
        let consensus = self.consensus.as_ref().filter(is_pairs);
        let settled = consensus.map(|consensus| self.current(consensus)).unwrap_or_default();
        let listed = self.errors.iter().filter(|error| differ.contains(&error.press));
        let disagreement = |error: &ListedError| {
            let (of_code, with_code) = (of.1.0.get(&error.press)?, with.1.0.get(&error.press)?);
            let parts = |code: &ErrorCauseCode| (code.kind().name().to_string(), code.aspect().map(str::to_string));
            let ((of_cause, of_aspect), (with_cause, with_aspect)) = (parts(of_code), parts(with_code));
            let shared = settled.0.get(&error.press);
            let (settled_cause, settled_aspect) = shared.map(parts).unzip();
            Some(RaterDisagreement {
                recording: self.name(),
                error: error.clone(),
                of: of.0.clone(),
                with: with.0.clone(),
                of_cause,
                of_aspect,
                with_cause,
                with_aspect,
                settled_cause,
                settled_aspect: settled_aspect.flatten(),
                words: [wording::code(of_code), wording::code(with_code)],
                settled_words: shared.map(wording::code),
            })
        };
        listed.filter_map(disagreement).collect()
    }
}

/// Raters' codes, agreement and disagreements: the output of `tomcom codes`.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct InterRaterSummary {
    pub recordings: Vec<CodedRecordingSummary>,
    /// Agreement of each pair of raters who coded common errors. A consensus does not count as a rater.
    pub agreements: Vec<RaterPairSummary>,
    pub known: Vec<RaterPairSummary>,
    pub disagreements: Vec<RaterDisagreement>,
}

#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct CodedRecordingSummary {
    pub recording: String,
    pub errors: u64,
    pub coded: BTreeMap<String, u64>,
    pub consensus: Option<ConsensusSummary>,
    /// Why its errors never count; null if they do.
    pub left_out: Option<String>,
    /// Pairs of raters ("R1+R2") who gave the same codes to all errors; absent if there are none.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub identical: Vec<IdenticalCodes>,
}

#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ConsensusSummary {
    pub of: String,
    pub with: String,
    pub agreed: u64,
    /// Number of errors with a valid consensus code, without those that both raters coded alike.
    pub settled: u64,
    pub open: u64,
    /// The rater of whom there are no codes any more; null if there are codes of both.
    pub missing: Option<String>,
    pub stale: Vec<ChangedRaterCode>,
}

#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct ChangedRaterCode {
    /// Number of the error in the recording, from 1.
    pub error: u64,
    pub press: u64,
    pub rater: String,
}

#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct RaterDisagreement {
    pub recording: String,
    #[serde(flatten)]
    pub error: ListedError,
    pub of: String,
    pub with: String,
    pub of_cause: String,
    /// State aspect that the participant believed wrong according to the first rater; null for other causes.
    pub of_aspect: Option<String>,
    pub with_cause: String,
    pub with_aspect: Option<String>,
    /// Cause of the error in the consensus code; null without consensus, or if a rater changed a code since.
    pub settled_cause: Option<String>,
    pub settled_aspect: Option<String>,
    #[serde(skip)]
    pub words: [String; 2],
    #[serde(skip)]
    pub settled_words: Option<String>,
}

#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct RaterPairSummary {
    pub of: String,
    /// Identifier of the second rater of the pair, or "simulation" for the true causes of a simulated participant.
    pub with: String,
    #[serde(flatten)]
    pub agreement: RaterAgreement,
}

impl InterRaterSummary {
    pub fn from_recordings(recordings: &[CodedRecording]) -> InterRaterSummary {
        let mut pairs: BTreeMap<(String, String), (AgreementTable, Vec<RaterDisagreement>)> = BTreeMap::new();
        let mut known: BTreeMap<String, AgreementTable> = BTreeMap::new();
        for one in recordings {
            for (index, (of, codes)) in one.codes.iter().enumerate() {
                for (with, other) in one.codes.iter().skip(index + 1) {
                    let (table, differ) = pairs.entry((of.clone(), with.clone())).or_default();
                    table.add(codes, other);
                    differ.extend(one.disagreements((of, codes), (with, other)));
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
            consensus: one.settled(),
            left_out: one.left_out.clone(),
            identical: one.identical(),
        };
        let pair = |(of, with): (String, String), table: AgreementTable| RaterPairSummary {
            of,
            with,
            agreement: table.agreement(),
        };
        let (mut agreements, mut disagreements) = (Vec::new(), Vec::new());
        for (raters, (table, differ)) in pairs {
            agreements.push(pair(raters, table));
            disagreements.extend(differ);
        }
        InterRaterSummary {
            recordings: recordings.iter().map(recording).collect(),
            agreements,
            known: known.into_iter().map(|(of, table)| pair((of, "simulation".to_string()), table)).collect(),
            disagreements,
        }
    }
}

pub fn describe(figures: &InterRaterSummary) -> String {
    let mut text = String::new();
    for one in &figures.recordings {
        let coded: Vec<String> = one.coded.iter().map(|(rater, number)| format!("{rater} {number}")).collect();
        let coded = match coded.is_empty() {
            true if one.left_out.is_some() || one.errors == 0 => "need not be coded".to_string(),
            true => "no rater has coded this recording yet".to_string(),
            false => format!("coded by each rater: {}", coded.join(", ")),
        };
        let left_out = one.left_out.as_ref().map_or(String::new(), |why| format!(" (the trial does not count: {why})"));
        text += &format!("{}: {}{left_out}, {coded}\n", one.recording, count(one.errors, "error", "errors"));
        text += &one.consensus.as_ref().map_or(String::new(), describe_consensus);
        for identical in &one.identical {
            text += &format!("  {}\n", identical.in_words());
        }
    }
    let number = |value: Option<f64>| decimal(value, 2);
    for pair in figures.agreements.iter().chain(&figures.known) {
        let RaterAgreement { errors, same_cause, kappa_cause, beliefs, same_aspect, kappa_aspect } = pair.agreement;
        text += &format!(
            "{} and {}: the same cause for {same_cause} of {errors} errors (kappa {}), the same false belief for \
             {same_aspect} of {beliefs} errors by false beliefs (kappa {})\n",
            pair.of,
            pair.with,
            number(kappa_cause),
            number(kappa_aspect),
        );
    }
    let pairs = figures.agreements.iter().chain(&figures.known).map(|pair| &pair.agreement);
    let kappas: Vec<Option<f64>> = pairs.flat_map(|found| [found.kappa_cause, found.kappa_aspect]).collect();
    if kappas.contains(&None) {
        text += "  kappa -: both give one code only, or no error has codes of both\n";
    }
    if kappas.iter().flatten().any(|kappa| *kappa < 0.005) {
        text += "  kappa 0.00 or below: they agree no more than by chance, as where one gives one code only\n";
    }
    text + &describe_disagreements(figures)
}

fn describe_consensus(found: &ConsensusSummary) -> String {
    let ConsensusSummary { of, with, agreed, settled, open, missing, stale } = found;
    let mut text =
        format!("  consensus of {of} and {with} on errors: {agreed} agreed, {settled} settled, {open} open\n");
    if let Some(rater) = missing {
        text += &format!("  the consensus does not hold: there are no codes of {rater}\n");
    }
    for ChangedRaterCode { error, press, rater } in stale {
        text +=
            &format!("  stale code: {rater} changed the code of error {error} (press {press}) after it was settled\n");
    }
    text
}

fn describe_disagreements(figures: &InterRaterSummary) -> String {
    let all = &figures.disagreements;
    if all.is_empty() {
        return String::new();
    }
    let recordings = all.iter().map(|one| one.recording.chars().count()).max().unwrap_or(0).max(9);
    let open = all.iter().filter(|one| one.settled_words.is_none()).count();
    let mut text =
        format!("{} between raters, {open} of them open:\n", count(all.len() as u64, "disagreement", "disagreements"));
    text += &format!("  {:<recordings$}  error   time  press  button\n", "recording");
    for one in all {
        let ListedError { error, press, .. } = one.error;
        let (clock, words) = (one.error.clock(), one.error.words());
        let [of, with] = &one.words;
        text += &format!(
            "  {:<recordings$}  {error:>5}  {clock:>5}  {press:>5}  {words}: {} {of}, {} {with}{}\n",
            one.recording,
            one.of,
            one.with,
            one.settled_words.as_ref().map_or(String::new(), |settled| format!("; settled as {settled}")),
        );
    }
    if open == 0 {
        return text;
    }
    let mut coded: BTreeMap<String, u64> = BTreeMap::new();
    for (rater, number) in figures.recordings.iter().flat_map(|one| &one.coded) {
        *coded.entry(rater.clone()).or_default() += number;
    }
    // The raters whose codes an analysis takes.
    let raters = of_most(&coded).map(|(raters, _)| raters).unwrap_or_default();
    let command = "settle the disagreements together, recording by recording: tomcom replay RECORDING --settle";
    text + &match &raters[..] {
        [of, with] => format!("{command} {of} {with}\n"),
        more => format!("{command} with two of {}, who coded as many errors\n", more.join(", ")),
    }
}

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

    fn lock(&self, folder: &Path) -> Result<RecordingLock, RecordingWriteError> {
        match self {
            RowAuthor::Rater(rater) => RecordingLock::take_for_codes(folder, &[rater]),
            RowAuthor::Pair([one, other]) => RecordingLock::take_for_codes(folder, &[one, other]),
        }
    }
}

#[derive(Debug)]
pub struct ImportableCodes {
    file: PathBuf,
    text: String,
    /// With the index of the recording; consensus codes last, since codes of raters can stand in later rows.
    rows: Vec<(usize, RowAuthor, RaterCodeRow)>,
    /// Raters in the table of whom none of the recordings has codes yet: perhaps somebody who was typed wrong.
    pub new_raters: Vec<String>,
    /// Number of codes of these recordings that the table changes, by rater, or by consensus such as `R1+R2`.
    pub changed: BTreeMap<String, u64>,
    pub known_raters: Vec<String>,
}

/// Reads a table of codes of these recordings. Errors: the file cannot be read, a row does not refer to an error of
/// these recordings or names no rater, or two raters differ in capital letters only.
pub fn read(recordings: &[CodedRecording], file: &Path) -> FileResult<ImportableCodes> {
    let (text, rows) = rows_of(recordings, file)?;
    let wrong =
        |row: &RaterCodeRow, found: String, remedy: &str| rater_codes::wrong_line(file, &text, row.line, found, remedy);
    let names: Vec<String> = recordings.iter().map(CodedRecording::name).collect();
    let known: BTreeSet<&str> = recordings.iter().flat_map(|one| one.codes.keys().map(String::as_str)).collect();
    let (mut imported, mut new, mut changed) = (Vec::new(), BTreeSet::new(), BTreeMap::new());
    for row in rows {
        let Some(index) = names.iter().position(|name| *name == row.recording) else {
            let found = format!("the recording \"{}\"{}", row.recording, did_you_mean(&row.recording, &names));
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

/// The text of a file with codes, and its rows: a table, or what was annotated in ELAN or BORIS.
fn rows_of(recordings: &[CodedRecording], file: &Path) -> FileResult<(String, Vec<RaterCodeRow>)> {
    let end = file.extension().unwrap_or_default().to_string_lossy().to_ascii_lowercase();
    let (text, found) = match end.as_str() {
        "eaf" => {
            let text = file_error::read_text(file)?;
            let found = annotations::from_elan(file, &text)?;
            (text, found)
        }
        // A project stands on one line, of which no message can show a part.
        "boris" => (String::new(), annotations::from_boris(file, &file_error::read_text(file)?)?),
        _ => return rater_codes::read_export(file),
    };
    let names: Vec<String> = recordings.iter().map(CodedRecording::name).collect();
    let rows = found.into_iter().map(|AnnotatedCode { line, recording, rater, error, code }| {
        // What is about no recording, or about no error of it, is refused by name below.
        let only = || names.first().filter(|_| names.len() == 1).cloned();
        let recording = recording.or_else(only).unwrap_or_default();
        let index = names.iter().position(|name| *name == recording);
        let press =
            index.and_then(|index| recordings[index].codable.errors.get(usize::try_from(error.checked_sub(1)?).ok()?));
        RaterCodeRow { line, recording, rater, press: press.copied().unwrap_or(u64::MAX), code }
    });
    Ok((text, rows.collect()))
}

impl ImportableCodes {
    /// Adds the codes to those of the recordings. No row is imported if one of them is invalid, or if another program
    /// codes as one of the raters: the codes of a rater are always replaced as a whole. Returns the number of rows.
    /// Errors: a consensus is of raters who have not coded, or contradicts a code that both raters gave; another
    /// program codes as one of the raters; or a folder is not writable.
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
        let both = new.raters.join(" and ");
        if let Some(rater) = new.without_codes(own.each_ref()) {
            let found = format!("a consensus of {both}, while {rater} has coded nothing");
            return Err((found, "raters who have both coded errors of this recording, each alone".to_string()));
        }
        let consensus = self.consensus.take().unwrap_or_else(|| new.clone());
        if consensus.raters != new.raters {
            let name = consensus.name();
            let remedy = format!("the consensus of {name}, who settled this recording; or delete this consensus first");
            return Err((format!("the consensus of {both}"), remedy));
        }
        let decided = RaterCodes([(press, code.clone())].into());
        let consensus = consensus.with_agreed(own.each_ref()).with_decided(&decided, own.each_ref());
        if let Some(remedy) = consensus.settled.get(&press).and_then(|settled| settled.fault()) {
            let found = format!("press {press} with another cause than the one that both raters gave");
            return Err((found, remedy.to_string()));
        }
        self.consensus = Some(consensus);
        Ok(())
    }
}

/// Writes all codes of the recordings into a file: codes of raters, and below them the consensus codes that still hold.
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
