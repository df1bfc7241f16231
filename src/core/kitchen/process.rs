//! Processing steps of the kitchen, such as cutting and cooking.

use super::content::ContentId;
use super::location::LocationId;

/// A processing step of the compiled kitchen.
#[derive(Clone, Debug, PartialEq)]
pub struct ProcessingStep {
    /// The name of the processing step from the recipe file: "cut".
    pub name: String,
    /// Location of the processing step; `None` for the hand of the agent who presses.
    pub place: Option<LocationId>,
    /// Which agents can do the processing step, indexed by [`super::Agent::index`].
    pub agents: [bool; 2],
    /// Pairs of input item and output item: what the processing step makes of each item.
    pub steps: Vec<(ContentId, ContentId)>,
}
