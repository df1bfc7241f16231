//! Joint angles of the timed robot arm between presses. The time at which the arm touches a button is drawn at random;
//! this module interpolates the joint angles with a quintic (Craig, Introduction to Robotics), so that the arm moves
//! slowly at both ends of each leg: up from the last button, across, and down on the next button.

use tomcom_core::base::time::SessionTime;
use tomcom_core::kitchen::{Agent, Button, ButtonId, Kitchen};
use tomcom_core::robot::{JOINTS, JointAngles};

use crate::clearance::ArmSurroundings;
use crate::kinematics::SerialArm;
use crate::reach::{BENT, ButtonPoses};

/// Share of the motion's duration in which the arm goes up (first), and share in which the arm goes down (last).
const UP: f64 = 0.15;
const DOWN: f64 = 0.2;
/// Duration of the arm's motion upwards if there is no next button, in seconds.
const UP_S: f64 = 0.4;
/// The joint angles of the timed robot arm over time.
#[derive(Clone, Debug)]
pub struct JointMotion {
    /// Poses of the arm at each of the robot's buttons; none if the button is out of reach, in which case the arm stays
    /// where it is.
    buttons: Vec<Option<ButtonPoses>>,
    /// Waypoints of the arm's motion with their times; never empty.
    way: Vec<(SessionTime, JointAngles)>,
    /// The button on which the arm's tip is down, so that the arm has to go up first.
    down_on: Option<ButtonId>,
}

impl JointMotion {
    /// A timed robot arm at rest above the middle of its buttons.
    pub fn new(kitchen: &Kitchen, arm: &SerialArm) -> JointMotion {
        let around = ArmSurroundings { table_m: kitchen.table_height_m, obstacles: Vec::new() };
        let at_button = |button: &Button| arm.at_button(button.at_m, &around).ok();
        let buttons: Vec<Option<ButtonPoses>> = kitchen.buttons[Agent::Robot.index()].iter().map(at_button).collect();
        let above: Vec<&JointAngles> = buttons.iter().flatten().map(|poses| &poses.above).collect();
        let mean = |joint: usize| above.iter().map(|pose| pose[joint]).sum::<f64>() / above.len() as f64;
        let rest = if above.is_empty() { BENT } else { std::array::from_fn(mean) };
        JointMotion { buttons, way: vec![(SessionTime::ZERO, rest)], down_on: None }
    }

    /// The joint angles of the arm at a time.
    pub fn at(&self, now: SessionTime) -> JointAngles {
        let next = self.way.partition_point(|(time, _)| *time <= now);
        let ((since, from), Some((until, to))) = (self.way[next.saturating_sub(1)], self.way.get(next)) else {
            return self.way[next - 1].1;
        };
        let length_s = until.secs_since(since);
        let share = if length_s > 0.0 { (now.secs_since(since) / length_s).clamp(0.0, 1.0) } else { 1.0 };
        let eased = share.powi(3) * (10.0 - 15.0 * share + 6.0 * share * share);
        std::array::from_fn::<f64, JOINTS, _>(|joint| from[joint] + (to[joint] - from[joint]) * eased)
    }

    /// The time at which the arm comes to rest if nothing interrupts its motion.
    pub fn rests_at(&self) -> SessionTime {
        self.way.last().map_or(SessionTime::ZERO, |(time, _)| *time)
    }

    /// Starts a motion of the arm that touches the button at the time `until`.
    pub fn set_out(&mut self, now: SessionTime, button: ButtonId, until: SessionTime) {
        let Some(Some(goal)) = self.buttons.get(button.index()).copied() else { return };
        let takes_s = until.secs_since(now).max(0.0);
        let after = |share: f64| now + SessionTime::from_secs_f64(takes_s * share);
        let here = self.at(now);
        let mut way = vec![(now, here)];
        if let Some(ButtonPoses { above, .. }) = self.poses_below().filter(|poses| poses.above != here) {
            way.push((after(UP), above));
        }
        way.extend([(after(1.0 - DOWN), goal.above), (until.max(now), goal.touching)]);
        self.way = way;
        self.down_on = Some(button);
    }

    /// Moves the arm up after a press was made or abandoned; an arm that is still on its way to a button just stops.
    pub fn go_up(&mut self, now: SessionTime) {
        let here = self.at(now);
        let goes_down = self.way.iter().rev().nth(1).is_none_or(|(since, _)| *since <= now);
        match self.poses_below().filter(|_| goes_down) {
            Some(ButtonPoses { above, .. }) => {
                self.way = vec![(now, here), (now + SessionTime::from_secs_f64(UP_S), above)];
            }
            None => {
                self.way = vec![(now, here)];
                self.down_on = None;
            }
        }
    }

    /// Stops the arm where it is.
    pub fn stand(&mut self, now: SessionTime) {
        self.way = vec![(now, self.at(now))];
    }

    fn poses_below(&self) -> Option<ButtonPoses> {
        self.down_on.and_then(|button| self.buttons[button.index()])
    }
}
