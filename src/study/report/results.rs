//! Sections of the study report: results beside those of the paper, the wizard, the robot, people, situation awareness.

use maud::{Markup, Render, html};

use crate::analysis::offer_summary::{OfferDurations, OfferSummary};
use crate::analysis::probe_figures::{
    ProbeAccuracyGrouping, ProbeAnswerAccuracy, ProbeCounts, ProbeSummary, RecordedBeliefComparison,
    SituationAwarenessEffect,
};
use crate::charts;
use crate::effect::AssistanceEffect;
use crate::figures::StudySummary;
use crate::headline::directed;
use crate::report::elements::{
    Captions, PageColumn, arm, cells, count, fixed, in_percent, keys, known, nothing, number, p_value, percent, range,
    told, unknown, with_interval,
};
use crate::robot_tally::{ArmSafetySummary, RobotArmTotals};
use crate::why;
use tomcom_core::base::text;
use tomcom_core::communication::offer::OfferCloseReason;
use tomcom_core::measures::detection::CALIBRATED;
use tomcom_core::measures::matching::MatchShares;
use tomcom_core::measures::raters::BeliefSource;
use tomcom_core::measures::wizard_performance::WizardMeasures;
use tomcom_core::robot::AbortReason;
use tomcom_session::plan::QuestionnaireItemKind;
use tomcom_session::study_arm::StudyArm;

pub(super) fn beside_the_paper(captions: &mut Captions, figures: &StudySummary) -> Markup {
    let totals = &figures.totals;
    let row = |what: &str, here: Markup, paper: &str| cells([&what, &here, &paper]);
    let own_row = |what: &str, here: Markup| cells([&what, &here, &unknown("the paper does not say")]);
    let (no_rate, no_length) = (totals.why_no_rate(), totals.why_no_length());
    let per_trial = (figures.trials > 0).then(|| totals.actions as f64 / figures.trials as f64);
    let matched = figures.similarity.as_ref().and_then(|found| found.signal.recall);
    let mut rows = vec![
        row("participants", figures.participants.render(), "14"),
        row("trials", figures.trials.render(), "28"),
        row("presses of both agents", totals.actions.render(), "8515"),
        row("presses per trial", number(per_trial, 0, "no trial"), "304"),
        row("errors of the human", totals.errors.render(), "587"),
        own_row("presses of the human judged by unproven costs to go", totals.unproven.render()),
        row("errors per press of both", percent(totals.error_rate, why::NO_PRESS), "6.9 %"),
        row("errors per press of the human", percent(totals.error_rate_human, why::NO_PRESS), "about 11 to 13 %"),
        row("belief related errors", count(totals.belief_related_errors, no_rate), "481"),
        own_row("of these about orders, recipes, either, places", kinds(figures)),
        row(
            "share of the errors that are belief related",
            percent(totals.belief_related_share, totals.why_no_share()),
            "82 %",
        ),
        row("sequences of related errors", count(totals.sequences, no_rate), "153"),
        row("mean errors per sequence", number(totals.mean_sequence_length, 2, no_length), "3.1"),
        own_row("error sequences, whatever the aspect", count(totals.sequences_any_aspect, no_rate)),
        own_row(
            "mean errors per sequence, whatever the aspect",
            number(totals.mean_sequence_length_any_aspect, 2, no_length),
        ),
        own_row("mean seconds to recover from a sequence", number(totals.mean_recovery_s, 1, totals.why_no_recovery())),
    ];
    // A study without the test, such as one with more than two conditions, has no result to compare with the paper's.
    if let Some(test) = figures.anova {
        let no_test = figures.effects.first().map_or("", AssistanceEffect::why_no_test);
        rows.extend([
            row("assistance: participants with both trials", test.n.render(), "14"),
            row("assistance: p of the mixed ANOVA", p_value(Some(test.p), no_test), "0.014"),
            row("assistance: Pearson r", number(figures.pearson.map(|found| found.r), 2, no_test), "0.64"),
            row("assistance: p of r", p_value(figures.pearson.map(|found| found.p), no_test), "0.014"),
        ]);
    }
    if matched.is_some() {
        rows.push(row("wizard signals matched by ToM-Com", percent(matched, why::NO_SIGNAL), "74 %"));
    }
    let caption =
        "All trials together. Paper: Buehler, Adamy and Weisswange (2021); its 6.9 % is per press of both agents.";
    let table = captions.table(caption, &["", "here", "paper"], &rows);
    captions.section("Comparison with the paper", table)
}

fn kinds(figures: &StudySummary) -> Markup {
    known(figures.totals.belief_related_by_kind, figures.totals.why_no_rate(), |kinds| {
        format!("{}, {}, {}, {}", kinds.orders, kinds.recipes, kinds.order_or_recipe, kinds.places)
    })
}

pub(super) fn similarity(captions: &mut Captions, figures: &StudySummary) -> Markup {
    let content = html! {
        (matches(captions, figures))
        @if let Some(wizard) = &figures.wizard {
            @if figures.similarity.is_some() { h3 { "The wizard" } "\n" }
            (captions.table(performance(figures), &["", "over all trials"], &wizard_rows(wizard)))
        }
        @if let Some(found) = &figures.offers { (offers(found)) }
    };
    captions.section("Wizard and assistant", content)
}

fn performance(figures: &StudySummary) -> String {
    let unknown = "; false beliefs that led to no error are not known";
    match figures.wizard_beliefs_from {
        None => "Performance of the wizard.".to_string(),
        Some(BeliefSource::Recorded) => format!("Performance of the wizard, by {}.", BeliefSource::Recorded.words()),
        Some(basis) => format!("Performance of the wizard, by {}{unknown}.", basis.words()),
    }
}

fn offers(found: &OfferSummary) -> Markup {
    let times = |one: &OfferDurations| match (one.median_s, one.shortest_s) {
        (Some(median_s), Some(shortest_s)) => format!("{median_s:.1} s in the median, {shortest_s:.1} s at least"),
        _ => "for a time that is not known, since all were cut".to_string(),
    };
    let by_reason = |(reason, one): (&OfferCloseReason, &OfferDurations)| format!("{} {}", one.n, reason.words());
    let reasons: Vec<String> = found.by_reason.iter().map(by_reason).collect();
    let reaction = found.reaction_s.map(|s| format!(", {s:.1} s after its opening in the median"));
    html! {
        p {
            "The wizard saw " (text::count(found.all.n, "offer", "offers")) ", which stood " (times(&found.all)) " (" (reasons.join(", ")) "). "
            "The signal of " (found.taken + found.by_own_key) " was sent" (reaction.unwrap_or_default()) ": of "
            (found.taken) " by the key of the offer, of " (found.by_own_key) " by the key of the signal. The table "
            code { "offers" } " has each of them."
        }
        "\n"
    }
}

/// Table of the similarity between wizard and assistant; empty without signals.
fn matches(captions: &mut Captions, figures: &StudySummary) -> Markup {
    let Some(found) = &figures.similarity else { return nothing() };
    let share = |what: &str, level: &MatchShares| {
        let (recall, precision) = (number(level.recall, 2, why::NO_SIGNAL), number(level.precision, 2, why::NO_SIGNAL));
        let (chance, f1) = (number(level.chance_recall, 2, why::NO_SHIFT), number(level.f1, 2, why::NO_MATCH));
        cells([&what, &recall, &chance, &precision, &f1])
    };
    let rows = [
        share("same signal and target", &found.signal),
        share("same kind of signal", &found.kind),
        share("any signal at about the same time", &found.any),
    ];
    let caption = "Agreement between the wizard\u{2019}s signals and the hypothetical signals of ToM-Com. The paper counts a match \
                   where \u{201c}a similar decision\u{201d} is taken \u{201c}in nearby time steps\u{201d} and does not define it further, \
                   so its 74 % may be any of the three levels.";
    let heads = ["within 3 presses of the human", "recall", "by chance", "precision", "F1"];
    html! {
        (captions.table(caption, &heads, &rows))
        p {
            "The wizard sent " (found.of_n) " signals, ToM-Com would have sent " (found.with_n) "; " (found.matched) " match. Kappa per press: "
            (told(found.kappa, 2, why::NO_KAPPA)) "."
            @if let Some((lead_s, _, earlier)) = found.median_lead_s.map(|lead_s| directed(lead_s, [0.0; 2], ["earlier", "later"])) {
                " ToM-Com is " (fixed(lead_s, 1)) " s " (earlier) " in the median."
            }
            " "
            span class="note" { "Paper: 74 % of the wizard\u{2019}s communications matched." }
        }
        "\n"
        @if let Some(seen) = &figures.similarity_with_advice {
            p {
                "Not part of this table: trials in which the wizard saw the assistant\u{2019}s recommendations. There "
                (seen.matched) " of " (seen.of_n) " signals match (recall " (told(seen.signal.recall, 2, why::NO_SIGNAL)) ", by chance "
                (told(seen.signal.chance_recall, 2, why::NO_SHIFT)) "; same kind " (told(seen.kind.recall, 2, why::NO_SIGNAL))
                ", any signal " (told(seen.any.recall, 2, why::NO_SIGNAL)) ")."
            }
            "\n"
        }
        @if let Some(wizard) = &figures.wizard { (limits(figures, wizard)) }
    }
}

/// Sentence on wizard signals that cannot have a match; only for participants with recorded beliefs.
fn limits(figures: &StudySummary, wizard: &WizardMeasures) -> Markup {
    let (Some(late), Some(wrong), Some(needless)) = (wizard.late, wizard.wrong_targets, wizard.needless) else {
        return nothing();
    };
    let who = if figures.simulated_participants { "scripted wizard" } else { "wizard" };
    html! {
        p {
            "Limits of the match: " (late + wrong + needless) " of " (wizard.signals) " signals of the " (who) " were about a \
            correctly believed aspect, for which ToM-Com sends no signal. ToM-Com also sends none if the false belief will \
            probably cost fewer presses than a signal. A signal of ToM-Com more than 3 presses earlier does not match either."
        }
        "\n"
    }
}

/// What is not known of these participants has no row.
fn wizard_rows(wizard: &WizardMeasures) -> Vec<Vec<Markup>> {
    let counts = [
        ("signals sent", Some(wizard.signals)),
        ("signals taken back", Some(wizard.taken_back)),
        ("false beliefs that led to errors", wizard.episodes),
        ("of these hit by a signal", wizard.hits),
        ("of these missed", wizard.omissions),
        ("repeated: about a false belief that was hit already", wizard.repeated),
        ("late: about a false belief that was corrected just before", wizard.late),
        ("wrong: about a right belief while another was false", wizard.wrong_targets),
        ("needless: while no belief was false", wizard.needless),
        ("harmless: about a false belief that led to no error", wizard.harmless),
    ];
    let known = counts.into_iter().filter_map(|(what, value)| Some(cells([&what, &value?])));
    let latency = wizard.latency_s.map(|times| {
        cells([&"median seconds from the start of a false belief to its signal", &fixed(times.median, 1)])
    });
    known.chain(latency).collect()
}

pub(super) fn people(captions: &mut Captions, figures: &StudySummary) -> Markup {
    let content = html! {
        @if let Some(found) = &figures.acceptance {
            p {
                "Acceptance of the signals: " (found.high) " high, " (found.medium) " medium, " (found.undecided) " undecided, "
                (found.low) " low, " (found.not_reported) " not reported; mean " (told(found.mean, 2, why::NO_ANSWER)) " (0: none, 1: full). "
                span class="note" { "Paper: 7 high, 3 medium, 3 undecided, 1 not reported." }
            }
            "\n"
        }
        @if !figures.questionnaire_scores.is_empty() { (scores(captions, figures)) }
        @if !figures.questionnaires.is_empty() { (items(captions, figures)) }
        @if let Some(found) = &figures.tutorial {
            p {
                "Check of understanding in the tutorial: " (found.right_at_once) " of " (found.questions)
                " questions answered rightly at once, by " (text::count(found.participants, "participant", "participants")) "."
            }
            "\n"
        }
    };
    captions.section("Questionnaires", content)
}

fn asked_after(after: Option<StudyArm>) -> String {
    after.map_or_else(|| "before the trials".to_string(), |after| after.title().to_string())
}

/// Answers in words are only counted, since they can identify their author.
fn items(captions: &mut Captions, figures: &StudySummary) -> Markup {
    let rows = figures.questionnaires.iter().map(|item| {
        let mean = match (item.points, item.asked.kind) {
            (Some(points), _) => known(item.mean, why::NO_ANSWER, |mean| format!("{} of {points}", fixed(mean, 1))),
            (None, QuestionnaireItemKind::Choice | QuestionnaireItemKind::Text) => nothing(),
            (None, _) => number(item.mean, 1, why::NO_ANSWER),
        };
        let counts = item.counts.iter().map(u64::to_string);
        let counts: Vec<String> = match item.asked.kind {
            QuestionnaireItemKind::Choice => {
                item.options.iter().zip(counts).map(|(text, count)| format!("{text}: {count}")).collect()
            }
            _ => counts.collect(),
        };
        let between = if item.asked.kind == QuestionnaireItemKind::Choice { ", " } else { " " };
        let after = asked_after(item.condition);
        cells([&item.asked.text, &after, &item.answers, &item.left_out, &mean, &counts.join(between)])
    });
    let heads = ["item", "after", "answers", "skipped", "mean", "number of answers 1, 2, \u{2026}, or by option"];
    captions.table(
        html! {
            "Answers by item and condition. Words stand only in the table " code { "questionnaires.csv" } ", those of the debriefing, which \
             are notes, only in the recordings (" code { "tomcom replay RECORDING" } ")."
        },
        &heads,
        &rows.collect::<Vec<_>>(),
    )
}

fn scores(captions: &mut Captions, figures: &StudySummary) -> Markup {
    let rows = figures.questionnaire_scores.iter().map(|one| {
        let after = asked_after(one.condition);
        cells([
            &one.questionnaire,
            &after,
            &one.scores.len(),
            &number(one.mean, 1, why::NO_ANSWER),
            &number(one.sd, 1, why::ONE_ANSWER),
        ])
    });
    let heads = ["questionnaire", "after", "answered in full", "mean score", "standard deviation"];
    captions.table("Scores by questionnaire and condition.", &heads, &rows.collect::<Vec<_>>())
}

pub(super) fn robot(captions: &mut Captions, figures: &StudySummary) -> Markup {
    let groups = &figures.robot;
    if groups.is_empty() {
        return nothing();
    }
    let row = |what: &str, of: &dyn Fn(&RobotArmTotals) -> Markup| -> Vec<Markup> {
        std::iter::once(what.render()).chain(groups.iter().map(of)).collect()
    };
    let felt = |what: &str, of: fn(&ArmSafetySummary) -> u64| {
        row(what, &|group| count(group.robot.arm.as_ref().map(of), why::TIMED_ARM))
    };
    let seconds = |what: &str, of: fn(&ArmSafetySummary) -> Option<f64>| {
        let why = |group: &RobotArmTotals| if group.robot.arm.is_none() { why::TIMED_ARM } else { "no contact" };
        row(what, &|group| number(group.robot.arm.as_ref().and_then(of), 1, why(group)))
    };
    let did = |what: &str, of: fn(&RobotArmTotals) -> u64| row(what, &|group| of(group).render());
    let mut rows = vec![
        felt("protective stops after a contact", |arm| arm.protective_stops),
        felt("stops because a joint did not follow", |arm| arm.faults),
        felt("contacts with a person", |arm| arm.contacts),
        seconds("largest contact force in N", |arm| arm.peak_force_n),
        seconds("seconds at reduced speed because of a hand nearby", |arm| Some(arm.reduced_s)),
        seconds("seconds of waiting for a hand (safeguard stop)", |arm| Some(arm.safeguard_s)),
        did("emergency stops by the wizard", |group| group.robot.emergency_stops),
    ];
    let occurs = |reason: &AbortReason| groups.iter().any(|group| group.robot.given_up.contains_key(reason));
    rows.extend(AbortReason::ALL.into_iter().filter(occurs).map(|reason| {
        let what = format!("aborted presses: {}", reason.words());
        row(&what, &|group| count(group.robot.given_up(reason), why::TIMED_ARM))
    }));
    rows.extend([
        did("times held by the wizard", |group| group.robot.held),
        did("presses skipped by the wizard", |group| group.robot.skipped),
        did("presses chosen by the wizard", |group| group.robot.driven),
        did("locations corrected by the wizard", |group| group.robot.corrected),
    ]);
    let head =
        |group: &RobotArmTotals| format!("{}, {}", arm(group.kind), text::count(group.trials, "trial", "trials"));
    let heads: Vec<String> = std::iter::once("arm".to_string()).chain(groups.iter().map(head)).collect();
    let caption = html! {
        "Sums over trials, pauses included, by arm. Values of each trial are in "
        code { "trials.csv" } "."
    };
    let table = captions.table(caption, &heads, &rows);
    captions.section("The robot", table)
}

pub(super) fn awareness(captions: &mut Captions, figures: &StudySummary) -> Markup {
    let Some(found) = &figures.probes else { return nothing() };
    let content = html! {
        (asked(&found.counts, found.participants))
        (left_out(&found.counts))
        p {
            "Of what could be asked, " b { (found.accuracy.accuracy.map_or("nothing that is known".to_string(), in_percent)) } " was known"
            (interval(found.accuracy.interval)) ". “I don’t know” counts as not known."
            @if let Some(effect) = &found.assistance {
                " With assistance a participant knew " (with_assistance(effect)) ", in the mean of "
                (text::count(effect.participants, "participant", "participants")) "; practice is part of this difference, and the test in \
                “Does assistance help?” takes it out."
            }
        }
        "\n"
        (accuracies(captions, found))
        h3 { "The estimate against the answers" } "\n"
        (estimate(found))
        div class="figures" {
            (captions.figure(charts::probe_calibration(found), html! {
                "Predicted probability of a false belief and weighted share of wrong answers, in bins between " (CALIBRATED[0]) " and "
                (CALIBRATED[1]) ". A perfect estimate lies on the line." (keys(&[("tom-com", "answers")]))
            }))
        }
        "\n"
        (probe_scores(captions, found))
        @if let Some(known) = &found.by_true_beliefs { (by_true_beliefs(known)) }
        @for one in &found.level_2 {
            p { "Asked " (one.group) ": " (one.accuracy.map_or("none".to_string(), in_percent)) " of " (one.n) " answers were right" (interval(one.interval)) "." } "\n"
        }
    };
    captions.section("What people knew", content)
}

/// "3.2 percentage points more than without", with the interval in the same direction.
fn with_assistance(effect: &SituationAwarenessEffect) -> String {
    let ends = effect.interval.unwrap_or([f64::NAN; 2]);
    let (difference, ends, more) = directed(effect.difference, ends, ["more", "less"]);
    let points = fixed(100.0 * difference, 1);
    format!("{points} percentage points {more} than without{}", interval(effect.interval.map(|_| ends)))
}

/// Text ", interval of 95 %: …" after a share; empty without an interval.
fn interval(ends: Option<[f64; 2]>) -> String {
    ends.map_or(String::new(), |ends| format!(" (interval of 95 %: {} %)", range(ends.map(|end| 100.0 * end), 1)))
}

fn asked(counts: &ProbeCounts, participants: u64) -> Markup {
    html! {
        p {
            "The task froze for " (text::count(counts.probes, "probe", "probes")) ", and "
            (text::count(participants, "participant", "participants")) " said what they believed. "
            (counts.counted) " of " (text::count(counts.questions, "question", "questions")) " count, "
            (counts.unsure) " of them answered with “I don’t know”. Each weighs the inverse of the chance with which it was drawn, since \
             the assistant’s estimate had a part in choosing questions for some probes; so the results are about everything that could be asked \
             at these times, not about what was chosen. They tell as much as " (fixed(counts.effective, 0))
            " questions of equal weight. False beliefs: by answers to probes; they tell no causes of errors."
        }
        "\n"
    }
}

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
                " " (text::count(counts.dropped, "probe", "probes")) " did not take place, since a signal or another probe was too close."
            }
            @if counts.skipped > 0 { " The wizard cut " (text::count(counts.skipped, "probe", "probes")) " short." }
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
            with_interval(one.accuracy.map(hundred), one.interval.map(|ends| ends.map(hundred)), 1, why::NO_ANSWER)
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
            "How surely the estimate tells what is believed wrong: area under the ROC " b { (told(detection.auc, 2, why::ONE_KIND)) }
            (bracketed(found.auc_interval)) ", the mean of places (" (told(detection.auc_locations, 2, why::ONE_KIND))
            "; knowing only what changed since the last look gives " (told(detection.auc_baseline, 2, why::ONE_KIND)) ") and recipes ("
            (told(detection.auc_recipes, 2, why::ONE_KIND)) "); 1 is always, 0.5 is chance. Without weights it would be "
            (told(found.auc_unweighted, 2, why::ONE_KIND)) ". Expected calibration error " (told(detection.ece, 3, why::UNCALIBRATED))
            (bracketed(found.ece_interval))
            ". A wrong answer is not always a false belief: where few beliefs are false, few slips of the finger lower the area much."
        }
        "\n"
    }
}

fn probe_scores(captions: &mut Captions, found: &ProbeSummary) -> Markup {
    let of = &found.log_scores;
    let row = |what: &str, score: Option<f64>| {
        let gain = score.zip(of.estimate).map(|(score, estimate)| estimate - score);
        cells([&what, &number(score, 3, why::NO_VALUE), &number(gain, 3, why::NO_VALUE)])
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
        text::count(of.n, "answer that names a value", "answers that name a value")
    );
    captions.table(caption, &["", "log score", "gain of the estimate"], &rows)
}

fn by_true_beliefs(known: &RecordedBeliefComparison) -> Markup {
    let area = |value: Option<f64>| told(value, 3, why::ONE_KIND);
    let error = |value: Option<f64>| told(value, 3, why::UNCALIBRATED);
    html! {
        p class="note" {
            "Of simulated participants it is known what they really believed. At " (known.n) " of these questions the area is "
            (area(known.detection.auc)) " and the calibration error " (error(known.detection.ece)) " by their beliefs, "
            (area(known.by_answers.auc)) " and " (error(known.by_answers.ece)) " by their answers; " (in_percent(known.agreement))
            " of the answers agree with the beliefs."
        }
        "\n"
    }
}
