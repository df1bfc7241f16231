//! Equivalence classes of contents: contents with the same use for the present goal are one class, and all contents
//! without use are one class.

/// Largest number of target dishes (ordered dishes that are still to be served), see
/// [`crate::kitchen::compile::MAX_ORDERS`].
pub const MAX_TARGETS: usize = 2;
/// The class of useless contents (obstacles); class 0 is empty.
pub const USELESS: u8 = 1;

/// A state in compact form: for every physical location, by index, the class of its content.
pub type CompactState = [u8; 16];
