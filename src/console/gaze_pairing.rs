//! How senders of gaze at other computers pair, for as long as no gaze arrives.

use crate::base::time::SessionTime;
use crate::session::Session;
use crate::session::preflight_checks::PreflightCheck;

/// What a sender at another computer has to know.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct GazePairing {
    /// Where it sends to: "192.168.1.5:50021".
    pub address: String,
    /// The pairing code.
    pub code: String,
}

impl GazePairing {
    /// The code for the gaze panel, while no gaze arrives.
    pub fn line(&self, session: &Session, now: SessionTime) -> Option<String> {
        session.gaze_hz(now).is_none().then(|| format!("pairing code {}", self.code))
    }

    /// Address and code for the list of checks, while no gaze arrives.
    pub fn check(&self, session: &Session, now: SessionTime) -> Option<PreflightCheck> {
        // The code first: on a small screen the line is cut.
        let found = format!("pairing code {}; send to {}", self.code, self.address);
        session.gaze_hz(now).is_none().then(|| PreflightCheck::ok("gaze pairing", found))
    }
}
