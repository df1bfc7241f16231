//! Decides after which events the assistant is asked for advice.

use super::event::Event;
use super::session_state::Session;

/// Whether the assistant is asked for advice after an event that has just been applied: after a press of either agent,
/// after a change of the task without a press, and after further events for which the session's settings ask for
/// advice.
pub fn leads_to_advice(session: &Session, event: &Event) -> bool {
    let leads = match event {
        Event::Press { .. }
        | Event::OrderShown { .. }
        | Event::OrderCleared { .. }
        | Event::KitchenCorrected { .. } => true,
        Event::HumanWaits { .. } => session.spec.assistant.asks_in_silence,
        Event::SeemsUnaware { .. } => session.spec.assistant.asks_by_gaze,
        _ => false,
    };
    leads && session.is_running()
}
