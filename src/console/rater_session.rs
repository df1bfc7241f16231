//! A rater's codes of the errors in a recording.

use crate::kitchen::Kitchen;
use crate::measures::cause_codes::{Code, Codes};

/// The codes of one rater for a recording so far.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct RaterSession {
    /// The rater's name in the file of codes.
    pub rater: String,
    /// Sequence numbers of the errors, in order.
    pub errors: Vec<u64>,
    /// The causes given so far, by press.
    pub codes: Codes,
}

impl RaterSession {
    /// Index of the last error among the first `events` events, where the replay stands.
    pub fn at(&self, events: usize) -> Option<usize> {
        self.errors.partition_point(|&press| press < events as u64).checked_sub(1)
    }

    /// Position and code of the current error in words; `press` describes the error.
    pub fn describe(&self, kitchen: &Kitchen, events: usize, press: &str) -> String {
        let (all, coded) = (self.errors.len(), self.codes.0.len());
        let here = match self.at(events) {
            None => format!("before the first of {all} errors"),
            Some(index) => {
                let said = match self.codes.0.get(&self.errors[index]) {
                    None => "not coded".to_string(),
                    Some(code) => describe(kitchen, code),
                };
                format!("error {} of {all}, {press}: {said}", index + 1)
            }
        };
        format!("{}, {here} ({coded} coded)", self.rater)
    }
}

fn describe(kitchen: &Kitchen, code: &Code) -> String {
    match code {
        Code::Belief(name) => {
            let label = kitchen.location_named(name).map(|location| kitchen.location(location).label());
            format!("wrong about {}", label.unwrap_or_else(|| name.clone()))
        }
        other => other.kind().name().to_string(),
    }
}
