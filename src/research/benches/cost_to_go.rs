//! Speed of the cost to go on recorded work loads: what belief inference and communication planning ask of it at every
//! press of two recorded trials. Prints, per evaluation, the time with cache and tables included (`cargo bench`).

use std::path::Path;
use std::sync::Arc;
use std::time::{Duration, Instant};

use rand::RngExt;
use rand_distr::{Distribution, Gamma};
use tomcom_core::base::rng::{Stream, stream};
use tomcom_core::base::time::SessionTime;
use tomcom_core::kitchen::cost_to_go::{CostToGo, DecisionCosts, MAX_BUTTONS};
use tomcom_core::kitchen::{Agent, AspectKind, ButtonId, Kitchen, Recipes, State};
use tomcom_core::mind::RecordedBelief;
use tomcom_session::engine::SessionEngine;
use tomcom_session::files::{read_kitchen, read_session};
use tomcom_session::{Event, TrialPhase};

/// Belief samples a press, and states a sample: the least that counts as the algorithm.
const BELIEFS: usize = 256;
const STATES: usize = 32;
/// Precision of the Dirichlets of locations and of recipes, as in the human model.
const PRECISION: [f64; 2] = [10.0, 0.6];
/// Recorded trials a kitchen.
const TRIALS: u64 = 6;
/// Rollouts a press in the planning load, and human decisions a rollout.
const ROLLOUTS: usize = 32;
const HORIZON: usize = 8;

/// A moment before a press of the human: the truth, and what the participant believed.
struct Moment {
    state: State,
    belief: RecordedBelief,
}

/// The categorical distributions of one belief, by aspect.
type Belief = Vec<Vec<f64>>;

fn moments(layout: &str, trial: u64) -> (Arc<Kitchen>, Vec<Moment>) {
    let top = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    let kitchen = Arc::new(read_kitchen(&top.join(layout)).expect("the layout loads").kitchen);
    let mut spec = read_session(&top.join("sessions/default.toml"), None).expect("the default session").spec;
    spec.seed = 7;
    let mut engine = SessionEngine::new(kitchen.clone(), spec, trial, CostToGo::new(kitchen.clone()));
    let _ = engine.input(SessionTime::ZERO, Event::TrialStarted);
    let mut moments = Vec::new();
    while engine.session().phase == TrialPhase::Running {
        let state = engine.session().state;
        for stamped in engine.fire() {
            if let Event::ParticipantBelieves(belief) = stamped.event {
                moments.push(Moment { state, belief });
            }
        }
    }
    (kitchen, moments)
}

/// Draws a belief around what the participant believed: a Dirichlet for every aspect.
fn draw_belief(kitchen: &Kitchen, moment: &Moment, random: &mut Stream) -> Belief {
    let aspects = kitchen.aspects.iter().zip(&moment.belief.aspects);
    let one = |(aspect, held): (&tomcom_core::kitchen::StateAspect, &tomcom_core::mind::AspectBelief)| {
        let (truth, precision) = match aspect.kind {
            AspectKind::Location(location) => (moment.state.code(location), PRECISION[0]),
            AspectKind::Recipe(_) => (aspect.values[0], PRECISION[1]),
        };
        let count = aspect.values.len() as f64;
        let p_truth = held.p_truth.clamp(0.02, 0.98);
        let weight = |(&value, label): (&u8, &String)| {
            let mut mean = 0.1 * (1.0 - p_truth) / count;
            mean += if value == truth { p_truth } else { 0.0 };
            mean += if *label == held.believes { 0.9 * (1.0 - p_truth) } else { 0.0 };
            Gamma::new(precision * mean, 1.0).map_or(0.0, |gamma| gamma.sample(random))
        };
        aspect.values.iter().zip(&aspect.labels).map(weight).collect()
    };
    aspects.map(one).collect()
}

/// Draws a state and recipes from a belief.
fn draw_state(kitchen: &Kitchen, belief: &Belief, random: &mut Stream) -> (State, Recipes) {
    let mut state = State::default();
    let mut recipes = kitchen.true_recipes();
    for (aspect, weights) in kitchen.aspects.iter().zip(belief) {
        let mut rest = random.random::<f64>() * weights.iter().sum::<f64>();
        let reached = weights.iter().position(|weight| {
            rest -= weight;
            rest <= 0.0
        });
        let value = aspect.values[reached.unwrap_or(0)];
        match aspect.kind {
            AspectKind::Location(location) => state.set_code(location, value),
            AspectKind::Recipe(dish) => recipes.set(dish, tomcom_core::kitchen::ContentId(value)),
        }
    }
    (state, recipes)
}

/// Sums over a load.
#[derive(Default)]
struct Tally {
    /// Costs to go of the state of a decision, and of every state that an effective press leads to.
    evaluations: u64,
    time: Duration,
    /// The sum of all costs, so that nothing is left out.
    sum: u64,
}

impl Tally {
    /// One decision of an agent: counts the evaluations behind it.
    fn decide(
        &mut self,
        kitchen: &Kitchen,
        cost: &mut CostToGo,
        state: State,
        recipes: &Recipes,
        agent: Agent,
    ) -> DecisionCosts {
        let decision = cost.decision(state, recipes, agent);
        let buttons = kitchen.buttons[agent.index()].len();
        self.sum += decision.after[..buttons].iter().map(|&cost| u64::from(cost)).sum::<u64>();
        decision
    }
}

/// How many buttons of the agent have an effect in a state.
fn effective(kitchen: &Kitchen, state: State, recipes: &Recipes, agent: Agent) -> u64 {
    let buttons = (0..kitchen.buttons[agent.index()].len()).map(|button| ButtonId(button as u8));
    buttons.filter(|&button| kitchen.press(state, recipes, agent, button).is_some()).count() as u64
}

/// What inference asks for at a press: the costs of all decisions under the sampled beliefs.
fn inference(kitchen: &Kitchen, moment: &Moment, cost: &mut CostToGo, random: &mut Stream, tally: &mut Tally) {
    let mut states = Vec::with_capacity(BELIEFS * STATES);
    for _ in 0..BELIEFS {
        let belief = draw_belief(kitchen, moment, random);
        states.extend((0..STATES).map(|_| draw_state(kitchen, &belief, random)));
    }
    let begun = Instant::now();
    for (state, recipes) in &states {
        tally.decide(kitchen, cost, *state, recipes, Agent::Human);
    }
    tally.time += begun.elapsed();
    tally.evaluations +=
        states.iter().map(|(state, recipes)| 1 + effective(kitchen, *state, recipes, Agent::Human)).sum::<u64>();
}

/// What planning asks for at a press: rollouts in which the human does what is best on average over the states drawn from a
/// belief, and the robot what its policy says.
fn planning(kitchen: &Kitchen, moment: &Moment, cost: &mut CostToGo, random: &mut Stream, tally: &mut Tally) {
    let truth = kitchen.true_recipes();
    for _ in 0..ROLLOUTS {
        let belief = draw_belief(kitchen, moment, random);
        let mut here = moment.state;
        for _ in 0..HORIZON {
            let states: Vec<_> = (0..STATES).map(|_| draw_state(kitchen, &belief, random)).collect();
            let begun = Instant::now();
            let mut sums = [0u32; MAX_BUTTONS];
            for (state, recipes) in &states {
                let decision = tally.decide(kitchen, cost, *state, recipes, Agent::Human);
                sums.iter_mut().zip(&decision.after).for_each(|(sum, &after)| *sum += u32::from(after));
            }
            let buttons = kitchen.buttons[Agent::Human.index()].len();
            let best = (0..buttons).min_by_key(|&button| sums[button]).unwrap_or(0);
            here = kitchen.press(here, &truth, Agent::Human, ButtonId(best as u8)).unwrap_or(here);
            let decision = tally.decide(kitchen, cost, here, &truth, Agent::Robot);
            let robots = (0..kitchen.buttons[Agent::Robot.index()].len()).min_by_key(|&button| decision.after[button]);
            tally.time += begun.elapsed();
            tally.evaluations += states
                .iter()
                .map(|(state, recipes)| 1 + effective(kitchen, *state, recipes, Agent::Human))
                .sum::<u64>();
            tally.evaluations += 1 + effective(kitchen, here, &truth, Agent::Robot);
            let press = robots.map(|button| ButtonId(button as u8));
            here = press.and_then(|press| kitchen.press(here, &truth, Agent::Robot, press)).unwrap_or(here);
        }
    }
}

fn main() {
    for layout in ["layouts/sushi.toml", "layouts/burger.toml"] {
        // Time and evaluations of inference and of planning, over all trials.
        let mut totals = [(0.0, 0), (0.0, 0)];
        for trial in 0..TRIALS {
            let (kitchen, moments) = moments(layout, trial);
            let begun = Instant::now();
            let mut cost = CostToGo::new(kitchen.clone());
            // In a session both go on at every press and share what was computed before.
            let mut loads = [Tally { time: begun.elapsed(), ..Tally::default() }, Tally::default()];
            let mut random = stream(1, "work load", trial);
            for moment in &moments {
                inference(&kitchen, moment, &mut cost, &mut random, &mut loads[0]);
                planning(&kitchen, moment, &mut cost, &mut random, &mut loads[1]);
            }
            for ((tally, total), load) in loads.iter().zip(&mut totals).zip(["inference", "planning"]) {
                let nanos = tally.time.as_nanos() as f64;
                println!(
                    "{layout} trial {trial}, {load}: {:.1} ns an evaluation, {} presses, {} evaluations a press, sum {}",
                    nanos / tally.evaluations as f64,
                    moments.len(),
                    tally.evaluations / moments.len() as u64,
                    tally.sum
                );
                *total = (total.0 + nanos, total.1 + tally.evaluations);
            }
            println!("  {} decisions were in no cache", cost.decisions_missed());
        }
        for ((nanos, evaluations), load) in totals.iter().zip(["inference", "planning"]) {
            println!("{layout} in all, {load}: {:.1} ns an evaluation", nanos / *evaluations as f64);
        }
    }
}
