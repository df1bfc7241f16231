//! Section of the study report on methods, from settings and circumstances in the recordings.

use maud::{Markup, html};

use crate::facts::RecordingFacts;
use crate::figures::StudySummary;
use crate::headline::sources;
use crate::report::elements::{Captions, arm};
use crate::robot_tally::RobotArmTotals;
use tomcom_core::base::text;
use tomcom_core::measures::raters::BeliefSource;
use tomcom_session::event::TrialEndReason;

pub(super) fn methods(captions: &mut Captions, figures: &StudySummary, facts: &RecordingFacts) -> Markup {
    let content = html! {
        p { (conduct(figures, facts)) (wizard(facts)) (versions(figures, facts)) } "\n"
        p {
            (analysis(figures))
            @if let Some(found) = &figures.preregistration { " SHA-256 of the frozen plan: " code { (found.digest) } "." }
        }
        "\n"
        @if let Some(traits) = facts.all("traits") {
            details class="note" {
                summary { "Traits of simulated participants" }
                "Medians; spread: standard deviation of the logarithm, of the logit for a probability: " (traits) "."
            }
            "\n"
        }
    };
    captions.section("Methods", content)
}

fn all(facts: &RecordingFacts, key: &str) -> String {
    facts.all(key).unwrap_or_else(|| "unknown".to_string())
}

fn conduct(figures: &StudySummary, facts: &RecordingFacts) -> String {
    let planned = facts.all("plan").map_or(" without a plan".to_string(), |plan| {
        format!(" after the plan {plan} (name and digest; its seed determines groups and orders of conditions)")
    });
    let orders = facts.all("orders").map_or(String::new(), |orders| format!(" or {orders} served orders"));
    let accuracy = facts.all("accuracy").map_or(String::new(), |deg| format!(" (accuracy in checks: {deg}\u{b0})"));
    let all = |key| all(facts, key);
    format!(
        "{} took part{planned}; {} recorded, {} left out of the analysis. Participants: {}. The task was that of the kitchen \
         \u{201c}{}\u{201d}. A trial was to end after {} presses of both agents or {} s{orders}, whichever came first.{}{} A press \
         of the robot took {}; it took the initiative when the participant had not pressed for {}. Gaze came from {}{accuracy}. A signal was shown for {}. Signals could show recipes, and highlight {}.",
        text::count(figures.participants, "participant", "participants"),
        text::count(figures.trials + figures.left_out.len() as u64, "trial was", "trials were"),
        figures.left_out.len(),
        all("participant"),
        all("kitchen"),
        all("presses"),
        all("seconds"),
        endings(figures),
        arms(figures),
        all("robot"),
        all("initiative"),
        all("gaze"),
        all("shown"),
        all("highlights"),
    )
}

fn wizard(facts: &RecordingFacts) -> Markup {
    html! {
        @if facts.has("scripted wizard") {
            " The wizard was a script that observes kitchen, presses and gaze, but no estimate: " (all(facts, "scripted wizard")) "."
            @if facts.has("script's offers") { " With advice, it also reads the assistant's offers: " (all(facts, "script's offers")) "." }
        }
        @if facts.has("wizard saw") {
            " The wizard saw " (all(facts, "wizard saw"))
            @if facts.has("unblinded") { ", and in some trials the hypothetical signals of assistants." } @else { "." }
        }
    }
}

fn versions(figures: &StudySummary, facts: &RecordingFacts) -> String {
    let all = |key| all(facts, key);
    let models = figures.human_models.iter().map(|(model, trials)| match figures.human_models.len() {
        1 => model.clone(),
        _ => format!("{model} (in {})", text::count(*trials, "trial", "trials")),
    });
    let models: Vec<String> = models.collect();
    format!(
        " The assistant's model of the human was {}, the cost of a signal {} presses. Recorded with tomcom {} (log format {}), \
         seed {}; analysed with tomcom {}.",
        models.join(" and "),
        all("cost"),
        all("program"),
        all("format"),
        all("seed"),
        env!("CARGO_PKG_VERSION"),
    )
}

fn analysis(figures: &StudySummary) -> String {
    // The report mentions hypothetical signals only if concepts were analysed.
    let computed = match figures.similarity.is_some() || figures.roc.iter().any(|roc| !roc.points.is_empty()) {
        true => ", the estimate of beliefs and the hypothetical signals of each concept",
        false => " and the estimate of beliefs",
    };
    let found = &figures.totals.belief_sources;
    let causes = match figures.totals.beliefs_from {
        Some(_) if found.len() > 1 => &format!("Causes of errors are known by {}.", sources(found)),
        Some(BeliefSource::Recorded) => {
            "Causes of errors were attributed by the recorded beliefs of the simulated participants."
        }
        Some(BeliefSource::Consensus) => {
            "Causes of errors were coded by two raters, who settled together what they had coded differently."
        }
        Some(BeliefSource::Raters) => "Causes of errors were coded by two raters.",
        Some(BeliefSource::Estimate) => "Causes of errors were attributed by the assistant's estimate of the beliefs.",
        // Answers to freeze probes do not tell the causes of errors.
        Some(BeliefSource::Probes) | None => "Causes of errors are not known for all trials.",
    };
    let unused = figures.unused_codes.as_ref().map_or(String::new(), |recordings| {
        format!(" Codes of raters were not used for simulated participants ({recordings}).")
    });
    format!(
        "Every recording was replayed event by event; errors, their causes{computed} were recomputed from the recorded events. In \
         recordings of this version of tomcom, the estimate at each press had to be as recorded. {causes}{unused}"
    )
}

fn endings(figures: &StudySummary) -> String {
    let one = |(reason, &count): (&TrialEndReason, &u64)| {
        let how = match reason {
            TrialEndReason::Presses => "after the set number of presses",
            TrialEndReason::Time => "after the set time",
            TrialEndReason::Orders => "after the set number of orders",
            TrialEndReason::Wizard => "early by the wizard",
            TrialEndReason::Aborted => "aborted",
        };
        format!("{count} {how}")
    };
    let ended: Vec<String> = figures.ended.iter().map(one).collect();
    let shorter = match figures.ended.keys().all(|reason| *reason == TrialEndReason::Presses) {
        true => "",
        false => " Each counts as one trial, regardless of its length.",
    };
    match ended.is_empty() {
        true => String::new(),
        false => format!(" Ends of the trials that count: {}.{shorter}", ended.join(", ")),
    }
}

fn arms(figures: &StudySummary) -> String {
    let trials =
        |group: &RobotArmTotals| format!("{} in {}", arm(group.kind), text::count(group.trials, "trial", "trials"));
    match &figures.robot[..] {
        [] => String::new(),
        [one] => format!(" The robot\u{2019}s arm was {}.", arm(one.kind)),
        both => {
            let both: Vec<String> = both.iter().map(trials).collect();
            format!(" The robot\u{2019}s arm was {}; the statistics pool them.", both.join(" and "))
        }
    }
}
