//! Maximises a noisy log likelihood within bounds ([`super::surface_search`]), with standard errors and intervals.
//! Surfaces from scores lead to the maximum; the curvature of a response surface there and the scores give the standard
//! errors.
//!
//! A variable whose maximum lies at a bound is held there. Such a variable gets one end of a profile likelihood interval
//! instead of a standard error (Venzon and Moolgavkar 1988).

use nalgebra::DVector;

use super::response_surface::QuadraticSurface;
use super::surface_search::{BoundReached, REJECTED_NATS, SurfaceSearch, SurfaceSource};

/// First step of the search for the end of a profile interval. The end is interpolated between two values of the
/// variable that lie closer together than this.
const PROFILE_STEP: f64 = 0.3;
/// Part of the distance between two values at the ends of which no value is tried between the two.
const PROFILE_MARGIN: f64 = 0.2;
/// Largest number of surfaces for one value of a profile likelihood.
const PROFILE_SURFACES: usize = 3;
/// A value of a variable is rejected, without optimising the other variables, if it lowers the log likelihood by more
/// than this (plus the noise).
const HOPELESS_NATS: f64 = 30.0;
/// A value of a variable is rejected as soon as the log likelihood is lower than the maximum by more than this (plus the
/// noise) and the surface promises no more.
const CLEAR_NATS: f64 = 6.0;
/// Standard deviations of the noise by which a single loss has to exceed the least loss in addition.
const NOISE_MARGIN: f64 = 2.0;
/// A step that lowers the loss by less than this ends the optimisation of the other variables.
const SETTLED_NATS: f64 = 0.5;

/// The least loss that the search has found.
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

/// How a search ended.
struct SettledSearch {
    /// The variables that are not held at a bound.
    free: Vec<usize>,
    /// Variances of the free variables' values, in steps; `None` where the likelihood does not determine them.
    variances: Option<DVector<f64>>,
    /// The least loss, if there are free variables.
    least: Option<LeastLoss>,
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
    /// Ends the search at the maximum of a response surface. A variable that converges at a bound is held there, and the
    /// others are optimised again. `None` if too few evaluations are left.
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

    /// Holds variables at bounds.
    fn hold(&mut self, ends: Vec<(usize, BoundReached)>, held: &mut [Option<BoundReached>]) {
        for (index, end) in ends {
            self.at[index] = self.bound(index, end);
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

#[cfg(test)]
mod tests {
    use rand::RngExt;

    use super::*;
    use tomcom_core::base::rng::stream;

    /// Measurements of 2 variables with standard deviation 1, in pairs around their means, so that the means are 0.7 of
    /// the first 100 and -1.2 of the last 24, and their standard errors are 0.1 and 0.2.
    const MEASURED: [(usize, usize, f64); 2] = [(0, 100, 0.7), (1, 24, -1.2)];

    /// Losses of single measurements where `mean` says what is expected of a variable.
    fn bowl(at: &[f64], mean: impl Fn(usize, f64) -> f64) -> Vec<f64> {
        let of = |(variable, number, centre): (usize, usize, f64)| {
            let expected = mean(variable, at[variable]);
            (0..number).map(move |index| {
                let measured = centre + if index % 2 == 0 { 1.0 } else { -1.0 };
                (measured - expected).powi(2) / 2.0
            })
        };
        MEASURED.into_iter().flat_map(of).collect()
    }

    #[test]
    fn finds_the_maximum_and_its_errors_through_noise() {
        let mut random = stream(4, "noise", 0);
        let noisy = |at: &[f64]| {
            let mut losses = bowl(at, |_, at| at);
            losses.iter_mut().for_each(|loss| *loss += 0.2 * (random.random::<f64>() - 0.5));
            Some(losses)
        };
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
        // The second variable changes nothing above -1.2, but for a small slope.
        let plateau = |at: &[f64]| {
            let mut losses = bowl(at, |variable, at| if variable == 1 { at.min(-1.2) } else { at });
            losses.push(-0.1 * at[1]);
            Some(losses)
        };
        let found = ascend(plateau, &[0.0, -2.0], &[[-5.0, 5.0], [-4.0, 3.0]], 300);
        let [first, second] = &found.variables[..] else { panic!("{found:?}") };
        assert!(found.converged && (first.at - 0.7).abs() < 0.05 && first.standard_error.is_some(), "{found:?}");
        assert_eq!((second.end, second.standard_error), (Some(BoundReached::High), None), "{found:?}");
        // 12 (-1.2 - x)^2 + 0.1 (3 - x) = 1.92 at x = -1.54.
        assert!((second.limit.expect("a limit") + 1.54).abs() < 0.05, "{found:?}");
    }

    #[test]
    fn says_when_it_was_not_done() {
        let found = ascend(|at| Some(bowl(at, |_, at| at)), &[50.0, 50.0], &[[-1e3, 1e3]; 2], 12);
        assert!(!found.converged && found.evaluations <= 12, "{found:?}");
        assert!(found.variables.iter().all(|variable| variable.standard_error.is_none()), "{found:?}");
    }
}
