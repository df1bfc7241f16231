//! Text summary of a study for the terminal.

use crate::analysis::probe_figures;
use crate::arm_comparison::StudyArmComparison;
use crate::effect::{AssistanceEffect, LeftOutParticipant, left_out_in_words};
use crate::figures::{CorrectedRecording, IdenticalCodes, StudySummary, pairs_in_words};
use crate::frozen_plan::PreregistrationCheck;
use crate::headline::{
    RATES_AND_RATIO, directed, doubts, level, mixed_sources, not_reliable, p_value, primary_outcome,
};
use crate::live_arms::SignalSenderResults;
use crate::pass::reading::WaivedPractice;
use crate::planned_trial::{copies_in_words, foreign_in_words, in_words};
use crate::roc::{BootstrapInterval, EQUAL_SIGNALS, INTERPOLATED};
use crate::why::{self, percent};
use tomcom_core::base::text::{count, decimal};
use tomcom_core::measures::matching::{MatchShares, Similarity};
use tomcom_core::measures::raters::BeliefSource;
use tomcom_session::event::TrialEndReason;

pub fn describe(figures: &StudySummary) -> String {
    let totals = &figures.totals;
    let mut text = format!("{}\n", figures.title);
    text += &lines(primary_outcome(figures));
    text += &lines(figures.preregistration.as_ref().map(PreregistrationCheck::words));
    if figures.arms.is_some() {
        text += &format!("{RATES_AND_RATIO}\n");
    }
    text += &format!(
        "{} of {}, {}: {} of the human, {} of the robot\n\
         errors: {} ({} of the presses of both, {} of the human's)\n",
        count(figures.trials, "trial", "trials"),
        count(figures.participants, "participant", "participants"),
        count(totals.actions, "press", "presses"),
        totals.human_actions,
        totals.robot_actions,
        totals.errors,
        percent(totals.error_rate, why::NO_PRESS),
        percent(totals.error_rate_human, why::NO_PRESS),
    );
    if totals.unproven > 0 {
        text += &format!(
            "{} judged by a cost to go that is not proven to be the least\n",
            count(totals.unproven, "press of the human is", "presses of the human are")
        );
    }
    text += &lines(foreign_in_words(&figures.foreign));
    text += &lines(in_words(&figures.missing_trials, &figures.corrections));
    text += &lines(figures.corrections.iter().map(CorrectedRecording::in_words));
    text += &lines(figures.other_orders.iter().map(|one| format!("not the planned order of conditions: {one}")));
    if figures.human_models.len() > 1 {
        let models = figures
            .human_models
            .iter()
            .map(|(model, &trials)| format!("{} with {model}", count(trials, "trial", "trials")));
        let models: Vec<String> = models.collect();
        text += &format!("the assistant had different models of the human: {}\n", models.join(", "));
    }
    text += &lines(copies_in_words(&figures.copies));
    text += &match (totals.belief_related_errors, totals.sequences) {
        (Some(0), _) => format!("belief related errors: 0 of {}\n", count(totals.errors, "error", "errors")),
        (Some(related), Some(sequences)) => format!(
            "belief related errors: {related} ({}), in {} of {} errors each ({} if a sequence may mix aspects), \
             {}{}\n",
            percent(totals.belief_related_share, totals.why_no_share()),
            count(sequences, "sequence", "sequences"),
            number(totals.mean_sequence_length, totals.why_no_length()),
            number(totals.mean_sequence_length_any_aspect, totals.why_no_length()),
            totals.mean_recovery_s.map_or_else(
                || format!("no recovery: {}", totals.why_no_recovery()),
                |seconds| format!("recovery after {seconds:.2} s")
            ),
            if totals.belief_sources.keys().eq([&BeliefSource::Estimate]) {
                "; beliefs by the assistant's estimate alone"
            } else {
                ""
            },
        ),
        _ => format!("belief related errors: not known ({})\n", totals.why_no_rate()),
    };
    text += &lines(mixed_sources(figures).map(|(words, _)| words));
    if let Some(found) = &figures.raters {
        text += &format!(
            "two raters ({}): same cause for {} of {} errors ({}), same false belief for {} of {} ({})\n",
            pairs_in_words(&figures.rater_pairs),
            found.same_cause,
            found.errors,
            kappa(found.kappa_cause),
            found.same_aspect,
            found.beliefs,
            kappa(found.kappa_aspect)
        );
    }
    text += &lines(figures.unused_codes.as_ref().map(|recordings| {
        format!("raters' codes are not used for simulated participants, whose beliefs are recorded: {recordings}")
    }));
    text += &lines(figures.identical_codes.iter().map(IdenticalCodes::in_words));
    if let (Some(shared), Some(episodes)) = (&figures.shared_beliefs, totals.false_belief_episodes) {
        text += &format!(
            "false belief episodes: {episodes}; both raters name the same false belief for {}, each another for {}, \
             one of them alone \
             names one for {}\n",
            count(shared.same, "error", "errors"),
            count(shared.differing, "error", "errors"),
            count(shared.of_one, "error", "errors"),
        );
    }
    for (raters, trials) in &figures.consensus {
        let raters = raters.replace('+', " and ");
        text += &format!("codes of errors: consensus of {raters} in {}\n", count(*trials, "trial", "trials"));
    }
    for one in &figures.stale_consensus {
        text += &format!(
            "stale consensus of raters, not used: {}: {}; settle these errors again\n",
            one.recording, one.reason
        );
    }
    if figures.ended.keys().any(|reason| *reason != TrialEndReason::Presses) {
        let ended: Vec<String> =
            figures.ended.iter().map(|(reason, count)| format!("{count} {}", reason.name())).collect();
        text += &format!("trials ended by: {}\n", ended.join(", "));
    }
    if let [_, _, ..] = &figures.robot[..] {
        let arms: Vec<String> = figures.robot.iter().map(|one| format!("{} {}", one.trials, one.kind.name())).collect();
        text += &format!("trials by the robot's arm: {}\n", arms.join(", "));
    }
    let of = |value: Option<f64>, what: &str, why: &str| match value {
        Some(value) => format!("{value:.2} {what}"),
        None => why.to_string(),
    };
    for one in &figures.conditions {
        text += &format!(
            "  {:<18}{:>11}, errors in {} of the human's presses, {}, {}\n",
            one.condition.title(),
            count(one.trials, "trial", "trials"),
            percent(one.totals.error_rate_human, why::NO_PRESS),
            of(one.totals.mean_sequence_length, "errors per sequence", one.totals.why_no_length()),
            of(one.mean_order_s, "s per order", why::NO_ORDER),
        );
    }
    text += &figures.effects.first().map_or(String::new(), of_effect);
    text += &figures.arms.as_ref().map_or(String::new(), describe_arms);
    for one in &figures.deviations {
        text += &format!("counted in the planned condition: {}\n", one.describe());
    }
    if let Some(carried_out) = &figures.as_carried_out {
        text += "by the conditions as carried out:\n";
        text += &carried_out.effects.first().map_or(String::new(), of_effect);
        text += &carried_out.arms.as_ref().map_or(String::new(), describe_arms);
    }
    if figures.roc.iter().any(|roc| !roc.points.is_empty()) {
        let heads: Vec<String> = EQUAL_SIGNALS.iter().map(|signals| format!("{signals:>6}")).collect();
        text += &format!(
            "concepts, {}, false beliefs by {}: belief related errors prevented, by signals per 100 presses of the \
             human\n{:<12}{}{:>8}\n",
            count(figures.roc_trials, "unassisted trial", "unassisted trials"),
            figures.roc_beliefs_from.map_or("unknown sources", BeliefSource::words),
            "",
            heads.join(""),
            "area"
        );
        let shares = |of: &[BootstrapInterval]| -> String {
            of.iter().map(|one| format!("{:>6}", decimal(one.value, 2))).collect()
        };
        for roc in &figures.roc {
            let area = decimal(roc.auc, 2);
            text += &format!("  {:<10}{}{area:>8}\n", roc.concept.title(), shares(&roc.at_equal_signals));
        }
        text += "share of useless signals among these signals\n";
        for roc in &figures.roc {
            text += &format!("  {:<10}{}\n", roc.concept.title(), shares(&roc.useless_at_equal_signals));
        }
        text += &format!("  {INTERPOLATED}\n");
        let shown =
            || figures.roc.iter().flat_map(|roc| roc.at_equal_signals.iter().chain(&roc.useless_at_equal_signals));
        if shown().any(|one| one.value.is_none()) {
            text += &format!("  -: {}\n", why::NO_CURVE);
        }
        if figures.roc.iter().any(|roc| roc.auc.is_none()) {
            text += &format!("  - as area: {}\n", why::NO_AREA);
        }
    }
    text += &figures.probes.as_ref().map_or(String::new(), probe_figures::describe);
    text += &of_live(&figures.live);
    let compared = [
        ("wizard and ToM-Com", &figures.similarity),
        ("not part of this, a wizard who saw the recommendations", &figures.similarity_with_advice),
    ];
    for (who, found) in compared {
        text += &found.as_ref().map_or(String::new(), |found| of_similarity(who, found));
    }
    text += &lines(WaivedPractice::in_words(&figures.waived));
    for one in &figures.left_out {
        text += &format!("left out of the analysis: {}: {}\n", one.recording, one.reason);
    }
    text
}

fn lines(all: impl IntoIterator<Item = String>) -> String {
    all.into_iter().map(|line| line + "\n").collect()
}

fn of_live(arms: &[SignalSenderResults]) -> String {
    let Some(first) = arms.first() else { return String::new() };
    let mut text = format!(
        "acting by themselves on the same {}: belief related errors and signals per 100 presses of the human\n",
        count(first.trials, "simulated trial", "simulated trials")
    );
    for arm in arms {
        let name = arm.arm.parameter.map_or(arm.arm.concept.to_string(), |at| format!("{} {at}", arm.arm.concept));
        text += &format!(
            "  {name:<14}{} errors, {} per sequence, {} orders ({} a minute), {} signals ({} useless); errors \
             prevented {} (offline {})\n",
            number(arm.belief_related_per_100, why::NO_PRESS),
            number(arm.mean_sequence_length, why::NO_SEQUENCE),
            arm.orders,
            number(arm.orders_per_minute, why::NO_PRESS),
            number(arm.interruptions_per_100, why::NO_PRESS),
            number(arm.useless_per_100, why::NOT_TWINNED),
            number(arm.prevented, why::NO_REFERENCE),
            number(arm.prevented_offline, why::NOT_OFFLINE),
        );
    }
    text
}

/// At three levels. The paper does not say to which its 74 % belong.
fn of_similarity(who: &str, found: &Similarity) -> String {
    let level = |level: &MatchShares| {
        let [recall, chance] = [(level.recall, why::NO_SIGNAL), (level.chance_recall, why::NO_SHIFT)]
            .map(|(share, why)| number(share, why));
        format!("{recall} (by chance {chance})")
    };
    format!(
        "{who}: {} of {} signals of the wizard matched, precision {}, {}\n  recall of the same signal {}, of \
         the same kind \
         {}, of any signal then {}; the paper's 74 % is not defined further\n",
        found.matched,
        found.of_n,
        number(found.signal.precision, why::NO_SIGNAL),
        kappa(found.kappa),
        level(&found.signal),
        level(&found.kind),
        level(&found.any),
    )
}

fn of_effect(effect: &AssistanceEffect) -> String {
    let (Some(test), Some(pearson)) = (effect.assistance(), effect.pearson) else {
        return match effect.groups.iter().sum::<usize>() {
            0 => String::new(),
            pairs => format!(
                "the paper's analysis of assistance, secondary: cannot be computed from {}: {}\n",
                count(pairs as u64, "pair of trials", "pairs of trials"),
                effect.why_no_test()
            ),
        };
    };
    let p = why::decimal(effect.permutation_p, 4, effect.why_no_test());
    let bounded = effect.reduction.filter(|found| found.low.is_finite() && found.high.is_finite());
    let reduction = bounded.map_or(String::new(), |found| {
        let [estimate, low, high] = [found.estimate, found.low, found.high].map(|value| 100.0 * value);
        let (estimate, [low, high], fewer) = directed(estimate, [low, high], ["fewer", "more"]);
        format!(
            "{estimate:.1} {fewer} errors per 100 presses of the human with assistance, {:.1} % interval {low:.1} to {high:.1} {fewer} \
             (Hodges-Lehmann); ",
            100.0 * found.level,
        )
    });
    let [second, first] = effect.groups;
    format!(
        "the paper's analysis of assistance, secondary: {reduction}F({:.0}, {:.0}) = {:.2}, p = {:.4}; r = {:.2}; permutation p = {p}\n  \
         {} participants: {second} assisted in the second trial, {first} in the first{}\n",
        test.df[0],
        test.df[1],
        test.f,
        test.p,
        pearson.r,
        second + first,
        left_out_of(&effect.left_out),
    )
}

fn left_out_of(left_out: &[LeftOutParticipant]) -> String {
    left_out_in_words(left_out).map_or(String::new(), |who| format!("; left out: {who}"))
}

pub fn describe_arms(found: &StudyArmComparison) -> String {
    let mut text = format!(
        "{} per press of the human, by condition (linear mixed model of {} of {}{}; ratio with interval, below 1: fewer with the first):\n",
        found.outcome.title(),
        count(found.trials as u64, "trial", "trials"),
        count(found.participants as u64, "participant", "participants"),
        left_out_of(&found.left_out),
    );
    for one in &found.contrasts {
        let [low, high] = one.interval;
        let doubted = not_reliable(found, one).map_or(String::new(), |why| format!("{why}; "));
        text += &format!(
            "  {} to {}: ratio {:.2} ({doubted}{} {low:.2} to {high:.2}), t({:.1}) = {:.2}, {}, corrected by Holm: {}\n",
            one.arm.title(),
            one.against.title(),
            one.ratio,
            level(one.level),
            one.contrast.df,
            one.contrast.t,
            p_value(one.contrast.p),
            p_value(one.p_holm)
        );
    }
    for one in &found.non_inferiority {
        let verdict = if one.holds { "not worse than" } else { "not shown to be not worse than" };
        text += &format!(
            "  {} is {verdict} {}: upper end of the ratio {:.2}, margin {:.2}\n",
            one.arm.title(),
            one.against.title(),
            one.upper,
            one.margin
        );
    }
    text += &lines(doubts(found).iter().map(|sentence| format!("  {sentence}")));
    text
}

fn kappa(value: Option<f64>) -> String {
    value.map_or_else(|| why::NO_KAPPA.to_string(), |value| format!("kappa {value:.2}"))
}

fn number(value: Option<f64>, why: &str) -> String {
    why::decimal(value, 2, why)
}
