//! Gaze that passes reads nothing: where reading begins after some time of a look, by its closed form and against plain
//! particles.

use tomcom::base::rng::stream;
use tomcom::base::time::SessionTime;
use tomcom::gaze::GazeSample;
use tomcom::kitchen::cost_to_go::CostToGo;
use tomcom::kitchen::{AspectId, DishId, Kitchen, OrderContent};
use tomcom::mind::filter::BeliefFilter;
use tomcom::mind::model::HumanModel;
use tomcom::mind::observation::{Observation, ObservedEvidence};
use tomcom::mind::reference::belief_set::ParticleSet;

use super::looks_at_nothing;
use super::world::kitchen;

const BEGINS_S: f64 = 0.05;
const RATE_HZ: f64 = 10.0;
const SAMPLE_S: f64 = 0.01;

fn model() -> HumanModel {
    let mut model = looks_at_nothing();
    (model.perception.reading_begins_s, model.perception.reading_rate_hz) = (BEGINS_S, RATE_HZ);
    (model.perception.look_alike, model.perception.anything) = (0.0, 0.0);
    model
}

/// An order appears; then looks at it of these numbers of samples, a second apart.
fn events(kitchen: &Kitchen, looks: &[u32]) -> Vec<Observation> {
    let at = |seconds: f64, what| Observation { time: SessionTime::from_secs_f64(seconds), what };
    let mut state = kitchen.empty_state();
    let mut events = vec![at(0.0, ObservedEvidence::Started { state })];
    state.set_order(kitchen.orders[0], OrderContent::Dish(DishId(0)));
    events.push(at(0.5, ObservedEvidence::Displayed { state }));
    let [x, y] = kitchen.location(kitchen.orders[0]).display.centre();
    let mut gaze = |seconds: f64, x: f64, y: f64| {
        let (sample, taken) = (GazeSample::new(x, y, 1.0), SessionTime::from_secs_f64(seconds));
        events.push(Observation { time: taken, what: ObservedEvidence::Gaze { sample, taken } });
    };
    for (second, &samples) in (1..).zip(looks) {
        let from_s = f64::from(second);
        // A sample at a far corner just before, so that the first one at the order covers no more than its own time.
        gaze(from_s - SAMPLE_S, 0.99, 0.99);
        (0..samples).for_each(|sample| gaze(from_s + f64::from(sample) * SAMPLE_S, x, y));
    }
    events
}

/// How much of the belief before the looks is left: the expected share of those who have not read the order.
fn unread(looks: &[u32]) -> f64 {
    let kitchen = kitchen("layouts/sushi.toml");
    let mut cost = CostToGo::new(kitchen.clone());
    let mut p_none = |looks: &[u32]| {
        let mut filter = BeliefFilter::new(kitchen.clone(), model(), 3);
        events(&kitchen, looks).iter().for_each(|event| filter.observe(event, &mut cost));
        let aspect = AspectId::of_location(kitchen.orders[0]);
        filter.belief().p_truth(&kitchen, kitchen.empty_state(), aspect)
    };
    p_none(looks) / p_none(&[])
}

#[test]
fn a_look_is_read_from_a_certain_time_on_and_every_look_begins_anew() {
    assert!((unread(&[4]) - 1.0).abs() < 1e-9, "gaze that passes reads nothing");
    assert!((unread(&[4, 4, 4]) - 1.0).abs() < 1e-9, "however often");
    for samples in [8, 20] {
        let expected = (-RATE_HZ * (f64::from(samples) * SAMPLE_S - BEGINS_S)).exp();
        let unread = unread(&[samples]);
        assert!((unread - expected).abs() < 1e-6, "{samples} samples: {unread} instead of {expected}");
    }
}

#[test]
fn the_closed_form_is_that_of_people_who_read_so() {
    let kitchen = kitchen("layouts/sushi.toml");
    let mut random = stream(11, "reading begins", 0);
    let mut cost = CostToGo::new(kitchen.clone());
    for looks in [&[4][..], &[8], &[20], &[7, 4, 9]] {
        let mut people = ParticleSet::new(kitchen.clone(), model());
        people.start(SessionTime::ZERO, kitchen.empty_state(), 4000, &mut random);
        for event in events(&kitchen, looks).iter().skip(1) {
            people.experience(event, &mut cost, &mut random);
        }
        let aspect = AspectId::of_location(kitchen.orders[0]);
        let none = kitchen.true_value(kitchen.empty_state(), aspect);
        let of_people = people.projected(&vec![1.0; people.of.len()]);
        let of_filter = {
            let mut filter = BeliefFilter::new(kitchen.clone(), model(), 3);
            events(&kitchen, looks).iter().for_each(|event| filter.observe(event, &mut cost));
            filter.belief().clone()
        };
        let [exact, plain] = [&of_filter, &of_people].map(|belief| belief.aspect(aspect).mean()[none]);
        assert!((exact - plain).abs() < 0.025, "{looks:?}: {exact} {plain}");
    }
}
