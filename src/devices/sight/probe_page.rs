//! The freeze probe question on the participant's display: its text, its choices in words and pictures, and which
//! choice an answer stands for.

use serde::Serialize;

use super::displayed_item::{SceneElement, spot};
use super::page_language::DisplayWords;
use tomcom_core::base::time::SessionTime;
use tomcom_core::kitchen::{Agent, ButtonAction, Kitchen, LocationId, LocationKind};
use tomcom_session::probe_sampling::SOMETHING_ELSE;
use tomcom_session::probes::{ProbeEndReason, ProbeQuestion, ProbeSubject, StartedProbe};
use tomcom_session::{Session, TrialPhase};

/// An open freeze probe as the participant's display shows it: a question, or the page before the first or after the
/// last question. The page contains nothing about the truth, the drawing of the question, or earlier answers.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct DisplayedProbe {
    pub probe: u32,
    /// Number of the question within the probe, from 1; 0 before the first question.
    pub question: u32,
    pub of: usize,
    pub text: String,
    pub about: Option<ProbePicture>,
    /// Choices of the question, in the order of the log; empty if no question is shown.
    pub choices: Vec<ProbeChoice>,
    pub confidence: bool,
    /// Time for the question, in seconds.
    pub limit_s: f64,
    /// Whether the time of the question before went by without an answer.
    pub late: bool,
    pub closed: bool,
}

/// One choice of a freeze probe question.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ProbeChoice {
    /// Number of the choice within the question, from 1.
    pub number: usize,
    pub words: String,
    /// Picture beside the text of this answer choice; `None` for a choice without a picture.
    pub shows: Option<ProbePicture>,
}

/// Picture for a choice or a question of a freeze probe.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum ProbePicture {
    Empty,
    /// An order that is served.
    Served,
    Item(String),
    Stack(Vec<String>),
    Dish(String),
    Recipe(Vec<String>),
    Order(usize),
    Location(usize),
    Storage(usize),
    Trash,
}

/// Text of a freeze probe question and of its choices.
#[derive(Clone, Debug, PartialEq)]
pub struct ProbeWording {
    pub question: String,
    /// Texts of the question's choices, in the order of the choices.
    pub choices: Vec<String>,
}

/// The open freeze probe as the participant sees it; `None` without a probe, and while the wizard pauses the probe.
pub(super) fn probe(session: &Session) -> Option<DisplayedProbe> {
    let open = shown_probe(session)?;
    let (kitchen, settings) = (&session.kitchen, session.spec.probes.as_ref()?);
    let words = DisplayWords::for_kitchen(kitchen, &session.spec.display);
    let question = asked(open);
    Some(DisplayedProbe {
        probe: open.number,
        question: question.map_or(0, |(index, _)| index as u32 + 1),
        of: open.questions.len(),
        text: question.map_or_else(String::new, |(_, question)| ask(kitchen, &words, &question.about)),
        about: question.and_then(|(_, question)| about(kitchen, &question.about)),
        choices: question.map_or_else(Vec::new, |(_, question)| choices(kitchen, &words, question)),
        confidence: settings.confidence,
        limit_s: settings.limit_s,
        late: is_late(open),
        closed: open.closed.is_some(),
    })
}

/// Whether the time of the question before went by without an answer.
fn is_late(open: &StartedProbe) -> bool {
    let before = match open.closed {
        Some((ProbeEndReason::TimeOver, _)) => open.shown,
        Some(_) => None,
        None => open.shown.and_then(|shown| shown.checked_sub(1)),
    };
    before.is_some_and(|before| open.answers[before].is_none())
}

/// The question that the tutorial's step practises.
pub(super) fn practice(session: &Session) -> Option<DisplayedProbe> {
    let (kitchen, settings) = (&session.kitchen, session.spec.probes.as_ref()?);
    let words = DisplayWords::for_kitchen(kitchen, &session.spec.display);
    let (question, _) = session.practised_question()?;
    Some(DisplayedProbe {
        probe: 0,
        question: 1,
        of: 1,
        text: ask(kitchen, &words, &question.about),
        about: about(kitchen, &question.about),
        choices: choices(kitchen, &words, &question),
        confidence: settings.confidence,
        limit_s: settings.limit_s,
        late: false,
        closed: false,
    })
}

/// The open freeze probe, unless the wizard pauses the probe.
fn shown_probe(session: &Session) -> Option<&StartedProbe> {
    session.probes.open.as_ref().filter(|open| session.phase == TrialPhase::Paused && !open.is_paused())
}

/// The freeze probe question that the display shows now, with its index.
fn asked(open: &StartedProbe) -> Option<(usize, &ProbeQuestion)> {
    let index = open.shown.filter(|_| open.closed.is_none())?;
    Some((index, open.questions.get(index)?))
}

/// Time that the shown question still has, or that the probe's count-down still has; `None` while no time runs.
pub fn probe_left(session: &Session, now: SessionTime) -> Option<SessionTime> {
    let open = shown_probe(session)?;
    let settings = session.spec.probes.as_ref()?;
    let (from, seconds) = match open.closed {
        Some((_, at)) => (at, settings.count_down_s),
        None => open.question().map(|_| (open.asked_at, settings.limit_s))?,
    };
    let ends = open.when(from, SessionTime::from_secs_f64(seconds));
    Some(SessionTime(ends.0.saturating_sub(now.0)))
}

/// Text of a question and of its choices in the participant's language.
pub fn probe_wording(session: &Session, question: &ProbeQuestion) -> ProbeWording {
    let words = DisplayWords::for_kitchen(&session.kitchen, &session.spec.display);
    let all = choices(&session.kitchen, &words, question);
    ProbeWording {
        question: ask(&session.kitchen, &words, &question.about),
        choices: all.into_iter().map(|choice| choice.words).collect(),
    }
}

fn ask(kitchen: &Kitchen, words: &DisplayWords, about: &ProbeSubject) -> String {
    match about {
        ProbeSubject::Location { location } => {
            let is_order = kitchen.location_named(location).is_some_and(|id| kitchen.orders.contains(&id));
            let of_place = format!("ask {}", location.replace('_', " "));
            let pattern = if is_order { "ask order" } else { "ask place" };
            words.known(&of_place).unwrap_or_else(|| words.filled(pattern, &words.of_name(location)))
        }
        ProbeSubject::Recipe { dish } => words.filled("ask recipe", &words.of_name(dish)),
        ProbeSubject::NextOrder => words.of_name("ask next order"),
        ProbeSubject::NextPress => words.of_name("ask next press"),
    }
}

fn about(kitchen: &Kitchen, about: &ProbeSubject) -> Option<ProbePicture> {
    match about {
        ProbeSubject::Location { location } => Some(place_picture(kitchen, kitchen.location_named(location)?)),
        ProbeSubject::Recipe { dish } => Some(ProbePicture::Dish(dish.clone())),
        ProbeSubject::NextPress => Some(ProbePicture::Location(kitchen.hands[Agent::Robot.index()].index())),
        ProbeSubject::NextOrder => None,
    }
}

fn place_picture(kitchen: &Kitchen, place: LocationId) -> ProbePicture {
    match kitchen.orders.iter().position(|order| *order == place) {
        Some(order) => ProbePicture::Order(order),
        None => ProbePicture::Location(place.index()),
    }
}

fn choices(kitchen: &Kitchen, words: &DisplayWords, question: &ProbeQuestion) -> Vec<ProbeChoice> {
    let choice = |(index, name): (usize, &String)| {
        let (words, shows) = match &question.about {
            _ if name == SOMETHING_ELSE => (words.of_name(name), None),
            ProbeSubject::Location { location } => content(kitchen, words, location, name),
            ProbeSubject::Recipe { .. } => recipe(kitchen, words, name),
            ProbeSubject::NextOrder => {
                (words.of_name(name), kitchen.location_named(name).map(|order| place_picture(kitchen, order)))
            }
            ProbeSubject::NextPress => press(kitchen, words, name),
        };
        ProbeChoice { number: index + 1, words, shows }
    };
    question.choices.iter().enumerate().map(choice).collect()
}

/// Text and picture of a location's content, or of the dish that an order asks for.
fn content(kitchen: &Kitchen, words: &DisplayWords, location: &str, name: &str) -> (String, Option<ProbePicture>) {
    let is_order =
        kitchen.location_named(location).is_some_and(|location| kitchen.location(location).kind == LocationKind::Order);
    let dish = || Some(ProbePicture::Dish(name.to_string()));
    match (is_order, name) {
        (true, "none") => return (words.of_name("no order"), Some(ProbePicture::Empty)),
        (true, "served") => return (words.of_name("served"), Some(ProbePicture::Served)),
        (true, _) => return (words.of_name(name), dish()),
        (false, _) => {}
    }
    let items = kitchen.content_named(name).map_or(&[][..], |id| &kitchen.content(id).items);
    let names = || items.iter().map(|item| kitchen.content(*item).name.clone()).collect::<Vec<_>>();
    match items.len() {
        0 => (words.of_name("empty"), Some(ProbePicture::Empty)),
        1 => (words.of_name(name), Some(ProbePicture::Item(name.to_string()))),
        _ if kitchen.dish_named(name).is_some() => (words.of_name(name), dish()),
        _ => (joined(words, &names()), Some(ProbePicture::Stack(names()))),
    }
}

/// Text and picture of a recipe that is given by the name of its stack. The name of the stack can be the name of
/// another dish, so the items of the stack are shown.
fn recipe(kitchen: &Kitchen, words: &DisplayWords, name: &str) -> (String, Option<ProbePicture>) {
    let items = kitchen.content_named(name).map_or(&[][..], |id| &kitchen.content(id).items);
    let names: Vec<String> = items.iter().map(|item| kitchen.content(*item).name.clone()).collect();
    (joined(words, &names), Some(ProbePicture::Recipe(names)))
}

fn press(kitchen: &Kitchen, words: &DisplayWords, name: &str) -> (String, Option<ProbePicture>) {
    let Some(button) = kitchen.button_named(Agent::Robot, name) else { return (words.of_name(name), None) };
    let action = kitchen.button(Agent::Robot, button).action;
    let picture = match spot(kitchen, Agent::Robot, action) {
        _ if action == ButtonAction::Trash => ProbePicture::Trash,
        SceneElement::Storage(storage) => ProbePicture::Storage(storage),
        SceneElement::Location(location) => place_picture(kitchen, LocationId(location as u8)),
    };
    let location = |id| words.of_name(&kitchen.location(id).name);
    let said = match action {
        ButtonAction::Take(item) => words.filled("do take", &words.of_name(&kitchen.content(item).name)),
        ButtonAction::Use(place) => words.filled("do use", &location(place)),
        ButtonAction::Serve(order) => words.filled("do serve", &location(order)),
        ButtonAction::Process(_) | ButtonAction::Trash => words.of_name(name),
    };
    (said, Some(picture))
}

fn joined(words: &DisplayWords, names: &[String]) -> String {
    names.iter().map(|name| words.of_name(name)).collect::<Vec<_>>().join(" + ")
}
