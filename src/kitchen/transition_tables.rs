//! Tables over contents, from which the kitchen knows what can lie where, what stacks to what, and what a process makes.

use super::content::ContentId;

/// Transition tables over contents, computed once.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct TransitionTables {
    /// Number of contents.
    pub(super) width: usize,
    /// `accepts[location * width + content]`: whether the location takes the content when it is empty.
    pub(super) accepts: Vec<bool>,
    /// `stacks[a * width + b]`: what a and b stacked are; 0 where they do not stack.
    pub(super) stacks: Vec<ContentId>,
    /// `becomes[process * width + content]`: what the content becomes; 0 where the process does nothing to it.
    pub(super) becomes: Vec<ContentId>,
}
