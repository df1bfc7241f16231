//! Record of a participant's beliefs at a press, and of the press's origin (plan, false belief or slip).
//!
//! The participant's decision is repeated with the truth and the same lapses. If the press stays the same, it came from
//! the plan; if the press changes, it came from a false belief, namely the smallest replacement by the truth that
//! changes the press. An order and the recipe of its dish are replaced together.

use super::decision::DecisionContext;
use super::true_beliefs::ParticipantBeliefs;
use tomcom_core::kitchen::{
    AspectId, AspectKind, ButtonId, Kitchen, LocationId, LocationKind, OrderContent, State, World,
};
use tomcom_core::mind::{AspectBelief, PressOrigin, RecordedBelief, WORTH_TELLING};

/// Records the belief about every aspect: the most probable value, the probability of the true value, and all other
/// probabilities large enough for the log.
pub fn witness(kitchen: &Kitchen, beliefs: &ParticipantBeliefs, state: State, reason: PressReason) -> RecordedBelief {
    let name = |aspect: &AspectId| kitchen.aspects[aspect.index()].name.clone();
    RecordedBelief {
        cause: reason.cause,
        origin: Some(reason.origin),
        targets: reason.targets.iter().map(name).collect(),
        ..without_press(kitchen, beliefs, state)
    }
}

/// Records the belief about every aspect at a freeze probe, which leads to no press.
pub fn without_press(kitchen: &Kitchen, beliefs: &ParticipantBeliefs, state: State) -> RecordedBelief {
    let told = |index: usize| {
        let (aspect, id) = (&kitchen.aspects[index], AspectId(index as u8));
        let values = aspect.labels.iter().zip(beliefs.distribution(id)).filter(|(_, p)| **p >= WORTH_TELLING);
        AspectBelief {
            aspect: aspect.name.clone(),
            believes: aspect.labels[beliefs.most_likely(id)].clone(),
            p_truth: rounded(beliefs.p_truth(kitchen, state, id)),
            values: values.map(|(label, &p)| (label.clone(), rounded(p))).collect(),
        }
    };
    RecordedBelief {
        aspects: (0..kitchen.aspects.len()).map(told).collect(),
        cause: "asked by a probe".to_string(),
        origin: None,
        targets: Vec::new(),
    }
}

/// Rounds a probability to six decimals for the log.
pub(super) fn rounded(p: f64) -> f64 {
    (p * 1e6).round() / 1e6
}

/// Why a participant presses a button.
#[derive(Clone, Debug, PartialEq)]
pub struct PressReason {
    /// Whether the press comes from the plan, from a false belief, or from a slip.
    pub origin: PressOrigin,
    /// The reason of the press, in words for the log.
    pub cause: String,
    /// The state aspects whose replacement by the truth changes the decision.
    pub targets: Vec<AspectId>,
}

impl PressReason {
    /// The reason of a press that was a slip, with a description of the slip.
    pub fn slip(cause: String) -> PressReason {
        PressReason { origin: PressOrigin::Slip, cause, targets: Vec::new() }
    }

    /// The reason of a press that the display proposed.
    pub fn proposed() -> PressReason {
        PressReason { origin: PressOrigin::Plan, cause: "as proposed on the display".to_string(), targets: Vec::new() }
    }

    /// The reason of a press that was decided in the world `believed`, while the world `truth` is the true one.
    pub fn decided(decision: &DecisionContext, believed: &World, truth: &World, button: ButtonId) -> PressReason {
        let kitchen = decision.kitchen;
        let presses = |world: &World| decision.resolve(world).plan.front().copied();
        let informed = presses(truth);
        if informed == Some(button) {
            let cause = "as it is".to_string();
            return PressReason { origin: PressOrigin::Plan, cause, targets: Vec::new() };
        }
        let wrong = wrong_targets(kitchen, believed, truth);
        let told = |world: &World, target: &[AspectId]| {
            let mut world = *world;
            target.iter().for_each(|&aspect| tell(kitchen, &mut world, truth, aspect));
            world
        };
        let mut changing: Option<Vec<AspectId>> = None;
        for target in &wrong {
            let press = presses(&told(believed, target));
            if press != Some(button) && (changing.is_none() || press == informed) {
                changing = Some(target.clone());
                if press == informed {
                    break;
                }
            }
        }
        let pairs = || {
            let pair = |(index, one): (usize, &Vec<AspectId>)| {
                let world = told(believed, one);
                let other = wrong[index + 1..].iter().find(|other| presses(&told(&world, other)) != Some(button))?;
                Some([one.as_slice(), other].concat())
            };
            wrong.iter().enumerate().find_map(pair)
        };
        let targets = changing.or_else(pairs).unwrap_or_else(|| wrong.concat());
        let label = |aspect: &AspectId| {
            let known = &kitchen.aspects[aspect.index()];
            let held = known.index_of(code_of(kitchen, believed, *aspect)).map_or("?", |value| &known.labels[value]);
            format!("believes {}: {held}", known.name)
        };
        let cause = targets.iter().map(label).collect::<Vec<_>>().join(", ");
        PressReason { origin: PressOrigin::Belief, cause, targets }
    }
}

/// State aspects with false beliefs, in the order of the layout; an order and the recipe of the dish that it truly wants
/// are one target.
fn wrong_targets(kitchen: &Kitchen, believed: &World, truth: &World) -> Vec<Vec<AspectId>> {
    let is_wrong = |aspect: &AspectId| code_of(kitchen, believed, *aspect) != code_of(kitchen, truth, *aspect);
    let mut left: Vec<AspectId> =
        (0..kitchen.aspects.len()).map(|index| AspectId(index as u8)).filter(is_wrong).collect();
    let mut targets = Vec::new();
    for index in 0..kitchen.locations.len() {
        let location = LocationId(index as u8);
        let mut target = vec![AspectId::of_location(location)];
        if kitchen.location(location).kind == LocationKind::Order
            && let OrderContent::Dish(dish) = truth.state.order(location)
        {
            target.push(kitchen.aspect_of_dish(dish));
        }
        target.retain(|aspect| left.contains(aspect));
        left.retain(|aspect| !target.contains(aspect));
        if !target.is_empty() {
            targets.push(target);
        }
    }
    targets.extend(left.into_iter().map(|aspect| vec![aspect]));
    targets
}

/// The code of an aspect's value in this world.
fn code_of(kitchen: &Kitchen, world: &World, aspect: AspectId) -> u8 {
    match kitchen.aspects[aspect.index()].kind {
        AspectKind::Location(location) => world.state.code(location),
        AspectKind::Recipe(dish) => world.recipes.get(dish).0,
    }
}

/// Sets a state aspect of a world to its true value.
fn tell(kitchen: &Kitchen, world: &mut World, truth: &World, aspect: AspectId) {
    match kitchen.aspects[aspect.index()].kind {
        AspectKind::Location(location) => world.state.set_code(location, truth.state.code(location)),
        AspectKind::Recipe(dish) => world.recipes.set(dish, truth.recipes.get(dish)),
    }
}
