//! A signal that was shown, in words: why it was sent, what it was worth, and what became of it.

use crate::Session;
use crate::follower::SessionFollower;
use crate::history::wording;
use crate::wizard_log::ShownSignalRecord;
use tomcom_core::base::time::SessionTime;
use tomcom_core::communication::Sender;
use tomcom_core::communication::concept::BenefitUnit;
use tomcom_core::communication::recommendation::{Recommendation, SignalOption, SignalReason};
use tomcom_core::kitchen::{AspectId, Kitchen};
use tomcom_core::measures::wizard_performance::SignalVerdict;

/// A wrong belief below this probability is no reason to tell of a signal that a wizard chose.
const LEAST_SAID: f64 = 0.2;

/// "saves 0.43 presses, +0.18 after the cost of a signal".
pub fn worth(unit: BenefitUnit, option: &SignalOption) -> String {
    let SignalOption { benefit, net, .. } = option;
    match unit {
        BenefitUnit::Deviation => format!("belief off by {benefit:.2}, {net:+.2} from the threshold"),
        BenefitUnit::Presses | BenefitUnit::None => {
            format!("saves {benefit:.2} presses, {net:+.2} after the cost of a signal")
        }
    }
}

/// "the human takes order 1 for tuna nigiri (probability 0.83): would press …".
fn reason(kitchen: &Kitchen, reason: Option<&SignalReason>, words: Option<&String>) -> Option<String> {
    let told = reason.map(|reason| format!("the human {}", wording::reason(kitchen, reason).words_with_unit()));
    told.or_else(|| words.cloned())
}

/// The signal that is advised, with its value and its reason.
pub fn advised(kitchen: &Kitchen, unit: BenefitUnit, advice: &Recommendation) -> Option<String> {
    let best = advice.best.as_ref()?;
    let option = advice.options.iter().find(|option| option.signal == *best);
    let parts = [
        Some(wording::signal(best)),
        // An external concept can name a signal without its value.
        option.map(|option| worth(unit, option)),
        reason(kitchen, advice.reason.as_ref(), advice.words.as_ref()),
    ];
    Some(parts.into_iter().flatten().collect::<Vec<_>>().join("; "))
}

/// Why nothing is advised: "no signal; best would be recipe of order 1: saves 0.43 presses, -1.07 after the cost of a signal".
pub fn not_advised(unit: BenefitUnit, advice: &Recommendation) -> String {
    let best =
        advice.top().map(|best| format!("; best would be {}: {}", wording::signal(&best.signal), worth(unit, best)));
    format!("no signal{}", best.unwrap_or_default())
}

/// Likewise of the session's present advice; `None` if it advises something, or ranks nothing.
pub fn none_advised(session: &Session) -> Option<String> {
    let advice = session.advice.as_ref().filter(|advice| advice.best.is_none() && advice.proposal.is_none())?;
    // Once the advised signal was sent, the next one is not judged before the next advice.
    let is_rated = advice.top().is_some_and(|top| top.net <= 0.0);
    is_rated.then(|| not_advised(session.spec.assistant.concept.name().unit(), advice))
}

/// In parts: "recipe of order 1, by the assistant", then what the assistant thought: "the human takes …", "saves …".
pub fn sent(follower: &SessionFollower, shown: &ShownSignalRecord) -> Vec<String> {
    let session = &follower.session;
    let unit = session.spec.assistant.concept.name().unit();
    // An assistant's reason for what a wizard sent is told if the assistant gave it some weight.
    let is_said = |why: &&SignalReason| shown.by == Sender::Assistant || why.p_believes >= LEAST_SAID;
    let why = reason(&session.kitchen, shown.reason.as_ref().filter(is_said), shown.words.as_ref());
    let parts = [
        Some(format!("{}, by the {}", wording::signal(&shown.signal), wording::sender(shown.by))),
        why.map(|why| match shown.by {
            Sender::Assistant => why,
            Sender::Wizard => format!("the assistant would have said: {why}"),
        }),
        shown.worth.as_ref().map(|option| worth(unit, option)),
        shown.offered.map(|offered| format!("net benefit {:+.2} when it was offered", offered.net)),
    ];
    parts.into_iter().flatten().collect()
}

/// A signal with its sender, what became of it, whether it was a hit, and last what the assistant thought. `verdicts`: as of
/// [`judged`].
pub fn told(follower: &SessionFollower, verdicts: Option<&[SignalVerdict]>, nth: usize) -> String {
    let mut parts = sent(follower, &follower.signals.shown[nth]);
    parts.insert(1, outcome(follower, nth));
    parts.insert(2, judged(follower, verdicts, nth));
    parts.retain(|part| !part.is_empty());
    parts.join("; ")
}

/// Whether a signal was a hit, by the participant's own beliefs, as the study counts it: "hit: no, late". `verdicts`: those of
/// all signals, from `signal_verdicts`.
pub fn judged(follower: &SessionFollower, verdicts: Option<&[SignalVerdict]>, nth: usize) -> String {
    match verdicts.and_then(|verdicts| verdicts.get(nth)) {
        Some(SignalVerdict::Hit { .. }) => "hit: yes, about a false belief that led to errors".to_string(),
        Some(other) => format!("hit: no, {}", other.name()),
        None if follower.session.is_trial_over() => "hit: not known".to_string(),
        None => "hit: judged at the end of the trial".to_string(),
    }
}

/// What became of a signal that is over: whether the participant looked at it, and what the estimate says of the belief it is
/// about. `nth`: its index among the signals shown.
pub fn outcome(follower: &SessionFollower, nth: usize) -> String {
    let Some(shown) = follower.signals.shown.get(nth) else { return String::new() };
    let session = &follower.session;
    let after = |time: SessionTime| wording::seconds(session.age(shown.time, time).as_secs_f64());
    let has_place = shown.signal.location(&session.kitchen).is_some() && session.gaze.samples > 0;
    let seen = match shown.seen {
        Some(seen) => Some(format!("looked at after {}", after(seen))),
        None => has_place.then(|| "not looked at".to_string()),
    };
    let taken_back = shown.is_taken_back().then(|| match shown.ended {
        Some(ended) => format!("taken back after {}", after(ended)),
        None => "taken back".to_string(),
    });
    [taken_back, seen, belief(follower, shown)].into_iter().flatten().collect::<Vec<_>>().join("; ")
}

/// What became of the beliefs that a signal is about, by the estimate.
fn belief(follower: &SessionFollower, shown: &ShownSignalRecord) -> Option<String> {
    let (session, track) = (&follower.session, &follower.false_beliefs);
    if shown.aspects().is_empty() {
        return None;
    }
    // A press makes a belief false at the very time at which a signal follows it.
    let was_false: Vec<AspectId> =
        shown.aspects().iter().copied().filter(|&aspect| track.until(aspect, shown.time).is_some()).collect();
    if was_false.is_empty() {
        return Some("by the estimate the belief was right already".to_string());
    }
    let end = shown.ended.unwrap_or(session.time);
    let name = |aspect: &AspectId| wording::location(&session.kitchen.aspects[aspect.index()].name);
    let told = was_false.iter().map(|aspect| match track.corrected(*aspect, shown.time) {
        Some(right) if right <= end => {
            let after = wording::seconds(session.age(shown.time, right).as_secs_f64());
            format!("by the estimate the belief about {} is right after {after}", name(aspect))
        }
        _ => format!("by the estimate the belief about {} stays false", name(aspect)),
    });
    Some(told.collect::<Vec<_>>().join("; "))
}
