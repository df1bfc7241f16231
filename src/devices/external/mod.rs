//! Connections to external minds: child processes, and programs of this computer that listen on a port. Nothing of a
//! program can stop a session: lines are bounded, queues are bounded, and nothing is waited for but by the caller.

mod child;
mod lines;
mod peer;

use tomcom_core::communication::settings::ExternalMind;
use tomcom_session::Session;
use tomcom_session::external::{ExternalMinds, MindConnection};

use crate::sight::{scene, sight};

/// How a setting names a program that listens.
const TCP: &str = "tcp://";

/// Starts programs on this computer.
#[derive(Clone, Copy, Debug)]
pub struct LocalMinds;

impl ExternalMinds for LocalMinds {
    fn open(&self, mind: &ExternalMind) -> Result<MindConnection, String> {
        match mind.external.trim().strip_prefix(TCP) {
            Some(address) => peer::connect(address),
            None => child::start(&mind.external),
        }
    }

    fn sight(&self, session: &Session) -> [serde_json::Value; 2] {
        // Both are plain data with texts as keys, so nothing can fail.
        [serde_json::to_value(scene(session)), serde_json::to_value(sight(session))].map(Result::unwrap_or_default)
    }
}
