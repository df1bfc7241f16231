//! Comparison of wizard and assistants over one recording, from its first event to its last.

use super::exclusion_status::ExclusionStatus;
use super::offer_summary::{OfferSummary, TimedOffer};
use tomcom_core::kitchen::Kitchen;
use tomcom_core::kitchen::cost_to_go::CostToGo;
use tomcom_session::apply::ApplyError;
use tomcom_session::history::comparison::SenderComparison;
use tomcom_session::settings::Condition;
use tomcom_session::watcher::{SenderComparisonFollower, SenderComparisonSettings};
use tomcom_session::wizard_log::{WizardLog, WizardSummary};
use tomcom_session::{Session, TimestampedEvent};

/// Compares wizard and assistants while a recording is read, event by event.
pub struct SenderComparer {
    follower: SenderComparisonFollower,
    wizard: WizardLog,
}

impl SenderComparer {
    /// The comparer at the beginning of a session, before the session's first event.
    pub fn new(session: Session, request: &SenderComparisonSettings) -> SenderComparer {
        let cost = CostToGo::new(session.kitchen.clone());
        SenderComparer { follower: SenderComparisonFollower::new(session, cost, request), wizard: WizardLog::default() }
    }

    /// Applies the next event of the recording to the session and to the comparison.
    ///
    /// # Errors
    /// The event is not possible in the session's present state.
    pub fn add(&mut self, stamped: &TimestampedEvent) -> Result<(), ApplyError> {
        self.follower.apply(stamped)?;
        self.wizard.note(stamped, &self.follower.follower.session);
        Ok(())
    }

    /// The session after the last event that was added.
    pub fn session(&self) -> &Session {
        &self.follower.follower.session
    }

    /// The result of the comparison, once the last event was added. `recording`: name of the recording.
    pub fn finish(mut self, recording: String, standing: ExclusionStatus) -> RecordingSenderComparison {
        self.follower.finish();
        let comparison = self.follower.comparison(true);
        let is_wizards = self.session().spec.trial.condition == Condition::Wizard;
        let wizard = is_wizards.then(|| self.wizard.figures(&self.follower.follower));
        let offers = OfferSummary::from_offers(&TimedOffer::visible(self.session()));
        RecordingSenderComparison { recording, follower: self.follower, standing, comparison, wizard, offers }
    }
}

/// Result of comparing wizard and assistants over one recording.
pub struct RecordingSenderComparison {
    /// Path of the recording, as the user gave it.
    pub recording: String,
    /// The session at the recording's end, with the assistants' recommendations.
    pub follower: SenderComparisonFollower,
    /// Whether the trial was aborted or excluded from the analysis.
    pub standing: ExclusionStatus,
    /// Comparison of the communications (signals or proposals) of wizard and assistants.
    pub comparison: SenderComparison,
    /// Summary of the wizard's signals; `None` where nobody could send signals.
    pub wizard: Option<WizardSummary>,
    /// Statistics of the offers that a wizard could see.
    pub offers: OfferSummary,
}

impl RecordingSenderComparison {
    /// The kitchen in which the recording was made.
    pub fn kitchen(&self) -> &Kitchen {
        &self.follower.follower.session.kitchen
    }
}
