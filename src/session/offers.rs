//! The rules of offers to the wizard: when one opens and closes, and which one the key `enter` takes.
//!
//! A running session asks [`due`] after every event and at [`Timer::ReviewOffer`](crate::Timer), and records the event
//! of an offer that `due` returns; a replay applies the recorded events. Ages of offers are measured on the trial's
//! clock, so offers do not grow older in a pause.

use crate::admit::{admit, hygiene, may_send, may_send_now};
use crate::settings::{Condition, WizardVisibility};
use crate::{Event, Session, TrialPhase};
use tomcom_core::base::time::SessionTime;
use tomcom_core::communication::offer::{
    GAP, HOLD, Offer, OfferCloseReason, OfferCloseThresholds, OfferKeyKind, OfferUse, OfferWorth, OfferedAdvice,
    TAKEN_AFTER, UNREAD,
};
use tomcom_core::communication::recommendation::{Recommendation, SignalOption};
use tomcom_core::communication::{Sender, Signal, unavailable};
use tomcom_core::kitchen::OrderContent;

/// An assistant that acts by itself sends its recommendation at once, without offers.
pub fn are_made(session: &Session) -> bool {
    session.spec.trial.condition != Condition::Assistant
}

/// `offer_opened` or `offer_closed`, if one is due.
pub fn due(session: &Session, now: SessionTime) -> Option<Event> {
    match session.offers.unclosed() {
        Some(offer) => {
            let reason = closing(session, offer, now)?;
            Some(Event::OfferClosed { offer: offer.seq, reason })
        }
        None => opening(session, now).map(Event::OfferOpened),
    }
}

fn closing(session: &Session, offer: &Offer, now: SessionTime) -> Option<OfferCloseReason> {
    match session.phase {
        TrialPhase::Running => {}
        TrialPhase::Ready | TrialPhase::Paused => return None,
        TrialPhase::Over(_) | TrialPhase::Closed => return Some(OfferCloseReason::TrialEnded),
    }
    match offer.used.map(|used| used.how) {
        Some(OfferKeyKind::Taken) => return Some(OfferCloseReason::Taken),
        Some(OfferKeyKind::OwnKey) => return Some(OfferCloseReason::OwnKey),
        None => {}
    }
    let is_impossible = |signal| unavailable(&session.kitchen, session.state, signal).is_some();
    if offer.signal().is_some_and(is_impossible) {
        return Some(OfferCloseReason::Impossible);
    }
    if session.age(offer.opened, now) < HOLD {
        return None;
    }
    outdone(session, offer, session.advice.as_ref()?)
}

/// Why the latest recommendation closes the open offer.
fn outdone(session: &Session, offer: &Offer, advice: &Recommendation) -> Option<OfferCloseReason> {
    let signal = &offer.advice.what;
    if let Signal::Propose(presses) = signal {
        return match &advice.proposal {
            None => Some(OfferCloseReason::Fell),
            Some(proposal) => (proposal.presses != *presses).then_some(OfferCloseReason::Replaced),
        };
    }
    if offer.advice.worth.is_none() && advice.options.is_empty() {
        // An external concept that names a signal without its value.
        return match &advice.best {
            None => Some(OfferCloseReason::Fell),
            Some(best) => (best != signal).then_some(OfferCloseReason::Replaced),
        };
    }
    // A signal that is not in the recommendation's list has no net benefit that could close the offer.
    let net = advice.options.iter().find(|option| option.signal == *signal)?.net;
    let thresholds = OfferCloseThresholds::for_concept(session.spec.assistant.concept.name());
    if net < thresholds.closes_below {
        return Some(OfferCloseReason::Fell);
    }
    let other = candidate(session, advice).filter(|option| option.signal != *signal)?;
    (other.net >= net + thresholds.better_by).then_some(OfferCloseReason::Replaced)
}

fn opening(session: &Session, now: SessionTime) -> Option<OfferedAdvice> {
    if !session.is_running() || !are_made(session) {
        return None;
    }
    let rests = session.offers.last().is_some_and(|last| session.age(last.closed, now) < GAP);
    let cool_down = SessionTime::from_secs_f64(session.spec.signals.cool_down_s);
    let cools = session.signalled_at.is_some_and(|sent| now - sent < cool_down);
    if rests || cools {
        return None;
    }
    let advice = session.advice.as_ref()?;
    let (for_seq, visible) = (advice.for_seq, is_visible(session));
    let without_value =
        |what| OfferedAdvice { what, for_seq, worth: None, reason: None, words: advice.words.clone(), visible };
    if let Some(proposal) = &advice.proposal {
        return Some(without_value(Signal::Propose(proposal.presses.clone())));
    }
    if advice.options.is_empty() {
        // An external concept that names a signal without its value.
        let signal = advice.best.as_ref()?;
        return unavailable(&session.kitchen, session.state, signal).is_none().then(|| without_value(signal.clone()));
    }
    let option = candidate(session, advice)?;
    let SignalOption { benefit, standard_error, net, .. } = *option;
    let worth = Some(OfferWorth { benefit, standard_error, net });
    // The recommendation gives a reason for its best signal only.
    let is_best = advice.best.as_ref() == Some(&option.signal);
    let (reason, words) = (advice.reason.clone().filter(|_| is_best), advice.words.clone().filter(|_| is_best));
    let what = option.signal.clone();
    Some(OfferedAdvice { what, for_seq, worth, reason, words, visible })
}

/// Whether a wizard could see an offer that opens now: a console shows it or a script reads it.
fn is_visible(session: &Session) -> bool {
    let is_drawn = session.has_console && session.spec.console.visibility == WizardVisibility::Recommendation;
    is_drawn || session.spec.script_reads_offers()
}

/// The best signal whose benefit exceeds its cost. If two orders want the same dish, the older one is chosen, provided
/// that the benefit of its recipe signal exceeds the cost, too.
fn candidate<'a>(session: &Session, advice: &'a Recommendation) -> Option<&'a SignalOption> {
    let is_worth = |option: &&SignalOption| {
        option.net > 0.0 && unavailable(&session.kitchen, session.state, &option.signal).is_none()
    };
    let best = advice.best.as_ref()?;
    let best = advice.options.iter().find(|option| option.signal == *best).filter(is_worth)?;
    let Some((appeared, dish)) = wanted(session, &best.signal) else { return Some(best) };
    let others = advice.options.iter().filter(is_worth).filter_map(|option| {
        let (at, other) = wanted(session, &option.signal)?;
        (other == dish && at < appeared).then_some((at, option))
    });
    Some(others.min_by_key(|(at, _)| *at).map_or(best, |(_, option)| option))
}

/// When the order of a recipe signal appeared (ties go to the layout's order), and the dish that the order wants.
fn wanted(session: &Session, signal: &Signal) -> Option<((SessionTime, usize), OrderContent)> {
    let Signal::ShowRecipe(order) = signal else { return None };
    let order = session.kitchen.location_named(order)?;
    let index = session.kitchen.orders.iter().position(|location| *location == order)?;
    Some(((session.changed_at[order.index()], index), session.state.order(order)))
}

/// The wizard sent the signal of the open offer, or of the last one while `enter` still takes it.
pub(super) fn sends(session: &mut Session, now: SessionTime, signal: &Signal, is_taken: bool) {
    let how = if is_taken { OfferKeyKind::Taken } else { OfferKeyKind::OwnKey };
    let with_last = still_takes(session, now).is_some();
    session.offers.sends(signal, OfferUse { how, at: now }, with_last);
}

/// The last closed offer, while the key `enter` can still take it.
fn still_takes(session: &Session, now: SessionTime) -> Option<&Offer> {
    session.offers.last().filter(|last| session.age(last.closed, now) <= TAKEN_AFTER).map(|last| &last.offer)
}

/// The offer to which `enter` refers: the open one; in the first 0.3 s of an open offer, or while none is open, the
/// last one if it closed at most 1.3 s ago and was not taken. The error is in words for the wizard.
pub fn meant(session: &Session, now: SessionTime) -> Result<&Offer, &'static str> {
    let open = session.offers.open();
    if let Some(offer) = open.filter(|offer| session.age(offer.opened, now) >= UNREAD) {
        return Ok(offer);
    }
    match (still_takes(session, now), open) {
        (Some(last), _) if last.used.is_none() => Ok(last),
        (_, Some(_)) => Err("the offer has just appeared: read it, then press again"),
        (Some(_), None) => Err("the signal on offer was sent already"),
        (None, None) => Err("no signal is on offer"),
    }
}

/// The offer that `enter` takes, with the event that sends its signal.
pub fn enter(session: &Session, now: SessionTime) -> Result<(&Offer, Event), String> {
    may_send(session, Sender::Wizard)?;
    if session.spec.console.visibility != WizardVisibility::Recommendation {
        return Err("recommendations are not shown in this session".to_string());
    }
    may_send_now(session, Sender::Wizard)?;
    let offer = meant(session, now)?;
    let event = take(offer).ok_or("proposed presses are for the participant to make; they cannot be sent")?;
    admit(session, &event)?;
    hygiene(session, now, &event)?;
    Ok((offer, event))
}

/// If `enter` would refer to the offer with this sequence number.
pub(crate) fn script_takes(session: &Session, now: SessionTime, offer: u64) -> Option<Event> {
    meant(session, now).ok().filter(|meant| meant.seq == offer).and_then(take)
}

/// `None` if the offer proposes presses.
fn take(offer: &Offer) -> Option<Event> {
    let signal = offer.signal()?.clone();
    Some(Event::SignalShown { by: Sender::Wizard, signal, offer: Some(offer.seq) })
}
