//! Section of the study report that shows the results beside those of the paper.

use maud::{Markup, html};

use super::elements::{Captions, UNKNOWN, cells, count, nothing, number, p_value, percent, scroll, section};
use crate::analysis::offer_summary::{OfferDurations, OfferSummary};
use crate::figures::StudySummary;
use tomcom_core::base::text;
use tomcom_core::communication::offer::OfferCloseReason;
use tomcom_core::measures::raters::BeliefSource;
use tomcom_core::measures::matching::MatchShares;
use tomcom_core::measures::wizard_performance::WizardMeasures;
use tomcom_session::plan::QuestionnaireItemKind;
use tomcom_session::study_arm::StudyArm;

/// Table with this study's results beside the results of the paper.
pub(super) fn beside_the_paper(captions: &mut Captions, figures: &StudySummary) -> Markup {
    let totals = &figures.totals;
    let row = |what: &str, here: String, paper: &str| cells([&what, &here, &paper]);
    let per_trial = (figures.trials > 0).then(|| totals.actions as f64 / figures.trials as f64);
    let matched = figures.similarity.as_ref().and_then(|found| found.signal.recall);
    let mut rows = vec![
        row("participants", figures.participants.to_string(), "14"),
        row("trials", figures.trials.to_string(), "28"),
        row("presses of both agents", totals.actions.to_string(), "8515"),
        row("presses per trial", number(per_trial, 0), "304"),
        row("errors of the human", totals.errors.to_string(), "587"),
        row("presses of the human judged by unproven costs to go", totals.unproven.to_string(), UNKNOWN),
        row("errors per press of both", percent(totals.error_rate), "6.9 %"),
        row("errors per press of the human", percent(totals.error_rate_human), "about 11 to 13 %"),
        row("belief related errors", count(totals.belief_related_errors), "481"),
        row("of these about orders, recipes, either, places", kinds(figures), UNKNOWN),
        row("share of the errors that are belief related", percent(totals.belief_related_share), "82 %"),
        row("sequences of related errors", count(totals.sequences), "153"),
        row("mean errors per sequence", number(totals.mean_sequence_length, 2), "3.1"),
        row("error sequences, whatever the aspect", count(totals.sequences_any_aspect), UNKNOWN),
        row(
            "mean errors per sequence, whatever the aspect",
            number(totals.mean_sequence_length_any_aspect, 2),
            UNKNOWN,
        ),
        row("mean seconds to recover from a sequence", number(totals.mean_recovery_s, 1), UNKNOWN),
    ];
    // A study without the test, such as one with more than two conditions, has no result to compare with the paper's.
    if let Some(test) = figures.anova {
        rows.extend([
            row("assistance: participants with both trials", test.n.to_string(), "14"),
            row("assistance: p of the mixed ANOVA", p_value(Some(test.p)), "0.014"),
            row("assistance: Pearson r", number(figures.pearson.map(|found| found.r), 2), "0.64"),
            row("assistance: p of r", p_value(figures.pearson.map(|found| found.p)), "0.014"),
        ]);
    }
    if matched.is_some() {
        rows.push(row("wizard signals matched by ToM-Com", percent(matched), "74 %"));
    }
    let caption =
        "All trials together. Paper: Buehler, Adamy and Weisswange (2021); its 6.9 % is per press of both agents.";
    section("Comparison with the paper", captions.table(caption, &["", "here", "paper"], &rows))
}

/// Shares of errors from false beliefs about orders, recipes, an order or its recipe, and other locations, as text.
fn kinds(figures: &StudySummary) -> String {
    let found = figures.totals.belief_related_by_kind;
    found.map_or(UNKNOWN.to_string(), |kinds| {
        format!("{}, {}, {}, {}", kinds.orders, kinds.recipes, kinds.order_or_recipe, kinds.places)
    })
}

/// Section of the report on the similarity of wizard and assistant.
pub(super) fn similarity(captions: &mut Captions, figures: &StudySummary) -> Markup {
    let content = html! {
        (matches(captions, figures))
        @if let Some(wizard) = &figures.wizard {
            h3 { "The wizard" } "\n"
            (captions.table(performance(figures), &["", "over all trials"], &wizard_rows(wizard)))
        }
        @if let Some(found) = &figures.offers { (offers(found)) }
    };
    section("Wizard and assistant", content)
}

/// Caption of the table of the wizard's performance, which names the source of the false beliefs.
fn performance(figures: &StudySummary) -> String {
    let unknown = "; false beliefs that led to no error are not known";
    match figures.wizard_beliefs_from {
        None => "Performance of the wizard.".to_string(),
        Some(BeliefSource::Recorded) => format!("Performance of the wizard, by {}.", BeliefSource::Recorded.words()),
        Some(basis) => format!("Performance of the wizard, by {}{unknown}.", basis.words()),
    }
}

/// Sentences on the offers to the wizard, and on how many of the offers the wizard used.
fn offers(found: &OfferSummary) -> Markup {
    let times = |one: &OfferDurations| match (one.median_s, one.shortest_s) {
        (Some(median_s), Some(shortest_s)) => format!("{median_s:.1} s in the median, {shortest_s:.1} s at least"),
        _ => UNKNOWN.to_string(),
    };
    let by_reason = |(reason, one): (&OfferCloseReason, &OfferDurations)| format!("{} {}", one.n, reason.words());
    let reasons: Vec<String> = found.by_reason.iter().map(by_reason).collect();
    let reaction = found.reaction_s.map(|s| format!(", {s:.1} s after its opening in the median"));
    html! {
        p {
            "The wizard saw " (words::count(found.all.n, "offer", "offers")) ", which stood " (times(&found.all)) " (" (reasons.join(", ")) "). "
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
        let shares = [level.recall, level.chance_recall, level.precision, level.f1].map(|value| number(value, 2));
        let [recall, chance, precision, f1] = &shares;
        cells([&what, recall, chance, precision, f1])
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
            "The wizard sent " (found.of_n) " signals, ToM-Com would have sent " (found.with_n) "; " (found.matched) " match. Kappa "
            (number(found.kappa, 2)) " per press; ToM-Com is earlier by " (number(found.median_lead_s, 1)) " s in the median \
            (negative: later). "
            span class="note" { "Paper: 74 % of the wizard\u{2019}s communications matched." }
        }
        "\n"
        @if let Some(seen) = &figures.similarity_with_advice {
            p {
                "Not part of this table: trials in which the wizard saw the assistant\u{2019}s recommendations. There "
                (seen.matched) " of " (seen.of_n) " signals match (recall " (number(seen.signal.recall, 2)) ", by chance "
                (number(seen.signal.chance_recall, 2)) "; same kind " (number(seen.kind.recall, 2)) ", any signal "
                (number(seen.any.recall, 2)) ")."
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

fn wizard_rows(wizard: &WizardMeasures) -> [Vec<Markup>; 11] {
    let row = |what: &str, value: Option<u64>| cells([&what, &count(value)]);
    [
        row("signals sent", Some(wizard.signals)),
        row("signals revoked", Some(wizard.taken_back)),
        row("false beliefs that led to errors", wizard.episodes),
        row("false beliefs that led to errors, with a signal (hits)", wizard.hits),
        row("false beliefs that led to errors, without a signal (omissions)", wizard.omissions),
        row("repeated signals about the same false belief", wizard.repeated),
        row("late signals, after the belief was corrected", wizard.late),
        row("signals about a wrong target", wizard.wrong_targets),
        row("signals without any false belief", wizard.needless),
        row("signals about a false belief that led to no error", wizard.harmless),
        cells([
            &"median seconds from the start of a false belief to its signal",
            &number(wizard.latency_s.map(|times| times.median), 1),
        ]),
    ]
}

/// Section of the report on the participants' answers to questionnaires.
pub(super) fn people(captions: &mut Captions, figures: &StudySummary) -> Markup {
    let content = html! {
        @if let Some(found) = &figures.acceptance {
            p {
                "Acceptance of the signals: " (found.high) " high, " (found.medium) " medium, " (found.undecided) " undecided, "
                (found.low) " low, " (found.not_reported) " not reported; mean " (number(found.mean, 2)) " (0: none, 1: full). "
                span class="note" { "Paper: 7 high, 3 medium, 3 undecided, 1 not reported." }
            }
            "\n"
        }
        @if !figures.questionnaire_scores.is_empty() { (scroll(scores(captions, figures))) }
        @if !figures.questionnaires.is_empty() { (scroll(items(captions, figures))) }
        @if let Some(found) = &figures.tutorial {
            p {
                "Check of understanding in the tutorial: " (found.right_at_once) " of " (found.questions)
                " questions answered rightly at once, by " (words::count(found.participants, "participant", "participants")) "."
            }
            "\n"
        }
    };
    section("Questionnaires", content)
}

/// Words for when answers were given: after trials of a condition, or before the trials.
fn asked_after(after: Option<StudyArm>) -> String {
    after.map_or_else(|| "before the trials".to_string(), |after| after.title().to_string())
}

/// Table of answers by questionnaire item. Answers in words are only counted, since they can identify their author; the
/// CSV table has these answers.
fn items(captions: &mut Captions, figures: &StudySummary) -> Markup {
    let rows = figures.questionnaires.iter().map(|item| {
        let mean = match (item.points, item.kind) {
            (Some(points), _) => format!("{} of {points}", number(item.mean, 1)),
            (None, QuestionnaireItemKind::Choice | QuestionnaireItemKind::Text) => String::new(),
            (None, _) => number(item.mean, 1).to_string(),
        };
        let counts = item.counts.iter().map(u64::to_string);
        let counts: Vec<String> = match item.kind {
            QuestionnaireItemKind::Choice => {
                item.options.iter().zip(counts).map(|(text, count)| format!("{text}: {count}")).collect()
            }
            _ => counts.collect(),
        };
        let between = if item.kind == QuestionnaireItemKind::Choice { ", " } else { " " };
        let after = asked_after(item.condition);
        cells([&item.text, &after, &item.answers, &item.left_out, &mean, &counts.join(between)])
    });
    let heads = ["item", "after", "answers", "skipped", "mean", "number of answers 1, 2, \u{2026}, or by option"];
    captions.table(
        "Answers by item and condition. Words stand only in the table questionnaires.csv.",
        &heads,
        &rows.collect::<Vec<_>>(),
    )
}

/// Table of scores by questionnaire and by condition.
fn scores(captions: &mut Captions, figures: &StudySummary) -> Markup {
    let rows = figures.questionnaire_scores.iter().map(|one| {
        let after = asked_after(one.condition);
        cells([&one.questionnaire, &after, &one.scores.len(), &number(one.mean, 1), &number(one.sd, 1)])
    });
    let heads = ["questionnaire", "after", "answered in full", "mean score", "standard deviation"];
    captions.table("Scores by questionnaire and condition.", &heads, &rows.collect::<Vec<_>>())
}
