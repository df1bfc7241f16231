//! Tables of participants (with the measures that are compared between their trials), of answers to questionnaires, and
//! of answers to the questions of tutorials.

use serde::{Deserialize, Serialize};

use crate::column::{CsvRow, CsvTable, TableCell, TableColumn, columns};
use crate::effect::{StudyMeasure, TrialPair, pairs};
use crate::pass::reading::RecordedConsent;
use crate::tables::trials::{HEADLINE, MEASURES};
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

/// `trials`: ordered by participant; `consents`: by time.
pub fn participants<'a>(
    trials: &'a [TrialStatistics],
    consents: &'a [RecordedConsent],
) -> impl Iterator<Item = ParticipantRow<'a>> {
    trials.chunk_by(|a, b| a.participant == b.participant).map(|of_one| {
        ParticipantRow(of_one, consents.iter().find(|consent| consent.participant == of_one[0].participant))
    })
}

/// Words for the number of a trial.
const NTH: [&str; 6] = ["first", "second", "third", "fourth", "fifth", "sixth"];

impl<'a> ParticipantRow<'a> {
    /// `None` unless two trials of the participant count and have the measure.
    fn pair(&self, measure: StudyMeasure) -> Option<TrialPair> {
        pairs(self.0, measure).pairs.pop()
    }

    /// Of the trial with this number, from 1; of a repeated one the last that counts.
    fn value(&self, measure: StudyMeasure, period: usize) -> Option<f64> {
        let is_it = |trial: &&TrialStatistics| trial.counts() && trial.period == Some(period as u32);
        (measure.value)(self.0.iter().rfind(is_it)?)
    }

    /// A measure has a column for each trial of a participant: at least two, and as many as these trials have.
    pub fn columns_of(trials: &[TrialStatistics]) -> Vec<TableColumn<ParticipantRow<'a>>> {
        let periods = trials.iter().filter_map(|trial| trial.period).max().unwrap_or(0) as usize;
        ParticipantRow::columns_up_to(periods.clamp(2, NTH.len()))
    }

    fn columns_up_to(periods: usize) -> Vec<TableColumn<ParticipantRow<'a>>> {
        let mut columns: Vec<TableColumn<Self>> = columns! { |row: Self|
            "participant", "", "participant code; prefixed by the seed if several seeds are analysed together"
                => &row.0[0].participant;
            "kind", "", "kind of participant: simulated, keyboard (at the console) or display (at the wall display)"
                => row.0[0].kind.name();
            "group", "", "starting group in the study plan, with a letter for each trial; A: the plan's first condition; empty: no plan"
                => row.0[0].group.as_ref();
            "trials", "trials", "number of recorded trials" => row.0.len() as u64;
            "trials_counted", "trials", "number of trials that are not left out"
                => row.0.iter().filter(|trial| trial.counts()).count() as u64;
        };
        if periods == 2 {
            columns.extend(columns! { |row: Self|
                "assisted_second", "", "whether the second trial is the assisted one; empty without a pair of trials that \
                    count" => row.pair(HEADLINE).map(|pair| pair.assisted_second);
            });
        }
        for measure in MEASURES {
            for (index, nth) in NTH.into_iter().enumerate().take(periods) {
                let name = format!("{}_{}", measure.name, index + 1);
                let meaning = measure.meaning_of_nth(nth);
                columns.push(TableColumn::new(name, measure.unit, meaning, move |row: &Self| {
                    row.value(measure, index + 1).into()
                }));
            }
        }
        columns.extend(columns! { |row: Self|
            "consent_on", "", "where consent was given: held on the display, or confirmed by the wizard on the \
                console; empty: not recorded" => row.1.map(RecordedConsent::place);
            "consent_at", "", "wall clock time (UTC) at which the recording that begins with the consent began; empty: not recorded"
                => row.1.and_then(|consent| consent.started.as_ref());
            "consent_digest", "", "digest of the text that was agreed to, as the recording has it beside the text; empty: not recorded"
                => row.1.map(|consent| &consent.digest);
        });
        columns
    }
}

impl CsvRow for ParticipantRow<'_> {
    const TABLE: CsvTable = CsvTable::Participants;

    fn columns() -> Vec<TableColumn<Self>> {
        ParticipantRow::columns_up_to(2)
    }
}

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

    fn columns() -> Vec<TableColumn<Self>> {
        columns! { |row: Self|
            "recording", "", "as in trials" => &row.trial.recording;
            "participant", "", "as in participants" => &row.trial.participant;
            "condition", "", "condition of the trial before it, or of the first trial if it was asked before that"
                => row.trial.condition.name();
            "questionnaire", "", "name" => &row.answer.asked.questionnaire;
            "item", "", "id of the item" => &row.answer.asked.item;
            "about", "", "construct that the item measures; empty: the questionnaire says none" => row.answer.asked.about.as_ref();
            "reversed", "", "whether agreement counts against the construct" => row.answer.asked.reversed;
            "answer", "", format!(
                "answer as given (not reversed): a point of the scale from 1, a number, a slider's position from 0 to 100, \
                words, or ids of options separated by spaces; empty: skipped; {GUARDED}"
            ) => row.answer.answer.as_ref().map(|answer| match answer {
                AnswerValue::Number(number) => TableCell::Whole(*number),
                answer => answer.cell().into(),
            });
            "points", "points", "number of points of the scale; empty: no scale" => row.answer.points;
            "kind", "", "scale, choice, number, text or slider" => row.answer.asked.kind.name();
            "asked", "", "before the first trial, or after the trial"
                => (if row.answer.before { "before" } else { "after" });
            "score", "", "score of the whole questionnaire at this occasion, the same at all its items; empty: it has none, or an \
                item was skipped" => row.answer.score;
        }
    }
}

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

    fn columns() -> Vec<TableColumn<Self>> {
        columns! { |row: Self|
            "recording", "", "name of the recording" => &row.recording;
            "participant", "", "as in participants" => &row.participant;
            "tutorial", "", "name of the tutorial" => &row.tutorial;
            "step", "", "id of the step" => &row.step;
            "question", "", "as the participant read it" => &row.question;
            "first_answer", "", format!("the first choice; empty: not answered; {GUARDED}")
                => row.first_answer.as_ref();
            "right", "", "whether the last answer was right; empty: not answered" => row.right;
            "tries", "", "number of answers, the right one included" => row.tries;
            "seconds", "s", "from the question's first appearance to the right answer; empty: none" => row.seconds;

        }
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
