//! Settings of the stream to the 3D viewer Rerun in a session file.

use serde::{Deserialize, Serialize};

use super::setting_checks::SettingError;

/// Settings of the stream to the 3D viewer Rerun.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct RerunSpec {
    /// Whether Rerun's viewers can connect while the session runs.
    pub live: bool,
    /// Whether the stream to Rerun is also written to `recording.rrd` beside the log.
    pub record: bool,
    /// Network address at which Rerun's viewers connect; if its port is taken, one of the next ports is used.
    pub address: String,
}

impl Default for RerunSpec {
    fn default() -> Self {
        RerunSpec { live: true, record: true, address: "127.0.0.1:9876".to_string() }
    }
}

impl RerunSpec {
    /// Whether the session has a stream to Rerun at all, live or recorded.
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
