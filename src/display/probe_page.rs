//! The question of a freeze probe that the participant is asked: its words, its choices in words and pictures, and what an answer means.

use serde::Serialize;

use super::display_place::{DisplayPlace, spot};
use super::page_language::DisplayWords;
use crate::base::time::SessionTime;
use crate::kitchen::{Agent, ButtonAction, ContentId, Kitchen, LocationId, LocationKind};
use crate::session::probes::{OpenProbe, ProbeQuestion, ProbeSubject};
use crate::session::{Phase, Session};

/// Longer lists of contents are answered by putting a stack together from its items.
const MOST_CARDS: usize = 16;

/// A probe that is open: the question, or what stands before the first and after the last one. Nothing in it says what is true, how
/// the question was drawn, or what was answered before.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct DisplayedProbe {
    /// Number of the probe in its trial, which the page says with the answer.
    pub probe: u32,
    /// Number of the question, from 1; 0 before the first.
    pub question: u32,
    /// Number of questions.
    pub of: usize,
    /// The question in words.
    pub text: String,
    /// Picture of what is asked about.
    pub about: Option<ProbePicture>,
    /// What can be chosen, in the order of the log; none: no question is shown.
    pub choices: Vec<ProbeChoice>,
    /// Items that can be chosen together to name a stack, at most one of each list; none: one choice is the answer.
    pub parts: Vec<Vec<String>>,
    /// Whether the participant is asked how sure the answer is.
    pub confidence: bool,
    /// Longest duration of a probe, in seconds.
    pub limit_s: f64,
    /// No more questions: the count-down runs.
    pub closed: bool,
}

/// A choice.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ProbeChoice {
    /// Its number in the question's choices, from 1.
    pub number: usize,
    /// The choice in words.
    pub words: String,
    /// Its picture.
    pub shows: Option<ProbePicture>,
}

/// The picture of a choice or a question.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum ProbePicture {
    /// Nothing lies there.
    Empty,
    /// An item.
    Item(String),
    /// Items on one another.
    Stack(Vec<String>),
    /// A dish.
    Dish(String),
    /// The card of a recipe: what goes into the dish.
    Recipe(Vec<String>),
    /// The order with this index among the orders.
    Order(usize),
    /// The location with this index in the scene.
    Location(usize),
    /// The storage with this index in the scene.
    Storage(usize),
}

/// A question in words, as it is put to the participant.
#[derive(Clone, Debug, PartialEq)]
pub struct ProbeWording {
    /// The question.
    pub question: String,
    /// Its choices, in their order.
    pub choices: Vec<String>,
}

/// The open probe, as the participant sees it; none without a probe, and while the wizard pauses it.
pub(super) fn probe(session: &Session) -> Option<DisplayedProbe> {
    let open = shown_probe(session)?;
    let (kitchen, settings) = (&session.kitchen, session.spec.probes.as_ref()?);
    let words = DisplayWords::for_kitchen(kitchen, &session.spec.display);
    let question = asked(open);
    let all = question.map_or_else(Vec::new, |(_, question)| choices(kitchen, &words, question));
    let parts = question.map_or_else(Vec::new, |(_, question)| parts(kitchen, question, &all));
    let is_part = |choice: &ProbeChoice| !parts.is_empty() && matches!(choice.shows, Some(ProbePicture::Stack(_)));
    Some(DisplayedProbe {
        probe: open.number,
        question: question.map_or(0, |(index, _)| index as u32 + 1),
        of: open.questions.len(),
        text: question.map_or_else(String::new, |(_, question)| ask(kitchen, &words, &question.about)),
        about: question.and_then(|(_, question)| about(kitchen, &question.about)),
        choices: all.into_iter().filter(|choice| !is_part(choice)).collect(),
        parts,
        confidence: settings.confidence,
        limit_s: settings.limit_s,
        closed: open.closed.is_some(),
    })
}

/// The probe that is open and not paused by the wizard.
fn shown_probe(session: &Session) -> Option<&OpenProbe> {
    session.probes.open.as_ref().filter(|open| session.phase == Phase::Paused && !open.is_paused())
}

/// The question that is shown now, with its index.
fn asked(open: &OpenProbe) -> Option<(usize, &ProbeQuestion)> {
    let index = open.shown.filter(|_| open.closed.is_none())?;
    Some((index, open.questions.get(index)?))
}

/// The time that the probe still has for its questions, or its count-down; none where no time runs.
pub fn probe_left(session: &Session, now: SessionTime) -> Option<SessionTime> {
    let open = shown_probe(session)?;
    let settings = session.spec.probes.as_ref()?;
    let (from, seconds) = match open.closed {
        Some((_, at)) => (at, settings.count_down_s),
        None => (open.begun, settings.limit_s),
    };
    let ends = open.when(from, SessionTime::from_secs_f64(seconds));
    Some(SessionTime(ends.0.saturating_sub(now.0)))
}

/// A question in the words of the participant's language.
pub fn probe_wording(session: &Session, question: &ProbeQuestion) -> ProbeWording {
    let words = DisplayWords::for_kitchen(&session.kitchen, &session.spec.display);
    let all = choices(&session.kitchen, &words, question);
    ProbeWording {
        question: ask(&session.kitchen, &words, &question.about),
        choices: all.into_iter().map(|choice| choice.words).collect(),
    }
}

/// The choice that consists of these items, by its name in the log; none if the question has no such choice.
pub fn choice_made_of(kitchen: &Kitchen, question: &ProbeQuestion, items: &[String]) -> Option<String> {
    let sorted = |ids: &[ContentId]| {
        let mut names: Vec<&str> = ids.iter().map(|id| kitchen.content(*id).name.as_str()).collect();
        names.sort_unstable();
        names
    };
    let mut wanted: Vec<&str> = items.iter().map(String::as_str).collect();
    wanted.sort_unstable();
    let is_it = |name: &&String| {
        kitchen.content_named(name).is_some_and(|content| sorted(&kitchen.content(content).items) == wanted)
    };
    question.choices.iter().find(is_it).cloned()
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

/// A content of a location, or what an order wants.
fn content(kitchen: &Kitchen, words: &DisplayWords, location: &str, name: &str) -> (String, Option<ProbePicture>) {
    let is_order =
        kitchen.location_named(location).is_some_and(|location| kitchen.location(location).kind == LocationKind::Order);
    let dish = || Some(ProbePicture::Dish(name.to_string()));
    match (is_order, name) {
        (true, "none") => return (words.of_name("no order"), Some(ProbePicture::Empty)),
        (true, "served") => return (words.of_name("served"), None),
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

/// A recipe by the name of its stack, which can be the name of another dish: what counts are the items.
fn recipe(kitchen: &Kitchen, words: &DisplayWords, name: &str) -> (String, Option<ProbePicture>) {
    let items = kitchen.content_named(name).map_or(&[][..], |id| &kitchen.content(id).items);
    let names: Vec<String> = items.iter().map(|item| kitchen.content(*item).name.clone()).collect();
    (joined(words, &names), Some(ProbePicture::Recipe(names)))
}

/// A press of the robot.
fn press(kitchen: &Kitchen, words: &DisplayWords, name: &str) -> (String, Option<ProbePicture>) {
    let Some(button) = kitchen.button_named(Agent::Robot, name) else { return (words.of_name(name), None) };
    let action = kitchen.button(Agent::Robot, button).action;
    let picture = match spot(kitchen, Agent::Robot, action) {
        DisplayPlace::Storage(storage) => ProbePicture::Storage(storage),
        DisplayPlace::Location(location) => place_picture(kitchen, LocationId(location as u8)),
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

/// The items from which a stack is put together, by slot of the stacking rule, where a list of all stacks would be too long. Which full
/// stacks are on the menu does not follow from them.
fn parts(kitchen: &Kitchen, question: &ProbeQuestion, choices: &[ProbeChoice]) -> Vec<Vec<String>> {
    let has_stacks = choices.iter().any(|choice| matches!(choice.shows, Some(ProbePicture::Stack(_))));
    if choices.len() <= MOST_CARDS || !has_stacks {
        return Vec::new();
    }
    let items: Vec<ContentId> = question.choices.iter().filter_map(|name| kitchen.content_named(name)).collect();
    let items: Vec<ContentId> = items.into_iter().filter(|id| kitchen.content(*id).items.len() == 1).collect();
    let meets = |a: ContentId, b: ContentId| kitchen.stacked(a, b).is_some() || kitchen.stacked(b, a).is_some();
    let mut slots: Vec<Vec<ContentId>> = Vec::new();
    for &item in items.iter().filter(|&&item| items.iter().any(|&other| meets(item, other))) {
        match slots.iter_mut().find(|slot| slot.iter().all(|&other| !meets(item, other))) {
            Some(slot) => slot.push(item),
            None => slots.push(vec![item]),
        }
    }
    let name = |id: &ContentId| kitchen.content(*id).name.clone();
    slots.iter().map(|slot| slot.iter().map(name).collect()).collect()
}
