//! Rollouts of humans who consider one order at a time: what a signal is worth depends on the order, and the planner agrees
//! with its plain reference.

use tomcom::communication::concept::Concept;
use tomcom::communication::planner::Planner;
use tomcom::communication::reference::ReferencePlanner;
use tomcom::communication::settings::AssistantSpec;
use tomcom::kitchen::cost_to_go::CostToGo;
use tomcom::kitchen::{AspectId, DishId, OrderContent};
use tomcom::mind::dirichlet::Dirichlet;
use tomcom::mind::model::HumanModel;
use tomcom::mind::signal_model::SignalReadingForecast;

use super::missed_signals::WrongRecipe;

/// Two dishes are ordered, and the human takes the recipe of the first for another one.
struct TwoOrders {
    scene: WrongRecipe,
    human: HumanModel,
    spec: AssistantSpec,
}

impl TwoOrders {
    fn new() -> TwoOrders {
        let mut scene = WrongRecipe::new();
        let kitchen = &scene.kitchen;
        let other = kitchen.dishes.iter().position(|dish| dish.name == "tuna maki").expect("a dish");
        let order = kitchen.orders[1];
        scene.state.set_order(order, OrderContent::Dish(DishId(other as u8)));
        let aspect = AspectId::of_location(order);
        let mut known = vec![0.0; kitchen.aspects[aspect.index()].values.len()];
        known[kitchen.true_value(scene.state, aspect)] = 1.0;
        scene.belief.aspects[aspect.index()] = Dirichlet::new(known, 10.0);
        let mut human = HumanModel::default();
        human.decision.one_order = 0.9;
        TwoOrders { scene, human, spec: AssistantSpec::default() }
    }

    /// The benefit of showing the first order's recipe to a human with these probabilities of each order focus.
    fn benefit(&self, focus: &[f64]) -> f64 {
        let signals = [self.scene.signal.clone()];
        let mut moment = self.scene.moment(SignalReadingForecast::default(), &signals);
        moment.situation.focus = focus;
        let mut spec = self.spec.clone();
        spec.rollout.least_rollouts = spec.rollout.rollouts;
        let mut planner = Planner::new(self.scene.kitchen.clone(), &self.human, spec, 8204);
        planner.advise(&mut CostToGo::new(self.scene.kitchen.clone()), &moment).options[0].benefit
    }
}

#[test]
fn a_recipe_is_worth_most_to_who_considers_its_order() {
    let orders = TwoOrders::new();
    let [all, this, other] = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]].map(|focus| orders.benefit(&focus));
    println!("benefit {all:.2} for who considers both orders, {this:.2} only its own, {other:.2} only the other one");
    assert!(this > other + 0.5 && this > 1.0);
    let mixed = orders.benefit(&[0.2, 0.4, 0.4]);
    assert!((mixed - (0.2 * all + 0.4 * this + 0.4 * other)).abs() < 0.25, "{mixed}");
}

#[test]
fn the_planner_and_its_plain_reference_agree_on_humans_who_consider_one_order() {
    let orders = TwoOrders::new();
    let signals = [orders.scene.signal.clone()];
    let mut spec = orders.spec.clone();
    spec.rollout.rollouts = 160;
    let plain = ReferencePlanner::new(orders.scene.kitchen.clone(), orders.human.clone(), spec, 8204);
    let mut cost = CostToGo::new(orders.scene.kitchen.clone());
    for focus in [[0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [0.2, 0.5, 0.3]] {
        let mut moment = orders.scene.moment(SignalReadingForecast::default(), &signals);
        moment.situation.focus = &focus;
        let fast = orders.benefit(&focus);
        let plain = &plain.advise(&mut cost, &moment)[0];
        let error = plain.standard_error;
        println!("{focus:?}: benefit {fast:.2} by the planner, {:.2} ± {error:.2} by the reference", plain.benefit);
        assert!((fast - plain.benefit).abs() < 3.0 * error + 0.15);
    }
}
