//! Inference of the human's belief, event by event: a product of Dirichlets over the state aspects (paper, section
//! "Inference of the human belief").
//!
//! Closed forms are used for reading, forgetting, signals, and own presses that involve one location. Samples are used for the
//! likelihood of a press, for own presses that involve several locations, and for presses of the robot.

mod distinct;
mod evidence;
mod exchange;
mod gamma;
mod own_press;
mod perception;
mod robot_press;
mod serving;
pub mod urn;

use std::sync::Arc;

use super::choice::ChoiceModel;
use super::dirichlet::{Dirichlet, DirichletBelief};
use super::model::HumanModel;
use super::observation::{Observation, Observed};
use crate::base::rng::{Stream, stream};
use crate::base::time::SessionTime;
use crate::kitchen::State;
use crate::kitchen::cost_to_go::CostToGo;
use crate::kitchen::{
    Agent, AspectId, AspectKind, ButtonAction, ButtonId, Kitchen, LocationId, LocationKind, OrderContent,
};
pub use evidence::Evidence;
use evidence::{EvidenceModel, Sampler};
use exchange::Exchange;
use perception::GazeReader;
use serving::Serving;

/// Update rule of a button: from one location, or from several that jointly determine the effect of the press.
#[derive(Clone, Debug)]
enum Lesson {
    Alone,
    Exchange(Exchange),
    Serving(Serving),
}

/// The recursive estimator of the human's belief.
#[derive(Clone, Debug)]
pub struct BeliefFilter {
    kitchen: Arc<Kitchen>,
    model: HumanModel,
    seed: u64,
    belief: DirichletBelief,
    /// The prior to which recipe beliefs decay.
    prior: DirichletBelief,
    reader: GazeReader,
    choice: ChoiceModel,
    /// Update rule of each button of the human, by [`ButtonId`].
    lessons: Vec<Lesson>,
    sampler: Sampler,
    shown: State,
    /// Number of presses of both agents so far. It seeds the random stream of an update, so that other events in a log do not
    /// change the estimate.
    presses: u64,
    /// Time up to which forgetting has been applied; `None` while the trial is paused.
    forgot: Option<SessionTime>,
    evidence: Option<Evidence>,
}

impl BeliefFilter {
    /// An estimate before the trial's start.
    pub fn new(kitchen: Arc<Kitchen>, model: HumanModel, seed: u64) -> BeliefFilter {
        let shown = kitchen.empty_state();
        let prior = DirichletBelief::prior(&kitchen, &model.prior, shown);
        let lesson = |action: ButtonAction| match action {
            ButtonAction::Use(location) => Lesson::Exchange(Exchange::new(&kitchen, location)),
            ButtonAction::Serve(order) => Lesson::Serving(Serving::new(&kitchen, order)),
            ButtonAction::Take(_) | ButtonAction::Process(_) | ButtonAction::Trash => Lesson::Alone,
        };
        let lessons = kitchen.buttons[Agent::Human.index()].iter().map(|button| lesson(button.action)).collect();
        BeliefFilter {
            reader: GazeReader::new(&kitchen, &model.perception),
            choice: ChoiceModel::for_draws(&kitchen, &model.decision, model.inference.states),
            belief: prior.clone(),
            sampler: Sampler::new(&kitchen),
            forgot: None,
            evidence: None,
            kitchen,
            model,
            seed,
            prior,
            lessons,
            shown,
            presses: 0,
        }
    }

    /// The estimate.
    pub fn belief(&self) -> &DirichletBelief {
        &self.belief
    }

    /// Likelihood and effective sample size of the human's last press.
    pub fn evidence(&self) -> Option<Evidence> {
        self.evidence
    }

    /// Updates the estimate with one observation. The random stream depends on the seed and the number of presses only.
    pub fn observe(&mut self, observation: &Observation, cost: &mut CostToGo) {
        let now = observation.time;
        if let Observed::Gaze { sample, taken } = observation.what {
            if self.forgot.is_some() {
                self.reader.read(&self.kitchen, &self.model.perception, &mut self.belief, &sample, taken);
            }
            return;
        }
        self.forget(now);
        self.reader.settle();
        match observation.what {
            Observed::Started { state } => {
                self.prior = DirichletBelief::prior(&self.kitchen, &self.model.prior, state);
                self.belief.clone_from(&self.prior);
                self.forgot = Some(now);
                self.show(now, state);
            }
            Observed::Gaze { .. } => {}
            Observed::Pressed(press) => {
                self.presses += 1;
                let mut random = stream(self.seed, "belief", self.presses);
                match press.agent {
                    Agent::Human => self.human_pressed(press.button, press.effective, cost, &mut random),
                    Agent::Robot => {
                        let (draws, foresight) = (self.model.inference.predictions, self.model.transition.foresight);
                        robot_press::predict(&self.kitchen, cost, &mut self.belief, draws, foresight, &mut random);
                    }
                }
                self.show(now, press.after);
            }
            Observed::Displayed { state } => {
                self.expect_cleared(state);
                self.show(now, state);
            }
            Observed::Told { location } => self.told(location),
            Observed::Paused => self.forgot = None,
            Observed::Resumed => {
                self.forgot = Some(now);
                self.reader.rest();
            }
        }
    }

    fn show(&mut self, now: SessionTime, state: State) {
        self.shown = state;
        self.reader.show(now, state, self.model.perception.history_s);
    }

    /// Lets recipe beliefs decay towards their prior.
    fn forget(&mut self, now: SessionTime) {
        let Some(last) = self.forgot else { return };
        self.forgot = Some(now.max(last));
        let lost = 1.0 - 0.5_f64.powf(now.secs_since(last) / self.model.transition.recipe_half_life_s);
        for index in 0..self.kitchen.aspects.len() {
            if matches!(self.kitchen.aspects[index].kind, AspectKind::Recipe(_)) {
                self.belief.aspects[index].mix(lost, &self.prior.aspects[index]);
            }
        }
    }

    fn human_pressed(&mut self, button: ButtonId, effective: bool, cost: &mut CostToGo, random: &mut Stream) {
        let model = EvidenceModel { kitchen: &self.kitchen, choice: &self.choice, inference: &self.model.inference };
        self.evidence = Some(self.sampler.weigh(&model, cost, &mut self.belief, button, random));
        let draws = self.model.inference.beliefs;
        match &self.lessons[button.index()] {
            Lesson::Alone => {
                let action = self.kitchen.button(Agent::Human, button).action;
                own_press::learn_alone(&self.kitchen, &mut self.belief, action, effective);
            }
            Lesson::Exchange(exchange) => exchange.learn(&mut self.belief, effective, draws, random),
            Lesson::Serving(serving) => serving.learn(&mut self.belief, effective, draws, random),
        }
    }

    /// Handles orders whose display changes from "served" to "none": a human who believes "served" expects this change.
    fn expect_cleared(&mut self, state: State) {
        for &order in &self.kitchen.orders {
            if self.shown.order(order) != OrderContent::Served || state.order(order) == OrderContent::Served {
                continue;
            }
            let aspect = &self.kitchen.aspects[order.index()];
            let [served, none] = [OrderContent::Served, OrderContent::None].map(|what| aspect.index_of(what.code()));
            if let (Some(served), Some(none)) = (served, none) {
                self.belief.aspects[order.index()].shift(served, none);
            }
        }
    }

    /// Makes the aspects that a signal shows certain, with the probability that the signal is noticed.
    fn told(&mut self, location: LocationId) {
        let kitchen = self.kitchen.clone();
        let mut aspects = vec![AspectId::of_location(location)];
        if let (LocationKind::Order, OrderContent::Dish(dish)) =
            (kitchen.location(location).kind, self.shown.order(location))
        {
            aspects.push(kitchen.aspect_of_dish(dish));
        }
        for aspect in aspects {
            let truth = kitchen.true_value(self.shown, aspect);
            let of_aspect: &mut Dirichlet = &mut self.belief.aspects[aspect.index()];
            let values = of_aspect.mean().len();
            of_aspect.learn(self.model.signal.noticed, (0..values).map(|value| f64::from(value == truth)));
        }
    }
}
