//! What changes: stage, orders, contents, presses and their effect, signals.

use serde::Serialize;

use super::words::Words;
use crate::communication::Signal;
use crate::kitchen::{Agent, ButtonAction, ContentId, Kitchen, LocationId, LocationKind, OrderContent};
use crate::session::calibration::Check;
use crate::session::display::Answering;
use crate::session::plan::PhaseSpec;
use crate::session::protocol::Answer;
use crate::session::{Happening, Phase, Session};

/// What the participant sees of the session now; always the whole of it.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Sight {
    pub stage: Stage,
    /// It is for practice.
    pub practice: bool,
    /// What each location shows, in the order of [`super::Scene::locations`].
    pub contents: Vec<Shown>,
    /// Orders served in this trial.
    pub served: usize,
    /// The last press of the human and of the robot, by [`Agent::index`].
    pub presses: [Option<Pressed>; 2],
    /// Where the robot is about to press, if the session shows it.
    pub intention: Option<Spot>,
    pub signal: Option<Told>,
    /// The number of the newest event to be marked by a flash.
    pub cue: Option<u64>,
    pub question: Option<Question>,
    /// Where the eyes are asked to look while the gaze is checked, in fractions of the display.
    pub target: Option<[f64; 2]>,
    /// The gaze is being checked: nothing else is shown.
    pub checks: bool,
}

/// What the display is for now.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Stage {
    Welcome,
    Instruction,
    /// The kitchen before the trial starts.
    Ready,
    Running,
    Paused,
    Over,
    Questionnaire,
    Thanks,
}

/// What a location shows.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Shown {
    Empty,
    Item(String),
    /// What lies on one another. A stack that is on the menu is its dish.
    Stack(Vec<String>),
    Dish(String),
    /// An order that was served a moment ago.
    Served,
}

/// A place of the display: a location or a storage, by its number in the scene.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Spot {
    Location(usize),
    Storage(usize),
}

/// A press and what came of it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub struct Pressed {
    /// Presses of this agent so far.
    pub number: u32,
    pub at: Spot,
    pub effective: bool,
}

/// A signal.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Told {
    /// The recipe of what an order wants.
    Recipe {
        order: usize,
        dish: String,
        items: Vec<String>,
    },
    Highlight(usize),
}

/// An item of a questionnaire that the participant answers.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Question {
    pub title: String,
    /// The item; nothing: all are answered, and are to be confirmed.
    pub item: Option<String>,
    pub text: String,
    /// Counted from 1.
    pub number: usize,
    pub of: usize,
    /// 1 to so many points, with what the ends mean.
    pub points: u8,
    pub low: String,
    pub high: String,
    /// What was answered before.
    pub answer: Option<u8>,
    /// The item before, to go back to.
    pub before: Option<String>,
    /// When all are answered: each item and its answer, if it got one.
    pub given: Vec<Given>,
}

/// An item with what the participant answered.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Given {
    pub text: String,
    pub rated: Option<u8>,
}

/// What the participant sees of a session.
pub fn sight(session: &Session) -> Sight {
    let kitchen = &session.kitchen;
    let contents = (0..kitchen.locations.len()).map(|index| shown(session, LocationId(index as u8)));
    let is_trial = matches!(session.phase, Phase::Running | Phase::Paused);
    let intention = session.robot.intention.filter(|_| session.spec.display.intention && is_trial);
    Sight {
        stage: stage(session),
        practice: matches!(session.study_phase(), Some(PhaseSpec::Familiarisation)),
        contents: contents.collect(),
        served: session.served.len(),
        presses: Agent::BOTH.map(|agent| pressed(session, agent)),
        intention: intention
            .map(|(button, ..)| spot(kitchen, Agent::Robot, kitchen.button(Agent::Robot, button).action)),
        signal: session.shown.as_ref().and_then(|shown| told(session, &shown.signal)),
        cue: session.cue,
        question: question(session),
        target: session.calibration.as_ref().and_then(Check::target),
        checks: session.calibration.as_ref().is_some_and(|check| check.result.is_none()),
    }
}

fn stage(session: &Session) -> Stage {
    let trial = match session.phase {
        Phase::Ready => Stage::Ready,
        Phase::Running => Stage::Running,
        Phase::Paused => Stage::Paused,
        Phase::Over(_) => Stage::Over,
        Phase::Closed => return Stage::Thanks,
    };
    match (session.protocol.is_some(), session.study_phase()) {
        (false, _) if trial == Stage::Ready => Stage::Welcome,
        (false, _) | (true, Some(PhaseSpec::Trial | PhaseSpec::Familiarisation)) => trial,
        (true, None) => Stage::Welcome,
        (true, Some(PhaseSpec::Instruction { .. })) => Stage::Instruction,
        (true, Some(PhaseSpec::Questionnaire { .. })) => Stage::Questionnaire,
        (true, Some(PhaseSpec::Debriefing { .. })) => Stage::Thanks,
    }
}

fn shown(session: &Session, location: LocationId) -> Shown {
    let (kitchen, state) = (&session.kitchen, session.state);
    if kitchen.location(location).kind == LocationKind::Order {
        return match state.order(location) {
            OrderContent::None => Shown::Empty,
            OrderContent::Served => Shown::Served,
            OrderContent::Dish(dish) => Shown::Dish(kitchen.dish(dish).name.clone()),
        };
    }
    content(kitchen, state.content(location))
}

fn content(kitchen: &Kitchen, id: ContentId) -> Shown {
    let content = kitchen.content(id);
    let names = || content.items.iter().map(|item| kitchen.content(*item).name.clone()).collect();
    match content.items.len() {
        0 => Shown::Empty,
        1 => Shown::Item(content.name.clone()),
        _ if kitchen.dishes.iter().any(|dish| dish.stack() == id) => Shown::Dish(content.name.clone()),
        _ => Shown::Stack(names()),
    }
}

fn pressed(session: &Session, agent: Agent) -> Option<Pressed> {
    let newest = session.timeline.iter().rev().find_map(|entry| match entry.what {
        Happening::Press { agent: by, button, effective } if by == agent => Some((button, effective)),
        _ => None,
    });
    let (button, effective) = newest?;
    let at = spot(&session.kitchen, agent, session.kitchen.button(agent, button).action);
    Some(Pressed { number: session.presses[agent.index()], at, effective })
}

/// Where a press of an agent happens.
fn spot(kitchen: &Kitchen, agent: Agent, action: ButtonAction) -> Spot {
    let hand = kitchen.hands[agent.index()];
    let location = match action {
        ButtonAction::Take(item) => {
            let is_it = |storage: &crate::kitchen::layout::Storage| storage.agent == agent && storage.item == item;
            return Spot::Storage(kitchen.storages.iter().position(is_it).unwrap_or_default());
        }
        ButtonAction::Use(location) => location,
        ButtonAction::Process(process) => kitchen.processes[usize::from(process)].place.unwrap_or(hand),
        ButtonAction::Trash => hand,
        ButtonAction::Serve(order) => order,
    };
    Spot::Location(location.index())
}

fn told(session: &Session, signal: &Signal) -> Option<Told> {
    let kitchen = &session.kitchen;
    let location = kitchen.location_named(signal.target())?;
    match signal {
        Signal::Highlight(_) => Some(Told::Highlight(location.index())),
        Signal::ShowRecipe(_) => {
            let OrderContent::Dish(dish) = session.state.order(location) else { return None };
            let dish = kitchen.dish(dish);
            let items = kitchen.content(dish.stack()).items.iter();
            let items = items.map(|item| kitchen.content(*item).name.clone()).collect();
            Some(Told::Recipe { order: location.index(), dish: dish.name.clone(), items })
        }
    }
}

/// The item that is to be answered here; nothing where the wizard reads it out.
fn question(session: &Session) -> Option<Question> {
    if session.spec.display.questionnaire == Answering::Console {
        return None;
    }
    let (questionnaire, protocol) = (session.questionnaire()?, session.protocol.as_ref()?);
    if protocol.confirmed {
        return None;
    }
    let words = Words::of(&session.spec.display);
    let item = questionnaire.items.get(protocol.item);
    let before = protocol.item.checked_sub(1).and_then(|before| questionnaire.items.get(before));
    let answer = |number: usize| match protocol.answers.get(number) {
        Some(Some(Answer::Rated(answer))) => Some(*answer),
        _ => None,
    };
    let items = questionnaire.items.iter().enumerate().filter(|_| item.is_none());
    let given = items.map(|(number, item)| Given { text: item.text.clone(), rated: answer(number) });
    Some(Question {
        title: questionnaire.title.clone(),
        item: item.map(|item| item.id.clone()),
        text: item.map_or_else(|| words.of_name("answers done"), |item| item.text.clone()),
        number: (protocol.item + 1).min(questionnaire.items.len()),
        of: questionnaire.items.len(),
        points: questionnaire.scale.points,
        low: questionnaire.scale.low.clone(),
        high: questionnaire.scale.high.clone(),
        answer: answer(protocol.item),
        given: given.collect(),
        before: before.map(|item| item.id.clone()),
    })
}
