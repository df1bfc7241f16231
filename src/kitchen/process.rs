//! Processing steps: cutting, cooking and their like.

use super::content::ContentId;
use super::location::LocationId;

/// A compiled processing step.
#[derive(Clone, Debug, PartialEq)]
pub struct Process {
    pub name: String,
    /// Where it happens; `None`: in the hand of the agent who presses.
    pub place: Option<LocationId>,
    /// Which agents can do it, indexed by [`super::Agent::index`].
    pub agents: [bool; 2],
    /// From which item to which.
    pub steps: Vec<(ContentId, ContentId)>,
}
