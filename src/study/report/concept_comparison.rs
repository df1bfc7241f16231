//! Report section that compares communication concepts.

use maud::{Markup, Render, html};

use super::elements::{Captions, keys, nothing, number, scroll, section, with_interval};
use crate::study::charts;
use crate::study::figures::StudySummary;
use crate::study::roc::EQUAL_SIGNALS;

/// Section that compares the concepts by the errors they prevent.
pub(super) fn concepts(captions: &mut Captions, figures: &StudySummary) -> Markup {
    let key = keys(&[("tom-com", "ToM-Com"), ("tom", "ToM"), ("dev", "DEV")]);
    let pictures = html! {
        (captions.figure(charts::roc(figures), html! {
            "Receiver operating characteristics over unassisted trials, bands of 95 %." (key)
        }))
        (captions.figure(charts::equal_signals(figures), html! {
            "Errors prevented against number of signals. Each point is one parameter value. A curve may fall, because a value that \
             sends signals earlier may send one before the false belief begins; it prevents nothing and is not repeated for some \
             time." (key)
        }))
    };
    if pictures.0.is_empty() {
        return nothing();
    }
    let content = html! {
        div class="figures" { (pictures) } "\n"
        h3 { "At equal signals per 100 presses of the human" } "\n"
        (scroll(at_equal_signals(captions, figures)))
    };
    section("Which concept prevents more?", content)
}

fn at_equal_signals(captions: &mut Captions, figures: &StudySummary) -> Markup {
    let banded = |value: Option<f64>, low: Option<f64>, high: Option<f64>| {
        with_interval(value, low.zip(high).map(|(low, high)| [low, high]), 2)
    };
    let concepts = figures.roc.iter().map(|roc| {
        let mut row = vec![roc.concept.title().render()];
        row.extend(roc.at_equal_signals.iter().map(|one| banded(one.value, one.low, one.high)));
        row.push(banded(roc.auc, roc.auc_low, roc.auc_high));
        row
    });
    let behind = figures.roc.iter().skip(1).map(|roc| {
        let mut row = vec![format!("ToM-Com is ahead of {} by", roc.concept.title()).render()];
        row.extend(roc.behind_first.iter().map(|one| banded(one.value, one.low, one.high)));
        row.push(nothing());
        row
    });
    let useless = figures.roc.iter().map(|roc| {
        let mut row = vec![format!("useless signals of {}", roc.concept.title()).render()];
        row.extend(roc.useless_at_equal_signals.iter().map(|one| banded(one.value, one.low, one.high)));
        row.push(nothing());
        row
    });
    let signals = EQUAL_SIGNALS.iter().map(|signals| format!("at {signals:.0} signals"));
    let heads: Vec<String> =
        std::iter::once("prevented".to_string()).chain(signals).chain(["partial area".to_string()]).collect();
    let caption = format!(
        "Shares of the belief related errors prevented at equal interruptions per 100 presses of the human, and shares of useless \
         ones among the signals, with intervals of 95 % by bootstrap over participants ({} in {} unassisted trials). The partial area is over false positive rates from 0 to {}, which \
         all concepts reach, divided by that range; its interval has the range of those who are drawn. The paper prints no figures \
         here; its ToM-Com lies clearly above ToM and DEV.",
        figures.roc_participants,
        figures.roc_trials,
        number(figures.roc_common_fpr, 3),
    );
    captions.table(caption, &heads, &concepts.chain(behind).chain(useless).collect::<Vec<_>>())
}
