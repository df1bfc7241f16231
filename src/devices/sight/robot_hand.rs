//! The robot's hand on the participant's display, for sessions without a real robot to see. An approaching hand reveals
//! an intention, as a real robot's hand does; the page is told where the hand is now, and never where or when the hand
//! goes.
//!
//! The hand moves from place to place on the display. The timed arm's hand follows a quintic polynomial, which is slow
//! at both ends (Craig, Introduction to Robotics), and arrives when the press is made. The physical arm's hand has
//! covered the same share of its way as the arm's tip has covered of the way to the button, so that the hand slows down
//! and stops with the arm.

use serde::Serialize;

use super::content::button_place;
#[cfg(feature = "physics")]
use tomcom_arm::kinematics::SerialArm;
use tomcom_core::base::maths::eased;
use tomcom_core::base::time::SessionTime;
use tomcom_core::kitchen::{Agent, ButtonId};
#[cfg(feature = "physics")]
use tomcom_core::robot::ArmPhase;
use tomcom_session::wall_display::RobotDepiction;
use tomcom_session::{Session, TrialPhase};

/// Share of the timed arm's motion after which the hand is above its target and begins to go down.
const ABOVE: f64 = 0.85;
/// Time that the hand takes to go up after a press, in seconds.
const UP_S: f64 = 0.3;
/// Time without an intended press after which the hand goes to its resting position, in seconds, and its speed there, in
/// displays per second.
const RESTS_AFTER_S: f64 = 0.5;
const HOME_PER_S: f64 = 0.8;
/// Distance, in metres, below which the physical arm's tip counts as being at its button.
#[cfg(feature = "physics")]
const AT_M: f64 = 1e-3;

/// A motion of the robot's hand to a location or storage on the display.
#[derive(Clone, Copy, Debug)]
struct Motion {
    button: ButtonId,
    /// Session time at which the motion began.
    since: SessionTime,
    from: [f64; 2],
    to: [f64; 2],
    /// Position of the physical arm's tip when the motion began, in metres.
    #[cfg(feature = "physics")]
    tip_from: Option<[f64; 2]>,
    /// Share of the hand's motion that is completed, from 0 to 1.
    done: f64,
}

/// Position of the robot's hand on the display over time.
#[derive(Clone, Debug)]
pub struct RobotHand {
    pose: RobotHandPose,
    /// Resting position: the place of the robot's hand on the display.
    home: [f64; 2],
    motion: Option<Motion>,
    last: SessionTime,
    /// Time since the last intended press, in seconds.
    idle_s: f64,
    #[cfg(feature = "physics")]
    arm: Option<ArmTip>,
}

impl RobotHand {
    /// Creates the hand at its resting position; `None` if the session does not show the hand.
    pub fn new(session: &Session) -> Option<RobotHand> {
        if session.spec.display.arm == RobotDepiction::None {
            return None;
        }
        let kitchen = &session.kitchen;
        let home = kitchen.location(kitchen.hands[Agent::Robot.index()]).display.centre();
        Some(RobotHand {
            pose: RobotHandPose { x: home[0], y: home[1], down: 0.0 },
            home,
            motion: None,
            last: SessionTime::ZERO,
            idle_s: 0.0,
            #[cfg(feature = "physics")]
            arm: ArmTip::of_session(session),
        })
    }

    /// Pose of the hand at a time; calls must not go back in time.
    pub fn at(&mut self, session: &Session, now: SessionTime) -> RobotHandPose {
        let passed_s = now.secs_since(self.last).max(0.0);
        self.last = now;
        if session.phase == TrialPhase::Running {
            self.idle_s = if session.robot.intention.is_some() { 0.0 } else { self.idle_s + passed_s };
            self.go(session, now);
            self.go_down(session, passed_s);
        }
        let is_idle = session.phase == TrialPhase::Running && self.idle_s > RESTS_AFTER_S && !session.robot.stopped;
        if is_idle || matches!(session.phase, TrialPhase::Over(_)) {
            self.go_home(passed_s);
        }
        self.pose.rounded()
    }

    /// Moves the hand on towards the location of the intended press.
    fn go(&mut self, session: &Session, now: SessionTime) {
        let Some((button, since, _)) = session.robot.intention else {
            self.motion = None;
            return;
        };
        let is_same = |motion: &Motion| motion.button == button && motion.since == since;
        let motion = self.motion.filter(is_same).unwrap_or_else(|| Motion {
            button,
            since,
            from: [self.pose.x, self.pose.y],
            to: button_place(session, button),
            #[cfg(feature = "physics")]
            tip_from: self.arm.as_ref().and_then(|arm| arm.at(session)).map(|(tip, _)| tip),
            done: 0.0,
        });
        // A stop of the arm delays the press; the hand never moves back.
        let done = self.share(session, &motion, now).clamp(motion.done, 1.0);
        let travelled = if self.is_physical() { done } else { eased((done / ABOVE).min(1.0)) };
        let along = |axis: usize| motion.from[axis] + (motion.to[axis] - motion.from[axis]) * travelled;
        (self.pose.x, self.pose.y) = (along(0), along(1));
        self.motion = Some(Motion { done, ..motion });
    }

    /// Moves the hand towards its resting position.
    fn go_home(&mut self, passed_s: f64) {
        let (dx, dy) = (self.home[0] - self.pose.x, self.home[1] - self.pose.y);
        let share = (HOME_PER_S * passed_s / dx.hypot(dy).max(1e-9)).min(1.0);
        (self.pose.x, self.pose.y) = (self.pose.x + share * dx, self.pose.y + share * dy);
    }

    /// Share of the hand's motion that is completed at this time.
    fn share(&self, session: &Session, motion: &Motion, now: SessionTime) -> f64 {
        #[cfg(feature = "physics")]
        if let Some(arm) = &self.arm {
            let Some((tip, _)) = arm.at(session) else { return 0.0 };
            let goal = session.kitchen.button(Agent::Robot, motion.button).at_m;
            let apart = |a: [f64; 2], b: [f64; 2]| (a[0] - b[0]).hypot(a[1] - b[1]);
            let (behind, ahead) = (apart(motion.tip_from.unwrap_or(tip), tip), apart(tip, [goal[0], goal[1]]));
            return if ahead < AT_M { 1.0 } else { behind / (behind + ahead) };
        }
        match session.robot.intention {
            Some((_, since, until)) if !session.robot.stopped => {
                now.secs_since(since) / until.secs_since(since).max(1e-3)
            }
            _ => motion.done,
        }
    }

    /// Lowers the hand at the end of a motion, and raises it afterwards.
    fn go_down(&mut self, session: &Session, passed_s: f64) {
        let up = (self.pose.down - passed_s / UP_S).max(0.0);
        #[cfg(feature = "physics")]
        if let Some(arm) = &self.arm {
            let is_down = arm.at(session).is_some_and(|(_, is_down)| is_down);
            self.pose.down = if is_down { 1.0 } else { up };
            return;
        }
        let done = self.motion.map_or(0.0, |motion| motion.done);
        let is_stopped = session.robot.stopped;
        let down = eased(((done - ABOVE) / (1.0 - ABOVE)).max(0.0));
        self.pose.down = if is_stopped { self.pose.down } else { down.max(up) };
    }

    fn is_physical(&self) -> bool {
        #[cfg(feature = "physics")]
        return self.arm.is_some();
        #[cfg(not(feature = "physics"))]
        false
    }
}

/// Kinematics of the session's physical arm, from which the tip's position follows.
#[cfg(feature = "physics")]
#[derive(Clone, Debug)]
struct ArmTip(SerialArm);

#[cfg(feature = "physics")]
impl ArmTip {
    /// The kinematics of a session's arm; `None` if the session has no physical arm.
    pub fn of_session(session: &Session) -> Option<ArmTip> {
        session.spec.robot.arm.has_joints().then(|| ArmTip(SerialArm::ur5()))
    }

    /// Position of the arm's tip at the last recorded pose, in metres in the frame of the arm's base, and whether the
    /// tip is down on a button; `None` before the first pose.
    pub fn at(&self, session: &Session) -> Option<([f64; 2], bool)> {
        let (_, sample) = session.robot.arm.last.as_ref()?;
        let tip = self.0.tip(&sample.joints).translation.vector;
        Some(([tip.x, tip.y], sample.phase == ArmPhase::Presses))
    }
}

/// Pose of the robot's hand on the participant's display.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct RobotHandPose {
    /// Horizontal position of the hand, as a fraction of the display's width.
    pub x: f64,
    /// Vertical position of the hand, as a fraction of the display's height, downwards.
    pub y: f64,
    /// How far the hand is lowered: 0 above the display, 1 at a press.
    pub down: f64,
}

impl RobotHandPose {
    /// The pose rounded to thousandths, which nobody can see, so that a resting hand causes no messages.
    pub(super) fn rounded(self) -> RobotHandPose {
        let to_thousandth = |value: f64| (1000.0 * value).round() / 1000.0;
        RobotHandPose { x: to_thousandth(self.x), y: to_thousandth(self.y), down: to_thousandth(self.down) }
    }
}
