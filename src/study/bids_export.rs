//! Exports recordings as a data set in the Brain Imaging Data Structure (BIDS).

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

use serde::Serialize;

use crate::analysis::bids::BidsFile;
use crate::analysis::bids::dataset::{
    BidsLabelMap, BidsParticipant, BidsSession, QuestionnairePhenotypes, dataset_files, letters_and_digits,
    session_label, sessions_files,
};
use crate::analysis::bids::recording_tables::{
    BidsRowCounts, LongTable, LongTableFacts, PressOutcome, RecordingTables,
};
use crate::files::bids_tree::BidsTree;
use crate::gathered::{GatheredRecordings, name};
use crate::kept_cost::KeptCost;
use crate::pass::reading;
use crate::planned_trial::{ForeignReason, ForeignRecording, RecordingCopy, left_out_in_words};
use crate::standing;
use tomcom_core::base::text::{PathText, count};
use tomcom_core::kitchen::KitchenChange;
use tomcom_core::measures::errors::PressJudge;
use tomcom_session::event::Event;
use tomcom_session::files::file_error::{FileError, FileResult};
use tomcom_session::log::{LogEnding, LogReader};
use tomcom_session::protocol::ProtocolEvent;
use tomcom_session::{LogHeader, apply};

#[derive(Clone, Debug, Serialize)]
pub struct BidsSummary {
    pub folder: PathText,
    pub changed_codes: Vec<(String, String)>,
    pub copies: Vec<RecordingCopy>,
    /// Recordings of no plan beside those of a plan, simulated ones beside those of people, those that are still being
    /// written, and excluded ones that cannot be read, which are left out.
    pub foreign: Vec<ForeignRecording>,
    pub recordings: Vec<BidsRecording>,
    pub questionnaires: usize,
    pub words: bool,
}

#[derive(Clone, Debug, Serialize)]
pub struct BidsRecording {
    pub recording: PathText,
    /// Common beginning of the paths of the recording's files in the data set.
    pub place: String,
    /// Why the analysis leaves it out; without words that somebody typed unless those are exported.
    pub left_out: Option<String>,
    pub rows: BidsRowCounts,
}

struct Planned {
    recording: PathBuf,
    header: LogHeader,
    label: String,
    session: String,
}

/// Exports these recordings into a new folder. `with_words`: whether text that wizards and participants typed is
/// exported, too. `done` is called after each recording. Errors: a recording cannot be read, all are left out,
/// or the data set cannot be written.
pub fn export(recordings: &[PathBuf], folder: &Path, with_words: bool, done: impl Fn()) -> FileResult<BidsSummary> {
    let GatheredRecordings { paths, copies, mut foreign, .. } =
        GatheredRecordings::find(recordings)?.without_foreign(&[]);
    let mut whole = Vec::new();
    for path in paths {
        let log = LogReader::open(&path)?;
        match log.ending() {
            LogEnding::Running => {
                let (reason, recording) = (ForeignReason::Running, name(&path));
                foreign.push(ForeignRecording { reason, recording, excluded: None });
            }
            _ => {
                // Onsets count from the beginning of the first part.
                let started = log.headers().last().and_then(|first| first.started.clone());
                whole.push((path, LogHeader { started, ..log.header }));
            }
        }
    }
    foreign.sort();
    if let Some(first) = foreign.first().filter(|_| whole.is_empty()) {
        let remedy = "a recording whose session is over, and that can be read".to_string();
        let found = format!("a recording that is {}", first.reason.words());
        return Err(FileError::from_finding(Path::new(&first.recording), found, remedy));
    }
    let labels = BidsLabelMap::from_names(whole.iter().map(|(_, header)| header.session.participant.code.as_str()));
    let planned = places(whole, &labels);
    let tree = BidsTree::create(folder)?;
    let (mut cost, mut phenotypes) = (KeptCost::default(), QuestionnairePhenotypes::default());
    let mut sessions: BTreeMap<String, Vec<String>> = BTreeMap::new();
    let mut told = Vec::new();
    for one in &planned {
        let (row, recording) = read(one, with_words, &mut cost, &mut phenotypes, &tree)?;
        sessions.entry(one.label.clone()).or_default().push(row);
        told.push(recording);
        done();
    }
    for (label, rows) in &sessions {
        sessions_files(label, rows).iter().try_for_each(|file| tree.write(file))?;
    }
    let asked = phenotypes.files(with_words);
    let plans: BTreeSet<String> =
        planned.iter().filter_map(|one| Some(one.header.session.step.as_ref()?.plan.clone())).collect();
    let plans: Vec<String> = plans.into_iter().collect();
    let root = dataset_files(&plans, &participants(&planned, &told)?, with_words);
    asked.iter().chain(&root).try_for_each(|file| tree.write(file))?;
    Ok(BidsSummary {
        folder: folder.to_path_buf().into(),
        changed_codes: labels.changed(),
        copies,
        foreign,
        recordings: told,
        questionnaires: asked.len() / 2,
        words: with_words,
    })
}

/// Places of the recordings in the data set: by the participant's label, then by plan, date and name of the recording.
fn places(mut all: Vec<(PathBuf, LogHeader)>, labels: &BidsLabelMap) -> Vec<Planned> {
    all.sort_by_cached_key(|(path, header)| {
        let step = header.session.step.as_ref().map(|step| (step.plan.clone(), step.period, step.attempt));
        (header.session.participant.code.clone(), step, header.started.clone(), path.clone())
    });
    let mut taken: BTreeMap<String, BTreeSet<String>> = BTreeMap::new();
    let place = |(recording, header): (PathBuf, LogHeader)| {
        let code = &header.session.participant.code;
        let label = labels.label(code).unwrap_or(code).to_string();
        let session = session_label(header.session.step.as_ref(), taken.entry(label.clone()).or_default());
        Planned { recording, header, label, session }
    };
    all.into_iter().map(place).collect()
}

fn read(
    one: &Planned,
    with_words: bool,
    cost: &mut KeptCost,
    phenotypes: &mut QuestionnairePhenotypes,
    tree: &BidsTree,
) -> FileResult<(String, BidsRecording)> {
    let mut log = LogReader::open(&one.recording)?;
    let mut session = log.session();
    let kitchen = session.kitchen.clone();
    let cost = cost.for_kitchen(&kitchen);
    let (mut judge, mut tables) = (PressJudge::new(kitchen.clone()), RecordingTables::new(&session, with_words));
    let (sub, ses) = (format!("sub-{}", one.label), format!("ses-{}", one.session));
    let place = format!("{sub}/{ses}/beh/{sub}_{ses}_task-{}", letters_and_digits(&kitchen.name));
    let begin = |table: LongTable| {
        let (name, heading) = tables.long_table(table);
        Ok((table, tree.begin(&format!("{place}_{name}"), heading)?))
    };
    let mut long = LongTable::ALL.into_iter().map(begin).collect::<FileResult<Vec<_>>>()?;
    while let Some(line) = log.next_line()? {
        let change = apply(&mut session, &line.stamped).map_err(|error| log.refused(&line, error))?.change;
        let error = judge.note(cost, line.stamped.time, &change).map(|verdict| verdict.error);
        if let Some(pause) = session.probe_pause(&line.stamped) {
            judge.postpone(pause);
        }
        let outcome = match change {
            KitchenChange::Press { press, .. } => Some(PressOutcome { effective: press.effective, error }),
            KitchenChange::UncountedPress { .. } => Some(PressOutcome::default()),
            _ => None,
        };
        tables.note(&line.stamped, &session, outcome);
        for row in tables.take_rows() {
            if let Some((_, file)) = long.iter_mut().find(|(table, _)| *table == row.table) {
                file.add(row)?;
            }
        }
        if matches!(line.stamped.event, Event::Protocol(ProtocolEvent::AnswersConfirmed)) {
            phenotypes.note(&one.label, &one.session, &session);
        }
    }
    let standing = standing::exclusion_status(&session, &log)?;
    let counts = standing.counts();
    // What somebody typed stands behind the colon.
    let words = |why: String| if counts || with_words { why } else { why.split(':').take(1).collect() };
    let left_out = standing.left_out(&session, log.ending()).map(words);
    let is_complete = log.ending() == LogEnding::Closed;
    let name = one.recording.file_name().unwrap_or_default().to_string_lossy().into_owned();
    let row = BidsSession {
        label: &one.session,
        recording: &name,
        header: &one.header,
        session: &session,
        ended: tables.ended,
        is_complete,
        counts,
        left_out: left_out.as_deref(),
    };
    let row = row.line();
    let mut facts = [LongTableFacts::default(); 3];
    for (facts, (_, file)) in facts.iter_mut().zip(long) {
        *facts = file.finish()?;
    }
    let (files, rows) = tables.into_files(&session, &facts);
    for file in files {
        tree.write(&BidsFile { name: format!("{place}_{}", file.name), ..file })?;
    }
    Ok((row, BidsRecording { recording: one.recording.clone().into(), place, left_out, rows }))
}

fn participants(planned: &[Planned], told: &[BidsRecording]) -> FileResult<Vec<BidsParticipant>> {
    let mut rows: Vec<BidsParticipant> = Vec::new();
    for (one, told) in planned.iter().zip(told) {
        let left_out = usize::from(told.left_out.is_some());
        let spec = &one.header.session;
        let consent = reading::consent(&one.recording)?;
        let consent = consent.map(|given| [Some(given.place().to_string()), given.started, Some(given.digest)]);
        match rows.iter_mut().find(|row| row.label == one.label) {
            Some(row) => {
                row.recordings += 1;
                row.left_out += left_out;
                // Recordings are in the order of their times, so the first consent counts.
                if let Some(consent) = consent.filter(|_| row.consent == [None, None, None]) {
                    row.consent = consent;
                }
            }
            None => {
                // A recording whose code was corrected names the group of the other participant.
                let own = planned.iter().filter(|other| other.label == one.label);
                let own = own.min_by_key(|own| own.header.correction.is_some());
                let step = own.and_then(|own| own.header.session.step.as_ref());
                rows.push(BidsParticipant {
                    label: one.label.clone(),
                    code: spec.participant.code.clone(),
                    kind: spec.participant.kind.name().to_string(),
                    group: step.map(|step| step.group.clone()),
                    recordings: 1,
                    left_out,
                    consent: consent.unwrap_or_default(),
                });
            }
        }
    }
    Ok(rows)
}

pub fn describe(summary: &BidsSummary) -> String {
    let rows = |of: fn(&BidsRowCounts) -> u64| summary.recordings.iter().map(|one| of(&one.rows)).sum::<u64>();
    let line = |one: &BidsRecording| {
        let left_out = one.left_out.as_ref().map_or(String::new(), |why| format!(" (left out of the analysis: {why})"));
        format!("  {} from {}{left_out}\n", one.place, one.recording.display())
    };
    let recordings: String = summary.recordings.iter().map(line).collect();
    let changed = summary.changed_codes.iter();
    let line = |(code, label): &(String, String)| {
        format!(
            "the participant with the code {code} is sub-{label} in the data set: labels have letters and digits \
             only, and differ by more than capitals\n"
        )
    };
    let changed: String = changed.map(line).collect();
    let left_out = left_out_in_words(&summary.foreign, &summary.copies);
    let left = rows(|rows| rows.words_left_out);
    let words = match left {
        0 => String::new(),
        left => format!(
            "left out: {} that somebody typed (--words exports them)\n",
            count(left, "note, reason or answer in words", "notes, reasons and answers in words")
        ),
    };
    format!(
        "{}: {}\n{recordings}rows: {} events, {} gaze samples, {} fixations and blinks, {} arm samples, {} beliefs; \
         {}\n{left_out}{changed}{words}",
        summary.folder.display(),
        count(summary.recordings.len() as u64, "recording", "recordings"),
        rows(|rows| rows.events),
        rows(|rows| rows.gaze),
        rows(|rows| rows.eye_events),
        rows(|rows| rows.arm),
        rows(|rows| rows.beliefs),
        count(summary.questionnaires as u64, "table of questionnaires", "tables of questionnaires"),
    )
}
