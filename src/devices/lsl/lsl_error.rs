//! Errors of the Lab Streaming Layer.

/// Why the Lab Streaming Layer (LSL) cannot be used.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum LslError {
    /// The LSL library cannot be loaded, for this reason.
    #[error("the library of the Lab Streaming Layer (liblsl) cannot be loaded: {0}")]
    Missing(String),
    /// The LSL library lacks a required function.
    #[error("{place} is no liblsl of version 1.17.7 or newer: it lacks {lacks}")]
    Unfit {
        /// Path of the LSL library that lacks the function.
        place: String,
        /// Name of the function that the LSL library lacks.
        lacks: &'static str,
    },
    /// The LSL library refuses to offer the stream of this name.
    #[error("liblsl does not offer the stream {0}")]
    Refused(String),
    /// The sending thread cannot be started, or does not answer in time.
    #[error("the thread for the Lab Streaming Layer cannot be started")]
    NoThread,
}

impl LslError {
    /// Advice for the user about this error of the Lab Streaming Layer.
    pub fn remedy(&self) -> &'static str {
        match self {
            LslError::Missing(_) | LslError::Unfit { .. } => {
                "name it in the session file, under [lsl]: library = \"…/liblsl.so\". The package pylsl has one (pip \
                 install pylsl, folder \
                 pylsl/lib); others are at github.com/sccn/liblsl/releases"
            }
            LslError::Refused(_) | LslError::NoThread => {
                "see docs/lsl.md; without [lsl] in the session file no streams are sent"
            }
        }
    }
}
