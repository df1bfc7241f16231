//! Classes of contents: contents with the same use for a goal are one class, and all useless contents are one class.

/// Largest number of targets, see [`crate::kitchen::compile::MAX_ORDERS`].
pub const MAX_TARGETS: usize = 2;
/// Class of useless contents; class 0 is empty.
pub const USELESS: u8 = 1;

/// A state as classes of the contents of the physical locations, by location index.
pub type ContentClasses = [u8; 16];
