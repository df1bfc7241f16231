//! Searches the parameters of the persons of one population: fits quadratic surfaces to each person's log likelihood, from
//! the scores of single presses ([`super::score_surface`]), and estimates the population anew after each round of surfaces.
//!
//! The surfaces approximate the likelihood alone; the population enters afterwards. So a surface stays right when the
//! population estimate changes, and a person with few presses needs no maximum of the likelihood. A round costs for
//! every person the evaluations of one surface.

use super::gaussian_likelihood::GaussianLikelihood;
use super::parameter_scale::{bounds_of, is_possible, model_at};
use super::population_estimate::{PopulationEstimate, estimate};
use super::response_surface::REACH;
use super::score_surface::{ScoreRegression, TriedPoint, points, points_around};
use crate::mind::fitting::{HumanModelParameter, TrialLikelihood};
use crate::mind::model::HumanModel;

/// Largest number of rounds of the search.
pub const ROUNDS: usize = 12;
/// Step sizes of the surfaces in the first round of the search.
const FIRST_STEP: f64 = 0.5;
/// Number of nats by which one step lowers a person's log likelihood, beside the noise of the surface. Step sizes
/// follow from the person's own presses alone: if the population counted, steps would shrink until noise looks like
/// information.
const STEP_NATS: f64 = 3.0;
/// Least and largest size of a step, and the largest factor between the sizes of successive steps.
const STEPS: [f64; 2] = [0.2, 1.0];
const STEP_CHANGE: f64 = 2.5;
/// Share of the way to a person's mode that the centre moves. The likelihood of small shares is flat on one side, so that
/// whole steps would lead from one side of the mode to the other and back.
const DAMPING: f64 = 0.5;
/// The search for a person has settled when the person's mode is within this many steps of the centre of the surface.
const NEAR: f64 = 0.5;

/// Which trials of a person the search uses.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TrialSelection {
    /// All trials of the person.
    All,
    /// All trials of the person except the last one; a person with a single trial keeps that trial.
    Training,
    /// The last trial of a person who has several trials.
    HeldOut,
}

/// A set of parameters whose likelihood is computed on a person's trials.
#[derive(Clone, Debug, PartialEq)]
pub struct PersonTry {
    /// Index of the person among all fitted persons.
    pub person: usize,
    /// Which of the person's trials are used.
    pub part: TrialSelection,
    /// The human model with the parameters to try.
    pub model: HumanModel,
}

/// What is searched: the parameters, for how many persons, on which trials.
#[derive(Clone, Copy, Debug)]
pub struct PeopleSearch<'a> {
    /// Human model with the values of the parameters that are not searched.
    pub base: &'a HumanModel,
    /// The parameters of the human model in which persons differ.
    pub parameters: &'a [HumanModelParameter],
    /// Number of persons whose parameters are searched.
    pub people: usize,
    /// Which trials of each person the search uses.
    pub part: TrialSelection,
}

/// Result of a search: the estimated population and its persons.
#[derive(Clone, Debug, PartialEq)]
pub struct FoundPeople {
    /// Estimate of the population's distribution and of the persons' parameters.
    pub estimate: PopulationEstimate,
    /// Mean of the population, moved inside the bounds of the parameters.
    pub mean: Vec<f64>,
    /// Most probable parameters (mode) of each person, moved inside the bounds of the parameters.
    pub modes: Vec<Vec<f64>>,
    /// Number of parameter sets tried for each person.
    pub tries: u64,
    /// Whether every person's mode was near the centre of that person's last surface.
    pub converged: bool,
}

/// Searches from the point `start`, which is the same for all persons. `likelihoods` returns the likelihood of each
/// tried parameter set, in the order of the tries.
pub fn search(
    what: PeopleSearch<'_>,
    start: &[f64],
    likelihoods: impl Fn(&[PersonTry]) -> Vec<TrialLikelihood>,
) -> FoundPeople {
    let bounds = bounds_of(what.parameters);
    let mut surveys =
        vec![Survey { centre: start.to_vec(), steps: vec![FIRST_STEP; start.len()], tried: Vec::new() }; what.people];
    let mut tries = 0;
    let mut round = 0;
    loop {
        surveys.iter_mut().for_each(|survey| survey.keep_inside(&bounds));
        try_points(what, &mut surveys, &likelihoods);
        tries += points(start.len()) as u64;
        let surfaces = surveys.iter().map(Survey::gaussian);
        let (gaussians, noises): (Vec<GaussianLikelihood>, Vec<f64>) = surfaces.unzip();
        let estimate = estimate(&gaussians, start);
        let inside = |at: &[f64]| -> Vec<f64> {
            at.iter().zip(&bounds).map(|(at, [low, high])| at.clamp(*low, *high)).collect()
        };
        let modes: Vec<Vec<f64>> = estimate.people.iter().map(|person| inside(&person.mode)).collect();
        round += 1;
        let converged = surveys.iter().zip(&modes).all(|(survey, mode)| survey.is_near(mode, &bounds));
        if converged && round > 1 || round == ROUNDS {
            return FoundPeople { mean: inside(&estimate.mean), estimate, modes, tries, converged };
        }
        for (((survey, gaussian), noise), mode) in surveys.iter_mut().zip(&gaussians).zip(&noises).zip(&modes) {
            survey.move_to(mode, gaussian, *noise);
        }
    }
}

/// Tries the points of every person's survey. Parameters that are invalid have no likelihood.
fn try_points(
    what: PeopleSearch<'_>,
    surveys: &mut [Survey],
    likelihoods: impl Fn(&[PersonTry]) -> Vec<TrialLikelihood>,
) {
    let (mut tries, mut places) = (Vec::new(), Vec::new());
    for (person, survey) in surveys.iter().enumerate() {
        for at in points_around(&survey.centre, &survey.steps) {
            let model = model_at(what.base, what.parameters, &at);
            if is_possible(&model) {
                tries.push(PersonTry { person, part: what.part, model });
                places.push(at);
            }
        }
    }
    let found = likelihoods(&tries);
    for ((of, at), found) in tries.iter().zip(places).zip(found) {
        surveys[of.person].tried.push((at, found.losses()));
    }
}

/// Where the next quadratic surface of a person's log likelihood is fitted: centre and step sizes.
#[derive(Clone, Debug)]
struct Survey {
    centre: Vec<f64>,
    steps: Vec<f64>,
    /// All points tried so far, with the loss of each press.
    tried: Vec<(Vec<f64>, Vec<f64>)>,
}

impl Survey {
    fn keep_inside(&mut self, bounds: &[[f64; 2]]) {
        for ((centre, step), [low, high]) in self.centre.iter_mut().zip(&mut self.steps).zip(bounds) {
            *step = step.min((high - low) / 2.0);
            *centre = centre.clamp(low + *step, (high - *step).max(low + *step));
        }
    }

    /// The quadratic likelihood around the centre, and the standard deviation of the noise of single values.
    fn gaussian(&self) -> (GaussianLikelihood, f64) {
        let tried: Vec<TriedPoint<'_>> = self.tried.iter().map(|(at, losses)| (at.clone(), &losses[..])).collect();
        match ScoreRegression::new(&tried, &self.centre, &self.steps) {
            Some(regression) => {
                let found = regression.surface();
                (GaussianLikelihood::from_surface(&found, &self.centre, &self.steps), found.noise)
            }
            None => (GaussianLikelihood::flat(self.centre.len()), 0.0),
        }
    }

    /// Whether a person's mode is near the centre of the survey; beside a bound, where the centre cannot lie, the mode
    /// may be as far away as the surface reaches.
    fn is_near(&self, mode: &[f64], bounds: &[[f64; 2]]) -> bool {
        self.centre.iter().zip(&self.steps).zip(mode).zip(bounds).all(|(((centre, step), mode), [low, high])| {
            let is_beside = centre - step <= *low || centre + step >= *high;
            (mode - centre).abs() <= step * if is_beside { 1.0 } else { NEAR }
        })
    }

    fn move_to(&mut self, mode: &[f64], known: &GaussianLikelihood, noise: f64) {
        let information = known.information.diagonal();
        for (((centre, step), mode), information) in
            self.centre.iter_mut().zip(&mut self.steps).zip(mode).zip(&information)
        {
            *centre += (mode - *centre).clamp(-REACH * *step, REACH * *step) * DAMPING;
            let wanted = (2.0 * (STEP_NATS + noise) / information).sqrt();
            *step = wanted.clamp(*step / STEP_CHANGE, *step * STEP_CHANGE).clamp(STEPS[0], STEPS[1]);
        }
    }
}
