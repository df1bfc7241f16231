//! Position of the physical arm's tip on the table.

use tomcom_arm::kinematics::SerialArm;
use tomcom_core::robot::ArmPhase;
use tomcom_session::Session;
use tomcom_session::settings::ArmKind;

/// Kinematics of the session's physical arm, from which the tip's position follows.
#[derive(Clone, Debug)]
pub(super) struct ArmTip(SerialArm);

impl ArmTip {
    /// The kinematics of a session's arm; `None` if the session has no physical arm.
    pub fn of_session(session: &Session) -> Option<ArmTip> {
        (session.spec.robot.arm == ArmKind::Physics).then(|| ArmTip(SerialArm::ur5()))
    }

    /// Position of the arm's tip at the last recorded pose, in metres in the frame of the arm's base, and whether the
    /// tip is down on a button; `None` before the first pose.
    pub fn at(&self, session: &Session) -> Option<([f64; 2], bool)> {
        let (_, sample) = session.robot.arm.last.as_ref()?;
        let tip = self.0.tip(&sample.joints).translation.vector;
        Some(([tip.x, tip.y], sample.phase == ArmPhase::Presses))
    }
}
