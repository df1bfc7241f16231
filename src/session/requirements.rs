//! The optional parts of the crate that a session needs.

use super::settings::{ArmKind, ParticipantKind, SessionSpec};
use crate::base::features::{Feature, NotBuilt};

impl SessionSpec {
    /// Whether this build can run the session without a console (it may need the simulated arm).
    ///
    /// # Errors
    /// The missing part.
    pub const fn require_built(&self) -> Result<(), NotBuilt> {
        match self.robot.arm {
            ArmKind::Physics => Feature::Physics.require(),
            ArmKind::Timed => Ok(()),
        }
    }

    /// Whether this build can run the session at the console.
    ///
    /// # Errors
    /// The missing part.
    pub fn require_built_live(&self) -> Result<(), NotBuilt> {
        self.require_built()?;
        match self.participant.kind {
            ParticipantKind::Display => Feature::Display.require(),
            ParticipantKind::Keyboard | ParticipantKind::Simulated => Ok(()),
        }
    }
}
