//! Table of answers to the questions of tutorials.

use serde::{Deserialize, Serialize};

use crate::column::{CsvColumn, CsvRow, CsvTable};
use tomcom_core::base::text::GUARDED;
use tomcom_core::base::time::SessionTime;
use tomcom_session::plan::{PhaseSpec, TutorialStep, TutorialStepKind};
use tomcom_session::protocol::{ProtocolEvent, StudyPhase};
use tomcom_session::tutorial::TutorialEvent;
use tomcom_session::{Event, SessionSpec, TimestampedEvent};

/// Row of the table of tutorials: a question of a tutorial with the participant's answers.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct TutorialQuestionRow {
    /// The recording's name in tables.
    pub recording: String,
    /// The participant's code.
    pub participant: String,
    /// The name of the tutorial in its file.
    pub tutorial: String,
    /// Identifier of the tutorial's step.
    pub step: String,
    /// The tutorial's question, as the participant read it.
    pub question: String,
    /// Text of the participant's first answer; `None` if the question was not answered.
    pub first_answer: Option<String>,
    /// Number of answers that the participant gave, including the right one.
    pub tries: u32,
    /// Whether the participant's last answer was right; `None` if the question was not answered.
    pub right: Option<bool>,
    /// Time from the question's first appearance to the right answer, in seconds.
    pub seconds: Option<f64>,
}

impl TutorialQuestionRow {
    /// Whether the participant's first answer was right.
    pub fn is_right_at_once(&self) -> bool {
        self.tries == 1 && self.right == Some(true)
    }
}

/// A question of the tutorial while its recording is read.
struct OpenQuestion<'a> {
    step: &'a TutorialStep,
    shown: Option<SessionTime>,
    answer: TutorialQuestionRow,
}

/// Collects the answers to the questions of a recording's tutorial from its events.
pub struct TutorialAnswerCollector<'a> {
    first: Option<&'a str>,
    open: Vec<OpenQuestion<'a>>,
    /// Whether the tutorial has begun in the recording.
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

    /// Notes the next event of the recording.
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
