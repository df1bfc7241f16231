//! Sections of the study report on the effect of assistance, and on the comparison of arms.

use maud::{Markup, Render, html};

use crate::arm_comparison::{
    ArmAnalysis, ArmDeviation, GroupOrder, NegativeBinomialContrast, NonInferiority, StudyArmComparison,
    StudyArmContrast, StudyConditionSummary,
};
use crate::charts;
use crate::effect::{AssistanceEffect, LeftOutParticipant, left_out_in_words};
use crate::figures::StudySummary;
use crate::headline::{RATES_AND_RATIO, directed, doubts, level, mixed_sources, not_reliable};
use crate::report::elements::{
    Captions, PageColumn, cells, fixed, keys, known, nothing, number, p_sentence, p_value, p_words, percent, range,
    with_interval,
};
use crate::statistics::FTest;
use crate::trial_statistics::TrialStatistics;
use crate::why;

pub(super) fn assistance(captions: &mut Captions, figures: &StudySummary, trials: &[TrialStatistics]) -> Markup {
    let headline = figures.effects.first();
    if figures.conditions.len() > 2 {
        // Charts and tests compare two conditions; a study with more conditions has another section for that.
        let content = html! { (conditions(captions, &figures.conditions)) (sources_differ(figures)) };
        return captions.section("Errors and times", content);
    }
    let pictures = pictures(captions, figures, trials);
    if pictures.0.is_empty() {
        return nothing();
    }
    let content = html! {
        (conditions(captions, &figures.conditions))
        (sources_differ(figures))
        div class="figures" { (pictures) } "\n"
        (headline.map_or_else(nothing, in_words))
        (experience(figures))
        @if figures.effects.iter().any(AssistanceEffect::has_pairs) {
            h3 { "Secondary tests" } "\n"
            (tests(captions, &figures.effects))
            @if let Some(effect) = headline { (anova(captions, effect)) }
        } @else {
            p class="note" {
                "Nothing is tested: no participant has one trial with assistance and one without among the trials that count."
            }
            "\n"
        }
    };
    captions.section(if figures.conditions.len() > 1 { "Does assistance help?" } else { "Errors and times" }, content)
}

/// Warning below a table of conditions whose columns about causes cannot be compared; empty if they can.
fn sources_differ(figures: &StudySummary) -> Markup {
    let Some((words, true)) = mixed_sources(figures) else { return nothing() };
    html! { p class="warning" { "C" (&words[1..]) "." } "\n" }
}

fn pictures(captions: &mut Captions, figures: &StudySummary, trials: &[TrialStatistics]) -> Markup {
    let key = keys(&[("first", "assisted first"), ("second", "unassisted first")]);
    let of_conditions = keys(&[("unassisted", "unassisted"), ("assisted", "assisted")]);
    html! {
        (captions.figure(charts::improvements(trials), html! {
            "Reduction of errors per 100 presses from the first to the second trial. Practice changes both groups alike; a difference \
             between the groups is the effect of assistance." (key)
        }))
        (captions.figure(charts::press_durations(trials), html! {
            "Median seconds between presses, which indicate experience." (of_conditions)
        }))
        (captions.figure(charts::sequence_lengths(&figures.conditions), html! {
            "Mean number of error sequences per trial, by length." (of_conditions)
        }))
    }
}

fn conditions(captions: &mut Captions, found: &[StudyConditionSummary]) -> Markup {
    let columns: [PageColumn<StudyConditionSummary>; 15] = [
        ("condition", |one| one.condition.title().render()),
        ("trials", |one| one.trials.render()),
        ("errors", |one| one.totals.errors.render()),
        ("errors per trial", |one| number(one.mean_errors, 1, "no trial")),
        ("per press of the human", |one| percent(one.totals.error_rate_human, why::NO_PRESS)),
        ("per press of both", |one| percent(one.totals.error_rate, why::NO_PRESS)),
        ("belief related", |one| percent(one.totals.belief_related_share, one.totals.why_no_share())),
        ("belief related per 100 presses", |one| {
            number(one.totals.belief_related_per_100, 2, one.totals.why_no_rate())
        }),
        ("sequences per 100 presses", |one| number(one.totals.sequences_per_100, 2, one.totals.why_no_rate())),
        ("errors per sequence", |one| number(one.totals.mean_sequence_length, 2, one.totals.why_no_length())),
        ("s to recover", |one| number(one.totals.mean_recovery_s, 1, one.totals.why_no_recovery())),
        ("s per order", |one| number(one.mean_order_s, 1, why::NO_ORDER)),
        ("additional presses per order", |one| number(one.mean_additional_presses_per_order, 1, why::NO_ORDER)),
        ("s per press", |one| number(one.mean_press_s, 2, why::ONE_PRESS)),
        ("signals", |one| one.totals.signals.render()),
    ];
    let caption = "By condition. Shares are of all presses, or errors, of a condition together, so that long trials weigh more; \
                   errors a trial, seconds from an order's appearance to its serving, additional presses (summed regret of both \
                   agents) and seconds a press are means over trials.";
    captions.table_of_columns(caption, &columns, found.iter())
}

fn in_words(effect: &AssistanceEffect) -> Markup {
    let (Some(reduction), Some(test)) = (effect.reduction, effect.assistance()) else { return nothing() };
    let [estimate, low, high] = [reduction.estimate, reduction.low, reduction.high].map(|value| 100.0 * value);
    let (estimate, ends, fewer) = directed(estimate, [low, high], ["fewer", "more"]);
    let interval = match low.is_finite() && high.is_finite() {
        true => format!(", interval of {:.1} %: {} {fewer}", 100.0 * reduction.level, range(ends, 1)),
        false => "; too few participants for an interval".to_string(),
    };
    let shown = if low < 0.0 && high > 0.0 { ": no difference shown" } else { "" };
    let degrees = format!("{:.0},\u{a0}{:.0}", test.df[0], test.df[1]);
    html! {
        p {
            "The paper\u{2019}s analysis, secondary: in " (test.n) " participants " (fixed(estimate, 1)) " " (fewer)
            " errors per 100 presses of the human with assistance (Hodges-Lehmann" (interval) ")" (shown) ". Interaction of period and starting group: F(" (degrees) ")\u{a0}=\u{a0}"
            (fixed(test.f, 2)) ", " (p_sentence(test.p)) "."
        }
        "\n"
    }
}

/// Sentence on the effect of the period on the time between presses, since that effect shows experience.
fn experience(figures: &StudySummary) -> Markup {
    let pace = figures.effects.iter().find(|effect| effect.measure.name == "press_s");
    let Some((effect, test)) = pace.and_then(|effect| Some((effect, effect.by_period.within?))) else {
        return nothing();
    };
    let change = |(seconds, which): (Option<f64>, &str)| {
        let (seconds, _, falls) = directed(seconds?, [0.0; 2], ["falls", "rises"]);
        Some(format!("{falls} by {} s ({which} trial assisted)", fixed(seconds, 2)))
    };
    let changes: Vec<String> = effect.improvements.into_iter().zip(["second", "first"]).filter_map(change).collect();
    html! {
        p {
            "Experience: from the first trial to the second the time between presses " (changes.join(" and "))
            "; period F(" (format!("{:.0},\u{a0}{:.0}", test.df[0], test.df[1]))
            ")\u{a0}=\u{a0}" (fixed(test.f, 2)) ", " (p_sentence(test.p)) "; "
            @if let Some(test) = effect.assistance() { "assistance " (p_sentence(test.p)) "; " }
            (test.n) " participants."
        }
        "\n"
    }
}

fn tests(captions: &mut Captions, effects: &[AssistanceEffect]) -> Markup {
    let columns: [PageColumn<AssistanceEffect>; 13] = [
        ("measure (lower is better)", |effect| effect.measure.title.render()),
        ("participants", |effect| format!("{} + {}", effect.groups[0], effect.groups[1]).render()),
        ("left out", |effect| effect.left_out.len().render()),
        ("F (interaction)", |effect| number(effect.assistance().map(|test| test.f), 2, effect.why_no_test())),
        ("p", |effect| p_value(effect.assistance().map(|test| test.p), effect.why_no_test())),
        ("partial \u{3b7}\u{b2}", |effect| {
            number(effect.assistance().map(|test| test.partial_eta_sq), 2, effect.why_no_test())
        }),
        ("r", |effect| number(effect.pearson.map(|found| found.r), 2, effect.why_no_test())),
        ("p of r", |effect| p_value(effect.pearson.map(|found| found.p), effect.why_no_test())),
        ("permutation p", |effect| p_value(effect.permutation_p, effect.why_no_test())),
        ("less by", |effect| {
            let found = effect.reduction;
            with_interval(
                found.map(|found| found.estimate),
                found.map(|found| [found.low, found.high]),
                effect.measure.digits,
                effect.why_no_test(),
            )
        }),
        ("Hedges\u{2019} g", |effect| number(effect.hedges_g, 2, effect.why_no_test())),
        ("F (period)", |effect| number(effect.by_period.within.map(|test| test.f), 2, effect.why_no_test())),
        ("p of period", |effect| p_value(effect.by_period.within.map(|test| test.p), effect.why_no_test())),
    ];
    let caption = "Tests of what assistance takes away. Participants: assisted in the second trial + in the first. Less by: the \
                   Hodges-Lehmann estimate with its interval (at least 95 %). Period: the second trial against the first, whatever \
                   the condition, which is experience, at the unweighted mean of both groups (type III). Left out: participants with \
                   recordings of whom not both trials have the measure.";
    // Measures that leave out the same participants share a sentence.
    let mut sentences: Vec<(&[LeftOutParticipant], Vec<&str>)> = Vec::new();
    for effect in effects {
        match sentences.iter_mut().find(|(left_out, _)| *left_out == effect.left_out) {
            Some((_, titles)) => titles.push(effect.measure.title),
            None => sentences.push((&effect.left_out, vec![effect.measure.title])),
        }
    }
    html! {
        (captions.table_of_columns(caption, &columns, effects.iter()))
        @for (who, titles) in sentences { (left_out(&titles.join(", "), who)) }
    }
}

fn left_out(what: &str, left_out: &[LeftOutParticipant]) -> Markup {
    let Some(who) = left_out_in_words(left_out) else { return nothing() };
    html! { p class="note" { "Left out of the tests of " (what) ": " (who) "." } "\n" }
}

fn anova(captions: &mut Captions, effect: &AssistanceEffect) -> Markup {
    let row = |what: &dyn Render, test: Option<FTest>| {
        let why = effect.why_no_test();
        cells([
            what,
            &number(test.map(|test| test.f), 3, why),
            &known(test, why, |test| format!("{:.0}, {:.0}", test.df[0], test.df[1])),
            &p_value(test.map(|test| test.p), why),
            &number(test.map(|test| test.partial_eta_sq), 3, why),
        ])
    };
    let (period, condition) = (&effect.by_period, &effect.by_condition);
    let rows = [
        row(&"period (within)", period.within),
        row(&"starting group (between)", period.between),
        row(&html! { "period \u{d7} starting group: " b { "assistance" } }, period.interaction),
        row(&"the paper\u{2019}s coding: condition (within)", condition.within),
        row(&"the paper\u{2019}s coding: starting group (between)", condition.between),
        row(&"the paper\u{2019}s coding: condition \u{d7} starting group", condition.interaction),
    ];
    let heads = ["", "F", "degrees of freedom", "p", "partial \u{3b7}\u{b2}"];
    html! {
        h3 { "Secondary: mixed ANOVA of " (effect.measure.title) } "\n"
        (captions.table(html! {
            "Mixed ANOVA of " (effect.groups.iter().sum::<usize>()) " participants, in the coding of a crossover and in the paper\u{2019}s; \
             sums of squares of type III."
        }, &heads, &rows))
    }
}

pub(super) fn arms(captions: &mut Captions, figures: &StudySummary) -> Markup {
    let content = html! {
        @if let Some(found) = &figures.arms { (comparison(captions, found)) }
        @if let Some(found) = &figures.as_carried_out { (carried_out(captions, &figures.deviations, found)) }
    };
    captions.section("How do the conditions compare?", content)
}

fn carried_out(captions: &mut Captions, deviations: &[ArmDeviation], found: &ArmAnalysis) -> Markup {
    html! {
        h3 { "Deviations from the plan" } "\n"
        p class="warning" {
            "Each trial counts in the condition to which the plan assigned it. Carried out otherwise: "
            (deviations.iter().map(ArmDeviation::describe).collect::<Vec<_>>().join("; "))
            ". The same analysis by the conditions as carried out follows."
        }
        "\n"
        (conditions(captions, &found.conditions))
        @if found.effects.iter().any(AssistanceEffect::has_pairs) { (tests(captions, &found.effects)) }
        @if let Some(arms) = &found.arms {
            (contrasts(captions, arms))
            (left_out("the contrasts", &arms.left_out))
        }
    }
}

fn comparison(captions: &mut Captions, found: &StudyArmComparison) -> Markup {
    let outcome = found.outcome.title();
    let [between, within] = found.standard_deviations;
    html! {
        p {
            "Compared: " (outcome) " per press of the human, in " (found.trials) " trials of " (found.participants)
            " participants. Linear mixed model of log((count\u{a0}+\u{a0}0.5)\u{a0}/\u{a0}presses): participant random, condition and trial \
            number fixed; REML, Satterthwaite\u{2019}s degrees of freedom. Standard deviations of the logarithms: "
            (fixed(between, 2)) " between participants, " (fixed(within, 2)) " within."
        }
        "\n"
        @if !found.groups.is_empty() {
            p {
                "Starting groups, with the order of their conditions and the number of participants: "
                (found.groups.iter().map(GroupOrder::describe).collect::<Vec<_>>().join("; ")) "."
            }
            "\n"
        }
        (contrasts(captions, found))
        (left_out("the contrasts", &found.left_out))
        @for one in &found.non_inferiority { (arms_in_words(one, outcome)) }
        @if found.arms.len() > 2 && found.with_carry_over.is_empty() {
            p class="note" { "The effect of the condition before (carry-over) cannot be estimated from these trials." } "\n"
        }
    }
}

/// A contrast of study arms in the primary model, with the same contrast in the two other models.
struct ContrastRow<'a> {
    own: &'a StudyArmContrast,
    doubt: Option<String>,
    carried: Option<&'a StudyArmContrast>,
    of_counts: Option<&'a NegativeBinomialContrast>,
}

fn contrasts(captions: &mut Captions, found: &StudyArmComparison) -> Markup {
    let rows: Vec<ContrastRow> = found
        .contrasts
        .iter()
        .map(|own| ContrastRow {
            own,
            doubt: not_reliable(found, own),
            carried: found.with_carry_over.iter().find(|other| (other.arm, other.against) == (own.arm, own.against)),
            of_counts: found.negative_binomial.as_ref().and_then(|model| model.of(own)),
        })
        .collect();
    let columns: [PageColumn<ContrastRow>; 9] = [
        ("condition", |row| row.own.arm.title().render()),
        ("against", |row| row.own.against.title().render()),
        ("ratio of rates", |row| {
            html! {
                (with_interval(Some(row.own.ratio), Some(row.own.interval), 2, ""))
                @if let Some(why) = &row.doubt { small class="doubt" { (why) } }
            }
        }),
        ("level of the interval", |row| level(row.own.level).render()),
        ("t (degrees of freedom)", |row| {
            format!("{} ({})", fixed(row.own.contrast.t, 2), fixed(row.own.contrast.df, 1)).render()
        }),
        ("p", |row| p_words(row.own.contrast.p).render()),
        ("p, Holm", |row| p_words(row.own.p_holm).render()),
        ("negative binomial: ratio, p (Holm)", |row| {
            known(row.of_counts, why::NO_COUNTS, |one| format!("{}, {}", fixed(one.ratio, 2), p_words(one.p_holm)))
        }),
        ("with carry-over: ratio, p (Holm)", |row| {
            known(row.carried, NO_CARRY_OVER, |one| format!("{}, {}", fixed(one.ratio, 2), p_words(one.p_holm)))
        }),
    ];
    let (columns, carried) = match found.with_carry_over.is_empty() {
        true => (&columns[..8], ""),
        false => (&columns[..], " and of the primary model with the effect of the condition before"),
    };
    let caption = format!(
        "Contrasts of the primary model, and beside them those of a mixed negative binomial model (log presses as offset){carried}. Holm: \
         corrected over all contrasts of a model. {RATES_AND_RATIO}"
    );
    html! {
        (captions.table_of_columns(caption, columns, rows.iter()))
        @for sentence in doubts(found) { p class="warning" { (sentence) } "\n" }
    }
}

const NO_CARRY_OVER: &str = "cannot be estimated from these trials";

fn arms_in_words(one: &NonInferiority, outcome: &str) -> Markup {
    let verdict = if one.holds { "is not worse than" } else { "is not shown to be not worse than" };
    html! {
        p {
            (one.arm.title()) " " (verdict) " the " (one.against.title()) ": ratio of " (outcome) " " (fixed(one.ratio, 2))
            ", upper end of the one-sided interval of 97.5 % " (fixed(one.upper, 2)) ", margin "
            (fixed(one.margin, 2)) " (" (p_sentence(one.p)) ")."
        }
        "\n"
    }
}
