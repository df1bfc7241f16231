//! Section of the study report on what participants knew, by their answers to freeze probes.

use maud::{Markup, Render, html};

use super::elements::{
    Captions, PageColumn, UNKNOWN, cells, keys, nothing, number, percent, range, scroll, section, with_interval,
};
use crate::analysis::probe_accuracy::{ProbeAccuracyGrouping, ProbeAnswerAccuracy};
use crate::analysis::probe_figures::{ProbeCounts, ProbeSummary, RecordedBeliefComparison};
use crate::charts;
use crate::figures::StudySummary;
use tomcom_core::base::text;
use tomcom_core::measures::detection::CALIBRATED;

/// Section of the report on what participants knew; empty without freeze probes.
pub(super) fn awareness(captions: &mut Captions, figures: &StudySummary) -> Markup {
    let Some(found) = &figures.probes else { return nothing() };
    let content = html! {
        (asked(&found.counts, found.participants))
        (left_out(&found.counts))
        p {
            "Of what could be asked, " b { (percent(found.accuracy.accuracy)) } " was known"
            (interval(found.accuracy.interval)) ". “I don’t know” counts as not known."
            @if let Some(effect) = &found.assistance {
                " With assistance a participant knew " (number(Some(100.0 * effect.difference), 1)) " percentage points more than without"
                (interval(effect.interval)) ", in the mean of "
                (words::count(effect.participants, "participant", "participants")) "; practice is part of this difference, and the test in \
                “Does assistance help?” takes it out."
            }
        }
        "\n"
        (scroll(accuracies(captions, found)))
        h3 { "The estimate against the answers" } "\n"
        (estimate(found))
        div class="figures" {
            (captions.figure(charts::probe_calibration(found), html! {
                "Predicted probability of a false belief and weighted share of wrong answers, in bins between " (CALIBRATED[0]) " and "
                (CALIBRATED[1]) ". A perfect estimate lies on the line." (keys(&[("tom-com", "answers")]))
            }))
        }
        "\n"
        (scroll(scores(captions, found)))
        @if let Some(known) = &found.by_true_beliefs { (by_true_beliefs(known)) }
        @for one in &found.level_2 {
            p { "Asked " (one.group) ": " (percent(one.accuracy)) " of " (one.n) " answers were right" (interval(one.interval)) "." } "\n"
        }
    };
    section("What people knew", content)
}

/// Text ", interval of 95 %: …" after a share; empty without an interval.
fn interval(ends: Option<[f64; 2]>) -> String {
    ends.map_or(String::new(), |ends| format!(" (interval of 95 %: {} %)", range(ends.map(|end| 100.0 * end), 1)))
}

fn asked(counts: &ProbeCounts, participants: u64) -> Markup {
    html! {
        p {
            "The task froze for " (words::count(counts.probes, "probe", "probes")) ", and "
            (words::count(participants, "participant", "participants")) " said what they believed. "
            (counts.counted) " of " (words::count(counts.questions, "question", "questions")) " count, "
            (counts.unsure) " of them answered with “I don’t know”. Each weighs the inverse of the chance with which it was drawn, since \
             the assistant’s estimate had a part in choosing questions for some probes; so the results are about everything that could be asked \
             at these times, not about what was chosen. They tell as much as " (number(Some(counts.effective), 0))
            " questions of equal weight. False beliefs: by answers to probes; they tell no causes of errors."
        }
        "\n"
    }
}

/// Sentence on the probe questions that the main results leave out, and why.
fn left_out(counts: &ProbeCounts) -> Markup {
    let one = |n: u64, what: &str| (n > 0).then(|| format!("{n} {what}"));
    let questions: Vec<String> = [
        one(counts.unanswered, "without an answer in time"),
        one(counts.questions_skipped, "that the wizard skipped"),
        one(counts.by_wizard, "in probes that the wizard asked for"),
        one(counts.level_2, "about what comes next"),
    ]
    .into_iter()
    .flatten()
    .collect();
    html! {
        p class="note" {
            "Left out: " @if questions.is_empty() { "no question" } @else { (questions.join(", ")) } "."
            @if counts.dropped > 0 {
                " " (words::count(counts.dropped, "probe", "probes")) " did not take place, since a signal or another probe was too close."
            }
            @if counts.skipped > 0 { " The wizard cut " (words::count(counts.skipped, "probe", "probes")) " short." }
        }
        "\n"
    }
}

fn accuracies(captions: &mut Captions, found: &ProbeSummary) -> Markup {
    let columns: [PageColumn<ProbeAnswerAccuracy>; 4] = [
        ("", |one| one.group.render()),
        ("answers", |one| one.n.render()),
        ("“I don’t know”", |one| one.unsure.render()),
        ("known, %", |one| {
            let hundred = |value: f64| 100.0 * value;
            with_interval(one.accuracy.map(hundred), one.interval.map(|ends| ends.map(hundred)), 1)
        }),
    ];
    // Results by single state aspect are only in the table of probes and in the JSON summary.
    let printed = found.accuracies.iter().filter(|one| one.by != ProbeAccuracyGrouping::Aspect);
    let caption = "What participants knew: by what was asked, by when the place last changed and whether it was looked at since, by \
                   condition, and by how questions were drawn. Weighted; intervals of 95 % by bootstrap over participants.";
    captions.table_of_columns(caption, &columns, printed)
}

fn estimate(found: &ProbeSummary) -> Markup {
    let detection = &found.detection;
    let bracketed = |ends: Option<[f64; 2]>| ends.map_or(String::new(), |ends| format!(" ({})", range(ends, 2)));
    html! {
        p {
            "How surely the estimate tells what is believed wrong: area under the ROC " b { (number(detection.auc, 2)) }
            (bracketed(found.auc_interval)) ", the mean of places (" (number(detection.auc_locations, 2))
            "; knowing only what changed since the last look gives " (number(detection.auc_baseline, 2)) ") and recipes ("
            (number(detection.auc_recipes, 2)) "); 1 is always, 0.5 is chance. Without weights it would be "
            (number(found.auc_unweighted, 2)) ". Expected calibration error " (number(detection.ece, 3)) (bracketed(found.ece_interval))
            ". A wrong answer is not always a false belief: where few beliefs are false, few slips of the finger lower the area much."
        }
        "\n"
    }
}

fn scores(captions: &mut Captions, found: &ProbeSummary) -> Markup {
    let of = &found.log_scores;
    let row = |what: &str, score: Option<f64>| {
        let gain = score.zip(of.estimate).map(|(score, estimate)| estimate - score);
        cells([&what, &number(score, 3), &number(gain, 3)])
    };
    let rows = [
        row("the estimate", of.estimate),
        row("the estimate, with wrong answers at random", of.estimate_with_slips),
        row("what usually lies there", of.usual),
        row("what was last seen there", of.last_seen),
        row("what is true", of.truth),
    ];
    let caption = format!(
        "How well {} are predicted: mean log of the probability of the answer, in nats; higher is better. How often the simple \
         predictions are right, and the share of answers at random, is learned on the other participants.",
        words::count(of.n, "answer that names a value", "answers that name a value")
    );
    captions.table(caption, &["", "log score", "gain of the estimate"], &rows)
}

fn by_true_beliefs(known: &RecordedBeliefComparison) -> Markup {
    let value = |value: Option<f64>| value.map_or(UNKNOWN.to_string(), |value| number(Some(value), 3));
    html! {
        p class="note" {
            "Of simulated participants it is known what they really believed. At " (known.n) " of these questions the area is "
            (value(known.detection.auc)) " and the calibration error " (value(known.detection.ece)) " by their beliefs, "
            (value(known.by_answers.auc)) " and " (value(known.by_answers.ece)) " by their answers; " (percent(Some(known.agreement)))
            " of the answers agree with the beliefs."
        }
        "\n"
    }
}
