//! The moments at which the assistant is asked for advice.

use super::event::Event;
use super::session_state::Session;

/// Whether advice is requested after an event that has just been applied: a press of either agent, a change of the task without a
/// press, and what the session's settings add to these.
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
