//! The page of a tutorial's step: what the participant may see of it.

use serde::Serialize;

use super::display_place::{DisplayPlace, spot};
use crate::kitchen::{Agent, DishId, Kitchen};
use crate::session::Session;
use crate::session::plan::{TutorialStep, TutorialStepKind, TutorialTarget};
use crate::session::tutorial::TutorialState;

/// A step of the tutorial.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct DisplayedTutorial {
    /// The step's id.
    pub step: String,
    /// What it is for.
    pub kind: TutorialStepKind,
    /// The heading.
    pub title: String,
    /// The text.
    pub text: String,
    /// Counted from 1.
    pub number: usize,
    /// Number of steps.
    pub of: usize,
    /// The step is done: the participant can go on.
    pub done: bool,
    /// What is framed.
    pub frames: Vec<TutorialFrame>,
    /// The button that is to be pressed now.
    pub hint: Option<TutorialHint>,
    /// Presses that are done, and presses of the step, if it has any.
    pub presses: Option<[usize; 2]>,
    /// The last press was not the one that is asked for.
    pub missed: bool,
    /// Recipe cards, as long as they are shown.
    pub cards: Vec<RecipeCard>,
    /// Time for which the cards are shown, in seconds; none: until the participant goes on.
    pub seconds: Option<f64>,
    /// The question of the step, if it has one.
    pub question: Option<DisplayedQuestion>,
}

/// What is framed.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum TutorialFrame {
    /// The area of an agent.
    Area(Agent),
    /// A location or storage.
    Place(DisplayPlace),
    /// A button of the human, by its name.
    Button(String),
}

/// The button that is to be pressed.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct TutorialHint {
    /// The button's name.
    pub button: String,
    /// It is marked after this time without the right press, in seconds.
    pub after_s: f64,
}

/// The recipe card of a dish.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct RecipeCard {
    /// The dish.
    pub dish: String,
    /// What it is made of.
    pub items: Vec<String>,
}

/// A question of the check of understanding.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct DisplayedQuestion {
    /// What can be chosen.
    pub choices: Vec<String>,
    /// The wrong choice that was made, counted from 1, until another is made.
    pub wrong: Option<u8>,
    /// Explanation after a wrong choice.
    pub explanation: Option<String>,
    /// The right choice, once it was made.
    pub right: Option<u8>,
}

/// The card of a dish.
pub(super) fn card(kitchen: &Kitchen, dish: DishId) -> RecipeCard {
    let dish = kitchen.dish(dish);
    let items = kitchen.content(dish.stack()).items.iter();
    let items = items.map(|item| kitchen.content(*item).name.clone()).collect();
    RecipeCard { dish: dish.name.clone(), items }
}

/// The page of the shown step; nothing without a tutorial, or after its end.
pub(super) fn tutorial(session: &Session) -> Option<DisplayedTutorial> {
    let kitchen = &session.kitchen;
    let (tutorial, _) = session.tutorial()?;
    let (step, state) = session.tutorial_step()?;
    let frames = step.point_at.iter().filter_map(|name| TutorialTarget::named(kitchen, name));
    let are_shown = step.kind == TutorialStepKind::Recipes && !state.are_cards_hidden;
    let dishes = (0..kitchen.dishes.len()).filter(|_| are_shown);
    let hint = state.wanted(step).map(|button| {
        // After a press that is not asked for, the button is marked at once.
        let is_missed = state.last.is_some_and(|last| !last.is_right);
        let after_s = if is_missed { 0.0 } else { step.hint_after_s(state.presses) };
        TutorialHint { button: button.clone(), after_s }
    });
    Some(DisplayedTutorial {
        step: step.id.clone(),
        kind: step.kind,
        title: step.title.clone(),
        text: step.text.clone(),
        number: state.step + 1,
        of: tutorial.steps.len(),
        done: state.is_done(),
        frames: frames.map(|target| frame(kitchen, target)).collect(),
        hint,
        presses: step.has_presses().then_some([state.presses, step.presses.len()]),
        missed: state.last.is_some_and(|last| !last.is_right),
        cards: dishes.map(|index| card(kitchen, DishId(index as u8))).collect(),
        seconds: step.seconds.filter(|_| step.is_timed() && are_shown),
        question: (step.kind == TutorialStepKind::Question).then(|| question(step, state)),
    })
}

fn frame(kitchen: &Kitchen, target: TutorialTarget) -> TutorialFrame {
    match target {
        TutorialTarget::Area(agent) => TutorialFrame::Area(agent),
        TutorialTarget::Location(location) => TutorialFrame::Place(DisplayPlace::Location(location.index())),
        TutorialTarget::Button(button) => {
            let button = kitchen.button(Agent::Human, button);
            match spot(kitchen, Agent::Human, button.action) {
                place @ DisplayPlace::Storage(_) => TutorialFrame::Place(place),
                DisplayPlace::Location(_) => TutorialFrame::Button(button.name.clone()),
            }
        }
    }
}

fn question(step: &TutorialStep, state: &TutorialState) -> DisplayedQuestion {
    DisplayedQuestion {
        choices: step.choices.clone(),
        wrong: state.wrong,
        explanation: step.explanation.clone().filter(|_| state.wrong.is_some()),
        right: step.right.filter(|_| state.is_done()),
    }
}
