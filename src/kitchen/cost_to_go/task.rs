//! Tasks of a goal: bringing a part to the board, or serving a complete stack.

/// Place of a part that is still in a storage.
pub const STORAGE: u8 = u8::MAX;

/// A task: a part to bring to the board, or a complete stack to serve.
#[derive(Clone, Copy, Debug, Default)]
pub struct AssemblyTask {
    /// The index of the target.
    pub target: u8,
    /// Bit set of the target's items in it; all bits for a complete stack.
    pub bits: u8,
    /// Its present location, or [`STORAGE`].
    pub at: u8,
}
