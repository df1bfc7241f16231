//! Draws the questions of a freeze probe with known probabilities.
//!
//! In a probe that uses the belief estimate, every state aspect belongs to one stratum: believed wrong by the estimate,
//! changed unseen, recipe of a current order, or any other. Each stratum that is not empty has the same share of the
//! questions, divided evenly among the stratum's aspects, but every aspect has a minimum probability. In a blind probe
//! all aspects have the same probability. The inclusion probability of each drawn aspect is recorded, so that an
//! analysis can weight answers by its inverse (Horvitz and Thompson 1952).
//!
//! A question shows what could be there, at most `MOST_CHOICES` answers: nothing comes first, then the others in random
//! order. Where more is possible, what is shown depends on the location and on the orders, which everybody sees, and on
//! chance; not on what is there, nor on what the recipes say beside the ingredients. The last answer is then
//! [`SOMETHING_ELSE`], which is right where the truth is not shown.
//!
//! With the setting `level_2` one further question is about what happens next (level 2 of situation awareness).
//!
//! Questions are drawn by systematic sampling of fixed size over the aspects in random order (Madow 1949), whose
//! inclusion probabilities are exact.

use rand::RngExt;

use crate::Session;
use crate::probe_settings::ProbeSpec;
use crate::probes::{ProbeQuestion, ProbeSubject};
use tomcom_core::base::rng::{Stream, shuffle, stream};
use tomcom_core::kitchen::{Agent, AspectId, AspectKind, Content, ContentId, Kitchen, LocationId, OrderContent, State};

const STRATA: usize = 4;
/// Largest number of answers: a participant can read these in the time of a question.
const MOST_CHOICES: usize = 12;
/// The answer that stands for all that a question does not show, by its name in the log.
pub const SOMETHING_ELSE: &str = "something else";
/// The answers that say that nothing is there: of places, and of orders.
const NOTHING: [&str; 2] = ["empty", "none"];

/// `is_wrong`: for each state aspect, whether the belief is wrong by the estimate; `None` in a blind probe.
pub fn questions(session: &Session, spec: &ProbeSpec, probe: u32, is_wrong: Option<&[bool]>) -> Vec<ProbeQuestion> {
    let name = format!("questions of probes in trial {}", session.trial);
    let mut random = stream(session.spec.seed, &name, u64::from(probe));
    let kitchen = &session.kitchen;
    let mut asked: Vec<AspectId> = (0..kitchen.aspects.len()).map(|index| AspectId(index as u8)).collect();
    asked.retain(|id| {
        let aspect = &kitchen.aspects[id.index()];
        spec.asks_about(&aspect.name, aspect.labels.len())
    });
    shuffle(&mut asked, &mut random);
    let most = (spec.most_questions as usize).min(asked.len());
    let number = random.random_range((spec.least_questions as usize).min(most)..=most);
    let shares: Vec<f64> = match is_wrong {
        None => vec![1.0 / asked.len().max(1) as f64; asked.len()],
        Some(is_wrong) => stratum_shares(&asked.iter().map(|&id| stratum(session, id, is_wrong)).collect::<Vec<_>>()),
    };
    let inclusion = inclusions(&shares, number, spec.least_inclusion);
    let mut drawn = systematic(&inclusion, number, random.random());
    shuffle(&mut drawn, &mut random);
    let questions = drawn.into_iter().map(|index| question(session, asked[index], inclusion[index], &mut random));
    let mut questions: Vec<ProbeQuestion> = questions.collect();
    if spec.level_2 {
        questions.push(what_next(session, &mut random));
    }
    questions
}

/// About the next served order, if there is an order, or about the robot.
fn what_next(session: &Session, random: &mut Stream) -> ProbeQuestion {
    let kitchen = &session.kitchen;
    let is_order = |&order: &LocationId| matches!(session.state.order(order), OrderContent::Dish(_));
    let subjects = match kitchen.orders.iter().any(is_order) {
        true => vec![ProbeSubject::NextOrder, ProbeSubject::NextPress],
        false => vec![ProbeSubject::NextPress],
    };
    let inclusion = 1.0 / subjects.len() as f64;
    let about = subjects[random.random_range(0..subjects.len())].clone();
    let choices = choices(kitchen, session.state, &about, random);
    ProbeQuestion { about, choices, inclusion }
}

/// What a question shows, by the names in the log.
fn choices(kitchen: &Kitchen, state: State, about: &ProbeSubject, random: &mut Stream) -> Vec<String> {
    let mut others = labels(kitchen, about);
    let nothing: Vec<String> = others.extract_if(.., |label| NOTHING.contains(&label.as_str())).collect();
    shuffle(&mut others, random);
    let room = MOST_CHOICES - nothing.len();
    let mut else_ = Vec::new();
    if others.len() > room {
        others.sort_by_key(|label| implausibility(kitchen, state, about, label));
        others.truncate(room - 1);
        shuffle(&mut others, random);
        else_.push(SOMETHING_ELSE.to_string());
    }
    [nothing, others, else_].concat()
}

/// Less plausible contents have higher numbers. Plausible is what is made of the ingredients of one current order, in
/// whichever state; and of that what the location is for: on the board what is stacked, elsewhere single items and
/// dishes.
fn implausibility(kitchen: &Kitchen, state: State, about: &ProbeSubject, label: &str) -> u8 {
    let ProbeSubject::Location { location } = about else { return 0 };
    let Some(id) = kitchen.content_named(label) else { return 0 };
    let content = kitchen.content(id);
    let ingredients = |content: &Content| content.items.iter().map(|item| kitchen.content(*item).ingredient).collect();
    let own: Vec<Option<usize>> = ingredients(content);
    let is_ordered = kitchen.orders.iter().any(|&order| {
        let OrderContent::Dish(dish) = state.order(order) else { return false };
        let wanted: Vec<Option<usize>> = ingredients(kitchen.content(kitchen.dish(dish).stack()));
        own.iter().all(|one| wanted.contains(one))
    });
    let is_stacked = |&other: &ContentId| kitchen.stacked(id, other).or(kitchen.stacked(other, id)).is_some();
    let is_for_it = match kitchen.location_named(location) == Some(kitchen.board) {
        true => content.is_stack() || (0..kitchen.contents.len()).any(|other| is_stacked(&ContentId(other as u8))),
        false => !content.is_stack() || content.is_dish,
    };
    2 * u8::from(!is_ordered) + u8::from(!is_for_it)
}

/// The question about a location in a tutorial, whose kitchen is in this state.
pub fn practice(session: &Session, state: State, location: &str) -> ProbeQuestion {
    let about = ProbeSubject::Location { location: location.to_string() };
    let mut random = stream(session.spec.seed, "question of the tutorial", 0);
    ProbeQuestion { choices: choices(&session.kitchen, state, &about, &mut random), about, inclusion: 1.0 }
}

/// All possible answers, by their names in the log; none if the kitchen does not have what the question is about.
fn labels(kitchen: &Kitchen, about: &ProbeSubject) -> Vec<String> {
    match about {
        ProbeSubject::Location { .. } | ProbeSubject::Recipe { .. } => {
            aspect(kitchen, about).map_or(Vec::new(), |id| kitchen.aspects[id.index()].labels.clone())
        }
        ProbeSubject::NextOrder => kitchen.orders.iter().map(|&order| kitchen.location(order).name.clone()).collect(),
        ProbeSubject::NextPress => {
            kitchen.buttons[Agent::Robot.index()].iter().map(|button| button.name.clone()).collect()
        }
    }
}

/// From 0.
fn stratum(session: &Session, id: AspectId, is_wrong: &[bool]) -> usize {
    let is_current =
        |dish| session.kitchen.orders.iter().any(|&order| session.state.order(order) == OrderContent::Dish(dish));
    match session.kitchen.aspects[id.index()].kind {
        _ if is_wrong.get(id.index()) == Some(&true) => 0,
        AspectKind::Location(location) if session.is_unseen(location) => 1,
        AspectKind::Recipe(dish) if is_current(dish) => 2,
        _ => 3,
    }
}

/// Strata that are not empty have equal shares, and so have the aspects within a stratum.
fn stratum_shares(strata: &[usize]) -> Vec<f64> {
    let mut sizes = [0_usize; STRATA];
    strata.iter().for_each(|&stratum| sizes[stratum] += 1);
    let filled = sizes.iter().filter(|size| **size > 0).count();
    strata.iter().map(|&stratum| 1.0 / (filled * sizes[stratum]) as f64).collect()
}

/// Inclusion probabilities for drawing `number` aspects: a minimum for every aspect, and the rest in proportion to
/// these shares, which sum to 1. No inclusion probability exceeds 1, and they sum to `number`.
fn inclusions(shares: &[f64], number: usize, floor: f64) -> Vec<f64> {
    let mut is_certain = vec![false; shares.len()];
    loop {
        let certain = is_certain.iter().filter(|certain| **certain).count();
        let open = || shares.iter().zip(&is_certain).filter(|(_, certain)| !**certain).map(|(share, _)| share);
        let open_share: f64 = open().sum();
        let left = number as f64 - certain as f64;
        // If the minimum probability alone exceeds what the number of questions allows, the minimum is lowered to the
        // highest possible value.
        let floor = floor.min(left / open().count().max(1) as f64);
        let rest = left - floor * open().count() as f64;
        let chance = |(share, certain): (&f64, &bool)| match certain {
            true => 1.0,
            false => floor + rest * share / open_share,
        };
        let chances: Vec<f64> = shares.iter().zip(&is_certain).map(chance).collect();
        if chances.iter().all(|chance| *chance <= 1.0) {
            return chances;
        }
        for (certain, chance) in is_certain.iter_mut().zip(&chances) {
            *certain |= *chance >= 1.0;
        }
    }
}

/// A systematic draw of `number` indices: those at which the cumulative sum of the inclusion probabilities passes
/// `start`, `start` + 1, and so on.
fn systematic(inclusion: &[f64], number: usize, start: f64) -> Vec<usize> {
    let mut drawn = Vec::with_capacity(number);
    let mut sum = 0.0;
    for (index, chance) in inclusion.iter().enumerate() {
        sum += chance;
        if drawn.len() < number && sum > start + drawn.len() as f64 {
            drawn.push(index);
        }
    }
    // Rounding can leave the cumulative sum of probabilities just below the last mark.
    if drawn.len() < number
        && let Some(last) = (0..inclusion.len()).rev().find(|index| !drawn.contains(index))
    {
        drawn.push(last);
    }
    drawn
}

fn question(session: &Session, id: AspectId, inclusion: f64, random: &mut Stream) -> ProbeQuestion {
    let kitchen = &session.kitchen;
    let aspect = &kitchen.aspects[id.index()];
    let about = match aspect.kind {
        AspectKind::Location(location) => ProbeSubject::Location { location: kitchen.location(location).name.clone() },
        AspectKind::Recipe(dish) => ProbeSubject::Recipe { dish: kitchen.dish(dish).name.clone() },
    };
    let choices = choices(kitchen, session.state, &about, random);
    // The inclusion probability is rounded as in the log, because the analysis divides by the recorded value.
    ProbeQuestion { about, choices, inclusion: (inclusion * 1e9).round() / 1e9 }
}

/// `None` if the question is about what happens next, or about something that the kitchen does not have.
pub fn aspect(kitchen: &Kitchen, about: &ProbeSubject) -> Option<AspectId> {
    match about {
        ProbeSubject::Location { location } => kitchen.location_named(location).map(AspectId::of_location),
        ProbeSubject::Recipe { dish } => kitchen.dish_named(dish).map(|dish| kitchen.aspect_of_dish(dish)),
        ProbeSubject::NextOrder | ProbeSubject::NextPress => None,
    }
}

/// Whether a recorded question fits this kitchen: its choices are possible answers, each once, and stand for all.
pub(super) fn fits(kitchen: &Kitchen, question: &ProbeQuestion) -> bool {
    let is_chance = question.inclusion > 0.0 && question.inclusion <= 1.0;
    let (labels, choices) = (labels(kitchen, &question.about), &question.choices);
    let is_first = |index: usize| !choices[..index].contains(&choices[index]);
    is_chance
        && !labels.is_empty()
        && (0..choices.len()).all(is_first)
        && choices.iter().all(|choice| choice == SOMETHING_ELSE || labels.contains(choice))
        && labels.iter().all(|label| choices.iter().any(|choice| choice == question.choice_for(label)))
}
