//! What answers to probes add to a fit.

use serde::Serialize;

use crate::base::words::count;
use crate::mind::fitting::{Likelihood, Parameter};

/// Answers to probes in a fit, and what they add to the presses.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct FittedAnswers {
    /// Number of answers.
    pub answers: u64,
    /// Log likelihood per answer with the parameters from before, in nats.
    pub log_likelihood_before: f64,
    /// Log likelihood per answer with the parameters that were found, in nats.
    pub log_likelihood: f64,
    /// The parameters as presses alone tell them, beside this fit.
    pub shrinkage: Vec<IntervalShrinkage>,
}

/// A parameter fitted to presses alone, beside the fit to presses and answers.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct IntervalShrinkage {
    /// The parameter's name in a parameter file.
    pub name: &'static str,
    /// Its value by presses alone.
    pub value: f64,
    /// Its 95 % interval by presses alone, as in the fit.
    pub interval: Option<[Option<f64>; 2]>,
    /// Width of the interval by presses and answers divided by that by presses alone, on the scale of the fit; below 1 answers have
    /// narrowed it. Null where one of the two does not have both ends.
    pub ratio: Option<f64>,
}

impl FittedAnswers {
    /// Answers under the parameters from before and those that were found.
    pub fn from_likelihoods(before: Likelihood, after: Likelihood) -> FittedAnswers {
        let answers = before.answers.max(1) as f64;
        FittedAnswers {
            answers: before.answers,
            log_likelihood_before: before.log_p_answers / answers,
            log_likelihood: after.log_p_answers / answers,
            shrinkage: Vec::new(),
        }
    }
}

impl IntervalShrinkage {
    /// Compares the intervals of a parameter: by presses alone with its value there, and by presses and answers.
    pub fn between(
        parameter: Parameter,
        value: f64,
        alone: Option<[Option<f64>; 2]>,
        with: Option<[Option<f64>; 2]>,
    ) -> IntervalShrinkage {
        let width = |interval: Option<[Option<f64>; 2]>| match interval {
            Some([Some(from), Some(to)]) => Some(parameter.to_scale(to) - parameter.to_scale(from)),
            _ => None,
        };
        let ratio = width(with).zip(width(alone)).map(|(with, alone)| with / alone);
        IntervalShrinkage { name: parameter.name(), value, interval: alone, ratio }
    }
}

/// The answers as text.
pub(super) fn describe(answers: &FittedAnswers) -> String {
    let mut text = format!(
        "\n{} to probes: log likelihood per answer {:.4}, before {:.4}\n{:<24}{:>16}{:>24}\n",
        count(answers.answers, "answer", "answers"),
        answers.log_likelihood,
        answers.log_likelihood_before,
        "parameter",
        "presses alone",
        "width of the interval",
    );
    for one in &answers.shrinkage {
        let identified = matches!(one.interval, Some([Some(_), Some(_)]));
        let width = match one.ratio {
            Some(ratio) => format!("{:.0} % of that alone", 100.0 * ratio),
            None if !identified => "alone not told".to_string(),
            None => "-".to_string(),
        };
        text.push_str(&format!("{:<24}{:>16.4}{width:>24}\n", one.name, one.value));
    }
    text
}
