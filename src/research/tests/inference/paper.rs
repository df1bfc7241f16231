//! The model `paper-2021` against the paper's equations, computed here in another way, on the tiny kitchen: by quadrature over
//! beliefs, with nothing of filter and planner but the rules, the robot's policy and the cost to go.

use std::sync::Arc;

use tomcom_core::base::time::SessionTime;
use tomcom_core::communication::Signal;
use tomcom_core::communication::concept::{Concept, DecisionPoint};
use tomcom_core::communication::planner::Planner;
use tomcom_core::communication::settings::AssistantSpec;
use tomcom_core::communication::concept::{RobotIntent, Situation};
use tomcom_core::gaze::GazeSample;
use tomcom_core::kitchen::cost_to_go::{CostToGo, Fidelity};
use tomcom_core::kitchen::{Agent, AspectId, ButtonId, DishId, Kitchen, OrderContent, Recipes, State};
use tomcom_core::mind::dirichlet::{Dirichlet, DirichletBelief, LEAST_MEAN};
use tomcom_core::mind::filter::BeliefFilter;
use tomcom_core::mind::model::HumanModel;
use tomcom_core::mind::model::PAPER_2021;
use tomcom_core::mind::observation::{Observation, ObservedEvidence};
use tomcom_core::robot::policy;

use super::grid::quadrature;
use crate::files::load;

/// Points along each share of a belief.
const POINTS: usize = 160;
/// Agreement where there are closed forms.
const CLOSED: f64 = 1e-9;

/// The tiny kitchen with an order for ham bread, whose human follows the model of the paper.
struct PaperBench {
    kitchen: Arc<Kitchen>,
    cost: CostToGo,
    filter: BeliefFilter,
    state: State,
}

impl PaperBench {
    fn new(model: HumanModel) -> PaperBench {
        let kitchen = Arc::new(load("tests/kitchens/tiny.toml"));
        let mut state = kitchen.empty_state();
        state.set_order(kitchen.orders[0], OrderContent::Dish(DishId(0)));
        let filter = BeliefFilter::new(kitchen.clone(), model, 1);
        let mut bench = PaperBench { cost: CostToGo::new(kitchen.clone()), kitchen, filter, state };
        bench.observe(0.0, ObservedEvidence::Started { state });
        bench
    }

    fn observe(&mut self, seconds: f64, what: ObservedEvidence) {
        let time = SessionTime::from_secs_f64(seconds);
        self.filter.observe(&Observation { time, what }, &mut self.cost);
    }

    fn aspect(&self, name: &str) -> AspectId {
        let index = self.kitchen.aspects.iter().position(|aspect| aspect.name == name);
        AspectId(index.unwrap_or_else(|| panic!("no aspect {name}")) as u8)
    }

    fn of(&self, name: &str) -> Dirichlet {
        self.filter.belief().aspect(self.aspect(name)).clone()
    }

    /// A gaze sample at the middle of a location.
    fn sample(&mut self, seconds: f64, name: &str) {
        let location = self.kitchen.location_named(name).expect("a location");
        let [x, y] = self.kitchen.location(location).display.centre();
        let sample = GazeSample { x, y, confidence: 1.0, device_ns: None, taken_ns: None };
        self.observe(seconds, ObservedEvidence::Gaze { sample, taken: SessionTime::from_secs_f64(seconds) });
    }
}

/// Points of a Dirichlet with weights: its stick is broken into independent Beta shares, each with its own quadrature.
fn points_of(dirichlet: &Dirichlet) -> Vec<(Vec<f64>, f64)> {
    let alphas: Vec<f64> = (0..dirichlet.mean().len()).map(|value| dirichlet.alpha(value)).collect();
    let mut points = vec![(Vec::new(), 1.0, 1.0)];
    for value in 0..alphas.len() - 1 {
        let rest: f64 = alphas[value + 1..].iter().sum();
        let shares = quadrature(alphas[value], rest, POINTS);
        let broken = |(before, left, weight): &(Vec<f64>, f64, f64)| {
            let each = |&(share, p): &(f64, f64)| {
                ([before.as_slice(), &[left * share]].concat(), left * (1.0 - share), weight * p)
            };
            shares.iter().map(each).collect::<Vec<_>>()
        };
        points = points.iter().flat_map(broken).collect();
    }
    points.into_iter().map(|(before, left, weight)| ([before, vec![left]].concat(), weight)).collect()
}

/// O_H(s, o) = p(o | s) of the model: the true value, one that looks like it, any other.
fn observed(kitchen: &Kitchen, location: usize, model: &HumanModel) -> Vec<Vec<f64>> {
    let aspect = &kitchen.aspects[location];
    let alike = |a: usize, b: usize| {
        let codes = kitchen.look_alike_codes(tomcom_core::kitchen::LocationId(location as u8), aspect.values[a]);
        codes.contains(&aspect.values[b])
    };
    let values = aspect.values.len();
    let row = |truth: usize| {
        let looks: Vec<bool> = (0..values).map(|other| other != truth && alike(truth, other)).collect();
        let count = looks.iter().filter(|looks| **looks).count();
        let (to_alike, to_other) = (
            if count > 0 { model.perception.look_alike } else { 0.0 },
            if values - 1 > count { model.perception.anything } else { 0.0 },
        );
        (0..values)
            .map(|other| match () {
                () if other == truth => 1.0 - to_alike - to_other,
                () if looks[other] => to_alike / count as f64,
                () => to_other / (values - 1 - count) as f64,
            })
            .collect()
    };
    (0..values).map(row).collect()
}

/// Equation (1): p(s | o) ~ p(o | s) p(s), for an observer who knows s and not o, by quadrature over beliefs.
#[test]
fn each_gaze_sample_updates_beliefs_by_bayes_rule() {
    let mut bench = PaperBench::new(PAPER_2021);
    let plate = bench.kitchen.plate;
    let aspect = AspectId::of_location(plate);
    let probabilities = observed(&bench.kitchen, plate.index(), &PAPER_2021);
    let truth = bench.kitchen.true_value(bench.state, aspect);
    for sample in 1..=3 {
        let before = bench.filter.belief().aspect(aspect).clone();
        let (mut mean, mut second) = (vec![0.0; before.mean().len()], 0.0);
        for (belief, weight) in points_of(&before) {
            for (seen, p) in probabilities[truth].iter().enumerate() {
                let joint: Vec<f64> = belief.iter().zip(&probabilities).map(|(b, row)| b * row[seen]).collect();
                let total: f64 = joint.iter().sum();
                for (mean, joint) in mean.iter_mut().zip(&joint) {
                    *mean += weight * p * joint / total;
                    second += weight * p * (joint / total).powi(2);
                }
            }
        }
        bench.sample(1.0 + 0.02 * f64::from(sample), "plate");
        let after = bench.filter.belief().aspect(aspect);
        let (p_truth, precision) = (after.mean()[truth], after.precision());
        println!("sample {sample}: P(truth) {p_truth:.6}, precision {precision:.4}");
        let apart = after.mean().iter().zip(&mean).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        assert!(apart < CLOSED, "sample {sample}: the means are {apart:e} apart");
        assert!((after.second() - second).abs() < CLOSED, "sample {sample}: {} and {second}", after.second());
    }
    assert!(bench.of("plate").mean()[truth] > 0.95, "what is looked at is known");
}

#[test]
fn outside_of_the_radius_and_without_gaze_nothing_is_perceived_and_nothing_is_forgotten() {
    let mut bench = PaperBench::new(PAPER_2021);
    let before = bench.filter.belief().clone();
    bench.sample(1.0, "plate");
    for (name, is_seen) in [("plate", true), ("board", false), ("robot_hand", false), ("recipe of ham bread", false)] {
        let apart = (bench.of(name).mean()[0] - before.aspect(bench.aspect(name)).mean()[0]).abs();
        assert_eq!(apart > CLOSED, is_seen, "{name} changes by {apart:e}");
    }
    let seen = bench.filter.belief().clone();
    let later = bench.filter.at(SessionTime::from_secs_f64(900.0), &mut bench.cost);
    for (index, (seen, later)) in seen.aspects.iter().zip(&later.aspects).enumerate() {
        let apart = seen.mean().iter().zip(later.mean()).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        assert!(apart < CLOSED && (seen.second() - later.second()).abs() < CLOSED, "aspect {index}: {apart:e}");
    }
}

/// Whoever looks at a place for long is certain of it, and no press and no change after that makes an infinite number.
#[test]
fn many_equal_samples_leave_likelihoods_finite() {
    let mut bench = PaperBench::new(PAPER_2021);
    for sample in 0..6000 {
        bench.sample(1.0 + 0.005 * f64::from(sample), ["plate", "board", "robot_hand"][sample as usize / 2000]);
    }
    for (number, button) in bench.kitchen.clone().buttons[Agent::Human.index()].iter().enumerate() {
        let press = bench.kitchen.try_press(bench.state, Agent::Human, ButtonId(number as u8));
        bench.observe(40.0 + number as f64, ObservedEvidence::Pressed(press));
        let log_p = bench.filter.evidence().expect("a press").log_p;
        println!("{}: {log_p}", button.name);
        assert!(log_p.is_finite(), "{}: {log_p}", button.name);
    }
    for (index, of) in bench.filter.belief().aspects.iter().enumerate() {
        let is_proper = of.mean().iter().all(|m| m.is_finite() && *m > 0.0) && of.precision().is_finite();
        assert!(is_proper, "aspect {index}: {of:?}");
    }
}

#[test]
fn a_signal_makes_its_aspects_certain_at_once() {
    let mut bench = PaperBench::new(PAPER_2021);
    let before = bench.filter.belief().clone();
    bench.observe(1.0, ObservedEvidence::Told { location: bench.kitchen.orders[0] });
    for name in ["order", "recipe of ham bread"] {
        let (aspect, after) = (bench.aspect(name), bench.of(name));
        let truth = bench.kitchen.true_value(bench.state, aspect);
        // Every other value keeps the least probability that values have.
        let certain = 1.0 / (1.0 + (after.mean().len() - 1) as f64 * LEAST_MEAN);
        assert!((after.mean()[truth] - certain).abs() < CLOSED, "{name}: {}", after.mean()[truth]);
    }
    let (board, other) = (bench.aspect("board"), bench.of("board"));
    assert_eq!(&other, before.aspect(board), "nothing else changes");
}

/// The model of the paper, with places that are all but certain and a recipe that may be another one.
fn unsure_of_the_recipe() -> HumanModel {
    let mut model = PAPER_2021;
    (model.prior.location_truth, model.prior.location_precision) = (1.0 - 1e-9, 1e4);
    (model.prior.recipe_truth, model.prior.recipe_precision) = (0.6, 1.5);
    (model.inference.beliefs, model.inference.max_beliefs) = (4096, 4096);
    (model.inference.states, model.inference.predictions) = (256, 1024);
    model
}

/// What the human expects of each button, and of waiting, where the recipe of the ordered dish is the true one with this
/// probability: E_b[C(s')] by button, and E_b[C(s)].
struct ExpectedCosts {
    of_versions: Vec<(Vec<f64>, f64)>,
}

impl ExpectedCosts {
    fn new(bench: &mut PaperBench) -> ExpectedCosts {
        let (kitchen, state) = (bench.kitchen.clone(), bench.state);
        let buttons = kitchen.buttons[Agent::Human.index()].len();
        let of_version = |&version: &_| {
            let mut recipes: Recipes = kitchen.true_recipes();
            recipes.set(DishId(0), version);
            let decision = bench.cost.decision(state, &recipes, Agent::Human);
            let after = decision.after[..buttons].iter().map(|&after| f64::from(after)).collect();
            (after, f64::from(decision.here))
        };
        ExpectedCosts { of_versions: kitchen.dish(DishId(0)).variants.iter().map(of_version).collect() }
    }

    fn expected(&self, belief: &[f64]) -> (Vec<f64>, f64) {
        let buttons = self.of_versions[0].0.len();
        let after = |button: usize| belief.iter().zip(&self.of_versions).map(|(b, (after, _))| b * after[button]).sum();
        let here = belief.iter().zip(&self.of_versions).map(|(b, (_, here))| b * here).sum();
        ((0..buttons).map(after).collect(), here)
    }

    /// Equation (3): p(a | b) ~ exp(tau Q(b, a)) of every button, with Q(b, a) = -E_b[1 + C(s')]; given a press.
    fn press(&self, belief: &[f64]) -> Vec<f64> {
        let weights: Vec<f64> =
            self.expected(belief).0.iter().map(|after| (-PAPER_2021.decision.tau * (1.0 + after)).exp()).collect();
        let total: f64 = weights.iter().sum();
        weights.iter().map(|weight| weight / total).collect()
    }
}

/// p(b | a) ~ p(a | b) p(b), with equation (3), by quadrature over beliefs about the recipe.
#[test]
fn a_press_is_evidence_of_beliefs_by_the_softmax() {
    for button in ["take ham", "take salami"] {
        let mut bench = PaperBench::new(unsure_of_the_recipe());
        let costs = ExpectedCosts::new(&mut bench);
        let pressed = bench.kitchen.button_named(Agent::Human, button).expect("a button");
        let (mut evidence, mut mean, mut second) = (0.0, 0.0, 0.0);
        for (belief, weight) in points_of(&bench.of("recipe of ham bread")) {
            let joint = weight * costs.press(&belief)[pressed.index()];
            evidence += joint;
            mean += joint * belief[0];
            second += joint * belief.iter().map(|b| b * b).sum::<f64>();
        }
        (mean, second) = (mean / evidence, second / evidence);
        let press = bench.kitchen.try_press(bench.state, Agent::Human, pressed);
        bench.observe(1.0, ObservedEvidence::Pressed(press));
        let (after, log_p) = (bench.of("recipe of ham bread"), bench.filter.evidence().expect("a press").log_p);
        println!(
            "{button}: P(truth) {:.4} (exact {mean:.4}), second moment {:.4} ({second:.4}), ln p {log_p:.4} ({:.4})",
            after.mean()[0],
            after.second(),
            evidence.ln()
        );
        assert!((after.mean()[0] - mean).abs() < 0.015 && (after.second() - second).abs() < 0.015);
        assert!((log_p - evidence.ln()).abs() < 0.05);
    }
}

/// All worlds of a belief (contents of the locations, and recipes) with their probabilities.
fn worlds_of(kitchen: &Kitchen, belief: &DirichletBelief) -> Vec<(State, Recipes, f64)> {
    let mut worlds = vec![(kitchen.empty_state(), kitchen.true_recipes(), 1.0)];
    for (index, of) in belief.aspects.iter().enumerate() {
        let with = |(state, recipes, p): &(State, Recipes, f64), value: usize| {
            let (mut state, mut recipes) = (*state, *recipes);
            kitchen.set_value(&mut state, &mut recipes, AspectId(index as u8), value);
            (state, recipes, p * of.mean()[value])
        };
        worlds = worlds.iter().flat_map(|world| (0..of.mean().len()).map(move |value| with(world, value))).collect();
    }
    worlds
}

/// Equation (2): the robot's press is part of the transition, T(s, s') = sum over its presses of p(s' | s, a_R) p(a_R), from
/// every state that the human believes in.
#[test]
fn the_robots_press_moves_beliefs_by_its_policy() {
    let mut model = PAPER_2021;
    model.inference.predictions = 2048;
    let mut bench = PaperBench::new(model);
    let (kitchen, before) = (bench.kitchen.clone(), bench.filter.belief().clone());
    let hand = bench.aspect("robot_hand");
    let values = before.aspect(hand).mean().len();
    // From each content of the robot's hand to each.
    let mut kernel = vec![vec![0.0; values]; values];
    for (state, recipes, p) in worlds_of(&kitchen, &before).into_iter().filter(|(_, _, p)| *p > 1e-6) {
        let choices = policy::choices(&kitchen, &mut bench.cost, Fidelity::Searched, state, &recipes);
        let next = |&button: &ButtonId| kitchen.press(state, &recipes, Agent::Robot, button).unwrap_or(state);
        let after: Vec<State> = if choices.is_empty() { vec![state] } else { choices.iter().map(next).collect() };
        for next in &after {
            kernel[kitchen.true_value(state, hand)][kitchen.true_value(*next, hand)] += p / after.len() as f64;
        }
    }
    for row in &mut kernel {
        let total: f64 = row.iter().sum();
        row.iter_mut().for_each(|p| *p /= total);
    }
    // b' = b T for a belief b from the Dirichlet, with E[b_v b_u] = (A m_v m_u + [v = u] m_v) / (A + 1).
    let (m, precision) = (before.aspect(hand).mean(), before.aspect(hand).precision());
    let mean: Vec<f64> = (0..values).map(|to| (0..values).map(|from| m[from] * kernel[from][to]).sum()).collect();
    let mut second = 0.0;
    for (to, (one, other)) in
        (0..values).flat_map(|to| (0..values * values).map(move |k| (to, (k / values, k % values))))
    {
        let own = if one == other { m[one] } else { 0.0 };
        second += kernel[one][to] * kernel[other][to] * (precision * m[one] * m[other] + own) / (precision + 1.0);
    }
    let take = kitchen.button_named(Agent::Robot, "take bread").expect("a button");
    let press = kitchen.try_press(bench.state, Agent::Robot, take);
    bench.observe(1.0, ObservedEvidence::Pressed(press));
    let after = bench.of("robot_hand");
    println!("the robot's hand: {:.4?}, exact {mean:.4?}; {:.4}, exact {second:.4}", after.mean(), after.second());
    let apart = after.mean().iter().zip(&mean).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
    assert!(apart < 0.03 && (after.second() - second).abs() < 0.03, "{apart}");
}

/// The communication POMDP over one decision of the human: what a signal saves is the difference of the expected presses and
/// costs to go, with and without it.
#[test]
fn the_benefit_of_a_signal_is_what_better_decisions_save() {
    let model = unsure_of_the_recipe();
    let mut bench = PaperBench::new(model.clone());
    let costs = ExpectedCosts::new(&mut bench);
    let truth = vec![1.0, 0.0];
    // The presses made, and the cost to go after them in truth; the human can also wait, which counts as a press.
    let value = |belief: &[f64]| {
        let ((after, here), tau) = (costs.expected(belief), model.decision.tau);
        let (truly, truly_here) = costs.expected(&truth);
        let wait = (-tau * (here + model.decision.wait_cost)).exp();
        let presses: Vec<f64> = after.iter().map(|after| (-tau * (1.0 + after)).exp()).collect();
        let total: f64 = wait + presses.iter().sum::<f64>();
        let pressed: f64 = presses.iter().zip(&truly).map(|(weight, after)| weight * (1.0 + after)).sum();
        (wait * (1.0 + truly_here) + pressed) / total
    };
    let mut belief = DirichletBelief::prior(&bench.kitchen, &model.prior, bench.state);
    for (index, of) in belief.aspects.iter_mut().enumerate().take(bench.kitchen.locations.len()) {
        let mut certain = vec![0.0; of.mean().len()];
        certain[bench.kitchen.true_value(bench.state, AspectId(index as u8))] = 1.0;
        *of = Dirichlet::of_moments(certain, 1.0);
    }
    let recipe = bench.aspect("recipe of ham bread");
    let silent: f64 = points_of(belief.aspect(recipe)).iter().map(|(belief, weight)| weight * value(belief)).sum();
    let exact = silent - value(&truth);
    let mut spec = AssistantSpec::default();
    (spec.rollout.horizon, spec.rollout.rollouts, spec.rollout.least_rollouts) = (1, 8192, 8192);
    (spec.rollout.states, spec.rollout.looks_hz) = (128, Some(0.0));
    (spec.rollout.other_looks_hz, spec.rollout.capture) = (Some(0.0), Some(0.0));
    let mut planner = Planner::new(bench.kitchen.clone(), &model, spec, 1);
    let signals = [Signal::ShowRecipe("order".to_string())];
    let situation = Situation { robot: RobotIntent::Still, ..Situation::new(bench.state, &belief) };
    let moment =
        DecisionPoint { seq: 0, time: SessionTime::ZERO, presses: 0, situation, signals: &signals, error: None };
    let found = planner.advise(&mut bench.cost, &moment).options[0].clone();
    println!("benefit {:.4} ± {:.4}, exact {exact:.4}", found.benefit, found.standard_error);
    assert!(exact > 0.1, "the signal saves something: {exact}");
    assert!((found.benefit - exact).abs() < 4.0 * found.standard_error + 0.02, "{} and {exact}", found.benefit);
}
