//! Answers to freeze probes as additional evidence in a fit of the human model.

use serde::Serialize;

use tomcom_core::base::text::count;
use tomcom_core::mind::fitting::{HumanModelParameter, TrialLikelihood};

/// Effect of the answers to freeze probes on a fit of the human model.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ProbeAnswerFit {
    /// Number of answers to freeze probes that the fit used.
    pub answers: u64,
    /// Log likelihood per answer with the parameters before the fit, in nats.
    pub log_likelihood_before: f64,
    /// Log likelihood per answer with the fitted parameters, in nats.
    pub log_likelihood: f64,
    /// For each parameter, its interval when fitted to presses alone, compared with the fit to presses and answers.
    pub shrinkage: Vec<IntervalNarrowing>,
}

/// How far the answers to freeze probes narrow a parameter's interval, compared with presses alone.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct IntervalNarrowing {
    /// The parameter's name in a parameter file.
    pub name: &'static str,
    /// Value of the parameter when fitted to presses alone.
    pub value: f64,
    /// 95 % interval of the parameter when fitted to presses alone, computed as in the main fit.
    pub interval: Option<[Option<f64>; 2]>,
    /// Width of the interval from presses and answers divided by the width from presses alone, on the scale of the fit;
    /// below 1 if answers have narrowed the interval. Null where one of the two intervals has no finite end.
    pub ratio: Option<f64>,
}

impl ProbeAnswerFit {
    /// Log likelihood of the answers under the parameters before the fit and under the fitted parameters.
    pub fn from_likelihoods(before: &TrialLikelihood, after: &TrialLikelihood) -> ProbeAnswerFit {
        let answers = before.answers.max(1) as f64;
        ProbeAnswerFit {
            answers: before.answers,
            log_likelihood_before: before.log_p_answers / answers,
            log_likelihood: after.log_p_answers / answers,
            shrinkage: Vec::new(),
        }
    }

    /// By how much less likely the answers are than before the fit, in nats.
    pub fn lost(&self) -> f64 {
        (self.log_likelihood_before - self.log_likelihood) * self.answers as f64
    }
}

impl IntervalNarrowing {
    /// Compares two intervals of a parameter: from presses alone (with the value from that fit), and from presses and
    /// answers to freeze probes.
    pub fn between(
        parameter: HumanModelParameter,
        value: f64,
        alone: Option<[Option<f64>; 2]>,
        with: Option<[Option<f64>; 2]>,
    ) -> IntervalNarrowing {
        let width = |interval: Option<[Option<f64>; 2]>| match interval {
            Some([Some(from), Some(to)]) => Some(parameter.to_scale(to) - parameter.to_scale(from)),
            _ => None,
        };
        let ratio = width(with).zip(width(alone)).map(|(with, alone)| with / alone);
        IntervalNarrowing { name: parameter.name(), value, interval: alone, ratio }
    }
}

/// What the answers to freeze probes add to the fit, as text.
pub(super) fn describe(answers: &ProbeAnswerFit) -> String {
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
