//! The study report: one self-contained HTML page for screen and print.

mod assistance;
mod concept_comparison;
mod elements;
mod methods;
mod results;

use std::collections::BTreeSet;

use maud::{DOCTYPE, Markup, PreEscaped, Render, html};

use crate::charts;
use crate::column::CsvTable;
use crate::definitions::DEFINITIONS;
use crate::facts::RecordingFacts;
use crate::figures::{StudySummary, pairs_in_words};
use crate::headline::{level, mixed_sources, no_interval, not_reliable, per_100, primary_outcome};
use crate::pass::reading::WaivedPractice;
use crate::planned_trial::{copies_in_words, foreign_in_words, in_words};
use crate::report::elements::{
    Captions, DASH, PageColumn, cells, count, fixed, keys, known, nothing, number, p_sentence, percent, range, told,
};
use crate::trial_statistics::{DisplayLosses, TrialStatistics};
use crate::why;
use tomcom_core::base::text;
use tomcom_core::measures::raters::{BeliefSource, RaterAgreement};

pub const STYLE: &str = include_str!("style.css");

pub fn page(figures: &StudySummary, trials: &[TrialStatistics], facts: &RecordingFacts, tables: &[CsvTable]) -> String {
    let captions = &mut Captions::default();
    let summary = summary(captions, figures, trials);
    let sections = [
        assistance::arms(captions, figures),
        assistance::assistance(captions, figures, trials),
        results::awareness(captions, figures),
        concept_comparison::concepts(captions, figures),
        results::similarity(captions, figures),
        results::robot(captions, figures),
        results::people(captions, figures),
        results::beside_the_paper(captions, figures),
        trials_section(captions, figures, trials),
        methods::methods(captions, figures, facts),
        definitions(captions),
        files(captions, tables),
    ];
    let page = html! {
        (DOCTYPE) "\n"
        html lang="en" {
            (head(figures, trials))
            body {
                main {
                    h1 { (figures.title) } "\n"
                    (summary) (captions.contents())
                    @for section in sections { (section) }
                }
            }
        }
        "\n"
    };
    page.into_string()
}

fn head(figures: &StudySummary, trials: &[TrialStatistics]) -> Markup {
    html! {
        head {
            meta charset="utf-8"; "\n"
            title { (figures.title) } "\n"
            @for (name, content) in metadata(trials) { meta name=(name) content=(content); "\n" }
            style { "\n" (PreEscaped(STYLE)) }
        }
        "\n"
    }
}

fn metadata(trials: &[TrialStatistics]) -> [(&'static str, String); 3] {
    let [generator, participants] = head_fields(trials.iter().map(|trial| trial.participant.as_str()));
    [generator, participants, ("viewport", "width=device-width, initial-scale=1".to_string())]
}

const GENERATOR: &str = "generator";
const PARTICIPANTS: &str = "participants";
const PROGRAM: &str = "tomcom ";

/// Metadata in the HTML head of a report, as pairs (name, content): program version and participants' codes, by which
/// `tomcom forget` finds the reports about a participant. Codes consist of letters, digits, - and _, as in tables.
fn head_fields<'a>(participants: impl Iterator<Item = &'a str>) -> [(&'static str, String); 2] {
    let participants: Vec<&str> = participants.collect::<BTreeSet<&str>>().into_iter().collect();
    [(GENERATOR, format!("{PROGRAM}{}", env!("CARGO_PKG_VERSION"))), (PARTICIPANTS, participants.join(" "))]
}

/// Participants of a report that this program wrote; `None` for any other HTML page.
pub fn participants_of_page(page: &str) -> Option<Vec<&str>> {
    let (head, _) = page.split_once("</head>")?;
    head.contains(&meta_tag(GENERATOR, PROGRAM)).then_some(())?;
    let (_, content) = head.split_once(&meta_tag(PARTICIPANTS, ""))?;
    let (content, _) = content.split_once('"')?;
    Some(content.split_whitespace().collect())
}

/// Start of an HTML metadata tag up to and including the first characters of the tag's content.
fn meta_tag(name: &str, begins: &str) -> String {
    format!("<meta name=\"{name}\" content=\"{begins}")
}

/// Least number of participants with both trials from which on r and p are shown among the main results.
const FEWEST_PARTICIPANTS: usize = 8;

fn summary(captions: &mut Captions, figures: &StudySummary, trials: &[TrialStatistics]) -> Markup {
    let (totals, outcome) = (&figures.totals, figures.primary_outcome);
    let pairs: usize = figures.effects.first().map_or(0, |effect| effect.groups.iter().sum());
    let effect = match figures.pearson {
        Some(_) if pairs < FEWEST_PARTICIPANTS => card(
            DASH,
            &format!(
                "secondary, the paper\u{2019}s analysis: no r and no p here, since {pairs} participants with both trials are fewer than {FEWEST_PARTICIPANTS}, and r would be chance"
            ),
        ),
        Some(pearson) => card(
            &format!("r\u{a0}=\u{a0}{}", fixed(pearson.r, 2)),
            &format!(
                "secondary, the paper\u{2019}s analysis: of assistance and fewer errors ({}); the first sentence is the main result",
                p_sentence(pearson.p)
            ),
        ),
        None => nothing(),
    };
    let rates = figures.conditions.iter().map(|one| {
        let trials = text::count(one.trials, "trial", "trials");
        let (outcome, condition) = (outcome.title(), one.condition.title());
        let what = format!("{outcome} per 100 presses of the human, all of {trials} pooled: {condition}");
        match per_100(one, figures.primary_outcome) {
            Some(rate) => card(&fixed(rate, 1), &what),
            None => card(DASH, &format!("{what}; {}", one.totals.why_no_rate())),
        }
    });
    // With two conditions; a chart and a table show more contrasts.
    let ratio = figures.arms.as_ref().filter(|found| found.contrasts.len() == 1).map(|found| {
        let one = &found.contrasts[0];
        let doubt = not_reliable(found, one).map_or(String::new(), |why| format!("; {why}"));
        let told = || format!("{} interval {}", level(one.level), range(one.interval, 2));
        let interval = no_interval(found, one).unwrap_or_else(told);
        let (arm, against) = (one.arm.title(), one.against.title());
        card(&fixed(one.ratio, 2), &format!("ratio of the rates, {arm} to {against}: {interval}{doubt}"))
    });
    html! {
        // Of several sentences the first says what the others show together; their figures stand in a table.
        @if let Some(sentence) = primary_outcome(figures).first() { p class="answer" { (sentence.replace(" < ", "\u{a0}<\u{a0}")) } "\n" }
        @if let Some(found) = &figures.preregistration {
            p class=(if found.differences.is_empty() { "note" } else { "warning" }) { (found.words()) } "\n"
        }
        p class="lead" {
            (text::count(figures.trials, "trial", "trials")) " of "
            (text::count(figures.participants, "participant", "participants")) ", " (totals.actions) " recorded presses."
            @if !figures.left_out.is_empty() {
                " Left out: " (text::count(figures.left_out.len() as u64, "trial", "trials")) ", " a href="#left-out" { "with reasons" } "."
            }
        }
        "\n"
        div class="cards" {
            "\n"
            @if let Some(ratio) = ratio { (ratio) }
            @for rate in rates { (rate) }
            (effect)
        }
        "\n"
        @if figures.simulated_participants {
            p class="warning" {
                "Participants are simulated. Their errors, beliefs and presses are those of a program for testing apparatus and \
                 parameters. Nothing here is evidence about people."
            }
            "\n"
        }
        @if totals.belief_sources.keys().eq([&BeliefSource::Estimate]) {
            p class="warning" {
                "Beliefs of participants are known only as the assistant's estimate. Results that rest on them, such as the share of \
                 belief related errors, are tentative until two raters have coded the errors."
            }
            "\n"
        }
        @if let Some((words, differs)) = mixed_sources(figures) {
            p class=(if differs { "warning" } else { "note" }) { "C" (&words[1..]) "." } "\n"
        }
        @if let Some(missing) = in_words(&figures.missing_trials, &figures.corrections) { p class="note" { (missing) } "\n" }
        @for one in &figures.corrections { p class="note" { (one.in_words()) "." } "\n" }
        @for one in &figures.other_orders { p class="warning" { "Not the planned order of conditions: " (one) "." } "\n" }
        @if let Some(foreign) = foreign_in_words(&figures.foreign) { p class="warning" { (foreign) "." } "\n" }
        @if let Some(copies) = copies_in_words(&figures.copies) { p class="note" { (copies) } "\n" }
        @if let Some(found) = &figures.raters { (raters(found, figures)) }
        @for one in &figures.identical_codes { p class="warning" { (one.in_words()) "." } "\n" }
        @for one in &figures.stale_consensus {
            p class="warning" { "Stale consensus, not used: " (one.recording) ": " (one.reason) "." } "\n"
        }
        div class="figures" {
            (captions.figure(charts::rates_by_condition(trials, outcome), html! {
                "A line joins the trials of a participant; black is the mean of the participants\u{2019} rates, each of the same weight. \
                 The rates of the first sentence, above and in the tables pool all presses, so that who pressed more weighs more: \
                 they differ from these."
                @if figures.conditions.len() == 2 { (keys(&[("first", "assisted first"), ("second", "unassisted first")])) }
            }))
            @if let Some(found) = &figures.arms {
                (captions.figure(charts::ratios(&found.contrasts), html! {
                    "Ratio of the rates of two conditions, with its interval. Below 1 the first one has fewer; an interval across the line \
                     at 1 does not show a difference."
                    @for (one, why) in found.contrasts.iter().filter_map(|one| Some((one, not_reliable(found, one)?))) {
                        " " (one.arm.title()) " to " (one.against.title()) ": " (why) "."
                    }
                }))
            }
        }
        "\n"
    }
}

fn raters(found: &RaterAgreement, figures: &StudySummary) -> Markup {
    html! {
        p {
            "Two raters (" (pairs_in_words(&figures.rater_pairs)) ") coded the causes of errors. They agree on the cause of " (found.same_cause) " of " (found.errors)
            " errors (Cohen\u{2019}s kappa " (told(found.kappa_cause, 2, why::NO_KAPPA)) "). Of " (found.beliefs) " errors that both \
            attribute to a false belief, they agree on its location for " (found.same_aspect) " (kappa "
            (told(found.kappa_aspect, 2, why::NO_KAPPA)) "). Without a consensus an error counts as belief related if both coded a false belief."
            @if let Some(shared) = &figures.shared_beliefs {
                " False belief episodes, and with them errors prevented, hits and omissions, follow from the errors for which both name \
                 the same false belief (" (shared.same) "), or from the consensus; for " (shared.differing) " errors they name different \
                 ones, for " (shared.of_one) " one of them alone names one."
            }
            @for (pair, trials) in &figures.consensus {
                " Codes of " (text::count(*trials, "trial", "trials")) ": consensus of " (pair.replace('+', " and "))
                ", settled together after each had coded alone; agreement is that of their own codes."
            }
        }
        "\n"
    }
}

fn card(value: &str, what: &str) -> Markup {
    html! { div class="card" { b { (value) } span { (what) } } "\n" }
}

const MOST_TRIALS: usize = 60;

fn trials_section(captions: &mut Captions, figures: &StudySummary, trials: &[TrialStatistics]) -> Markup {
    let content = html! {
        div class="long" { (counting(captions, trials)) } "\n"
        h3 id="left-out" { "Excluded" } "\n"
        (left_out(captions, figures))
        @if figures.practice > 0 {
            p class="note" {
                (text::count(figures.practice, "recording is", "recordings are")) " of practice and not analysed."
            }
            "\n"
        }
        @if let Some(waived) = WaivedPractice::in_words(&figures.waived) { p class="note" { "P" (&waived[1..]) "." } "\n" }
        (without_display(trials))
    };
    captions.section("Trials", content)
}

/// How often participants' displays were lost; empty if none was.
fn without_display(trials: &[TrialStatistics]) -> Markup {
    let lost: Vec<DisplayLosses> =
        trials.iter().filter_map(|trial| trial.display_losses).filter(|it| it.times > 0).collect();
    let (times, seconds) = (lost.iter().map(|it| it.times).sum::<u64>(), lost.iter().map(|it| it.seconds).sum::<f64>());
    html! {
        @if times > 0 {
            p class="note" {
                "The participant's display was lost " (text::count(times, "time", "times")) " while a trial ran, for "
                (fixed(seconds, 1)) " s, in " (text::count(lost.len() as u64, "trial", "trials")) " (" code { "display_lost" } ")."
            }
            "\n"
        }
    }
}

fn counting(captions: &mut Captions, trials: &[TrialStatistics]) -> Markup {
    let columns: [PageColumn<TrialStatistics>; 14] = [
        ("participant", |trial| trial.participant.render()),
        ("group", |trial| known(trial.group.as_ref(), why::NO_PLAN, String::clone)),
        ("trial", |trial| count(trial.period.map(u64::from), why::NO_PLAN)),
        ("condition", |trial| trial.planned_arm.title().render()),
        ("ended by", |trial| known(trial.ended, why::CUT, |reason| reason.name().to_string())),
        ("presses, human", |trial| trial.human_presses.render()),
        ("robot", |trial| trial.robot_presses.render()),
        ("errors", |trial| trial.errors.render()),
        ("per press of the human", |trial| percent(trial.error_rate_human(), why::NO_PRESS)),
        ("belief related", |trial| count(trial.beliefs.as_ref().map(|beliefs| beliefs.errors), trial.why_no_length())),
        ("per sequence", |trial| number(trial.sequence_length(), 1, trial.why_no_length())),
        ("signals", |trial| trial.signals.render()),
        ("orders", |trial| trial.orders.render()),
        ("s per press", |trial| number(trial.press_s, 2, why::ONE_PRESS)),
    ];
    let number = trials.iter().filter(|trial| trial.counts()).count();
    let caption = html! {
        @if number > MOST_TRIALS {
            "The first " (MOST_TRIALS) " of " (number) " trials that count; all are in " code { "trials.csv" } "."
        } @else {
            "Analysed trials."
        }
    };
    let printed = trials.iter().filter(|trial| trial.counts()).take(MOST_TRIALS);
    captions.table_of_columns(caption, &columns, printed)
}

fn left_out(captions: &mut Captions, figures: &StudySummary) -> Markup {
    if figures.left_out.is_empty() {
        return html! { p { "No trial is excluded." } "\n" };
    }
    let rows: Vec<Vec<Markup>> =
        figures.left_out.iter().map(|one| cells([&one.recording, &one.participant, &one.reason])).collect();
    captions.table_of_text("Excluded trials.", &["recording", "participant", "reason"], &rows)
}

fn definitions(captions: &mut Captions) -> Markup {
    let content = html! {
        dl { @for (term, text) in DEFINITIONS { "\n" dt { (term) } "\n" dd { (text) } } } "\n"
    };
    captions.section("Definitions", content)
}

fn files(captions: &mut Captions, tables: &[CsvTable]) -> Markup {
    let content = html! {
        p {
            "Beside this page: "
            @for (index, table) in tables.iter().enumerate() {
                @if index > 0 { ", " }
                code { (table.name()) ".csv" }
            }
            ". The last one defines every column of the others. Empty cells are unknown values; the recording's name is the key \
            that joins the tables."
        }
        "\n"
    };
    captions.section("Tables", content)
}
