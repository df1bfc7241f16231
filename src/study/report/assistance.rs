//! Sections of the study report on the effect of assistance, and on the comparison of arms.

use maud::{Markup, Render, html};

use crate::arm_comparison::{
    ArmAnalysis, ArmDeviation, GroupOrder, NonInferiority, StudyArmComparison, StudyArmContrast, StudyConditionSummary,
};
use crate::charts;
use crate::effect::{AssistanceEffect, LeftOutParticipant, left_out_in_words};
use crate::figures::StudySummary;
use crate::headline::{RATES_AND_RATIO, fewer, level, mixed_sources};
use crate::report::elements::{
    Captions, PageColumn, UNKNOWN, cells, keys, nothing, number, p_sentence, p_value, percent, range, with_interval,
};
use crate::statistics::FTest;
use crate::trial_statistics::TrialStatistics;

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
            h3 { "Tests" } "\n"
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
        ("errors per trial", |one| number(one.mean_errors, 1).render()),
        ("per press of the human", |one| percent(one.totals.error_rate_human).render()),
        ("per press of both", |one| percent(one.totals.error_rate).render()),
        ("belief related", |one| percent(one.totals.belief_related_share).render()),
        ("belief related per 100 presses", |one| number(one.totals.belief_related_per_100, 2).render()),
        ("sequences per 100 presses", |one| number(one.totals.sequences_per_100, 2).render()),
        ("errors per sequence", |one| number(one.totals.mean_sequence_length, 2).render()),
        ("s to recover", |one| number(one.totals.mean_recovery_s, 1).render()),
        ("s per order", |one| number(one.mean_order_s, 1).render()),
        ("additional presses per order", |one| number(one.mean_additional_presses_per_order, 1).render()),
        ("s per press", |one| number(one.mean_press_s, 2).render()),
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
    let interval = match low.is_finite() && high.is_finite() {
        true => format!(", interval of {:.1} %: {} fewer", 100.0 * reduction.level, range([low, high], 1)),
        false => "; too few participants for an interval".to_string(),
    };
    let shown = if low < 0.0 && high > 0.0 { ": no difference shown" } else { "" };
    let degrees = format!("{:.0},\u{a0}{:.0}", test.df[0], test.df[1]);
    html! {
        p {
            "The paper\u{2019}s analysis, secondary: in " (test.n) " participants " (fewer(estimate))
            " errors per 100 presses of the human with assistance (Hodges-Lehmann" (interval) ")" (shown) ". Interaction of period and starting group: F(" (degrees) ")\u{a0}=\u{a0}"
            (number(Some(test.f), 2)) ", " (p_sentence(Some(test.p))) "."
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
    let [faster_second, faster_first] = effect.improvements.map(|seconds| number(seconds, 2));
    html! {
        p {
            "Experience: from the first trial to the second the time between presses falls by " (faster_second) " s (second trial \
            assisted) and " (faster_first) " s (first trial assisted); period F(" (format!("{:.0},\u{a0}{:.0}", test.df[0], test.df[1]))
            ")\u{a0}=\u{a0}" (number(Some(test.f), 2)) ", " (p_sentence(Some(test.p))) "; assistance "
            (p_sentence(effect.assistance().map(|test| test.p))) "; " (test.n) " participants."
        }
        "\n"
    }
}

fn tests(captions: &mut Captions, effects: &[AssistanceEffect]) -> Markup {
    let columns: [PageColumn<AssistanceEffect>; 13] = [
        ("measure (lower is better)", |effect| effect.measure.title.render()),
        ("participants", |effect| format!("{} + {}", effect.groups[0], effect.groups[1]).render()),
        ("left out", |effect| effect.left_out.len().render()),
        ("F (interaction)", |effect| number(effect.assistance().map(|test| test.f), 2).render()),
        ("p", |effect| p_value(effect.assistance().map(|test| test.p)).render()),
        ("partial \u{3b7}\u{b2}", |effect| number(effect.assistance().map(|test| test.partial_eta_sq), 2).render()),
        ("r", |effect| number(effect.pearson.map(|found| found.r), 2).render()),
        ("p of r", |effect| p_value(effect.pearson.map(|found| found.p)).render()),
        ("permutation p", |effect| p_value(effect.permutation_p).render()),
        ("less by", |effect| {
            let found = effect.reduction;
            with_interval(
                found.map(|found| found.estimate),
                found.map(|found| [found.low, found.high]),
                effect.measure.digits,
            )
        }),
        ("Hedges\u{2019} g", |effect| number(effect.hedges_g, 2).render()),
        ("F (period)", |effect| number(effect.by_period.within.map(|test| test.f), 2).render()),
        ("p of period", |effect| p_value(effect.by_period.within.map(|test| test.p)).render()),
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
        cells([
            what,
            &number(test.map(|test| test.f), 3),
            &test.map_or(UNKNOWN.to_string(), |test| format!("{:.0}, {:.0}", test.df[0], test.df[1])),
            &p_value(test.map(|test| test.p)),
            &number(test.map(|test| test.partial_eta_sq), 3),
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
        h3 { "Mixed ANOVA of " (effect.measure.title) } "\n"
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
            (number(Some(between), 2)) " between participants, " (number(Some(within), 2)) " within."
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
    carried: Option<&'a StudyArmContrast>,
    of_counts: Option<(f64, f64)>,
}

fn contrasts(captions: &mut Captions, found: &StudyArmComparison) -> Markup {
    let counts = || found.negative_binomial.iter().flat_map(|model| &model.contrasts);
    let rows: Vec<ContrastRow> = found
        .contrasts
        .iter()
        .map(|own| ContrastRow {
            own,
            carried: found.with_carry_over.iter().find(|other| (other.arm, other.against) == (own.arm, own.against)),
            of_counts: counts()
                .find(|other| (other.arm, other.against) == (own.arm, own.against))
                .map(|other| (other.ratio, other.p_holm)),
        })
        .collect();
    let columns: [PageColumn<ContrastRow>; 9] = [
        ("condition", |row| row.own.arm.title().render()),
        ("against", |row| row.own.against.title().render()),
        ("ratio of rates", |row| with_interval(Some(row.own.ratio), Some(row.own.interval), 2)),
        ("level of the interval", |row| level(row.own.level).render()),
        ("t (degrees of freedom)", |row| {
            format!("{} ({})", number(Some(row.own.contrast.t), 2), number(Some(row.own.contrast.df), 1)).render()
        }),
        ("p", |row| p_value(Some(row.own.contrast.p)).render()),
        ("p, Holm", |row| p_value(Some(row.own.p_holm)).render()),
        ("negative binomial: ratio, p (Holm)", |row| {
            row.of_counts
                .map_or_else(
                    || number(None, 2),
                    |(ratio, p)| format!("{}, {}", number(Some(ratio), 2), p_value(Some(p))),
                )
                .render()
        }),
        ("with carry-over: ratio, p (Holm)", |row| {
            row.carried
                .map_or_else(
                    || number(None, 2),
                    |one| format!("{}, {}", number(Some(one.ratio), 2), p_value(Some(one.p_holm))),
                )
                .render()
        }),
    ];
    let caption = "Contrasts of the primary model, and beside them those of a mixed negative binomial model (log presses as offset) and of \
                   the primary model with the effect of the condition before. Holm: corrected over all contrasts of a model.";
    let caption = format!("{caption} {RATES_AND_RATIO}");
    captions.table_of_columns(caption, &columns, rows.iter())
}

fn arms_in_words(one: &NonInferiority, outcome: &str) -> Markup {
    let verdict = if one.holds { "is not worse than" } else { "is not shown to be not worse than" };
    html! {
        p {
            (one.arm.title()) " " (verdict) " the " (one.against.title()) ": ratio of " (outcome) " " (number(Some(one.ratio), 2))
            ", upper end of the one-sided interval of 97.5 % " (number(Some(one.upper), 2)) ", margin "
            (number(Some(one.margin), 2)) " (p\u{a0}=\u{a0}" (p_value(Some(one.p))) ")."
        }
        "\n"
    }
}
