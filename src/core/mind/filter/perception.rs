//! Perception: the update of the estimate by a gaze sample, in closed form.
//!
//! Where every sample is an observation, see [`super::sample_observation`]. Where looks are, a sample that covers dt
//! reads a location with probability 1 - exp(-rate dt), at a rate that falls with the distance of the gaze from the
//! location's area (see [`PerceptionModel`]). One look gives one draw from the confusion matrix: a location is read at
//! most once in a look. Let m0 be the belief at the start of the look, or after the last other event that changed the
//! belief; `unread` is the probability that the location had not been read in this look by then, and `survived` the
//! probability that it has not been read since. The weight of m0 in the present belief is 1 - unread (1 - survived);
//! the remaining weight is on the content that was read. Each sample moves a further share of m0 to that content. Mean
//! and second moment are exact.

use std::collections::VecDeque;
use std::sync::Arc;

use crate::base::time::SessionTime;
use crate::gaze::GazeSample;
use crate::kitchen::{AspectId, Kitchen, LocationId, State};
use crate::mind::dirichlet::DirichletBelief;
use crate::mind::model::{LocationReadingRate, PerceptionModel, PerceptionUnit};

use super::sample_observation::{NEGLIGIBLE, SampleObservations};

/// Share of the full reading rate below which the gaze counts as being elsewhere than at a location.
const ELSEWHERE: f64 = 0.1;

/// A look at a location: consecutive gaze samples near the location.
#[derive(Clone, Copy, Debug)]
struct Look {
    /// Probability that the location had not been read in this look up to the last event other than a gaze sample.
    unread: f64,
    /// Probability that the location has not been read since that last event.
    survived: f64,
    /// Code of the content that the display showed at the last sample of the look.
    code: u8,
    /// Time of the last sample of the look.
    last: SessionTime,
}

impl Look {
    /// Applies a probability `chance` that the location is read, given that it has not been read in this look. Returns
    /// the share of the present belief that the reading replaces.
    fn read(&mut self, chance: f64) -> f64 {
        let left = 1.0 - self.unread * (1.0 - self.survived);
        self.survived *= 1.0 - chance;
        1.0 - (1.0 - self.unread * (1.0 - self.survived)) / left.max(f64::MIN_POSITIVE)
    }
}

/// The update of the estimate by gaze samples, with looks and the display's history.
#[derive(Clone, Debug)]
pub struct GazeBeliefUpdate {
    /// The update by single samples, where these are observations.
    samples: Option<Arc<SampleObservations>>,
    /// Confusion matrix of each location: for each true value, the probability of reading each value.
    confusions: Vec<Vec<Vec<f64>>>,
    rate: LocationReadingRate,
    looks: Vec<Look>,
    /// Recent states of the display, each with the session time at which the state appeared.
    shown: VecDeque<(SessionTime, State)>,
}

impl GazeBeliefUpdate {
    /// The gaze update at the start of a trial, before the first gaze sample.
    pub fn new(kitchen: &Kitchen, model: &PerceptionModel) -> GazeBeliefUpdate {
        let of_location = |index: usize| {
            let values = kitchen.aspects[index].values.len();
            (0..values).map(|value| model.confusion(kitchen, LocationId(index as u8), value)).collect()
        };
        let confusions: Vec<_> = (0..kitchen.locations.len()).map(of_location).collect();
        let looks = vec![Look { unread: 1.0, survived: 1.0, code: 0, last: SessionTime::ZERO }; confusions.len()];
        let samples = match model.observation {
            PerceptionUnit::Sample => Some(Arc::new(SampleObservations::new(kitchen, model))),
            PerceptionUnit::Look => None,
        };
        GazeBeliefUpdate { samples, confusions, rate: model.reading_rate(), looks, shown: VecDeque::new() }
    }

    /// Records that the display shows `state` from `now` on.
    pub fn show(&mut self, now: SessionTime, state: State, history_s: f64) {
        self.shown.push_back((now, state));
        while self.shown.len() > 1 && now.secs_since(self.shown[1].0) > history_s {
            self.shown.pop_front();
        }
    }

    /// Records that an event other than reading is about to change the belief: the present belief becomes the new m0 of
    /// every look.
    pub fn settle(&mut self) {
        for look in &mut self.looks {
            look.unread *= look.survived;
            look.survived = 1.0;
        }
    }

    /// Shifts all stored times by the duration of a freeze probe, during which the task stood still.
    pub fn postpone(&mut self, by: SessionTime) {
        self.looks.iter_mut().for_each(|look| look.last = look.last + by);
        self.shown.iter_mut().for_each(|(since, _)| *since = *since + by);
    }

    /// Distribution of the value read at a location while the display shows `state`; empty if no value is shown there.
    pub fn reading(&self, kitchen: &Kitchen, location: LocationId, state: State) -> &[f64] {
        let value = kitchen.aspects[location.index()].index_of(state.code(location));
        value.map_or(&[], |value| &self.confusions[location.index()][value])
    }

    /// State that the display showed at `time`; `None` if that time is before the stored history.
    fn shown_at(&self, time: SessionTime) -> Option<State> {
        self.shown.iter().rev().find(|(since, _)| *since <= time).map(|(_, state)| *state)
    }

    /// Updates the estimate with a gaze sample taken at session time `taken`, during which the gaze is known for
    /// `known_s` seconds.
    pub fn read(
        &mut self,
        kitchen: &Kitchen,
        model: &PerceptionModel,
        belief: &mut DirichletBelief,
        sample: &GazeSample,
        taken: SessionTime,
        known_s: f64,
    ) {
        // A point that is NaN is not on the display: these comparisons are false for NaN.
        let on_display = (0.0..=1.0).contains(&sample.x) && (0.0..=1.0).contains(&sample.y);
        let is_usable = on_display && known_s > 0.0;
        let Some(state) = self.shown_at(taken).filter(|_| is_usable) else { return };
        if let Some(samples) = &self.samples {
            return observe(kitchen, model, samples, belief, sample, state);
        }
        let (full_hz, confidence) = (model.reading_rate_hz, sample.confidence.min(1.0));
        for (index, look) in self.looks.iter_mut().enumerate() {
            let distance_m = kitchen.locations[index].display.distance_m([sample.x, sample.y], kitchen.display_m);
            let rate_hz = self.rate.at(distance_m, confidence);
            let code = state.code(LocationId(index as u8));
            if code != look.code || taken.secs_since(look.last) > model.look_ends_s {
                (look.unread, look.survived) = (1.0, 1.0);
                look.code = code;
            }
            if rate_hz >= ELSEWHERE * full_hz * confidence {
                look.last = taken;
            }
            let read = look.read(-(-rate_hz * known_s).exp_m1());
            if read < NEGLIGIBLE {
                continue;
            }
            let aspect = AspectId(index as u8);
            let Some(value) = kitchen.aspects[index].index_of(code) else { continue };
            belief.aspects[aspect.index()].learn(read, self.confusions[index][value].iter().copied());
        }
    }
}

/// Updates the estimate by the observations of one gaze sample: of every location within the radius around the gaze.
fn observe(
    kitchen: &Kitchen,
    model: &PerceptionModel,
    samples: &SampleObservations,
    belief: &mut DirichletBelief,
    sample: &GazeSample,
    state: State,
) {
    if sample.confidence < model.min_confidence {
        return;
    }
    for (index, location) in kitchen.locations.iter().enumerate() {
        let code = state.code(LocationId(index as u8));
        let is_near = location.display.distance_m([sample.x, sample.y], kitchen.display_m) <= model.radius_m();
        if let Some(truth) = kitchen.aspects[index].index_of(code).filter(|_| is_near) {
            samples.observe(&mut belief.aspects[index], index, truth);
        }
    }
}
