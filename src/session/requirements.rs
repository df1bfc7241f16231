//! Checks that the build contains the optional parts of the program that a session needs.

use super::settings::{ArmKind, ParticipantKind, SessionSpec};
use crate::features::{Feature, MissingFeature};

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
