//! Signals that can be missed: what the planner makes of the chance, against its plain reference, and when a signal is repeated.

use std::sync::Arc;

use tomcom_core::base::time::SessionTime;
use tomcom_core::communication::concept::{Concept, DecisionPoint};
use tomcom_core::communication::planner::Planner;
use tomcom_core::communication::signal::SignalRepeatRule;
use tomcom_core::communication::settings::AssistantSpec;
use tomcom_core::communication::concept::{RobotIntent, Situation};
use tomcom_core::communication::{HighlightSet, Signal, signals};
use tomcom_core::kitchen::cost_to_go::CostToGo;
use tomcom_core::kitchen::{AspectId, DishId, Kitchen, OrderContent, State};
use tomcom_core::mind::dirichlet::{Dirichlet, DirichletBelief};
use tomcom_core::mind::model::HumanModel;
use tomcom_core::mind::model::SignalReadingForecast;
use tomcom_research::reference::planner::ReferencePlanner;

use crate::files::kitchen;

/// Salmon nigiri is wanted and the base is ready; its recipe is taken for another one.
pub struct WrongRecipe {
    pub kitchen: Arc<Kitchen>,
    pub state: State,
    pub belief: DirichletBelief,
    pub signal: Signal,
    recipe: AspectId,
}

impl WrongRecipe {
    pub fn new() -> WrongRecipe {
        let kitchen = kitchen("sushi");
        let dish = kitchen.dishes.iter().position(|dish| dish.name == "salmon nigiri").expect("a dish");
        let dish = DishId(dish as u8);
        let mut state = kitchen.empty_state();
        state.set_order(kitchen.orders[0], OrderContent::Dish(dish));
        let board = AspectId::of_location(kitchen.board);
        let labels = &kitchen.aspects[board.index()].labels;
        let base = labels.iter().position(|label| label == "rice shaped + nori").expect("a content");
        kitchen.set_value(&mut state, &mut kitchen.true_recipes(), board, base);
        let certain = |aspect: AspectId, value: usize, p: f64| {
            let values = kitchen.aspects[aspect.index()].values.len();
            let mean = (0..values).map(|other| if other == value { p } else { (1.0 - p) / (values - 1) as f64 });
            Dirichlet::new(mean.collect(), 10.0)
        };
        let truth = |index: usize| {
            let aspect = AspectId(index as u8);
            certain(aspect, kitchen.true_value(state, aspect), 0.98)
        };
        let mut belief = DirichletBelief { aspects: (0..kitchen.aspects.len()).map(truth).collect() };
        let recipe = kitchen.aspect_of_dish(dish);
        let crab = "rice shaped + nori + crab cut";
        let wrong = kitchen.aspects[recipe.index()].labels.iter().position(|label| label == crab).expect("a variant");
        belief.aspects[recipe.index()] = certain(recipe, wrong, 0.9);
        let signal = Signal::ShowRecipe("order_1".to_string());
        WrongRecipe { kitchen, state, belief, signal, recipe }
    }

    pub fn moment<'a>(&'a self, forecast: SignalReadingForecast, signals: &'a [Signal]) -> DecisionPoint<'a> {
        let robot = RobotIntent::Still;
        let situation = Situation { robot, forecast, ..Situation::new(self.state, &self.belief) };
        DecisionPoint { seq: 0, time: SessionTime::ZERO, presses: 0, situation, signals, error: None }
    }

    /// The benefit of showing the recipe, by the planner.
    fn benefit(&self, forecast: SignalReadingForecast) -> f64 {
        let signals = [self.signal.clone()];
        let mut spec = AssistantSpec::default();
        // All rollouts, so that answers differ by the forecast alone.
        spec.rollout.least_rollouts = spec.rollout.rollouts;
        let mut planner = Planner::new(self.kitchen.clone(), &HumanModel::default(), spec, 9804);
        let mut cost = CostToGo::new(self.kitchen.clone());
        planner.advise(&mut cost, &self.moment(forecast, &signals)).options[0].benefit
    }
}

#[test]
fn the_benefit_of_a_signal_is_weighed_by_the_chance_that_it_is_read_and_falls_with_its_delay() {
    let scene = WrongRecipe::new();
    let benefit = |recipe: f64, delay_s: f64| scene.benefit(SignalReadingForecast { recipe, highlight: 1.0, delay_s });
    let certain = benefit(1.0, 0.0);
    assert!(certain > 1.5, "{certain}");
    assert!((benefit(0.5, 0.0) - 0.5 * certain).abs() < 0.01, "half of it is missed: {}", benefit(0.5, 0.0));
    assert_eq!(benefit(0.0, 0.0), 0.0, "who misses it saves nothing");
    let (soon, late) = (benefit(1.0, 1.0), benefit(1.0, 8.0));
    println!("{certain:.2} presses saved if it is read at once, {soon:.2} after a second, {late:.2} after eight");
    assert!(late < soon && soon <= certain + 0.1, "{certain} {soon} {late}");
}

#[test]
fn the_planner_and_its_plain_reference_agree_on_a_signal_that_can_be_missed() {
    let scene = WrongRecipe::new();
    let forecast = SignalReadingForecast { recipe: 0.7, highlight: 0.5, delay_s: 1.5 };
    let fast = scene.benefit(forecast);
    let mut spec = AssistantSpec::default();
    spec.rollout.rollouts = 96;
    let planner = ReferencePlanner::new(scene.kitchen.clone(), HumanModel::default(), spec, 9804);
    let signals = [scene.signal.clone()];
    let mut cost = CostToGo::new(scene.kitchen.clone());
    let plain = &planner.advise(&mut cost, &scene.moment(forecast, &signals))[0];
    let error = plain.standard_error;
    println!("benefit {fast:.2} by the planner, {:.2} ± {error:.2} by the reference", plain.benefit);
    assert!((fast - plain.benefit).abs() < 3.0 * error + 0.2);
}

#[test]
fn a_signal_that_was_probably_missed_may_be_repeated_and_one_that_was_read_may_not() {
    let WrongRecipe { kitchen, state, belief, signal, recipe } = WrongRecipe::new();
    let may = |repeats: &SignalRepeatRule| repeats.allowed(&kitchen, HighlightSet::usual(&kitchen)).contains(&signal);
    let location = kitchen.orders[0];
    let mut known = belief.clone();
    known.aspects[recipe.index()] =
        DirichletBelief::prior(&kitchen, &HumanModel::default().prior, state).aspects[recipe.index()].clone();
    let truth = kitchen.true_value(state, recipe);
    let values = known.aspects[recipe.index()].mean().len();
    known.aspects[recipe.index()].learn(0.95, (0..values).map(|value| f64::from(u8::from(value == truth))));

    let mut missed = SignalRepeatRule::default();
    missed.shown(&kitchen, state, &signal);
    missed.update(&kitchen, state, &belief);
    assert!(!may(&missed), "not while it stands on the display");
    missed.over(location, 0.1);
    missed.update(&kitchen, state, &belief);
    assert!(may(&missed), "it was missed");

    let mut read = SignalRepeatRule::default();
    read.shown(&kitchen, state, &signal);
    read.update(&kitchen, state, &known);
    read.over(location, 0.95);
    read.update(&kitchen, state, &known);
    assert!(!may(&read), "it was read");
    read.update(&kitchen, state, &belief);
    assert!(may(&read), "and is forgotten");

    let mut doubtful = SignalRepeatRule::default();
    doubtful.shown(&kitchen, state, &signal);
    doubtful.over(location, 0.6);
    doubtful.update(&kitchen, state, &belief);
    assert!(may(&doubtful), "P(truth) never passed 0.9");
    assert!(signals(&kitchen, HighlightSet::usual(&kitchen)).iter().any(|(_, one)| *one == signal));
}
