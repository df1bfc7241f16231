//! Record of a participant's beliefs at a press, and of the press's origin (plan, false belief or slip).
//!
//! The participant's decision is repeated with the truth and the same lapses. If the press stays the same, it came from
//! the plan; if the press changes, it came from a false belief, namely the smallest replacement by the truth that
//! changes the press. An order and the recipe of its dish are replaced together.

use rand::RngExt;
use tomcom_core::base::rng::{Stream, stream};
use tomcom_core::kitchen::{
    AspectId, AspectKind, ButtonId, Kitchen, LocationId, LocationKind, OrderContent, State, World,
};
use tomcom_core::mind::{AspectBelief, PressOrigin, RecordedBelief, WORTH_TELLING};

use super::beliefs::ParticipantBeliefs;
use super::decision::DecisionContext;
use super::simulated::SimulatedParticipant;
use super::{chance, normal, witness};

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
pub(crate) fn without_press(kitchen: &Kitchen, beliefs: &ParticipantBeliefs, state: State) -> RecordedBelief {
    let told = |id: AspectId| {
        let aspect = &kitchen.aspects[id.index()];
        let values = aspect.labels.iter().zip(beliefs.distribution(id)).filter(|(_, p)| **p >= WORTH_TELLING);
        AspectBelief {
            aspect: aspect.name.clone(),
            believes: aspect.labels[beliefs.most_likely(id)].clone(),
            p_truth: rounded(beliefs.p_truth(kitchen, state, id)),
            values: values.map(|(label, &p)| (label.clone(), rounded(p))).collect(),
        }
    };
    RecordedBelief {
        aspects: kitchen.aspect_ids().map(told).collect(),
        cause: "asked by a probe".to_string(),
        origin: None,
        targets: Vec::new(),
    }
}

pub(super) fn rounded(p: f64) -> f64 {
    (p * 1e6).round() / 1e6
}

#[derive(Clone, Debug, PartialEq)]
pub struct PressReason {
    pub origin: PressOrigin,
    pub cause: String,
    /// The state aspects whose replacement by the truth changes the decision.
    pub targets: Vec<AspectId>,
}

impl PressReason {
    pub fn slip(cause: String) -> PressReason {
        PressReason { origin: PressOrigin::Slip, cause, targets: Vec::new() }
    }

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
            for &aspect in target {
                world.set_value(kitchen, aspect, kitchen.true_value(truth.state, aspect));
            }
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
    let mut left: Vec<AspectId> = kitchen.aspect_ids().filter(is_wrong).collect();
    let mut targets = Vec::new();
    for location in kitchen.location_ids() {
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

fn code_of(kitchen: &Kitchen, world: &World, aspect: AspectId) -> u8 {
    match kitchen.aspects[aspect.index()].kind {
        AspectKind::Location(location) => world.state.code(location),
        AspectKind::Recipe(dish) => world.recipes.get(dish).0,
    }
}

/// Standard deviation of the logarithm of one participant's answering times.
const ANSWER_JITTER: f64 = 0.35;
/// Least probabilities of the most probable value from which the confidence in an answer is 2 or 3 (of 3).
const SURE_FROM: [f64; 2] = [2.0 / 3.0, 0.9];

impl SimulatedParticipant {
    pub fn believes(&self, state: State) -> RecordedBelief {
        witness::without_press(&self.kitchen, &self.beliefs, state)
    }

    /// Time from a probe's question to the participant's answer, in seconds.
    pub fn answers_after_s(&self, probe: u32, question: u32) -> f64 {
        self.person.answer_s * (ANSWER_JITTER * normal(&mut self.of_answer(probe, question))).exp()
    }

    /// The participant's answer to a question about a state aspect: one of the choices, or `None` for "I don't know".
    ///
    /// What is not among the choices is the last of them, which then stands for all else. If the true value is as
    /// probable as any other value, the participant answers the true value: so the answer is right where the belief is
    /// not false.
    pub fn answer(
        &self,
        state: State,
        aspect: AspectId,
        choices: &[String],
        (probe, question): (u32, u32),
    ) -> Option<String> {
        let mut random = self.of_answer(probe, question);
        let _time = normal(&mut random);
        let labels = &self.kitchen.aspects[aspect.index()].labels;
        let place = |value: usize| choices.iter().position(|choice| *choice == labels[value]);
        let choice_of = |value: usize| place(value).unwrap_or(choices.len().saturating_sub(1));
        let mut chances = vec![0.0; choices.len()];
        for (value, chance) in self.beliefs.distribution(aspect).iter().enumerate() {
            *chances.get_mut(choice_of(value))? += chance;
        }
        let (truth, likely) =
            (choice_of(self.kitchen.true_value(state, aspect)), choice_of(self.beliefs.most_likely(aspect)));
        let best = (0..choices.len()).fold(likely, |best, one| if chances[one] > chances[best] { one } else { best });
        let most_likely = witness::rounded(chances[best]);
        let believed = &choices[if witness::rounded(chances[truth]) >= most_likely { truth } else { best }];
        if chance(&mut random, self.person.answers_wrong) {
            let others: Vec<&String> = choices.iter().filter(|choice| *choice != believed).collect();
            return (!others.is_empty()).then(|| others[random.random_range(0..others.len())].clone());
        }
        (most_likely >= self.population.answers_from).then(|| believed.clone())
    }

    /// The participant's confidence in its answer about an aspect, from 1 to 3.
    pub fn confidence(&self, aspect: AspectId) -> u8 {
        match self.beliefs.certainty(aspect) {
            p if p < SURE_FROM[0] => 1,
            p if p < SURE_FROM[1] => 2,
            _ => 3,
        }
    }

    /// The order that the participant expects to be served next: the order on which the participant works.
    pub fn next_order(&self) -> Option<LocationId> {
        self.intent.order.map(|(order, _)| order)
    }

    /// The random stream of one answer, separate for each answer, so that no answer depends on which others were given.
    fn of_answer(&self, probe: u32, question: u32) -> Stream {
        stream(self.answer_seed, "participant's answers", u64::from(probe) << 8 | u64::from(question))
    }
}
