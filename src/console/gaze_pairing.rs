//! Pairing code and address for gaze senders at other computers, shown while no gaze arrives.

use tomcom_core::base::time::SessionTime;
use tomcom_session::Session;
use tomcom_session::preflight_checks::PreflightCheck;

/// Address and pairing code that a gaze sender at another computer needs.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct GazePairing {
    /// Network address to which the sender sends its gaze: "192.168.1.5:50021".
    pub address: String,
    /// Pairing code that the sender has to send first.
    pub code: String,
}

impl GazePairing {
    /// Text with the pairing code for the gaze panel, while no gaze arrives.
    pub fn line(&self, session: &Session, now: SessionTime) -> Option<String> {
        session.gaze_hz(now).is_none().then(|| format!("pairing code {}", self.code))
    }

    /// Entry of the preflight list with pairing code and address, while no gaze arrives.
    pub fn check(&self, session: &Session, now: SessionTime) -> Option<PreflightCheck> {
        // The pairing code stands before the address, because small screens cut the line.
        let found = format!("pairing code {}; send gaze to {}", self.code, self.address);
        session.gaze_hz(now).is_none().then(|| PreflightCheck::ok("gaze pairing", found))
    }
}
