//! The results, each with what the paper found.

use super::{count, figure, keys, number, p_sentence, p_value, percent, range, section, table};
use crate::measures::wizard::WizardMeasures;
use crate::study::charts;
use crate::study::effect::AssistanceEffect;
use crate::study::figures::StudySummary;
use crate::study::roc::EQUAL_SIGNALS;
use crate::study::statistics::FTest;
use crate::study::svg::escaped;
use crate::study::trial::Trial;

/// What the paper found, beside what was found here.
pub(super) fn beside_the_paper(figures: &StudySummary) -> String {
    let totals = &figures.totals;
    let row = |what: &str, here: String, paper: &str| vec![what.to_string(), here, paper.to_string()];
    let per_trial = (figures.trials > 0).then(|| totals.actions as f64 / figures.trials as f64);
    let rows = [
        row("participants", figures.participants.to_string(), "14"),
        row("trials", figures.trials.to_string(), "28"),
        row("presses of both agents", totals.actions.to_string(), "8515"),
        row("presses a trial", number(per_trial, 0), "304"),
        row("errors of the human", totals.errors.to_string(), "587"),
        row("errors per press of both", percent(totals.error_rate), "6.9 %"),
        row("errors per press of the human", percent(totals.error_rate_human), "about 11 to 13 %"),
        row("belief related errors", count(totals.belief_related_errors), "481"),
        row("share of the errors that are belief related", percent(totals.belief_related_share), "82 %"),
        row("error sequences", count(totals.sequences), "153"),
        row("errors in a sequence, in the mean", number(totals.mean_sequence_length, 2), "3.1"),
        row("the same by single aspect", number(totals.mean_sequence_length_by_aspect, 2), "\u{2013}"),
        row("seconds to recover, in the mean", number(totals.mean_recovery_s, 1), "\u{2013}"),
        row("assistance: p of the mixed ANOVA", p_value(figures.anova.map(|test| test.p)), "0.014"),
        row("assistance: Pearson r", number(figures.pearson.map(|found| found.r), 2), "0.64"),
        row("assistance: p of r", p_value(figures.pearson.map(|found| found.p)), "0.014"),
        row(
            "signals of the wizard with a match of ToM-Com",
            percent(figures.similarity.as_ref().and_then(|found| found.strict.recall)),
            "74 %",
        ),
    ];
    let caption =
        "All trials together. Paper: Buehler, Adamy and Weisswange (2021); its 6.9 % is per press of both agents.";
    section("Beside the paper", &table(caption, &["", "here", "paper"], &rows))
}

/// The effect of assistance.
pub(super) fn assistance(figures: &StudySummary, trials: &[Trial]) -> String {
    let key = keys(&[("first", "assisted first"), ("second", "unassisted first")]);
    let of_conditions = keys(&[("unassisted", "unassisted"), ("assisted", "assisted")]);
    let pictures = figure(
        charts::errors_by_condition(trials),
        "",
        &format!(
            "Errors by condition; a line is a participant with both trials, black the mean of their rates, in which each \
             counts the same. The table\u{2019}s share is that of all presses together.{key}"
        ),
    ) + &figure(
        charts::improvements(trials),
        "",
        "By how much the second trial has fewer errors in 100 presses. Practice moves both groups, assistance moves them apart.",
    ) + &figure(
        charts::press_durations(trials),
        "",
        &format!("Median seconds from press to press, a sign of experience.{of_conditions}"),
    ) + &figure(
        charts::sequence_lengths(&figures.conditions),
        "",
        &format!("How many error sequences of each length a trial has, in the mean.{of_conditions}"),
    );
    if pictures.is_empty() {
        return String::new();
    }
    let mut text = conditions(figures) + &format!("<div class=\"figures\">\n{pictures}</div>\n");
    text += &figures.effects.first().map_or(String::new(), in_words);
    let rows: Vec<Vec<String>> = figures.effects.iter().map(effect_row).collect();
    let heads = [
        "less of it with assistance?",
        "participants",
        "F (interaction)",
        "p",
        "partial \u{3b7}\u{b2}",
        "r",
        "p of r",
        "permutation p",
        "less by",
        "Hedges\u{2019} g",
    ];
    let caption = "Tests of what assistance takes away. Participants: assisted in the second trial + in the first. Less by: the \
                   Hodges-Lehmann estimate with its interval (at least 95 %).";
    text += &format!("<h3>Tests</h3>\n<div class=\"scroll\">{}</div>\n", table(caption, &heads, &rows));
    if let Some(first) = figures.effects.first() {
        text += &anova(first);
    }
    section("Does assistance help?", &text)
}

fn conditions(figures: &StudySummary) -> String {
    let rows: Vec<Vec<String>> = figures
        .conditions
        .iter()
        .map(|one| {
            let totals = &one.totals;
            vec![
                super::sections::condition(one.condition).to_string(),
                one.trials.to_string(),
                number(one.mean_errors, 1),
                percent(totals.error_rate_human),
                percent(totals.error_rate),
                percent(totals.belief_related_share),
                number(totals.mean_sequence_length, 2),
                number(totals.mean_recovery_s, 1),
                number(one.mean_order_s, 1),
                number(one.mean_press_s, 2),
                totals.signals.to_string(),
            ]
        })
        .collect();
    let heads = [
        "condition",
        "trials",
        "errors a trial",
        "per press of the human",
        "per press of both",
        "belief related",
        "errors in a sequence",
        "s to recover",
        "s for an order",
        "s a press",
        "signals",
    ];
    let caption = "By condition. Shares are of all presses, or errors, of a condition together, so that long trials weigh more; \
                   errors a trial, seconds for an order and seconds a press are means over trials.";
    format!("<div class=\"scroll\">{}</div>\n", table(caption, &heads, &rows))
}

/// What the first effect says, in a sentence.
fn in_words(effect: &AssistanceEffect) -> String {
    let (Some(reduction), Some(test)) = (effect.reduction, effect.assistance()) else { return String::new() };
    let [estimate, low, high] = [reduction.estimate, reduction.low, reduction.high].map(|value| 100.0 * value);
    let interval = match low.is_finite() && high.is_finite() {
        true => format!(", interval of {:.1} %: {}", 100.0 * reduction.level, range(Some(low), Some(high), 1)),
        false => ", with too few participants for an interval".to_string(),
    };
    format!(
        "<p>Assistance takes {} errors away from 100 presses of the human (Hodges-Lehmann{interval}). Interaction of period and \
         starting group: F({:.0},\u{a0}{:.0})\u{a0}=\u{a0}{}, {}.</p>\n",
        number(Some(estimate), 1),
        test.df[0],
        test.df[1],
        number(Some(test.f), 2),
        p_sentence(Some(test.p))
    )
}

fn effect_row(effect: &AssistanceEffect) -> Vec<String> {
    let test = effect.assistance();
    let (reduction, digits) = (effect.reduction, effect.measure.digits);
    let interval = reduction.map_or("\u{2013}".to_string(), |found| {
        let ends = range(Some(found.low), Some(found.high), digits);
        format!("{}<small>{ends}</small>", number(Some(found.estimate), digits))
    });
    vec![
        effect.measure.title.to_string(),
        format!("{} + {}", effect.groups[0], effect.groups[1]),
        number(test.map(|test| test.f), 2),
        p_value(test.map(|test| test.p)),
        number(test.map(|test| test.partial_eta_sq), 2),
        number(effect.pearson.map(|found| found.r), 2),
        p_value(effect.pearson.map(|found| found.p)),
        p_value(effect.permutation_p),
        interval,
        number(effect.hedges_g, 2),
    ]
}

/// The whole analysis of variance, in both codings.
fn anova(effect: &AssistanceEffect) -> String {
    let row = |what: &str, test: Option<FTest>| {
        vec![
            what.to_string(),
            number(test.map(|test| test.f), 3),
            test.map_or("\u{2013}".to_string(), |test| format!("{:.0}, {:.0}", test.df[0], test.df[1])),
            p_value(test.map(|test| test.p)),
            number(test.map(|test| test.partial_eta_sq), 3),
        ]
    };
    let (period, condition) = (&effect.by_period, &effect.by_condition);
    let rows = [
        row("period (within)", period.within),
        row("starting group (between)", period.between),
        row("period \u{d7} starting group: <b>assistance</b>", period.interaction),
        row("the paper\u{2019}s coding: condition (within)", condition.within),
        row("the paper\u{2019}s coding: starting group (between)", condition.between),
        row("the paper\u{2019}s coding: condition \u{d7} starting group", condition.interaction),
    ];
    format!(
        "<h3>Mixed ANOVA of {}</h3>\n{}",
        effect.measure.title,
        table(
            "Mixed ANOVA, in the coding of a crossover and in the paper\u{2019}s.",
            &["", "F", "degrees of freedom", "p", "partial \u{3b7}\u{b2}"],
            &rows
        )
    )
}

/// The comparison of communication concepts.
pub(super) fn concepts(figures: &StudySummary) -> String {
    let key = keys(&[("tom-com", "ToM-Com"), ("tom", "ToM"), ("dev", "DEV")]);
    let pictures = figure(
        charts::roc(figures),
        "",
        &format!("Receiver operating characteristics over unassisted trials, bands of 95 %.{key}"),
    ) + &figure(
        charts::equal_signals(figures),
        "",
        &format!(
            "The same, over how often the concepts interrupt. A curve may fall: each point is the concept with another \
             value of its parameter, and one that speaks earlier may tell something before it is believed wrong, which prevents \
             nothing and is not said again for a while.{key}"
        ),
    );
    if pictures.is_empty() {
        return String::new();
    }
    let rows: Vec<Vec<String>> = figures
        .roc
        .iter()
        .map(|roc| {
            let mut row = vec![roc.concept.title().to_string()];
            row.extend(roc.at_equal_signals.iter().map(|one| banded(one.value, one.low, one.high)));
            row.push(banded(roc.auc, roc.auc_low, roc.auc_high));
            row
        })
        .collect();
    let behind: Vec<Vec<String>> = figures
        .roc
        .iter()
        .skip(1)
        .map(|roc| {
            let mut row = vec![format!("ToM-Com is ahead of {} by", roc.concept.title())];
            row.extend(roc.behind_first.iter().map(|one| banded(one.value, one.low, one.high)));
            row.push(String::new());
            row
        })
        .collect();
    let heads: Vec<String> = EQUAL_SIGNALS.iter().map(|signals| format!("at {signals:.0} signals")).collect();
    let heads: Vec<&str> =
        ["prevented"].into_iter().chain(heads.iter().map(String::as_str)).chain(["partial area"]).collect();
    let caption = format!(
        "Shares of the belief related errors prevented at equal signals per 100 presses of the human, with intervals of 95 % by \
         bootstrap over participants ({} in {} unassisted trials). The partial area is over false positive rates from 0 to {}, which \
         all concepts reach, divided by that range; its interval has the range of those who are drawn. The paper prints no figures \
         here; its ToM-Com lies clearly above ToM and DEV.",
        figures.roc_participants,
        figures.roc_trials,
        number(figures.roc_common_fpr, 3),
    );
    let text = format!(
        "<div class=\"figures\">\n{pictures}</div>\n<h3>At equal signals per 100 presses of the human</h3>\n\
         <div class=\"scroll\">{}</div>\n",
        table(&caption, &heads, &[rows, behind].concat()),
    );
    section("Which concept prevents more?", &text)
}

fn banded(value: Option<f64>, low: Option<f64>, high: Option<f64>) -> String {
    match low.zip(high) {
        Some(_) => format!("{}<small>{}</small>", number(value, 2), range(low, high, 2)),
        None => number(value, 2),
    }
}

/// Wizard and assistant.
pub(super) fn similarity(figures: &StudySummary) -> String {
    let mut text = String::new();
    if let Some(found) = &figures.similarity {
        let share = |what: &str, level: &crate::measures::matching::MatchShares, chance: Option<f64>| {
            let [recall, precision, f1] = [level.recall, level.precision, level.f1].map(|value| number(value, 2));
            vec![what.to_string(), recall, number(chance, 2), precision, f1]
        };
        let rows = [
            share("same signal and target", &found.strict, found.chance_recall),
            share("same kind of signal", &found.lenient, None),
            share("anything, at about the same time", &found.timing, None),
        ];
        let caption = "How far the wizard\u{2019}s signals and those that ToM-Com would have sent match.";
        text += &table(caption, &["within 3 presses of the human", "recall", "by chance", "precision", "F1"], &rows);
        text += &format!(
            "<p>The wizard sent {} signals, ToM-Com would have sent {}; {} match. Kappa {} per press; ToM-Com is earlier by {} s in \
             the median (negative: later). <span class=\"note\">Paper: 74 % of the wizard\u{2019}s communications matched.</span></p>\n",
            found.of_n,
            found.with_n,
            found.matched,
            number(found.kappa, 2),
            number(found.median_lead_s, 1)
        );
        text += &figures.wizard.as_ref().map_or(String::new(), |wizard| limits(figures, wizard));
    }
    if let Some(wizard) = &figures.wizard {
        let row = |what: &str, value: Option<u64>| vec![what.to_string(), count(value)];
        let rows = [
            row("signals sent", Some(wizard.signals)),
            row("taken back", Some(wizard.taken_back)),
            row("false beliefs that led to errors", wizard.episodes),
            row("of those with a signal (hits)", wizard.hits),
            row("without one (omissions)", wizard.omissions),
            row("signals about the same again", wizard.repeated),
            row("late: it was right again already", wizard.late),
            row("about the wrong thing", wizard.wrong_targets),
            row("while nothing was believed wrong", wizard.needless),
            row("about a wrong belief that led to no error", wizard.harmless),
            vec![
                "seconds from the beginning of a false belief to its signal, in the median".to_string(),
                number(wizard.latency_s.map(|times| times.median), 1),
            ],
        ];
        text += &format!("<h3>The wizard</h3>\n{}", table("What the wizard did.", &["", "over all trials"], &rows));
    }
    section("Wizard and assistant", &text)
}

/// What keeps the wizard's signals from having a match; of participants who tell what they believed.
fn limits(figures: &StudySummary, wizard: &WizardMeasures) -> String {
    let (Some(late), Some(wrong), Some(needless)) = (wizard.late, wizard.wrong_targets, wizard.needless) else {
        return String::new();
    };
    let who = if figures.simulated_participants { "scripted wizard" } else { "wizard" };
    format!(
        "<p>What limits the match: {} of {} signals of the {who} were about something that was believed right, then or already, and \
         ToM-Com has no reason for them. It keeps silent, too, where the error is likely to end by itself before it costs more \
         presses than a signal does. What it said more than 3 presses earlier is no match either.</p>\n",
        late + wrong + needless,
        wizard.signals
    )
}

/// What participants said.
pub(super) fn people(figures: &StudySummary) -> String {
    let mut text = String::new();
    if let Some(found) = &figures.acceptance {
        text += &format!(
            "<p>Acceptance of the signals: {} high, {} medium, {} undecided, {} low, {} not reported; mean {} (0: none, 1: full). \
             <span class=\"note\">Paper: 7 high, 3 medium, 3 undecided, 1 not reported.</span></p>\n",
            found.high,
            found.medium,
            found.undecided,
            found.low,
            found.not_reported,
            number(found.mean, 2)
        );
    }
    if !figures.questionnaires.is_empty() {
        let rows: Vec<Vec<String>> = figures
            .questionnaires
            .iter()
            .map(|item| {
                let given: u64 = item.counts.iter().sum();
                vec![
                    escaped(&item.text),
                    super::sections::condition(item.condition).to_string(),
                    given.to_string(),
                    item.left_out.to_string(),
                    format!("{} of {}", number(item.mean, 1), item.points),
                    item.counts.iter().map(u64::to_string).collect::<Vec<_>>().join(" "),
                ]
            })
            .collect();
        text += &format!(
            "<div class=\"scroll\">{}</div>\n",
            table(
                "Answers by item and condition.",
                &["item", "after", "answers", "left out", "mean", "how often 1, 2, \u{2026}"],
                &rows
            )
        );
    }
    section("What participants said", &text)
}
