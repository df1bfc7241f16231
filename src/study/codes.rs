//! Command `tomcom codes`: raters' codes of errors, agreement and disagreements between raters, and their consensus.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use serde::Serialize;

use crate::figures::IdenticalCodes;
use tomcom_core::base::text::{count, decimal};
use tomcom_core::measures::raters::{AgreementTable, CodableErrors, ErrorCauseCode, RaterAgreement, RaterCodes};
use tomcom_core::measures::raters::{RaterConsensus, unsettled};
use tomcom_core::measures::raters::{RaterPair, of_most};
use tomcom_session::error_list::ListedError;
use tomcom_session::files::file_error::FileResult;
use tomcom_session::history::wording;
use tomcom_session::log::{consensus_file, rater_codes};
use tomcom_session::replay::RecordingReplay;
use tomcom_session::settings::ParticipantKind;

/// A recording with raters' codes of its errors.
#[derive(Clone, Debug)]
pub struct CodedRecording {
    /// Folder of the recording.
    pub folder: PathBuf,
    /// The errors of the recording that can be coded, and the false beliefs that can be named as causes.
    pub codable: CodableErrors,
    /// Errors of the recording, with times and presses.
    pub errors: Vec<ListedError>,
    /// Raters' codes of the recording's errors, by the rater's identifier.
    pub codes: BTreeMap<String, RaterCodes>,
    /// Consensus of two raters about their codes of the recording's errors.
    pub consensus: Option<RaterConsensus>,
    /// True causes of the errors, if the participant was simulated.
    pub known: Option<RaterCodes>,
}

impl CodedRecording {
    /// Reads a recording and the codes beside it.
    ///
    /// # Errors
    /// The recording cannot be read, or a file with codes is damaged.
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
        let codable = CodableErrors::from_presses(kitchen, judged);
        Ok(CodedRecording {
            codes: rater_codes::read_all(&folder, &codable)?,
            consensus: consensus_file::read(&folder, &codable)?,
            codable,
            errors: ListedError::all(&replay.follower),
            known: is_known.then(|| RaterCodes::known(kitchen, judged)),
            folder,
        })
    }

    /// Reads the codes beside the recording again.
    ///
    /// # Errors
    /// A file with codes is damaged.
    pub(super) fn read_codes(&mut self) -> FileResult<()> {
        self.codes = rater_codes::read_all(&self.folder, &self.codable)?;
        self.consensus = consensus_file::read(&self.folder, &self.codable)?;
        Ok(())
    }

    /// Name of the recording's folder.
    pub fn name(&self) -> String {
        let resolved = self.folder.canonicalize().unwrap_or_else(|_| self.folder.clone());
        resolved.file_name().unwrap_or_default().to_string_lossy().into_owned()
    }

    /// The consensus codes that still hold because the raters have not changed their own codes.
    pub fn current(&self, consensus: &RaterConsensus) -> RaterCodes {
        let none = RaterCodes::default();
        consensus.current(consensus.raters.each_ref().map(|rater| self.codes.get(rater).unwrap_or(&none)))
    }

    /// Pairs of raters who gave the same codes to all errors.
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
        let settled = consensus.current(own).0.len() as u64;
        let missing = consensus.without_codes(own).map(str::to_string);
        let changed = if missing.is_some() { Vec::new() } else { consensus.changed(own) };
        let stale = changed.into_iter().map(|changed| ChangedRaterCode {
            error: self.codable.errors.partition_point(|&press| press < changed.press) as u64 + 1,
            press: changed.press,
            rater: changed.rater,
        });
        let errors = self.codable.errors.len() as u64;
        Some(ConsensusSummary { of, with, agreed, settled, open: errors - settled, missing, stale: stale.collect() })
    }

    /// The errors to which two raters gave different codes.
    fn disagreements(&self, of: (&String, &RaterCodes), with: (&String, &RaterCodes)) -> Vec<RaterDisagreement> {
        let differ = unsettled(&self.codable.errors, [of.1, with.1]);
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
    /// The coded recordings, with the number of errors that each rater has coded.
    pub recordings: Vec<CodedRecordingSummary>,
    /// Agreement of each pair of raters who coded common errors. A consensus does not count as a rater.
    pub agreements: Vec<RaterPairSummary>,
    /// Agreement of each rater with the true causes of simulated participants.
    pub known: Vec<RaterPairSummary>,
    /// The errors to which two raters gave different codes, for each pair of raters.
    pub disagreements: Vec<RaterDisagreement>,
}

/// Progress of the raters in coding one recording.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct CodedRecordingSummary {
    /// The name of the recording's folder.
    pub recording: String,
    /// Number of errors of the human in the recording.
    pub errors: u64,
    /// Number of errors coded by each rater, by the rater's identifier.
    pub coded: BTreeMap<String, u64>,
    /// Consensus of two raters; null without one.
    pub consensus: Option<ConsensusSummary>,
    /// Pairs of raters ("R1+R2") who gave the same codes to all errors; absent if there are none.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub identical: Vec<IdenticalCodes>,
}

/// Consensus of two raters about a recording's errors.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ConsensusSummary {
    /// Identifier of the first rater of the consensus.
    pub of: String,
    /// Identifier of the second rater of the consensus.
    pub with: String,
    /// Number of errors to which both raters gave the same code.
    pub agreed: u64,
    /// Number of errors with a valid consensus code, including errors that both raters coded alike.
    pub settled: u64,
    /// Number of errors without a consensus code.
    pub open: u64,
    /// The rater of whom there are no codes any more; null if there are codes of both.
    pub missing: Option<String>,
    /// Codes that a rater changed after the raters had settled the error.
    pub stale: Vec<ChangedRaterCode>,
}

/// A rater's code that changed after two raters had settled it.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct ChangedRaterCode {
    /// Number of the error in the recording, from 1.
    pub error: u64,
    /// Sequence number of the press in the log.
    pub press: u64,
    /// The rater who changed the code.
    pub rater: String,
}

/// An error that two raters coded differently.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct RaterDisagreement {
    /// The name of the recording's folder.
    pub recording: String,
    /// The error to which the raters gave different codes.
    #[serde(flatten)]
    pub error: ListedError,
    /// Identifier of the first of the two raters.
    pub of: String,
    /// Identifier of the second of the two raters.
    pub with: String,
    /// Cause of the error according to the first rater.
    pub of_cause: String,
    /// State aspect that the participant believed wrong according to the first rater; null for other causes.
    pub of_aspect: Option<String>,
    /// Cause of the error according to the second rater.
    pub with_cause: String,
    /// State aspect that the participant believed wrong according to the second rater; null for other causes.
    pub with_aspect: Option<String>,
    /// Cause of the error in the consensus code; null without consensus, or if a rater changed a code since.
    pub settled_cause: Option<String>,
    /// State aspect that the participant believed wrong by the consensus code; null for other causes.
    pub settled_aspect: Option<String>,
    /// Codes that the two raters gave to the error, in words.
    #[serde(skip)]
    pub words: [String; 2],
    /// Consensus code of the error in words.
    #[serde(skip)]
    pub settled_words: Option<String>,
}

/// Agreement between two raters, or between a rater and the true causes of a simulation.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct RaterPairSummary {
    /// Identifier of the first rater of the pair.
    pub of: String,
    /// Identifier of the second rater of the pair, or "simulation" for the true causes of a simulated participant.
    pub with: String,
    /// Agreement of the two raters, over all recordings together.
    #[serde(flatten)]
    pub agreement: RaterAgreement,
}

impl InterRaterSummary {
    /// Summary of raters' codes, agreement and disagreements in these recordings.
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

/// The summary of raters' codes as text for the terminal.
pub fn describe(figures: &InterRaterSummary) -> String {
    let mut text = String::new();
    for one in &figures.recordings {
        let coded: Vec<String> = one.coded.iter().map(|(rater, number)| format!("{rater} {number}")).collect();
        let coded = match coded.is_empty() {
            true => "no rater has coded this recording yet".to_string(),
            false => format!("coded by each rater: {}", coded.join(", ")),
        };
        text += &format!("{}: {}, {coded}\n", one.recording, count(one.errors, "error", "errors"));
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
    text + &describe_disagreements(figures)
}

fn describe_consensus(found: &ConsensusSummary) -> String {
    let ConsensusSummary { of, with, agreed, settled, open, missing, stale } = found;
    let decided = settled.saturating_sub(*agreed);
    let mut text = format!(
        "  consensus of {of} and {with} on errors: {agreed} agreed, {decided} settled, {open} \
                            open\n"
    );
    if let Some(rater) = missing {
        text += &format!("  the consensus does not hold: there are no codes of {rater}\n");
    }
    for ChangedRaterCode { error, press, rater } in stale {
        text +=
            &format!("  stale code: {rater} changed the code of error {error} (press {press}) after it was settled\n");
    }
    text
}

/// The errors that raters coded differently as a table, followed by how to settle them.
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
