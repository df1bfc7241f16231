//! Equivalence classes of contents: contents with the same use for the present goal are one class, and all useless
//! contents are one class.

/// Largest number of target dishes (ordered dishes that are still to be served), see
/// [`crate::kitchen::compile::MAX_ORDERS`].
pub const MAX_TARGETS: usize = 2;
/// The class of useless contents; class 0 is empty.
pub const USELESS: u8 = 1;

/// A state in compact form: the class of the content of every physical location, by location index.
pub type ContentClasses = [u8; 16];
