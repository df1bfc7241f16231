//! Carries out the robot's task policy with presses that take time. The duration of a press is drawn at random (timed
//! arm), results from the simulated arm, or is that of a real arm, which reports what it does. This module knows neither
//! events nor clocks: the caller passes time and state.

use rand_distr::{Distribution, LogNormal};
use tomcom_core::base::rng::{Stream, stream};
use tomcom_core::base::time::SessionTime;
use tomcom_core::kitchen::cost_to_go::{CostToGo, Fidelity};
use tomcom_core::kitchen::{Agent, ButtonId, Kitchen, State};
use tomcom_core::robot::policy::PolicyDecision;
use tomcom_core::robot::{AbortReason, ArmPhase, IdleReason, RobotEvent, SafetyMode, policy};

use crate::body::SimulatedArm;
use crate::real_arm::{ArmOrder, RealArm};

#[cfg(feature = "physics")]
use super::controller::ArmController;

/// Time for which a skipped press of the robot is not chosen again, in seconds.
pub(crate) const SKIP_S: f64 = 5.0;

#[derive(Clone, Copy, Debug)]
struct OngoingPress {
    button: ButtonId,
    until: SessionTime,
    /// Whether the wizard chose this press: the arm then makes the press even if it is not useful.
    driven: bool,
}

impl OngoingPress {
    fn is_useful(self, kitchen: &Kitchen, cost: &mut CostToGo, state: State, is_passive: bool) -> bool {
        self.driven || policy::is_useful(kitchen, cost, state, is_passive, self.button)
    }
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Idleness {
    reason: IdleReason,
    /// The human's presses for one of which the robot waits, as a bit set of the human's buttons.
    waits_for: u64,
    state: State,
    is_passive: bool,
}

/// What presses the buttons.
#[derive(Clone, Debug)]
enum ArmBody {
    /// Nothing: presses take a random time.
    Timed,
    Simulated(Box<SimulatedArm>),
    Real(RealArm),
}

impl ArmBody {
    fn simulated(&mut self) -> Option<&mut SimulatedArm> {
        match self {
            ArmBody::Simulated(body) => Some(body),
            ArmBody::Timed | ArmBody::Real(_) => None,
        }
    }

    fn give_up(&mut self) {
        match self {
            ArmBody::Timed => {}
            ArmBody::Simulated(body) => body.give_up(),
            ArmBody::Real(arm) => arm.give_up(),
        }
    }

    /// Whether it can begin a press.
    fn is_able(&self) -> bool {
        match self {
            ArmBody::Real(arm) => arm.is_able(),
            ArmBody::Timed | ArmBody::Simulated(_) => true,
        }
    }
}

/// The robot at work: it decides on presses and carries them out with its arm; the robot can be idle, held or stopped.
#[derive(Clone, Debug)]
pub struct RobotTaskExecutor {
    random: Stream,
    duration_s: LogNormal<f64>,
    busy: Option<OngoingPress>,
    stopped: bool,
    /// Whether the wizard holds the robot: the robot then starts no press, and waits above the button of the present
    /// press.
    held: bool,
    /// The button that the wizard chose for the robot's next press, until the arm starts to move to the button.
    driven: Option<ButtonId>,
    /// Presses that were skipped or failed, each with the time until which the robot does not choose the press.
    skipped: Vec<(ButtonId, SessionTime)>,
    idle: Option<Idleness>,
    /// Time without a press of the human after which the human counts as passive.
    initiative: SessionTime,
    /// The time from which the human counts as passive if the human does not press before.
    passive_from: SessionTime,
    body: ArmBody,
    /// Expected duration of a press of a real arm, in seconds.
    press_s: f64,
}

impl RobotTaskExecutor {
    /// A robot at rest with a timed arm. `press_s` is the median duration of a press in seconds, `spread` the standard
    /// deviation of its logarithm; after `initiative_s` seconds without a press of the human the robot takes the
    /// initiative.
    pub fn new(press_s: f64, spread: f64, initiative_s: f64, seed: u64, trial: u64) -> RobotTaskExecutor {
        let median = press_s.max(0.05);
        let duration_s = LogNormal::new(median.ln(), spread.clamp(0.0, 2.0)).expect("a finite mean and spread");
        let initiative = SessionTime::from_secs_f64(initiative_s);
        RobotTaskExecutor {
            random: stream(seed, "robot", trial),
            duration_s,
            busy: None,
            stopped: false,
            held: false,
            driven: None,
            skipped: Vec::new(),
            idle: None,
            initiative,
            passive_from: initiative,
            body: ArmBody::Timed,
            press_s,
        }
    }

    pub fn with_body(self, body: SimulatedArm) -> RobotTaskExecutor {
        RobotTaskExecutor { body: ArmBody::Simulated(Box::new(body)), ..self }
    }

    pub fn with_real_arm(self) -> RobotTaskExecutor {
        RobotTaskExecutor { body: ArmBody::Real(RealArm::default()), ..self }
    }

    #[cfg(feature = "physics")]
    pub fn arm(&mut self) -> Option<&mut ArmController> {
        self.body.simulated().map(|body| &mut body.arm)
    }

    /// The time of the robot's next action: a touch of the button, a controller cycle, or a new decision after a
    /// skipped press or once the human is passive. The time may have passed already: a held arm touches the button as
    /// soon as the arm is released.
    pub fn next_due(&self) -> Option<SessionTime> {
        let idle = self.idle.filter(|_| self.busy.is_none() && !self.held);
        let unskips = self.skipped.iter().map(|(_, until)| *until).min();
        let again = idle.and_then(|idle| match idle.reason {
            IdleReason::Skipped => unskips,
            IdleReason::HumanTurn => (!idle.is_passive).then_some(self.passive_from),
            IdleReason::NoOrder => None,
        });
        let moves = match (&self.body, self.busy) {
            (ArmBody::Simulated(body), _) => body.next_due(!self.waits()),
            (ArmBody::Timed, Some(ongoing)) => (!self.held || ongoing.driven).then_some(ongoing.until),
            (ArmBody::Timed, None) | (ArmBody::Real(_), _) => None,
        };
        again.into_iter().chain(moves).min()
    }

    fn waits(&self) -> bool {
        self.held && self.busy.is_none_or(|ongoing| !ongoing.driven)
    }

    /// Starts the press that the wizard chose; otherwise decides on a press if the arm is free and the state changed
    /// since the last decision. Of a real arm, also decides whether the ongoing press is still useful where that is to be
    /// asked.
    pub fn decide(
        &mut self,
        kitchen: &Kitchen,
        cost: &mut CostToGo,
        now: SessionTime,
        state: State,
    ) -> Option<RobotEvent> {
        if let Some(ongoing) = self.busy {
            let may_press = !self.waits();
            let ArmBody::Real(arm) = &mut self.body else { return None };
            if !arm.asks(may_press, state) {
                return None;
            }
            if ongoing.is_useful(kitchen, cost, state, now >= self.passive_from) {
                arm.go_for_it(state);
                return None;
            }
            return self.give_up(AbortReason::NoLongerUseful);
        }
        if self.stopped || !self.body.is_able() {
            return None;
        }
        if let Some(button) = self.driven.take() {
            return Some(self.set_out(now, button, true));
        }
        let skipped = self.skipped.len();
        self.skipped.retain(|(_, until)| *until > now);
        if self.skipped.len() < skipped {
            self.idle = None;
        }
        let is_passive = self.is_passive(now);
        if self.held || self.idle.is_some_and(|idle| (idle.state, idle.is_passive) == (state, is_passive)) {
            return None;
        }
        let skipped: Vec<ButtonId> = self.skipped.iter().map(|(button, _)| *button).collect();
        match policy::decide(kitchen, cost, state, is_passive, &skipped, &mut self.random) {
            PolicyDecision::Press(button) => Some(self.set_out(now, button, false)),
            PolicyDecision::Idle(reason) => {
                if let Some(body) = self.body.simulated() {
                    body.has_nothing_to_do();
                }
                let waits_for = match reason {
                    IdleReason::HumanTurn => {
                        cost.nearer(Fidelity::Searched, state, &kitchen.true_recipes(), Agent::Human)
                    }
                    IdleReason::NoOrder | IdleReason::Skipped => 0,
                };
                let told = self.idle.replace(Idleness { reason, waits_for, state, is_passive });
                let is_new = told.is_none_or(|told| (told.reason, told.waits_for) != (reason, waits_for));
                is_new.then_some(RobotEvent::Idle { reason, waits_for })
            }
        }
    }

    /// Whether the robot takes the initiative, since the human has not pressed for `initiative_s`.
    fn is_passive(&self, now: SessionTime) -> bool {
        now >= self.passive_from
    }

    fn set_out(&mut self, now: SessionTime, button: ButtonId, driven: bool) -> RobotEvent {
        let takes_s = match &mut self.body {
            ArmBody::Timed => self.duration_s.sample(&mut self.random),
            ArmBody::Real(arm) => {
                arm.set_out(button);
                self.press_s
            }
            ArmBody::Simulated(body) => match body.set_out(now, button) {
                Ok(takes_s) => takes_s,
                Err(why) => {
                    self.leave_out(now, button);
                    return RobotEvent::Abort(button, why);
                }
            },
        };
        let until = now + SessionTime::from_secs_f64(takes_s);
        self.busy = Some(OngoingPress { button, until, driven });
        self.idle = None;
        RobotEvent::Intend { button, until, initiative: !driven && self.is_passive(now) }
    }

    /// Carries out the robot's action that is due: a touch of the timed arm, or a cycle of the simulated arm.
    pub fn act(&mut self, kitchen: &Kitchen, cost: &mut CostToGo, now: SessionTime, state: State) -> Vec<RobotEvent> {
        let (may_press, is_passive) = (!self.waits(), self.is_passive(now));
        let body = match &mut self.body {
            ArmBody::Simulated(body) => body,
            ArmBody::Timed => return self.touch(kitchen, cost, state, is_passive).into_iter().collect(),
            // Only a new decision is due, which follows.
            ArmBody::Real(_) => return Vec::new(),
        };
        let mut events = Vec::new();
        // Only a new decision is due, which follows; an arm whose cycle is not due would move too fast.
        if body.next_due(may_press).is_none_or(|due| due > now) {
            return events;
        }
        if let Some((button, why)) = body.go_on() {
            events.extend(self.go_without(now, button, why));
            return events;
        }
        if let Some(ongoing) = self.busy.filter(|_| body.asks(may_press, state)) {
            match ongoing.is_useful(kitchen, cost, state, is_passive) {
                true => body.go_for_it(may_press, state),
                false => {
                    body.give_up();
                    self.busy = None;
                    events.push(RobotEvent::Abort(ongoing.button, AbortReason::NoLongerUseful));
                }
            }
        }
        let cycle = body.cycle(now);
        events.extend(cycle.news);
        if let Some(button) = cycle.clicked {
            self.busy = None;
            events.push(RobotEvent::Press(button));
        }
        events.extend(cycle.report.and_then(|report| self.follow(now, report)));
        events
    }

    /// Handles a failed press, and returns the robot activity to record, if there is one.
    fn follow(&mut self, now: SessionTime, report: PressFailure) -> Option<RobotEvent> {
        let (button, reason) = match report {
            PressFailure::Contact(_) => return self.halt(AbortReason::Contact),
            PressFailure::Fault(_) => return self.halt(AbortReason::Fault),
            PressFailure::Blocked(button) => (button, AbortReason::HandInTheWay),
            PressFailure::NoClick(button) => (button, AbortReason::NoClick),
        };
        self.go_without(now, button, reason)
    }

    fn go_without(&mut self, now: SessionTime, button: ButtonId, reason: AbortReason) -> Option<RobotEvent> {
        self.leave_out(now, button);
        self.give_up(reason)
    }

    fn halt(&mut self, reason: AbortReason) -> Option<RobotEvent> {
        self.stopped = true;
        self.idle = None;
        self.driven = None;
        self.give_up(reason)
    }

    fn leave_out(&mut self, now: SessionTime, button: ButtonId) {
        self.skipped.push((button, now + SessionTime::from_secs_f64(SKIP_S)));
        self.idle = None;
    }

    /// Lets the timed arm touch the button. The arm presses if the press is still useful or the wizard chose the press;
    /// otherwise the arm abandons the press.
    fn touch(&mut self, kitchen: &Kitchen, cost: &mut CostToGo, state: State, is_passive: bool) -> Option<RobotEvent> {
        let ongoing = self.busy.take()?;
        match ongoing.is_useful(kitchen, cost, state, is_passive) {
            true => Some(RobotEvent::Press(ongoing.button)),
            false => Some(RobotEvent::Abort(ongoing.button, AbortReason::NoLongerUseful)),
        }
    }

    /// Reacts to a change of the state without a press: a press that is no longer useful is abandoned at once.
    pub fn reconsider(
        &mut self,
        kitchen: &Kitchen,
        cost: &mut CostToGo,
        now: SessionTime,
        state: State,
    ) -> Option<RobotEvent> {
        let ongoing = self.busy?;
        match ongoing.is_useful(kitchen, cost, state, self.is_passive(now)) {
            true => None,
            false => self.give_up(AbortReason::NoLongerUseful),
        }
    }

    fn give_up(&mut self, reason: AbortReason) -> Option<RobotEvent> {
        let ongoing = self.busy.take()?;
        self.body.give_up();
        Some(RobotEvent::Abort(ongoing.button, reason))
    }

    /// Stops the robot at the wizard's command; the present press is abandoned.
    pub fn stop(&mut self) -> Vec<RobotEvent> {
        let safety = self.body.simulated().and_then(|body| body.stop());
        let given_up = self.halt(AbortReason::Stopped);
        safety.into_iter().chain(given_up).collect()
    }

    /// Holds the robot above its next button at the wizard's command, or releases it.
    pub fn hold(&mut self, held: bool) {
        self.held = held;
        self.idle = None;
    }

    /// Skips the present press at the wizard's command. The robot does not choose the skipped press again for a while;
    /// an earlier skipped press becomes available again.
    pub fn skip(&mut self, now: SessionTime) -> Option<RobotEvent> {
        let ongoing = self.busy?;
        self.skipped.clear();
        self.leave_out(now, ongoing.button);
        self.give_up(AbortReason::Skipped)
    }

    pub fn drive(&mut self, button: ButtonId) -> Option<RobotEvent> {
        self.driven = Some(button);
        self.give_up(AbortReason::Driven)
    }

    pub fn resume(&mut self, now: SessionTime) -> Option<RobotEvent> {
        self.stopped = false;
        self.body.simulated()?.resume(now)
    }

    /// The order for the driver of a real arm; `None` for other arms.
    pub fn order(&self) -> Option<ArmOrder> {
        match &self.body {
            ArmBody::Real(arm) => Some(arm.order(self.stopped)),
            ArmBody::Timed | ArmBody::Simulated(_) => None,
        }
    }

    /// A real arm says in which phase of its motion it is.
    pub fn arm_moves(&mut self, phase: ArmPhase) {
        if let ArmBody::Real(arm) = &mut self.body {
            arm.moves(phase);
        }
    }

    /// A real arm says whether it takes orders, and its safety mode; `stopped` says that the robot is stopped by now.
    pub fn arm_changes(&mut self, is_ready: bool, mode: SafetyMode, stopped: bool) -> Option<RobotEvent> {
        let ArmBody::Real(arm) = &mut self.body else { return None };
        arm.changes(is_ready, mode);
        let halts = stopped && !self.stopped;
        if halts { self.halt(AbortReason::Stopped) } else { None }
    }

    /// A button clicked under a real arm.
    pub fn arm_pressed(&mut self, button: ButtonId) {
        if let ArmBody::Real(arm) = &mut self.body
            && self.busy.take_if(|ongoing| ongoing.button == button).is_some()
        {
            arm.give_up();
        }
    }

    /// A real arm could not press the button.
    pub fn arm_failed(&mut self, now: SessionTime, button: ButtonId) {
        if matches!(self.body, ArmBody::Real(_)) {
            self.arm_pressed(button);
            self.leave_out(now, button);
        }
    }

    /// Tells the simulated hand that the person intends to press the button at this position on the table (metres) at
    /// the time `at`, as far as the time is known now.
    pub fn human_means(&mut self, now: SessionTime, button_m: [f64; 2], at: SessionTime) {
        if let Some(body) = self.body.simulated() {
            body.human_means(now, button_m, at);
        }
    }

    pub fn start(&mut self, now: SessionTime) {
        self.passive_from = now + self.initiative;
    }

    /// Tells the robot, and the simulated hand, that the person has pressed the button at this position on the table
    /// (metres).
    pub fn human_pressed(&mut self, now: SessionTime, button_m: [f64; 2]) {
        self.passive_from = now + self.initiative;
        if let Some(body) = self.body.simulated() {
            body.human_pressed(now, button_m);
        }
    }

    pub fn rest(&mut self) {
        self.busy = None;
        if let ArmBody::Real(arm) = &mut self.body {
            arm.give_up();
        }
        self.idle = None;
        self.driven = None;
        self.skipped.clear();
    }

    pub fn postpone(&mut self, by: SessionTime) {
        if let Some(ongoing) = &mut self.busy {
            ongoing.until = ongoing.until + by;
        }
        for (_, until) in &mut self.skipped {
            *until = *until + by;
        }
        self.passive_from = self.passive_from + by;
        if let Some(body) = self.body.simulated() {
            body.postpone(by);
        }
    }
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub enum PressFailure {
    /// A hand was in the way for too long, so the arm abandoned the press of this button.
    Blocked(ButtonId),
    NoClick(ButtonId),
    /// The arm measured a contact force (newtons) above the threshold; it stops and abandons the press.
    Contact(f64),
    /// This joint (number 0 is the first) did not follow its command; the brakes hold the arm, and the press is
    /// abandoned.
    Fault(usize),
}

/// The result of a controller cycle for the arm's press, and the events of the cycle to record.
#[derive(Clone, Debug, PartialEq)]
pub struct ArmCycleReport {
    /// The button that clicked. A click counts as a press even if the arm was about to abandon the press.
    pub clicked: Option<ButtonId>,
    pub report: Option<PressFailure>,
    /// The robot activities to record, in the order of their times.
    pub news: Vec<RobotEvent>,
}
