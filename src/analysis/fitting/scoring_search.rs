//! The method of scoring for a noisy log likelihood within bounds: each step leads to the maximum of a quadratic surface
//! whose curvature follows from the scores of single presses (Berndt, Hall, Hall and Hausman 1974). Single comparisons of
//! values are unreliable under noise; a surface averages the noise over its points and estimates the size of the noise.

use super::score_surface::{QuadraticSurface, REACH, TriedPoint, points, points_around, surface};

/// Step size of the first surface.
const FIRST_STEP: f64 = 0.4;
/// Steps of the search are chosen so that one step lowers the log likelihood by this much: least and most in nats, and
/// in standard deviations of the noise.
const STEP_NATS: [f64; 2] = [1.0, 6.0];
const STEP_NOISE: f64 = 0.5;
/// Least and largest size of a step of the search, and the largest factor between the sizes of successive steps.
const STEPS: [f64; 2] = [0.02, 1.6];
const STEP_CHANGE: f64 = 2.5;
/// Difference of log likelihoods that is significant at 5 %: half the 95 % quantile of chi squared with one degree of
/// freedom.
pub(super) const REJECTED_NATS: f64 = 1.92;
/// Distance to a bound below which a variable counts as lying at the bound.
const CLOSE: f64 = 1e-9;

/// The bound (lower or upper) at which a variable has its maximum.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum BoundReached {
    /// The variable's maximum lies at its lower bound.
    Low,
    /// The variable's maximum lies at its upper bound.
    High,
}

/// Least value of a surface within reach, in nats.
pub(super) fn lowest(surface: &QuadraticSurface) -> f64 {
    let reach = vec![REACH; surface.slope.len()];
    surface.at(&surface.least(&reach.iter().map(|reach| -reach).collect::<Vec<f64>>(), &reach))
}

/// A search for the maximum of a log likelihood, and what it has found so far.
pub(super) struct ScoringSearch<'a, F> {
    losses: F,
    /// Lower and upper bound of each variable.
    pub(super) bounds: &'a [[f64; 2]],
    /// Points of all surfaces, with the loss of each press.
    tried: Vec<(Vec<f64>, Vec<f64>)>,
    /// Point with the least loss that the search has found so far.
    pub(super) at: Vec<f64>,
    /// Step size of each variable.
    pub(super) steps: Vec<f64>,
    /// Number of evaluations of the log likelihood so far.
    pub(super) evaluations: usize,
    most: usize,
}

impl<'a, F: FnMut(&[f64]) -> Option<Vec<f64>>> ScoringSearch<'a, F> {
    /// A search from `start`, which is moved inside the bounds, with about `most` evaluations of `losses`: the negative log
    /// likelihood of each press in nats.
    pub(super) fn begin(losses: F, start: &[f64], bounds: &'a [[f64; 2]], most: usize) -> ScoringSearch<'a, F> {
        let inside = |(at, [low, high]): (&f64, &[f64; 2])| at.clamp(*low, *high);
        let at: Vec<f64> = start.iter().zip(bounds).map(inside).collect();
        ScoringSearch { losses, bounds, tried: Vec::new(), steps: vec![FIRST_STEP; at.len()], at, evaluations: 0, most }
    }

    /// Maximises the likelihood over the free variables. Returns the surface around the maximum (`Some(None)` without
    /// free variables), or `None` if the search did not converge.
    pub(super) fn climb(&mut self, free: &[usize]) -> Option<Option<QuadraticSurface>> {
        if free.is_empty() {
            return Some(None);
        }
        // Least value at the centre of a surface, and that centre.
        let mut best = None::<(f64, Vec<f64>)>;
        loop {
            let before = self.at.clone();
            let (surface, by) = self.step(free)?;
            // Where the curvature changes much, a step can lead too far: then it is halved.
            if let Some((value, at)) = &best
                && surface.value > value + surface.noise * share_of_noise(free.len())
            {
                let is_close = free.iter().all(|&index| (before[index] - at[index]).abs() < self.steps[index] / 2.0);
                self.at = before.iter().zip(at).map(|(before, at)| (before + at) / 2.0).collect();
                if is_close {
                    best = None;
                }
                continue;
            }
            if best.as_ref().is_none_or(|(value, _)| surface.value < *value) {
                best = Some((surface.value, before));
            }
            // The search stops here: poorly determined variables only move with the noise, and further steps gain
            // nothing.
            let gain = surface.value - surface.at(&by);
            let is_noise =
                surface.covariance().is_some() && gain <= REJECTED_NATS + surface.noise * share_of_noise(free.len());
            let is_near = free.iter().zip(&by).all(|(&index, by)| by.abs() <= 1.0 || self.end(index).is_some());
            let wanted = self.wanted_steps(free, &surface);
            let is_telling = free.iter().zip(&wanted).all(|(&index, wanted)| {
                let change = wanted / self.steps[index];
                (0.5..=2.0).contains(&change) || self.end(index).is_some()
            });
            if (is_near || is_noise) && is_telling {
                return Some(Some(surface));
            }
            free.iter().zip(wanted).for_each(|(&index, wanted)| self.steps[index] = wanted);
        }
    }

    /// Goes to the least value of a surface around the best point. Returns the surface, and how far that was, in steps from
    /// the surface's centre; `None` if too few evaluations are left.
    pub(super) fn step(&mut self, free: &[usize]) -> Option<(QuadraticSurface, Vec<f64>)> {
        let (centre, surface) = self.survey(free)?;
        let by = self.least(free, &centre, &surface);
        for ((&index, centre), by) in free.iter().zip(&centre).zip(&by) {
            self.at[index] = (centre + by * self.steps[index]).clamp(self.bounds[index][0], self.bounds[index][1]);
        }
        Some((surface, by))
    }

    /// A surface over the free variables around the best point, inside the bounds, with the surface's centre;
    /// `None` if too few evaluations are left.
    fn survey(&mut self, free: &[usize]) -> Option<(Vec<f64>, QuadraticSurface)> {
        if self.evaluations + points(free.len()) > self.most {
            return None;
        }
        for &index in free {
            let [low, high] = self.bounds[index];
            self.steps[index] = self.steps[index].min((high - low) / 2.0);
        }
        let inside = |&index: &usize| {
            let ([low, high], step) = (self.bounds[index], self.steps[index]);
            self.at[index].clamp(low + step, (high - step).max(low + step))
        };
        let centre: Vec<f64> = free.iter().map(inside).collect();
        let steps: Vec<f64> = free.iter().map(|&index| self.steps[index]).collect();
        for point in points_around(&centre, &steps) {
            let mut whole = self.at.clone();
            free.iter().zip(point).for_each(|(&index, at)| whole[index] = at);
            self.evaluations += 1;
            self.tried.extend((self.losses)(&whole).map(|losses| (whole, losses)));
        }
        let is_held = |index: &usize| !free.contains(index);
        let has_held =
            |at: &[f64]| (0..at.len()).filter(is_held).all(|index| (at[index] - self.at[index]).abs() <= CLOSE);
        let of_free = |at: &[f64]| -> Vec<f64> { free.iter().map(|&index| at[index]).collect() };
        let tried = self.tried.iter().filter(|(at, _)| has_held(at)).map(|(at, losses)| (of_free(at), &losses[..]));
        surface(&tried.collect::<Vec<TriedPoint<'_>>>(), &centre, &steps).map(|surface| (centre, surface))
    }

    fn least(&self, free: &[usize], centre: &[f64], surface: &QuadraticSurface) -> Vec<f64> {
        let in_steps = |end: usize, reach: f64| -> Vec<f64> {
            let of = |(&index, centre): (&usize, &f64)| (self.bounds[index][end] - centre) / self.steps[index];
            free.iter()
                .zip(centre)
                .map(of)
                .map(|by: f64| if end == 0 { by.max(reach) } else { by.min(reach) })
                .collect()
        };
        surface.least(&in_steps(0, -REACH), &in_steps(1, REACH))
    }

    /// Step sizes of the variables whose effect on the likelihood just exceeds the noise.
    fn wanted_steps(&self, free: &[usize], surface: &QuadraticSurface) -> Vec<f64> {
        let [least, most] = STEP_NATS.map(|nats| nats + STEP_NOISE * surface.noise);
        let wanted = |(place, &index): (usize, &usize)| {
            let rise = surface.curvature[(place, place)] / 2.0;
            let change = match rise {
                _ if rise > most || rise > 0.0 && rise < least => ((least * most).sqrt() / rise).sqrt(),
                _ if rise > 0.0 => 1.0,
                _ => STEP_CHANGE,
            };
            let [low, high] = self.bounds[index];
            let step = self.steps[index] * change.clamp(1.0 / STEP_CHANGE, STEP_CHANGE);
            step.clamp(STEPS[0], STEPS[1].min((high - low) / 2.0))
        };
        free.iter().enumerate().map(wanted).collect()
    }

    /// The bound at which a variable lies; `None` if the variable lies inside its bounds.
    pub(super) fn end(&self, index: usize) -> Option<BoundReached> {
        let [low, high] = self.bounds[index];
        match self.at[index] {
            at if at <= low + CLOSE => Some(BoundReached::Low),
            at if at >= high - CLOSE => Some(BoundReached::High),
            _ => None,
        }
    }

    /// A bound of a variable.
    pub(super) fn bound(&self, index: usize, end: BoundReached) -> f64 {
        self.bounds[index][end as usize]
    }

    /// Loss at the best point, in nats; infinite without a likelihood.
    pub(super) fn loss(&mut self) -> f64 {
        self.evaluations += 1;
        (self.losses)(&self.at).map_or(f64::INFINITY, |losses| losses.iter().sum())
    }
}

/// Standard deviation of the difference between two surfaces' minima, as a multiple of the noise of single values.
pub(super) fn share_of_noise(variables: usize) -> f64 {
    let count = variables as f64;
    (2.0 * (1.0 + count) / points(variables) as f64).sqrt()
}
