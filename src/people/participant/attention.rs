//! Queue of locations at which a simulated participant intends to look.

use std::collections::VecDeque;

use tomcom_core::base::time::SessionTime;
use tomcom_core::kitchen::LocationId;

/// Largest number of locations in the queue of locations to look at.
const MOST_GLANCES: usize = 6;

/// Queue of locations at which a simulated participant intends to look, and the time of the last reading of each
/// location.
#[derive(Clone, Debug, Default)]
pub struct LookQueue {
    /// The locations at which the participant will look next, in order.
    pub glances: VecDeque<LocationId>,
    /// The location at which the participant is looking.
    pub looking_at: Option<LocationId>,
    /// Session time of the participant's last reading of each location.
    pub read_at: Vec<SessionTime>,
}

impl LookQueue {
    /// Puts a location at the front of the queue of locations to look at.
    pub fn first(&mut self, location: LocationId) {
        self.glances.retain(|&other| other != location);
        self.glances.push_front(location);
        self.glances.truncate(MOST_GLANCES);
    }

    /// Puts a location at the end of the queue of locations to look at.
    pub fn later(&mut self, location: LocationId) {
        if !self.glances.contains(&location) && self.glances.len() < MOST_GLANCES {
            self.glances.push_back(location);
        }
    }
}
