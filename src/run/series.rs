//! The series of a participant's recordings: each recording has at most one trial, and the wizard makes one recording
//! after another without leaving the console.

use std::net::SocketAddr;
use std::path::Path;

use super::error::LiveError;
use super::event_loop::in_runtime;
use super::leaving::{LeavingReason, LiveOutcome};
use super::live;
use super::operator_station::OperatorStation;
use super::options::{DEFAULT_OUT, SeriesRequest, SessionStart};
use super::resume::PreparedSession;
use super::start_prompt::{ask, ask_consent};
use crate::console::lists::StartPrompt;
use tomcom_core::base::text::count;
use tomcom_session::files::SessionSetup;
use tomcom_session::files::file_error::FileError;
use tomcom_session::log::{LogReader, RecordingLock, RecordingWriteError};
use tomcom_session::plan::{NextRecording, ParticipantProgress, PlanRecording, RecordingOutcome, Study, listed};
use tomcom_session::settings::ParticipantKind;
use tomcom_session::wall_display::AnswerDevice;
use tomcom_session::watcher::SenderComparisonSettings;
use tomcom_study::files::recordings;

/// Result of one session, or of a participant's series of sessions.
#[derive(Clone, Debug)]
pub struct SeriesOutcome {
    /// Result of each session of the series, in order.
    pub done: Vec<LiveOutcome>,
    /// Progress of the participant through the study plan, as text.
    pub remark: Option<String>,
}

/// Runs one session at the console until the wizard leaves it, and repeats the session's trial if the wizard asks for
/// that. With `compare`, the console shows the comparison of wizard and assistants, which unblinds the wizard;
/// continued recordings have no comparison. With `observe`, the wizard's screen can be watched at this address.
///
/// # Errors
/// There is no terminal, the session cannot be recorded, or the gaze input cannot be opened.
pub fn operate(
    beginning: SessionStart,
    compare: Option<SenderComparisonSettings>,
    observe: Option<SocketAddr>,
) -> Result<SeriesOutcome, LiveError> {
    let _lock = continued_lock(&beginning)?;
    in_runtime(async {
        // The session's start is checked before the terminal is taken over and a recording is created, so that a
        // session that cannot start leaves nothing behind.
        let mut begun = PreparedSession::new(beginning, compare.clone())?;
        let mut station = OperatorStation::take(begun.spec(), begun.kitchen(), observe).await?;
        let mut done = Vec::new();
        loop {
            let mut end = live::run(begun, &mut station).await?;
            let again = end.again.take();
            done.push(end);
            match again {
                Some(again) => begun = PreparedSession::new(again, compare.clone())?,
                None => return Ok(SeriesOutcome { done, remark: None }),
            }
        }
    })
}

/// Runs the remaining recordings of a participant in a study plan, one after another, until the wizard quits.
///
/// # Errors
/// The errors of [`operate`]; or recordings cannot be read or do not fit the plan.
pub fn operate_series(series: SeriesRequest) -> Result<SeriesOutcome, LiveError> {
    in_runtime(async {
        let (planned, mut done) = (Planned::new(series)?, Vec::new());
        let remark = planned.run(&mut done).await?;
        Ok(SeriesOutcome { done, remark: Some(remark) })
    })
}

/// The right to record the participant of a plan's recording that is continued; `None` for a recording of no plan, and
/// for a new session.
fn continued_lock(beginning: &SessionStart) -> Result<Option<RecordingLock>, LiveError> {
    let SessionStart::Continued(recording) = beginning else { return Ok(None) };
    let log = LogReader::open(recording)?;
    let Some(step) = &log.header.session.step else { return Ok(None) };
    let place = log.path_of_last_part().canonicalize();
    let place = place.map_err(|reason| FileError::unreadable(recording, reason, "a readable recording"))?;
    let beside = place.parent().and_then(Path::parent).unwrap_or(Path::new("."));
    Ok(Some(RecordingLock::take_for_participant(beside, &step.plan, &log.header.session.participant.code)?))
}

/// The results of a participant's sessions as text.
pub fn describe(sitting: &SeriesOutcome) -> String {
    let ends: String = sitting.done.iter().map(|end| format!("{}\n", end.describe())).collect();
    let remark = sitting.remark.as_ref().map_or(String::new(), |remark| format!("{remark}\n"));
    ends + &remark
}

/// The wizard's choice before a recording.
enum Choice {
    Begin(Box<PreparedSession>),
    /// The wizard quits the program; a remark is printed, if there is one.
    Leave(Option<String>),
}

/// The series of one participant in a study plan. The next recording is determined from the existing recordings each
/// time.
struct Planned {
    series: SeriesRequest,
    study: Study,
}

impl Planned {
    fn new(series: SeriesRequest) -> Result<Planned, LiveError> {
        let study = series.files.study().ok_or(LiveError::Plan("a session without a plan".to_string()))?;
        Ok(Planned { series, study })
    }

    /// Progress of the participant; number of participants who have done everything, and of all.
    fn progress(&self) -> Result<(ParticipantProgress, (usize, usize)), LiveError> {
        let (made, _) = recordings_of(&self.study, &self.series.out)?;
        let progress = |participant| ParticipantProgress::from_recordings(&self.study, participant, &made);
        let all = self.study.plan.codes().len();
        // Recordings of others that do not fit the plan do not stop this participant.
        let others = (0..all).filter_map(|participant| progress(participant).ok());
        let finished = others.filter(|one| one.next == NextRecording::Finished).count();
        Ok((progress(self.series.participant).map_err(LiveError::Plan)?, (finished, all)))
    }

    fn stands(&self, progress: &ParticipantProgress) -> String {
        let SeriesRequest { files, out, kind, frozen, .. } = &self.series;
        let kind = progress.kind.or(*kind);
        stands(progress, &operate_command(&files.path, out, frozen.as_deref(), &progress.code, kind))
    }

    /// The question whether a recording is meant, where others in the folder are of another version of the plan.
    fn changed(&self, made: &[PlanRecording], code: &str) -> Result<Option<StartPrompt>, LiveError> {
        let others: Vec<&PlanRecording> = made.iter().filter(|made| made.step.digest != self.study.digest).collect();
        let Some(mut since) = others.last() else { return Ok(None) };
        let (out, kitchen) = (&self.series.out, &self.series.files.kitchen);
        let mut changed = listed(&[]);
        // The last one may be of a kind that did not change, such as the practice.
        for other in others.iter().rev() {
            let header = LogReader::open(&out.join(&other.recording))?.header;
            let shown = self.study.changed_since(&header, [&kitchen.layout, &kitchen.recipes]);
            if !shown.is_empty() {
                (since, changed) = (other, listed(&shown));
                break;
            }
        }
        let number = count(others.len() as u64, "recording", "recordings");
        Ok(Some(StartPrompt::new(
            format!("{code}: THE PLAN HAS CHANGED"),
            vec![
                format!("The plan is not that of {number} in the folder {}.", out.display()),
                format!("Changed since {}: {changed}.", since.recording),
            ],
            vec!["record under the changed plan".to_string(), "leave: nothing is recorded".to_string()],
        )))
    }

    /// The question whether a recording is meant, where another of the participant is of another kind of participant.
    fn other_kind(&self, made: &[PlanRecording], code: &str) -> Option<StartPrompt> {
        let kind = self.study.session.participant.kind;
        let is_other = |made: &&PlanRecording| made.code == code && made.kind != kind;
        let PlanRecording { recording, kind: before, .. } = made.iter().rev().find(is_other)?;
        let as_before = match before {
            ParticipantKind::External => "kind = \"external\" in the session file, and no --participant".to_string(),
            _ => format!("--participant {}", before.name()),
        };
        Some(StartPrompt::new(
            format!("{code}: ANOTHER KIND OF PARTICIPANT"),
            vec![
                format!("So far: {}, in {recording}.", before.words()),
                format!("Now: {}, by --participant, or by kind under [participant] in the session file.", kind.words()),
                format!("To go on as before, leave, and begin again with {as_before}."),
            ],
            vec![format!("record with the {}", kind.words()), "leave: nothing is recorded".to_string()],
        ))
    }

    /// Makes recordings until nothing is left or the wizard leaves; returns what is said then.
    async fn run(&self, done: &mut Vec<LiveOutcome>) -> Result<String, LiveError> {
        let code = self.study.plan.code(self.series.participant);
        // Until the series is over, no other program can begin a recording of the participant.
        let _lock = RecordingLock::take_for_participant(&self.series.out, &self.study.plan.name, &code)?;
        let (mut progress, mut participants) = self.progress()?;
        if progress.next == NextRecording::Finished && progress.excluded().next().is_none() {
            return Ok(self.stands(&progress));
        }
        let SeriesRequest { files, observe, .. } = &self.series;
        let mut station = OperatorStation::take(&files.spec, &files.kitchen.kitchen, *observe).await?;
        if self.series.files.spec.participant.kind == ParticipantKind::Simulated
            && ask(&mut station, rehearsal(&progress, &self.series.out)).await? != Some(0)
        {
            return Ok(self.stands(&progress));
        }
        let (made, _) = recordings_of(&self.study, &self.series.out)?;
        for question in [self.changed(&made, &code)?, self.other_kind(&made, &code)].into_iter().flatten() {
            if ask(&mut station, question).await? != Some(0) {
                return Ok(self.stands(&progress));
            }
        }
        let excluded: Vec<usize> = progress.excluded().map(|(slot, _)| slot).collect();
        if !excluded.is_empty() {
            match ask(&mut station, repeat(&progress)).await? {
                Some(0) => {}
                Some(index) => progress.redo(excluded.get(index - 1).copied()),
                None => return Ok(self.stands(&progress)),
            }
        }
        while progress.next != NextRecording::Finished {
            let mut begun = match self.choose(&progress, &mut station).await? {
                Choice::Begin(begun) => *begun,
                Choice::Leave(remark) => return Ok(remark.unwrap_or_else(|| self.stands(&progress))),
            };
            (begun.participants_done, begun.is_last) = (Some(participants), is_last(&progress));
            let end = live::run(begun, &mut station).await?;
            let (leaving, slot) = (end.leaving, progress.next.slot());
            done.push(end);
            (progress, participants) = self.progress()?;
            match leaving {
                LeavingReason::Quit => break,
                LeavingReason::Next => {}
                LeavingReason::Redo => progress.redo(slot),
            }
        }
        Ok(self.stands(&progress))
    }

    /// Prepares the next recording of the series, after asking the wizard the questions that come before it.
    async fn choose(&self, progress: &ParticipantProgress, station: &mut OperatorStation) -> Result<Choice, LiveError> {
        let (slot, attempt, open) = match &progress.next {
            NextRecording::Begin { slot, attempt } => (*slot, *attempt, None),
            NextRecording::Choose { recording, slot, attempt } => (*slot, *attempt, Some(recording)),
            NextRecording::Running { recording, .. } => {
                let folder = self.series.out.join(recording);
                let pid = RecordingLock::holder(&folder).and_then(|holder| holder.pid);
                return Err(RecordingWriteError::InUse { folder, pid }.into());
            }
            NextRecording::Finished => return Ok(Choice::Leave(None)),
        };
        let (spec, trial) = progress.settings(&self.study, slot, attempt);
        let label = spec.step.as_ref().map_or(String::new(), |step| step.label());
        let continued = match open {
            None => None,
            Some(recording) => match ask(station, which(progress, recording, slot)).await? {
                Some(0) => Some(recording),
                Some(_) => None,
                None => return Ok(Choice::Leave(None)),
            },
        };
        let beginning = match continued {
            Some(recording) => SessionStart::Continued(self.series.out.join(recording)),
            None => {
                let files = Box::new(SessionSetup { spec, ..self.series.files.clone() });
                SessionStart::New { files, trial, out: self.series.out.clone() }
            }
        };
        let mut begun = PreparedSession::new(beginning, self.series.compare.clone())?;
        // Only people are asked for consent.
        let is_simulated = self.series.files.spec.participant.kind == ParticipantKind::Simulated;
        if progress.consent || is_simulated {
            return Ok(Choice::Begin(Box::new(begun)));
        }
        let asks_on_display = self.study.plan.consent_on == AnswerDevice::Display;
        let text = asks_on_display.then_some(self.study.plan.consent.as_str());
        let on_display = station.display.welcome(begun.engine.session(), text);
        match ask_consent(station, consent(&self.study, progress, &label, on_display), on_display).await? {
            Some((0, on)) => {
                begun.consent = Some(self.study.consent_given(on));
                Ok(Choice::Begin(Box::new(begun)))
            }
            Some(_) => {
                let remark = format!("{} does not agree to be recorded: nothing was recorded", progress.code);
                Ok(Choice::Leave(Some(remark)))
            }
            None => Ok(Choice::Leave(None)),
        }
    }
}

/// Whether nothing of the participant's series is left after the next recording.
fn is_last(progress: &ParticipantProgress) -> bool {
    let next = progress.next.slot();
    progress.steps.iter().enumerate().all(|(slot, stand)| stand.is_done || Some(slot) == next)
}

/// The question whether a simulated participant is meant, where people take part. `out`: folder of the recordings.
fn rehearsal(progress: &ParticipantProgress, out: &Path) -> StartPrompt {
    let (code, out) = (&progress.code, out.display());
    StartPrompt::new(
        format!("{code}: SIMULATED PARTICIPANT"),
        vec![
            "This is a rehearsal: the session file, or --participant, lets the program play the participant."
                .to_string(),
            "Consent and tutorial are left out: they are for people.".to_string(),
            format!("Its recordings go to the folder {out}, and count there as those of {code}."),
            "If people are recorded there, leave, and name another folder with --out.".to_string(),
        ],
        vec![
            "rehearse with the simulated participant".to_string(),
            "leave; with a person: --participant display, or keyboard".to_string(),
        ],
    )
}

/// The question to the wizard whether a trial that was excluded after its session is repeated. The first answer goes on
/// without.
fn repeat(progress: &ParticipantProgress) -> StartPrompt {
    let lines = progress.excluded().map(|(slot, attempt)| {
        let RecordingOutcome::Excluded { reason } = &attempt.outcome else { return String::new() };
        format!("The recording {} of {} is excluded: {reason}.", attempt.recording, slot_name(progress, slot))
    });
    let on = match progress.next.slot() {
        None => "leave: nothing else is to be done".to_string(),
        Some(slot) => format!("go on with {}", slot_name(progress, slot)),
    };
    let again =
        progress.excluded().map(|(slot, _)| format!("repeat {} in another recording", slot_name(progress, slot)));
    StartPrompt::new(
        format!("{}: excluded trials", progress.code),
        lines.collect(),
        [on].into_iter().chain(again).collect(),
    )
}

/// The question to the wizard whether an unfinished recording is continued or its trial repeated.
fn which(progress: &ParticipantProgress, recording: &str, slot: usize) -> StartPrompt {
    let name = slot_name(progress, slot);
    let attempt = progress.steps.get(slot).and_then(|stand| stand.recordings.last());
    let (is_over, ended_where) = attempt.map_or((false, ""), |one| (one.trial_over, one.ended_where.as_str()));
    let left_out = attempt.and_then(|attempt| attempt.excluded.as_ref());
    let left_out = left_out.map_or(String::new(), |reason| format!(" It is excluded: {reason}."));
    let (stands, on, again) = match is_over {
        true => (
            "is over, but not all that follows it is done",
            "continue this recording with what follows the trial",
            "do the whole trial again in another recording; this trial is kept, and counts until tomcom exclude leaves it out",
        ),
        false => (
            "is not done",
            "continue this recording where it ended, with a running trial paused",
            "do this part again from its beginning; the unfinished recording is kept, and does not count",
        ),
    };
    StartPrompt::new(
        format!("{}: {name} {stands}", progress.code),
        vec![
            format!("The recording {recording} was cut, or ended before everything was done.{left_out}"),
            format!("Where it ended: {ended_where}."),
            "Continued, it keeps its settings: those of the session file and of options hold for new recordings."
                .to_string(),
        ],
        vec![on.to_string(), again.to_string()],
    )
}

/// The question for the participant's consent, without which nothing is recorded. If the display asks for consent, the
/// wizard can still confirm it at the console.
fn consent(study: &Study, progress: &ParticipantProgress, label: &str, on_display: bool) -> StartPrompt {
    let mut text = vec![study.plan.consent.clone()];
    if on_display {
        text.push("Waiting for the participant, who agrees on the display by holding a button.".to_string());
    }
    let yes = if on_display {
        "the participant agrees, as told to you: this is recorded"
    } else {
        "yes, the participant agrees"
    };
    let no = "no, the participant does not agree: nothing is recorded";
    StartPrompt::new(format!("{}: {label}", progress.code), text, vec![yes.to_string(), no.to_string()])
}

/// Name of a planned trial: "practice", "trial 1".
pub(super) fn slot_name(progress: &ParticipantProgress, slot: usize) -> String {
    match progress.steps.get(slot).and_then(|stand| stand.slot.period) {
        Some(period) => format!("trial {period}"),
        None => "practice".to_string(),
    }
}

/// Progress of a participant through the study plan, in one line. `operate`: the command that records the participant.
pub(super) fn stands(progress: &ParticipantProgress, operate: &str) -> String {
    let (code, done, all) = (&progress.code, progress.done(), progress.steps.len());
    let (out, again) = match progress.excluded().count() {
        0 => (String::new(), String::new()),
        out => (format!(" ({out} of them excluded)"), format!(", {out} excluded: repeat with {operate}")),
    };
    match &progress.next {
        NextRecording::Finished if !progress.has_counting_trial() => {
            format!("{code}: nothing counts, since every trial is excluded{again}")
        }
        NextRecording::Finished => format!("{code}: everything is done{again}"),
        NextRecording::Begin { slot, attempt: 1 } => {
            format!("{code}: {done} of {all} done{out}, next: {}", slot_name(progress, *slot))
        }
        NextRecording::Begin { slot, attempt } => {
            format!("{code}: {done} of {all} done{out}, next: {} again (attempt {attempt})", slot_name(progress, *slot))
        }
        NextRecording::Choose { slot, recording, .. } => {
            let slot = slot_name(progress, *slot);
            format!("{code}: {done} of {all} done{out}, {slot} is unfinished in {recording}: go on with {operate}")
        }
        NextRecording::Running { slot, recording } => {
            format!(
                "{code}: {done} of {all} done{out}, {} is being recorded in {recording}",
                slot_name(progress, *slot)
            )
        }
    }
}

/// The command that records a participant of a plan. `kind`: that of the participant, if not the session file's; an
/// external one is chosen by the session file alone.
pub(super) fn operate_command(
    session: &Path,
    out: &Path,
    frozen: Option<&Path>,
    code: &str,
    kind: Option<ParticipantKind>,
) -> String {
    let kind = kind.filter(|kind| *kind != ParticipantKind::External);
    let kind = kind.map_or(String::new(), |kind| format!(" --participant {}", kind.name()));
    let out = match out.to_str() {
        Some(DEFAULT_OUT) => String::new(),
        _ => format!(" --out {}", out.display()),
    };
    let frozen = frozen.map_or(String::new(), |file| format!(" --frozen {}", file.display()));
    format!("tomcom operate {} --code {code}{kind}{out}{frozen}", session.display())
}

/// The recordings of a study in the folder `out`, and the number of simulated ones.
///
/// # Errors
/// A recording cannot be read, or is of a participant who is not in the plan.
pub fn recordings_of(study: &Study, out: &Path) -> Result<(Vec<PlanRecording>, u64), LiveError> {
    let (made, simulated) = recordings::of_plan(out, &study.plan.name)?;
    let codes = study.plan.codes();
    let Some(stranger) = made.iter().find(|made| !codes.contains(&made.code)) else {
        return Ok((made, simulated));
    };
    let PlanRecording { recording, code, recorded_as, .. } = stranger;
    let found = format!("the recording {recording} of {code}, a participant who is not in the plan");
    Err(match recorded_as {
        None => LiveError::Plan(found),
        Some(before) => LiveError::Corrected {
            found: format!("{found}; it was recorded as {before}"),
            recording: out.join(recording),
        },
    })
}
