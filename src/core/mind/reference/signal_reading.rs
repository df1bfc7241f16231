//! The signal on the display, followed for each explicit belief: the human of a belief reads the signal or misses it.

use rand::RngExt;

use super::person::{Particle, pick};
use crate::base::rng::Stream;
use crate::base::time::SessionTime;
use crate::gaze::GazeSample;
use crate::kitchen::{AspectId, Kitchen, LocationId, LocationKind, State};
use crate::mind::model::HumanModel;

/// The signal on the display.
#[derive(Clone, Debug)]
struct ShownContent {
    location: LocationId,
    aspects: Vec<AspectId>,
    since: SessionTime,
    noticed: f64,
}

/// The signal on the display, if there is one.
#[derive(Clone, Debug, Default)]
pub struct ReferenceSignalHistory {
    shown: Option<ShownContent>,
}

impl ReferenceSignalHistory {
    /// A signal takes the place of the one before it.
    pub fn show(
        &mut self,
        kitchen: &Kitchen,
        model: &HumanModel,
        now: SessionTime,
        (location, aspects): (LocationId, Vec<AspectId>),
    ) {
        let noticed = match kitchen.location(location).kind {
            LocationKind::Order => model.signal.noticed,
            _ => model.signal.highlight_noticed.unwrap_or(model.signal.noticed),
        };
        self.shown = Some(ShownContent { location, aspects, since: now, noticed });
    }

    /// The signal leaves the display.
    pub fn end(&mut self) {
        self.shown = None;
    }

    /// Moves the signal's beginning on by a duration for which the task stood still.
    pub fn postpone(&mut self, by: SessionTime) {
        self.shown.iter_mut().for_each(|shown| shown.since = shown.since + by);
    }

    /// Lets the human of every belief notice the signal, or not, where signals take no time to be read.
    pub fn read_at_once(
        &mut self,
        kitchen: &Kitchen,
        model: &HumanModel,
        people: &mut [Particle],
        state: State,
        random: &mut Stream,
    ) {
        if let Some(shown) = self.shown.take() {
            shown.read(kitchen, model, people, shown.noticed, state, random);
            people.iter_mut().for_each(|person| person.read_signal = false);
        }
    }

    /// Lets every belief read the signal in a gaze sample whose gaze is known for `known_s` seconds.
    pub fn look(
        &self,
        kitchen: &Kitchen,
        model: &HumanModel,
        people: &mut [Particle],
        (sample, taken, known_s): (&GazeSample, SessionTime, f64),
        state: State,
        random: &mut Stream,
    ) {
        let Some(shown) = self.shown.as_ref().filter(|shown| taken >= shown.since) else { return };
        if !(0.0..=1.0).contains(&sample.x) || !(0.0..=1.0).contains(&sample.y) {
            return;
        }
        let distance_m = kitchen.location(shown.location).display.distance_m([sample.x, sample.y], kitchen.display_m);
        let near = (-distance_m.powi(2) / (2.0 * model.perception.radius_m().powi(2))).exp();
        let rate_hz = model.signal.reading_rate_hz * near * sample.confidence.min(1.0);
        shown.read(kitchen, model, people, 1.0 - (-rate_hz * known_s).exp(), state, random);
    }

    /// Lets the human of every belief notice the signal, or not, in `seconds` of unknown gaze up to `until`.
    pub fn look_unseen(
        &self,
        kitchen: &Kitchen,
        model: &HumanModel,
        people: &mut [Particle],
        (seconds, until): (f64, SessionTime),
        state: State,
        random: &mut Stream,
    ) {
        let Some(shown) = &self.shown else { return };
        // Of those who notice the signal, the share that has read it t seconds after its beginning is 1 - exp(-L (1 -
        // exp(-t / delay))) for exp(-L) = 1 - noticed.
        let most = -(1.0 - shown.noticed.min(0.999)).ln();
        let hazard = |time_s: f64| most * (1.0 - (-time_s.max(0.0) / model.signal.delay_s).exp());
        let until_s = until.secs_since(shown.since);
        let passed = hazard(until_s) - hazard(until_s - seconds);
        shown.read(kitchen, model, people, 1.0 - (-passed).exp(), state, random);
    }
}

impl ShownContent {
    /// Lets the human of each belief read the signal with the probability `chance`.
    fn read(
        &self,
        kitchen: &Kitchen,
        model: &HumanModel,
        people: &mut [Particle],
        chance: f64,
        state: State,
        random: &mut Stream,
    ) {
        for person in people {
            if random.random::<f64>() >= chance {
                continue;
            }
            person.read_signal = true;
            for &aspect in &self.aspects {
                let values = kitchen.aspects[aspect.index()].values.len();
                let truth = kitchen.true_value(state, aspect);
                let weight = |value: usize| match value == truth {
                    true => 1.0 - model.signal.misread,
                    false => model.signal.misread / (values - 1) as f64,
                };
                let weights: Vec<f64> = (0..values).map(weight).collect();
                person.settle(aspect, pick(&weights, random));
            }
        }
    }
}
