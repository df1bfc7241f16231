//! What the robot does in a session, and how its arm stands.

use crate::base::time::SessionTime;
use crate::kitchen::ButtonId;
use crate::robot::moment::ArmSample;
use crate::robot::safety::SafetyMode;
use crate::robot::{AbortReason, IdleReason};

/// What the robot does.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct RobotStatus {
    /// The press that the arm is busy with, since when, and when it will touch the button.
    pub intention: Option<(ButtonId, SessionTime, SessionTime)>,
    /// Stopped, by the wizard or by itself, until the wizard lets it go on.
    pub stopped: bool,
    /// Held by the wizard before its next press.
    pub held: bool,
    /// The press that the wizard drives the robot to, until it is made or given up.
    pub driven_to: Option<ButtonId>,
    /// Why it does nothing, if it does nothing.
    pub idle: Option<IdleReason>,
    /// The arm in the physics.
    pub arm: ArmStatus,
}

/// How the arm in the physics stands, and how safe it is.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ArmStatus {
    /// What was told of it last, and when; nothing before it moves first, and of a timed arm.
    pub last: Option<(SessionTime, ArmSample)>,
    pub mode: SafetyMode,
    /// Why it stopped by itself: the force that it felt, in newtons.
    pub stopped_by_n: Option<f64>,
}

impl RobotStatus {
    /// Whether the wizard has stopped it. An arm that stopped by itself can still be stopped by the wizard.
    pub fn is_stopped_by_wizard(&self) -> bool {
        self.stopped && !self.arm.mode.has_stopped_itself()
    }

    /// It is on its way to a button, and will touch it at `until` if nothing comes between.
    pub(super) fn sets_out(&mut self, button: ButtonId, now: SessionTime, until: SessionTime) {
        self.intention = Some((button, now, until));
        self.idle = None;
    }

    pub(super) fn gives_up(&mut self, reason: AbortReason) {
        self.intention = None;
        // What the wizard drives it to is still to come.
        self.driven_to = self.driven_to.filter(|_| reason == AbortReason::Driven);
    }

    /// The trial is over.
    pub(super) fn rests(&mut self) {
        self.intention = None;
        self.driven_to = None;
        self.idle = None;
    }
}
