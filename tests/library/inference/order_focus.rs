//! Which orders people consider: presses for one order tell nothing of the other.

use tomcom::kitchen::cost_to_go::CostToGo;
use tomcom::kitchen::{Agent, AspectId, Press};
use tomcom::mind::filter::BeliefFilter;
use tomcom::mind::model::HumanModel;
use tomcom::mind::observation::ObservedEvidence;

use super::observed::recorded;
use super::world::kitchen;

/// Over the presses of recorded simulated participants: the log likelihood per press, and the mean expected P(truth) of
/// what is ordered.
fn presses_and_orders(one_order: f64) -> [f64; 2] {
    let kitchen = kitchen("layouts/sushi.toml");
    let mut model = HumanModel::default();
    (model.decision.one_order, model.decision.tau) = (one_order, 8.0);
    let mut cost = CostToGo::new(kitchen.clone());
    let (mut sums, mut presses, mut orders) = ([0.0; 2], 0, 0);
    for seed in [21, 9961] {
        let mut filter = BeliefFilter::new(kitchen.clone(), model.clone(), 1);
        let mut shown = kitchen.empty_state();
        for observation in recorded(&kitchen, seed, 200) {
            let own = matches!(observation.what, ObservedEvidence::Pressed(Press { agent: Agent::Human, .. }));
            if own {
                for (order, _) in kitchen.wanted(shown) {
                    sums[1] += filter.belief().p_truth(&kitchen, shown, AspectId::of_location(order));
                    orders += 1;
                }
            }
            filter.observe(&observation, &mut cost);
            match observation.what {
                ObservedEvidence::Started { state } | ObservedEvidence::Displayed { state } => shown = state,
                ObservedEvidence::Pressed(press) => shown = press.after,
                _ => {}
            }
            if own {
                sums[0] += filter.evidence().expect("evidence").log_p;
                presses += 1;
            }
        }
    }
    [sums[0] / f64::from(presses), sums[1] / f64::from(orders)]
}

#[test]
fn simulated_participants_press_as_people_who_consider_one_order() {
    let [[all, known], [one, known_of_one]] = [0.0, 0.8].map(presses_and_orders);
    println!(
        "log likelihood per press {all:.3}, considering one order {one:.3}; P(truth) of what is ordered {known:.3}, \
         {known_of_one:.3}"
    );
    assert!(one > all + 0.03, "{all} {one}");
    assert!(known_of_one > known + 0.01, "presses for one order seemed to say that the other is unknown");
}
