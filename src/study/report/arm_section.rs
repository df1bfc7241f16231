//! Section of the study report that compares the study's arms.

use maud::{Markup, Render, html};

use super::assistance;
use super::elements::{Captions, PageColumn, number, p_value, scroll, section, with_interval};
use crate::arm_analysis::{ArmAnalysis, ArmDeviation};
use crate::arm_chart;
use crate::arm_comparison::{NonInferiority, StudyArmComparison, StudyArmContrast, StudyArmCounts};
use crate::effect::AssistanceEffect;
use crate::figures::StudySummary;
use crate::group_orders::GroupOrder;

/// Section with the arms' rates, their contrasts, the non-inferiority of the assistant to the wizard, and the deviations
/// from the planned arms.
pub(super) fn arms(captions: &mut Captions, figures: &StudySummary) -> Markup {
    let content = html! {
        @if let Some(found) = &figures.arms { (comparison(captions, found)) }
        @if let Some(found) = &figures.as_carried_out { (carried_out(captions, &figures.deviations, found)) }
    };
    section("How do the conditions compare?", content)
}

/// The deviations from the planned arms, and the analysis by the arms as carried out.
fn carried_out(captions: &mut Captions, deviations: &[ArmDeviation], found: &ArmAnalysis) -> Markup {
    html! {
        h3 { "Deviations from the plan" } "\n"
        p class="warning" {
            "Each trial counts in the condition to which the plan assigned it. Carried out otherwise: "
            (deviations.iter().map(ArmDeviation::describe).collect::<Vec<_>>().join("; "))
            ". The same analysis by the conditions as carried out follows."
        }
        "\n"
        (scroll(assistance::conditions(captions, &found.conditions)))
        @if found.effects.iter().any(AssistanceEffect::has_pairs) { (assistance::tests(captions, &found.effects)) }
        @if let Some(arms) = &found.arms {
            (scroll(rates(captions, arms)))
            (scroll(contrasts(captions, arms)))
            (assistance::left_out("the contrasts", &arms.left_out))
        }
    }
}

fn comparison(captions: &mut Captions, found: &StudyArmComparison) -> Markup {
    let outcome = found.outcome.title();
    let [between, within] = found.standard_deviations;
    html! {
        p {
            "Primary outcome: " (outcome) " per press of the human, in " (found.trials) " trials of " (found.participants)
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
        (scroll(rates(captions, found)))
        div class="figures" {
            (captions.figure(arm_chart::ratios(&found.contrasts), "Ratio of the rates of two conditions, with its interval of 95 %. Below \
                1 the first one has fewer."))
        }
        "\n"
        (scroll(contrasts(captions, found)))
        (assistance::left_out("the contrasts", &found.left_out))
        @for one in &found.non_inferiority { (in_words(one, outcome)) }
        @if found.arms.len() > 2 && found.with_carry_over.is_empty() {
            p class="note" { "The effect of the condition before (carry-over) cannot be estimated from these trials." } "\n"
        }
    }
}

fn rates(captions: &mut Captions, found: &StudyArmComparison) -> Markup {
    let columns: [PageColumn<StudyArmCounts>; 5] = [
        ("condition", |one| one.arm.title().render()),
        ("trials", |one| one.trials.render()),
        ("events", |one| one.events.render()),
        ("presses of the human", |one| one.presses.render()),
        ("per 100 presses", |one| number(Some(one.per_100()), 2).render()),
    ];
    let caption = format!("Events ({}) by condition, all trials of a condition pooled.", found.outcome.title());
    captions.table_of_columns(&caption, &columns, found.arms.iter())
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
    let columns: [PageColumn<ContrastRow>; 8] = [
        ("condition", |row| row.own.arm.title().render()),
        ("against", |row| row.own.against.title().render()),
        ("ratio of rates", |row| with_interval(Some(row.own.ratio), Some(row.own.interval), 2)),
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
    captions.table_of_columns(caption, &columns, rows.iter())
}

fn in_words(one: &NonInferiority, outcome: &str) -> Markup {
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
