//! The participant's tutorial, a phase of a study plan: pages on the display before the first practice, which the
//! participant turns.

use std::collections::BTreeSet;

use serde::{Deserialize, Serialize};

use crate::admit::unless;
use crate::plan::PhaseSpec;
use crate::probes::ProbeQuestion;
use crate::settings::{SettingError, is_code};
use crate::{Session, probe_sampling};
use tomcom_core::base::time::SessionTime;
use tomcom_core::kitchen::rules::NoEffectReason;
use tomcom_core::kitchen::{Agent, AspectId, ButtonId, Kitchen, LocationId, OrderContent, State};

/// For recipe cards, in seconds.
const LONGEST_S: f64 = 3600.0;
/// Each is chosen by a digit key.
const MOST_CHOICES: usize = 9;

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Tutorial {
    /// In the log.
    pub name: String,
    /// Language code: "en".
    pub language: String,
    /// Each is a page.
    #[serde(rename = "step")]
    pub steps: Vec<TutorialStep>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum TutorialStepKind {
    /// What the text is about is framed.
    Text,
    /// The participant presses buttons one after another; each is marked in turn.
    Press,
    /// The recipe cards of all dishes, to learn.
    Recipes,
    /// A signal, shown as in a trial.
    Signal,
    /// A guided order: as `press`, but with a dish to prepare and hints that fade.
    Order,
    /// It has one right choice.
    Question,
    /// The robot's hand moves as in a trial: it presses buttons one after another, again and again.
    Robot,
    /// The robot's area says one after the other what it can say in a trial.
    RobotSays,
    /// A question of a freeze probe, to practise; left out where the session has no probes.
    Probe,
}

/// One page on the participant's display.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct TutorialStep {
    /// In the log.
    pub id: String,
    pub kind: TutorialStepKind,
    pub title: String,
    /// With `question`, the question.
    pub text: String,
    /// What the page frames: locations, the human's buttons, or "human" and "robot" for their areas.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub point_at: Vec<String>,
    /// With `press` and `order`: the human's buttons, in the order in which they are marked, or in another one with the same
    /// result; with `robot`: the robot's.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub presses: Vec<String>,
    /// With `order`, with a signal that shows a recipe, with a text that explains orders, and with a probe, whose answers
    /// depend on what is ordered.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub dish: Option<String>,
    /// With `signal`: the highlighted location; without it, the signal shows the recipe of `dish`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub highlight: Option<String>,
    /// With `order`: number of presses whose button is marked at once; later ones are marked after `hint_after_s`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub hints: Option<usize>,
    /// With `order`: time without the right press after which its button is marked.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub hint_after_s: Option<f64>,
    /// With `recipes`: for how long the cards are shown; 0: until the participant turns the page.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub seconds: Option<f64>,
    /// With `question`, as the next two.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub choices: Vec<String>,
    /// Number of the right choice, from 1.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub right: Option<u8>,
    /// Shown after a wrong choice, before the question is asked again.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub explanation: Option<String>,
    /// With `probe`: the location that is asked about.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub about: Option<String>,
}

impl TutorialStep {
    pub fn has_presses(&self) -> bool {
        matches!(self.kind, TutorialStepKind::Press | TutorialStepKind::Order)
    }

    /// Whose buttons it presses.
    fn agent(&self) -> Agent {
        if self.kind == TutorialStepKind::Robot { Agent::Robot } else { Agent::Human }
    }

    /// Whether the recipe cards disappear after a set time.
    pub fn is_timed(&self) -> bool {
        self.kind == TutorialStepKind::Recipes && self.seconds.is_some_and(|seconds| seconds > 0.0)
    }

    /// How long the step waits without the right press before it marks the button of the press with this index.
    pub fn hint_after_s(&self, press: usize) -> f64 {
        match self.kind {
            TutorialStepKind::Order if press >= self.hints.unwrap_or(3) => self.hint_after_s.unwrap_or(8.0),
            _ => 0.0,
        }
    }
}

impl Tutorial {
    /// Whether this is the first step with presses.
    pub fn has_first_presses(&self, step: usize) -> bool {
        self.steps.iter().position(TutorialStep::has_presses) == Some(step)
    }

    pub fn position(&self, id: &str) -> Option<usize> {
        self.steps.iter().position(|step| step.id == id)
    }

    /// The kitchen at the beginning of a step: after all presses of the steps before.
    fn state_at(&self, kitchen: &Kitchen, step: usize) -> State {
        let mut state = kitchen.empty_state();
        for (nth, one) in self.steps.iter().enumerate().take(step + 1) {
            for &order in &kitchen.orders {
                state.set_order(order, OrderContent::None);
            }
            let dish = one.dish.as_ref().and_then(|dish| kitchen.dish_named(dish));
            if let (Some(&order), Some(dish)) = (kitchen.orders.first(), dish) {
                state.set_order(order, OrderContent::Dish(dish));
            }
            // What the robot shows is no work on the kitchen: it shows it again and again.
            let presses = one.presses.iter().filter(|_| nth < step && one.has_presses());
            for button in presses.filter_map(|name| kitchen.button_named(Agent::Human, name)) {
                state = kitchen.try_press(state, Agent::Human, button).after;
            }
        }
        state
    }

    /// As far as possible without a kitchen.
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

    /// Names of locations, buttons and dishes must be the kitchen's, and every press must have an effect when its turn
    /// comes.
    pub fn check_kitchen(&self, kitchen: &Kitchen) -> Result<(), SettingError> {
        for (nth, step) in self.steps.iter().enumerate() {
            check_names(kitchen, step).map_err(|error| placed(error, nth, step))?;
            let mut state = self.state_at(kitchen, nth);
            for name in &step.presses {
                let Some(after) = pressed(kitchen, state, step.agent(), name) else {
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

/// `None` if the press has no effect.
fn pressed(kitchen: &Kitchen, state: State, agent: Agent, button: &str) -> Option<State> {
    let press = kitchen.try_press(state, agent, kitchen.button_named(agent, button)?);
    press.effective.then_some(press.after)
}

/// An order of these buttons of the human in which each has an effect and the last one reaches the goal: the given one, if
/// it does. `tried`: kitchens with the buttons that are left, which are searched no more.
fn ordered(
    kitchen: &Kitchen,
    state: State,
    left: &[String],
    goal: State,
    tried: &mut BTreeSet<(State, Vec<String>)>,
) -> Option<Vec<String>> {
    if left.is_empty() {
        return (state == goal).then(Vec::new);
    }
    if !tried.insert((state, left.to_vec())) {
        return None;
    }
    (0..left.len()).filter(|&at| !left[..at].contains(&left[at])).find_map(|at| {
        let after = pressed(kitchen, state, Agent::Human, &left[at])?;
        let rest = ordered(kitchen, after, &without(left, at), goal, tried)?;
        Some(std::iter::once(left[at].clone()).chain(rest).collect())
    })
}

fn without(names: &[String], at: usize) -> Vec<String> {
    [&names[..at], &names[at + 1..]].concat()
}

/// At the step's id in the file, which every step has exactly once.
fn placed(error: SettingError, nth: usize, step: &TutorialStep) -> SettingError {
    let found = format!("step \"{}\": {}", step.id, error.found);
    SettingError { nth, found, path: "step.id".to_string(), ..error }
}

fn check_step(step: &TutorialStep) -> Result<(), SettingError> {
    use TutorialStepKind::{Order, Press, Probe, Question, Recipes, Robot, Signal, Text};
    let wrong = |key: &str, found: String, remedy: &'static str| Err(SettingError::new(key, found, remedy));
    let kind = step.kind;
    let may_have_dish = matches!(kind, Order | Probe | Signal | Text);
    let must_have_dish = kind == Order || (kind == Signal && step.highlight.is_none());
    let has_buttons = matches!(kind, Press | Order | Robot);
    let given = [
        ("presses", !step.presses.is_empty(), has_buttons, has_buttons),
        ("dish", step.dish.is_some(), may_have_dish, must_have_dish),
        ("highlight", step.highlight.is_some(), kind == Signal && step.dish.is_none(), false),
        ("hints", step.hints.is_some(), kind == Order, false),
        ("hint_after_s", step.hint_after_s.is_some(), kind == Order, false),
        ("seconds", step.seconds.is_some(), kind == Recipes, kind == Recipes),
        ("choices", !step.choices.is_empty(), kind == Question, kind == Question),
        ("right", step.right.is_some(), kind == Question, kind == Question),
        ("explanation", step.explanation.is_some(), kind == Question, kind == Question),
        ("about", step.about.is_some(), kind == Probe, kind == Probe),
    ];
    for (key, is_there, may, must) in given {
        if is_there && !may {
            let remedy = "only the settings of the step's kind: docs/display.md";
            return wrong(key, format!("`{key}`, which has no meaning in it"), remedy);
        }
        if must && !is_there {
            return wrong(key, format!("no `{key}`"), "all settings of the step's kind: docs/display.md");
        }
    }
    for (key, value) in [("seconds", step.seconds), ("hint_after_s", step.hint_after_s)] {
        if let Some(value) = value.filter(|value| !(0.0..=LONGEST_S).contains(value)) {
            return wrong(key, format!("{key} = {value}"), "0 to 3600 seconds");
        }
    }
    let choices = step.choices.len();
    if kind == Question && !(2..=MOST_CHOICES).contains(&choices) {
        return wrong("choices", format!("{choices} choices"), "two to nine");
    }
    match step.right.filter(|&right| right == 0 || usize::from(right) > choices) {
        Some(right) => wrong("right", format!("right = {right}"), "the number of a choice, 1 the first"),
        None => Ok(()),
    }
}

fn check_names(kitchen: &Kitchen, step: &TutorialStep) -> Result<(), SettingError> {
    let wrong = |key: &str, found: String, remedy: &'static str| Err(SettingError::new(key, found, remedy));
    let is_button = |name: &String| kitchen.button_named(step.agent(), name).is_some();
    let is_shown = |name: &String| TutorialTarget::named(kitchen, name).is_some();
    if let Some(name) = step.point_at.iter().find(|name| !is_shown(name)) {
        let remedy =
            "a location or a button of the human, as tomcom kitchen LAYOUT lists them, or \"human\", \"robot\"";
        return wrong("point_at", format!("point_at \"{name}\""), remedy);
    }
    if let Some(name) = step.presses.iter().find(|name| !is_button(name)) {
        let remedy =
            "a button of the human, or with kind = \"robot\" of the robot, as tomcom kitchen LAYOUT lists them";
        return wrong("presses", format!("the button \"{name}\""), remedy);
    }
    if let Some(name) = step.dish.as_ref().filter(|name| kitchen.dish_named(name).is_none()) {
        return wrong("dish", format!("the dish \"{name}\""), "a dish of the kitchen's menu");
    }
    for (key, name) in [("highlight", &step.highlight), ("about", &step.about)] {
        if let Some(name) = name.as_ref().filter(|name| kitchen.location_named(name).is_none()) {
            return wrong(key, format!("{key} \"{name}\""), "a location of the layout");
        }
    }
    Ok(())
}

/// What a step can frame on the display.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TutorialTarget {
    Area(Agent),
    Location(LocationId),
    /// Of the human.
    Button(ButtonId),
}

impl TutorialTarget {
    /// By its name in a tutorial file.
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

#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, strum::IntoStaticStr)]
#[serde(rename_all = "snake_case")]
#[strum(serialize_all = "snake_case")]
pub enum TutorialPageTurner {
    /// Only when the step is done.
    Participant,
    /// May skip a step.
    Wizard,
}

named!(TutorialPageTurner);

/// Presses act on a kitchen of the tutorial's own: they are no presses of a trial, and no evidence of beliefs.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "did", rename_all = "snake_case")]
pub enum TutorialEvent {
    /// A step before or after the present one.
    Shown { step: String, by: TutorialPageTurner },
    /// In the tutorial's own kitchen.
    Pressed { button: String },
    /// The set time of the recipe cards is over: they disappear.
    CardsHidden { step: String },
    /// A question or a practised probe.
    Answered {
        step: String,
        /// From 1; 0: "I don't know", of a practised probe.
        choice: u8,
    },
    /// The participant read the last step, or the wizard skipped the rest.
    Ended { by: TutorialPageTurner },
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TutorialPress {
    /// In the tutorial, from 1.
    pub number: u32,
    pub button: ButtonId,
    /// Whether the step asks for this button.
    pub is_right: bool,
    /// Why, by the rules of the kitchen, and the location that the reason is about.
    pub no_effect: Option<(NoEffectReason, LocationId)>,
}

#[derive(Clone, Debug, Default, PartialEq)]
pub struct TutorialState {
    /// Index of the shown step.
    pub step: usize,
    /// Since when it is shown.
    pub shown_since: SessionTime,
    /// For how long each step was shown before it was last left.
    pub shown_before: Vec<SessionTime>,
    /// The tutorial's own kitchen.
    pub kitchen: State,
    /// Number of the step's presses that are done.
    pub presses: usize,
    /// Buttons of the step that are still to be pressed, in the order in which they are asked for.
    pub left: Vec<String>,
    /// In the shown step.
    pub last: Option<TutorialPress>,
    /// Number of presses in the tutorial so far.
    pub pressed: u32,
    /// The cards of the step were shown for their set time.
    pub are_cards_hidden: bool,
    /// Wrong choice in the step's question, from 1, until the participant chooses again.
    pub wrong: Option<u8>,
    /// By step.
    pub done: Vec<bool>,
    /// By step.
    pub wrong_answers: Vec<u32>,
    pub is_over: bool,
}

impl TutorialState {
    /// At the first step, which is shown from `now`.
    pub fn new(tutorial: &Tutorial, kitchen: &Kitchen, now: SessionTime) -> TutorialState {
        let steps = tutorial.steps.len();
        let mut state = TutorialState {
            shown_since: now,
            shown_before: vec![SessionTime::ZERO; steps],
            done: vec![false; steps],
            wrong_answers: vec![0; steps],
            ..TutorialState::default()
        };
        state.show(tutorial, kitchen, 0, now);
        state
    }

    pub(crate) fn show(&mut self, tutorial: &Tutorial, kitchen: &Kitchen, step: usize, now: SessionTime) {
        if let Some(before) = self.shown_before.get_mut(self.step) {
            *before = *before + (now - self.shown_since);
        }
        self.shown_since = now;
        self.step = step;
        self.kitchen = tutorial.state_at(kitchen, step);
        (self.presses, self.last, self.wrong) = (0, None, None);
        // What the robot presses is asked of nobody.
        let asked = tutorial.steps.get(step).filter(|step| step.has_presses());
        self.left = asked.map_or_else(Vec::new, |step| step.presses.clone());
        // Recipe cards that were shown for their time are not shown again when the participant goes back in the
        // tutorial: the recipes have to be remembered.
        self.are_cards_hidden = tutorial.steps.get(step).is_some_and(TutorialStep::is_timed) && self.is_done();
        use TutorialStepKind::{Order, Press, Probe, Question, Recipes, Robot, RobotSays, Signal, Text};
        let needs_nothing = tutorial.steps.get(step).is_some_and(|step| match step.kind {
            Text | Signal | Robot | RobotSays => true,
            Recipes => !step.is_timed(),
            Press | Order | Question | Probe => false,
        });
        self.finish(needs_nothing);
    }

    /// For how long timed recipe cards are still shown, from when the step was last shown: the time continues where the
    /// participant left the step.
    pub fn cards_left_s(&self, step: &TutorialStep) -> Option<f64> {
        let seconds = step.seconds.filter(|_| step.is_timed() && !self.are_cards_hidden)?;
        let before = self.shown_before.get(self.step).copied().unwrap_or_default();
        Some((seconds - before.as_secs_f64()).max(0.0))
    }

    /// Whether the last press was not the one that the step still asks for.
    pub fn is_missed(&self) -> bool {
        self.wanted().is_some() && self.last.is_some_and(|last| !last.is_right)
    }

    /// Whether the participant may continue from the shown step.
    pub fn is_done(&self) -> bool {
        self.done.get(self.step) == Some(&true)
    }

    /// The button that the step asks for now.
    pub fn wanted(&self) -> Option<&String> {
        self.left.first()
    }

    /// Only a button after which the step's other buttons still lead to what it asks for changes the tutorial's kitchen, so
    /// that hints remain correct; the order of the file is one of several.
    pub(crate) fn press(&mut self, kitchen: &Kitchen, button: ButtonId) {
        self.pressed += 1;
        let onward = self.onward(kitchen, button);
        let no_effect = kitchen.no_effect(self.kitchen, Agent::Human, button);
        self.last = Some(TutorialPress { number: self.pressed, button, is_right: onward.is_some(), no_effect });
        if let Some((after, left)) = onward {
            (self.kitchen, self.left) = (after, left);
            self.presses += 1;
            self.finish(self.left.is_empty());
        }
    }

    /// The kitchen after a press of this button, and an order of the other buttons of the step that leads from there to the
    /// same kitchen as the step's own order; `None` if there is none.
    fn onward(&self, kitchen: &Kitchen, button: ButtonId) -> Option<(State, Vec<String>)> {
        let is_it = |name: &String| kitchen.button_named(Agent::Human, name) == Some(button);
        let at = self.left.iter().position(is_it)?;
        let goal =
            self.left.iter().try_fold(self.kitchen, |state, name| pressed(kitchen, state, Agent::Human, name))?;
        let after = pressed(kitchen, self.kitchen, Agent::Human, &self.left[at])?;
        Some((after, ordered(kitchen, after, &without(&self.left, at), goal, &mut BTreeSet::new())?))
    }

    pub(crate) fn answer(&mut self, is_right: bool, choice: u8) {
        self.wrong = (!is_right).then_some(choice);
        if let Some(count) = self.wrong_answers.get_mut(self.step) {
            *count += u32::from(!is_right);
        }
        self.finish(is_right);
    }

    fn finish(&mut self, is_done: bool) {
        if let Some(done) = self.done.get_mut(self.step) {
            *done |= is_done;
        }
    }
}

impl Session {
    /// The question that the shown step of the tutorial practises, with the right answer.
    pub fn practised_question(&self) -> Option<(ProbeQuestion, &str)> {
        let (step, state) = self.tutorial_step()?;
        let location = step.about.as_ref()?;
        let question = probe_sampling::practice(self, state.kitchen, location);
        let aspect = AspectId::of_location(self.kitchen.location_named(location)?);
        let truth = self.kitchen.true_value(state.kitchen, aspect);
        Some((question, &self.kitchen.aspects[aspect.index()].labels[truth]))
    }

    /// Of the present phase.
    pub fn tutorial(&self) -> Option<(&Tutorial, &TutorialState)> {
        let (_, protocol) = self.step()?;
        match self.study_phase()? {
            PhaseSpec::Tutorial { tutorial } => Some((tutorial, protocol.tutorial.as_ref()?)),
            _ => None,
        }
    }

    /// The plan's tutorial, if it is in another language than the participant's display.
    pub fn foreign_tutorial(&self) -> Option<&Tutorial> {
        let tutorial = self.spec.step.as_ref()?.phases.iter().find_map(|phase| match phase {
            PhaseSpec::Tutorial { tutorial } => Some(tutorial),
            _ => None,
        })?;
        (tutorial.language != self.spec.display.code()).then_some(tutorial)
    }

    /// The shown step; `None` if the tutorial is over.
    pub fn tutorial_step(&self) -> Option<(&TutorialStep, &TutorialState)> {
        let (tutorial, state) = self.tutorial().filter(|(_, state)| !state.is_over)?;
        Some((tutorial.steps.get(state.step)?, state))
    }
}

pub(crate) fn admit(session: &Session, event: &TutorialEvent) -> Result<(), &'static str> {
    let (tutorial, _) = session.tutorial().ok_or("no tutorial is shown now")?;
    let (step, state) = session.tutorial_step().ok_or("the tutorial is over")?;
    let may_leave = |by: TutorialPageTurner| by == TutorialPageTurner::Wizard || state.is_done();
    let is_shown = |id: &str| unless(step.id == id, "another step of the tutorial is shown");
    match event {
        TutorialEvent::Shown { step, by } => {
            let to = tutorial.position(step).ok_or("the tutorial has no such step")?;
            unless(
                to + 1 == state.step || to == state.step + 1,
                "only the next step of the tutorial or the one before can be shown",
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
                "the tutorial shows no recipe cards that could be hidden",
            )
        }
        TutorialEvent::Answered { step: id, choice } => {
            is_shown(id)?;
            // Whoever does not know the answer to a probe says so.
            let is_choice = match session.practised_question() {
                Some((question, _)) => usize::from(*choice) <= question.choices.len(),
                None => *choice > 0 && usize::from(*choice) <= step.choices.len(),
            };
            unless(is_choice, "the tutorial's question has no such choice")?;
            unless(!state.is_done(), "this question of the tutorial is answered already")
        }
        TutorialEvent::Ended { by } => {
            let is_last = state.step + 1 == tutorial.steps.len();
            unless(*by == TutorialPageTurner::Wizard || (is_last && state.is_done()), "the tutorial is not at its end")
        }
    }
}

/// Of the study phase that has just begun, if it has a tutorial.
pub(crate) fn begin(session: &mut Session, now: SessionTime) {
    let begun = match session.study_phase() {
        Some(PhaseSpec::Tutorial { tutorial }) => Some(TutorialState::new(tutorial, &session.kitchen, now)),
        _ => None,
    };
    if let Some(protocol) = &mut session.protocol {
        protocol.tutorial = begun;
    }
}

pub(crate) fn apply(session: &mut Session, event: &TutorialEvent, now: SessionTime) {
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
                state.press(kitchen, button);
            }
        }
        TutorialEvent::CardsHidden { .. } => {
            state.are_cards_hidden = true;
            state.finish(true);
        }
        TutorialEvent::Answered { choice, .. } => {
            let is_right = match session.practised_question() {
                Some((question, truth)) => {
                    let answer = usize::from(*choice).checked_sub(1).and_then(|index| question.choices.get(index));
                    answer.is_some_and(|answer| answer == question.choice_for(truth))
                }
                None => step.right == Some(*choice),
            };
            state.answer(is_right, *choice);
        }
        TutorialEvent::Ended { .. } => state.is_over = true,
    }
    if let Some(protocol) = &mut session.protocol {
        protocol.tutorial = Some(state);
    }
}
