//! Tasks towards a goal of the cost to go: bringing an item to the board, or serving a complete stack.

/// Stands for the location of an item that is still in a storage.
pub const STORAGE: u8 = u8::MAX;

/// A task: an item to bring to the board, or a complete stack to serve.
#[derive(Clone, Copy, Debug, Default)]
pub struct DeliveryTask {
    /// The index of the target dish for which the task is done.
    pub target: u8,
    /// Bit set of the target dish's items that the task provides; all bits for a complete stack.
    pub bits: u8,
    /// The present location of the task's item, or [`STORAGE`].
    pub at: u8,
}
