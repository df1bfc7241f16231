//! The participant's button box, which sends each press as a line of text: its events and its state.

use serde::{Deserialize, Serialize};

use crate::Session;
use crate::preflight_checks::PreflightCheck;
use crate::tracker::DeviceConnection;
use tomcom_core::base::text::count;
use tomcom_core::base::time::SessionTime;

/// What can be done about a box that does not open.
pub const REMEDY: &str = "plug the box in, set its path as button_box under [participant], end other programs that use it, and let \
                          this account read it (on Linux by the group dialout)";

/// All are witnesses (only recorded).
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(tag = "what", rename_all = "snake_case")]
pub enum ButtonBoxEvent {
    Connected {
        /// Its path.
        device: String,
    },
    /// It reconnects by itself.
    Lost { reason: String },
    /// Lines that are no presses, told once a second at most.
    Refused {
        lines: u64,
        /// What is wrong with the first of them.
        found: String,
    },
}

impl ButtonBoxEvent {
    pub fn words(&self) -> String {
        match self {
            ButtonBoxEvent::Connected { device } => format!("the button box is connected: {device}"),
            ButtonBoxEvent::Lost { reason } => {
                format!("the button box is not there, and connects by itself once it is: {reason}")
            }
            ButtonBoxEvent::Refused { lines: 1, found } => format!("the button box sent no press: {found}"),
            ButtonBoxEvent::Refused { lines, found } => {
                format!(
                    "the button box sent {} that are no presses; the first: {found}",
                    count(*lines, "line", "lines")
                )
            }
        }
    }
}

#[derive(Clone, Debug, Default, PartialEq)]
pub struct ButtonBoxStatus {
    pub link: DeviceConnection,
    /// The last press that was recorded, with the name of its button.
    pub last: Option<(SessionTime, String)>,
    /// What is wrong with a line, if no press has come since.
    fault: Option<String>,
}

impl ButtonBoxStatus {
    pub(super) fn apply(&mut self, now: SessionTime, event: &ButtonBoxEvent) {
        match event {
            ButtonBoxEvent::Connected { device } => self.link = DeviceConnection::Connected { device: device.clone() },
            ButtonBoxEvent::Lost { reason } => {
                self.link = DeviceConnection::Lost { since: now, reason: reason.clone() };
            }
            ButtonBoxEvent::Refused { found, .. } => self.fault = Some(found.clone()),
        }
    }

    pub(super) fn note_press(&mut self, now: SessionTime, button: &str) {
        (self.last, self.fault) = (Some((now, button.to_string())), None);
    }
}

/// Whether the button box is there, and when its last press came; `None` in a session without one.
pub(crate) fn check(session: &Session, now: SessionTime) -> Option<PreflightCheck> {
    let path = session.spec.participant.button_box.as_ref()?;
    let ButtonBoxStatus { link, last, fault } = &session.button_box;
    let failed = |reason: &str| PreflightCheck::failed("button box", format!("{path}: {reason}"), REMEDY);
    let pressed = match (link, last) {
        (DeviceConnection::Lost { reason, .. }, _) => return Some(failed(reason)),
        (DeviceConnection::Unknown, _) => return Some(failed("it is being opened")),
        (DeviceConnection::Connected { .. }, Some((at, button))) => {
            format!("last press {button}, {:.0} s ago", now.secs_since(*at))
        }
        (DeviceConnection::Connected { .. }, None) => "no press yet".to_string(),
    };
    let remedy = "let the box send a line for each press, at 115200 baud: the name of the button in the layout, or its number there \
                  (gamepad)";
    Some(match fault {
        None => PreflightCheck::ok("button box", format!("{path}, {pressed}")),
        Some(fault) => PreflightCheck::warning("button box", format!("{path}, {pressed}; {fault}"), remedy),
    })
}
