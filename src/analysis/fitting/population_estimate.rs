//! Empirical Bayes for the persons of one population: each parameter is normally distributed in the population, with a
//! mean and a standard deviation; a person's log likelihood is a quadratic function of the parameters
//! ([`GaussianLikelihood`]).
//!
//! This is a linear mixed model with known errors. Standard deviations are estimated by restricted maximum likelihood
//! with the EM algorithm (Laird and Ware 1982), which takes into account that the mean is estimated, too; persons are
//! estimated by the posterior of their parameters.

use nalgebra::{DMatrix, DVector};

use super::gaussian_likelihood::{GaussianLikelihood, inverse};
use super::surface_search::REJECTED_NATS;

/// Standard deviation between persons at the start of the estimation, and its least and largest value, on the scale of
/// the fit.
const FIRST_SD: f64 = 0.5;
const SDS: [f64; 2] = [0.01, 5.0];
/// Standard deviation of the weak prior of the population's mean around the point where the search began. A parameter
/// that nobody's presses determine stays at that point.
const PRIOR_SD: f64 = 10.0;
/// Largest number of EM iterations, and the relative change of every standard deviation below which the iterations end.
const ITERATIONS: usize = 2000;
const SETTLED: f64 = 1e-6;
/// Number of bisections by which the end of an interval is found.
const BISECTIONS: usize = 40;

/// Estimate of a population's distribution and of its persons' parameters.
#[derive(Clone, Debug, PartialEq)]
pub struct PopulationEstimate {
    /// Mean of each parameter over the population, on the scale of the fit.
    pub mean: Vec<f64>,
    /// Standard error of each parameter's population mean, on the scale of the fit.
    pub mean_error: Vec<f64>,
    /// Standard deviation of each parameter between persons, on the scale of the fit.
    pub sd: Vec<f64>,
    /// The 95 % interval of each standard deviation between persons by the restricted likelihood, with the other
    /// standard deviations as estimated. `None`: no end within 0.01 to 5.
    pub sd_interval: Vec<[Option<f64>; 2]>,
    /// Posteriors of the persons' parameters, in the order in which the likelihoods were passed.
    pub people: Vec<PersonPosterior>,
}

/// A person's parameters on the scale of the fit: a normal distribution around the mode (Laplace's approximation).
#[derive(Clone, Debug, PartialEq)]
pub struct PersonPosterior {
    /// Most probable value (mode) of each parameter of the person.
    pub mode: Vec<f64>,
    /// Standard deviation of each parameter of the person, including the uncertainty of the population's mean.
    pub sd: Vec<f64>,
    /// Shrinkage of each parameter: variance given the population divided by the population's variance. 1: nothing is
    /// known of the person but the population; 0: the population makes no difference.
    pub shrinkage: Vec<f64>,
}

/// Estimates the population and its persons. `anchor` is the point where the search of parameters began.
pub fn estimate(people: &[GaussianLikelihood], anchor: &[f64]) -> PopulationEstimate {
    let mut sd = vec![FIRST_SD; anchor.len()];
    for _ in 0..ITERATIONS {
        let next = Moments::new(people, &sd, anchor).spread();
        let is_settled = sd.iter().zip(&next).all(|(sd, next)| (next / sd).ln().abs() < SETTLED);
        sd = next;
        if is_settled {
            break;
        }
    }
    let moments = Moments::new(people, &sd, anchor);
    let sd_interval = (0..sd.len()).map(|index| sd_interval(people, &sd, anchor, index)).collect();
    let posteriors = (0..people.len()).map(|person| moments.posterior(person, &sd)).collect();
    PopulationEstimate {
        mean: moments.mean.iter().copied().collect(),
        mean_error: moments.mean_covariance.diagonal().iter().map(|variance| variance.sqrt()).collect(),
        sd,
        sd_interval,
        people: posteriors,
    }
}

/// Means, persons' modes and likelihood that follow from given standard deviations of the population.
struct Moments {
    /// Inverse variances of the parameters in the population, on the diagonal of a matrix.
    precision: DMatrix<f64>,
    mean: DVector<f64>,
    mean_covariance: DMatrix<f64>,
    /// For each person, the mode of the parameters and their covariance given the population's mean.
    people: Vec<(DVector<f64>, DMatrix<f64>)>,
    /// Restricted log likelihood of the standard deviations, except for a constant.
    log_likelihood: f64,
}

impl Moments {
    fn new(people: &[GaussianLikelihood], sd: &[f64], anchor: &[f64]) -> Moments {
        let n = sd.len();
        let precision = DMatrix::from_diagonal(&DVector::from_iterator(n, sd.iter().map(|sd| sd.powi(-2))));
        let weak = DMatrix::identity(n, n) / PRIOR_SD.powi(2);
        let mut information = weak.clone();
        let mut weighted = weak * DVector::from_column_slice(anchor);
        let mut log_likelihood = 0.0;
        let mut covariances = Vec::with_capacity(people.len());
        for person in people {
            let covariance = inverse(&person.information + &precision);
            information += &precision - &precision * &covariance * &precision;
            weighted += &precision * &covariance * &person.weighted;
            let explained = person.weighted.dot(&(&covariance * &person.weighted));
            log_likelihood += (precision.determinant().ln() + covariance.determinant().ln() + explained) / 2.0;
            covariances.push(covariance);
        }
        let mean_covariance = inverse(information);
        let mean = &mean_covariance * &weighted;
        log_likelihood += (mean_covariance.determinant().ln() + weighted.dot(&mean)) / 2.0;
        let mode = |person: &GaussianLikelihood, covariance: &DMatrix<f64>| {
            covariance * (&person.weighted + &precision * &mean)
        };
        let people = people.iter().zip(covariances).map(|(person, covariance)| (mode(person, &covariance), covariance));
        let people = people.collect();
        Moments { precision, mean, mean_covariance, people, log_likelihood }
    }

    /// New standard deviations between persons from the persons' distances to the mean and their uncertainty: the M
    /// step of the EM algorithm.
    fn spread(&self) -> Vec<f64> {
        let n = self.mean.len();
        let mut variances = DVector::zeros(n);
        for (mode, covariance) in &self.people {
            let drawn = covariance * &self.precision - DMatrix::identity(n, n);
            let apart = covariance + &drawn * &self.mean_covariance * drawn.transpose();
            variances += (mode - &self.mean).map(|distance| distance * distance) + apart.diagonal();
        }
        let count = self.people.len().max(1) as f64;
        variances.iter().map(|sum: &f64| (sum / count).sqrt().clamp(SDS[0], SDS[1])).collect()
    }

    fn posterior(&self, person: usize, sd: &[f64]) -> PersonPosterior {
        let (mode, given) = &self.people[person];
        let drawn = given * &self.precision;
        let whole = given + &drawn * &self.mean_covariance * drawn.transpose();
        let share = |(index, sd): (usize, &f64)| (given[(index, index)] / (sd * sd)).clamp(0.0, 1.0);
        PersonPosterior {
            mode: mode.iter().copied().collect(),
            sd: whole.diagonal().iter().map(|variance| variance.sqrt()).collect(),
            shrinkage: sd.iter().enumerate().map(share).collect(),
        }
    }
}

/// The 95 % interval of the standard deviation of one parameter between persons.
fn sd_interval(people: &[GaussianLikelihood], sd: &[f64], anchor: &[f64], index: usize) -> [Option<f64>; 2] {
    let at = |log: f64| {
        let mut moved = sd.to_vec();
        moved[index] = log.exp();
        Moments::new(people, &moved, anchor).log_likelihood
    };
    let best = sd[index].ln();
    let least = at(best) - REJECTED_NATS;
    SDS.map(|end| {
        let (mut inside, mut outside) = (best, end.ln());
        if at(outside) >= least {
            return None;
        }
        for _ in 0..BISECTIONS {
            let middle = (inside + outside) / 2.0;
            *(if at(middle) >= least { &mut inside } else { &mut outside }) = middle;
        }
        Some(inside.exp())
    })
}

#[cfg(test)]
mod tests {
    use rand::RngExt;

    use super::*;
    use crate::base::rng::{Stream, stream};

    fn normal(random: &mut Stream) -> f64 {
        // A standard normal number as the sum of twelve uniform numbers (Irwin and Hall): mean 6, variance 1, minus 6.
        (0..12).map(|_| random.random::<f64>()).sum::<f64>() - 6.0
    }

    /// Test data: persons with standard deviation 0.6 around 1, each known with an error.
    fn people(count: usize, error: f64, random: &mut Stream) -> (Vec<f64>, Vec<GaussianLikelihood>) {
        let truths: Vec<f64> = (0..count).map(|_| 1.0 + 0.6 * normal(random)).collect();
        let information = error.powi(-2);
        let measured = truths.iter().map(|truth| GaussianLikelihood {
            information: DMatrix::from_element(1, 1, information),
            weighted: DVector::from_element(1, information * (truth + error * normal(random))),
        });
        let measured = measured.collect();
        (truths, measured)
    }

    #[test]
    fn equal_errors_give_the_estimates_of_an_analysis_of_variance() {
        let mut random = stream(9822, "persons", 0);
        let (_, measured) = people(40, 0.5, &mut random);
        let found = estimate(&measured, &[0.0]);
        let at: Vec<f64> = measured.iter().map(|one| one.weighted[0] * 0.25).collect();
        let mean = at.iter().sum::<f64>() / 40.0;
        let variance = at.iter().map(|at| (at - mean).powi(2)).sum::<f64>() / 39.0;
        assert!((found.mean[0] - mean).abs() < 1e-3 && (found.sd[0].powi(2) - (variance - 0.25)).abs() < 1e-3);
        assert!((found.mean_error[0] - (variance / 40.0).sqrt()).abs() < 1e-3, "{found:?}");
        let weight = found.sd[0].powi(2) / (found.sd[0].powi(2) + 0.25);
        for (person, at) in found.people.iter().zip(&at) {
            assert!((person.mode[0] - (mean + weight * (at - mean))).abs() < 1e-3, "{person:?}");
            assert!((person.shrinkage[0] - (1.0 - weight)).abs() < 1e-3, "{person:?}");
        }
    }

    #[test]
    fn intervals_hold_the_truth_about_as_often_as_they_say() {
        let mut random = stream(9823, "studies", 0);
        let (mut mean, mut sd, mut nearer) = (0, 0, 0);
        for _ in 0..200 {
            let (truths, measured) = people(12, 0.7, &mut random);
            let found = estimate(&measured, &[1.0]);
            mean += u32::from((found.mean[0] - 1.0).abs() < 2.2 * found.mean_error[0]);
            let [low, high] = found.sd_interval[0];
            sd += u32::from(low.is_none_or(|low| low < 0.6) && high.is_none_or(|high| high > 0.6));
            let off = |at: &dyn Fn(usize) -> f64| {
                truths.iter().enumerate().map(|(one, truth)| (at(one) - truth).powi(2)).sum::<f64>()
            };
            let alone = off(&|one| measured[one].weighted[0] * 0.49);
            nearer += u32::from(off(&|one| found.people[one].mode[0]) < alone);
        }
        assert!(mean >= 180 && sd >= 180 && nearer >= 160, "{mean}, {sd} and {nearer} of 200");
    }

    #[test]
    fn what_nobody_tells_stays_where_the_search_began() {
        let found = estimate(&[GaussianLikelihood::flat(2), GaussianLikelihood::flat(2)], &[0.3, -2.0]);
        assert!((found.mean[0] - 0.3).abs() < 1e-6 && (found.mean[1] + 2.0).abs() < 1e-6, "{found:?}");
        assert!(found.people.iter().all(|person| person.shrinkage.iter().all(|share| *share > 0.999)), "{found:?}");
        assert_eq!(found.sd_interval, [[None, None]; 2]);
    }
}
