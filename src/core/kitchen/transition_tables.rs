//! Transition tables of a kitchen: which location accepts which content, what two contents give when stacked, and what
//! a processing step makes of a content.

use super::content::ContentId;

/// Transition tables over contents, computed once for each kitchen.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct TransitionTables {
    /// Number of contents in the kitchen, which is the width of the tables' rows.
    pub(super) width: usize,
    /// `accepts[location * width + content]`: whether the location, when empty, accepts the content.
    pub(super) accepts: Vec<bool>,
    /// `stacks[a * width + b]`: the stack of contents a and b; 0 if these contents cannot be stacked.
    pub(super) stacks: Vec<ContentId>,
    /// `becomes[process * width + content]`: the result of the processing step; 0 if the step does not apply to the
    /// content.
    pub(super) becomes: Vec<ContentId>,
}
