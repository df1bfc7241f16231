//! State of the participant's tutorial: its step, its kitchen, and the answers so far.

use super::plan::{Tutorial, TutorialStep, TutorialStepKind};
use tomcom_core::base::time::SessionTime;
use tomcom_core::kitchen::rules::NoEffectReason;
use tomcom_core::kitchen::{Agent, ButtonId, Kitchen, LocationId, State};

/// A press of the participant in a tutorial.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TutorialPress {
    /// Number of the press in the tutorial, from 1.
    pub number: u32,
    /// The button that the participant pressed.
    pub button: ButtonId,
    /// Whether the pressed button is the button that the tutorial step asks for.
    pub is_right: bool,
    /// Why the press has no effect by the rules of the kitchen, and the location that the reason is about; `None` if
    /// the press has an effect.
    pub no_effect: Option<(NoEffectReason, LocationId)>,
}

/// State of the participant's tutorial.
#[derive(Clone, Debug, PartialEq)]
pub struct TutorialState {
    /// Index of the shown tutorial step.
    pub step: usize,
    /// Session time since which the tutorial step is shown.
    pub shown_since: SessionTime,
    /// Total time for which each step of the tutorial was shown before it was last left.
    pub shown_before: Vec<SessionTime>,
    /// The state of the tutorial's own kitchen: the content of every location.
    pub kitchen: State,
    /// Number of the presses requested by the tutorial step that are done.
    pub presses: usize,
    /// The participant's last press in the shown tutorial step.
    pub last: Option<TutorialPress>,
    /// Number of presses in the tutorial so far.
    pub pressed: u32,
    /// Whether the recipe cards of the step were shown for their set time.
    pub are_cards_hidden: bool,
    /// The participant's wrong choice in the step's question, counted from 1, until the participant chooses again.
    pub wrong: Option<u8>,
    /// Whether each step of the tutorial was done.
    pub done: Vec<bool>,
    /// Number of wrong answers to each step's question.
    pub wrong_answers: Vec<u32>,
    /// Whether the tutorial is over.
    pub is_over: bool,
}

impl TutorialState {
    /// A tutorial at its first step, which is shown from session time `now`.
    pub fn new(tutorial: &Tutorial, kitchen: &Kitchen, now: SessionTime) -> TutorialState {
        let steps = tutorial.steps.len();
        let mut state = TutorialState {
            step: 0,
            shown_since: now,
            shown_before: vec![SessionTime::ZERO; steps],
            kitchen: kitchen.empty_state(),
            presses: 0,
            last: None,
            pressed: 0,
            are_cards_hidden: false,
            wrong: None,
            done: vec![false; steps],
            wrong_answers: vec![0; steps],
            is_over: false,
        };
        state.show(tutorial, kitchen, 0, now);
        state
    }

    /// Shows a tutorial step from its beginning, at session time `now`.
    pub(super) fn show(&mut self, tutorial: &Tutorial, kitchen: &Kitchen, step: usize, now: SessionTime) {
        if let Some(before) = self.shown_before.get_mut(self.step) {
            *before = *before + (now - self.shown_since);
        }
        self.shown_since = now;
        self.step = step;
        self.kitchen = tutorial.state_at(kitchen, step);
        (self.presses, self.last, self.wrong) = (0, None, None);
        // Recipe cards that were shown for their time are not shown again when the participant goes back in the
        // tutorial: the recipes have to be remembered.
        self.are_cards_hidden = tutorial.steps.get(step).is_some_and(TutorialStep::is_timed) && self.is_done();
        let needs_nothing = tutorial.steps.get(step).is_some_and(|step| match step.kind {
            TutorialStepKind::Text | TutorialStepKind::Signal => true,
            TutorialStepKind::Recipes => !step.is_timed(),
            TutorialStepKind::Press | TutorialStepKind::Order | TutorialStepKind::Question => false,
        });
        self.finish(needs_nothing);
    }

    /// Time for which the recipe cards of a step with a set time are still shown, in seconds, counted from when the
    /// step was last shown: the time continues where the participant left the step. `None` if no cards with a set time
    /// are shown.
    pub fn cards_left_s(&self, step: &TutorialStep) -> Option<f64> {
        let seconds = step.seconds.filter(|_| step.is_timed() && !self.are_cards_hidden)?;
        let before = self.shown_before.get(self.step).copied().unwrap_or_default();
        Some((seconds - before.as_secs_f64()).max(0.0))
    }

    /// Whether the participant's last press was not the press that the tutorial step still asks for.
    pub fn is_missed(&self, step: &TutorialStep) -> bool {
        self.wanted(step).is_some() && self.last.is_some_and(|last| !last.is_right)
    }

    /// Whether the participant may continue from the shown tutorial step.
    pub fn is_done(&self) -> bool {
        self.done.get(self.step) == Some(&true)
    }

    /// The button that the tutorial step asks for now.
    pub fn wanted<'a>(&self, step: &'a TutorialStep) -> Option<&'a String> {
        step.presses.get(self.presses)
    }

    /// Applies a press of the participant in the tutorial. Only the button that the step asks for changes the
    /// tutorial's kitchen, so that hints remain correct.
    pub(super) fn press(&mut self, step: &TutorialStep, kitchen: &Kitchen, button: ButtonId) {
        self.pressed += 1;
        let is_right =
            self.wanted(step).is_some_and(|wanted| kitchen.button_named(Agent::Human, wanted) == Some(button));
        let no_effect = kitchen.no_effect(self.kitchen, Agent::Human, button);
        self.last = Some(TutorialPress { number: self.pressed, button, is_right, no_effect });
        if is_right {
            self.kitchen = kitchen.try_press(self.kitchen, Agent::Human, button).after;
            self.presses += 1;
            self.finish(self.presses == step.presses.len());
        }
    }

    /// Applies the participant's answer to the tutorial step's question.
    pub(super) fn answer(&mut self, step: &TutorialStep, choice: u8) {
        let is_right = step.right == Some(choice);
        self.wrong = (!is_right).then_some(choice);
        if let Some(count) = self.wrong_answers.get_mut(self.step) {
            *count += u32::from(!is_right);
        }
        self.finish(is_right);
    }

    /// Hides the recipe cards of the tutorial step, because the cards were shown for their set time.
    pub(super) fn hide_cards(&mut self) {
        self.are_cards_hidden = true;
        self.finish(true);
    }

    fn finish(&mut self, is_done: bool) {
        if let Some(done) = self.done.get_mut(self.step) {
            *done |= is_done;
        }
    }
}
