//! Section of the study report that compares communication concepts.

use maud::{Markup, Render, html};

use super::elements::{Captions, PageColumn, keys, nothing, number, told, with_interval};
use crate::charts::{self, MOST_SIGNALS};
use crate::figures::StudySummary;
use crate::live_arms::SignalSenderResults;
use crate::roc::{BootstrapInterval, ConceptRocCurve, EQUAL_SIGNALS, INTERPOLATED};
use crate::why;
use tomcom_core::base::text::count;
use tomcom_core::measures::raters::BeliefSource;

pub(super) fn concepts(captions: &mut Captions, figures: &StudySummary) -> Markup {
    let key = keys(&[("tom-com", "ToM-Com"), ("tom", "ToM"), ("dev", "DEV")]);
    let pictures = html! {
        (captions.figure(charts::roc(figures), html! {
            "Receiver operating characteristics over unassisted trials" (bands(figures)) ". False beliefs are known by "
            (figures.roc_beliefs_from.map_or("unknown sources", BeliefSource::words)) "." (key)
        }))
        (captions.figure(charts::equal_signals(figures), html! {
            "Errors prevented against number of signals. Each point is one parameter value. A curve may fall: a threshold \
             that sends signals earlier may send one before the false belief begins, which prevents nothing and is not repeated for \
             some time; longer proposals of DEV interrupt less often." (cut_off(figures)) (key)
        }))
    };
    let content = html! {
        @if !pictures.0.is_empty() {
            div class="figures" { (pictures) } "\n"
            h3 { "At equal signals per 100 presses of the human" } "\n"
            (at_equal_signals(captions, figures))
        }
        @if !figures.live.is_empty() {
            h3 { "Acting by themselves" } "\n"
            (live(captions, figures))
        }
    };
    captions.section("Which concept prevents more?", content)
}

const REFERENCE: &str = "the others are compared with this";

fn bands(figures: &StudySummary) -> String {
    let drawn = figures.roc.iter().filter(|roc| !roc.points.is_empty());
    let without: Vec<&str> = drawn.clone().filter(|roc| roc.band.is_empty()).map(|roc| roc.concept.title()).collect();
    match without.len() {
        0 => ", bands of 95 % by bootstrap over participants".to_string(),
        some if some == drawn.count() => ", without bands: too few participants for a bootstrap".to_string(),
        _ => format!(
            ", bands of 95 % by bootstrap over participants; too few participants for a band of {}",
            without.join(", ")
        ),
    }
}

fn cut_off(figures: &StudySummary) -> String {
    let points = figures.roc.iter().flat_map(|roc| &roc.points);
    match points.filter(|point| point.signals_per_100_actions > MOST_SIGNALS).count() as u64 {
        0 => String::new(),
        beyond => format!(" Cut off at {MOST_SIGNALS}: {} beyond it.", count(beyond, "point lies", "points lie")),
    }
}

fn live(captions: &mut Captions, figures: &StudySummary) -> Markup {
    let columns: [PageColumn<SignalSenderResults>; 12] = [
        ("concept, parameter", |one| {
            let parameter = one.arm.parameter.map_or(String::new(), |parameter| format!(" {parameter}"));
            format!("{}{parameter}", one.arm.concept).render()
        }),
        ("belief related errors per 100 presses", |one| number(one.belief_related_per_100, 2, why::NO_PRESS)),
        ("sequences per 100 presses", |one| number(one.sequences_per_100, 2, why::NO_PRESS)),
        ("errors per sequence", |one| number(one.mean_sequence_length, 2, why::NO_SEQUENCE)),
        ("orders", |one| one.orders.render()),
        ("orders per minute", |one| number(one.orders_per_minute, 2, why::NO_PRESS)),
        ("signals per 100 presses", |one| number(one.interruptions_per_100, 2, why::NO_PRESS)),
        ("their contents", |one| number(one.contents_per_100, 2, why::NO_PRESS)),
        ("useless", |one| number(one.useless_per_100, 2, why::NOT_TWINNED)),
        ("fewer belief related errors", |one| {
            let why = if one.arm.concept == "none" { REFERENCE } else { why::NO_REFERENCE };
            number(one.prevented, 2, why)
        }),
        ("prevented, offline", |one| number(one.prevented_offline, 2, why::NOT_OFFLINE)),
        ("signals per 100, offline", |one| number(one.interruptions_per_100_offline, 2, why::NOT_OFFLINE)),
    ];
    let trials = figures.live.first().map_or(0, |arm| arm.trials);
    let caption = format!(
        "Concepts that acted by themselves in the {trials} simulated trials (the same seeds) that every line has. A proposal of k presses is one \
         signal with k contents. Useless: signals per 100 presses \
         without which a twin of the trial, with the same random streams, makes no more errors about their target (of a proposal: no more errors \
         in its next k presses). Fewer belief \
         related errors: share per press of the human, against no signals. Offline: what the analysis of unassisted trials says for \
         the same parameter; a replayed signal changes nothing that follows."
    );
    captions.table_of_columns(caption, &columns, figures.live.iter())
}

fn at_equal_signals(captions: &mut Captions, figures: &StudySummary) -> Markup {
    let banded = |value: Option<f64>, low: Option<f64>, high: Option<f64>, why: &str| {
        with_interval(value, low.zip(high).map(|(low, high)| [low, high]), 2, why)
    };
    let row = |head: String, values: &[BootstrapInterval], area: Markup| -> Vec<Markup> {
        let values = values.iter().map(|one| banded(one.value, one.low, one.high, why::NO_CURVE));
        std::iter::once(head.render()).chain(values).chain([area]).collect()
    };
    let title = |roc: &ConceptRocCurve| roc.concept.title().to_string();
    let area = |roc: &ConceptRocCurve| banded(roc.auc, roc.auc_low, roc.auc_high, why::NO_AREA);
    let concepts = figures.roc.iter().map(|roc| row(title(roc), &roc.at_equal_signals, area(roc)));
    let behind = figures.roc.iter().skip(1);
    let behind = behind.map(|roc| row(format!("ToM-Com is ahead of {} by", title(roc)), &roc.behind_first, nothing()));
    let useless = figures
        .roc
        .iter()
        .map(|roc| row(format!("useless signals of {}", title(roc)), &roc.useless_at_equal_signals, nothing()));
    let signals = EQUAL_SIGNALS.iter().map(|signals| format!("at {signals:.0} signals"));
    let heads: Vec<String> =
        std::iter::once("prevented".to_string()).chain(signals).chain(["partial area".to_string()]).collect();
    let caption = format!(
        "Shares of the belief related errors prevented at equal interruptions per 100 presses of the human, and shares of useless \
         ones among the signals, with intervals of 95 % by bootstrap over participants ({} in {} unassisted trials). {INTERPOLATED} The partial area is over false positive rates from 0 to {}, the largest that \
         all concepts reach, divided by that range; its interval has the range of those who are drawn. The paper prints no figures \
         here; its ToM-Com lies clearly above ToM and DEV.",
        figures.roc_participants,
        figures.roc_trials,
        told(figures.roc_common_fpr, 3, why::NO_AREA),
    );
    captions.table(caption, &heads, &concepts.chain(behind).chain(useless).collect::<Vec<_>>())
}
