//! State of the robot in a session: its present press, its stops, and its arm.

use tomcom_core::base::time::SessionTime;
use tomcom_core::kitchen::ButtonId;
use tomcom_core::robot::ArmSample;
use tomcom_core::robot::SafetyMode;
use tomcom_core::robot::{AbortReason, IdleReason};

/// State of the robot in a session.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct RobotStatus {
    /// The robot's ongoing press: button, start, and expected time of contact.
    pub intention: Option<(ButtonId, SessionTime, SessionTime)>,
    /// Whether the ongoing or last press is part of the robot's initiative.
    pub initiative: bool,
    /// Number of presses that the robot made by its initiative while the trial ran.
    pub initiative_presses: u32,
    /// Whether the robot is stopped, by the wizard or by itself, until the wizard resumes it.
    pub stopped: bool,
    /// Whether the wizard holds the robot before its next press.
    pub held: bool,
    /// The press that the wizard chose for the robot, until the robot has made or aborted that press.
    pub driven_to: Option<ButtonId>,
    /// Why the robot is idle, if it is, and the human's buttons for a press of one of which it waits.
    pub idle: Option<(IdleReason, Vec<ButtonId>)>,
    /// State of the simulated robot arm.
    pub arm: ArmStatus,
}

/// Pose and safety state of the simulated arm.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ArmStatus {
    /// Last sample of the arm's motion with its time; `None` before the first motion and for the timed arm.
    pub last: Option<(SessionTime, ArmSample)>,
    /// The safety mode of the arm: normal, slowed, or stopped for a reason.
    pub mode: SafetyMode,
    /// Contact force that caused a protective stop, in newtons.
    pub stopped_by_n: Option<f64>,
}

impl RobotStatus {
    /// Whether the wizard stopped the robot (also possible after a protective stop).
    pub fn is_stopped_by_wizard(&self) -> bool {
        self.stopped && !self.arm.mode.has_stopped_itself()
    }

    /// The safety mode as screens name it: a stop by the wizard is an emergency stop also of the timed arm, which has no
    /// safety modes of its own.
    pub fn safety_mode(&self) -> SafetyMode {
        if self.is_stopped_by_wizard() { SafetyMode::EmergencyStop } else { self.arm.mode }
    }

    /// Records that the robot starts a press and will touch the button at `until`.
    pub(super) fn sets_out(&mut self, button: ButtonId, now: SessionTime, until: SessionTime, initiative: bool) {
        self.intention = Some((button, now, until));
        self.initiative = initiative;
        self.idle = None;
    }

    pub(super) fn gives_up(&mut self, reason: AbortReason) {
        self.intention = None;
        // If the wizard chose another press for the robot, that press is still pending.
        self.driven_to = self.driven_to.filter(|_| reason == AbortReason::Driven);
    }

    /// Records the end of the trial: the robot has no press and is not idle for a reason.
    pub(super) fn rests(&mut self) {
        self.intention = None;
        self.driven_to = None;
        self.idle = None;
    }
}
