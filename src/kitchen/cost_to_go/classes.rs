//! Classes of contents: for the cost to go only the worth of a content for a goal matters, and all contents that are of no use
//! are one class.

/// At most so many targets, see [`crate::kitchen::compile::MAX_ORDERS`].
pub const MAX_TARGETS: usize = 2;
/// Class 0 is empty, class 1 is of no use.
pub const USELESS: u8 = 1;

/// Classes of the physical locations, by location index.
pub type ContentClasses = [u8; 16];
