//! The update of the estimate by a robot's press: the human notices that the robot pressed a button, but not which one.
//!
//! Worlds are drawn from the estimate. For each world, the robot's task policy gives the possible presses and the rules
//! give their results. This defines a transition kernel T over the values of every aspect. The belief b becomes b T;
//! its mean is m T and, since b is Dirichlet with precision A, S' = (A sum_w m'_w^2 + sum_v m_v sum_w T_vw^2) / (A +
//! 1). Values that no press changes are not affected.

use super::draws::PolyaUrn;
use crate::base::rng::Stream;
use crate::kitchen::cost_to_go::{CostToGo, Fidelity};
use crate::kitchen::{Agent, AspectId, AspectKind, Kitchen, LocationId, State, WeightedWorld, WeightedWorlds, World};
use crate::mind::dirichlet::{Dirichlet, DirichletBelief};
use crate::robot::policy;

/// Share of the draws below which a world's costs to go are computed by lower bounds instead of plans.
const COUNTS: f64 = 0.05;

/// One transition of an aspect's value to another value, with the weight of the transition.
#[derive(Clone, Copy, Debug)]
struct Flow {
    aspect: usize,
    from: usize,
    to: usize,
    weight: f64,
}

/// Updates the belief by a press of the robot whose consequences the human infers with probability `foresight`.
pub fn predict(
    kitchen: &Kitchen,
    cost: &mut CostToGo,
    belief: &mut DirichletBelief,
    draws: usize,
    foresight: f64,
    random: &mut Stream,
) {
    let drawn = draw(kitchen, belief, draws, random);
    let locations = kitchen.locations.len();
    let mut flows: Vec<Flow> = Vec::new();
    let mut occurred: Vec<Vec<f64>> =
        kitchen.aspects[..locations].iter().map(|aspect| vec![0.0; aspect.values.len()]).collect();
    for WeightedWorld { world: World { state, recipes }, weight: count } in drawn.all {
        for (index, occurred) in occurred.iter_mut().enumerate() {
            if let Some(value) = kitchen.aspects[index].index_of(state.code(LocationId(index as u8))) {
                occurred[value] += count;
            }
        }
        let fidelity = if count >= COUNTS * draws as f64 { Fidelity::PlanBound } else { Fidelity::LowerBound };
        let choices = policy::choices(kitchen, cost, fidelity, state, &recipes);
        let weight = count / choices.len().max(1) as f64;
        for next in choices.iter().filter_map(|&button| kitchen.press(state, &recipes, Agent::Robot, button)) {
            note_changes(kitchen, state, next, weight, &mut flows);
        }
    }
    for (index, occurred) in occurred.iter().enumerate() {
        let of_aspect: Vec<Flow> = flows.iter().copied().filter(|flow| flow.aspect == index).collect();
        if !of_aspect.is_empty() {
            let moved = moved(&belief.aspects[index], &of_aspect, occurred);
            belief.aspects[index].mix(foresight, &moved);
        }
    }
}

fn note_changes(kitchen: &Kitchen, before: State, after: State, weight: f64, flows: &mut Vec<Flow>) {
    for location in kitchen.changed(before, after) {
        let index = location.index();
        let [from, to] = [before, after].map(|state| kitchen.aspects[index].index_of(state.code(location)));
        let (Some(from), Some(to)) = (from, to) else { continue };
        match flows.iter_mut().find(|flow| flow.aspect == index && flow.from == from && flow.to == to) {
            Some(flow) => flow.weight += weight,
            None => flows.push(Flow { aspect: index, from, to, weight }),
        }
    }
}

/// The estimate of an aspect after applying the transition kernel, which is given by the transitions `flows` and by how
/// often each value was drawn.
fn moved(dirichlet: &Dirichlet, flows: &[Flow], occurred: &[f64]) -> Dirichlet {
    let (old, precision) = (dirichlet.mean(), dirichlet.precision());
    let mut mean = old.to_vec();
    // For each value: the probability of staying, and the sum over target values of T^2.
    let mut stays = vec![1.0; old.len()];
    let mut squares = vec![0.0; old.len()];
    for flow in flows {
        let share = flow.weight / occurred[flow.from];
        mean[flow.from] -= share * old[flow.from];
        mean[flow.to] += share * old[flow.from];
        stays[flow.from] -= share;
        squares[flow.from] += share * share;
    }
    let square: f64 = mean.iter().map(|m| m * m).sum();
    let spread: f64 =
        old.iter().zip(stays.iter().zip(&squares)).map(|(m, (stay, rest))| m * (stay * stay + rest)).sum();
    Dirichlet::of_moments(mean, (precision * square + spread) / (precision + 1.0))
}

/// Worlds drawn from the expected belief by stratified sampling; the weight of a world is its number of draws.
fn draw(kitchen: &Kitchen, belief: &DirichletBelief, draws: usize, random: &mut Stream) -> WeightedWorlds {
    let mut worlds = vec![World::empty(kitchen); draws];
    let mut values = vec![0; draws];
    let mut urn = PolyaUrn::default();
    for (index, dirichlet) in belief.aspects.iter().enumerate() {
        urn.fill(dirichlet, 1, random);
        urn.first_draws(random, &mut values);
        for (world, &value) in worlds.iter_mut().zip(&values) {
            let is_open = match kitchen.aspects[index].kind {
                AspectKind::Location(_) => true,
                AspectKind::Recipe(dish) => kitchen.wanted(world.state).any(|(_, wanted)| wanted == dish),
            };
            if is_open {
                world.set_value(kitchen, AspectId(index as u8), usize::from(value));
            }
        }
    }
    worlds.sort_unstable();
    let mut together = WeightedWorlds::default();
    for world in worlds {
        match together.all.last_mut() {
            Some(last) if last.world == world => last.weight += 1.0,
            _ => together.all.push(WeightedWorld { world, weight: 1.0 }),
        }
    }
    together
}
