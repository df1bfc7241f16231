//! The optional parts of the crate (Cargo features), and which of these parts this build contains.

use std::fmt;

use crate::SessionSpec;
use crate::settings::{ArmKind, ParticipantKind};

/// An optional part of the crate; each is a Cargo feature of this name.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Feature {
    /// The wizard's console in the terminal.
    Console,
    /// The server of the participant's display.
    Display,
    /// Export of recordings as MCAP files.
    Mcap,
    /// The simulated robot arm that presses buttons in a physics simulation, and its kinematics.
    Physics,
    /// Streams of a session for Rerun's 3D viewers.
    Rerun,
}

impl Feature {
    /// All optional parts of the crate.
    pub const ALL: [Feature; 5] = [Feature::Console, Feature::Display, Feature::Mcap, Feature::Physics, Feature::Rerun];

    /// Whether this build of the program contains the optional part.
    pub const fn is_built(self) -> bool {
        match self {
            Feature::Console => cfg!(feature = "console"),
            Feature::Display => cfg!(feature = "display"),
            Feature::Mcap => cfg!(feature = "mcap"),
            Feature::Physics => cfg!(feature = "physics"),
            Feature::Rerun => cfg!(feature = "rerun"),
        }
    }

    /// The name of the optional part's Cargo feature.
    pub const fn key(self) -> &'static str {
        match self {
            Feature::Console => "console",
            Feature::Display => "display",
            Feature::Mcap => "mcap",
            Feature::Physics => "physics",
            Feature::Rerun => "rerun",
        }
    }

    /// What a build without this optional part cannot do, in words.
    pub const fn lacks(self) -> &'static str {
        match self {
            Feature::Console => "no session can be run or looked at in the terminal",
            Feature::Display => "the participant's display cannot be served",
            Feature::Mcap => "no recording is exported as MCAP",
            Feature::Physics => "the arm cannot be simulated, and nothing checks that it reaches its buttons",
            Feature::Rerun => "no stream for Rerun's viewers is written or served",
        }
    }

    /// Checks that this build contains the optional part.
    ///
    /// # Errors
    /// This build does not contain the part.
    pub const fn require(self) -> Result<(), MissingFeature> {
        if self.is_built() { Ok(()) } else { Err(MissingFeature(self)) }
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

/// Error: this build does not contain the optional part (Cargo feature) that was asked for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("built without {0}: {lacks}", lacks = .0.lacks())]
pub struct MissingFeature(pub Feature);

impl MissingFeature {
    /// How to get a build that contains the missing part, in words.
    pub fn remedy(self) -> String {
        format!("cargo build --release --features {}, or a build with the default features", self.0.key())
    }
}

impl SessionSpec {
    /// Checks that this build can run the session without a console; the simulated arm is an optional part of the
    /// build.
    ///
    /// # Errors
    /// The part of the program that this build lacks.
    pub const fn require_built(&self) -> Result<(), MissingFeature> {
        match self.robot.arm {
            ArmKind::Physics => Feature::Physics.require(),
            ArmKind::Timed => Ok(()),
        }
    }

    /// Checks that this build can run the session at the console.
    ///
    /// # Errors
    /// The part of the program that this build lacks.
    pub fn require_built_live(&self) -> Result<(), MissingFeature> {
        self.require_built()?;
        match self.participant.kind {
            ParticipantKind::Display => Feature::Display.require(),
            ParticipantKind::Keyboard | ParticipantKind::Simulated => Ok(()),
        }
    }
}
