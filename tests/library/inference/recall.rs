//! Recall of recipes: an order makes the participant hold one version, against plain particles and by its closed form.

use std::path::Path;
use std::sync::Arc;

use tomcom::base::rng::stream;
use tomcom::base::time::SessionTime;
use tomcom::edge::files::read_kitchen;
use tomcom::kitchen::cost_to_go::CostToGo;
use tomcom::kitchen::{AspectId, DishId, Kitchen, OrderContent, State};
use tomcom::mind::dirichlet::Dirichlet;
use tomcom::mind::filter::BeliefFilter;
use tomcom::mind::model::HumanModel;
use tomcom::mind::observation::{Observation, ObservedEvidence};
use tomcom::mind::reference::belief_set::ParticleSet;

use super::looks_at_nothing;

const RECALL: f64 = 0.4;
const HALF_LIFE_S: f64 = 100.0;
const ANEW_S: f64 = 40.0;
const FORGOTTEN: f64 = 0.5;

fn model(recall_precision: Option<f64>) -> HumanModel {
    let mut model = looks_at_nothing();
    model.prior.recipe_precision = 5.0;
    model.transition.recipe_half_life_s = HALF_LIFE_S;
    (model.transition.recall_precision, model.transition.recall_half_life_s) = (recall_precision, ANEW_S);
    model
}

/// What the display shows: a dish is ordered after 10 s, served after 110 s, and ordered again after 210 s.
fn story(kitchen: &Kitchen) -> Vec<(f64, State)> {
    let [mut ordered, mut served] = [kitchen.empty_state(); 2];
    ordered.set_order(kitchen.orders[0], OrderContent::Dish(DishId(0)));
    served.set_order(kitchen.orders[0], OrderContent::Served);
    vec![(10.0, ordered), (110.0, served), (210.0, ordered)]
}

/// The events of the story up to a time, and one that changes nothing at that time.
fn events(kitchen: &Kitchen, until_s: f64) -> Vec<Observation> {
    let at = |seconds: f64, what| Observation { time: SessionTime::from_secs_f64(seconds), what };
    let mut events = vec![at(0.0, ObservedEvidence::Started { state: kitchen.empty_state() })];
    let mut shown = kitchen.empty_state();
    for (seconds, state) in story(kitchen).into_iter().filter(|(seconds, _)| *seconds <= until_s) {
        events.push(at(seconds, ObservedEvidence::Displayed { state }));
        shown = state;
    }
    events.push(at(until_s, ObservedEvidence::Displayed { state: shown }));
    events
}

fn burgers() -> Arc<Kitchen> {
    Arc::new(read_kitchen(Path::new("layouts/burger.toml")).expect("the kitchen loads").kitchen)
}

/// The estimate of the ordered dish's recipe, and of another one, at a time of the story.
fn estimate(model: &HumanModel, until_s: f64) -> [Dirichlet; 2] {
    let kitchen = burgers();
    let mut cost = CostToGo::new(kitchen.clone());
    let mut filter = BeliefFilter::new(kitchen.clone(), model.clone(), 3);
    events(&kitchen, until_s).iter().for_each(|event| filter.observe(event, &mut cost));
    let of = |dish| filter.belief().aspect(kitchen.aspect_of_dish(DishId(dish))).clone();
    [of(0), of(1)]
}

#[test]
fn an_order_makes_one_hold_one_version_as_long_as_it_is_ordered() {
    let recalling = model(Some(RECALL));
    let [before, other] = estimate(&recalling, 9.999_999);
    let [ordered, unordered] = estimate(&recalling, 10.0);
    assert!((other.second() - unordered.second()).abs() < 1e-6, "no other recipe is recalled: {unordered:?}");
    for (one, mean) in ordered.mean().iter().zip(before.mean()) {
        assert!((one - mean).abs() < 1e-9, "nobody learns from an order what is right: {one}, {mean}");
    }
    let second = (RECALL * before.second() + 1.0) / (RECALL + 1.0);
    assert!((ordered.second() - second).abs() < 1e-6, "{} {second}", ordered.second());
    assert!(ordered.precision() < RECALL && before.precision() > 4.9, "{} {}", ordered.precision(), before.precision());
    let prior = estimate(&recalling, 0.0)[0].second();
    let recalled = (RECALL * prior + 1.0) / (RECALL + 1.0);
    let anew = 1.0 - 0.5_f64.powf(99.0 / ANEW_S);
    let [later, _] = estimate(&recalling, 109.0);
    let expected = (1.0 - anew) * ordered.second() + anew * recalled;
    assert!((later.second() - expected).abs() < 1e-6, "all hold one version still: {} {expected}", later.second());
    let [[served, _], [faded, _]] = [110.0, 209.0].map(|until_s| estimate(&recalling, until_s));
    let square: f64 = faded.mean().iter().map(|mean| mean * mean).sum();
    let left = 0.5_f64.powf(2.0 * 0.99) * (served.second() - square);
    assert!((faded.second() - square - left).abs() < 1e-6, "who fades is less sure: {} {left}", faded.second());
    let [again, _] = estimate(&recalling, 210.0);
    assert!(again.second() > faded.second() + 0.1, "it is recalled anew: {again:?}");
}

#[test]
fn a_recipe_fades_to_what_is_left_of_it_and_is_recalled_anew_from_that() {
    for recall_precision in [Some(RECALL), None] {
        let mut forgetting = model(recall_precision);
        let known = forgetting.prior.recipe_truth;
        forgetting.transition.forgotten_truth = Some(FORGOTTEN);
        let [start, faded] = [0.0, 90.0].map(|until_s| estimate(&forgetting, until_s)[1].mean()[0]);
        assert!((start - known).abs() < 1e-9, "the instruction is remembered at the start: {start}");
        let expected = FORGOTTEN + (known - FORGOTTEN) * 0.5_f64.powf(90.0 / HALF_LIFE_S);
        assert!((faded - expected).abs() < 1e-6, "{recall_precision:?}: {faded} {expected}");
        let [ordered, later] = [10.0, 109.0].map(|until_s| estimate(&forgetting, until_s)[0].mean()[0]);
        let half_life_s = if recall_precision.is_some() { ANEW_S } else { HALF_LIFE_S };
        let expected = FORGOTTEN + (ordered - FORGOTTEN) * 0.5_f64.powf(99.0 / half_life_s);
        assert!((later - expected).abs() < 1e-6, "{recall_precision:?}: {later} {expected}");
    }
}

#[test]
fn without_recall_orders_change_nothing_that_is_held_of_recipes() {
    for until_s in [9.0, 10.0, 109.0, 210.0] {
        let [ordered, other] = estimate(&model(None), until_s);
        assert!((ordered.second() - other.second()).abs() < 1e-9, "{until_s} s: {ordered:?}");
    }
}

#[test]
fn the_closed_form_is_that_of_people_who_recall() {
    let kitchen = burgers();
    let mut model = model(Some(RECALL));
    model.transition.forgotten_truth = Some(FORGOTTEN);
    let mut random = stream(11, "recall", 0);
    let mut cost = CostToGo::new(kitchen.clone());
    let aspect: AspectId = kitchen.aspect_of_dish(DishId(0));
    for until_s in [9.0, 10.0, 60.0, 209.0, 210.0] {
        let mut people = ParticleSet::new(kitchen.clone(), model.clone());
        people.start(SessionTime::ZERO, kitchen.empty_state(), 4000, &mut random);
        for event in events(&kitchen, until_s).iter().skip(1) {
            people.experience(event, &mut cost, &mut random);
        }
        let [exact, _] = estimate(&model, until_s);
        let of_people = people.projected(&vec![1.0; people.of.len()]);
        let second = of_people.aspect(aspect).second();
        assert!((exact.second() - second).abs() < 0.012, "{until_s} s: {} {second}", exact.second());
        for (one, plain) in exact.mean().iter().zip(of_people.aspect(aspect).mean()) {
            assert!((one - plain).abs() < 0.02, "{until_s} s: {one} {plain}");
        }
    }
}
