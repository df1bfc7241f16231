//! Perception: the update of the estimate by a gaze sample, in closed form.
//!
//! Where every sample is an observation, see [`SampleObservations`]. Where looks are, a sample that covers dt
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
use crate::kitchen::{Kitchen, LocationId, State};
use crate::mind::dirichlet::{Dirichlet, DirichletBelief, LEAST_MEAN, PRECISIONS};
use crate::mind::model::{LocationReadingRate, PerceptionModel, PerceptionUnit};

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
            PerceptionUnit::Sample => Some(Arc::new(SampleObservations::new(&confusions))),
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
        let is_usable = sample.is_on_display() && known_s > 0.0;
        let Some(state) = self.shown_at(taken).filter(|_| is_usable) else { return };
        if let Some(samples) = &self.samples {
            return self.observe(kitchen, model, samples, belief, sample, state);
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
            let Some(value) = kitchen.aspects[index].index_of(code) else { continue };
            belief.aspects[index].learn(read, self.confusions[index][value].iter().copied());
        }
    }

    /// Updates the estimate by the observations of one gaze sample: of every location within the radius around the gaze.
    fn observe(
        &self,
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
                samples.observe(&mut belief.aspects[index], index, truth, &self.confusions[index][truth]);
            }
        }
    }
}

// Perception where every gaze sample is an observation (paper, equation 1): the human sees o with the probability
// c(o | s) of the true content s, and updates a belief b by Bayes' rule, b'_v = c(o | v) b_v / sum_u c(o | u) b_u.
//
// The observer does not know o, and b is Dirichlet, so the update is averaged over both. With b_v = g_v / sum_u g_u
// for independent g_v ~ Gamma(alpha_v), w_v = c(o | v) and 1 / x^n = integral of t^(n - 1) exp(-t x) / (n - 1)! over
// t,
//
// ```text
// E[b'_v]   = alpha_v               integral of (w_v / (1 + t w_v))     P(t) dt
// E[b'_v^2] = alpha_v (alpha_v + 1) integral of t (w_v / (1 + t w_v))^2 P(t) dt
// P(t)      = product over u of (1 + t w_u)^(-alpha_u)
// ```
//
// With t = e^x the integrands are analytic and fall exponentially on both sides, so the trapezoidal rule is exact to
// about ten digits; what lies beyond its ends is a geometric series.

/// Contents that would be read with a smaller probability than this are ignored.
pub const NEGLIGIBLE: f64 = 1e-9;

/// Distance of neighbouring points x of the trapezoidal rule.
const STEP: f64 = 0.375;
/// At the first point, t times the largest precision is e^-SIDE; at the last one, t times the smallest weight is
/// e^SIDE.
const SIDE: f64 = 20.0;
/// Least weight c(o | v), so that an observation which the human holds to be impossible leaves a proper belief.
const LEAST_WEIGHT: f64 = 1e-9;

/// The update of beliefs by observations of single gaze samples.
#[derive(Clone, Debug)]
pub struct SampleObservations {
    /// For each weight c(o | v), at the points of the trapezoidal rule: ln(1 + t w), and t w / (1 + t w).
    weights: Vec<Vec<[f64; 2]>>,
    /// `[location][o][v]`: index of c(o | v) among the weights.
    weight_of: Vec<Vec<Vec<usize>>>,
}

/// Values of one class: those with the same weight c(o | v).
#[derive(Clone, Copy, Debug, Default)]
struct ValueClass {
    /// Sum of the alphas, and of alpha (alpha + 1).
    alpha: f64,
    squares: f64,
    /// Integrals of the first and of the second moment, before multiplication with the alphas.
    integrals: [f64; 2],
}

impl SampleObservations {
    /// `confusions` has c(o | s) by location, displayed value s, and observed value o.
    fn new(confusions: &[Vec<Vec<f64>>]) -> SampleObservations {
        let mut all: Vec<f64> = Vec::new();
        let mut index_of = |weight: f64| {
            let weight = weight.max(LEAST_WEIGHT);
            all.iter().position(|other| *other == weight).unwrap_or_else(|| {
                all.push(weight);
                all.len() - 1
            })
        };
        let of_location = |confusion: &Vec<Vec<f64>>| -> Vec<Vec<usize>> {
            let of_observed = |seen: usize| confusion.iter().map(|row| index_of(row[seen])).collect();
            (0..confusion.len()).map(of_observed).collect()
        };
        let weight_of = confusions.iter().map(of_location).collect();
        let least = all.iter().copied().fold(1.0, f64::min);
        let [first, last] = [-PRECISIONS[1].ln() - SIDE, SIDE - least.ln()];
        let times: Vec<f64> =
            (0..=((last - first) / STEP).ceil() as usize).map(|point| (first + STEP * point as f64).exp()).collect();
        let at_points =
            |weight: f64| times.iter().map(|t| [(t * weight).ln_1p(), t * weight / (1.0 + t * weight)]).collect();
        SampleObservations { weights: all.into_iter().map(at_points).collect(), weight_of }
    }

    /// Updates the belief about a location by an observation of it, where the value `truth` is displayed; `confusion` is
    /// the probability of observing each value.
    fn observe(&self, belief: &mut Dirichlet, location: usize, truth: usize, confusion: &[f64]) {
        let weight_of = &self.weight_of[location];
        let values = belief.mean().len();
        // A belief that is as certain as a Dirichlet may be here stays what it is.
        if 1.0 - belief.mean()[truth] <= 2.0 * LEAST_MEAN * values as f64 {
            return;
        }
        let alphas: Vec<f64> = (0..values).map(|value| belief.alpha(value)).collect();
        let (mut mean, mut second) = (vec![0.0; values], 0.0);
        let mut classes = vec![ValueClass::default(); self.weights.len()];
        for (seen, &p) in confusion.iter().enumerate().filter(|(_, p)| **p >= NEGLIGIBLE) {
            classes.fill(ValueClass::default());
            for (alpha, &weight) in alphas.iter().zip(&weight_of[seen]) {
                classes[weight].alpha += alpha;
                classes[weight].squares += alpha * (alpha + 1.0);
            }
            self.integrate(&mut classes, belief.precision());
            for ((mean, alpha), &weight) in mean.iter_mut().zip(&alphas).zip(&weight_of[seen]) {
                *mean += p * alpha * classes[weight].integrals[0];
            }
            second += p * classes.iter().map(|class| class.squares * class.integrals[1]).sum::<f64>();
        }
        *belief = Dirichlet::of_moments(mean, second);
    }

    fn integrate(&self, classes: &mut [ValueClass], precision: f64) {
        let used: Vec<usize> = (0..classes.len()).filter(|&index| classes[index].alpha > 0.0).collect();
        let points = self.weights[used[0]].len();
        let height = |classes: &[ValueClass], point: usize| {
            let exponents = used.iter().map(|&index| classes[index].alpha * self.weights[index][point][0]);
            STEP * (-exponents.sum::<f64>()).exp()
        };
        for point in 0..points {
            let height = height(classes, point);
            let mut is_over = true;
            for &index in &used {
                let ratio = self.weights[index][point][1];
                let [first, second] = &mut classes[index].integrals;
                let sums = [*first + height * ratio, *second + height * ratio * ratio];
                is_over &= sums == [*first, *second];
                [*first, *second] = sums;
            }
            // Logarithms of the integrands are concave: beyond a point that changes no sum, no point changes one.
            if is_over {
                break;
            }
        }
        // Before the first point the integrands are proportional to t and t^2; after the last one to t^-precision.
        let after = height(classes, points - 1) / (precision * STEP).exp_m1();
        for &index in &used {
            let ratio = self.weights[index][0][1];
            let [first, second] = &mut classes[index].integrals;
            *first += STEP * ratio / STEP.exp_m1() + after;
            *second += STEP * ratio * ratio / (2.0 * STEP).exp_m1() + after;
        }
    }
}
