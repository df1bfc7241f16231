//! Tutorials: what the participant is shown on the display before the first practice, a page a step, at the participant's own
//! pace.

use serde::{Deserialize, Serialize};

use crate::kitchen::{Agent, ButtonId, DishId, Kitchen, LocationId, OrderContent, State};
use crate::session::setting_checks::{SettingError, is_code};

/// Longest time for which recipe cards may be shown, in seconds.
const LONGEST_S: f64 = 3600.0;
/// Largest number of choices of a question: each has a digit.
const MOST_CHOICES: usize = 9;

/// A tutorial file.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Tutorial {
    /// Stands for the tutorial in the log.
    pub name: String,
    /// The language of its texts, as in "en".
    pub language: String,
    /// The steps in order; each is a page.
    #[serde(rename = "step")]
    pub steps: Vec<TutorialStep>,
}

/// What a step is for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum TutorialStepKind {
    /// A text, and places to which it points.
    Text,
    /// Buttons that the participant presses one after another; each is marked.
    Press,
    /// The recipe cards of all dishes.
    Recipes,
    /// A signal as it looks in a trial.
    Signal,
    /// A guided order: as `press`, with a dish that is wanted and hints that fade.
    Order,
    /// A question with one right choice.
    Question,
}

/// A step of a tutorial.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct TutorialStep {
    /// Identifier of the step in the log.
    pub id: String,
    /// What the step is for.
    pub kind: TutorialStepKind,
    /// Heading of the page.
    pub title: String,
    /// Text of the page; of a question, the question.
    pub text: String,
    /// Locations, human's buttons, or "human" and "robot" for their areas, which are framed.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub point_at: Vec<String>,
    /// Of `press` and `order`: the human's buttons, in the order in which they are to be pressed.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub presses: Vec<String>,
    /// Of `order`, and of the signal that shows a recipe: the wanted dish.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub dish: Option<String>,
    /// Of `signal`: the location that is highlighted; without it, the signal shows the recipe of `dish`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub highlight: Option<String>,
    /// Of `order`: number of presses whose button is marked at once; the others are marked after `hint_after_s`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub hints: Option<usize>,
    /// Of `order`: time without the right press after which the button is marked, in seconds.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub hint_after_s: Option<f64>,
    /// Of `recipes`: time for which the cards are shown, in seconds; 0, until the participant goes on.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub seconds: Option<f64>,
    /// Of `question`: what can be chosen.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub choices: Vec<String>,
    /// Of `question`: the right choice, counted from 1.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub right: Option<u8>,
    /// Of `question`: what is shown after a wrong choice, before it is asked again.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub explanation: Option<String>,
}

impl TutorialStep {
    /// Whether the participant presses buttons in it.
    pub fn has_presses(&self) -> bool {
        matches!(self.kind, TutorialStepKind::Press | TutorialStepKind::Order)
    }

    /// Whether its recipe cards vanish after a set time.
    pub fn is_timed(&self) -> bool {
        self.kind == TutorialStepKind::Recipes && self.seconds.is_some_and(|seconds| seconds > 0.0)
    }

    /// Time without the right press after which the button of this press, counted from 0, is marked; in seconds.
    pub fn hint_after_s(&self, press: usize) -> f64 {
        match self.kind {
            TutorialStepKind::Order if press >= self.hints.unwrap_or(3) => self.hint_after_s.unwrap_or(8.0),
            _ => 0.0,
        }
    }
}

impl Tutorial {
    /// Index of a step.
    pub fn position(&self, id: &str) -> Option<usize> {
        self.steps.iter().position(|step| step.id == id)
    }

    /// The kitchen at the beginning of a step: that of all presses before it.
    pub fn state_at(&self, kitchen: &Kitchen, step: usize) -> State {
        let mut state = kitchen.empty_state();
        for (nth, one) in self.steps.iter().enumerate().take(step + 1) {
            for &order in &kitchen.orders {
                state.set_order(order, OrderContent::None);
            }
            if let (Some(&order), Some(dish)) = (kitchen.orders.first(), dish_of(kitchen, one)) {
                state.set_order(order, OrderContent::Dish(dish));
            }
            let presses = one.presses.iter().filter(|_| nth < step);
            for button in presses.filter_map(|name| kitchen.button_named(Agent::Human, name)) {
                state = kitchen.try_press(state, Agent::Human, button).after;
            }
        }
        state
    }

    /// Checks what can be checked without a kitchen.
    ///
    /// # Errors
    /// The first invalid setting.
    pub fn check(&self) -> Result<(), SettingError> {
        if !is_code(&self.name) {
            let remedy = "a short name of letters, digits, - and _, such as \"sushi\"";
            return Err(SettingError::new("name", format!("name = \"{}\"", self.name), remedy));
        }
        if self.steps.is_empty() {
            let found = "a tutorial without steps".to_string();
            return Err(SettingError::new("step", found, "at least one [[step]]"));
        }
        for (nth, step) in self.steps.iter().enumerate() {
            let twice = self.steps[..nth].iter().any(|other| other.id == step.id);
            let wrong_id = |found, remedy| Err(SettingError { nth, ..SettingError::new("step.id", found, remedy) });
            if twice {
                return wrong_id(format!("the id \"{}\" twice", step.id), "each id once");
            }
            if !is_code(&step.id) {
                let remedy = "a short id of letters, digits, - and _, such as \"cook_rice\"";
                return wrong_id(format!("id = \"{}\"", step.id), remedy);
            }
            check_step(step).map_err(|error| placed(error, nth, step))?;
        }
        Ok(())
    }

    /// Checks the names of locations, buttons and dishes, and that every press has an effect when its turn comes.
    ///
    /// # Errors
    /// The first one that does not fit the kitchen.
    pub fn check_kitchen(&self, kitchen: &Kitchen) -> Result<(), SettingError> {
        for (nth, step) in self.steps.iter().enumerate() {
            check_names(kitchen, step).map_err(|error| placed(error, nth, step))?;
            let mut state = self.state_at(kitchen, nth);
            for name in &step.presses {
                let press = kitchen.button_named(Agent::Human, name).map(|button| pressed(kitchen, state, button));
                let Some(Some(after)) = press else {
                    let found =
                        format!("step \"{}\": \"{name}\", which does nothing after the presses before it", step.id);
                    let remedy =
                        "a button that has an effect when its turn comes; the kitchen is empty before the first step";
                    return Err(SettingError { nth, ..SettingError::new("step.id", found, remedy) });
                };
                state = after;
            }
            let is_open = kitchen.orders.first().is_some_and(|&order| state.order(order) != OrderContent::Served);
            if step.kind == TutorialStepKind::Order && is_open {
                let found = format!("step \"{}\": presses that do not serve its dish at the first order", step.id);
                let remedy = "all presses up to the one that serves the dish";
                return Err(SettingError { nth, ..SettingError::new("step.id", found, remedy) });
            }
        }
        Ok(())
    }
}

/// The kitchen after an effective press.
fn pressed(kitchen: &Kitchen, state: State, button: ButtonId) -> Option<State> {
    let press = kitchen.try_press(state, Agent::Human, button);
    press.effective.then_some(press.after)
}

/// The dish that a step's first order wants.
fn dish_of(kitchen: &Kitchen, step: &TutorialStep) -> Option<DishId> {
    kitchen.dish_named(step.dish.as_ref()?)
}

/// An error of a step is shown at its id, which every step has once.
fn placed(error: SettingError, nth: usize, step: &TutorialStep) -> SettingError {
    let found = format!("step \"{}\": {}", step.id, error.found);
    SettingError { nth, found, path: "step.id".to_string(), ..error }
}

fn check_step(step: &TutorialStep) -> Result<(), SettingError> {
    use TutorialStepKind::{Order, Press, Question, Recipes, Signal};
    let wrong = |key: &str, found: String, remedy: &'static str| Err(SettingError::new(key, found, remedy));
    let kind = step.kind;
    let given = [
        ("presses", !step.presses.is_empty(), matches!(kind, Press | Order), matches!(kind, Press | Order)),
        (
            "dish",
            step.dish.is_some(),
            matches!(kind, Order | Signal),
            kind == Order || (kind == Signal && step.highlight.is_none()),
        ),
        ("highlight", step.highlight.is_some(), kind == Signal && step.dish.is_none(), false),
        ("hints", step.hints.is_some(), kind == Order, false),
        ("hint_after_s", step.hint_after_s.is_some(), kind == Order, false),
        ("seconds", step.seconds.is_some(), kind == Recipes, kind == Recipes),
        ("choices", !step.choices.is_empty(), kind == Question, kind == Question),
        ("right", step.right.is_some(), kind == Question, kind == Question),
        ("explanation", step.explanation.is_some(), kind == Question, kind == Question),
    ];
    for (key, is_there, may, must) in given {
        if is_there && !may {
            return wrong(
                key,
                format!("`{key}`, which has no meaning in it"),
                "only the settings of the step's kind: docs/display.md",
            );
        }
        if must && !is_there {
            return wrong(key, format!("no `{key}`"), "all settings of the step's kind: docs/display.md");
        }
    }
    let is_time = |seconds: &f64| (0.0..=LONGEST_S).contains(seconds);
    for (key, value) in [("seconds", step.seconds), ("hint_after_s", step.hint_after_s)] {
        if let Some(value) = value.filter(|value| !is_time(value)) {
            return wrong(key, format!("{key} = {value}"), "0 to 3600 seconds");
        }
    }
    let choices = step.choices.len();
    if kind == Question && !(2..=MOST_CHOICES).contains(&choices) {
        return wrong("choices", format!("{choices} choices"), "two to nine");
    }
    match step.right.filter(|&right| right == 0 || usize::from(right) > choices) {
        Some(right) if kind == Question => {
            wrong("right", format!("right = {right}"), "the number of a choice, 1 the first")
        }
        _ => Ok(()),
    }
}

fn check_names(kitchen: &Kitchen, step: &TutorialStep) -> Result<(), SettingError> {
    let wrong = |key: &str, found: String, remedy: &'static str| Err(SettingError::new(key, found, remedy));
    let is_button = |name: &String| kitchen.button_named(Agent::Human, name).is_some();
    let is_shown = |name: &String| TutorialTarget::named(kitchen, name).is_some();
    if let Some(name) = step.point_at.iter().find(|name| !is_shown(name)) {
        let remedy =
            "a location or a button of the human, as tomcom kitchen LAYOUT lists them, or \"human\", \"robot\"";
        return wrong("point_at", format!("point_at \"{name}\""), remedy);
    }
    if let Some(name) = step.presses.iter().find(|name| !is_button(name)) {
        return wrong(
            "presses",
            format!("the button \"{name}\""),
            "a button of the human, as tomcom kitchen LAYOUT lists them",
        );
    }
    if let Some(name) = step.dish.as_ref().filter(|name| kitchen.dish_named(name).is_none()) {
        return wrong("dish", format!("the dish \"{name}\""), "a dish of the kitchen's menu");
    }
    match step.highlight.as_ref().filter(|name| kitchen.location_named(name).is_none()) {
        Some(name) => wrong("highlight", format!("highlight \"{name}\""), "a location of the layout"),
        None => Ok(()),
    }
}

/// What a step points at.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TutorialTarget {
    /// The area of an agent.
    Area(Agent),
    /// A location.
    Location(LocationId),
    /// A button of the human.
    Button(ButtonId),
}

impl TutorialTarget {
    /// The target with this name in a tutorial file.
    pub fn named(kitchen: &Kitchen, name: &str) -> Option<TutorialTarget> {
        match name {
            "human" => Some(TutorialTarget::Area(Agent::Human)),
            "robot" => Some(TutorialTarget::Area(Agent::Robot)),
            _ => {
                let location = kitchen.location_named(name).map(TutorialTarget::Location);
                location.or_else(|| kitchen.button_named(Agent::Human, name).map(TutorialTarget::Button))
            }
        }
    }
}
