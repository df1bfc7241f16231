//! Tutorials: pages for the participant on the display before the first practice, one page per step; the participant
//! turns the pages.

use serde::{Deserialize, Serialize};

use crate::setting_checks::{SettingError, is_code};
use tomcom_core::kitchen::{Agent, ButtonId, DishId, Kitchen, LocationId, OrderContent, State};

/// Longest time for which a tutorial may show the recipe cards, in seconds.
const LONGEST_S: f64 = 3600.0;
/// Largest number of choices of a tutorial question: each is chosen by a digit key.
const MOST_CHOICES: usize = 9;

/// A tutorial for participants, as its file has it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Tutorial {
    /// Identifier of the tutorial in the log.
    pub name: String,
    /// Language code of the tutorial's texts: "en".
    pub language: String,
    /// The steps of the tutorial in order; each is a page.
    #[serde(rename = "step")]
    pub steps: Vec<TutorialStep>,
}

/// The kind of a tutorial step.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum TutorialStepKind {
    /// Step with a text; places on the display that the text is about are framed.
    Text,
    /// Step in which the participant presses buttons one after another; each button is marked in turn.
    Press,
    /// Step with the recipe cards of all dishes, for the participant to learn.
    Recipes,
    /// Step with a signal on the display, shown as in a trial.
    Signal,
    /// Step with a guided order: as `press`, but with a dish to prepare and hints that fade.
    Order,
    /// Step with a question that has one right choice.
    Question,
}

/// A step of a tutorial: one page on the participant's display.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct TutorialStep {
    /// Identifier of the tutorial step in the log.
    pub id: String,
    /// The kind of the tutorial step.
    pub kind: TutorialStepKind,
    /// Heading of the tutorial page.
    pub title: String,
    /// Text of the tutorial page; for the kind `question`, the question.
    pub text: String,
    /// Names of what the tutorial page frames: locations, the human's buttons, or "human" and "robot" for their areas.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub point_at: Vec<String>,
    /// For the kinds `press` and `order`: the human's buttons, in the order in which the participant has to press them.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub presses: Vec<String>,
    /// For the kind `order`, for a signal that shows a recipe, and for a text that explains orders: name of the ordered
    /// dish.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub dish: Option<String>,
    /// For the kind `signal`: the highlighted location; without a location, the signal shows the recipe of `dish`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub highlight: Option<String>,
    /// For the kind `order`: number of presses whose button is marked at once; the buttons of later presses are marked
    /// after `hint_after_s`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub hints: Option<usize>,
    /// For the kind `order`: time without the right press after which the button is marked, in seconds.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub hint_after_s: Option<f64>,
    /// For the kind `recipes`: time for which the recipe cards are shown, in seconds; 0: until the participant turns
    /// the page.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub seconds: Option<f64>,
    /// For the kind `question`: the texts of the choices.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub choices: Vec<String>,
    /// For the kind `question`: the number of the right choice, counted from 1.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub right: Option<u8>,
    /// For the kind `question`: text after a wrong choice, before the question is asked again.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub explanation: Option<String>,
}

impl TutorialStep {
    /// Whether the participant presses buttons in this step.
    pub fn has_presses(&self) -> bool {
        matches!(self.kind, TutorialStepKind::Press | TutorialStepKind::Order)
    }

    /// Whether this step's recipe cards disappear after a set time.
    pub fn is_timed(&self) -> bool {
        self.kind == TutorialStepKind::Recipes && self.seconds.is_some_and(|seconds| seconds > 0.0)
    }

    /// How long the step waits without the right press before it marks the button of the press with this index (from
    /// 0), in
    /// seconds.
    pub fn hint_after_s(&self, press: usize) -> f64 {
        match self.kind {
            TutorialStepKind::Order if press >= self.hints.unwrap_or(3) => self.hint_after_s.unwrap_or(8.0),
            _ => 0.0,
        }
    }
}

impl Tutorial {
    /// Whether this step is the first one in which the participant presses buttons.
    pub fn has_first_presses(&self, step: usize) -> bool {
        self.steps.iter().position(TutorialStep::has_presses) == Some(step)
    }

    /// Index of the tutorial step with this identifier.
    pub fn position(&self, id: &str) -> Option<usize> {
        self.steps.iter().position(|step| step.id == id)
    }

    /// The state of the tutorial's kitchen at the beginning of a step: after all presses of the steps before.
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

    /// Checks the tutorial's settings as far as possible without a kitchen.
    ///
    /// # Errors
    /// An error names the first invalid setting.
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

    /// Checks the names of locations, buttons and dishes in the tutorial, and that every press of the tutorial has an
    /// effect when its turn comes.
    ///
    /// # Errors
    /// The first name or press that does not fit the kitchen.
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

/// The state of the kitchen after the human's press; `None` if the press has no effect.
fn pressed(kitchen: &Kitchen, state: State, button: ButtonId) -> Option<State> {
    let press = kitchen.try_press(state, Agent::Human, button);
    press.effective.then_some(press.after)
}

/// The dish that a tutorial step's first order wants.
fn dish_of(kitchen: &Kitchen, step: &TutorialStep) -> Option<DishId> {
    kitchen.dish_named(step.dish.as_ref()?)
}

/// Places the error of a tutorial step at the step's id in the file, which every step has exactly once.
fn placed(error: SettingError, nth: usize, step: &TutorialStep) -> SettingError {
    let found = format!("step \"{}\": {}", step.id, error.found);
    SettingError { nth, found, path: "step.id".to_string(), ..error }
}

fn check_step(step: &TutorialStep) -> Result<(), SettingError> {
    use TutorialStepKind::{Order, Press, Question, Recipes, Signal, Text};
    let wrong = |key: &str, found: String, remedy: &'static str| Err(SettingError::new(key, found, remedy));
    let kind = step.kind;
    let given = [
        ("presses", !step.presses.is_empty(), matches!(kind, Press | Order), matches!(kind, Press | Order)),
        (
            "dish",
            step.dish.is_some(),
            matches!(kind, Order | Signal | Text),
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

/// An element of the display that a tutorial step can frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TutorialTarget {
    /// The area of human or robot on the display.
    Area(Agent),
    /// A location on the display.
    Location(LocationId),
    /// A button of the human on the display.
    Button(ButtonId),
}

impl TutorialTarget {
    /// The element of the display that has this name in a tutorial file.
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
