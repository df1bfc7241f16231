//! The optional parts of the crate (Cargo features), and which of them this build contains.

use std::fmt;

/// A part of the crate that a build can leave out; each is a Cargo feature of this name.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Feature {
    /// The wizard's console in the terminal.
    Console,
    /// The server of the participant's display.
    Display,
    /// Recordings as MCAP.
    Mcap,
    /// The arm that presses buttons in a physics simulation, and its kinematics.
    Physics,
    /// Streams for Rerun's viewers.
    Rerun,
}

impl Feature {
    /// All optional parts.
    pub const ALL: [Feature; 5] = [Feature::Console, Feature::Display, Feature::Mcap, Feature::Physics, Feature::Rerun];

    /// Whether this build contains the part.
    pub const fn is_built(self) -> bool {
        match self {
            Feature::Console => cfg!(feature = "console"),
            Feature::Display => cfg!(feature = "display"),
            Feature::Mcap => cfg!(feature = "mcap"),
            Feature::Physics => cfg!(feature = "physics"),
            Feature::Rerun => cfg!(feature = "rerun"),
        }
    }

    /// The name of the Cargo feature.
    pub const fn key(self) -> &'static str {
        match self {
            Feature::Console => "console",
            Feature::Display => "display",
            Feature::Mcap => "mcap",
            Feature::Physics => "physics",
            Feature::Rerun => "rerun",
        }
    }

    /// What a build without the part cannot do, in words.
    pub const fn lacks(self) -> &'static str {
        match self {
            Feature::Console => "no session can be run or looked at in the terminal",
            Feature::Display => "the participant's display cannot be served",
            Feature::Mcap => "no recording is exported as MCAP",
            Feature::Physics => "the arm cannot be simulated, and nothing checks that it reaches its buttons",
            Feature::Rerun => "no stream for Rerun's viewers is written or served",
        }
    }

    /// `Err` in a build without it.
    ///
    /// # Errors
    /// This build does not have the part.
    pub const fn require(self) -> Result<(), NotBuilt> {
        if self.is_built() { Ok(()) } else { Err(NotBuilt(self)) }
    }
}

impl fmt::Display for Feature {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str(match self {
            Feature::Console => "the console",
            Feature::Display => "the participant's display",
            Feature::Mcap => "MCAP",
            Feature::Physics => "physics",
            Feature::Rerun => "Rerun",
        })
    }
}

/// The build lacks a part that was asked for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("built without {0}: {lacks}", lacks = .0.lacks())]
pub struct NotBuilt(pub Feature);

impl NotBuilt {
    /// What to do about it.
    pub fn remedy(self) -> String {
        format!("cargo build --release --features {}, or a build with the default features", self.0.key())
    }
}
