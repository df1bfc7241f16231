//! Tells the simulated participant and the scripted wizard about events, and opens and closes offers to a wizard at the
//! console.

use super::SessionEngine;
use crate::accuracy_check::RunningGazeCheck;
use crate::event::SignalEndReason;
use crate::offers;
use crate::{Event, TimestampedEvent};
use tomcom_core::base::time::SessionTime;
use tomcom_core::communication::offer::{OfferedAdvice, OfferedCommunication};
use tomcom_core::communication::recommendation::SignalReason;
use tomcom_core::kitchen::KitchenChange;

impl SessionEngine {
    /// Tells the simulated participant the part of an applied event that a participant can notice.
    pub(super) fn tell_participant(&mut self, stamped: &TimestampedEvent, change: &KitchenChange) {
        let Some(participant) = &mut self.participant else { return };
        let session = &self.follower.session;
        let (now, state) = (stamped.time, session.state);
        if let Some(press) = change.press() {
            participant.on_press(now, &press);
        }
        match &stamped.event {
            Event::TrialStarted => participant.on_trial_start(now, state),
            Event::SignalShown { signal, .. } => {
                if let Some(shown) = &session.shown {
                    participant.on_signal(now, shown.location, signal);
                }
            }
            Event::SignalEnded { reason } => participant.on_signal_end(*reason == SignalEndReason::Outdated),
            Event::Calibration(_) => {
                participant.on_target(now, session.calibration.as_ref().and_then(RunningGazeCheck::target))
            }
            _ => {}
        }
    }

    /// Records the event by which an offer to the wizard opens or closes, if one is due.
    pub(super) fn review_offer(&mut self, now: SessionTime) {
        while let Some(mut event) = offers::due(self.session(), now) {
            // A recommendation states a reason for its first option only; if two orders want the same dish, the offer
            // may be about the other order.
            if let Event::OfferOpened(advice) = &mut event
                && let (None, OfferedCommunication::Signal(signal)) = (&advice.reason, &advice.what)
            {
                let session = &self.follower.session;
                advice.reason = SignalReason::for_signal(&session.kitchen, session.state, self.belief(), signal);
            }
            self.record_own(now, event);
        }
    }

    /// Tells a scripted wizard the part of an applied event that a wizard sees: kitchen, presses, gaze, and offers if
    /// they are shown.
    pub(super) fn tell_wizard(&mut self, stamped: &TimestampedEvent, change: &KitchenChange) {
        let Some(wizard) = &mut self.wizard else { return };
        let session = &self.follower.session;
        let (now, state) = (stamped.time, session.state);
        if let Some(press) = change.human_press() {
            let judged = self.follower.judged.last().filter(|press| press.seq == stamped.seq);
            let is_error = judged.is_some_and(|press| press.verdict.error);
            return wizard.on_human_press(now, &press, is_error, &mut self.follower.cost);
        }
        match &stamped.event {
            Event::TrialStarted => wizard.on_trial_start(state),
            Event::Gaze(sample) => {
                let location = session.looked_at();
                let sees_present = location.is_some_and(|location| session.sees_present_content(location));
                wizard.on_gaze(sample.taken(now), location, sees_present.then_some(state));
            }
            Event::SignalShown { .. } => {
                if let Some(location) = session.shown.as_ref().and_then(|shown| shown.location) {
                    wizard.on_signal(now, location, state);
                }
            }
            Event::OfferOpened(OfferedAdvice { what: OfferedCommunication::Signal(_), visible: true, .. }) => {
                wizard.on_offer(now, stamped.seq);
            }
            _ => {
                if let Some((before, after)) = change.states() {
                    wizard.on_change(now, before, after);
                }
            }
        }
    }
}
