//! Details of a trial from which tables and summary follow, but which are too large to be kept in memory for every
//! trial of a study: the analysis keeps them in temporary files and reads them trial by trial.

use serde::{Deserialize, Serialize};

use super::concept_totals::ConceptPreventionCounts;
use crate::analysis::offer_summary::TimedOffer;
use crate::analysis::probe_record::ProbedTrial;
use tomcom_core::measures::matching::CommunicationEvent;

/// Details of a trial beside its statistics.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct TrialDetails {
    /// Offers that a wizard could see; empty in recordings without offers.
    pub offers: Vec<TimedOffer>,
    /// In wizard trials: the communications that were sent, and those that the assistant would have sent.
    pub lanes: Option<[Vec<CommunicationEvent>; 2]>,
    /// In unassisted trials with known beliefs: what each concept would have prevented, for each value of its
    /// parameter.
    pub swept: Vec<ConceptPreventionCounts>,
    /// Freeze probes of the trial with their questions and answers; `None` without probes.
    pub probes: Option<ProbedTrial>,
}
