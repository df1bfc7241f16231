//! Looks while the gaze is unknown, for each explicit belief: the human looks at what the human's next press needs.

use rand::RngExt;

use super::person::{Particle, pick};
use super::reading_effect::reading;
use crate::base::rng::Stream;
use crate::kitchen::cost_to_go::CostToGo;
use crate::kitchen::{Agent, AspectId, ButtonId, Kitchen, LocationId, State};
use crate::mind::model::HumanModel;

/// For each explicit belief, the probability that the human needs to look at each location before the next press.
#[derive(Clone, Debug)]
pub struct LookNeedProbabilities {
    needs: Vec<Vec<f64>>,
}

impl LookNeedProbabilities {
    /// Computes which locations the human of every belief needs to look at, from the press probabilities under that
    /// belief.
    pub fn before(
        kitchen: &Kitchen,
        model: &HumanModel,
        people: &[Particle],
        cost: &mut CostToGo,
        random: &mut Stream,
    ) -> LookNeedProbabilities {
        let own_hand = kitchen.hands[Agent::Human.index()];
        let mut needs_of = |person: &Particle| {
            let chances = person.press_chances(kitchen, cost, &model.decision, model.inference.states, random);
            let mut needs = vec![0.0; kitchen.locations.len()];
            for (button, chance) in chances.iter().enumerate() {
                for place in kitchen.watched(ButtonId(button as u8)).into_iter().filter(|&place| place != own_hand) {
                    needs[place.index()] += chance;
                }
            }
            needs
        };
        LookNeedProbabilities { needs: people.iter().map(&mut needs_of).collect() }
    }

    /// Draws looks for every belief at a display that shows `state`. `looks` are the expected looks at a location: if
    /// the next press does not need the location, and if it certainly does.
    pub fn look(
        &self,
        kitchen: &Kitchen,
        model: &HumanModel,
        people: &mut [Particle],
        state: State,
        [least, needed]: [f64; 2],
        random: &mut Stream,
    ) {
        for (person, needs) in people.iter_mut().zip(&self.needs) {
            for (index, need) in needs.iter().enumerate() {
                let expected = least + (needed - least) * need;
                if random.random::<f64>() < 1.0 - (-expected).exp() {
                    read(kitchen, model, person, LocationId(index as u8), state, random);
                }
            }
        }
    }
}

/// Draws for every belief whether the human reads what changed between two states, with probability `seen` at each
/// location.
pub fn see_changes(
    kitchen: &Kitchen,
    model: &HumanModel,
    people: &mut [Particle],
    [before, after]: [State; 2],
    seen: f64,
    random: &mut Stream,
) {
    for index in 0..kitchen.locations.len() {
        let location = LocationId(index as u8);
        if before.code(location) == after.code(location) {
            continue;
        }
        for person in &mut *people {
            if random.random::<f64>() < seen {
                read(kitchen, model, person, location, after, random);
            }
        }
    }
}

/// Draws for every belief looks at each location of a bit set, with probability `looks`; a look reads the content that
/// the state has there.
pub fn asked(
    kitchen: &Kitchen,
    model: &HumanModel,
    people: &mut [Particle],
    (locations, state): (u32, State),
    looks: f64,
    random: &mut Stream,
) {
    for index in (0..kitchen.locations.len()).filter(|index| locations & 1 << index != 0) {
        for person in &mut *people {
            if random.random::<f64>() < looks {
                read(kitchen, model, person, LocationId(index as u8), state, random);
            }
        }
    }
}

/// Makes a belief certain of the content that is read at a location.
fn read(
    kitchen: &Kitchen,
    model: &HumanModel,
    person: &mut Particle,
    location: LocationId,
    state: State,
    random: &mut Stream,
) {
    if let Some(value) = kitchen.aspects[location.index()].index_of(state.code(location)) {
        let value = pick(&reading(kitchen, &model.perception, location, value), random);
        person.settle(AspectId::of_location(location), value);
    }
}
