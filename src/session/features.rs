//! The optional parts of the crate (Cargo features), and which of these parts this build contains.

use std::fmt;

use crate::SessionSpec;
use crate::settings::{ArmKind, ParticipantKind};

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Feature {
    Console,
    Display,
    Mcap,
    Physics,
    Rerun,
}

impl Feature {
    pub const ALL: [Feature; 5] = [Feature::Console, Feature::Display, Feature::Mcap, Feature::Physics, Feature::Rerun];

    pub const fn is_built(self) -> bool {
        match self {
            Feature::Console => cfg!(feature = "console"),
            Feature::Display => cfg!(feature = "display"),
            Feature::Mcap => cfg!(feature = "mcap"),
            Feature::Physics => cfg!(feature = "physics"),
            Feature::Rerun => cfg!(feature = "rerun"),
        }
    }

    pub const fn key(self) -> &'static str {
        match self {
            Feature::Console => "console",
            Feature::Display => "display",
            Feature::Mcap => "mcap",
            Feature::Physics => "physics",
            Feature::Rerun => "rerun",
        }
    }

    /// What a build without it cannot do.
    pub const fn lacks(self) -> &'static str {
        match self {
            Feature::Console => "no session can be run or looked at in the terminal",
            Feature::Display => "the participant's display cannot be served",
            Feature::Mcap => "no recording is exported as MCAP",
            Feature::Physics => "the arm cannot be simulated, and nothing checks that it reaches its buttons",
            Feature::Rerun => "no stream for Rerun's viewers is written or served",
        }
    }

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

#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("built without {0}: {lacks}", lacks = .0.lacks())]
pub struct MissingFeature(pub Feature);

impl MissingFeature {
    /// How to get a build that contains it.
    pub fn remedy(self) -> String {
        format!("cargo build --release --features {}, or a build with the default features", self.0.key())
    }
}

impl SessionSpec {
    /// Whether this build can run the session without a console.
    pub const fn require_built(&self) -> Result<(), MissingFeature> {
        match self.robot.arm {
            ArmKind::Physics => Feature::Physics.require(),
            ArmKind::Timed => Ok(()),
        }
    }

    /// Whether this build can run the session at the console.
    pub fn require_built_live(&self) -> Result<(), MissingFeature> {
        self.require_built()?;
        match self.participant.kind {
            ParticipantKind::Display => Feature::Display.require(),
            ParticipantKind::Keyboard | ParticipantKind::Simulated => Ok(()),
        }
    }
}
