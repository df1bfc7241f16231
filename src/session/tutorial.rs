//! The participant's tutorial, a phase of a study plan: which tutorial events a session accepts, and what they change.

use super::plan::{PhaseSpec, Tutorial, TutorialStep, TutorialStepKind};
use super::session_state::Session;
pub use super::tutorial_event::{TutorialEvent, TutorialPageTurner};
pub use super::tutorial_state::{TutorialPress, TutorialState};
use tomcom_core::base::time::SessionTime;
use tomcom_core::kitchen::Agent;

impl Session {
    /// The tutorial of the present phase and the tutorial's state; `None` if the phase has no tutorial.
    pub fn tutorial(&self) -> Option<(&Tutorial, &TutorialState)> {
        let (_, protocol) = self.step()?;
        match self.study_phase()? {
            PhaseSpec::Tutorial { tutorial } => Some((tutorial, protocol.tutorial.as_ref()?)),
            _ => None,
        }
    }

    /// The shown step of the tutorial; `None` if the tutorial is over.
    pub fn tutorial_step(&self) -> Option<(&TutorialStep, &TutorialState)> {
        let (tutorial, state) = self.tutorial().filter(|(_, state)| !state.is_over)?;
        Some((tutorial.steps.get(state.step)?, state))
    }
}

/// Whether the session accepts this event of the tutorial now.
///
/// # Errors
/// Why the session refuses the event, in words for the wizard.
pub(super) fn admit(session: &Session, event: &TutorialEvent) -> Result<(), &'static str> {
    let (tutorial, _) = session.tutorial().ok_or("no tutorial is shown now")?;
    let (step, state) = session.tutorial_step().ok_or("the tutorial is over")?;
    let unless = |holds: bool, reason: &'static str| if holds { Ok(()) } else { Err(reason) };
    let may_leave = |by: TutorialPageTurner| by == TutorialPageTurner::Wizard || state.is_done();
    let is_shown = |id: &str| unless(step.id == id, "another step of the tutorial is shown");
    match event {
        TutorialEvent::Shown { step, by } => {
            let to = tutorial.position(step).ok_or("the tutorial has no such step")?;
            unless(
                to + 1 == state.step || to == state.step + 1,
                "only the next step of the tutorial or the one \
                                                                  before can be shown",
            )?;
            unless(to < state.step || may_leave(*by), "the participant has not done this step of the tutorial yet")
        }
        TutorialEvent::Pressed { button } => {
            unless(session.kitchen.button_named(Agent::Human, button).is_some(), "the kitchen has no such button")?;
            unless(step.has_presses(), "this step of the tutorial has no presses")
        }
        TutorialEvent::CardsHidden { step: id } => {
            is_shown(id)?;
            unless(
                step.is_timed() && !state.are_cards_hidden,
                "the tutorial shows no recipe cards that could be \
                                                                hidden",
            )
        }
        TutorialEvent::Answered { step: id, choice } => {
            is_shown(id)?;
            let is_choice = *choice > 0 && usize::from(*choice) <= step.choices.len();
            unless(step.kind == TutorialStepKind::Question && is_choice, "the tutorial's question has no such choice")?;
            unless(!state.is_done(), "this question of the tutorial is answered already")
        }
        TutorialEvent::Ended { by } => {
            let is_last = state.step + 1 == tutorial.steps.len();
            unless(*by == TutorialPageTurner::Wizard || (is_last && state.is_done()), "the tutorial is not at its end")
        }
    }
}

/// Begins the tutorial of the study phase that has just begun, at session time `now`, if the phase has a tutorial.
pub(super) fn begin(session: &mut Session, now: SessionTime) {
    let begun = match session.study_phase() {
        Some(PhaseSpec::Tutorial { tutorial }) => Some(TutorialState::new(tutorial, &session.kitchen, now)),
        _ => None,
    };
    if let Some(protocol) = &mut session.protocol {
        protocol.tutorial = begun;
    }
}

/// Applies an event of the tutorial that the session accepts, at the event's session time `now`.
pub(super) fn apply(session: &mut Session, event: &TutorialEvent, now: SessionTime) {
    let Some((tutorial, state)) = session.tutorial() else { return };
    let Some(step) = tutorial.steps.get(state.step) else { return };
    let (mut state, kitchen) = (state.clone(), &session.kitchen);
    match event {
        TutorialEvent::Shown { step, .. } => {
            if let Some(to) = tutorial.position(step) {
                state.show(tutorial, kitchen, to, now);
            }
        }
        TutorialEvent::Pressed { button } => {
            if let Some(button) = kitchen.button_named(Agent::Human, button) {
                state.press(step, kitchen, button);
            }
        }
        TutorialEvent::CardsHidden { .. } => state.hide_cards(),
        TutorialEvent::Answered { choice, .. } => state.answer(step, *choice),
        TutorialEvent::Ended { .. } => state.is_over = true,
    }
    if let Some(protocol) = &mut session.protocol {
        protocol.tutorial = Some(state);
    }
}
