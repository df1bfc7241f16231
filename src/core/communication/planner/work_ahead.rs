//! Working ahead between two requests for advice, so that the next answer comes sooner.
//!
//! After a press the planner's caches lack what the new situation needs, and filling them takes most of the time of a
//! late answer. Seconds pass between presses, so the planner runs the rollouts of the likeliest next situations in
//! advance and drops their results. The caches keep costs to go, decisions and choices of the robot, which do not
//! depend on the gaze and on time. The answer itself is still computed after the event, from the situation then: the
//! answer is the same with and without working ahead.

use super::Planner;
use super::rollout::choice_weights;
use super::sample::QuasiRandomLattice;
use crate::base::rng::stream;
use crate::communication::concept::{DecisionPoint, RobotIntent, Situation};
use crate::kitchen::cost_to_go::{CostToGo, MAX_BUTTONS};
use crate::kitchen::{Agent, AspectId, ButtonId, DishId, Kitchen, LocationId, OrderContent, State, WeightedWorlds};
use crate::mind::choice::HumanChoice;
use crate::mind::dirichlet::DirichletBelief;

/// Number of belief samples that say which presses of the human are likely.
const SAMPLES: usize = 32;
/// Largest number of the human's presses for which the planner prepares.
const PRESSES: usize = 4;
/// Least share of the belief samples in which the human must choose a press for the planner to prepare for that press.
const LEAST_SHARE: f64 = 0.05;

/// A situation that may come next.
struct NextSituation {
    state: State,
    belief: DirichletBelief,
    changed: Vec<AspectId>,
    robot: RobotIntent,
    presses: u32,
}

impl Planner {
    /// Runs the rollouts of the situations after the robot's ongoing press, after the human's likeliest presses, and
    /// with any new order where there is no order.
    pub(super) fn prepare_for_presses(
        &mut self,
        cost: &mut CostToGo,
        moment: &DecisionPoint,
        proceed: &(dyn Fn() -> bool + Sync),
    ) {
        let presses = self.likely_presses(cost, moment, proceed).into_iter();
        let after_presses = presses.filter_map(|button| self.after_the_human(moment, button));
        let nexts = self.after_the_robot(moment).into_iter().chain(after_presses).chain(self.with_new_orders(moment));
        for next in nexts.collect::<Vec<NextSituation>>() {
            if !proceed() {
                return;
            }
            let NextSituation { state, ref belief, ref changed, robot, presses } = next;
            let situation = Situation { state, belief, changed, robot, ..moment.situation };
            let next = DecisionPoint { situation, presses, ..*moment };
            let candidates = self.candidates(&next, |_| f64::NEG_INFINITY);
            self.compared(cost, &next, candidates, proceed);
        }
    }

    fn likely_presses(
        &mut self,
        cost: &mut CostToGo,
        moment: &DecisionPoint,
        proceed: &(dyn Fn() -> bool + Sync),
    ) -> Vec<ButtonId> {
        let mut random = stream(self.seed, "work-ahead", u64::from(moment.presses));
        let mut counts = [0usize; MAX_BUTTONS];
        self.samples.prepare(moment.situation.belief, SAMPLES, self.spec.rollout.states, &mut random);
        let lattice = QuasiRandomLattice::shifted(&mut random);
        let mut believed = WeightedWorlds::default();
        for number in 0..SAMPLES {
            if !proceed() {
                return Vec::new();
            }
            self.samples.draw(&self.kitchen, moment.situation.state, number, &mut random, &mut believed);
            let weights = choice_weights(&self.choice, cost, &believed);
            let [draw, ..] = lattice.point(number);
            if let HumanChoice::Press(button) = self.choice.intended(&weights, draw) {
                counts[button.index()] += 1;
            }
        }
        let likely = |button: &usize| counts[*button] as f64 >= LEAST_SHARE * SAMPLES as f64;
        let mut buttons: Vec<usize> = (0..MAX_BUTTONS).filter(likely).collect();
        buttons.sort_by_key(|&button| std::cmp::Reverse(counts[button]));
        buttons.into_iter().take(PRESSES).map(|button| ButtonId(button as u8)).collect()
    }

    /// The situation after the robot's ongoing press, which the human has not seen yet.
    fn after_the_robot(&self, moment: &DecisionPoint) -> Option<NextSituation> {
        let situation = &moment.situation;
        let RobotIntent::Busy { button, .. } = situation.robot else { return None };
        let state = self.kitchen.press(situation.state, &self.kitchen.true_recipes(), Agent::Robot, button)?;
        Some(NextSituation {
            changed: self.kitchen.changed(situation.state, state).map(AspectId::of_location).collect(),
            robot: RobotIntent::Free,
            presses: moment.presses + 1,
            ..unchanged(state, moment)
        })
    }

    fn after_the_human(&self, moment: &DecisionPoint, button: ButtonId) -> Option<NextSituation> {
        let before = moment.situation.state;
        let state = self.kitchen.press(before, &self.kitchen.true_recipes(), Agent::Human, button)?;
        let mut next = NextSituation { presses: moment.presses + 1, ..unchanged(state, moment) };
        for location in self.kitchen.changed(before, state) {
            make_certain(&self.kitchen, &mut next.belief, AspectId::of_location(location), state);
        }
        Some(next)
    }

    fn with_new_orders(&self, moment: &DecisionPoint) -> impl Iterator<Item = NextSituation> {
        let before = moment.situation.state;
        let is_empty = move |order: &&LocationId| !matches!(before.order(**order), OrderContent::Dish(_));
        let dishes = self.kitchen.dishes.len() as u8;
        let with = move |order: LocationId, dish: u8| {
            let mut state = before;
            state.set_order(order, OrderContent::Dish(DishId(dish)));
            NextSituation { changed: vec![AspectId::of_location(order)], ..unchanged(state, moment) }
        };
        let empty = self.kitchen.orders.iter().filter(is_empty);
        empty.flat_map(move |&order| (0..dishes).map(move |dish| with(order, dish)))
    }
}

fn unchanged(state: State, moment: &DecisionPoint) -> NextSituation {
    let Situation { belief, robot, .. } = moment.situation;
    NextSituation { state, belief: belief.clone(), changed: Vec::new(), robot, presses: moment.presses }
}

fn make_certain(kitchen: &Kitchen, belief: &mut DirichletBelief, aspect: AspectId, state: State) {
    let truth = kitchen.true_value(state, aspect);
    let dirichlet = &mut belief.aspects[aspect.index()];
    let values = dirichlet.mean().len();
    dirichlet.learn(1.0, (0..values).map(|value| f64::from(u8::from(value == truth))));
}
