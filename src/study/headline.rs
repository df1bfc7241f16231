//! What a study found, in plain sentences, the same in the terminal and in the report; and where the causes of errors are
//! known from.

use std::collections::BTreeMap;

use crate::arm_comparison::{StudyArmComparison, StudyArmContrast, StudyConditionSummary};
use crate::effect::LEVEL;
use crate::figures::StudySummary;
use tomcom_core::base::text::count;
use tomcom_core::measures::raters::BeliefSource;
use tomcom_session::plan::PrimaryOutcome;

/// Why the quotient of two rates is not the ratio beside them.
pub const RATES_AND_RATIO: &str = "Rates pool all presses of a condition; the ratio compares the trials within participants (mixed model, the \
                                   number of the trial accounted for), so it need not be their quotient.";

/// One sentence for each contrast of the primary outcome: both rates, their ratio with its interval, and whether that
/// shows a difference. Empty without trials that count.
pub fn primary_outcome(figures: &StudySummary) -> Vec<String> {
    if let Some(found) = &figures.arms {
        return found.contrasts.iter().map(|one| contrast(found, one)).collect();
    }
    let (outcome, conditions) = (figures.primary_outcome, &figures.conditions);
    let rates: Vec<String> = conditions.iter().map(|one| rate(one, outcome)).collect();
    let why = match conditions.len() {
        0 => return Vec::new(),
        1 => "one condition, so nothing is compared",
        _ => "not compared: too few participants have trials in several conditions",
    };
    vec![format!("Primary outcome, {} per 100 presses of the human: {}; {why}.", outcome.title(), rates.join(", "))]
}

fn rate(one: &StudyConditionSummary, outcome: PrimaryOutcome) -> String {
    let per_100 = match outcome {
        PrimaryOutcome::Errors => one.totals.error_rate_human.map(|rate| 100.0 * rate),
        PrimaryOutcome::BeliefRelatedErrors => one.totals.belief_related_per_100,
        PrimaryOutcome::Sequences => one.totals.sequences_per_100,
    };
    let per_100 = per_100.map_or("not known".to_string(), |rate| format!("{rate:.1}"));
    format!("{} {per_100}", one.condition.title())
}

fn contrast(found: &StudyArmComparison, one: &StudyArmContrast) -> String {
    let rate = |arm| found.arms.iter().find(|counts| counts.arm == arm).map_or(f64::NAN, |counts| counts.per_100());
    let ([low, high], contrasts) = (one.interval, found.contrasts.len());
    let (arm, against) = (one.arm.title(), one.against.title());
    // An interval is that of its contrast alone; of several contrasts some spans nothing by chance.
    let corrected = match contrasts {
        1 => String::new(),
        _ => format!(" ({} corrected for {contrasts} contrasts)", p_value(one.p_holm)),
    };
    let interval = match low.is_finite() && high.is_finite() {
        true => format!("{:.0} % interval {low:.2} to {high:.2}", 100.0 * LEVEL),
        false => "too few trials for an interval".to_string(),
    };
    let is_shown = (high < 1.0 || low > 1.0) && (contrasts == 1 || one.p_holm < 1.0 - LEVEL);
    let verdict = match (is_shown, high < 1.0) {
        (false, _) => "no difference shown".to_string(),
        (true, true) => format!("fewer in {arm} trials than in {against} trials"),
        (true, false) => format!("more in {arm} trials than in {against} trials"),
    };
    format!(
        "Primary outcome, {} per 100 presses of the human: {arm} {:.1}, {against} {:.1}; ratio {:.2}, {interval}: \
         {verdict}{corrected}.",
        found.outcome.title(),
        rate(one.arm),
        rate(one.against),
        one.ratio,
    )
}

/// A p value as text: "p = 0.123", or "p < 0.001".
pub(crate) fn p_value(p: f64) -> String {
    if p < 0.001 { "p < 0.001".to_string() } else { format!("p = {p:.3}") }
}

/// What a reduction of a measure is, in words: "0.1 fewer", "2.3 more".
pub(crate) fn fewer(reduction: f64) -> String {
    format!("{:.1} {}", reduction.abs(), if reduction < 0.0 { "more" } else { "fewer" })
}

/// Sources of causes with their numbers of trials: "the consensus of two raters in 1 trial, the assistant's estimate in 2
/// trials".
pub(crate) fn sources(found: &BTreeMap<BeliefSource, u64>) -> String {
    let one = |(source, trials): (&BeliefSource, &u64)| {
        format!("{} in {}", source.words(), count(*trials, "trial", "trials"))
    };
    found.iter().map(one).collect::<Vec<_>>().join(", ")
}

/// Where the causes of errors are known from, by condition, if from several sources; and whether the conditions differ in
/// that, so that what rests on the causes cannot be compared between them.
pub fn mixed_sources(figures: &StudySummary) -> Option<(String, bool)> {
    if figures.totals.belief_sources.len() < 2 {
        return None;
    }
    let of =
        |one: &StudyConditionSummary| format!("{}: {}", one.condition.title(), sources(&one.totals.belief_sources));
    let words = figures.conditions.iter().map(of).collect::<Vec<_>>().join("; ");
    let is_like = |one: &BTreeMap<BeliefSource, u64>, other: &BTreeMap<BeliefSource, u64>| {
        let [all, others]: [u64; 2] = [one, other].map(|sources| sources.values().sum());
        let share = |sources: &BTreeMap<BeliefSource, u64>, source| sources.get(source).copied().unwrap_or(0);
        one.keys().chain(other.keys()).all(|source| share(one, source) * others == share(other, source) * all)
    };
    let differs = figures
        .conditions
        .windows(2)
        .any(|pair| !is_like(&pair[0].totals.belief_sources, &pair[1].totals.belief_sources));
    let warning = match differs {
        true => {
            "; so the conditions are measured differently, and what rests on causes (belief related errors, sequences) cannot be compared"
        }
        false => "",
    };
    Some((format!("causes of errors by {words}{warning}"), differs))
}
