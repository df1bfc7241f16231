//! The optional parts of the crate (Cargo features), and which of these parts this build contains.

use std::fmt;

use crate::SessionSpec;
use crate::settings::{ArmKind, ParticipantKind};

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Feature {
    Display,
    Mcap,
    Physics,
    Rerun,
    Ur,
}

impl Feature {
    pub const ALL: [Feature; 5] = [Feature::Display, Feature::Mcap, Feature::Physics, Feature::Rerun, Feature::Ur];

    /// Name in Cargo, whether this build has it, name in words, and what a build without it cannot do.
    const fn about(self) -> (&'static str, bool, &'static str, &'static str) {
        match self {
            Feature::Display => (
                "display",
                cfg!(feature = "display"),
                "the participant's display",
                "neither the participant's display nor the observers' page can be served",
            ),
            Feature::Mcap => ("mcap", cfg!(feature = "mcap"), "MCAP", "no recording is exported as MCAP"),
            Feature::Physics => (
                "physics",
                cfg!(feature = "physics"),
                "physics",
                "the arm cannot be simulated, and nothing checks that it reaches its buttons",
            ),
            Feature::Rerun => {
                ("rerun", cfg!(feature = "rerun"), "Rerun", "no stream for Rerun's viewers is written or served")
            }
            Feature::Ur => (
                "ur",
                cfg!(feature = "ur"),
                "the real arm",
                "neither a real arm can be driven nor the controller of one be simulated",
            ),
        }
    }

    /// What a build without it cannot do.
    pub const fn lacks(self) -> &'static str {
        let (.., lacks) = self.about();
        lacks
    }

    pub const fn require(self) -> Result<(), MissingFeature> {
        let (_, is_built, ..) = self.about();
        if is_built { Ok(()) } else { Err(MissingFeature(self)) }
    }
}

impl fmt::Display for Feature {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (_, _, title, _) = self.about();
        formatter.write_str(title)
    }
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("built without {0}: {lacks}", lacks = .0.lacks())]
pub struct MissingFeature(pub Feature);

impl MissingFeature {
    /// How to get a build that contains it.
    pub fn remedy(self) -> String {
        let (key, ..) = self.0.about();
        format!("cargo build --features {key}, or a build with the default features")
    }
}

impl SessionSpec {
    /// Whether this build can run the session without a console, or read its recordings.
    pub const fn require_built(&self) -> Result<(), MissingFeature> {
        match self.robot.arm {
            ArmKind::Physics => Feature::Physics.require(),
            ArmKind::Timed | ArmKind::Ur(_) => Ok(()),
        }
    }

    /// Whether this build can run the session at the console.
    pub fn require_built_live(&self) -> Result<(), MissingFeature> {
        self.require_built()?;
        if self.robot.arm.is_real() {
            Feature::Ur.require()?;
        }
        match self.participant.kind {
            ParticipantKind::Display => Feature::Display.require(),
            ParticipantKind::Keyboard | ParticipantKind::Simulated | ParticipantKind::External => Ok(()),
        }
    }
}
