//! The places that the participant keeps in mind to look at.

use std::collections::VecDeque;

use crate::base::time::SessionTime;
use crate::kitchen::LocationId;

/// At most so many places are kept in mind to look at next.
const MOST_GLANCES: usize = 6;

/// The places to look at next, and when each was read last.
#[derive(Clone, Debug, Default)]
pub struct Attention {
    pub glances: VecDeque<LocationId>,
    pub looking_at: Option<LocationId>,
    pub read_at: Vec<SessionTime>,
}

impl Attention {
    /// The next look goes there.
    pub fn first(&mut self, location: LocationId) {
        self.glances.retain(|&other| other != location);
        self.glances.push_front(location);
        self.glances.truncate(MOST_GLANCES);
    }

    /// A look goes there in time.
    pub fn later(&mut self, location: LocationId) {
        if !self.glances.contains(&location) && self.glances.len() < MOST_GLANCES {
            self.glances.push_back(location);
        }
    }
}
