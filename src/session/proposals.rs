//! Proposed presses (of the concept DEV) on the participant's display: which presses are still to be made, and when the
//! proposal is out of date.

use crate::{Event, Session, TimelineEvent};
use tomcom_core::communication::{Signal, unavailable};
use tomcom_core::kitchen::Agent;

/// Names of the proposed presses that the human has still to make; `None` if no proposal is on the display. After a
/// press of another button, none are left.
pub fn left(session: &Session) -> Option<&[String]> {
    let Signal::Propose(presses) = &session.shown.as_ref()?.signal else { return None };
    let since = session
        .timeline
        .iter()
        .rev()
        .take_while(|entry| !matches!(entry.what, TimelineEvent::Noted(Event::SignalShown { .. })));
    let mut made: Vec<&str> = since
        .filter_map(|entry| match entry.what {
            TimelineEvent::Press { agent: Agent::Human, button, .. } => {
                Some(session.kitchen.button(Agent::Human, button).name.as_str())
            }
            _ => None,
        })
        .collect();
    made.reverse();
    let is_followed = made.len() <= presses.len() && made.iter().zip(presses).all(|(made, proposed)| *made == proposed);
    Some(if is_followed { &presses[made.len()..] } else { &[] })
}

/// Its presses were made, another button was pressed, or the next one would have no effect.
pub fn is_outdated(session: &Session) -> bool {
    let Some(left) = left(session) else { return false };
    unavailable(&session.kitchen, session.state, &Signal::Propose(left.to_vec())).is_some()
}

/// Whether presses were proposed since the human's last press: an error gets one proposal only.
pub(crate) fn was_made(session: &Session) -> bool {
    let newest = session.timeline.iter().rev().find(|entry| match &entry.what {
        TimelineEvent::Press { agent, .. } => *agent == Agent::Human,
        TimelineEvent::Noted(Event::SignalShown { signal, .. }) => matches!(signal, Signal::Propose(_)),
        _ => false,
    });
    newest.is_some_and(|entry| matches!(entry.what, TimelineEvent::Noted(Event::SignalShown { .. })))
}
