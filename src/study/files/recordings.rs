//! Overview of a folder of recordings, from their logs alone, without replaying them.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::io::{self, BufRead, BufReader, ErrorKind, Read};
use std::path::{Path, PathBuf};

use serde::Deserialize;

use tomcom_session::event::TrialEndReason;
use tomcom_session::files::file_error::{FileError, FileResult, open_regular};
use tomcom_session::files::near_path::did_you_mean;
use tomcom_session::header::{FORMAT, PreviousPart};
use tomcom_session::log::{
    LOG_NAME, LogEnding, LogReader, MAX_LINE, RecordingLock, SameLogs, first_line, header_digest, read_header, ruling,
};
use tomcom_session::plan::{PhaseSpec, PhaseStand, PlanPosition, PlanRecording, RecordingOutcome};
use tomcom_session::probes::ProbeEvent;
use tomcom_session::protocol::{PhaseProgress, ProtocolEvent, StudyPhase};
use tomcom_session::settings::ParticipantKind;
use tomcom_session::tutorial::TutorialEvent;
use tomcom_session::{Event, TimestampedEvent};

/// Live recordings of the study plan with this name in a folder, by folder name; the parts of a continued recording
/// count as one recording, and copies of a log once. Other files do not count; of simulated recordings of the plan, only
/// their number is told. Errors: the folder or a recording in it cannot be read.
pub fn of_plan(folder: &Path, plan: &str) -> FileResult<(Vec<PlanRecording>, u64)> {
    let mut found = BTreeMap::new();
    let mut simulated = 0;
    let unreadable = |reason| FileError::unreadable(folder, reason, "the folder with the recordings, as --out");
    let entries = match fs::read_dir(folder) {
        Ok(entries) => entries,
        Err(reason) if reason.kind() == ErrorKind::NotFound => return Ok((Vec::new(), 0)),
        Err(reason) => return Err(unreadable(reason)),
    };
    for entry in entries {
        let path = entry.map_err(unreadable)?.path();
        let name = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
        match Part::read(&path.join(LOG_NAME), plan)? {
            FoundLog::Other => {}
            FoundLog::Simulated => simulated += 1,
            FoundLog::Live(mut part) => {
                // A later decision in the file `exclusion.toml` beside the log takes precedence over the log.
                if let Some(ruling) = ruling(&path)? {
                    part.told.excluded = Some(ruling.excluded.then_some(ruling.reason));
                }
                found.insert(name, *part);
            }
        }
    }
    remove_copies(folder, &mut found)?;
    let continued: Vec<String> = found.values().filter_map(|part| part.continues.clone()).collect();
    let last = found.iter().filter(|(name, _)| !continued.contains(name));
    Ok((last.map(|(name, part)| part.made(name, &found)).collect(), simulated))
}

/// A copy of a cut recording would be offered to be continued, instead of the recording.
fn remove_copies(folder: &Path, found: &mut BTreeMap<String, Part>) -> FileResult<()> {
    let mut logs = Vec::new();
    for (name, part) in &*found {
        let log = folder.join(name).join(LOG_NAME);
        logs.push((name.clone(), format!("{} {}", header_digest(&log)?, part.code), log));
    }
    let keys: Vec<(&Path, &str)> = logs.iter().map(|(_, key, log)| (log.as_path(), key.as_str())).collect();
    let continued: BTreeSet<String> = found.values().filter_map(|part| part.continues.clone()).collect();
    for same in SameLogs::of(&keys)? {
        let is_excluded = |name: &String| matches!(found[name].told.excluded, Some(Some(_)));
        let rank = |name: &&String| (!continued.contains(*name), is_excluded(name));
        let names: Vec<&String> = same.all().map(|log| &logs[log].0).collect();
        let kept = names.iter().copied().min_by_key(rank);
        let copies: Vec<&String> = names.into_iter().filter(|name| Some(*name) != kept).collect();
        copies.into_iter().for_each(|name| drop(found.remove(name)));
    }
    Ok(())
}

/// The log of a recording beside which an export is to be written. Errors: the log cannot be read, is still being written,
/// or is not in the folder of a recording.
pub fn open_closed(recording: &Path) -> FileResult<LogReader> {
    let log = LogReader::open(recording)?;
    let wrong =
        |found: &str, remedy: &str| Err(FileError::from_finding(recording, found.to_string(), remedy.to_string()));
    if log.ending() == LogEnding::Running {
        return wrong("a recording that is still being written", "a recording whose session is over");
    }
    if !log.path().ends_with(LOG_NAME) {
        return wrong("a log that is not called events.jsonl", "the folder of a recording, into which it is written");
    }
    Ok(log)
}

/// The recording itself, or all in the folder, sorted by name; of several parts, the last.
pub fn of_folder(folder: &Path) -> FileResult<Vec<PathBuf>> {
    let remedy = "the folder of a recording, or one with recordings in it";
    let unreadable = |reason: io::Error| {
        let found = match reason.kind() {
            ErrorKind::NotFound => format!("no folder of this name{}", did_you_mean(folder, Path::new(""))),
            ErrorKind::NotADirectory => "a file, not a folder".to_string(),
            _ => return FileError::unreadable(folder, reason, remedy),
        };
        FileError::from_finding(folder, found, remedy.to_string())
    };
    if folder.join(LOG_NAME).is_file() {
        return Ok(vec![folder.to_path_buf()]);
    }
    let mut found = Vec::new();
    for entry in fs::read_dir(folder).map_err(unreadable)? {
        let path = entry.map_err(unreadable)?.path();
        if path.join(LOG_NAME).is_file() {
            found.push(path);
        }
    }
    if found.is_empty() {
        let found = "a folder without recordings".to_string();
        return Err(FileError::from_finding(folder, found, remedy.to_string()));
    }
    found.sort();
    let mut continued = Vec::new();
    for path in &found {
        let log = path.join(LOG_NAME);
        let file = open_regular(&log).map_err(|reason| FileError::unreadable(&log, reason, remedy))?;
        // An invalid header is reported when the recording is read.
        let line = first_line(&mut BufReader::new(file)).unwrap_or_default();
        let header = serde_json::from_slice::<PartHeaderGlance>(&line).ok();
        continued.extend(header.and_then(|header| header.continues).map(|before| folder.join(before.recording)));
    }
    found.retain(|path| !continued.contains(path));
    Ok(found)
}

/// The field of a log's header that names the part which the recording continues; the rest is not parsed, to save time.
#[derive(Deserialize)]
struct PartHeaderGlance {
    #[serde(default)]
    continues: Option<PreviousPart>,
}

#[derive(Debug)]
struct Part {
    code: String,
    recorded_as: Option<String>,
    kind: ParticipantKind,
    step: PlanPosition,
    continues: Option<String>,
    running: bool,
    told: PartProgress,
}

enum FoundLog {
    Live(Box<Part>),
    /// It fills no plan.
    Simulated,
    /// No recording, or one of another plan.
    Other,
}

/// What the events of a part tell.
#[derive(Debug, Default)]
struct PartProgress {
    consent: bool,
    instructed: bool,
    phase: usize,
    /// Steps of the last phase that were ticked or, in a later part, unticked.
    ticks: BTreeMap<usize, bool>,
    tutorial_over: bool,
    /// Items of the last phase that were answered or skipped.
    items: BTreeSet<String>,
    /// Numbers of the phases whose answers were confirmed.
    confirmed: BTreeSet<usize>,
    /// Whether the trial's clock goes; a press before and after is no press of the trial.
    runs: bool,
    presses: u32,
    trial_over: bool,
    ended_by_wizard: bool,
    criterion_failed: bool,
    criterion_waived: Option<String>,
    aborted: Option<String>,
    /// Whether an event excludes the recording from the analysis or includes it again, and the reason of an exclusion.
    excluded: Option<Option<String>>,
    ended: bool,
}

impl PartProgress {
    fn follow(&mut self, event: &Event) {
        match event {
            Event::Press { .. } => self.presses += u32::from(self.runs),
            Event::TrialStarted | Event::TrialResumed | Event::Probe(ProbeEvent::Ended { .. }) => self.runs = true,
            Event::TrialPaused | Event::Probe(ProbeEvent::Begun { .. }) => self.runs = false,
            Event::TrialEnded { reason } => {
                (self.runs, self.trial_over) = (false, true);
                self.ended_by_wizard = *reason == TrialEndReason::Wizard;
            }
            Event::TrialAborted { reason } => (self.runs, self.aborted) = (false, Some(reason.clone())),
            Event::TrialExcluded { reason } => self.excluded = Some(Some(reason.clone())),
            Event::TrialIncluded => self.excluded = Some(None),
            Event::SessionEnded => self.ended = true,
            Event::Protocol(ProtocolEvent::ConsentGiven { .. }) => self.consent = true,
            Event::Protocol(ProtocolEvent::PhaseStarted { phase, number }) => {
                self.phase = *number;
                self.ticks.clear();
                self.items.clear();
                self.instructed |= !matches!(phase, StudyPhase::Instruction | StudyPhase::Tutorial);
            }
            Event::Protocol(ProtocolEvent::Ticked { step, done }) => drop(self.ticks.insert(*step, *done)),
            Event::Protocol(ProtocolEvent::Tutorial(TutorialEvent::Ended { .. })) => self.tutorial_over = true,
            Event::Protocol(ProtocolEvent::ItemAnswered { item, .. } | ProtocolEvent::ItemSkipped { item }) => {
                self.items.insert(item.clone());
            }
            // A part that continues another one in the middle of a phase does not name it.
            Event::Protocol(ProtocolEvent::AnswersConfirmed) => drop(self.confirmed.insert(self.phase)),
            Event::Protocol(ProtocolEvent::CriterionChecked { met, .. }) => self.criterion_failed = !met,
            Event::Protocol(ProtocolEvent::CriterionWaived { reason }) => self.criterion_waived = Some(reason.clone()),
            _ => {}
        }
    }
}

impl Part {
    /// Reads the log of one part of a recording.
    fn read(path: &Path, plan: &str) -> FileResult<FoundLog> {
        let file = match open_regular(path) {
            Ok(file) => file,
            // No log at this path: an empty folder, or a file beside the recordings.
            Err(reason) if matches!(reason.kind(), ErrorKind::NotFound | ErrorKind::NotADirectory) => {
                return Ok(FoundLog::Other);
            }
            Err(reason) => return Err(FileError::unreadable(path, reason, "a readable recording")),
        };
        let mut lines = BufReader::with_capacity(1 << 16, file);
        let mut line = Vec::new();
        let mut next = |line: &mut Vec<u8>| {
            line.clear();
            let read = lines.by_ref().take(MAX_LINE as u64).read_until(b'\n', line);
            let read = read.map_err(|reason| FileError::unreadable(path, reason, "a readable recording"))?;
            // A last line of the log without a line end was cut off, or is still being written.
            Ok::<bool, FileError>(read > 0 && line.last() == Some(&b'\n'))
        };
        if !next(&mut line)? {
            return Ok(FoundLog::Other);
        }
        // A recording with a damaged header is an error: its trial would be offered again otherwise.
        if !is_log(&line) {
            return Ok(FoundLog::Other);
        }
        let header = match read_header(path, String::from_utf8_lossy(&line).trim_end()) {
            Ok(header) => header,
            Err(_) if names_another_plan(&line, plan) => return Ok(FoundLog::Other),
            Err(error) => return Err(error),
        };
        let Some(step) = header.session.step.filter(|step| step.plan == plan) else {
            return Ok(FoundLog::Other);
        };
        if header.started.is_none() {
            return Ok(FoundLog::Simulated);
        }
        let mut part = Part {
            code: header.session.participant.code,
            recorded_as: header.correction.map(|correction| correction.before),
            kind: header.session.participant.kind,
            step,
            continues: header.continues.map(|before| before.recording),
            running: path.parent().is_some_and(|folder| RecordingLock::holder(folder).is_some()),
            told: PartProgress::default(),
        };
        while next(&mut line)? {
            if !is_sample(&line)
                && let Ok(stamped) = serde_json::from_slice::<TimestampedEvent>(&line)
            {
                part.told.follow(&stamped.event);
            }
        }
        Ok(FoundLog::Live(Box::new(part)))
    }

    fn made(&self, name: &str, parts: &BTreeMap<String, Part>) -> PlanRecording {
        let mut all = vec![self];
        // Parts of a recording whose headers refer to each other must not lead to an endless loop.
        while let Some(before) = all.last().and_then(|part| parts.get(part.continues.as_ref()?)) {
            if all.len() > parts.len() {
                break;
            }
            all.push(before);
        }
        let any = |is: fn(&PartProgress) -> bool| all.iter().any(|part| is(&part.told));
        // The last part of the recording that contains a decision about exclusion counts.
        let excluded = all.iter().find_map(|part| part.told.excluded.clone()).flatten();
        let aborted = all.iter().find_map(|part| part.told.aborted.as_ref());
        let waived = all.iter().find_map(|part| part.told.criterion_waived.clone());
        let presses = all.iter().map(|part| part.told.presses).sum();
        let void = |reason: &str| RecordingOutcome::Void { reason: reason.to_string() };
        let outcome = if !self.told.ended && self.running {
            RecordingOutcome::Running
        } else if !self.told.ended {
            RecordingOutcome::Open
        } else if let Some(reason) = aborted {
            void(&format!("aborted ({reason})"))
        } else if any(|part| part.criterion_failed) && waived.is_none() {
            void("criterion not met")
        } else if !any(|part| part.trial_over) || !self.is_last_phase_done(&all) {
            RecordingOutcome::Open
        } else if self.step.period.is_some() && presses == 0 && excluded.is_none() {
            // As in the study's analysis (`ExclusionStatus::left_out`).
            void("no press in it")
        } else {
            excluded.clone().map_or(RecordingOutcome::Complete, |reason| RecordingOutcome::Excluded { reason })
        };
        let phase = all.iter().map(|part| part.told.phase).find(|phase| *phase > 0).unwrap_or(0);
        let items: BTreeSet<&String> = since(&all, phase).iter().flat_map(|part| &part.told.items).collect();
        let stand = PhaseStand {
            phase,
            trial_over: any(|part| part.trial_over),
            ended_by_wizard: any(|part| part.ended_by_wizard),
            items: items.len(),
        };
        PlanRecording {
            recording: name.to_string(),
            code: self.code.clone(),
            recorded_as: self.recorded_as.clone(),
            kind: self.kind,
            step: self.step.clone(),
            consent: any(|part| part.consent),
            instructed: any(|part| part.instructed),
            presses,
            stand,
            waived,
            excluded,
            answered: self.answered_before_trial(&all),
            outcome,
        }
    }
}

/// Whether a header that is not valid still tells that its recording is of another plan, or of none.
fn names_another_plan(header: &[u8], plan: &str) -> bool {
    let header = serde_json::from_slice::<serde_json::Value>(header);
    header.is_ok_and(|header| header.pointer("/session/step/plan").and_then(|named| named.as_str()) != Some(plan))
}

/// The parts, the last one first, back to the one in which this phase began.
fn since<'p, 'a>(parts: &'p [&'a Part], phase: usize) -> &'p [&'a Part] {
    let first = parts.iter().position(|part| part.told.phase == phase);
    first.map_or(&[], |first| &parts[..=first])
}

/// Numbers of the phases whose answers are confirmed in these parts, the last one first.
fn confirmed(parts: &[&Part]) -> BTreeSet<usize> {
    let mut phase = 0;
    let mut all = BTreeSet::new();
    for Part { told, .. } in parts.iter().rev() {
        // What a part says before it names a phase belongs to the phase that the part before it has left open.
        all.extend(told.confirmed.iter().map(|number| if *number == 0 { phase } else { *number }));
        phase = if told.phase > 0 { told.phase } else { phase };
    }
    all
}

impl Part {
    /// Names of the questionnaires before the trial whose answers are confirmed in these parts.
    fn answered_before_trial(&self, parts: &[&Part]) -> BTreeSet<String> {
        let confirmed = confirmed(parts);
        let phases = self.step.phases.iter().zip(1..).take_while(|(phase, _)| **phase != PhaseSpec::Trial);
        let answered = phases.filter_map(|(phase, number)| match phase {
            PhaseSpec::Questionnaire { questionnaire } if confirmed.contains(&number) => {
                Some(questionnaire.name.clone())
            }
            _ => None,
        });
        answered.collect()
    }

    /// Whether the last phase of the plan's step is done, after these parts, the last one first.
    fn is_last_phase_done(&self, parts: &[&Part]) -> bool {
        let (Some(last), number) = (self.step.phases.last(), self.step.phases.len()) else { return false };
        let since = since(parts, number);
        if since.is_empty() {
            return false;
        }
        let mut ticks: BTreeMap<usize, bool> = BTreeMap::new();
        since.iter().rev().for_each(|part| ticks.extend(&part.told.ticks));
        let progress = PhaseProgress {
            ticked: ticks.values().filter(|done| **done).count(),
            tutorial_over: since.iter().any(|part| part.told.tutorial_over),
            trial_over: parts.iter().any(|part| part.told.trial_over),
            confirmed: confirmed(parts).contains(&number),
        };
        progress.lacks(last).is_none()
    }
}

fn is_log(line: &[u8]) -> bool {
    line.windows(FORMAT.len()).any(|part| part == FORMAT.as_bytes())
}

/// Whether a line of a log is a gaze or arm sample, as most lines are; such lines are skipped here.
fn is_sample(line: &[u8]) -> bool {
    let head = &line[..line.len().min(80)];
    let is = |kind: &[u8]| head.windows(kind.len()).any(|part| part == kind);
    is(br#""kind":"gaze""#) || is(br#""kind":"robot_moves""#)
}
