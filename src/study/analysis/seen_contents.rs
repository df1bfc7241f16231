//! What the participant has last seen at each location, and which content was at each location for how long; follows
//! from gaze, changes and the participant's presses, without any belief estimate.

use tomcom_core::base::time::SessionTime;
use tomcom_core::gaze::{GazeSample, MIN_CONFIDENCE};
use tomcom_core::kitchen::state::MAX_LOCATIONS;
use tomcom_core::kitchen::{KitchenChange, LocationId, State};
use tomcom_session::probes::ProbeEvent;
use tomcom_session::{Event, Session};

#[derive(Clone, Debug, Default)]
struct SeenLocation {
    seen: u8,
    /// Whether somebody else changed the location since the participant last saw it.
    is_changed_unseen: bool,
    has_changed: bool,
    /// Duration, on the trial's clock, for which each content (by its code) was at the location until its last change.
    lay: Vec<(u8, SessionTime)>,
    since: SessionTime,
}

#[derive(Clone, Debug, Default)]
pub struct LastSeenContents {
    locations: [SeenLocation; MAX_LOCATIONS],
    looks: LocationDwells,
}

impl LastSeenContents {
    pub fn note(&mut self, session: &Session, event: &Event, change: &KitchenChange) {
        if let KitchenChange::TrialStarted { after, .. } = change {
            *self = LastSeenContents::default();
            for (index, location) in self.locations.iter_mut().enumerate() {
                location.seen = after.code(LocationId(index as u8));
            }
            return;
        }
        // A pause and a freeze probe interrupt looks.
        if matches!(event, Event::TrialPaused | Event::Probe(ProbeEvent::Begun { .. })) {
            self.looks.interrupted();
        }
        let is_own = change.human_press().is_some();
        // A late sample, or one that arrives again, says nothing about where the gaze is, and ends no look.
        let is_seen = |sample: &GazeSample| {
            sample.confidence >= MIN_CONFIDENCE && !session.is_frozen() && session.gaze.fault.is_none()
        };
        let is_look = matches!(event, Event::Gaze(sample) if is_seen(sample));
        for index in 0..session.kitchen.locations.len() {
            let place = LocationId(index as u8);
            if let Some((before, after)) = change.states().filter(|(one, other)| one.code(place) != other.code(place)) {
                self.changed(session, place, [before, after], is_own);
            }
            if is_look && self.looks.sampled(session, place) {
                let location = &mut self.locations[index];
                (location.seen, location.is_changed_unseen) = (session.state.code(place), false);
            }
        }
    }

    fn changed(&mut self, session: &Session, place: LocationId, [before, after]: [State; 2], is_own: bool) {
        self.looks.changed(place);
        let now = session.trial_clock(session.time);
        let location = &mut self.locations[place.index()];
        location.lay.push((before.code(place), now - location.since));
        (location.since, location.has_changed) = (now, true);
        location.is_changed_unseen = !is_own;
        if is_own {
            location.seen = after.code(place);
        }
    }

    pub fn is_changed_unseen(&self, place: LocationId) -> bool {
        self.locations[place.index()].is_changed_unseen
    }

    pub fn last_seen(&self, place: LocationId) -> u8 {
        self.locations[place.index()].seen
    }

    /// In seconds, without pauses; `None` if the location has not changed in the trial.
    pub fn changed_s(&self, session: &Session, place: LocationId) -> Option<f64> {
        let location = &self.locations[place.index()];
        location.has_changed.then(|| session.trial_clock(session.time).secs_since(location.since))
    }

    pub fn usual(&self, session: &Session, place: LocationId) -> u8 {
        let location = &self.locations[place.index()];
        let present = session.state.code(place);
        let now = session.trial_clock(session.time);
        let of = |code: u8| {
            let before = location.lay.iter().filter(|(other, _)| *other == code).map(|(_, time)| *time);
            let current = if code == present { now - location.since } else { SessionTime::ZERO };
            before.fold(current, |sum, time| sum + time)
        };
        let codes = location.lay.iter().map(|(code, _)| *code);
        codes.fold(present, |best, code| if of(code) > of(best) { code } else { best })
    }
}

/// Least duration of a look after which a location counts as seen, in seconds.
const LOOK_S: f64 = 0.1;

/// Since when the gaze has been at each location without a change there, by the times of samples.
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

    /// Notes a usable sample. Returns whether the present content was seen by now; older samples are no look at it.
    pub(crate) fn sampled(&mut self, session: &Session, location: LocationId) -> bool {
        let since = &mut self.since[location.index()];
        let taken = session.gaze.looked_at[location.index()].filter(|_| session.sees_present_content(location));
        *since = taken.map(|taken| since.unwrap_or(taken));
        since.zip(taken).is_some_and(|(since, taken)| taken.secs_since(since) >= LOOK_S)
    }
}
