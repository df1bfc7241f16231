//! Maximum likelihood fits of the human model to recorded presses.
//!
//! The log likelihood is the sum over all presses of ln p(press | estimate before the press), and, if freeze probes are
//! used, over all answers of ln p(answer | estimate at the freeze). Parameters are transformed to an unbounded scale
//! and searched within bounds. The belief filter's random numbers make the log likelihood noisy by some nats, so the
//! search uses a sequence of quadratic surfaces ([`ascent`]): first from the scores of presses ([`score_surface`]),
//! at the end from the values alone ([`response_surface`]). Standard errors follow from the curvature of the last surface and
//! the outer products of the scores (the "sandwich" of Huber 1967 and White 1982). A parameter whose maximum lies at a
//! bound, or whose interval reaches one, is not identified; the interval of such a parameter is one-sided.

pub mod ascent;
pub mod response_surface;
pub mod score_surface;

use std::sync::Arc;

use serde::Serialize;

use crate::analysis::fitting::ascent::{BoundReached, LikelihoodMaximum, VariableEstimate, ascend};
use tomcom_core::base::text::{count, short};
use tomcom_core::kitchen::Kitchen;
use tomcom_core::mind::fitting::{FitObservations, HumanModelParameter, TrialLikelihood};
use tomcom_core::mind::model::HumanModel;
use tomcom_session::ranges;

/// Half width of a 95 % interval, in standard errors or standard deviations.
const HALF_WIDTH: f64 = 1.96;

/// Recordings of a fit that were made with one human model, which is not that of the first recording.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct OtherModel {
    pub model: String,
    pub recordings: Vec<String>,
}

/// A human model in words: "plain", or "paper-2021 with decision.tau = 3.0, not 4.0".
pub fn in_words(model: &HumanModel) -> String {
    match &model.differences()[..] {
        [] => model.model.name().to_string(),
        differences => format!("{} with {}", model.model.name(), differences.join("; ")),
    }
}

/// The parameters to fit: those that were named, or else the usual ones that a fit beginning with this model can have.
/// Errors: the first named parameter that the fit cannot have, why, and what would be right; or, where none was named,
/// why it can have none of the usual ones.
pub fn choose(named: &[HumanModelParameter], model: &HumanModel) -> Result<Vec<HumanModelParameter>, (String, String)> {
    let wanted = if named.is_empty() { &HumanModelParameter::USUAL[..] } else { named };
    let mut chosen = Vec::new();
    let mut first = None;
    for parameter in wanted {
        match parameter.obstacle(model) {
            None => chosen.push(*parameter),
            Some(obstacle) if !named.is_empty() => return Err(obstacle),
            Some(obstacle) => first = first.or(Some(obstacle)),
        }
    }
    chosen.sort_unstable();
    chosen.dedup();
    match first.filter(|_| chosen.is_empty()) {
        Some(obstacle) => Err(obstacle),
        None => Ok(chosen),
    }
}

/// The trials of the recordings of a fit.
#[derive(Clone, Debug)]
pub struct FitTrials {
    pub kitchen: Arc<Kitchen>,
    /// That of the first recording.
    pub model: HumanModel,
    pub others: Vec<OtherModel>,
    /// Recordings that analyses do not count, each with the reason.
    pub left_out: Vec<String>,
    pub observations: Vec<FitObservations>,
}

#[derive(Clone, Debug, PartialEq)]
pub struct FitSettings {
    pub parameters: Vec<HumanModelParameter>,
    /// Also gives the values of parameters that are not fitted. `None`: the parameters in the recordings.
    pub start: Option<HumanModel>,
    pub most_tries: usize,
}

/// Result of fitting the human model: the output of `tomcom fit`.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct FitSummary {
    pub recordings: u64,
    pub human_actions: u64,
    /// Log likelihood per press with the parameters before the fit, in nats.
    pub log_likelihood_before: f64,
    /// Log likelihood per press with the fitted parameters, in nats.
    pub log_likelihood: f64,
    pub tries: u64,
    pub most_tries: u64,
    /// Whether the search began with the parameters in the recordings rather than with those of a file.
    pub begins_with_recordings: bool,
    pub begins_with: String,
    pub others: Vec<OtherModel>,
    /// Recordings that analyses do not count, each with the reason.
    pub left_out: Vec<String>,
    /// Why usual parameters were not fitted: the model does not use them, or they begin outside of the search.
    pub not_fitted: Vec<String>,
    pub converged: bool,
    pub parameters: Vec<FittedParameter>,
    #[serde(skip)]
    pub model: HumanModel,
    /// Effect of the answers to freeze probes on the fit; `None` if the fit did not use answers.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub answers: Option<ProbeAnswerFit>,
}

impl FitSummary {
    /// By how much less likely the presses, and the answers if they were used, are than before the fit, in nats.
    fn lost(&self) -> f64 {
        let presses = (self.log_likelihood_before - self.log_likelihood) * self.human_actions as f64;
        presses + self.answers.as_ref().map_or(0.0, ProbeAnswerFit::lost)
    }
}

#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct FittedParameter {
    pub name: &'static str,
    pub unit: &'static str,
    pub before: f64,
    pub value: f64,
    /// Whether the parameter's interval is finite on both sides within the bounds of the search.
    pub identified: bool,
    /// Null where not identified, where the log likelihood is not concave, and where the search did not converge.
    pub standard_error: Option<f64>,
    /// 95 % interval of the parameter, symmetric on the scale of the fit; for a parameter at a bound, its profile
    /// likelihood interval. An end beyond the bounds of the search is null.
    pub interval: Option<[Option<f64>; 2]>,
}

impl FittedParameter {
    fn from_variable(parameter: HumanModelParameter, before: f64, found: &VariableEstimate) -> FittedParameter {
        let value = parameter.from_scale(found.at);
        let [low, high] = parameter.bounds().map(|end| parameter.to_scale(end));
        let told = |end: f64| (low..=high).contains(&end).then(|| parameter.from_scale(end));
        let around =
            found.standard_error.map(|error| [-HALF_WIDTH, HALF_WIDTH].map(|width| told(found.at + width * error)));
        let limit = found.limit.map(|limit| parameter.from_scale(limit));
        let interval = match found.end {
            None => around,
            Some(BoundReached::High) => limit.map(|limit| [Some(limit), None]),
            Some(BoundReached::Low) => limit.map(|limit| [None, Some(limit)]),
        };
        let identified = matches!(interval, Some([Some(_), Some(_)]));
        let error = found.standard_error.filter(|_| identified);
        FittedParameter {
            name: parameter.name(),
            unit: parameter.unit(),
            before,
            value,
            identified,
            standard_error: error.map(|error| parameter.error_of(value, error)),
            interval,
        }
    }

    fn span(&self) -> String {
        match self.interval {
            None => "-".to_string(),
            Some([Some(from), Some(to)]) => format!("{} to {}", short(from, 4), short(to, 4)),
            Some([Some(from), None]) => format!("above {}", short(from, 4)),
            Some([None, Some(to)]) => format!("below {}", short(to, 4)),
            Some([None, None]) => "not told".to_string(),
        }
    }
}

/// `likelihood`: of all trials under a model; `tried` is called after each evaluation.
pub fn fit(
    trials: &FitTrials,
    plan: &FitSettings,
    likelihood: impl Fn(&HumanModel) -> TrialLikelihood,
    tried: impl Fn(),
) -> FitSummary {
    let begin = plan.start.as_ref().unwrap_or(&trials.model);
    // `at`: on the unbounded scale of the fit; other parameters as they begin.
    let with = |at: &[f64]| {
        let mut model = begin.clone();
        let both = plan.parameters.iter().zip(at);
        both.for_each(|(parameter, &scaled)| parameter.set(&mut model, parameter.from_scale(scaled)));
        model
    };
    let losses = |at: &[f64]| {
        let model = with(at);
        let is_possible = ranges::check_human_model(&model).is_ok() && model.fault().is_none();
        let losses = is_possible.then(|| likelihood(&model).losses());
        tried();
        losses
    };
    let start: Vec<f64> = plan.parameters.iter().map(|one| one.to_scale(one.get(begin))).collect();
    let bounds: Vec<[f64; 2]> = plan.parameters.iter().map(|one| one.bounds().map(|end| one.to_scale(end))).collect();
    let before = likelihood(begin);
    let LikelihoodMaximum { mut variables, evaluations, converged } = ascend(losses, &start, &bounds, plan.most_tries);
    let mut model = with(&variables.iter().map(|variable| variable.at).collect::<Vec<f64>>());
    let mut after = likelihood(&model);
    // A search that did not converge may end at a point worse than the point where it began.
    if !converged && after.total() < before.total() {
        variables.iter_mut().zip(&start).for_each(|(variable, &start)| variable.at = start);
        (model, after) = (begin.clone(), before.clone());
    }
    let presses = before.presses.max(1) as f64;
    let fitted = plan.parameters.iter().zip(&variables);
    FitSummary {
        recordings: trials.observations.len() as u64,
        human_actions: before.presses,
        log_likelihood_before: before.log_p / presses,
        log_likelihood: after.log_p / presses,
        tries: evaluations as u64,
        most_tries: plan.most_tries as u64,
        begins_with_recordings: plan.start.is_none(),
        begins_with: in_words(begin),
        others: trials.others.clone(),
        left_out: trials.left_out.clone(),
        not_fitted: not_fitted(&plan.parameters, begin),
        converged,
        parameters: fitted.map(|(one, found)| FittedParameter::from_variable(*one, one.get(begin), found)).collect(),
        model,
        answers: (before.answers > 0).then(|| ProbeAnswerFit::from_likelihoods(&before, &after)),
    }
}

pub const FITTED: &str = "Parameters of the human model, fitted to";

pub fn comment(fit: &FitSummary) -> String {
    let values = fit.parameters.iter().map(|one| match (one.standard_error, one.interval) {
        (Some(error), _) => format!("{} = {}, standard error {}", one.name, short(one.value, 4), short(error, 4)),
        (None, Some(_)) => {
            format!(
                "{}, {}: the recordings do not tell it; {} is where the search ended",
                one.name,
                one.span(),
                short(one.value, 4)
            )
        }
        (None, None) if !fit.converged => {
            format!("{} = {}, from a search that did not come to its end", one.name, short(one.value, 4))
        }
        (None, None) => format!("{} = {}, which the recordings do not tell surely", one.name, short(one.value, 4)),
    });
    let values: Vec<String> = values.collect();
    format!(
        "{FITTED} {} with {} of the human:\n{}",
        count(fit.recordings, "recording", "recordings"),
        count(fit.human_actions, "press", "presses"),
        values.join("\n")
    )
}

pub fn describe(fit: &FitSummary) -> String {
    let lost = fit.lost();
    let end = match fit.converged {
        true if lost > 0.0 => format!(
            "\nless likely than before by {lost:.1} nats over all presses{}: not more than the search can tell from chance in \
             the estimate; more samples ([inference] in a file for --start) or recordings tell more",
            if fit.answers.is_some() { " and answers" } else { "" }
        ),
        true => String::new(),
        false => format!(
            "\nthe search did not come to its end: its next step takes more than is left of the {} that --tries allows",
            count(fit.most_tries, "try", "tries")
        ),
    };
    let begin = match (fit.begins_with_recordings, fit.others.is_empty()) {
        (false, _) => "--start",
        (true, true) => "the recordings",
        (true, false) => "the first recording",
    };
    let mut text = format!(
        "{}, {} of the human: log likelihood per press {:.4}, before {:.4}, after {}{end}\nbefore: the parameters of {begin} \
         ({}); what is not fitted stays as it is there\n{}\n{:<24}{:>10}{:>12}{:>10}{:>22}\n",
        count(fit.recordings, "recording", "recordings"),
        count(fit.human_actions, "press", "presses"),
        fit.log_likelihood,
        fit.log_likelihood_before,
        count(fit.tries, "try", "tries"),
        fit.begins_with,
        beside(fit),
        "parameter",
        "before",
        "fitted",
        "error",
        "95 %",
    );
    for one in &fit.parameters {
        let error = one.standard_error.map_or("-".to_string(), |error| short(error, 4));
        let interval = one.span();
        let name = format!("{} ({})", one.name, one.unit);
        let [before, value] = [one.before, one.value].map(|value| short(value, 4));
        text.push_str(&format!("{name:<24}{before:>10}{value:>12}{error:>10}{interval:>22}\n"));
    }
    text += &fit.answers.as_ref().map_or(String::new(), describe_answers);
    text + &untold(fit)
}

fn beside(fit: &FitSummary) -> String {
    let left_out = fit.left_out.iter().map(|one| format!("left out of the analysis: {one}\n"));
    let not_fitted = fit.not_fitted.iter().map(|why| format!("not fitted: {why}\n"));
    let others = fit.others.iter().map(|one| format!("made with {}: {}\n", one.model, one.recordings.join(", ")));
    left_out.chain(not_fitted).chain(others).collect()
}

fn not_fitted(fitted: &[HumanModelParameter], model: &HumanModel) -> Vec<String> {
    let others = HumanModelParameter::USUAL.into_iter().filter(|usual| !fitted.contains(usual));
    others.filter_map(|usual| Some(usual.obstacle(model)?.0)).collect()
}

fn untold(fit: &FitSummary) -> String {
    let untold: Vec<&str> = fit.parameters.iter().filter(|one| !one.identified).map(|one| one.name).collect();
    if untold.is_empty() {
        return String::new();
    }
    let (why, remedy) = match fit.converged {
        true => ("not told by these recordings", "More recordings may tell them"),
        false => ("not known, since the search did not come to its end", "A larger --tries may tell them"),
    };
    format!(
        "\n{why}: {}. These values are not findings, but the file (--out) contains them. {remedy}, or keep them as they are: leave them out of --parameters.\n",
        untold.join(", ")
    )
}

#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ProbeAnswerFit {
    pub answers: u64,
    /// Log likelihood per answer with the parameters before the fit, in nats.
    pub log_likelihood_before: f64,
    /// Log likelihood per answer with the fitted parameters, in nats.
    pub log_likelihood: f64,
    pub shrinkage: Vec<IntervalNarrowing>,
}

#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct IntervalNarrowing {
    pub name: &'static str,
    pub value: f64,
    /// 95 % interval of the parameter when fitted to presses alone, computed as in the main fit.
    pub interval: Option<[Option<f64>; 2]>,
    /// Width of the interval from presses and answers divided by the width from presses alone, on the scale of the fit;
    /// below 1 if answers have narrowed the interval. Null where one of the two intervals has no finite end.
    pub ratio: Option<f64>,
}

impl ProbeAnswerFit {
    fn from_likelihoods(before: &TrialLikelihood, after: &TrialLikelihood) -> ProbeAnswerFit {
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

fn describe_answers(answers: &ProbeAnswerFit) -> String {
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
