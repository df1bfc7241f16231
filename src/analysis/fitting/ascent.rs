//! Maximises a noisy log likelihood within bounds by a sequence of response surfaces (Box and Wilson 1951). Single
//! comparisons of values are unreliable under noise; a response surface averages the noise over its points and
//! estimates the size of the noise.
//!
//! A variable whose maximum lies at a bound, or whose bound is not significantly worse than the maximum, is held at
//! that bound. Such a variable gets one end of a profile likelihood interval instead of a standard error (Venzon and
//! Moolgavkar 1988).

use super::response_surface::{QuadraticSurface, REACH, points, surface};

/// Step size of the first response surface.
const FIRST_STEP: f64 = 0.4;
/// Steps of the search are chosen so that one step lowers the log likelihood by this much: least and most in nats, and
/// in standard deviations of the noise.
const STEP_NATS: [f64; 2] = [2.0, 12.0];
const STEP_NOISE: f64 = 0.5;
/// Least and largest size of a step of the search, and the largest factor between the sizes of successive steps.
const STEPS: [f64; 2] = [0.02, 1.6];
const STEP_CHANGE: f64 = 2.5;
/// Difference of log likelihoods that is significant at 5 %: half the 95 % quantile of chi squared with one degree of
/// freedom.
pub(super) const REJECTED_NATS: f64 = 1.92;
/// First step of the search for the end of a profile interval; the end is found to within a quarter of this step.
const PROFILE_STEP: f64 = 0.3;
/// A bound is rejected, without optimising the other variables, if it lowers the log likelihood by more than this (plus
/// the noise) with the other variables at the maximum.
const HOPELESS_NATS: f64 = 30.0;
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

/// Estimate of one variable of a likelihood, with its uncertainty.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct VariableEstimate {
    /// Value of the variable at which the likelihood is greatest.
    pub at: f64,
    /// Standard error of the variable; `None` at a bound, and where the log likelihood is not concave.
    pub standard_error: Option<f64>,
    /// The bound at which the variable has its maximum, if any.
    pub end: Option<BoundReached>,
    /// Other end of the 95 % profile likelihood interval of a variable at a bound; `None` if that end was not found.
    pub limit: Option<f64>,
}

/// Result of a search for the maximum of a log likelihood.
#[derive(Clone, Debug, PartialEq)]
pub struct LikelihoodMaximum {
    /// Estimates of the variables, in the order in which they were passed.
    pub variables: Vec<VariableEstimate>,
    /// Number of evaluations of the log likelihood during the search.
    pub evaluations: usize,
    /// Whether the search converged before the allowed evaluations were used up.
    pub converged: bool,
}

/// Maximises a log likelihood within bounds as [`ascend`] does, but without standard errors and intervals, which take
/// most of the evaluations of [`ascend`].
pub fn climb(loss: impl FnMut(&[f64]) -> f64, start: &[f64], bounds: &[[f64; 2]], most: usize) -> LikelihoodMaximum {
    let mut search = Search::begin(loss, start, bounds, most);
    let free: Vec<usize> = (0..start.len()).collect();
    let converged = search.climb(&free).is_some();
    let variable = |&at: &f64| VariableEstimate { at, standard_error: None, end: None, limit: None };
    let variables = search.at.iter().map(variable).collect();
    LikelihoodMaximum { variables, evaluations: search.evaluations, converged }
}

/// Maximises a log likelihood within bounds; `loss` is the negative log likelihood in nats. Stops after about `most`
/// evaluations of `loss`.
pub fn ascend(loss: impl FnMut(&[f64]) -> f64, start: &[f64], bounds: &[[f64; 2]], most: usize) -> LikelihoodMaximum {
    let mut search = Search::begin(loss, start, bounds, most);
    let count = start.len();
    let mut held = vec![None; count];
    // A variable that converges at a bound is held there, and the others are optimised again.
    let last = loop {
        let free: Vec<usize> = (0..count).filter(|&index| held[index].is_none()).collect();
        let Some(last) = search.climb(&free) else { break None };
        let mut ends: Vec<(usize, BoundReached)> =
            free.iter().filter_map(|&index| Some((index, search.end(index)?))).collect();
        if ends.is_empty() {
            ends.extend(last.as_ref().and_then(|last| search.open_end(&free, last)));
        }
        if ends.is_empty() {
            break Some((free, last));
        }
        for (index, end) in ends {
            search.at[index] = search.bound(index, end);
            held[index] = Some(end);
        }
    };
    let converged = last.is_some();
    let covariance = last.as_ref().and_then(|(_, last)| last.as_ref()?.covariance());
    let error = |index: usize| {
        let (free, _) = last.as_ref()?;
        let place = free.iter().position(|&other| other == index)?;
        Some(covariance.as_ref()?[(place, place)].sqrt() * search.steps[index])
    };
    let errors: Vec<Option<f64>> = (0..count).map(error).collect();
    let limits: Vec<Option<f64>> = (0..count)
        .map(|index| held[index].filter(|_| converged).and_then(|end| search.limit(index, end, &held)))
        .collect();
    let variable = |index: usize| VariableEstimate {
        at: search.at[index],
        standard_error: errors[index],
        end: held[index].filter(|_| converged),
        limit: limits[index],
    };
    LikelihoodMaximum { variables: (0..count).map(variable).collect(), evaluations: search.evaluations, converged }
}

struct Search<'a, F> {
    loss: F,
    bounds: &'a [[f64; 2]],
    /// Point with the least loss that the search has found so far.
    at: Vec<f64>,
    steps: Vec<f64>,
    evaluations: usize,
    most: usize,
}

impl<'a, F: FnMut(&[f64]) -> f64> Search<'a, F> {
    fn begin(loss: F, start: &[f64], bounds: &'a [[f64; 2]], most: usize) -> Search<'a, F> {
        let inside = |(at, [low, high]): (&f64, &[f64; 2])| at.clamp(*low, *high);
        let at: Vec<f64> = start.iter().zip(bounds).map(inside).collect();
        Search { loss, bounds, steps: vec![FIRST_STEP; at.len()], at, evaluations: 0, most }
    }

    /// Maximises the likelihood over the free variables. Returns the surface around the maximum (`Some(None)` without
    /// free variables), or `None` if the search did not converge.
    fn climb(&mut self, free: &[usize]) -> Option<Option<QuadraticSurface>> {
        if free.is_empty() {
            return Some(None);
        }
        loop {
            let (centre, surface) = self.survey(free)?;
            let by = self.least(free, &centre, &surface);
            for ((&index, centre), by) in free.iter().zip(&centre).zip(&by) {
                self.at[index] = (centre + by * self.steps[index]).clamp(self.bounds[index][0], self.bounds[index][1]);
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

    /// A response surface over the free variables around the best point, inside the bounds, with the surface's centre;
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
        let mut whole = self.at.clone();
        let (loss, evaluations) = (&mut self.loss, &mut self.evaluations);
        let of_free = |at: &[f64]| {
            free.iter().zip(at).for_each(|(&index, &at)| whole[index] = at);
            *evaluations += 1;
            loss(&whole)
        };
        surface(of_free, &centre, &steps).map(|surface| (centre, surface))
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
    fn end(&self, index: usize) -> Option<BoundReached> {
        let [low, high] = self.bounds[index];
        match self.at[index] {
            at if at <= low + CLOSE => Some(BoundReached::Low),
            at if at >= high - CLOSE => Some(BoundReached::High),
            _ => None,
        }
    }

    fn bound(&self, index: usize, end: BoundReached) -> f64 {
        self.bounds[index][end as usize]
    }

    /// A variable with a bound that is not significantly worse than the maximum, and that bound.
    fn open_end(&mut self, free: &[usize], last: &QuadraticSurface) -> Option<(usize, BoundReached)> {
        let best = self.at.clone();
        let value = last.at(&last.least(&vec![-REACH; free.len()], &vec![REACH; free.len()]));
        for &index in free {
            let others: Vec<usize> = free.iter().copied().filter(|&other| other != index).collect();
            for end in [BoundReached::Low, BoundReached::High] {
                self.at[index] = self.bound(index, end);
                self.evaluations += 1;
                let hopeless = (self.loss)(&self.at) - value > HOPELESS_NATS + 3.0 * last.noise;
                let at_bound = if hopeless { None } else { self.profile(&others) };
                self.at.clone_from(&best);
                if at_bound.is_some_and(|(at_bound, noise)| at_bound - value <= REJECTED_NATS + noise) {
                    return Some((index, end));
                }
            }
        }
        None
    }

    /// End of the profile interval of a variable at a bound: where the profile log likelihood is significantly below
    /// the likelihood at the bound, beyond the noise.
    fn limit(&mut self, index: usize, end: BoundReached, held: &[Option<BoundReached>]) -> Option<f64> {
        let others: Vec<usize> = (0..held.len()).filter(|&other| other != index && held[other].is_none()).collect();
        let best = self.at.clone();
        let (at_bound, _) = self.profile(&others)?;
        let [low, high] = self.bounds[index];
        let away = if end == BoundReached::Low { 1.0 } else { -1.0 };
        let (mut near, mut far, mut step) = (0.0, None, PROFILE_STEP);
        let found = loop {
            let by = match far {
                None if near >= high - low => break None,
                None => (near + step).min(high - low),
                Some(far) if far - near <= PROFILE_STEP / 4.0 => break Some(best[index] + away * (near + far) / 2.0),
                Some(far) => (near + far) / 2.0,
            };
            self.at.clone_from(&best);
            self.at[index] = best[index] + away * by;
            let Some((value, noise)) = self.profile(&others) else { break None };
            match value - at_bound > REJECTED_NATS + noise {
                true => far = Some(by),
                false => (near, step) = (by, 2.0 * step),
            }
        };
        self.at = best;
        found
    }

    /// Least loss over the variables `others` near the best point, and the standard deviation of the difference between
    /// two such least losses.
    fn profile(&mut self, others: &[usize]) -> Option<(f64, f64)> {
        if others.is_empty() {
            self.evaluations += 1;
            return Some(((self.loss)(&self.at), 0.0));
        }
        let (centre, surface) = self.survey(others)?;
        let by = self.least(others, &centre, &surface);
        Some((surface.at(&by), surface.noise * share_of_noise(others.len())))
    }
}

/// Standard deviation of the difference between two surfaces' minima, as a multiple of the noise of single values.
fn share_of_noise(variables: usize) -> f64 {
    let count = variables as f64;
    let terms = 1.0 + count + count * (count + 1.0) / 2.0;
    (2.0 * terms / points(variables) as f64).sqrt()
}

#[cfg(test)]
mod tests {
    use rand::RngExt;

    use super::*;
    use crate::base::rng::stream;

    /// Test function: a loss of 2 variables whose minimum has standard errors of 0.1 and 0.2.
    fn bowl(at: &[f64]) -> f64 {
        50.0 * (at[0] - 0.7).powi(2) + 12.5 * (at[1] + 1.2).powi(2)
    }

    #[test]
    fn finds_the_maximum_and_its_errors_through_noise() {
        let mut random = stream(4, "noise", 0);
        let noisy = |at: &[f64]| bowl(at) + 3.0 * (random.random::<f64>() - 0.5);
        let found = ascend(noisy, &[3.0, 2.0], &[[-5.0, 5.0]; 2], 300);
        assert!(found.converged, "{found:?}");
        for (variable, (at, error)) in found.variables.iter().zip([(0.7, 0.1), (-1.2, 0.2)]) {
            let told = variable.standard_error.expect("an error");
            assert!((0.7 * error..2.0 * error).contains(&told), "{found:?}");
            assert!((variable.at - at).abs() < 3.0 * told && variable.end.is_none(), "{found:?}");
        }
    }

    #[test]
    fn what_has_no_maximum_gets_one_end_of_an_interval() {
        // Test function that the second variable does not change above 1.
        let plateau = |at: &[f64]| 50.0 * (at[0] - 0.7).powi(2) + 40.0 * (1.0 - at[1]).max(0.0).powi(2) - 0.1 * at[1];
        let found = ascend(plateau, &[0.0, 0.0], &[[-5.0, 5.0], [-3.0, 3.0]], 600);
        let [first, second] = &found.variables[..] else { panic!("{found:?}") };
        assert!(found.converged && (first.at - 0.7).abs() < 0.05 && first.standard_error.is_some(), "{found:?}");
        assert_eq!((second.end, second.standard_error), (Some(BoundReached::High), None), "{found:?}");
        // 40 (1 - x)^2 + 0.1 (3 - x) = 1.92 at x = 0.79.
        assert!((second.limit.expect("a limit") - 0.79).abs() < 0.1, "{found:?}");
    }

    #[test]
    fn says_when_it_was_not_done() {
        let found = ascend(bowl, &[50.0, 50.0], &[[-1e3, 1e3]; 2], 12);
        assert!(!found.converged && found.evaluations <= 12, "{found:?}");
        assert!(found.variables.iter().all(|variable| variable.standard_error.is_none()), "{found:?}");
    }
}
