//! Looks at locations: for how long the gaze has rested in a location's area since the content there last changed.

use tomcom_core::base::time::SessionTime;
use tomcom_core::kitchen::LocationId;
use tomcom_core::kitchen::state::MAX_LOCATIONS;
use tomcom_session::Session;

/// Least duration of a look after which a location counts as seen, in seconds.
pub const LOOK_S: f64 = 0.1;

/// For each location, the time since which the gaze has been in the location's area without a change there. Times are
/// those at which samples were taken.
#[derive(Clone, Debug, Default)]
pub struct LocationDwells {
    since: [Option<SessionTime>; MAX_LOCATIONS],
}

impl LocationDwells {
    /// Notes a change of a location's content: a look at the earlier content does not count for the new content.
    pub fn changed(&mut self, location: LocationId) {
        self.since[location.index()] = None;
    }

    /// Ends the looks at all locations, because a pause of the trial interrupts looks.
    pub fn interrupted(&mut self) {
        self.since = Default::default();
    }

    /// Notes a usable gaze sample that has just been applied to the session. Returns whether the participant has seen
    /// the location's present content by now. A sample that was taken before the last change there is no look at it.
    pub fn sampled(&mut self, session: &Session, location: LocationId) -> bool {
        let since = &mut self.since[location.index()];
        let taken = session.gaze.looked_at[location.index()].filter(|_| session.sees_present_content(location));
        *since = taken.map(|taken| since.unwrap_or(taken));
        since.zip(taken).is_some_and(|(since, taken)| taken.secs_since(since) >= LOOK_S)
    }
}
