//! Configuration of liblsl (the library of the Lab Streaming Layer): the lab's own configuration file, but without log
//! messages of the library, since the terminal belongs to the console.

use std::path::PathBuf;

use tomcom_session::files::file_error::read_regular;

/// Default name of liblsl's configuration file.
const NAME: &str = "lsl_api.cfg";
/// Text of the table that turns off all of liblsl's log messages except fatal ones.
const QUIET: &str = "\n[log]\nlevel = -3\n";

/// Text of the lab's configuration file for liblsl (empty without a file), with log messages turned off.
pub(super) fn configuration() -> String {
    let named = std::env::var_os("LSLAPICFG").map(PathBuf::from);
    let home = std::env::home_dir().map(|home| home.join("lsl_api").join(NAME));
    let system = PathBuf::from("/etc/lsl_api").join(NAME);
    let places = named.into_iter().chain([PathBuf::from(NAME)]).chain(home).chain([system]);
    quiet(&places.filter_map(|place| read_regular(&place).ok()).next().unwrap_or_default())
}

/// Text of a configuration file in which the table for log messages is replaced by one that turns them off.
fn quiet(text: &str) -> String {
    let mut is_about_messages = false;
    let kept = text.lines().filter(|line| {
        let line = line.trim();
        if let Some(table) = line.strip_prefix('[') {
            is_about_messages = table.trim_end_matches(']').trim() == "log";
        }
        !is_about_messages
    });
    let kept: String = kept.map(|line| format!("{line}\n")).collect();
    kept + QUIET
}

/// Why the Lab Streaming Layer (LSL) cannot be used.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum LslError {
    #[error("the library of the Lab Streaming Layer (liblsl) cannot be loaded: {0}")]
    Missing(String),
    #[error("{place} is no liblsl of version 1.17.7 or newer: it lacks {lacks}")]
    Unfit { place: String, lacks: &'static str },
    #[error("liblsl does not offer the stream {0}")]
    Refused(String),
    /// The sending thread cannot be started, or does not answer in time.
    #[error("the thread for the Lab Streaming Layer cannot be started")]
    NoThread,
}

impl LslError {
    pub fn remedy(&self) -> &'static str {
        match self {
            LslError::Missing(_) | LslError::Unfit { .. } => {
                "name it in the session file, under [lsl]: library = \"…/liblsl.so\". The package pylsl has one (pip \
                 install pylsl, folder \
                 pylsl/lib); others are at github.com/sccn/liblsl/releases"
            }
            LslError::Refused(_) | LslError::NoThread => {
                "see docs/lsl.md; without [lsl] in the session file no streams are sent"
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_labs_configuration_stays_but_for_messages() {
        let text = "[lab]\nKnownPeers = {10.0.0.2}\n[log]\nlevel = 5\nfile = x\n[multicast]\nResolveScope = link\n";
        let wanted = "[lab]\nKnownPeers = {10.0.0.2}\n[multicast]\nResolveScope = link\n\n[log]\nlevel = -3\n";
        assert_eq!(quiet(text), wanted);
        assert_eq!(quiet(""), QUIET);
    }
}
