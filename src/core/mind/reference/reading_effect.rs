//! The effect of a gaze sample at each location: the probability that the location is read, or that it is observed, and
//! the distribution of the value that is read or observed.

use crate::base::time::SessionTime;
use crate::gaze::GazeSample;
use crate::kitchen::{ContentId, DishId, Kitchen, LocationId, LocationKind, OrderContent, State};
use crate::mind::model::{PerceptionModel, PerceptionUnit};

/// Share of the full reading rate below which the gaze counts as being elsewhere than at a location.
const ELSEWHERE: f64 = 0.1;

/// The effect of a gaze sample at one location.
#[derive(Clone, Debug, PartialEq)]
pub struct LocationReading {
    /// The location that the gaze sample may read.
    pub location: LocationId,
    /// Whether the sample begins a new look, in which the location can be read again.
    pub begins: bool,
    /// Probability that the location is read by this sample, given that it was not yet read in this look.
    pub chance: f64,
    /// Distribution of the value that is read at the location.
    pub reading: Vec<f64>,
    /// Where the sample is an observation: `[v][o]`, the probability of observing value o where v is the true one, by
    /// which the belief is updated. Where a look is one, the belief becomes certain of what was read.
    pub observation: Option<Vec<Vec<f64>>>,
}

/// A look at a location.
#[derive(Clone, Copy, Debug, Default)]
struct Look {
    /// Code of the content that is displayed.
    code: u8,
    /// Time of the last sample.
    last: SessionTime,
}

/// Tracks looks at locations and the recent states of the display.
#[derive(Clone, Debug, Default)]
pub struct LookTracker {
    /// Recent states of the display, each with the session time at which the state appeared.
    shown: Vec<(SessionTime, State)>,
    /// The present look at each location.
    looks: Vec<Look>,
}

impl LookTracker {
    /// Records that the display shows `state` from `now` on.
    pub fn show(&mut self, now: SessionTime, state: State) {
        self.shown.push((now, state));
    }

    /// Moves all times on by a duration for which the task stood still.
    pub fn postpone(&mut self, by: SessionTime) {
        self.shown.iter_mut().for_each(|(since, _)| *since = *since + by);
        self.looks.iter_mut().for_each(|look| look.last = look.last + by);
    }

    /// The effect at each location of a gaze sample taken at session time `taken`, during which the gaze is known for
    /// `known_s` seconds.
    pub fn glances(
        &mut self,
        kitchen: &Kitchen,
        model: &PerceptionModel,
        sample: &GazeSample,
        taken: SessionTime,
        known_s: f64,
    ) -> Vec<LocationReading> {
        let on_display = (0.0..=1.0).contains(&sample.x) && (0.0..=1.0).contains(&sample.y);
        if !on_display || known_s <= 0.0 {
            return Vec::new();
        }
        let Some(state) = self.shown_at(taken, model.history_s) else { return Vec::new() };
        let confidence = sample.confidence.min(1.0);
        self.looks.resize(kitchen.locations.len(), Look::default());
        let mut glances = Vec::new();
        for index in 0..kitchen.locations.len() {
            let location = LocationId(index as u8);
            let distance_m = kitchen.locations[index].display.distance_m([sample.x, sample.y], kitchen.display_m);
            let rate_hz = model.reading_rate().at(distance_m, confidence);
            let code = state.code(location);
            let look = &mut self.looks[index];
            let begins = code != look.code || taken.secs_since(look.last) > model.look_ends_s;
            if begins {
                *look = Look { code, ..*look };
            }
            if model.observation == PerceptionUnit::Sample {
                let Some(value) = kitchen.aspects[index].index_of(code) else { continue };
                if distance_m <= model.radius_m() && sample.confidence >= model.min_confidence {
                    let values = 0..kitchen.aspects[index].values.len();
                    let all: Vec<_> = values.map(|value| reading(kitchen, model, location, value)).collect();
                    let (reading, observation) = (all[value].clone(), Some(all));
                    glances.push(LocationReading { location, begins: true, chance: 1.0, reading, observation });
                }
                continue;
            }
            if rate_hz >= ELSEWHERE * model.reading_rate_hz * confidence {
                look.last = taken;
            }
            let Some(value) = kitchen.aspects[index].index_of(code) else { continue };
            let chance = 1.0 - (-rate_hz * known_s).exp();
            glances.push(LocationReading {
                location,
                begins,
                chance,
                reading: reading(kitchen, model, location, value),
                observation: None,
            });
        }
        glances
    }

    /// State that the display showed at `time`; `None` if that time is before the stored history.
    fn shown_at(&self, time: SessionTime, history_s: f64) -> Option<State> {
        let newest = self.shown.last().map(|(since, _)| *since)?;
        let (at, (_, state)) = self.shown.iter().enumerate().rev().find(|(_, (since, _))| *since <= time)?;
        // A state of the display is stored until its successor is older than the history.
        let is_known = self.shown.get(at + 1).is_none_or(|(until, _)| newest.secs_since(*until) <= history_s);
        is_known.then_some(*state)
    }
}

/// The probability of reading each value of a location, given its true value (a row of the confusion matrix).
pub fn reading(kitchen: &Kitchen, model: &PerceptionModel, location: LocationId, value: usize) -> Vec<f64> {
    let aspect = &kitchen.aspects[location.index()];
    let alike: Vec<bool> =
        aspect.values.iter().map(|&other| is_alike(kitchen, location, aspect.values[value], other)).collect();
    let count = alike.iter().filter(|alike| **alike).count();
    let others = aspect.values.len() - 1 - count;
    let to_alike = if count == 0 { 0.0 } else { model.look_alike };
    let to_others = if others == 0 { 0.0 } else { model.anything };
    let chance = |other: usize| match alike[other] {
        _ if other == value => 1.0 - to_alike - to_others,
        true => to_alike / count as f64,
        false => to_others / others as f64,
    };
    (0..aspect.values.len()).map(chance).collect()
}

/// Whether one code of a location looks like another one.
fn is_alike(kitchen: &Kitchen, location: LocationId, code: u8, other: u8) -> bool {
    let stack = |dish: DishId| kitchen.dish(dish).stack();
    let (one, another) = match kitchen.location(location).kind {
        LocationKind::Order => match (OrderContent::from_code(code), OrderContent::from_code(other)) {
            (OrderContent::Dish(one), OrderContent::Dish(another)) => (stack(one), stack(another)),
            _ => return false,
        },
        _ => (ContentId(code), ContentId(other)),
    };
    kitchen.content(one).look_alikes.contains(&another)
}
