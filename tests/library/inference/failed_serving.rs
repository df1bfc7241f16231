//! A serving without effect: another version of the recipe is recalled, against plain particles.

use std::path::Path;
use std::sync::Arc;

use tomcom::base::rng::stream;
use tomcom::base::time::SessionTime;
use tomcom::edge::files::read_kitchen;
use tomcom::kitchen::cost_to_go::CostToGo;
use tomcom::kitchen::{Agent, AspectId, ButtonAction, ButtonId, DishId, Kitchen, OrderContent, Press};
use tomcom::mind::dirichlet::{Dirichlet, DirichletBelief};
use tomcom::mind::filter::BeliefFilter;
use tomcom::mind::model::HumanModel;
use tomcom::mind::observation::{Observation, ObservedEvidence};
use tomcom::mind::reference::belief_set::ParticleSet;

use super::looks_at_nothing;

/// A dish, and a wrong version of its recipe whose stack can be on the plate.
fn on_plate(kitchen: &Kitchen) -> (DishId, usize) {
    let contents = &kitchen.aspects[kitchen.plate.index()];
    let wrong = |dish: DishId| {
        let mut variants = kitchen.dish(dish).variants.iter().enumerate().skip(1);
        variants.find(|(_, variant)| contents.index_of(variant.0).is_some()).map(|(version, _)| (dish, version))
    };
    let dishes = (0..kitchen.dishes.len()).map(|dish| DishId(dish as u8));
    dishes.filter_map(wrong).next().expect("a wrong version can be made")
}

/// People who are sure of what they saw at the start, and unsure of recipes until they recall one.
fn model(recall_precision: Option<f64>) -> HumanModel {
    let mut model = looks_at_nothing();
    (model.prior.location_truth, model.prior.location_precision) = (0.9999, 0.01);
    (model.prior.recipe_truth, model.prior.recipe_precision) = (0.4, 5.0);
    (model.perception.look_alike, model.perception.anything) = (0.0, 0.0);
    (model.transition.recipe_half_life_s, model.transition.recall_half_life_s) = (1e6, 1e6);
    model.transition.recall_precision = recall_precision;
    model
}

/// A dish is ordered, a wrong version of it stands on the plate, and the human presses "serve" in vain.
fn events() -> [Observation; 2] {
    let kitchen = sushi();
    let (dish, version) = on_plate(&kitchen);
    let mut state = kitchen.empty_state();
    state.set_order(kitchen.orders[0], OrderContent::Dish(dish));
    state.set_content(kitchen.plate, kitchen.dish(dish).variants[version]);
    let serves = |action: ButtonAction| action == ButtonAction::Serve(kitchen.orders[0]);
    let buttons = &kitchen.buttons[Agent::Human.index()];
    let button = buttons.iter().position(|button| serves(button.action)).expect("the order has a button");
    let press =
        Press { agent: Agent::Human, button: ButtonId(button as u8), before: state, after: state, effective: false };
    let at = |seconds: f64, what| Observation { time: SessionTime::from_secs_f64(seconds), what };
    [at(0.0, ObservedEvidence::Started { state }), at(4.0, ObservedEvidence::Pressed(press))]
}

fn sushi() -> Arc<Kitchen> {
    Arc::new(read_kitchen(Path::new("layouts/sushi.toml")).expect("the kitchen loads").kitchen)
}

fn estimate(model: &HumanModel, events: &[Observation]) -> DirichletBelief {
    let kitchen = sushi();
    let mut cost = CostToGo::new(kitchen.clone());
    let mut filter = BeliefFilter::new(kitchen, model.clone(), 3);
    events.iter().for_each(|event| filter.observe(event, &mut cost));
    filter.belief().clone()
}

/// What 2,000 people of the model believe in the end, weighted by how likely each of them pressed.
fn of_people(model: &HumanModel, events: &[Observation]) -> DirichletBelief {
    let kitchen = sushi();
    let mut cost = CostToGo::new(kitchen.clone());
    let mut random = stream(13, "failed serving", 0);
    let mut people = ParticleSet::new(kitchen.clone(), model.clone());
    people.start(SessionTime::ZERO, kitchen.empty_state(), 2000, &mut random);
    let mut weights = Vec::new();
    for event in events {
        weights = people.experience(event, &mut cost, &mut random);
    }
    people.projected(&weights)
}

fn recipe(belief: &DirichletBelief) -> &Dirichlet {
    belief.aspect(sushi().aspect_of_dish(on_plate(&sushi()).0))
}

fn plate(belief: &DirichletBelief) -> &Dirichlet {
    belief.aspect(AspectId::of_location(sushi().plate))
}

/// Holds the estimate of recipe and plate against the beliefs of explicit people.
fn compare(model: &HumanModel, events: &[Observation]) {
    let (filter, people) = (estimate(model, events), of_people(model, events));
    for of in [recipe, plate] {
        let (one, plain) = (of(&filter), of(&people));
        let story = format!("{:?}: {one:?} {plain:?}", model.transition);
        assert!((one.second() - plain.second()).abs() < 0.04, "{story}");
        one.mean().iter().zip(plain.mean()).for_each(|(a, b)| assert!((a - b).abs() < 0.04, "{story}"));
    }
}

#[test]
fn who_could_not_serve_a_version_recalls_another_one() {
    let (_, wrong) = on_plate(&sushi());
    let events = events();
    let [same, another] = [None, Some(0.4)].map(|recall| recipe(&estimate(&model(recall), &events)).clone());
    assert!(same.mean()[wrong] < 0.1 && another.mean()[wrong] < 0.1, "{same:?} {another:?}");
    let before = recipe(&estimate(&model(Some(0.4)), &events[..1])).clone();
    // Nearly all who press "serve" held the version on the plate, so what they recall is as the forgotten recipe is.
    let left = |version: usize| before.mean()[version] / (1.0 - before.mean()[wrong]);
    for version in (0..before.mean().len()).filter(|&version| version != wrong) {
        let (now, left) = (another.mean()[version], left(version));
        assert!((now - left).abs() < 0.06, "version {version}: {now}, left {left}");
    }
    let precision = another.precision();
    assert!(precision < 0.6, "one version is recalled: {precision}");
}

#[test]
fn the_estimate_after_a_failed_serving_is_that_of_people_who_recall_another_version() {
    for recall in [None, Some(0.4), Some(3.0)] {
        compare(&model(recall), &events());
    }
}
