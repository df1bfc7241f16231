//! The controller of the simulated robot arm, which presses buttons in the physics simulation; the controller runs 125
//! cycles per second.
//!
//! The arm moves along its planned path to a button as fast as speed and separation monitoring allows
//! (below). Slowing down stretches the time along the path, so that the arm stays on the path that was
//! checked for collisions. The controller reports the result of each press.

use std::collections::VecDeque;

use tomcom_core::kitchen::{Agent, ButtonId, Kitchen};
use tomcom_core::robot::{ArmPhase, JOINTS, JointAngles, SLOWS_M, SafetyMode};

use crate::kinematics::SerialArm;
use crate::physics::bodies::HandPose;
use crate::physics::{CYCLE_S, ContactForces, PhysicsWorld};
use crate::reach::{ArmSurroundings, BUTTON_M, ButtonPoses, UnreachableReason, resting_pose};
use crate::trajectory::{LegKind, TrajectoryLeg, way_over, way_to, way_up};
use crate::worker::PressFailure;

/// Changes of the arm's share of its planned speed along the path, per second: while the arm slows down, stops, and
/// speeds up.
const SLOWS: f64 = 10.0;
const STOPS: f64 = 20.0;
const SPEEDS_UP: f64 = 3.0;
/// Look-ahead along the arm's path when computing the distance to a hand, in seconds.
const AHEAD_S: f64 = 0.08;
/// Time with a hand in the way after which the arm abandons the press, in seconds.
const BLOCKED_S: f64 = 4.0;
/// Time without a hand in the way after which the arm's path counts as free, in seconds.
const FREE_S: f64 = 0.25;
/// Tracking error of a joint, in radians, and number of cycles with such an error, above which the joint counts as
/// faulty.
pub const DEVIATION_RAD: f64 = 0.05;
pub const DEVIATION_CYCLES: u32 = 3;
/// Height of the stick's tip above a button's top, in metres, above which the stick cannot touch the button within one
/// cycle: in that time the tip moves by 2 mm.
pub const MAY_TOUCH_M: f64 = 0.01;
/// Longest time to wait for the click of a button that the arm pushes down, in seconds.
const CLICKS_WITHIN_S: f64 = 0.1;
/// The arm counts as standing still if all joints are slower than this, in radians per second.
pub const STILL_RAD_S: f64 = 0.02;

/// Hands further away from the arm than this, in metres, do not influence the arm.
const FAR_M: f64 = SLOWS_M + MARGIN_M + 0.02;

#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ControlCycleResult {
    /// The button that clicked in this cycle. A click counts as a press even if the arm was about to abandon the press.
    pub clicked: Option<ButtonId>,
    /// Why the arm abandoned the press; `None` if the arm did not abandon a press in this cycle.
    pub report: Option<PressFailure>,
    pub felt: ContactForces,
    /// Peak force in newtons of a contact with the human, reported shortly after the contact began. Each contact is
    /// reported once; by then, a contact above [`SafetyMode::threshold_n`] has stopped the arm
    /// ([`PressFailure::Contact`]).
    pub touched_n: Option<f64>,
}

#[derive(Clone, Debug)]
pub struct ArmController {
    arm: SerialArm,
    world: PhysicsWorld,
    around: ArmSurroundings,
    /// Pose in which the arm waits while it has no press to make.
    home: JointAngles,
    buttons: Vec<Result<ButtonPoses, UnreachableReason>>,
    way: VecDeque<TrajectoryLeg>,
    /// Time since the present leg of the trajectory began, in seconds at the planned speed.
    since_s: f64,
    /// Present share of the planned speed with which the arm moves.
    rate: f64,
    here: JointAngles,
    goal: Option<ButtonId>,
    may_press: bool,
    /// Whether the arm has abandoned its press and slows down before it goes up.
    halts: bool,
    pub mode: SafetyMode,
    /// Whether speed and separation monitoring is on; without it the arm only reacts to forces.
    pub watches_hands: bool,
    /// Time for which the arm has waited for a hand in the way to leave, or for a click, in seconds.
    waited_s: f64,
    /// Time without a hand in the arm's way, in seconds.
    free_s: f64,
    deviating_cycles: u32,
    touch: ContactTracker,
}

impl ArmController {
    /// A robot arm at rest above the middle of its buttons.
    pub fn new(kitchen: &Kitchen) -> ArmController {
        let arm = SerialArm::ur5();
        let around = ArmSurroundings { table_m: kitchen.table_height_m, obstacles: Vec::new() };
        let places: Vec<[f64; 2]> = kitchen.buttons[Agent::Robot.index()].iter().map(|button| button.at_m).collect();
        let buttons: Vec<_> = places.iter().map(|&place| arm.at_button(place, &around)).collect();
        // Above the buttons that only the robot has, the arm does not obstruct the human.
        let is_shared = |place: &[f64; 2]| kitchen.buttons[Agent::Human.index()].iter().any(|it| it.at_m == *place);
        let own =
            places.iter().zip(&buttons).filter(|(place, _)| !is_shared(place)).filter_map(|(_, at)| at.as_ref().ok());
        let here = resting_pose(&own.collect::<Vec<_>>());
        let world = PhysicsWorld::new(&arm, &here, &places, around.table_m);
        ArmController {
            arm,
            world,
            around,
            home: here,
            buttons,
            way: VecDeque::new(),
            since_s: 0.0,
            rate: 0.0,
            here,
            goal: None,
            may_press: false,
            halts: false,
            mode: SafetyMode::default(),
            watches_hands: true,
            waited_s: 0.0,
            free_s: 0.0,
            deviating_cycles: 0,
            touch: ContactTracker::default(),
        }
    }

    /// Starts the motion to a button from a standstill; returns the time in seconds until the button clicks if nothing
    /// interferes.
    ///
    /// # Errors
    /// The reason why the arm cannot reach the button.
    pub fn set_out(&mut self, button: ButtonId) -> Result<f64, UnreachableReason> {
        self.way = self.way_to(button)?.into();
        self.goal = Some(button);
        (self.since_s, self.rate, self.waited_s, self.may_press) = (0.0, 0.0, 0.0, false);
        self.halts = false;
        Ok(self.way.iter().map(|leg| leg.takes_s).sum::<f64>())
    }

    /// The time in seconds until a button clicks if the arm started now.
    ///
    /// # Errors
    /// The reason why the arm cannot reach the button.
    pub(crate) fn takes_s(&self, button: ButtonId) -> Result<f64, UnreachableReason> {
        Ok(self.way_to(button)?.iter().map(|leg| leg.takes_s).sum())
    }

    fn way_to(&self, button: ButtonId) -> Result<Vec<TrajectoryLeg>, UnreachableReason> {
        let at = (*self.buttons.get(button.index()).unwrap_or(&Err(UnreachableReason::TooFar)))?;
        way_to(&self.arm, &self.here, &at, &self.around)
    }

    pub fn around(&mut self) -> &mut ArmSurroundings {
        &mut self.around
    }

    pub fn world(&mut self) -> &mut PhysicsWorld {
        &mut self.world
    }

    /// Allows the arm to press the button above which it waits.
    pub fn press(&mut self) {
        self.may_press = true;
    }

    /// Abandons the press: the arm slows down and goes up from where it is.
    pub fn give_up(&mut self) {
        self.goal = None;
        self.waited_s = 0.0;
        self.halts = true;
        if self.rate == 0.0 {
            self.go_up();
        }
    }

    /// Whether the arm is away from its waiting pose without a press to make.
    pub(crate) fn is_out(&self) -> bool {
        let is_away = (0..JOINTS).any(|joint| (self.here[joint] - self.home[joint]).abs() > 1e-3);
        self.way.is_empty() && !self.mode.is_stopped() && is_away
    }

    /// Moves the arm back to its waiting pose; the arm stays in place if there is no collision-free path.
    pub(crate) fn go_home(&mut self) {
        match way_over(&self.arm, &self.here, &self.home, &self.around) {
            Ok(way) => (self.way, self.since_s, self.rate) = (way.into(), 0.0, 0.0),
            Err(_) => self.home = self.here,
        }
    }

    /// Whether the arm moves without a button that it is to press.
    pub(crate) fn withdraws(&self) -> bool {
        self.goal.is_none() && self.rate > 0.0
    }

    /// Whether the arm still slows down, so that it cannot set out for another button.
    pub fn halts(&self) -> bool {
        self.halts
    }

    fn go_up(&mut self) {
        (self.since_s, self.halts) = (0.0, false);
        self.way = way_up(&self.arm, &self.here, &self.around).unwrap_or_default().into();
    }

    /// Stops the arm in place, as fast as possible, until [`Self::resume`] releases the arm.
    pub fn stop(&mut self, mode: SafetyMode) {
        self.mode = mode;
        self.goal = None;
    }

    /// Releases the arm after a stop: the arm goes up and is ready for the next press.
    pub fn resume(&mut self) {
        if self.mode.is_stopped() {
            self.mode = SafetyMode::Normal;
            (self.deviating_cycles, self.rate) = (0, 0.0);
            self.here = self.world.joints().0;
            self.give_up();
        }
    }

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

    /// Whether the next cycle changes anything: the arm has a path to follow, or a motion has not settled.
    pub fn is_busy(&self) -> bool {
        let goes_on = !self.way.is_empty() && !self.mode.is_stopped() && self.phase() != ArmPhase::Hovers;
        goes_on || self.rate > 0.0 || self.moves() || self.touch.is_to_be_told()
    }

    pub fn moves(&self) -> bool {
        self.world.joints().1.iter().any(|speed| speed.abs() > STILL_RAD_S)
    }

    pub fn joints(&self) -> JointAngles {
        self.world.joints().0
    }

    pub fn distance(&self, hand: &HandPose) -> f64 {
        self.world.distance(hand)
    }

    /// Runs one controller cycle with the human's hand in this pose, if there is a hand. An idle arm without a hand
    /// nearby costs no computing time.
    pub fn cycle(&mut self, hand: Option<HandPose>) -> ControlCycleResult {
        let hand = hand.filter(|hand| self.distance(hand) < FAR_M);
        let share = self.share_allowed(hand);
        if hand.is_none() && !self.is_busy() && self.world.hand().is_none() {
            return ControlCycleResult::default();
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
        ControlCycleResult { clicked, report, felt, touched_n }
    }

    /// The share of the planned speed that the distance between hand and arm allows (speed and separation monitoring).
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
        // Hysteresis: a hand at the edge of the limit must not make the safety mode flicker.
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
        // The lower bound of the planned speed stops the arm near a hand even where a leg begins or ends slowly.
        let share = limit_m_s / planned_m_s.max(limit_m_s).max(1e-3);
        if limit_m_s == 0.0 { 0.0 } else { share }
    }

    fn go_on(&mut self) {
        if self.halts && self.rate == 0.0 && !self.mode.is_stopped() {
            self.go_up();
        }
        let Some(leg) = self.way.front() else { return };
        self.since_s += self.rate * CYCLE_S;
        self.here = leg.at(self.since_s);
        let ends = self.since_s >= leg.takes_s;
        // On a button, the arm waits for the click or for the timeout.
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

    /// Activates the button under the arm's stick in the physics while the stick is so low that it may touch the button.
    fn aim(&mut self) {
        let height_m = || self.arm.tip(&self.world.joints().0).translation.z - self.around.table_m - BUTTON_M;
        match self.way.front().map(|leg| leg.kind) {
            Some(LegKind::Down | LegKind::Up) if height_m() > MAY_TOUCH_M => self.world.aim_at(None),
            Some(LegKind::Down) => self.world.aim_at(self.goal.map(ButtonId::index)),
            Some(LegKind::Over) | None => self.world.aim_at(None),
            Some(LegKind::Up) => {}
        }
    }

    /// The failure of the press that follows from the measured contact forces; `None` if the press has not failed.
    fn judge(&mut self, felt: &ContactForces) -> Option<PressFailure> {
        if self.mode.is_stopped() {
            return None;
        }
        if felt.human_n > self.mode.threshold_n() {
            self.stop(SafetyMode::ProtectiveStop);
            return Some(PressFailure::Contact(felt.human_n));
        }
        if let Some(joint) = self.deviating_joint() {
            self.stop(SafetyMode::Fault);
            // The brakes hold the arm in its present pose.
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

    fn deviating_joint(&mut self) -> Option<usize> {
        let (angles, _) = self.world.joints();
        let off = |joint: &usize| (angles[*joint] - self.here[*joint]).abs();
        let worst = (0..JOINTS).max_by(|one, two| off(one).total_cmp(&off(two)))?;
        self.deviating_cycles = if off(&worst) > DEVIATION_RAD { self.deviating_cycles + 1 } else { 0 };
        (self.deviating_cycles >= DEVIATION_CYCLES).then_some(worst)
    }
}

// Speed and separation monitoring (ISO/TS 15066, 5.5.4): the robot arm slows down near a hand and waits for a hand in
// its way.

/// Protective separation distance in metres: the arm does not approach a hand that is nearer than this.
const WAITS_M: f64 = 0.03;
/// Highest speed of the arm's tip in m/s at the distance at which the arm begins to slow down; nearer to the hand, the
/// limit falls in proportion to the distance.
const SLOWED_M_S: f64 = 0.8;
/// Speeds of the arm's tip below this limit, in m/s, count as waiting.
const CREEPS_M_S: f64 = 0.02;
/// Speed limit of the arm's tip for motion away from a hand, in m/s.
const LEAVES_M_S: f64 = 0.1;
/// Hysteresis of the distances between hand and arm in metres, so that the safety mode does not flicker.
pub(crate) const MARGIN_M: f64 = 0.03;

/// The speed limit of the arm's tip in m/s for a hand at this distance, depending on whether the arm approaches the
/// hand.
pub(crate) fn speed_limit(distance_m: f64, comes_nearer: bool) -> f64 {
    let by_distance = match distance_m {
        far if far >= SLOWS_M => f64::INFINITY,
        near => SLOWED_M_S * (near - WAITS_M).max(0.0) / (SLOWS_M - WAITS_M),
    };
    match comes_nearer {
        true if by_distance < CREEPS_M_S => 0.0,
        true => by_distance,
        false => by_distance.max(LEAVES_M_S),
    }
}

/// The safety mode for a hand at this distance while the arm is not stopped. `waits` says whether the arm must not move
/// at all.
pub(crate) fn mode_near(before: SafetyMode, distance_m: f64, waits: bool) -> SafetyMode {
    let is_out = distance_m >= SLOWS_M + if before == SafetyMode::Normal { 0.0 } else { MARGIN_M };
    match (waits, is_out) {
        (true, _) => SafetyMode::Safeguard,
        (false, true) => SafetyMode::Normal,
        (false, false) => SafetyMode::Reduced,
    }
}

/// Number of controller cycles after which a contact is reported, and number of cycles without force after which the
/// contact has ended.
const CYCLES: u32 = 12;

/// The present contact between robot arm and human; `None` without a contact.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct ContactTracker(Option<Contact>);

#[derive(Clone, Copy, Debug, Default)]
struct Contact {
    most_n: f64,
    cycles: u32,
    /// Number of controller cycles without force since the contact was last felt.
    quiet: u32,
}

impl ContactTracker {
    /// Adds the contact force of a controller cycle, in newtons. Returns the peak force of a contact that has to be
    /// reported now.
    pub fn feel(&mut self, force_n: f64) -> Option<f64> {
        if force_n > 0.0 {
            self.0.get_or_insert_default();
        }
        let contact = self.0.as_mut()?;
        contact.most_n = contact.most_n.max(force_n);
        contact.cycles += 1;
        contact.quiet = if force_n > 0.0 { 0 } else { contact.quiet + 1 };
        let told = (contact.cycles == CYCLES).then_some(contact.most_n);
        if contact.cycles > CYCLES && contact.quiet >= CYCLES {
            self.0 = None;
        }
        told
    }

    /// Whether there is a contact that has not been reported yet.
    pub(crate) fn is_to_be_told(&self) -> bool {
        self.0.is_some_and(|contact| contact.cycles < CYCLES)
    }
}
