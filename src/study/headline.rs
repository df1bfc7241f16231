//! What a study found, in plain sentences, the same in the terminal and in the report; and where the causes of errors are
//! known from.

use std::collections::BTreeMap;

use crate::arm_comparison::{
    ContrastDoubt, ContrastVerdict, FEW_EVENTS, StudyArmComparison, StudyArmContrast, StudyConditionSummary,
};
use crate::figures::StudySummary;
use crate::planned_trial::named;
use tomcom_core::base::text::count;
use tomcom_core::measures::raters::BeliefSource;
use tomcom_session::plan::PrimaryOutcome;
use tomcom_session::study_arm::StudyArm;

/// Why the quotient of two rates is not the ratio beside them.
pub const RATES_AND_RATIO: &str = "Rates pool all presses of a condition; the ratio compares the trials within participants (mixed model, the \
                                   number of the trial accounted for), so it need not be their quotient. Its interval has the level at which \
                                   Holm's correction tests it: it is without 1 where the corrected p is below 0.05.";

/// Least number of participants of a difference that is not shown, from which on its interval is told in sentences. With two
/// conditions fewer leave at most three degrees of freedom: an interval of more than three standard errors to both sides,
/// which reaches from almost nothing to a multiple.
const FEWEST_FOR_INTERVAL: usize = 6;

/// Largest number of trials that are named as left out.
const MOST_NAMED: usize = 3;

/// One sentence for each contrast of the primary outcome: whether a difference is shown, how many percent it is with its
/// interval, both rates, and their ratio; before them, if there are several, one that says what they show together. Empty
/// without trials that count.
pub fn primary_outcome(figures: &StudySummary) -> Vec<String> {
    if let Some(found) = &figures.arms {
        let together = (found.contrasts.len() > 1).then(|| answer(found));
        let mut all: Vec<String> =
            together.into_iter().chain(found.contrasts.iter().map(|one| contrast(found, one))).collect();
        if let Some(first) = all.first_mut() {
            *first += &opposed(found);
        }
        return all;
    }
    let (outcome, conditions) = (figures.primary_outcome, &figures.conditions);
    let rates: Vec<String> = conditions.iter().map(|one| rate(one, outcome)).collect();
    let why = match conditions.len() {
        0 => return Vec::new(),
        1 => "one condition, so nothing is compared: no trial of another one counts",
        _ => &format!(
            "not compared: too few participants have trials in several conditions, and an interval needs {FEWEST_FOR_INTERVAL}"
        ),
    };
    let out: Vec<String> = figures.left_out.iter().map(|one| format!("{} ({})", one.recording, one.reason)).collect();
    let out = match out.is_empty() {
        true => String::new(),
        false => format!("; left out: {}", named(&out, MOST_NAMED)),
    };
    let title = outcome.title();
    vec![format!("Primary outcome, {title} per 100 presses of the human: {}; {why}{out}.", rates.join(", "))]
}

/// That the rates of conditions and their ratio point two ways, in a sentence that follows another; empty where they do not.
fn opposed(found: &StudyArmComparison) -> String {
    let is_opposed = |one: &&StudyArmContrast| {
        let [rate, against] = [one.arm, one.against].map(|arm| found.per_100(arm));
        (10.0 * (rate - against)).round() * (100.0 * (one.ratio - 1.0)).round() < 0.0
    };
    let named = |one: &StudyArmContrast| format!("{} to {}", one.arm.title(), one.against.title());
    let which: Vec<String> = found.contrasts.iter().filter(is_opposed).map(named).collect();
    match which.is_empty() {
        true => String::new(),
        false => format!(
            " Of {} rates and ratio point two ways: the rates pool all presses, the ratio compares trials within participants.",
            which.join(", ")
        ),
    }
}

fn rate(one: &StudyConditionSummary, outcome: PrimaryOutcome) -> String {
    let per_100 = per_100(one, outcome).map_or("not known".to_string(), |rate| format!("{rate:.1}"));
    format!("{} {per_100}", one.condition.title())
}

/// Of the outcome, per 100 presses of the human in this condition.
pub(crate) fn per_100(one: &StudyConditionSummary, outcome: PrimaryOutcome) -> Option<f64> {
    match outcome {
        PrimaryOutcome::Errors => one.totals.error_rate_human.map(|rate| 100.0 * rate),
        PrimaryOutcome::BeliefRelatedErrors => one.totals.belief_related_per_100,
        PrimaryOutcome::Sequences => one.totals.sequences_per_100,
    }
}

/// What the contrasts say together, in one sentence.
fn answer(found: &StudyArmComparison) -> String {
    let outcome = found.outcome.title();
    let mut groups: Vec<(ContrastVerdict, bool, StudyArm, Vec<&str>)> = Vec::new();
    for one in &found.contrasts {
        let (verdict, is_fewer) = (one.verdict(), one.ratio < 1.0);
        let is_same = |group: &&mut (ContrastVerdict, bool, StudyArm, Vec<&str>)| {
            let is_alike = group.1 == is_fewer || verdict == ContrastVerdict::NoDifference;
            group.0 == verdict && group.2 == one.against && is_alike
        };
        match groups.iter_mut().find(is_same) {
            Some(group) => group.3.push(one.arm.title()),
            None => groups.push((verdict, is_fewer, one.against, vec![one.arm.title()])),
        }
    }
    let participants = count(found.participants as u64, "participant", "participants");
    let words = |(verdict, is_fewer, against, arms): (ContrastVerdict, bool, StudyArm, Vec<&str>)| {
        let (arms, against) = (arms.join(" and in "), against.title());
        let differ =
            format!("{} {outcome} in {arms} trials than in {against} trials", if is_fewer { "fewer" } else { "more" });
        match verdict {
            ContrastVerdict::Shown => differ,
            ContrastVerdict::Uncertain => format!("perhaps {differ}, which is not certain with {participants}"),
            ContrastVerdict::NoDifference => {
                format!("no difference shown between {} and {against} trials", arms.replace(" and in ", ", "))
            }
        }
    };
    let text = groups.into_iter().map(words).collect::<Vec<_>>().join("; ");
    let first = text.chars().next().map_or(0, char::len_utf8);
    let doubts = |one| is_of_few(found, one).then(|| too_few(found)).or_else(|| not_reliable(found, one));
    let doubted = found.contrasts.iter().find_map(doubts).map_or(String::new(), |why| format!(" ({why})"));
    format!("{}{}{doubted}.", text[..first].to_uppercase(), &text[first..])
}

/// Whether no difference is shown by so few participants that it could hardly have been.
fn is_of_few(found: &StudyArmComparison, one: &StudyArmContrast) -> bool {
    found.participants < FEWEST_FOR_INTERVAL && one.verdict() != ContrastVerdict::Shown
}

fn too_few(found: &StudyArmComparison) -> String {
    let participants = count(found.participants as u64, "participant is", "participants are");
    format!("{participants} too few for a test and an interval; at least {FEWEST_FOR_INTERVAL} are needed")
}

/// Why the interval of a contrast stands in no sentence.
pub(crate) fn no_interval(found: &StudyArmComparison, one: &StudyArmContrast) -> Option<String> {
    let is_known = one.interval.iter().all(|end| end.is_finite());
    let unknown = (!is_known).then(|| "too few trials for an interval".to_string());
    is_of_few(found, one).then(|| too_few(found)).or(unknown)
}

/// That a ratio of the primary model is not reliable, to stand beside it; `None` where nothing speaks against it.
pub(crate) fn not_reliable(found: &StudyArmComparison, one: &StudyArmContrast) -> Option<String> {
    let ContrastDoubt { few_events, other_ratio } = one.doubt?;
    let few = few_events.map(|_| format!("{} are few", found.outcome.title()));
    let other = other_ratio.map(|ratio| format!("the model of counts says {ratio:.2}"));
    Some(format!("not reliable: {}", few.into_iter().chain(other).collect::<Vec<_>>().join(", and ")))
}

/// Why ratios of the primary model are not reliable, each in a sentence with its sources.
pub fn doubts(found: &StudyArmComparison) -> Vec<String> {
    let outcome = found.outcome.title();
    let of = |one: &StudyArmContrast| {
        let ContrastDoubt { few_events, other_ratio } = one.doubt?;
        let (arm, against) = (one.arm.title(), one.against.title());
        let few = few_events.map(|mean| {
            format!(
                "{outcome} are few ({mean:.1} a trial in the condition with the fewest), and below {FEW_EVENTS} a trial a model of \
                 logarithms of counts is biased (Bolker et al. 2009, O'Hara and Kotze 2010)"
            )
        });
        let other = match found.negative_binomial.as_ref().map(|counts| counts.of(one)) {
            Some(Some(other)) => {
                let outside = if other_ratio.is_some() { ", outside the interval" } else { "" };
                let (ratio, p) = (other.ratio, p_value(other.p_holm));
                format!("the negative binomial model, which is one of counts, says {ratio:.2} ({p}){outside}")
            }
            _ => "the negative binomial model cannot be estimated".to_string(),
        };
        let why = few.into_iter().chain([other]).collect::<Vec<_>>().join("; ");
        Some(format!(
            "The ratio {:.2} of {arm} to {against} is not reliable: {why}. Report both models, and conclude nothing from the primary one \
             alone.",
            one.ratio
        ))
    };
    found.contrasts.iter().filter_map(of).collect()
}

fn contrast(found: &StudyArmComparison, one: &StudyArmContrast) -> String {
    let ([low, high], contrasts) = (one.interval, found.contrasts.len());
    let (arm, against) = (one.arm.title(), one.against.title());
    let (outcome, rates) = (found.outcome.title(), [one.against, one.arm].map(|arm| found.per_100(arm)));
    if rates == [0.0, 0.0] {
        return format!(
            "Primary outcome, {outcome} per 100 presses of the human: none in {arm} and none in {against} trials."
        );
    }
    let change = match format!("{:.2}", one.ratio) == "1.00" {
        true => format!("about as many in {arm} trials as in {against} trials"),
        false => format!("{} in {arm} trials than in {against} trials", fewer_or_more(one.ratio)),
    };
    let corrected = match contrasts {
        2.. if !is_of_few(found, one) => format!(" ({} corrected for {contrasts} contrasts)", p_value(one.p_holm)),
        _ => String::new(),
    };
    let (in_percent, of_ratio) = match no_interval(found, one) {
        None => (
            format!("{} interval {} to {}", level(one.level), fewer_or_more(low), fewer_or_more(high)),
            format!(", interval {low:.2} to {high:.2}"),
        ),
        Some(why) => (why, String::new()),
    };
    let shown = match (one.verdict(), one.doubt) {
        (ContrastVerdict::Shown, None) => "",
        (ContrastVerdict::Shown, Some(_)) => "by this model alone, ",
        _ => "no difference shown: ",
    };
    let doubted = not_reliable(found, one).map_or(String::new(), |why| format!(" ({why})"));
    format!(
        "Primary outcome, {outcome} per 100 presses of the human: {shown}{change} ({in_percent}); of all presses, from {:.1} in {against} to \
         {:.1} in {arm} trials; ratio {:.2}{doubted}{of_ratio}{corrected}.",
        rates[0], rates[1], one.ratio,
    )
}

/// A ratio as a change: "28 % fewer".
fn fewer_or_more(ratio: f64) -> String {
    let percent = 100.0 * (ratio - 1.0);
    format!("{:.0} % {}", percent.abs(), if percent < 0.0 { "fewer" } else { "more" })
}

/// A confidence level as text: "95 %", "98.3 %".
pub(crate) fn level(level: f64) -> String {
    let percent = format!("{:.1}", 100.0 * level);
    format!("{} %", percent.strip_suffix(".0").unwrap_or(&percent))
}

/// A p value as text: "p = 0.123", or "p < 0.001".
pub(crate) fn p_value(p: f64) -> String {
    if p < 0.001 { "p < 0.001".to_string() } else { format!("p = {p:.3}") }
}

/// A difference and its interval in the direction of the difference, which is positive, with the word for it: the first
/// of two if it was positive before.
pub(crate) fn directed(value: f64, [low, high]: [f64; 2], words: [&str; 2]) -> (f64, [f64; 2], &str) {
    if value < 0.0 { (-value, [-high, -low], words[1]) } else { (value, [low, high], words[0]) }
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
    // Where nobody erred there was no cause to be known.
    let with_errors: Vec<&StudyConditionSummary> =
        figures.conditions.iter().filter(|one| one.totals.errors > 0).collect();
    let words = with_errors.iter().copied().map(of).collect::<Vec<_>>().join("; ");
    let is_like = |one: &BTreeMap<BeliefSource, u64>, other: &BTreeMap<BeliefSource, u64>| {
        let [all, others]: [u64; 2] = [one, other].map(|sources| sources.values().sum());
        let share = |sources: &BTreeMap<BeliefSource, u64>, source| sources.get(source).copied().unwrap_or(0);
        one.keys().chain(other.keys()).all(|source| share(one, source) * others == share(other, source) * all)
    };
    let differs =
        with_errors.windows(2).any(|pair| !is_like(&pair[0].totals.belief_sources, &pair[1].totals.belief_sources));
    let warning = match differs {
        true => {
            "; so the conditions are measured differently, and what rests on causes (belief related errors, sequences) cannot be compared"
        }
        false => "",
    };
    Some((format!("causes of errors by {words}{warning}"), differs))
}
