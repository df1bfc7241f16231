//! What the estimate learns about a person in a trial: how often it slips.

use std::path::Path;
use std::sync::Arc;

use tomcom::base::time::SessionTime;
use tomcom::edge::files::read_kitchen;
use tomcom::kitchen::cost_to_go::CostToGo;
use tomcom::kitchen::{Agent, ButtonId, Press};
use tomcom::mind::filter::BeliefFilter;
use tomcom::mind::model::HumanModel;
use tomcom::mind::observation::{Observation, ObservedEvidence};
use tomcom::mind::reference::ReferenceFilter;

use super::observed::recorded;

/// A human model whose lapse is learned.
fn learned_lapse() -> HumanModel {
    let mut model = HumanModel::default();
    model.adapt.lapse = true;
    model
}

/// Expected lapses of filter and reference after a trial of 90 presses in which every `slips`th press of the human is followed by one that does
/// nothing; 0: none is.
fn lapses_after(slips: usize) -> [f64; 2] {
    let kitchen = Arc::new(read_kitchen(Path::new("layouts/sushi.toml")).expect("a kitchen").kitchen);
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
    let kitchen = Arc::new(read_kitchen(Path::new("layouts/sushi.toml")).expect("a kitchen").kitchen);
    let filter = BeliefFilter::new(kitchen, HumanModel::default(), 1);
    assert_eq!(filter.lapse(), HumanModel::default().decision.lapse);
}
