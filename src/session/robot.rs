//! The robot in a session: its settings, what it does, and how its arm stands.

use serde::{Deserialize, Serialize};

use super::apply::note;
use super::{Event, Session, TimelineEvent};
use crate::base::time::SessionTime;
use crate::kitchen::ButtonId;
use crate::robot::moment::ArmSample;
use crate::robot::safety::SafetyMode;
use crate::robot::{AbortReason, IdleReason};

/// How the robot's presses come about.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum ArmKind {
    /// They take a while by chance; the arm is only shown.
    #[default]
    Timed,
    /// A simulated arm makes them, in the physics: it slows near the human's hand, and stops when it touches it.
    Physics,
}

impl ArmKind {
    /// As it stands in files.
    pub fn name(self) -> &'static str {
        match self {
            ArmKind::Timed => "timed",
            ArmKind::Physics => "physics",
        }
    }

    fn is_timed(&self) -> bool {
        *self == ArmKind::Timed
    }
}

/// The robot.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct RobotSpec {
    /// Its arm; where nothing is said, and in recordings of before there was another one, it is timed.
    #[serde(skip_serializing_if = "ArmKind::is_timed")]
    pub arm: ArmKind,
    /// Of the timed arm: median duration of a press in seconds.
    pub press_s: f64,
    /// Of the timed arm: the standard deviation of the logarithm of the duration.
    pub press_spread: f64,
}

impl Default for RobotSpec {
    fn default() -> Self {
        RobotSpec { arm: ArmKind::Timed, press_s: 2.4, press_spread: 0.15 }
    }
}

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

/// What is told of the arm in the physics.
pub(super) fn arm(session: &mut Session, now: SessionTime, event: &Event) {
    match event {
        Event::RobotMoves(moment) => session.robot.arm.last = Some((now, *moment)),
        Event::RobotTouched { force_n } => note(session, now, TimelineEvent::ArmTouched { force_n: *force_n }),
        Event::RobotSafety { mode, force_n, joint } => {
            let arm = &mut session.robot.arm;
            (arm.mode, arm.stopped_by_n) = (*mode, *force_n);
            // Where the wizard stopped it, that is told already.
            if mode.is_stopped() && !session.robot.stopped {
                session.robot.stopped = true;
                session.robot.idle = None;
                note(session, now, TimelineEvent::ArmStopped { mode: *mode, force_n: *force_n, joint: *joint });
            }
        }
        _ => {}
    }
}

/// The wizard stops it, or lets it go on.
pub(super) fn stop(session: &mut Session, now: SessionTime, stopped: bool) {
    session.robot.stopped = stopped;
    session.robot.idle = None;
    note(session, now, if stopped { TimelineEvent::RobotStopped } else { TimelineEvent::RobotResumed });
}

/// The wizard holds it before its next press, or lets it go.
pub(super) fn hold(session: &mut Session, now: SessionTime, held: bool) {
    session.robot.held = held;
    session.robot.idle = None;
    note(session, now, if held { TimelineEvent::RobotHeld } else { TimelineEvent::RobotReleased });
}
