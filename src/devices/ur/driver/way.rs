//! The way of the arm, leg by leg: which comes next, what came of the last, and what is given up.

use std::collections::VecDeque;

use tomcom_arm::reach::UnreachableReason;
use tomcom_arm::trajectory::{BELOW_M, LegKind, TrajectoryLeg, way_above, way_down, way_up};
use tomcom_core::kitchen::{Agent, ButtonId};
use tomcom_core::robot::{AbortReason, ArmPhase, ArmStage, JointAngles};
use tomcom_session::Event;

use super::super::client::ArmReading;
use super::super::controller::INPUTS;
use super::{Touch, UrDriver, is_still, tell};

/// Height over a button's top at which a press begins, in metres, and its speed in metres per second.
const PRESS_FROM_M: f64 = 0.01;
const PRESS_M_S: f64 = 0.02;
/// Number of legs in a row that begin elsewhere than where the arm stands, after which it is stopped.
const MOST_MISSES: u32 = 5;

#[derive(Clone, Debug, PartialEq)]
pub(super) struct Leg {
    pub phase: ArmPhase,
    pub presses: bool,
    pub takes_s: f64,
    pub poses: [JointAngles; 4],
}

impl From<&TrajectoryLeg> for Leg {
    fn from(leg: &TrajectoryLeg) -> Leg {
        let phase = match leg.kind {
            LegKind::Up => ArmPhase::Retracts,
            LegKind::Over => ArmPhase::Travels,
            LegKind::Down => ArmPhase::Presses,
        };
        Leg { phase, presses: false, takes_s: leg.takes_s, poses: leg.poses }
    }
}

/// What the legs lead to; the number is the order's.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Task {
    Rest,
    Goes(u32, ButtonId),
    Waits(u32, ButtonId),
    Presses(u32, ButtonId),
    DryRun(VecDeque<ButtonId>),
}

impl UrDriver {
    pub(super) fn drive(&mut self, reading: &ArmReading) {
        if self.drops {
            if !reading.stands || !is_still(reading) {
                return;
            }
            (self.active, self.drops) = (None, false);
        }
        if reading.done == self.number
            && reading.leg == self.number
            && let Some(leg) = self.active.take()
        {
            self.leg_ends(&leg, reading);
        }
        if self.is_outdated() {
            self.give_up_way();
            self.task = Task::Rest;
        }
        let may_move = self.stage == ArmStage::DryRun || self.stage == ArmStage::Ready && !self.order.stands;
        if self.active.is_some() || self.drops || !may_move {
            return;
        }
        if self.legs.is_empty() {
            self.plan(&reading.joints);
        }
        if let Some(leg) = self.legs.pop_front() {
            self.number += 1;
            self.active = Some(leg);
        }
    }

    /// Whether what the arm is about is no longer ordered.
    fn is_outdated(&self) -> bool {
        match self.task {
            Task::Goes(number, _) | Task::Waits(number, _) | Task::Presses(number, _) => {
                self.order.button.is_none() || self.order.number != number
            }
            Task::Rest | Task::DryRun(_) => false,
        }
    }

    pub(super) fn begin_dry_run(&mut self) {
        self.wants_dry_run = false;
        let all = (0..self.poses.len()).map(|number| ButtonId(number as u8));
        self.task = Task::DryRun(all.collect());
        self.to(ArmStage::DryRun, "");
    }

    pub(super) fn give_up_way(&mut self) {
        self.legs.clear();
        self.drops = self.active.is_some();
    }

    fn leg_ends(&mut self, leg: &Leg, reading: &ArmReading) {
        match (reading.result, self.touch) {
            (0, _) => self.misses = 0,
            (1, Some(touch)) if leg.presses => self.click(touch),
            (2, Some(touch)) if leg.presses && touch.button.index() >= INPUTS => self.click(touch),
            (2 | 3, Some(touch)) if leg.presses => {
                if let Task::Presses(number, button) = self.task
                    && !touch.has_clicked
                {
                    self.fail(number, button, AbortReason::NoClick);
                }
                self.task = Task::Rest;
            }
            _ => {
                // The arm is elsewhere, as after somebody has pushed it: another way is planned.
                self.legs.clear();
                self.misses += 1;
                if !matches!(self.task, Task::DryRun(_)) {
                    self.task = Task::Rest;
                }
                if self.misses > MOST_MISSES {
                    self.program_ends();
                    self.to(ArmStage::Stopped, "the arm does not stand where its way begins");
                }
            }
        }
    }

    pub(super) fn click(&mut self, touch: Touch) {
        if !touch.has_clicked {
            self.touch = Some(Touch { has_clicked: true, ..touch });
            let button = self.names[touch.button.index()].clone();
            self.waiting.push(tell(Event::Press { agent: Agent::Robot, button, at_ns: None, button_box: false }));
        }
        if let Task::Presses(number, _) = self.task {
            (self.over, self.task) = (number, Task::Rest);
        }
    }

    fn fail(&mut self, number: u32, button: ButtonId, reason: AbortReason) {
        self.over = number;
        let button = self.names[button.index()].clone();
        self.waiting.push(tell(Event::RobotAborts { button, reason }));
    }

    /// Plans the next legs, from where the arm stands.
    fn plan(&mut self, here: &JointAngles) {
        match self.task.clone() {
            Task::DryRun(mut left) => {
                let Some(button) = left.pop_front() else {
                    self.task = Task::Rest;
                    return self.to(ArmStage::Tried, "");
                };
                self.task = Task::DryRun(left);
                if let Err(why) = self.plan_above(here, button) {
                    self.task = Task::Rest;
                    let (name, why) = (&self.names[button.index()], why.words());
                    let found = format!("no clear way to {name}: {why}; guide the arm above the table");
                    self.to(ArmStage::Untried, found);
                }
            }
            Task::Goes(number, button) => {
                self.task = Task::Waits(number, button);
                self.told.0 = None;
            }
            Task::Waits(number, button) => {
                if self.order.may_press {
                    self.plan_press(number, button);
                }
            }
            Task::Presses(..) | Task::Rest => self.plan_next(here),
        }
    }

    fn plan_next(&mut self, here: &JointAngles) {
        let up = match way_up(&self.arm, here, &self.around) {
            Ok(up) => up,
            Err(why) => {
                self.program_ends();
                return self.to(ArmStage::Stopped, format!("no clear way up: {}; guide the arm up", why.words()));
            }
        };
        if !up.is_empty() {
            self.task = Task::Rest;
            return self.legs.extend(up.iter().map(Leg::from));
        }
        self.touch = None;
        let number = self.order.number;
        let Some(button) = self.order.button.filter(|_| number != self.over) else { return };
        match self.plan_above(here, button) {
            Ok(()) => self.task = Task::Goes(number, button),
            Err(why) => self.fail(number, button, why.into()),
        }
    }

    fn plan_above(&mut self, here: &JointAngles, button: ButtonId) -> Result<(), UnreachableReason> {
        let poses = (*self.poses.get(button.index()).unwrap_or(&Err(UnreachableReason::TooFar)))?;
        let way = way_above(&self.arm, here, &poses.above, &self.around)?;
        self.legs.extend(way.iter().map(Leg::from));
        Ok(())
    }

    fn plan_press(&mut self, number: u32, button: ButtonId) {
        let down = |from: &JointAngles, over_m: f64| way_down(&self.arm, from, over_m, &self.around);
        let poses = *self.poses.get(button.index()).unwrap_or(&Err(UnreachableReason::TooFar));
        let way = poses.and_then(|poses| {
            let near = down(&poses.above, PRESS_FROM_M)?;
            let press = down(near.end(), -BELOW_M)?;
            Ok([near, press])
        });
        match way {
            Ok([near, press]) => {
                let takes_s = (PRESS_FROM_M + BELOW_M) / PRESS_M_S;
                self.legs.extend([Leg::from(&near), Leg { presses: true, takes_s, ..Leg::from(&press) }]);
                self.touch = Some(Touch { button, has_clicked: false });
                self.task = Task::Presses(number, button);
            }
            Err(why) => {
                self.fail(number, button, why.into());
                self.task = Task::Rest;
            }
        }
    }
}
