//! Where the tip of the physical arm is on the table.

use crate::arm::kinematics::Arm;
use crate::robot::moment::ArmPhase;
use crate::session::Session;
use crate::session::settings::ArmKind;

/// The physical arm of a session.
#[derive(Clone, Debug)]
pub(super) struct ArmTip(Arm);

impl ArmTip {
    /// The arm of a session, if it is a physical one.
    pub fn of_session(session: &Session) -> Option<ArmTip> {
        (session.spec.robot.arm == ArmKind::Physics).then(|| ArmTip(Arm::ur5()))
    }

    /// The tip at the last recorded pose, in the frame of the arm's base in metres, and whether it is down on a button; `None`
    /// before the first pose.
    pub fn at(&self, session: &Session) -> Option<([f64; 2], bool)> {
        let (_, sample) = session.robot.arm.last.as_ref()?;
        let tip = self.0.tip(&sample.joints).translation.vector;
        Some(([tip.x, tip.y], sample.phase == ArmPhase::Presses))
    }
}
