//! Tables of participants (with the measures that are compared between their trials), of answers to questionnaires, and
//! of answers to the questions of tutorials.

use serde::{Deserialize, Serialize};

use crate::column::{CsvCell, CsvColumn, CsvRow, CsvTable};
use crate::effect::{StudyMeasure, TrialPair, pairs};
use crate::pass::reading::RecordedConsent;
use crate::tables::trials::{HEADLINE, measures};
use crate::trial_statistics::{QuestionnaireAnswer, TrialStatistics};
use tomcom_core::base::text::GUARDED;
use tomcom_core::base::time::SessionTime;
use tomcom_session::plan::{PhaseSpec, TutorialStep, TutorialStepKind};
use tomcom_session::protocol::{ProtocolEvent, StudyPhase};
use tomcom_session::questionnaire::AnswerValue;
use tomcom_session::tutorial::TutorialEvent;
use tomcom_session::{Event, SessionSpec, TimestampedEvent};

#[derive(Clone, Copy, Debug)]
pub struct ParticipantRow<'a>(&'a [TrialStatistics], Option<&'a RecordedConsent>);

/// Participants of these trials, which must be ordered by participant, with their consents, which must be ordered by
/// time.
pub fn participants<'a>(
    trials: &'a [TrialStatistics],
    consents: &'a [RecordedConsent],
) -> impl Iterator<Item = ParticipantRow<'a>> {
    trials.chunk_by(|a, b| a.participant == b.participant).map(|of_one| {
        ParticipantRow(of_one, consents.iter().find(|consent| consent.participant == of_one[0].participant))
    })
}

impl ParticipantRow<'_> {
    /// The participant's compared pair of trials for a measure; `None` unless two trials of the participant count and
    /// have the measure.
    fn pair(&self, measure: StudyMeasure) -> Option<TrialPair> {
        pairs(self.0, measure).pairs.pop()
    }
}

impl CsvRow for ParticipantRow<'_> {
    const TABLE: CsvTable = CsvTable::Participants;

    fn columns() -> Vec<CsvColumn<Self>> {
        let code = "participant code; prefixed by the seed if several seeds are analysed together";
        let kind = "kind of participant: simulated, keyboard (at the console) or display (at the wall display)";
        let group = "starting group in the study plan; AB: conditions in the plan's order";
        let second = "whether the second trial is the assisted one; empty without a pair of trials that count";
        let mut columns: Vec<CsvColumn<Self>> = vec![
            Self::column("participant", "", code, |row| (&row.0[0].participant).into()),
            Self::column("kind", "", kind, |row| row.0[0].kind_name().into()),
            Self::column("group", "", group, |row| row.0[0].group.as_ref().into()),
            Self::column("trials", "trials", "number of recorded trials", |row| (row.0.len() as u64).into()),
            Self::column("trials_counted", "trials", "number of trials that are not left out", |row| {
                (row.0.iter().filter(|trial| trial.counts()).count() as u64).into()
            }),
            Self::column("assisted_second", "", second, |row| {
                row.pair(HEADLINE).map(|pair| pair.assisted_second).into()
            }),
        ];
        for measure in measures() {
            for (index, period) in ["first", "second"].into_iter().enumerate() {
                let name = format!("{}_{}", measure.name, index + 1);
                let meaning = measure.meaning_in.replace("{}", period);
                columns.push(Self::column(name, measure.unit, meaning, move |row| {
                    row.pair(measure).map(|pair| pair.values[index]).into()
                }));
            }
        }
        let on = "where consent was given: held on the display, or confirmed by the wizard on the console; empty: not recorded";
        let at = "wall clock time (UTC) at which the recording that begins with the consent began";
        let digest = "digest of the text that was agreed to, as the recording has it beside the text";
        columns.extend([
            Self::column("consent_on", "", on, |row| row.1.map(RecordedConsent::place).into()),
            Self::column("consent_at", "", at, |row| row.1.and_then(|consent| consent.started.as_ref()).into()),
            Self::column("consent_digest", "", digest, |row| row.1.map(|consent| &consent.digest).into()),
        ]);
        columns
    }
}

/// Row of the table of questionnaires: an answer with the trial after which it was given.
#[derive(Clone, Copy, Debug)]
pub struct AnswerRow<'a> {
    trial: &'a TrialStatistics,
    answer: &'a QuestionnaireAnswer,
}

pub fn answers(trial: &TrialStatistics) -> impl Iterator<Item = AnswerRow<'_>> {
    trial.answers.iter().map(move |answer| AnswerRow { trial, answer })
}

impl CsvRow for AnswerRow<'_> {
    const TABLE: CsvTable = CsvTable::Questionnaires;

    fn columns() -> Vec<CsvColumn<Self>> {
        let given = format!(
            "answer as given (not reversed): a point of the scale from 1, a number, a slider's position from 0 to 100, words, \
             or ids of options separated by spaces; empty: skipped; {GUARDED}"
        );
        let score = "score of the whole questionnaire at this occasion, the same at all its items; empty: it has none, or an item \
                     was skipped";
        vec![
            Self::column("recording", "", "as in trials", |row| (&row.trial.recording).into()),
            Self::column("participant", "", "as in participants", |row| (&row.trial.participant).into()),
            Self::column(
                "condition",
                "",
                "condition of the trial before it, or of the first trial if it was asked before that",
                |row| row.trial.condition.name().into(),
            ),
            Self::column("questionnaire", "", "name", |row| (&row.answer.questionnaire).into()),
            Self::column("item", "", "id of the item", |row| (&row.answer.item).into()),
            Self::column("about", "", "construct that the item measures", |row| row.answer.about.as_ref().into()),
            Self::column("reversed", "", "whether agreement counts against the construct", |row| {
                row.answer.reversed.into()
            }),
            Self::column("answer", "", given, |row| match &row.answer.answer {
                Some(AnswerValue::Number(number)) => (*number).into(),
                Some(answer) => answer.cell().into(),
                None => CsvCell::Unknown,
            }),
            Self::column("points", "points", "number of points of the scale; empty: no scale", |row| {
                row.answer.points.into()
            }),
            Self::column("kind", "", "scale, choice, number, text or slider", |row| row.answer.kind.name().into()),
            Self::column("asked", "", "before the first trial, or after the trial", |row| {
                if row.answer.before { "before" } else { "after" }.into()
            }),
            Self::column("score", "", score, |row| row.answer.score.into()),
        ]
    }
}

/// Row of the table of tutorials: a question of a tutorial with the participant's answers.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct TutorialQuestionRow {
    pub recording: String,
    pub participant: String,
    pub tutorial: String,
    pub step: String,
    pub question: String,
    /// Text of the participant's first answer; `None` if the question was not answered.
    pub first_answer: Option<String>,
    pub tries: u32,
    /// Whether the participant's last answer was right; `None` if the question was not answered.
    pub right: Option<bool>,
    pub seconds: Option<f64>,
}

impl TutorialQuestionRow {
    fn is_right_at_once(&self) -> bool {
        self.tries == 1 && self.right == Some(true)
    }
}

struct OpenQuestion<'a> {
    step: &'a TutorialStep,
    shown: Option<SessionTime>,
    answer: TutorialQuestionRow,
}

pub struct TutorialAnswerCollector<'a> {
    first: Option<&'a str>,
    open: Vec<OpenQuestion<'a>>,
    has_begun: bool,
}

impl<'a> TutorialAnswerCollector<'a> {
    /// A collector for the tutorial among the phases of a recording; `None` if the recording has no tutorial.
    pub fn new(recording: &str, spec: &'a SessionSpec) -> Option<TutorialAnswerCollector<'a>> {
        let tutorial = spec.step.as_ref()?.phases.iter().find_map(|phase| match phase {
            PhaseSpec::Tutorial { tutorial } => Some(tutorial),
            _ => None,
        })?;
        let questions = tutorial.steps.iter().filter(|step| step.kind == TutorialStepKind::Question);
        let open = questions.map(|step| OpenQuestion {
            step,
            shown: None,
            answer: TutorialQuestionRow {
                recording: recording.to_string(),
                participant: spec.participant.code.clone(),
                tutorial: tutorial.name.clone(),
                step: step.id.clone(),
                question: step.text.clone(),
                first_answer: None,
                tries: 0,
                right: None,
                seconds: None,
            },
        });
        let first = tutorial.steps.first().map(|step| step.id.as_str());
        Some(TutorialAnswerCollector { first, open: open.collect(), has_begun: false })
    }

    pub fn note(&mut self, stamped: &TimestampedEvent) {
        let Event::Protocol(event) = &stamped.event else { return };
        match event {
            ProtocolEvent::PhaseStarted { phase: StudyPhase::Tutorial, .. } => {
                self.has_begun = true;
                if let Some(first) = self.first {
                    self.show(first, stamped.time);
                }
            }
            ProtocolEvent::Tutorial(TutorialEvent::Shown { step, .. }) => self.show(step, stamped.time),
            ProtocolEvent::Tutorial(TutorialEvent::Answered { step, choice }) => {
                self.answer(step, *choice, stamped.time);
            }
            _ => {}
        }
    }

    fn show(&mut self, id: &str, now: SessionTime) {
        if let Some(question) = self.open.iter_mut().find(|question| question.step.id == id) {
            question.shown.get_or_insert(now);
        }
    }

    fn answer(&mut self, id: &str, choice: u8, now: SessionTime) {
        let Some(OpenQuestion { step, shown, answer }) = self.open.iter_mut().find(|one| one.step.id == id) else {
            return;
        };
        let words = usize::from(choice).checked_sub(1).and_then(|index| step.choices.get(index));
        let is_right = step.right == Some(choice);
        answer.tries += 1;
        answer.right = Some(is_right);
        answer.first_answer = answer.first_answer.take().or_else(|| words.cloned());
        if is_right {
            answer.seconds = shown.map(|shown| now.secs_since(shown));
        }
    }

    /// The tutorial's questions with their answers, in the tutorial's order; empty if the tutorial did not begin.
    pub fn finish(self) -> Vec<TutorialQuestionRow> {
        let has_begun = self.has_begun;
        self.open.into_iter().filter(|_| has_begun).map(|question| question.answer).collect()
    }
}

impl CsvRow for TutorialQuestionRow {
    const TABLE: CsvTable = CsvTable::Tutorial;

    fn columns() -> Vec<CsvColumn<Self>> {
        let right = "whether the last answer was right; empty: not answered";
        let seconds = "from the question's first appearance to the right answer";
        vec![
            Self::column("recording", "", "name of the recording", |row| (&row.recording).into()),
            Self::column("participant", "", "as in participants", |row| (&row.participant).into()),
            Self::column("tutorial", "", "name of the tutorial", |row| (&row.tutorial).into()),
            Self::column("step", "", "id of the step", |row| (&row.step).into()),
            Self::column("question", "", "as the participant read it", |row| (&row.question).into()),
            Self::column("first_answer", "", format!("the first choice; empty: not answered; {GUARDED}"), |row| {
                row.first_answer.as_ref().into()
            }),
            Self::column("right", "", right, |row| row.right.into()),
            Self::column("tries", "", "number of answers, the right one included", |row| row.tries.into()),
            Self::column("seconds", "s", seconds, |row| row.seconds.into()),
        ]
    }
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub struct TutorialSummary {
    pub participants: u64,
    pub questions: u64,
    pub right_at_once: u64,
}

impl TutorialSummary {
    /// Summarizes answers, which must be ordered by participant; `None` if no question was answered.
    pub fn from_answers(answers: &[TutorialQuestionRow]) -> Option<TutorialSummary> {
        let answered: Vec<&TutorialQuestionRow> = answers.iter().filter(|answer| answer.tries > 0).collect();
        let mut participants: Vec<&str> = answered.iter().map(|answer| answer.participant.as_str()).collect();
        participants.dedup();
        (!answered.is_empty()).then(|| TutorialSummary {
            participants: participants.len() as u64,
            questions: answered.len() as u64,
            right_at_once: answered.iter().filter(|answer| answer.is_right_at_once()).count() as u64,
        })
    }
}
