//! The arm that presses buttons in the physics: a cycle of its controller after the other (125 a second).
//!
//! It goes along its way to a button as fast as it may (`super::separation`): what slows it lets time along the way go by
//! more slowly, so that it stays on a way that was looked at before. It reports what came of it.

use std::collections::VecDeque;

use super::clearance::ArmSurroundings;
use super::kinematics::Arm;
use super::physics::hand::HandPose;
use super::physics::{CYCLE_S, CycleForces, PhysicsWorld};
use super::reach::{ButtonPoses, Unreachable, resting_pose};
use super::report::PressFailure;
use super::separation::{MARGIN_M, mode_near, speed_limit};
use super::touch::ContactTracker;
use super::trajectory::{LegKind, TrajectoryLeg, way_over, way_to, way_up};
use crate::kitchen::{Agent, ButtonId, Kitchen};
use crate::robot::moment::{ArmPhase, JOINTS, JointAngles};
use crate::robot::safety::{SLOWS_M, SafetyMode};

/// How fast it slows and speeds up again: changes of its share of the speed planned for, a second; the second for stops.
const SLOWS: f64 = 10.0;
const STOPS: f64 = 20.0;
const SPEEDS_UP: f64 = 3.0;
/// It looks so far ahead along its way whether it comes nearer to a hand, in seconds.
const AHEAD_S: f64 = 0.08;
/// A hand in the way for so long makes it give its press up, in seconds.
const BLOCKED_S: f64 = 4.0;
/// And for so long out of it before that counts as over.
const FREE_S: f64 = 0.25;
/// A joint so far from where it was told to be, in radians, for so many cycles, is at fault.
const ASTRAY_RAD: f64 = 0.05;
const ASTRAY_CYCLES: u32 = 3;
/// Down on a button that has not clicked it waits so long, in seconds.
const CLICKS_WITHIN_S: f64 = 0.1;
/// Below this speed of every joint it stands still, in radians a second.
pub const STILL_RAD_S: f64 = 0.02;

/// A hand further away than this matters to nothing, in metres.
const FAR_M: f64 = SLOWS_M + MARGIN_M + 0.02;

/// A cycle, and what came of it.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ControlCycle {
    /// This button clicked: it is pressed, also where the arm was about to give that up.
    pub clicked: Option<ButtonId>,
    pub report: Option<PressFailure>,
    pub felt: CycleForces,
    /// Somebody touched it a moment ago, with this force in newtons at most so far. Every contact is told so, once; one of
    /// more force than [`SafetyMode::threshold_n`] has stopped it by then ([`PressFailure::Contact`]).
    pub touched_n: Option<f64>,
}

/// The arm.
#[derive(Clone, Debug)]
pub struct PhysicalArm {
    arm: Arm,
    world: PhysicsWorld,
    around: ArmSurroundings,
    /// Where it stands while there is nothing to do.
    home: JointAngles,
    buttons: Vec<Result<ButtonPoses, Unreachable>>,
    way: VecDeque<TrajectoryLeg>,
    /// How far it is on the first leg, in seconds of that leg.
    since_s: f64,
    /// Share of the planned speed.
    rate: f64,
    /// The last command.
    here: JointAngles,
    goal: Option<ButtonId>,
    may_press: bool,
    /// It gave its press up, and slows down to go up.
    halts: bool,
    pub mode: SafetyMode,
    /// Whether it slows near hands; without, it only feels them.
    pub watches_hands: bool,
    /// How long it waits for a hand in its way, or for a button to click.
    waited_s: f64,
    /// How long no hand is in its way.
    free_s: f64,
    astray: u32,
    touch: ContactTracker,
}

impl PhysicalArm {
    /// An arm at rest above the middle of its buttons.
    pub fn new(kitchen: &Kitchen) -> PhysicalArm {
        let arm = Arm::ur5();
        let around = ArmSurroundings { table_m: kitchen.table_height_m, obstacles: Vec::new() };
        let places: Vec<[f64; 2]> = kitchen.buttons[Agent::Robot.index()].iter().map(|button| button.at_m).collect();
        let buttons: Vec<_> = places.iter().map(|&place| arm.at_button(place, &around)).collect();
        // Over those that are its alone it is out of the human's way.
        let is_shared = |place: &[f64; 2]| kitchen.buttons[Agent::Human.index()].iter().any(|it| it.at_m == *place);
        let own =
            places.iter().zip(&buttons).filter(|(place, _)| !is_shared(place)).filter_map(|(_, at)| at.as_ref().ok());
        let here = resting_pose(&own.collect::<Vec<_>>());
        let world = PhysicsWorld::new(&arm, &here, &places, around.table_m);
        let mode = SafetyMode::default();
        let (way, since_s, rate) = (VecDeque::new(), 0.0, 0.0);
        let (goal, may_press, halts, watches_hands, waited_s, astray) = (None, false, false, true, 0.0, 0);
        PhysicalArm {
            arm,
            world,
            around,
            home: here,
            buttons,
            way,
            since_s,
            rate,
            here,
            goal,
            may_press,
            halts,
            mode,
            watches_hands,
            waited_s,
            free_s: 0.0,
            astray,
            touch: ContactTracker::default(),
        }
    }

    /// Sets out for a button, from a standstill; how long it takes until it clicks if nothing comes between, in seconds.
    ///
    /// # Errors
    /// Why it cannot.
    pub fn set_out(&mut self, button: ButtonId) -> Result<f64, Unreachable> {
        self.way = self.way_to(button)?.into();
        self.goal = Some(button);
        (self.since_s, self.rate, self.waited_s, self.may_press) = (0.0, 0.0, 0.0, false);
        self.halts = false;
        Ok(self.way.iter().map(|leg| leg.takes_s).sum::<f64>())
    }

    /// How long it would take to a button from where it is, in seconds.
    ///
    /// # Errors
    /// Why it could not.
    pub fn takes_s(&self, button: ButtonId) -> Result<f64, Unreachable> {
        Ok(self.way_to(button)?.iter().map(|leg| leg.takes_s).sum())
    }

    fn way_to(&self, button: ButtonId) -> Result<Vec<TrajectoryLeg>, Unreachable> {
        let at = (*self.buttons.get(button.index()).unwrap_or(&Err(Unreachable::TooFar)))?;
        way_to(&self.arm, &self.here, &at, &self.around)
    }

    /// Puts something in its surroundings that it plans its ways around.
    pub fn around(&mut self) -> &mut ArmSurroundings {
        &mut self.around
    }

    /// The bodies.
    pub fn world(&mut self) -> &mut PhysicsWorld {
        &mut self.world
    }

    /// It may press the button above which it stands.
    pub fn press(&mut self) {
        self.may_press = true;
    }

    /// Has done with its press: slows down, and goes up where it is.
    pub fn give_up(&mut self) {
        self.goal = None;
        self.waited_s = 0.0;
        self.halts = true;
        if self.rate == 0.0 {
            self.go_up();
        }
    }

    /// Whether it stands elsewhere than where it waits, with nothing to do.
    pub fn is_out(&self) -> bool {
        let is_away = (0..JOINTS).any(|joint| (self.here[joint] - self.home[joint]).abs() > 1e-3);
        self.way.is_empty() && !self.mode.is_stopped() && is_away
    }

    /// Goes where it waits; where it cannot, it waits where it is.
    pub fn go_home(&mut self) {
        match way_over(&self.arm, &self.here, &self.home, &self.around) {
            Ok(way) => (self.way, self.since_s, self.rate) = (way.into(), 0.0, 0.0),
            Err(_) => self.home = self.here,
        }
    }

    /// Whether it moves without a button to press.
    pub fn withdraws(&self) -> bool {
        self.goal.is_none() && self.rate > 0.0
    }

    /// Whether it still slows down, before it can set out for something else.
    pub fn halts(&self) -> bool {
        self.halts
    }

    fn go_up(&mut self) {
        (self.since_s, self.halts) = (0.0, false);
        self.way = way_up(&self.arm, &self.here, &self.around).unwrap_or_default().into();
    }

    /// Stops where it is, as fast as it can, until [`Self::resume`].
    pub fn stop(&mut self, mode: SafetyMode) {
        self.mode = mode;
        self.goal = None;
    }

    /// The wizard lets it go on: up, and then wherever it sets out for.
    pub fn resume(&mut self) {
        if self.mode.is_stopped() {
            self.mode = SafetyMode::Normal;
            (self.astray, self.rate) = (0, 0.0);
            self.here = self.world.joints().0;
            self.give_up();
        }
    }

    /// What it does.
    pub fn phase(&self) -> ArmPhase {
        match (self.way.front(), self.goal) {
            (None, _) => ArmPhase::Rests,
            (Some(leg), Some(_)) if leg.kind == LegKind::Down && !self.may_press => ArmPhase::Hovers,
            (Some(leg), _) => match leg.kind {
                LegKind::Up => ArmPhase::Retracts,
                LegKind::Over => ArmPhase::Travels,
                LegKind::Down => ArmPhase::Presses,
            },
        }
    }

    /// Whether its next cycle changes anything: it has a way to go and may, or it is not at rest yet.
    pub fn is_busy(&self) -> bool {
        let goes_on = !self.way.is_empty() && !self.mode.is_stopped() && self.phase() != ArmPhase::Hovers;
        goes_on || self.rate > 0.0 || self.moves() || self.touch.is_to_be_told()
    }

    /// Whether any joint moves.
    pub fn moves(&self) -> bool {
        self.world.joints().1.iter().any(|speed| speed.abs() > STILL_RAD_S)
    }

    /// The joint angles, in radians.
    pub fn joints(&self) -> JointAngles {
        self.world.joints().0
    }

    /// How far a hand is from it, in metres.
    pub fn distance(&self, hand: &HandPose) -> f64 {
        self.world.distance(hand)
    }

    /// One cycle, with the human's hand where the person holds it, if there is one. With nothing to do and nobody near
    /// nothing is computed.
    pub fn cycle(&mut self, hand: Option<HandPose>) -> ControlCycle {
        let hand = hand.filter(|hand| self.distance(hand) < FAR_M);
        let share = self.share_allowed(hand);
        if hand.is_none() && !self.is_busy() && self.world.hand().is_none() {
            return ControlCycle::default();
        }
        let slope = match (share < self.rate, self.mode.is_stopped()) {
            (true, true) => STOPS,
            (true, false) => SLOWS,
            (false, _) => SPEEDS_UP,
        };
        self.rate += (share - self.rate).clamp(-slope * CYCLE_S, slope * CYCLE_S);
        self.go_on();
        self.aim();
        let felt = self.world.cycle(&self.here, hand);
        let touched_n = self.touch.feel(felt.human_n);
        let clicked = self.world.aimed_at().filter(|_| felt.clicked).map(|button| ButtonId(button as u8));
        let report = self.judge(&felt);
        if clicked.is_some() && !self.mode.is_stopped() {
            self.give_up();
        }
        ControlCycle { clicked, report, felt, touched_n }
    }

    /// The share of the planned speed that it may go now.
    fn share_allowed(&mut self, hand: Option<HandPose>) -> f64 {
        if self.mode.is_stopped() {
            return 0.0;
        }
        let waits = self.phase() == ArmPhase::Hovers || self.halts;
        let hand = hand.map(|wanted| self.world.hand().unwrap_or(wanted));
        let Some(hand) = hand.filter(|_| self.watches_hands) else {
            self.mode = SafetyMode::Normal;
            return if waits { 0.0 } else { 1.0 };
        };
        let distance_m = self.world.distance(&hand);
        let share = self.share_near(&hand, distance_m);
        let blocked = share == 0.0 && !self.way.is_empty();
        self.free_s = if blocked { 0.0 } else { self.free_s + CYCLE_S };
        // A hand that moves at its edge does not make the mode flicker.
        let waited = self.mode == SafetyMode::Safeguard && self.free_s < FREE_S;
        self.mode = mode_near(self.mode, distance_m, blocked || waited);
        self.waited_s = match blocked && self.goal.is_some() {
            true => self.waited_s + CYCLE_S,
            false if self.phase() == ArmPhase::Presses => self.waited_s,
            false => 0.0,
        };
        if waits { 0.0 } else { share }
    }

    fn share_near(&self, hand: &HandPose, distance_m: f64) -> f64 {
        let Some(leg) = self.way.front().filter(|_| distance_m < SLOWS_M) else { return 1.0 };
        let ahead = leg.at(self.since_s + AHEAD_S);
        let comes_nearer = self.arm.distance(&ahead, hand) < distance_m;
        let limit_m_s = speed_limit(distance_m, comes_nearer);
        let tip = |joints: &JointAngles| self.arm.tip(joints).translation.vector;
        let planned_m_s = (tip(&ahead) - tip(&leg.at(self.since_s))).norm() / AHEAD_S;
        // Also where a leg begins or ends slowly, a hand at the arm stops it.
        let share = limit_m_s / planned_m_s.max(limit_m_s).max(1e-3);
        if limit_m_s == 0.0 { 0.0 } else { share }
    }

    /// Goes on along the way for a cycle.
    fn go_on(&mut self) {
        if self.halts && self.rate == 0.0 && !self.mode.is_stopped() {
            self.go_up();
        }
        let Some(leg) = self.way.front() else { return };
        self.since_s += self.rate * CYCLE_S;
        self.here = leg.at(self.since_s);
        let ends = self.since_s >= leg.takes_s;
        // On a button it stays until it clicks or does not.
        if ends && leg.kind != LegKind::Down {
            self.since_s -= leg.takes_s;
            self.way.pop_front();
            match self.way.front() {
                None => (self.since_s, self.rate) = (0.0, 0.0),
                Some(next) => {
                    self.since_s = if next.kind == LegKind::Down && !self.may_press { 0.0 } else { self.since_s };
                    self.here = next.at(self.since_s);
                }
            }
        }
    }

    /// The button under the stick takes part in the physics.
    fn aim(&mut self) {
        match self.way.front().map(|leg| leg.kind) {
            Some(LegKind::Down) => self.world.aim_at(self.goal.map(ButtonId::index)),
            Some(LegKind::Over) | None => self.world.aim_at(None),
            Some(LegKind::Up) => {}
        }
    }

    /// What follows from what was felt.
    fn judge(&mut self, felt: &CycleForces) -> Option<PressFailure> {
        if self.mode.is_stopped() {
            return None;
        }
        if felt.human_n > self.mode.threshold_n() {
            self.stop(SafetyMode::ProtectiveStop);
            return Some(PressFailure::Contact(felt.human_n));
        }
        if let Some(joint) = self.joint_astray() {
            self.stop(SafetyMode::Fault);
            // The brakes hold it where it is.
            self.here = self.world.joints().0;
            self.way.clear();
            self.world.brake();
            return Some(PressFailure::Fault(joint));
        }
        let button = self.goal.filter(|_| !felt.clicked)?;
        if self.waited_s > BLOCKED_S {
            self.give_up();
            return Some(PressFailure::Blocked(button));
        }
        let is_down = self.way.front().is_some_and(|leg| leg.kind == LegKind::Down && self.since_s >= leg.takes_s);
        if is_down && self.mode != SafetyMode::Safeguard {
            self.waited_s += CYCLE_S;
            if self.waited_s > CLICKS_WITHIN_S {
                self.give_up();
                return Some(PressFailure::NoClick(button));
            }
        }
        None
    }

    /// The joint that is not where it was told to be.
    fn joint_astray(&mut self) -> Option<usize> {
        let (angles, _) = self.world.joints();
        let off = |joint: &usize| (angles[*joint] - self.here[*joint]).abs();
        let worst = (0..JOINTS).max_by(|one, two| off(one).total_cmp(&off(two)))?;
        self.astray = if off(&worst) > ASTRAY_RAD { self.astray + 1 } else { 0 };
        (self.astray >= ASTRAY_CYCLES).then_some(worst)
    }
}
