//! The study protocol: the phases of a plan's recording, which follow one after another.

use serde::{Deserialize, Serialize};

use crate::admit::unless;
pub use crate::plan::StudyPhase;
use crate::plan::{PhaseSpec, PlanPosition};
use crate::questionnaire::{AnswerValue, Questionnaire};
use crate::tutorial::{self, TutorialEvent, TutorialState};
use crate::wall_display::AnswerDevice;
use crate::{Session, TrialPhase};
use tomcom_core::base::time::SessionTime;

named!(StudyPhase);

impl StudyPhase {
    /// As screens name it.
    pub fn title(self) -> &'static str {
        match self {
            StudyPhase::Familiarisation => "practice",
            phase => phase.name(),
        }
    }

    /// Practice or counted.
    pub fn has_trial(self) -> bool {
        matches!(self, StudyPhase::Trial | StudyPhase::Familiarisation)
    }
}

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "what", rename_all = "snake_case")]
pub enum ProtocolEvent {
    /// Without consent nothing is recorded.
    ConsentGiven {
        /// By holding a button on the display, or by telling the wizard, who confirmed it at the console.
        on: AnswerDevice,
        text: String,
        digest: String,
    },
    /// The next phase, after all that the present one needs.
    PhaseStarted {
        phase: StudyPhase,
        /// In the recording, from 1.
        number: usize,
    },
    /// A step of an instruction or debriefing.
    Ticked {
        /// From 1.
        step: usize,
        done: bool,
    },
    /// In the participant's tutorial.
    Tutorial(TutorialEvent),
    /// An item of the questionnaire.
    ItemShown { item: String },
    /// All answers are shown, for the participant to confirm them.
    AnswersShown,
    /// A later answer replaces an earlier one. The next item follows at once, except after sliders and choices of
    /// several options.
    ItemAnswered { item: String, answer: AnswerValue },
    /// The shown item stays without an answer.
    ItemSkipped { item: String },
    /// The answers become final.
    AnswersConfirmed,
    /// Result of the practice trial.
    CriterionChecked {
        met: bool,
        orders: u32,
        /// Of the participant.
        presses: u32,
        /// Among these presses.
        errors: u32,
    },
    /// The wizard goes on although the criterion is not met.
    CriterionWaived { reason: String },
}

#[derive(Clone, Debug, PartialEq, Eq)]
pub enum ItemAnswer {
    Given(AnswerValue),
    Skipped,
}

/// Of the practice trial.
#[derive(Clone, Debug, PartialEq)]
pub struct PracticeResult {
    pub met: bool,
    pub orders: u32,
    pub presses: u32,
    pub errors: u32,
    /// Why the criterion was waived, if it was.
    pub waived: Option<String>,
}

#[derive(Clone, Debug, Default, PartialEq)]
pub struct StudyProtocolState {
    pub consent: bool,
    /// Number of the present phase, from 1; 0 before the first phase.
    pub number: usize,
    /// Steps of the present instruction or debriefing.
    pub ticks: Vec<bool>,
    /// To the items of the present questionnaire.
    pub answers: Vec<Option<ItemAnswer>>,
    /// Index of the shown item; the number of items while all answers are shown for confirmation.
    pub item: usize,
    /// Whether the answers are final.
    pub confirmed: bool,
    pub practice: Option<PracticeResult>,
    pub tutorial: Option<TutorialState>,
}

impl ItemAnswer {
    /// `None` if the item was skipped.
    pub fn value(&self) -> Option<&AnswerValue> {
        match self {
            ItemAnswer::Given(value) => Some(value),
            ItemAnswer::Skipped => None,
        }
    }
}

impl StudyProtocolState {
    /// Whether anything of the plan was done, beyond showing its first sheet.
    pub(crate) fn is_begun(&self) -> bool {
        let is_read = self.tutorial.as_ref().is_some_and(|tutorial| tutorial.step > 0 || tutorial.is_over);
        self.consent
            || self.number > 1
            || is_read
            || self.ticks.contains(&true)
            || self.answers.iter().any(Option::is_some)
    }

    pub fn given(&self, index: usize) -> Option<&AnswerValue> {
        self.answers.get(index)?.as_ref()?.value()
    }

    /// Records the answer to the shown item and shows the next one, unless the shown one stays; after the last item,
    /// the first unanswered one or all answers are shown.
    pub(crate) fn answer(&mut self, answer: ItemAnswer, stays: bool) {
        if let Some(place) = self.answers.get_mut(self.item) {
            *place = Some(answer);
        }
        if stays {
            return;
        }
        let next = self.item + 1;
        self.item = match self.open_item() {
            None => self.answers.len(),
            Some(open) if next == self.answers.len() => open,
            Some(_) => next,
        };
    }

    /// The first item without an answer.
    pub fn open_item(&self) -> Option<usize> {
        self.answers.iter().position(Option::is_none)
    }
}

/// What was done of a phase.
#[derive(Clone, Copy, Debug, Default)]
pub struct PhaseProgress {
    /// Number of steps of an instruction or debriefing.
    pub ticked: usize,
    pub tutorial_over: bool,
    pub trial_over: bool,
    /// Whether the answers to the questionnaire are final.
    pub confirmed: bool,
}

impl PhaseProgress {
    /// Why the phase is not done; `None` if it is.
    pub fn lacks(self, phase: &PhaseSpec) -> Option<&'static str> {
        let (is_done, why) = match phase {
            PhaseSpec::Instruction { steps } | PhaseSpec::Debriefing { steps } => {
                (self.ticked == steps.len(), "not every step of this phase is done")
            }
            PhaseSpec::Tutorial { .. } => (self.tutorial_over, "the participant is not through the tutorial"),
            PhaseSpec::Trial | PhaseSpec::Familiarisation => (self.trial_over, "the trial is not over"),
            PhaseSpec::Questionnaire { .. } => (self.confirmed, "the answers to the questionnaire are not confirmed"),
        };
        (!is_done).then_some(why)
    }
}

impl Session {
    /// `None` if the recording belongs to no plan.
    pub fn step(&self) -> Option<(&PlanPosition, &StudyProtocolState)> {
        self.spec.step.as_ref().zip(self.protocol.as_ref())
    }

    pub fn study_phase(&self) -> Option<&PhaseSpec> {
        let (step, protocol) = self.step()?;
        step.phases.get(protocol.number.checked_sub(1)?)
    }

    pub fn next_phase(&self) -> Option<StudyPhase> {
        let (step, protocol) = self.step()?;
        step.phases.get(protocol.number).map(PhaseSpec::phase)
    }

    /// The event that moves to the next item, or to the overview of all answers; `None` in the overview.
    pub fn next_item(&self) -> Option<ProtocolEvent> {
        let (questionnaire, protocol) = (self.questionnaire()?, self.protocol.as_ref()?);
        questionnaire.items.get(protocol.item)?;
        Some(match questionnaire.items.get(protocol.item + 1) {
            Some(next) => ProtocolEvent::ItemShown { item: next.id.clone() },
            None => ProtocolEvent::AnswersShown,
        })
    }

    /// Of the present phase.
    pub fn questionnaire(&self) -> Option<&Questionnaire> {
        match self.study_phase()? {
            PhaseSpec::Questionnaire { questionnaire } => Some(questionnaire),
            _ => None,
        }
    }

    /// Why the present phase cannot be left yet.
    pub fn phase_lacks(&self) -> Option<&'static str> {
        let protocol = self.protocol.as_ref()?;
        if self.aborted.is_some() {
            return Some("the trial was aborted");
        }
        let progress = PhaseProgress {
            ticked: protocol.ticks.iter().filter(|ticked| **ticked).count(),
            tutorial_over: protocol.tutorial.as_ref().is_some_and(|tutorial| tutorial.is_over),
            trial_over: self.is_trial_over(),
            confirmed: protocol.confirmed,
        };
        progress.lacks(self.study_phase()?)
    }

    /// Whether all phases are done or the trial was aborted; true without a plan.
    pub fn is_step_done(&self) -> bool {
        match &self.protocol {
            None => self.is_trial_over(),
            Some(_) if self.aborted.is_some() => true,
            Some(protocol) => protocol.number > 0 && self.next_phase().is_none() && self.phase_lacks().is_none(),
        }
    }
}

pub fn admit(session: &Session, event: &ProtocolEvent) -> Result<(), &'static str> {
    let Some((step, protocol)) = session.step() else { return Err("the session has no study plan") };
    match event {
        ProtocolEvent::ConsentGiven { .. } => {
            unless(!protocol.consent && protocol.number == 0, "consent is given once, before everything else")
        }
        ProtocolEvent::PhaseStarted { phase, number } => {
            let next = step.phases.get(protocol.number).map(PhaseSpec::phase);
            unless(*number == protocol.number + 1 && next == Some(*phase), "another phase of the study comes next")?;
            session.phase_lacks().map_or(Ok(()), Err)
        }
        ProtocolEvent::Ticked { step, done } => {
            let is_done = step.checked_sub(1).and_then(|index| protocol.ticks.get(index));
            unless(
                is_done.is_some_and(|is_done| is_done != done),
                "the phase has no step with this number to be ticked",
            )
        }
        ProtocolEvent::Tutorial(event) => tutorial::admit(session, event),
        ProtocolEvent::ItemShown { item } => open_item(session, item).map(drop),
        ProtocolEvent::AnswersShown => unless(is_open(session), "no questionnaire is being answered"),
        ProtocolEvent::ItemAnswered { item, answer } => {
            let questionnaire = shown_item(session, item)?;
            questionnaire
                .form(protocol.item)
                .ok_or("the questionnaire's item lacks a setting that its kind needs")?
                .admit(answer)
        }
        ProtocolEvent::ItemSkipped { item } => shown_item(session, item).map(drop),
        ProtocolEvent::AnswersConfirmed => {
            unless(is_open(session), "no questionnaire is being answered")?;
            unless(
                protocol.answers.iter().all(Option::is_some),
                "not every item of the questionnaire is answered or skipped",
            )
        }
        ProtocolEvent::CriterionChecked { .. } => {
            let is_practice = matches!(session.study_phase(), Some(PhaseSpec::Familiarisation));
            let is_over = matches!(session.phase, TrialPhase::Over(_));
            unless(
                is_practice && is_over && protocol.practice.is_none(),
                "no practice has been completed that could be judged",
            )
        }
        ProtocolEvent::CriterionWaived { reason } => {
            let failed = protocol.practice.as_ref().is_some_and(|practice| !practice.met && practice.waived.is_none());
            unless(failed, "no practice criterion is unmet that could be waived")?;
            unless(!reason.is_empty(), "waiving the criterion needs a reason")
        }
    }
}

/// In a plan, only in the phase of the trial.
pub(crate) fn admit_trial(session: &Session) -> Result<(), &'static str> {
    let has_trial = session.study_phase().is_some_and(|phase| phase.phase().has_trial());
    unless(session.protocol.is_none() || has_trial, "this phase of the study has no trial")
}

fn is_open(session: &Session) -> bool {
    session.questionnaire().is_some() && session.protocol.as_ref().is_some_and(|protocol| !protocol.confirmed)
}

fn open_item<'a>(session: &'a Session, item: &str) -> Result<&'a Questionnaire, &'static str> {
    let questionnaire = session.questionnaire().filter(|_| is_open(session));
    let questionnaire = questionnaire.ok_or("no questionnaire is being answered")?;
    questionnaire.position(item).map(|_| questionnaire).ok_or("the questionnaire has no such item")
}

fn shown_item<'a>(session: &'a Session, item: &str) -> Result<&'a Questionnaire, &'static str> {
    let questionnaire = open_item(session, item)?;
    let shown = session.protocol.as_ref().and_then(|protocol| questionnaire.items.get(protocol.item));
    unless(shown.is_some_and(|shown| shown.id == item), "another item of the questionnaire is shown")?;
    Ok(questionnaire)
}

pub(crate) fn apply(session: &mut Session, event: &ProtocolEvent, now: SessionTime) {
    if let ProtocolEvent::Tutorial(event) = event {
        return tutorial::apply(session, event, now);
    }
    let next = match event {
        ProtocolEvent::ItemShown { item } => session.questionnaire().and_then(|asked| asked.position(item)),
        _ => None,
    };
    let shown = session.protocol.as_ref().and_then(|protocol| session.questionnaire()?.form(protocol.item));
    let stays = shown.is_some_and(|form| form.stays());
    let Some(protocol) = &mut session.protocol else { return };
    match event {
        ProtocolEvent::Tutorial(_) => {}
        ProtocolEvent::ConsentGiven { .. } => protocol.consent = true,
        ProtocolEvent::PhaseStarted { number, .. } => {
            let phase = session.spec.step.as_ref().and_then(|step| step.phases.get(number.checked_sub(1)?));
            let items = match phase {
                Some(PhaseSpec::Questionnaire { questionnaire }) => questionnaire.items.len(),
                _ => 0,
            };
            protocol.number = *number;
            protocol.ticks = vec![false; phase.map_or(0, |phase| phase.steps().len())];
            protocol.answers = vec![None; items];
            protocol.item = 0;
            protocol.confirmed = false;
            tutorial::begin(session, now);
        }
        ProtocolEvent::Ticked { step, done } => {
            if let Some(tick) = step.checked_sub(1).and_then(|index| protocol.ticks.get_mut(index)) {
                *tick = *done;
            }
        }
        ProtocolEvent::ItemShown { .. } => protocol.item = next.unwrap_or(0),
        ProtocolEvent::AnswersShown => protocol.item = protocol.answers.len(),
        ProtocolEvent::ItemAnswered { answer, .. } => protocol.answer(ItemAnswer::Given(answer.clone()), stays),
        ProtocolEvent::ItemSkipped { .. } => protocol.answer(ItemAnswer::Skipped, false),
        ProtocolEvent::AnswersConfirmed => protocol.confirmed = true,
        ProtocolEvent::CriterionChecked { met, orders, presses, errors } => {
            let (met, orders, presses, errors) = (*met, *orders, *presses, *errors);
            protocol.practice = Some(PracticeResult { met, orders, presses, errors, waived: None });
        }
        ProtocolEvent::CriterionWaived { reason } => {
            if let Some(practice) = &mut protocol.practice {
                practice.waived = Some(reason.clone());
            }
        }
    }
}
