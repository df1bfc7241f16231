//! Command `tomcom plan`: participants, groups, progress and next recordings of a study.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use serde::Serialize;

use super::error::LiveError;
use super::series::{operate_command, recordings_of, slot_name, stands};
use crate::console::text_columns::{beside, width};
use tomcom_core::base::text::{PathText, count};
use tomcom_session::files::file_error::{FileError, FileResult, place_of, read_text};
use tomcom_session::files::{KitchenWithSources, SessionSetup, in_language};
use tomcom_session::plan::{
    ParticipantProgress, PlanDifference, PlanRecording, RecordingOutcome, Study, TrialAttempt, orders,
};
use tomcom_session::settings::ParticipantKind;
use tomcom_session::study_arm::StudyArm;
use tomcom_study::files::pool_file;
use tomcom_study::frozen_plan::FrozenPlan;

/// Progress of a study: the output of `tomcom plan SESSION`.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct StudyProgress {
    /// Path of the session file with the plan.
    pub session: PathText,
    pub recordings: PathText,
    /// File of the frozen plan that was asked for.
    #[serde(skip)]
    pub frozen: Option<PathBuf>,
    pub plan: String,
    /// Checksum of the plan and its settings.
    pub digest: String,
    /// Seed of counterbalancing, and of the trials' random numbers.
    pub seed: u64,
    pub planned: usize,
    /// Number of participants who have completed all their recordings.
    pub finished: usize,
    /// Number of simulated recordings of the plan, which fill none of it.
    pub simulated: u64,
    /// What the plan leaves out without being wrong, and which recordings do not count, in words.
    pub remarks: Vec<String>,
    pub participants: Vec<ParticipantProgress>,
}

impl StudyProgress {
    /// Progress of a study, whose plan is in the file `session`, computed from the recordings in the folder `out`.
    ///
    /// # Errors
    /// A recording cannot be read or does not belong to the plan.
    pub fn from_study(
        study: &Study,
        session: &Path,
        out: &Path,
        frozen: Option<&Path>,
    ) -> Result<StudyProgress, LiveError> {
        let (made, simulated) = recordings_of(study, out)?;
        let codes = study.plan.codes();
        let progress =
            |participant| ParticipantProgress::from_recordings(study, participant, &made).map_err(LiveError::Plan);
        let participants = (0..codes.len()).map(progress).collect::<Result<Vec<_>, _>>()?;
        Ok(StudyProgress {
            session: session.to_path_buf().into(),
            recordings: out.to_path_buf().into(),
            frozen: frozen.map(Path::to_path_buf),
            plan: study.plan.name.clone(),
            digest: study.digest.clone(),
            seed: study.session.seed,
            planned: participants.len(),
            finished: participants.iter().filter(|one| one.done() == one.steps.len()).count(),
            simulated,
            remarks: remarks(study)
                .into_iter()
                .chain(rehearsed(&made))
                .chain(uncounted(made.len(), simulated, session, out, frozen))
                .collect(),
            participants,
        })
    }
}

fn remarks(study: &Study) -> Vec<String> {
    let language = study.session.display.code();
    // Nobody but its author knows the language of the consent's text.
    let consent = (language != "en")
        .then(|| format!("the consent's text stands in the plan: make sure that it is in \"{language}\""));
    study.remarks().into_iter().chain(consent).collect()
}

/// That recordings of rehearsals count as those of people.
fn rehearsed(made: &[PlanRecording]) -> Option<String> {
    let rehearsed = made.iter().filter(|made| made.kind == ParticipantKind::Simulated).count() as u64;
    let are = count(rehearsed, "recording is", "recordings are");
    let told = || format!("{are} of a simulated participant at the console, and count here as those of people do");
    (rehearsed > 0).then(told)
}

/// Why recordings that somebody made may not show in the progress.
fn uncounted(counted: usize, simulated: u64, session: &Path, out: &Path, frozen: Option<&Path>) -> Option<String> {
    let operate = operate_command(session, out, frozen, "CODE", None);
    let missing = if out.exists() { "" } else { ", which does not exist" };
    let out = out.display();
    match (counted, simulated) {
        (0, 0) => Some(format!("no recording of the plan is in {out}{missing}; --out DIR looks in another folder")),
        (_, 0) => None,
        (_, some) => Some(format!(
            "not counted: {}, since tomcom simulate fills no plan; {}",
            count(some, "recording of a simulated participant", "recordings of simulated participants"),
            match counted {
                0 => format!("tomcom study {out} analyses them, {operate} records for the plan"),
                _ => "move them to a folder of their own".to_string(),
            }
        )),
    }
}

/// Result of freezing (preregistering) a study plan: the output of `tomcom plan SESSION --freeze FILE`.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct FrozenPlanSummary {
    pub plan: String,
    /// SHA-256 digest of the frozen plan.
    pub digest: String,
    /// Number of recordings of the plan that existed already.
    pub recordings_before: u64,
    pub file: PathText,
}

impl FrozenPlanSummary {
    /// What the frozen plan contains, as text for the terminal.
    pub fn describe(&self) -> String {
        let (file, before) = (self.file.display(), count(self.recordings_before, "recording", "recordings"));
        let warning = match self.recordings_before {
            0 => String::new(),
            _ => format!("{before} of the plan were made before the plan was frozen; the file says so\n"),
        };
        format!(
            "the plan {} is frozen in {file}\nSHA-256 {}\n{warning}after the study: tomcom study RECORDINGS --frozen \
             {file}\n",
            self.plan, self.digest
        )
    }
}

/// Freezes a study plan: writes it with definitions and analysis to a new file. `progress`: the study's progress so
/// far.
///
/// # Errors
/// The file of the frozen plan exists already, or cannot be written.
pub fn freeze(
    study: &Study,
    kitchen: &KitchenWithSources,
    progress: &StudyProgress,
    file: &Path,
) -> FileResult<FrozenPlanSummary> {
    let steps = progress.participants.iter().flat_map(|one| &one.steps);
    let recordings_before = steps.map(|step| step.recordings.len() as u64).sum();
    let frozen = FrozenPlan::new(study, [&kitchen.layout.text, &kitchen.recipes.text], recordings_before);
    let digest = pool_file::freeze(file, &frozen)?;
    Ok(FrozenPlanSummary { plan: frozen.plan, digest, recordings_before, file: file.to_path_buf().into() })
}

/// Checks that the study of a session file is the one that was frozen in the file `frozen`.
///
/// # Errors
/// The file is no frozen plan, or the study is another one: at the first setting or line that differs.
pub fn check_frozen(session: &Path, files: &SessionSetup, frozen: &Path) -> FileResult<()> {
    let (_, plan) = pool_file::read_frozen(frozen)?;
    let wrong = |found: &str| {
        let remedy = format!("the plan \"{}\", which was frozen in {}", plan.plan, frozen.display());
        FileError::from_finding(session, found.to_string(), remedy)
    };
    let study = files.study().ok_or_else(|| wrong("a session without a plan"))?;
    if study.digest == plan.plan_digest {
        return Ok(());
    }
    let KitchenWithSources { layout, recipes, .. } = &files.kitchen;
    let folder = session.parent().unwrap_or(Path::new("."));
    let layout_path = folder.join(&layout.path);
    let recipes_path = layout_path.parent().unwrap_or(Path::new(".")).join(&recipes.path);
    let sources = [(layout_path, &layout.text, "layout"), (recipes_path, &recipes.text, "recipes")];
    let frozen_text = |kind: &str| plan.settings[kind].as_str().unwrap_or_default();
    let texts = plan.texts_differ_from(&study);
    // The error points to the first difference; the others are listed, whatever file they are in.
    let too = |others: &[PlanDifference], sources: &[(PathBuf, &String, &str)], texts: &[PlanDifference]| {
        let files = sources.iter().filter(|(_, now, kind)| *now != frozen_text(kind));
        let settings = others.iter().chain(texts).map(PlanDifference::to_string);
        let all = settings.chain(files.map(|(path, ..)| path.display().to_string()));
        all.map(|one| format!("\nchanged, too: {one}")).collect::<String>()
    };
    let wrong_at = |path: &Path, text: &str, place, found: &str, before: &str, others: String| {
        let right = format!(
            "{before}, as it was frozen in {}{others}\nrestore what was frozen, or freeze the changed plan in a new file: tomcom plan {} \
             --freeze NEW",
            frozen.display(),
            session.display()
        );
        FileError::at(path, text, place, format!("{found}, changed since the plan was frozen"), right)
    };
    let changed = plan.differs_from(&study);
    if let [first, others @ ..] = &changed[..] {
        let text = read_text(session)?;
        let [before, found] = first.settings();
        let place = place_of(&text, &first.path, first.nth);
        return Err(wrong_at(session, &text, place, &found, &before, too(others, &sources, &texts)));
    }
    for (nth, (path, now, kind)) in sources.iter().enumerate() {
        let before = frozen_text(kind);
        if *now != before {
            let same =
                now.split_inclusive('\n').zip(before.split_inclusive('\n')).take_while(|(now, before)| now == before);
            let start = same.map(|(line, _)| line.len()).sum();
            let [found, wanted] =
                [now, before].map(|text| text[start..].lines().next().unwrap_or("the end of the file"));
            let others = too(&[], &sources[nth + 1..], &texts);
            return Err(wrong_at(path, now, Some(start..start + found.len()), found, wanted, others));
        }
    }
    let Some((first, others)) = texts.split_first() else {
        return Err(wrong("another text of what participants are told, taught or asked"));
    };
    let mut asked = study.plan.questionnaire.iter().zip(&study.questionnaires);
    let of_file = asked.find(|(_, asked)| first.path.starts_with(&format!("questionnaire {}.", asked.name)));
    let file = of_file.map(|(asked, _)| &asked.file).or(study.plan.tutorial.as_ref());
    let path = file.map_or(session.to_path_buf(), |file| in_language(folder.join(file), study.session.display.code()));
    let text = read_text(&path)?;
    let now = first.values[1].as_ref().and_then(|now| now.as_str()).filter(|now| !now.is_empty());
    let place = now.and_then(|now| Some(text.find(now)?..text.find(now)? + now.len()));
    let [before, _] = first.settings();
    Err(wrong_at(&path, &text, place, &first.to_string(), &before, too(others, &[], &[])))
}

/// Progress of the study as text for a terminal of this width. Where the conditions leave little room, the letters of the
/// groups stand for them.
pub fn describe(figures: &StudyProgress, columns: u16) -> String {
    let mut sizes = BTreeMap::new();
    for one in &figures.participants {
        *sizes.entry(one.group.as_str()).or_insert(0) += 1;
    }
    let sizes: Vec<String> = sizes.iter().map(|(group, size)| format!("{size} {group}")).collect();
    let finished = figures.participants.iter().filter(|one| one.done() == one.steps.len());
    let with_excluded = match finished.filter(|one| one.excluded().next().is_some()).count() {
        0 => String::new(),
        some => format!(" ({some} of them with an excluded trial)"),
    };
    let head = format!(
        "plan {} ({}), seed {}: {} of {} participants have done everything{with_excluded}; groups: {}\n",
        figures.plan,
        figures.digest,
        figures.seed,
        figures.finished,
        figures.planned,
        sizes.join(", ")
    );
    let arms = |progress: &ParticipantProgress| -> Vec<&str> {
        let trials = progress.steps.iter().filter(|stand| stand.slot.period.is_some());
        trials.map(|stand| stand.slot.condition.title()).collect()
    };
    let code = figures.participants.iter().map(|one| one.code.len()).max().unwrap_or(0);
    let group = |progress: &ParticipantProgress| format!("{:code$}  {}  ", progress.code, progress.group);
    let whole = |progress: &ParticipantProgress| format!("{}{}  ", group(progress), arms(progress).join(", "));
    let is_wide = figures.participants.iter().any(|one| 2 * width(&whole(one)) > columns);
    let one = |progress: &ParticipantProgress| {
        let first = if is_wide { group(progress) } else { whole(progress) };
        let StudyProgress { session, recordings, frozen, .. } = figures;
        let operate = operate_command(session, recordings, frozen.as_deref(), &progress.code, progress.kind);
        let stands = stands(progress, &operate);
        let stands = stands.split_once(": ").map_or(stands.as_str(), |(_, stands)| stands);
        let attempts = attempts(progress);
        let attempts = attempts.lines().map(|line| beside("", line, 6, columns));
        beside(&first, stands, width(&first), columns) + &attempts.collect::<String>()
    };
    let letters = figures.participants.first().filter(|_| is_wide).map_or(String::new(), |one| {
        let letters: BTreeMap<char, &str> = one.group.chars().zip(arms(one)).collect();
        letters.into_iter().map(|(letter, arm)| format!("{letter}: {arm}")).collect::<Vec<_>>().join(", ")
    });
    let remarks: String = figures.remarks.iter().map(|remark| format!("{remark}\n")).collect();
    let head = head + &unbalanced(figures) + &remarks + &letters;
    head.lines().map(|line| beside("", line, 0, columns)).chain(figures.participants.iter().map(one)).collect()
}

/// Remark on a number of participants with whom the orders of the conditions do not come equally often.
fn unbalanced(figures: &StudyProgress) -> String {
    let Some(first) = figures.participants.first() else { return String::new() };
    let trials = |one: &ParticipantProgress| -> Vec<StudyArm> {
        one.steps.iter().filter(|stand| stand.slot.period.is_some()).map(|stand| stand.slot.condition).collect()
    };
    let conditions = trials(first);
    let (orders, planned) = (orders(conditions.len()).len(), figures.planned);
    if planned % orders == 0 {
        return String::new();
    }
    let firsts: Vec<StudyArm> = figures.participants.iter().filter_map(|one| trials(one).first().copied()).collect();
    let mut arms = conditions;
    arms.sort_unstable();
    let times = |arm: &StudyArm| format!("{} {}", arm.title(), firsts.iter().filter(|first| *first == arm).count());
    let times = arms.iter().map(times).collect::<Vec<_>>().join(", ");
    format!(
        "not balanced: {} with {orders} orders of the conditions (first comes: {times}); a multiple of {orders} participants is\n",
        count(planned as u64, "participant", "participants"),
    )
}

/// Remarks on a participant's recordings: invalid recordings, and recordings made with another version of the plan.
fn attempts(progress: &ParticipantProgress) -> String {
    let mut lines = String::new();
    for (slot, stand) in progress.steps.iter().enumerate() {
        // A trial that is over counts, also if what follows it was left.
        let is_complete = |attempt: &&TrialAttempt| match attempt.outcome {
            RecordingOutcome::Complete => true,
            RecordingOutcome::Open => attempt.trial_over && attempt.excluded.is_none(),
            _ => false,
        };
        let complete: Vec<&str> =
            stand.recordings.iter().filter(is_complete).map(|one| one.recording.as_str()).collect();
        if let ([_, _, ..], Some(_)) = (&complete[..], stand.slot.period) {
            let name = slot_name(progress, slot);
            lines += &format!(
                "{name} is done in {}; one of them counts, so leave the others out: tomcom exclude\n",
                complete.join(" and in ")
            );
        }
        for (index, attempt) in stand.recordings.iter().enumerate() {
            let open = if index + 1 < stand.recordings.len() { "not finished, repeated" } else { "open" };
            let simulated = if attempt.simulated { ", with a simulated participant" } else { "" };
            let version = if attempt.other_version { ", recorded under another version of the plan" } else { "" };
            let planned = stand.slot.condition.title();
            let arm = attempt.other_arm.map(|arm| format!(", in the condition {} (planned: {planned})", arm.title()));
            let arm = arm.unwrap_or_default();
            let recorded = attempt.recorded_as.as_ref();
            let corrected = recorded.map_or(String::new(), |code| format!(", recorded as {code}{arm}"));
            let how = match (&attempt.outcome, &attempt.waived, &attempt.excluded) {
                (RecordingOutcome::Complete, Some(reason), _) => &format!("criterion not met, waived ({reason})"),
                (RecordingOutcome::Complete, None, _) if attempt.ended_by_wizard && stand.slot.period.is_some() => {
                    let over = attempt.ended_where.split("; ").next().unwrap_or_default();
                    &format!("{over}, as the wizard ended it; it counts")
                }
                (RecordingOutcome::Complete, None, _)
                    if attempt.simulated || attempt.other_version || recorded.is_some() =>
                {
                    "done"
                }
                (RecordingOutcome::Complete, None, _) => continue,
                (RecordingOutcome::Open, _, Some(reason)) => &format!("{open}, excluded ({reason})"),
                (RecordingOutcome::Open, _, None) => open,
                (RecordingOutcome::Running, ..) => "being recorded",
                (RecordingOutcome::Excluded { reason }, ..) => &format!("excluded ({reason})"),
                (RecordingOutcome::Void { reason }, ..) => reason,
            };
            let (name, recording) = (slot_name(progress, slot), &attempt.recording);
            lines += &format!("{name} in {recording}: {how}{simulated}{version}{corrected}\n");
        }
    }
    lines
}
