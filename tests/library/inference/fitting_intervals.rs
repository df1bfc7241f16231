//! Intervals of a fit hold the truth as often as they say, and a fit is quick, on a likelihood like the program's whose truth and
//! exact value are known: people with beliefs about three facts choose among eight buttons, and beliefs are averaged over particles.

use tomcom_core::base::rng::Stream;
use tomcom_core::mind::fitting::HumanModelParameter;
use tomcom_study::analysis::fitting::ascent::BoundReached;
use tomcom_study::analysis::fitting::ascent::{LikelihoodMaximum, VariableEstimate, ascend};

use crate::support::*;

const BUTTONS: usize = 8;
/// Combinations of three facts that are known or not.
const BELIEFS: usize = 8;
const PARAMETERS: [HumanModelParameter; 5] = HumanModelParameter::USUAL;
const TRUTH: [f64; 5] = [2.5, 0.08, 2.5, 4.0, 120.0];
/// Where the search begins.
const START: [f64; 5] = [4.0, 0.05, 1.5, 10.0, 600.0];

/// A press, and what is known of a fact: how far from the gaze it is, how long it has been in sight, how long ago it was told.
struct SyntheticPress {
    /// Expected presses to go after each button, under each belief.
    costs: [[f64; BUTTONS]; BELIEFS],
    distance_deg: f64,
    seen_s: f64,
    told_s: f64,
    pressed: usize,
    /// Uniform random numbers of the particles: each knows a fact whose probability exceeds its number.
    particles: Vec<[f64; 3]>,
}

impl SyntheticPress {
    /// Draws a press of a person with these parameters.
    fn draw(parameters: &[f64; 5], random: &mut Stream) -> SyntheticPress {
        let base: [f64; BUTTONS] = std::array::from_fn(|_| f64::from(random.random_range(0..4)));
        let shifts: [[f64; BUTTONS]; 3] = std::array::from_fn(|_| {
            std::array::from_fn(|_| match random.random::<f64>() < 0.25 {
                true => f64::from(random.random_range(-2..3)),
                false => 0.0,
            })
        });
        let shift = |belief: usize, button: usize| {
            (0..3).filter(|fact| belief >> fact & 1 == 1).map(|fact: usize| shifts[fact][button]).sum::<f64>()
        };
        let mut press = SyntheticPress {
            costs: std::array::from_fn(|belief| std::array::from_fn(|button| base[button] + shift(belief, button))),
            distance_deg: 6.0 * random.random::<f64>(),
            seen_s: -0.3 * (1.0 - random.random::<f64>()).ln(),
            told_s: -100.0 * (1.0 - random.random::<f64>()).ln(),
            pressed: 0,
            particles: (0..64).map(|_| std::array::from_fn(|_| random.random())).collect(),
        };
        let belief = known(&press.p_known(parameters), std::array::from_fn(|_| random.random()));
        let mut rest = random.random::<f64>();
        for button in 0..BUTTONS {
            press.pressed = button;
            rest -= press.p(parameters, belief);
            if rest < 0.0 {
                break;
            }
        }
        press
    }

    /// Probability that each of the three facts is known.
    fn p_known(&self, [_, _, radius_deg, reading_rate_hz, half_life_s]: &[f64; 5]) -> [f64; 3] {
        [
            1.0 - (-reading_rate_hz * self.seen_s).exp(),
            (-self.told_s / half_life_s).exp2(),
            (-(self.distance_deg / radius_deg).powi(2) / 2.0).exp(),
        ]
    }

    /// Probability of the press under a belief.
    fn p(&self, [tau, lapse, ..]: &[f64; 5], belief: usize) -> f64 {
        let weights = self.costs[belief].map(|cost| (-tau * cost).exp());
        (1.0 - lapse) * weights[self.pressed] / weights.iter().sum::<f64>() + lapse / BUTTONS as f64
    }

    /// Negative log likelihood of the press by the particles.
    fn loss(&self, parameters: &[f64; 5]) -> f64 {
        let p_known = self.p_known(parameters);
        let mut counts = [0.0; BELIEFS];
        self.particles.iter().for_each(|drawn| counts[known(&p_known, *drawn)] += 1.0);
        let believed = counts.iter().enumerate().filter(|(_, count)| **count > 0.0);
        let sum: f64 = believed.map(|(belief, count)| count * self.p(parameters, belief)).sum();
        -(sum / self.particles.len() as f64).ln()
    }

    /// Negative log likelihood of the press, exactly.
    fn exact_loss(&self, parameters: &[f64; 5]) -> f64 {
        let p_known = self.p_known(parameters);
        let share = |belief: usize| {
            (0..3)
                .map(|fact| if belief >> fact & 1 == 1 { p_known[fact] } else { 1.0 - p_known[fact] })
                .product::<f64>()
        };
        -(0..BELIEFS).map(|belief| share(belief) * self.p(parameters, belief)).sum::<f64>().ln()
    }
}

/// The belief that knows the facts whose probabilities exceed these numbers.
fn known(p_known: &[f64; 3], drawn: [f64; 3]) -> usize {
    (0..3).map(|fact| usize::from(drawn[fact] < p_known[fact]) << fact).sum()
}

fn to_scale(values: [f64; 5]) -> [f64; 5] {
    std::array::from_fn(|index| PARAMETERS[index].to_scale(values[index]))
}

fn from_scale(at: &[f64]) -> [f64; 5] {
    std::array::from_fn(|index| PARAMETERS[index].from_scale(at[index]))
}

fn fit(presses: &[SyntheticPress]) -> LikelihoodMaximum {
    let bounds = PARAMETERS.map(|parameter| parameter.bounds().map(|end| parameter.to_scale(end)));
    let losses = |at: &[f64]| {
        let parameters = from_scale(at);
        Some(presses.iter().map(|press| press.loss(&parameters)).collect())
    };
    ascend(losses, &to_scale(START), &bounds, 600)
}

/// Whether the interval of 95 % holds the truth.
fn holds(found: &VariableEstimate, truth: f64) -> bool {
    match (found.standard_error, found.end, found.limit) {
        (Some(error), None, _) => (found.at - truth).abs() <= 1.96 * error,
        (_, Some(BoundReached::High), Some(limit)) => truth >= limit,
        (_, Some(BoundReached::Low), Some(limit)) => truth <= limit,
        _ => false,
    }
}

#[test]
fn intervals_hold_the_truth_and_the_search_is_quick() {
    const SETS: u64 = 40;
    let truth = to_scale(TRUTH);
    let (mut held, mut evaluations, mut gain) = ([0; 5], 0, 0.0);
    for set in 0..SETS {
        let mut random = stream(9955, "presses", set);
        let presses: Vec<SyntheticPress> = (0..500).map(|_| SyntheticPress::draw(&TRUTH, &mut random)).collect();
        let found = fit(&presses);
        assert!(found.converged, "set {set}: {found:?}");
        let at: Vec<f64> = found.variables.iter().map(|variable| variable.at).collect();
        let exact = |values: &[f64; 5]| presses.iter().map(|press| press.exact_loss(values)).sum::<f64>();
        gain += (exact(&TRUTH) - exact(&from_scale(&at))) / SETS as f64;
        evaluations += found.evaluations as u64;
        for (held, (found, truth)) in held.iter_mut().zip(found.variables.iter().zip(truth)) {
            *held += u64::from(holds(found, truth));
        }
    }
    println!(
        "intervals that hold the truth: {held:?} of {SETS}; {evaluations} evaluations; {gain:.2} nats above the truth"
    );
    // 95 % of 200 intervals are 190; with the noise, which the intervals know in part only, some fewer.
    assert!(held.iter().sum::<u64>() >= 180 && held.iter().all(|held| *held >= SETS * 4 / 5), "{held:?}");
    // A response surface alone has 41 points, and the search takes several without scores.
    assert!(evaluations <= 150 * SETS, "{evaluations}");
    // The maximum of five parameters lies 2.5 nats above the truth in the mean (half of chi squared), less what the noise costs.
    assert!(gain > 1.5, "{gain}");
}
