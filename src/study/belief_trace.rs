//! Everything in a trial that can change or show the participant's beliefs, in order: changes of the kitchen, looks,
//! signals and the participant's presses. Neither estimates nor recorded beliefs are part of this trace.

use crate::analysis::looks::LocationDwells;
use tomcom_core::base::time::SessionTime;
use tomcom_core::communication::recommendation::aspects_told;
use tomcom_core::gaze::MIN_CONFIDENCE;
use tomcom_core::kitchen::{Agent, AspectId, KitchenChange, LocationId, Press, State};
use tomcom_session::{Event, Session, TimestampedEvent};

/// Event of a trial that can change or show the participant's belief.
#[derive(Clone, Debug, PartialEq)]
pub enum BeliefEvidenceEvent {
    /// The trial starts in a state of the kitchen that the participant knows.
    Started {
        /// State of the kitchen at the trial's start: empty.
        state: State,
    },
    /// Somebody other than the participant changes the kitchen: the robot, a new order, or the wizard's correction.
    Changed {
        /// State of the kitchen before the change.
        before: State,
        /// State of the kitchen after the change.
        after: State,
    },
    /// The gaze has rested on a location long enough to read its present content; noted once for each look and content.
    Looked {
        /// The location at which the participant looked.
        location: LocationId,
    },
    /// A signal tells the participant the true value of these state aspects.
    Told {
        /// The state aspects that the signal is about.
        aspects: Vec<AspectId>,
    },
    /// The participant presses a button.
    Pressed {
        /// Sequence number of the press in the log.
        seq: u64,
        /// The press with the states of the kitchen before and after it.
        press: Press,
    },
}

/// The belief-related events of a trial, collected event by event.
#[derive(Clone, Debug, Default)]
pub struct BeliefEvidence {
    /// The trial's events with their session times, in order.
    pub events: Vec<(SessionTime, BeliefEvidenceEvent)>,
    looks: LocationDwells,
    /// For each location, whether the present look at its present content is already in `events`.
    is_noted: Vec<bool>,
}

impl BeliefEvidence {
    /// Adds an event that has just been applied to the session.
    pub fn note(&mut self, stamped: &TimestampedEvent, change: &KitchenChange, session: &Session) {
        if !session.is_running() && change.states().is_none() {
            // Participants do not read the display during a pause, so looks end.
            self.looks.interrupted();
            return;
        }
        if let Some((before, after)) = change.states() {
            self.is_noted.resize(session.kitchen.locations.len(), false);
            for location in session.kitchen.changed(before, after) {
                self.looks.changed(location);
                self.is_noted[location.index()] = false;
            }
        }
        let traced = match (*change, &stamped.event) {
            (KitchenChange::TrialStarted { after, .. }, _) => Some(BeliefEvidenceEvent::Started { state: after }),
            (KitchenChange::Press { press, .. }, _) if press.agent == Agent::Human => {
                Some(BeliefEvidenceEvent::Pressed { seq: stamped.seq, press })
            }
            (_, Event::SignalShown { signal, .. }) => {
                Some(BeliefEvidenceEvent::Told { aspects: aspects_told(&session.kitchen, session.state, signal) })
            }
            (_, Event::Gaze(sample)) if sample.confidence >= MIN_CONFIDENCE && session.gaze.fault.is_none() => {
                self.looked(stamped.time, session);
                None
            }
            _ => change.states().map(|(before, after)| BeliefEvidenceEvent::Changed { before, after }),
        };
        self.events.extend(traced.map(|event| (stamped.time, event)));
    }

    fn looked(&mut self, now: SessionTime, session: &Session) {
        self.is_noted.resize(session.kitchen.locations.len(), false);
        for (index, is_noted) in self.is_noted.iter_mut().enumerate() {
            let location = LocationId(index as u8);
            let is_seen = self.looks.sampled(session, location);
            if is_seen && !*is_noted {
                self.events.push((now, BeliefEvidenceEvent::Looked { location }));
            }
            *is_noted = is_seen;
        }
    }

    /// Whether the trial has any look of the participant; without gaze data it is unknown what the participant saw.
    pub fn has_looks(&self) -> bool {
        self.events.iter().any(|(_, event)| matches!(event, BeliefEvidenceEvent::Looked { .. }))
    }
}
