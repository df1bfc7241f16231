//! A recording in which wizard and assistants were compared from its first event to its last.

use super::exclusion_status::ExclusionStatus;
use super::offer_summary::{OfferSummary, TimedOffer};
use super::watcher::{CompareRequest, ComparisonFollower};
use super::wizard_log::{WizardLog, WizardSummary};
use crate::history::comparison::LaneComparison;
use crate::kitchen::Kitchen;
use crate::session::apply::ApplyError;
use crate::session::settings::Condition;
use crate::session::{Session, Stamped};

/// Follows a recording, event by event.
pub struct RecordingComparer {
    follower: ComparisonFollower,
    wizard: WizardLog,
}

impl RecordingComparer {
    /// Of a session from before its first event on.
    pub fn new(session: Session, request: &CompareRequest) -> RecordingComparer {
        RecordingComparer { follower: ComparisonFollower::new(session, request), wizard: WizardLog::default() }
    }

    /// Applies the next event.
    ///
    /// # Errors
    /// The event cannot be at this point.
    pub fn add(&mut self, stamped: &Stamped) -> Result<(), ApplyError> {
        self.follower.apply(stamped)?;
        self.wizard.note(stamped, &self.follower.follower.session);
        Ok(())
    }

    /// The session as it is now.
    pub fn session(&self) -> &Session {
        &self.follower.follower.session
    }

    /// Nothing more comes of the recording, which goes by this name.
    pub fn finish(mut self, recording: String, standing: ExclusionStatus) -> ComparedRecording {
        self.follower.finish();
        let comparison = self.follower.comparison(true);
        let is_wizards = self.session().spec.trial.condition == Condition::Wizard;
        let wizard = is_wizards.then(|| self.wizard.figures(&self.follower.follower));
        let offers = self.session().makes_offers.then(|| TimedOffer::visible(self.session()));
        let offers = offers.map(|offers| OfferSummary::from_offers(&offers));
        ComparedRecording { recording, follower: self.follower, standing, comparison, wizard, offers }
    }
}

/// A recording that was followed to its end.
pub struct ComparedRecording {
    /// Its path, as it was named.
    pub recording: String,
    /// The session at its end, with what assistants advised.
    pub follower: ComparisonFollower,
    /// Whether the trial counts in the analysis.
    pub standing: ExclusionStatus,
    /// Wizard and assistants side by side.
    pub comparison: LaneComparison,
    /// None where nobody could send signals.
    pub wizard: Option<WizardSummary>,
    /// Offers that a wizard could see; `None` in recordings without offers.
    pub offers: Option<OfferSummary>,
}

impl ComparedRecording {
    /// The kitchen of the recording.
    pub fn kitchen(&self) -> &Kitchen {
        &self.follower.follower.session.kitchen
    }
}
