//! Events that follow immediately from other events: whether a practice trial (familiarisation) met its criterion, the
//! measured gaze accuracy, the assistant's signal, the end of a proposal.

use super::SessionEngine;
use crate::admit::admit;
use crate::event::SignalEndReason;
use crate::proposals;
use crate::protocol::ProtocolEvent;
use crate::{Event, TrialPhase};
use tomcom_core::base::time::SessionTime;
use tomcom_core::communication::recommendation::Recommendation;
use tomcom_core::communication::{Sender, Signal};
use tomcom_core::kitchen::Agent;

impl SessionEngine {
    /// Records at the end of a practice trial (familiarisation) whether its criterion is met.
    pub(super) fn check_criterion(&mut self, now: SessionTime) {
        let session = self.session();
        let Some((step, protocol)) = session.step() else { return };
        let Some(criterion) = step.criterion.filter(|_| protocol.practice.is_none()) else { return };
        if !matches!(session.phase, TrialPhase::Over(_)) || session.aborted.is_some() {
            return;
        }
        let (orders, presses) = (session.served.len() as u32, session.presses[Agent::Human.index()]);
        let errors = self.follower.errors() as u32;
        let met = criterion.is_met(orders, presses, errors);
        self.record_own(now, Event::Protocol(ProtocolEvent::CriterionChecked { met, orders, presses, errors }));
    }

    /// Removes proposed presses from the participant's display once they are out of date.
    pub(super) fn end_outdated_proposal(&mut self, now: SessionTime) {
        if self.session().is_running() && proposals::is_outdated(self.session()) {
            self.record_own(now, Event::SignalEnded { reason: SignalEndReason::Outdated });
        }
    }

    /// Measures the gaze accuracy after the last target of a gaze accuracy check.
    pub(super) fn measure_calibration(&mut self, now: SessionTime) {
        let session = self.session();
        let event = session.calibration.as_ref().and_then(|check| check.to_measure(&session.viewing()));
        if let Some(event) = event {
            self.record_own(now, Event::Calibration(event));
        }
    }

    /// The signal that the assistant sends because of its recommendation, if the assistant may act. An error gets one
    /// proposal, as long as the error is the human's last press.
    pub(super) fn acted_on(&self, advice: &Recommendation) -> Option<Event> {
        let is_last = |error: u64| self.judged().last().is_some_and(|press| press.seq == error);
        let proposal =
            advice.proposal.as_ref().filter(|one| is_last(one.error) && !proposals::was_made(self.session()));
        let proposal = proposal.map(|one| Signal::Propose(one.presses.clone()));
        let signal = advice.best.clone().or(proposal)?;
        let event = Event::SignalShown { by: Sender::Assistant, signal, offer: None };
        admit(self.session(), &event).is_ok().then_some(event)
    }
}
