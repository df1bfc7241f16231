//! What is around the results: summary, trials, methods, definitions, files.

use super::{count, number, p_sentence, percent, section, table};
use crate::base::words;
use crate::session::event::EndReason;
use crate::session::settings::Condition;
use crate::study::arm_group::ArmGroup;
use crate::study::column::Table;
use crate::study::definitions::DEFINITIONS;
use crate::study::facts::Facts;
use crate::study::figures::StudySummary;
use crate::study::svg::escaped;
use crate::study::trial::{BeliefBasis, Trial};

/// What it is about, and the main figures.
pub(super) fn summary(figures: &StudySummary) -> String {
    let totals = &figures.totals;
    let mut text = format!(
        "<p class=\"lead\">{} of {}, {} recorded presses.</p>\n",
        words::count(figures.trials, "trial", "trials"),
        words::count(figures.participants, "participant", "participants"),
        totals.actions
    );
    if figures.simulated_participants {
        text += "<p class=\"warning\">Participants are simulated. Their errors, beliefs and presses are those of a program that \
                 is there to try machinery and parameters. Nothing here is evidence about people.</p>\n";
    }
    if totals.beliefs_from == Some(BeliefBasis::Estimate) {
        text += "<p class=\"warning\">What participants believed is known only as the assistant's estimate. Figures that rest on \
                 it, such as the share of belief related errors, need the codes of two raters to be more than that.</p>\n";
    }
    if let Some(found) = &figures.raters {
        text += &format!(
            "<p>Two raters coded why presses were errors. They say the same cause of {} of {} errors (Cohen\u{2019}s kappa {}), and of \
             {} errors that both put down to a belief they say of {} that the same is believed wrong (kappa {}). An error is belief \
             related if both say so.</p>\n",
            found.same_cause,
            found.errors,
            number(found.kappa_cause, 2),
            found.beliefs,
            found.same_aspect,
            number(found.kappa_aspect, 2)
        );
    }
    let card = |value: String, what: &str| format!("<div class=\"card\"><b>{value}</b><span>{what}</span></div>\n");
    text += "<div class=\"cards\">\n";
    text += &card(percent(totals.error_rate), "of the presses of both agents are errors of the human");
    text += &card(percent(totals.belief_related_share), "of the errors come of false beliefs");
    text += &card(number(totals.mean_sequence_length, 1), "errors in a sequence, in the mean");
    text += &match (figures.pearson, &figures.similarity) {
        (Some(pearson), _) => card(
            format!("r\u{a0}=\u{a0}{}", number(Some(pearson.r), 2)),
            &format!("of assistance and fewer errors ({})", p_sentence(Some(pearson.p))),
        ),
        (None, Some(found)) => card(percent(found.strict.recall), "of the wizard's signals have a match"),
        (None, None) => card(words::count(totals.signals, "signal", "signals"), "shown to participants"),
    };
    text + "</div>\n"
}

/// No longer list of trials is printed.
const MOST_TRIALS: usize = 60;

/// Every trial, and those that are left out with the reasons.
pub(super) fn trials(figures: &StudySummary, trials: &[Trial]) -> String {
    let row = |trial: &Trial| {
        vec![
            escaped(&trial.participant),
            trial.group.as_deref().map_or("\u{2013}".to_string(), escaped),
            trial.period.map_or("\u{2013}".to_string(), |period| period.to_string()),
            condition(trial.condition).to_string(),
            trial.ended.map_or("\u{2013}", EndReason::name).to_string(),
            trial.human_presses.to_string(),
            trial.robot_presses.to_string(),
            trial.errors.to_string(),
            percent(trial.error_rate_human()),
            count(trial.beliefs.as_ref().map(|beliefs| beliefs.errors)),
            number(trial.sequence_length(), 1),
            trial.signals.to_string(),
            trial.orders.to_string(),
            number(trial.press_s, 2),
        ]
    };
    let counting: Vec<&Trial> = trials.iter().filter(|trial| trial.counts()).collect();
    let rows: Vec<Vec<String>> = counting.iter().take(MOST_TRIALS).map(|trial| row(trial)).collect();
    let heads = [
        "participant",
        "group",
        "trial",
        "condition",
        "ended by",
        "presses, human",
        "robot",
        "errors",
        "per press of the human",
        "belief related",
        "in a sequence",
        "signals",
        "orders",
        "s a press",
    ];
    let caption = match counting.len() > MOST_TRIALS {
        true => format!(
            "The first {MOST_TRIALS} of {} trials that count; all are in <code>trials.csv</code>.",
            counting.len()
        ),
        false => "Trials that count.".to_string(),
    };
    let mut text = format!("<div class=\"scroll long\">{}</div>\n", table(&caption, &heads, &rows));
    text += "<h3>Left out</h3>\n";
    text += &match figures.left_out.len() {
        0 => "<p>No trial is left out.</p>\n".to_string(),
        _ => {
            let rows: Vec<Vec<String>> = figures
                .left_out
                .iter()
                .map(|one| [&one.recording, &one.participant, &one.reason].map(|text| escaped(text)).to_vec())
                .collect();
            table("Trials that do not count.", &["recording", "participant", "why"], &rows).replacen(
                "<table>",
                "<table class=\"text\">",
                1,
            )
        }
    };
    if figures.practice > 0 {
        let practice = words::count(figures.practice, "recording is", "recordings are");
        text += &format!("<p class=\"note\">{practice} of practice, and no trial.</p>\n");
    }
    section("Trials", &text)
}

/// A condition in words.
pub(super) fn condition(condition: Condition) -> &'static str {
    match condition {
        Condition::None => "unassisted",
        Condition::Wizard => "wizard",
        Condition::Assistant => "assistant",
    }
}

/// How it was done, from what the recordings say.
pub(super) fn methods(figures: &StudySummary, facts: &Facts) -> String {
    let all = |key: &str| facts.all(key).map_or("unknown".to_string(), |text| escaped(&text));
    let planned = facts.all("plan").map_or(" without a plan".to_string(), |plan| {
        format!(
            " after the plan {} (name and digest; groups and orders of conditions follow from its seed)",
            escaped(&plan)
        )
    });
    let orders = facts.all("orders").map_or(String::new(), |orders| format!(" or {} served orders", escaped(&orders)));
    let mut text = format!(
        "<p>{} took part{planned}; {} recorded, {} left out of the analysis. Participants: {}. The task was that of the kitchen \
         \u{201c}{}\u{201d}. A trial was to end after {} presses of both agents or {} s{orders}, whatever came first.{}{} A press \
         of the robot took {}. Gaze came from {}{}. A signal was shown for {}.",
        words::count(figures.participants, "participant", "participants"),
        words::count(figures.trials + figures.left_out.len() as u64, "trial was", "trials were"),
        figures.left_out.len(),
        all("participant"),
        all("kitchen"),
        all("presses"),
        all("seconds"),
        endings(figures),
        arms(figures),
        all("robot"),
        all("gaze"),
        facts.all("accuracy").map_or(String::new(), |deg| format!(" (accuracy in checks: {deg}\u{b0})")),
        all("shown"),
    );
    if facts.has("scripted wizard") {
        text += &format!(
            " The wizard was a script that sees kitchen, presses and gaze, and no estimate: {}.",
            all("scripted wizard")
        );
    }
    if facts.has("wizard saw") {
        text += &format!(" The wizard saw {}", all("wizard saw"));
        text += if facts.has("unblinded") { ", and in some trials what assistants would say." } else { "." };
    }
    text += &format!(
        " The human model's temperature was \u{3c4} = {}, the cost of a signal {} presses. Recorded with tomcom {} (log format {}), \
         seed {}; analysed with tomcom {}.</p>\n",
        all("tau"),
        all("cost"),
        all("program"),
        all("format"),
        all("seed"),
        env!("CARGO_PKG_VERSION"),
    );
    text += &format!(
        "<p>Every recording was replayed event by event; errors, their causes{} were computed anew from the recorded events. \
         {}</p>\n",
        // Where nothing was asked of the concepts, nothing is known of what they would have said.
        match figures.similarity.is_some() || figures.roc.iter().any(|roc| !roc.points.is_empty()) {
            true => ", the estimate of beliefs and what each concept would have said",
            false => " and the estimate of beliefs",
        },
        match figures.totals.beliefs_from {
            Some(BeliefBasis::Recorded) =>
                "Why presses were errors was judged by what the simulated participants recorded of their beliefs.",
            Some(BeliefBasis::Raters) => "Why presses were errors was coded by two raters.",
            Some(BeliefBasis::Estimate) =>
                "Why presses were errors was judged by the assistant's estimate of the beliefs.",
            None => "Why presses were errors is not known for all trials.",
        }
    );
    section("Methods", &text)
}

/// How many trials ended how, in a sentence.
fn endings(figures: &StudySummary) -> String {
    let one = |(reason, &count): (&EndReason, &u64)| {
        let how = match reason {
            EndReason::Presses => "with the presses",
            EndReason::Time => "as the time was over",
            EndReason::Orders => "as the orders were served",
            EndReason::Wizard => "as the wizard ended it before",
            EndReason::Aborted => "aborted",
        };
        format!("{count} {how}")
    };
    let ended: Vec<String> = figures.ended.iter().map(one).collect();
    let shorter = match figures.ended.keys().all(|reason| *reason == EndReason::Presses) {
        true => "",
        false => " Each counts as one trial, however long it was.",
    };
    match ended.is_empty() {
        true => String::new(),
        false => format!(" Of the trials that count ended {}.{shorter}", ended.join(", ")),
    }
}

/// With which arms, in a sentence.
fn arms(figures: &StudySummary) -> String {
    let trials = |group: &ArmGroup| {
        format!("{} in {}", super::robot::arm(group.kind), words::count(group.trials, "trial", "trials"))
    };
    match &figures.robot[..] {
        [] => String::new(),
        [one] => format!(" The robot\u{2019}s arm was {}.", super::robot::arm(one.kind)),
        both => {
            let both: Vec<String> = both.iter().map(trials).collect();
            format!(" The robot\u{2019}s arm was {}; the figures pool them.", both.join(" and "))
        }
    }
}

/// What every term means.
pub(super) fn definitions() -> String {
    let one = |(term, text): &(&str, &str)| format!("<dt>{}</dt>\n<dd>{}</dd>\n", escaped(term), escaped(text));
    section("Definitions", &format!("<dl>\n{}</dl>\n", DEFINITIONS.iter().map(one).collect::<String>()))
}

/// The files beside the report that have something in them.
pub(super) fn files(tables: &[Table]) -> String {
    let names: Vec<String> = tables.iter().map(|table| format!("<code>{}.csv</code>", table.name())).collect();
    let text = format!(
        "<p>Beside this page: {}. The last one says what every column of the others means. Empty cells are unknown values; a \
         recording's name joins the tables.</p>\n",
        names.join(", ")
    );
    section("Tables", &text)
}
