//! What the estimate learns about a person in a trial: how often it slips, and how attentive it is.

use tomcom::base::time::SessionTime;
use tomcom::kitchen::cost_to_go::CostToGo;
use tomcom::kitchen::{Agent, ButtonId, Press};
use tomcom::mind::attention_posterior::{ATTENTIONS, with_attention};
use tomcom::mind::filter::BeliefFilter;
use tomcom::mind::filter::conditional_filter::ConditionalFilter;
use tomcom::mind::model::{AdaptationSettings, HumanModel};
use tomcom::mind::observation::{Observation, ObservedEvidence};
use tomcom::mind::reference::ReferenceFilter;

use super::observed::recorded;
use super::world::{Human, World, kitchen, live};

/// Humans simulated from the model for each attention, and presses of each.
const HUMANS: u64 = 10;
const PRESSES: usize = 40;

/// A human model whose lapse is learned.
fn learned_lapse() -> HumanModel {
    let mut model = HumanModel::default();
    model.adapt.lapse = true;
    model
}

/// Expected lapses of filter and reference after a trial of 90 presses in which every `slips`th press of the human is followed by one that does
/// nothing; 0: none is.
fn lapses_after(slips: usize) -> [f64; 2] {
    let kitchen = kitchen("layouts/sushi.toml");
    let mut cost = CostToGo::new(kitchen.clone());
    let mut model = learned_lapse();
    let mut filter = BeliefFilter::new(kitchen.clone(), model.clone(), 9804);
    model.inference.beliefs = 512;
    let mut reference = ReferenceFilter::new(kitchen.clone(), model, 9804);
    let buttons = kitchen.buttons[Agent::Human.index()].len() as u8;
    let mut own = 0;
    for Observation { time, what } in recorded(&kitchen, 9803, 90) {
        let mut all = vec![Observation { time, what }];
        if let ObservedEvidence::Pressed(Press { agent: Agent::Human, after, .. }) = what {
            own += 1;
            // Who knows the kitchen does not press what does nothing.
            if slips > 0 && own % slips == 0 {
                let presses = (0..buttons).map(|button| kitchen.try_press(after, Agent::Human, ButtonId(button)));
                let slip = presses.into_iter().find(|press| !press.effective).expect("a press that does nothing");
                all.push(Observation {
                    time: time + SessionTime::from_secs_f64(0.1),
                    what: ObservedEvidence::Pressed(slip),
                });
            }
        }
        for observation in all {
            filter.observe(&observation, &mut cost);
            reference.observe(&observation, &mut cost);
        }
    }
    [filter.lapse(), reference.lapse()]
}

#[test]
fn the_lapse_is_learned_from_slips_and_from_their_absence() {
    let prior = HumanModel::default().decision.lapse;
    let [seldom, plain_seldom] = lapses_after(0);
    let [often, plain_often] = lapses_after(3);
    println!(
        "lapse {seldom:.4} (reference {plain_seldom:.4}) as recorded, {often:.4} ({plain_often:.4}) with slips, {prior} before"
    );
    assert!(often > 1.25 * prior && seldom < 0.9 * prior);
    assert!((often / plain_often).ln().abs() < 0.3, "{often} {plain_often}");
    assert!((seldom / plain_seldom).ln().abs() < 0.5, "{seldom} {plain_seldom}");
}

#[test]
fn the_lapse_stays_as_it_is_where_it_is_not_learned() {
    let kitchen = kitchen("layouts/sushi.toml");
    let filter = BeliefFilter::new(kitchen, HumanModel::default(), 1);
    assert_eq!(filter.lapse(), HumanModel::default().decision.lapse);
}

/// A human model whose attention is learned, and nothing else.
fn learned_attention() -> HumanModel {
    let mut model = HumanModel::default();
    model.adapt.attention = true;
    model
}

/// The geometric mean of the expected attention after trials of humans who are simulated from the model with this one.
fn attention_of(times: f64) -> f64 {
    let kitchen = kitchen("layouts/sushi.toml");
    let model = learned_attention();
    let own = with_attention(&model, times);
    let mut cost = CostToGo::new(kitchen.clone());
    let mut logs = 0.0;
    for index in 0..HUMANS {
        let mut world = World::new(kitchen.clone(), cost, 15.0, 9903, index);
        let mut human = Human::new(&kitchen, &own, 9903, index);
        let mut filter = BeliefFilter::new(kitchen.clone(), model.clone(), index);
        live(&mut world, &mut human, PRESSES, |observation, _, cost| filter.observe(observation, cost));
        logs += filter.attention().expected().ln();
        cost = world.cost;
    }
    (logs / HUMANS as f64).exp()
}

#[test]
fn the_attention_is_learned_from_humans_of_the_model_who_read_slowly_or_fast() {
    let [slow, usual, fast] = [1.0 / 3.0, 1.0, 3.0].map(attention_of);
    println!(
        "expected attention after {PRESSES} presses of {HUMANS} humans: {slow:.2} of slow, {usual:.2} of usual, {fast:.2} of fast readers"
    );
    assert!(slow < usual && usual < fast && slow < 0.9 && fast > 1.1, "{slow} {usual} {fast}");
}

#[test]
fn the_estimate_has_the_moments_of_the_filters_with_each_attention() {
    let kitchen = kitchen("layouts/sushi.toml");
    let mut cost = CostToGo::new(kitchen.clone());
    let model = HumanModel { adapt: AdaptationSettings::ALL, ..HumanModel::default() };
    let mut mixture = BeliefFilter::new(kitchen.clone(), model.clone(), 1);
    let mut each =
        ATTENTIONS.map(|(times, _)| ConditionalFilter::new(kitchen.clone(), with_attention(&model, times), 1));
    for observation in recorded(&kitchen, 9904, 40) {
        mixture.observe(&observation, &mut cost);
        each.iter_mut().for_each(|filter| filter.observe(&observation, &mut cost));
    }
    let p = mixture.attention().probabilities();
    assert!((p.iter().sum::<f64>() - 1.0).abs() < 1e-12 && p != [0.25, 0.5, 0.25], "{p:?}");
    let expected =
        |of: &dyn Fn(&ConditionalFilter) -> f64| -> f64 { each.iter().zip(p).map(|(one, p)| p * of(one)).sum() };
    for (index, aspect) in mixture.belief().aspects.iter().enumerate() {
        for (value, mean) in aspect.mean().iter().enumerate() {
            let of_each = expected(&|one| one.belief().aspects[index].mean()[value]);
            assert!((mean - of_each).abs() < 1e-6, "aspect {index}, value {value}: {mean}, not {of_each}");
        }
        let second = expected(&|one| one.belief().aspects[index].second());
        assert!((aspect.second() - second).abs() < 1e-4, "aspect {index}: {}, not {second}", aspect.second());
    }
    assert!((mixture.lapse() - expected(&|one| one.lapse())).abs() < 1e-12);
}

#[test]
fn a_human_model_without_the_key_has_one_attention_and_none_is_written() {
    let read = |text: &str| toml::from_str::<HumanModel>(text).expect("parameters");
    let old = read("[adapt]\nlapse = true\n");
    assert!(old.adapt.lapse && !old.adapt.attention);
    assert!(!toml::to_string(&old).expect("text").contains("attention"));
    let new = read("[adapt]\nattention = true\n");
    assert_eq!(read(&toml::to_string(&new).expect("text")), new);
    let kitchen = kitchen("layouts/sushi.toml");
    let filter = BeliefFilter::new(kitchen, old, 1);
    assert_eq!((filter.attention().times(), filter.attention().expected()), (&[1.0][..], 1.0));
}
