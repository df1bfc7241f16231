//! The tasks that serve the targets: a part to bring to the board, or a complete stack to serve.

/// The place of a part that is still in a storage.
pub const STORAGE: u8 = u8::MAX;

/// One part to bring to the board, or a complete stack to serve.
#[derive(Clone, Copy, Debug, Default)]
pub struct AssemblyTask {
    pub target: u8,
    /// Which items of the target it is; all of them: a complete stack.
    pub bits: u8,
    /// Where it is now, or [`STORAGE`].
    pub at: u8,
}
