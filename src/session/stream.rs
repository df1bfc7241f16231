//! What a session file asks of Rerun: the stream in which a session can be looked at.

use serde::{Deserialize, Serialize};

use super::setting_checks::SettingError;

/// Whether a live session is streamed, and where viewers connect.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct RerunSpec {
    /// Viewers can connect while the session runs.
    pub live: bool,
    /// The stream is written beside the log, as `recording.rrd`.
    pub record: bool,
    /// The address at which viewers connect; where its port is taken, one of the next is used.
    pub address: String,
}

impl Default for RerunSpec {
    fn default() -> Self {
        RerunSpec { live: true, record: true, address: "127.0.0.1:9876".to_string() }
    }
}

impl RerunSpec {
    /// Whether anything is to be streamed.
    pub fn is_on(&self) -> bool {
        self.live || self.record
    }

    pub(super) fn check(&self) -> Result<(), SettingError> {
        let is_address = self.address.rsplit_once(':').is_some_and(|(host, port)| {
            let is_host = !host.is_empty() && host.chars().all(|c| c.is_ascii_hexdigit() || "[].:".contains(c));
            is_host && port.parse::<u16>().is_ok_and(|port| port > 0)
        });
        let found = || format!("address = \"{}\"", self.address);
        let remedy =
            "an address of this machine and a port, such as \"127.0.0.1:9876\"; \"0.0.0.0:9876\" for all networks";
        if is_address { Ok(()) } else { Err(SettingError::new("rerun.address", found(), remedy)) }
    }
}
