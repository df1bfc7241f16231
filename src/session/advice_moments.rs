//! Decides after which events the assistant is asked for advice.

use super::event::Event;
use super::session_state::Session;

/// Whether the assistant is asked for advice after an event that has just been applied: after a press of either agent,
/// after a change of the task without a press, and while the human has not pressed for unusually long.
pub fn leads_to_advice(session: &Session, event: &Event) -> bool {
    let leads = matches!(
        event,
        Event::Press { .. }
            | Event::OrderShown { .. }
            | Event::OrderCleared { .. }
            | Event::KitchenCorrected { .. }
            | Event::HumanWaits { .. }
    );
    leads && session.is_running()
}
