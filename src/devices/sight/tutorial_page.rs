//! Page on the participant's display for a step of the tutorial.

use serde::Serialize;

use super::content::{ShownContent, button_place, shown};
use super::displayed_item::{SceneElement, spot};
use super::probe_page::{DisplayedProbe, practice};
use tomcom_core::kitchen::{Agent, DishId, Kitchen, LocationId, State};
use tomcom_session::Session;
use tomcom_session::plan::{TutorialStep, TutorialStepKind, TutorialTarget};
use tomcom_session::tutorial::TutorialState;

/// A step of the tutorial, as the participant's display shows it.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct DisplayedTutorial {
    pub step: String,
    pub kind: TutorialStepKind,
    /// Heading of the step's page.
    pub title: String,
    /// Text of the step's page.
    pub text: String,
    /// Number of the tutorial's step, from 1.
    pub number: usize,
    pub of: usize,
    /// Whether the step of the tutorial is completed, so that the participant can go on.
    pub done: bool,
    pub frames: Vec<TutorialFrameTarget>,
    /// The button that the participant has to press now.
    pub hint: Option<RequestedTutorialButton>,
    /// Number of presses made and number of presses required, if the step has presses.
    pub presses: Option<[usize; 2]>,
    /// Whether the tutorial's page says how buttons are pressed: in the first step that requires presses.
    pub explains_buttons: bool,
    /// Whether the participant's last press was another than the required press, which is false once no press is
    /// required; or whether the last answer to the practised probe was wrong.
    pub missed: bool,
    /// Recipe cards, while they are shown.
    pub cards: Vec<RecipeCard>,
    /// Time for which the recipe cards are shown, in seconds; `None` until the participant goes on.
    pub seconds: Option<f64>,
    /// Time for which the recipe cards were still to be shown when the step was last shown, in seconds; less than
    /// `seconds` when the participant comes back to them.
    pub left_s: Option<f64>,
    /// Comprehension question of the step, if it has one.
    pub question: Option<DisplayedTutorialQuestion>,
    /// Question of a freeze probe, until it is answered rightly.
    pub probe: Option<DisplayedProbe>,
    /// What the robot does, again and again; empty where it rests.
    pub robot: Vec<ShownRobotPress>,
}

/// A press of the robot that the tutorial shows.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ShownRobotPress {
    /// Where the hand goes, in fractions of the display.
    pub to: [f64; 2],
    /// What each location shows after the press.
    pub contents: Vec<ShownContent>,
}

/// Something that the tutorial marks with a frame.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum TutorialFrameTarget {
    Area(Agent),
    /// A location or storage of the kitchen.
    Place(SceneElement),
    Button(String),
}

/// The button that the tutorial asks the participant to press.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct RequestedTutorialButton {
    pub button: String,
    /// Time without the right press after which the page marks the button, in seconds.
    pub after_s: f64,
}

/// The recipe card of a dish in the tutorial.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct RecipeCard {
    pub dish: String,
    /// Ingredients of the dish.
    pub items: Vec<String>,
}

/// A question of the tutorial's check of understanding.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct DisplayedTutorialQuestion {
    /// Answers from which the participant chooses.
    pub choices: Vec<String>,
    /// Number, from 1, of the wrong answer that the participant gave last; `None` once the participant has given
    /// another answer.
    pub wrong: Option<u8>,
    /// Explanation that the page shows after a wrong answer.
    pub explanation: Option<String>,
    /// Number of characters of the explanation, for which the page keeps room before it knows the explanation.
    pub explanation_length: usize,
    pub right: Option<u8>,
}

pub(super) fn card(kitchen: &Kitchen, dish: DishId) -> RecipeCard {
    let dish = kitchen.dish(dish);
    let items = kitchen.content(dish.stack()).items.iter();
    let items = items.map(|item| kitchen.content(*item).name.clone()).collect();
    RecipeCard { dish: dish.name.clone(), items }
}

/// The page of the tutorial's present step; `None` without a tutorial, or after the tutorial's end.
pub(super) fn tutorial(session: &Session) -> Option<DisplayedTutorial> {
    let kitchen = &session.kitchen;
    let (tutorial, _) = session.tutorial()?;
    let (step, state) = session.tutorial_step()?;
    let frames = step.point_at.iter().filter_map(|name| TutorialTarget::named(kitchen, name));
    let are_shown = step.kind == TutorialStepKind::Recipes && !state.are_cards_hidden;
    let dishes = (0..kitchen.dishes.len()).filter(|_| are_shown);
    let hint = state.wanted().map(|button| {
        // After a wrong press, the page marks the required button at once.
        let after_s = if state.is_missed() { 0.0 } else { step.hint_after_s(state.presses) };
        RequestedTutorialButton { button: button.clone(), after_s }
    });
    Some(DisplayedTutorial {
        step: step.id.clone(),
        kind: step.kind,
        title: step.title.clone(),
        text: step.text.clone(),
        number: state.step + 1,
        of: tutorial.steps.len(),
        done: state.is_done(),
        frames: frames.map(|target| frame(kitchen, target)).chain(robot_spots(kitchen, step)).collect(),
        hint,
        presses: step.has_presses().then_some([state.presses, step.presses.len()]),
        explains_buttons: tutorial.has_first_presses(state.step),
        missed: state.is_missed() || (step.kind == TutorialStepKind::Probe && state.wrong.is_some()),
        cards: dishes.map(|index| card(kitchen, DishId(index as u8))).collect(),
        seconds: step.seconds.filter(|_| step.is_timed() && are_shown),
        left_s: state.cards_left_s(step),
        question: (step.kind == TutorialStepKind::Question).then(|| question(step, state)),
        probe: step.about.as_ref().filter(|_| !state.is_done()).and_then(|_| practice(session)),
        robot: if step.kind == TutorialStepKind::Robot { robot_presses(session, step, state) } else { Vec::new() },
    })
}

fn robot_presses(session: &Session, step: &TutorialStep, state: &TutorialState) -> Vec<ShownRobotPress> {
    let kitchen = &session.kitchen;
    let buttons = step.presses.iter().filter_map(|name| kitchen.button_named(Agent::Robot, name));
    let show = |now: &mut State, button| {
        *now = kitchen.try_press(*now, Agent::Robot, button).after;
        let contents = (0..kitchen.locations.len()).map(|index| shown(kitchen, *now, LocationId(index as u8)));
        Some(ShownRobotPress { to: button_place(session, button), contents: contents.collect() })
    };
    buttons.scan(state.kitchen, show).collect()
}

/// Where the robot presses in a step that shows what it does: the places are framed as well.
fn robot_spots(kitchen: &Kitchen, step: &TutorialStep) -> impl Iterator<Item = TutorialFrameTarget> {
    let presses = step.presses.iter().filter(move |_| step.kind == TutorialStepKind::Robot);
    let buttons = presses.filter_map(move |name| kitchen.button_named(Agent::Robot, name));
    buttons
        .map(move |button| spot(kitchen, Agent::Robot, kitchen.button(Agent::Robot, button).action))
        .map(TutorialFrameTarget::Place)
}

fn frame(kitchen: &Kitchen, target: TutorialTarget) -> TutorialFrameTarget {
    match target {
        TutorialTarget::Area(agent) => TutorialFrameTarget::Area(agent),
        TutorialTarget::Location(location) => TutorialFrameTarget::Place(SceneElement::Location(location.index())),
        TutorialTarget::Button(button) => {
            let button = kitchen.button(Agent::Human, button);
            match spot(kitchen, Agent::Human, button.action) {
                place @ SceneElement::Storage(_) => TutorialFrameTarget::Place(place),
                SceneElement::Location(_) => TutorialFrameTarget::Button(button.name.clone()),
            }
        }
    }
}

fn question(step: &TutorialStep, state: &TutorialState) -> DisplayedTutorialQuestion {
    DisplayedTutorialQuestion {
        choices: step.choices.clone(),
        wrong: state.wrong,
        explanation: step.explanation.clone().filter(|_| state.wrong.is_some()),
        explanation_length: step.explanation.as_ref().map_or(0, |text| text.chars().count()),
        right: step.right.filter(|_| state.is_done()),
    }
}
