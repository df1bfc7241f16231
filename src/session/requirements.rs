//! Which parts of the crate a session needs, and whether this build has them.

use super::settings::{ArmKind, ParticipantKind, SessionSpec};
use crate::base::features::{Feature, NotBuilt};

impl SessionSpec {
    /// Whether this build can run a session of these settings without a console: it takes the part that moves the arm.
    ///
    /// # Errors
    /// It cannot: the part that it lacks.
    pub const fn require_built(&self) -> Result<(), NotBuilt> {
        match self.robot.arm {
            ArmKind::Physics => Feature::Physics.require(),
            ArmKind::Timed => Ok(()),
        }
    }

    /// Whether this build can run such a session at the console.
    ///
    /// # Errors
    /// It cannot: the part that it lacks.
    pub fn require_built_live(&self) -> Result<(), NotBuilt> {
        self.require_built()?;
        match self.participant.kind {
            ParticipantKind::Display => Feature::Display.require(),
            ParticipantKind::Keyboard | ParticipantKind::Simulated => Ok(()),
        }
    }
}
