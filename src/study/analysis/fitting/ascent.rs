//! Search for the maximum of a noisy log likelihood within bounds, with standard errors and intervals. Each step leads
//! to the maximum of a quadratic surface. Single comparisons of values are unreliable under noise; a surface averages
//! the noise over its points and estimates the size of the noise.
//!
//! Surfaces are of two kinds. Those from the scores of single presses ([`super::score_surface`], the method of scoring) take
//! few points and lead to the maximum quickly, but noise that neighbouring points share counts as curvature. Those from
//! the values alone ([`super::response_surface`]; Box and Wilson 1951) take many points, and their curvature is right in the
//! mean: the search ends with them. The curvature of the last one and the scores give the standard errors.
//!
//! A variable whose maximum lies at a bound is held there. Such a variable gets one end of a profile likelihood
//! interval instead of a standard error (Venzon and Moolgavkar 1988).

use nalgebra::{DMatrix, DVector};

use crate::analysis::fitting::response_surface::{self, QuadraticSurface, REACH};
use crate::analysis::fitting::score_surface::{self, ScoreRegression, TriedPoint};

/// First step of the search for the end of a profile interval, which is interpolated between closer values.
const PROFILE_STEP: f64 = 0.3;
/// Part of the distance between two values at the ends of which no value is tried between the two.
const PROFILE_MARGIN: f64 = 0.2;
const PROFILE_SURFACES: usize = 3;
/// Loss (plus the noise) above which a value is rejected without optimising the other variables.
const HOPELESS_NATS: f64 = 30.0;
/// Loss (plus the noise) above which a value is rejected once the surface promises no more.
const CLEAR_NATS: f64 = 6.0;
/// Standard deviations of the noise by which a single loss has to exceed the least loss in addition.
const NOISE_MARGIN: f64 = 2.0;
/// A step that lowers the loss by less than this ends the optimisation of the other variables.
const SETTLED_NATS: f64 = 0.5;

#[derive(Clone, Copy, Debug)]
struct LeastLoss {
    /// Loss in nats.
    value: f64,
    /// Standard deviation of the noise of single losses, in nats.
    noise: f64,
}

impl LeastLoss {
    /// The least loss of a surface within a step of its centre, where its points lie.
    fn from_surface(surface: &QuadraticSurface) -> LeastLoss {
        let [low, high] = [-1.0, 1.0].map(|end| vec![end; surface.slope.len()]);
        LeastLoss { value: surface.at(&surface.least(&low, &high)), noise: surface.noise }
    }
}

struct SettledSearch {
    free: Vec<usize>,
    /// Variances of the free variables' values, in steps; `None` where the likelihood does not determine them.
    variances: Option<DVector<f64>>,
    least: Option<LeastLoss>,
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub struct VariableEstimate {
    pub at: f64,
    /// Standard error of the variable; `None` at a bound, and where the log likelihood is not concave.
    pub standard_error: Option<f64>,
    pub end: Option<BoundReached>,
    /// Other end of the 95 % profile likelihood interval of a variable at a bound; `None` if that end was not found.
    pub limit: Option<f64>,
}

#[derive(Clone, Debug, PartialEq)]
pub struct LikelihoodMaximum {
    pub variables: Vec<VariableEstimate>,
    pub evaluations: usize,
    pub converged: bool,
}

/// Maximises a log likelihood within bounds. `losses` returns the negative log likelihood of each press at a point, in
/// nats, always of the same presses in the same order; `None` where there is no likelihood. Stops after about `most`
/// evaluations of `losses`.
pub fn ascend(
    losses: impl FnMut(&[f64]) -> Option<Vec<f64>>,
    start: &[f64],
    bounds: &[[f64; 2]],
    most: usize,
) -> LikelihoodMaximum {
    let mut search = SurfaceSearch::begin(losses, start, bounds, most);
    let all: Vec<usize> = (0..start.len()).collect();
    let mut held = vec![None; start.len()];
    let is_begun = search.climb(SurfaceSource::Scores, &all).is_some();
    search.hold(search.ends(&all), &mut held);
    let last = if is_begun { search.settle(&mut held) } else { None };
    let converged = last.is_some();
    let error = |index: usize| {
        let last = last.as_ref()?;
        let place = last.free.iter().position(|&other| other == index)?;
        Some(last.variances.as_ref()?[place].sqrt() * search.steps[index])
    };
    let errors: Vec<Option<f64>> = all.iter().map(|&index| error(index)).collect();
    let least = last.and_then(|last| last.least);
    let limits: Vec<Option<f64>> = all
        .iter()
        .map(|&index| held[index].filter(|_| converged).and_then(|end| search.limit((index, end), &held, least)))
        .collect();
    let variable = |index: usize| VariableEstimate {
        at: search.at[index],
        standard_error: errors[index],
        end: held[index].filter(|_| converged),
        limit: limits[index],
    };
    let variables = all.iter().map(|&index| variable(index)).collect();
    LikelihoodMaximum { variables, evaluations: search.evaluations, converged }
}

impl<F: FnMut(&[f64]) -> Option<Vec<f64>>> SurfaceSearch<'_, F> {
    /// Ends the search; a variable that converges at a bound is held. `None` if too few evaluations are left.
    fn settle(&mut self, held: &mut [Option<BoundReached>]) -> Option<SettledSearch> {
        loop {
            let free: Vec<usize> = (0..held.len()).filter(|&index| held[index].is_none()).collect();
            let surface = self.climb(SurfaceSource::Values, &free)?;
            let variances = surface.as_ref().and_then(|surface| surface.variances(&self.score_products(&free)?));
            let ends = self.ends(&free);
            if ends.is_empty() {
                let least = surface.as_ref().map(LeastLoss::from_surface);
                return Some(SettledSearch { free, variances, least });
            }
            self.hold(ends, held);
        }
    }

    fn hold(&mut self, ends: Vec<(usize, BoundReached)>, held: &mut [Option<BoundReached>]) {
        for (index, end) in ends {
            self.at[index] = self.bounds[index][end as usize];
            held[index] = Some(end);
        }
    }

    /// End of the profile interval of a variable at a bound: where the profile log likelihood is significantly below the
    /// likelihood at the bound, beyond the noise. `least` is the least loss at the bound, if other variables are free.
    fn limit(
        &mut self,
        (index, end): (usize, BoundReached),
        held: &[Option<BoundReached>],
        least: Option<LeastLoss>,
    ) -> Option<f64> {
        let others: Vec<usize> = (0..held.len()).filter(|&other| other != index && held[other].is_none()).collect();
        let start = self.at.clone();
        let least = least.unwrap_or_else(|| LeastLoss { value: self.loss(), noise: 0.0 });
        let [low, high] = self.bounds[index];
        let away = if end == BoundReached::Low { 1.0 } else { -1.0 };
        // The loss is about quadratic in the distance to its minimum, so its root is interpolated.
        let root = |excess: f64| excess.max(0.0).sqrt();
        let (mut near, mut far, mut step) = ((0.0, 0.0), None::<(f64, f64)>, PROFILE_STEP);
        let found = loop {
            let share = |far: (f64, f64)| (root(REJECTED_NATS) - near.1) / (far.1 - near.1);
            let by = match far {
                None if near.0 >= high - low => break None,
                None => (near.0 + step).min(high - low),
                Some(far) if far.0 - near.0 <= PROFILE_STEP => {
                    break Some(start[index] + away * (near.0 + share(far) * (far.0 - near.0)));
                }
                Some(far) => near.0 + share(far).clamp(PROFILE_MARGIN, 1.0 - PROFILE_MARGIN) * (far.0 - near.0),
            };
            self.at[index] = start[index] + away * by;
            let Some(excess) = self.excess(&others, least) else { break None };
            match excess > REJECTED_NATS {
                true => far = Some((by, root(excess))),
                false => (near, step) = ((by, root(excess)), 2.0 * step),
            }
        };
        self.at = start;
        found
    }

    /// By how much the least loss over the variables `others` exceeds the least loss so far, beyond the noise, in nats.
    /// What does not have to be known exactly is not: the others are optimised only where that can decide whether the
    /// excess is significant. The current point moves to the least loss that was found. `None` if too few evaluations are
    /// left.
    fn excess(&mut self, others: &[usize], least: LeastLoss) -> Option<f64> {
        let clear = CLEAR_NATS + 3.0 * least.noise;
        let mut excess = self.loss() - least.value - NOISE_MARGIN * least.noise;
        for _ in 0..PROFILE_SURFACES {
            if excess <= REJECTED_NATS || excess > HOPELESS_NATS + 3.0 * least.noise || others.is_empty() {
                break;
            }
            let (surface, by) = self.step(SurfaceSource::Scores, others)?;
            let (before, foreseen) = (excess, surface.at(&by) - least.value);
            excess = self.loss() - least.value - NOISE_MARGIN * least.noise;
            if before - excess < SETTLED_NATS || excess > clear && foreseen > clear {
                break;
            }
        }
        Some(excess)
    }
}

const FIRST_STEP: f64 = 0.4;
/// By how much a step should lower the log likelihood: least and most in nats, and in deviations of the noise.
const STEP_NATS: [f64; 2] = [1.0, 6.0];
const STEP_NOISE: f64 = 0.5;
/// Least and largest size of a step of the search, and the largest factor between the sizes of successive steps.
const STEPS: [f64; 2] = [0.02, 1.6];
const STEP_CHANGE: f64 = 2.5;
/// Significant at 5 %: half the 95 % quantile of chi squared with one degree of freedom.
const REJECTED_NATS: f64 = 1.92;
/// Distance to a bound below which a variable counts as lying at the bound.
const CLOSE: f64 = 1e-9;

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum BoundReached {
    Low,
    High,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum SurfaceSource {
    Scores,
    Values,
}

impl SurfaceSource {
    fn points(self, variables: usize) -> usize {
        match self {
            SurfaceSource::Scores => score_surface::points(variables),
            SurfaceSource::Values => response_surface::points(variables),
        }
    }

    /// Standard deviation of the difference between two surfaces' minima, as a multiple of the noise of single values.
    fn share_of_noise(self, variables: usize) -> f64 {
        let count = variables as f64;
        let terms = match self {
            SurfaceSource::Scores => 1.0 + count,
            SurfaceSource::Values => 1.0 + count + count * (count + 1.0) / 2.0,
        };
        (2.0 * terms / self.points(variables) as f64).sqrt()
    }
}

struct SurfaceSearch<'a, F> {
    losses: F,
    bounds: &'a [[f64; 2]],
    tried: Vec<(Vec<f64>, Vec<f64>)>,
    /// The current point: where the latest surface, or half a step to it, has led.
    at: Vec<f64>,
    centre: Vec<f64>,
    steps: Vec<f64>,
    evaluations: usize,
    most: usize,
}

impl<'a, F: FnMut(&[f64]) -> Option<Vec<f64>>> SurfaceSearch<'a, F> {
    /// A search from `start`, which is moved inside the bounds, with about `most` evaluations of `losses`: the
    /// negative log likelihood of each press in nats.
    fn begin(losses: F, start: &[f64], bounds: &'a [[f64; 2]], most: usize) -> SurfaceSearch<'a, F> {
        let inside = |(at, [low, high]): (&f64, &[f64; 2])| at.clamp(*low, *high);
        let at: Vec<f64> = start.iter().zip(bounds).map(inside).collect();
        SurfaceSearch {
            losses,
            bounds,
            tried: Vec::new(),
            centre: at.clone(),
            steps: vec![FIRST_STEP; at.len()],
            at,
            evaluations: 0,
            most,
        }
    }

    /// The surface around the maximum (`Some(None)` without free variables); `None` if it did not converge.
    fn climb(&mut self, source: SurfaceSource, free: &[usize]) -> Option<Option<QuadraticSurface>> {
        if free.is_empty() {
            return Some(None);
        }
        // Least value at the centre of a surface, and that centre.
        let mut best = None::<(f64, Vec<f64>)>;
        loop {
            let before = self.at.clone();
            let (surface, by) = self.step(source, free)?;
            // Where the curvature changes much, a step can lead too far: then it is halved.
            if let Some((value, at)) = &best
                && surface.value > value + surface.noise * source.share_of_noise(free.len())
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
                surface.is_convex() && gain <= REJECTED_NATS + surface.noise * source.share_of_noise(free.len());
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

    /// Returns the surface, and how far it led, in steps; `None` if too few evaluations are left.
    fn step(&mut self, source: SurfaceSource, free: &[usize]) -> Option<(QuadraticSurface, Vec<f64>)> {
        let (centre, surface) = self.survey(source, free)?;
        let by = self.least(free, &centre, &surface);
        for ((&index, centre), by) in free.iter().zip(&centre).zip(&by) {
            self.at[index] = (centre + by * self.steps[index]).clamp(self.bounds[index][0], self.bounds[index][1]);
        }
        Some((surface, by))
    }

    /// A surface around the current point, with its centre; `None` if too few evaluations are left.
    fn survey(&mut self, source: SurfaceSource, free: &[usize]) -> Option<(Vec<f64>, QuadraticSurface)> {
        if self.evaluations + source.points(free.len()) > self.most {
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
        self.centre = self.with(free, &centre);
        let surface = match source {
            SurfaceSource::Scores => {
                for at in score_surface::points_around(&centre, &steps) {
                    self.try_point(free, &at);
                }
                ScoreRegression::new(&self.tried_with(free), &centre, &steps).map(|regression| regression.surface())
            }
            SurfaceSource::Values => response_surface::surface(|at| self.try_point(free, at), &centre, &steps),
        };
        surface.map(|surface| (centre, surface))
    }

    /// Covariance of the log likelihood's slope around the centre of the latest surface, per step of each free variable.
    fn score_products(&self, free: &[usize]) -> Option<DMatrix<f64>> {
        let [centre, steps] = [&self.centre, &self.steps].map(|of| free.iter().map(|&index| of[index]).collect());
        let [centre, steps]: [Vec<f64>; 2] = [centre, steps];
        ScoreRegression::new(&self.tried_with(free), &centre, &steps).map(|regression| regression.score_products())
    }

    fn tried_with(&self, free: &[usize]) -> Vec<TriedPoint<'_>> {
        let is_held = |index: &usize| !free.contains(index);
        let has_held =
            |at: &[f64]| (0..at.len()).filter(is_held).all(|index| (at[index] - self.at[index]).abs() <= CLOSE);
        let of_free = |at: &[f64]| -> Vec<f64> { free.iter().map(|&index| at[index]).collect() };
        self.tried.iter().filter(|(at, _)| has_held(at)).map(|(at, losses)| (of_free(at), &losses[..])).collect()
    }

    fn with(&self, free: &[usize], values: &[f64]) -> Vec<f64> {
        let mut whole = self.at.clone();
        free.iter().zip(values).for_each(|(&index, &value)| whole[index] = value);
        whole
    }

    /// Loss at the current point with other values of the free variables, in nats; infinite without a likelihood.
    fn try_point(&mut self, free: &[usize], values: &[f64]) -> f64 {
        let at = self.with(free, values);
        self.evaluations += 1;
        let Some(losses) = (self.losses)(&at) else { return f64::INFINITY };
        let loss = losses.iter().sum();
        self.tried.push((at, losses));
        loss
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
            // A surface lies within the bounds: a step beyond the nearer bound would move the surface's centre away from it.
            let room = (self.at[index] - low).min(high - self.at[index]);
            let step = step.min(room.max(self.steps[index]));
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

    fn ends(&self, free: &[usize]) -> Vec<(usize, BoundReached)> {
        free.iter().filter_map(|&index| Some((index, self.end(index)?))).collect()
    }

    /// Loss at the current point, in nats; infinite without a likelihood.
    fn loss(&mut self) -> f64 {
        self.try_point(&[], &[])
    }
}
