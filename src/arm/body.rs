//! The simulated robot arm and the human's hand beside the arm, stepped in session time, and the events that they
//! report.

use tomcom_core::base::rng::stream;
use tomcom_core::base::time::SessionTime;
use tomcom_core::kitchen::{ButtonId, Kitchen, State};
use tomcom_core::robot::{AbortReason, ArmPhase, ArmSample, RobotEvent, SafetyMode};

use crate::controller::{ArmController, ControlCycleResult};
use crate::physics::CYCLE_S;
use crate::reaching::{ReachingBehaviour, ReachingHand};
use crate::worker::{ArmCycleReport, PressFailure};

/// Interval between recorded samples of a moving robot arm: about twelve per second.
pub const TOLD_EVERY: SessionTime = SessionTime(80_000_000);

/// A value in parts of one, such as thousandths, as it is recorded.
pub fn rounded(value: f64, parts: f64) -> f64 {
    // Adding 0 turns -0 into 0, which is written differently in the log.
    (value * parts).round() / parts + 0.0
}

#[derive(Clone, Copy, Debug, Default)]
struct Told {
    at: SessionTime,
    phase: ArmPhase,
    mode: SafetyMode,
    moving: bool,
    /// Greatest contact force since the last report, in newtons.
    force_n: f64,
}

/// The simulated arm with the human's hand and the session time that the simulation has reached.
#[derive(Clone, Debug)]
pub struct SimulatedArm {
    pub arm: ArmController,
    hand: ReachingHand,
    at: SessionTime,
    /// The button to which the arm moves as soon as it stands still.
    next: Option<ButtonId>,
    idle: bool,
    told: Told,
    /// The state of the kitchen in which the present press was last found useful.
    found_useful: Option<State>,
    on_button: bool,
}

impl SimulatedArm {
    pub fn new(kitchen: &Kitchen, hand: ReachingBehaviour, seed: u64, trial: u64) -> SimulatedArm {
        let hand = ReachingHand::new(kitchen, hand, stream(seed, "human's hand", trial));
        let arm = ArmController::new(kitchen);
        SimulatedArm {
            arm,
            hand,
            at: SessionTime::ZERO,
            next: None,
            idle: false,
            told: Told::default(),
            found_useful: None,
            on_button: false,
        }
    }

    /// The time of the next controller cycle; none if arm and hand are at rest. `may_press` is false while the wizard
    /// holds the arm above the button.
    pub fn next_due(&self, may_press: bool) -> Option<SessionTime> {
        let goes_down = self.arm.phase() == ArmPhase::Hovers && may_press && !self.arm.mode.is_stopped();
        let goes_home = self.idle && self.arm.is_out();
        let sets_out = self.next.is_some() && !self.arm.mode.is_stopped();
        let next = (goes_down || goes_home || sets_out || self.arm.is_busy())
            .then(|| self.at + SessionTime::from_secs_f64(CYCLE_S));
        next.into_iter().chain(self.hand.next_move(self.at)).min()
    }

    /// Starts the arm's motion to a button, at once or as soon as the arm stands still. Returns the duration of the
    /// motion, if nothing disturbs the arm, in seconds.
    pub fn set_out(&mut self, now: SessionTime, button: ButtonId) -> Result<f64, AbortReason> {
        (self.found_useful, self.idle) = (None, false);
        if self.arm.withdraws() {
            self.arm.give_up();
        }
        if self.arm.halts() {
            self.next = Some(button);
            return Ok(self.arm.takes_s(button)?);
        }
        // Nothing happened to the arm while it was at rest.
        self.at = self.at.max(now);
        Ok(self.arm.set_out(button)?)
    }

    pub fn give_up(&mut self) {
        self.next = None;
        self.arm.give_up();
    }

    /// Whether the caller now has to decide if the arm's press is still useful: above the button, whenever the state
    /// changed before the stick touches the button, and while a hand blocks the arm.
    pub fn asks(&self, may_press: bool, state: State) -> bool {
        match self.arm.phase() {
            _ if self.next.is_some() => false,
            _ if self.arm.mode == SafetyMode::Safeguard && !self.on_button => self.found_useful != Some(state),
            ArmPhase::Hovers => may_press && !self.arm.mode.is_stopped(),
            ArmPhase::Presses => !self.on_button && self.found_useful != Some(state),
            ArmPhase::Rests | ArmPhase::Retracts | ArmPhase::Travels => false,
        }
    }

    /// Confirms that the press is useful in this state of the kitchen: an arm above the button presses the button.
    pub(crate) fn go_for_it(&mut self, may_press: bool, state: State) {
        self.found_useful = Some(state);
        if self.arm.phase() == ArmPhase::Hovers && may_press {
            self.arm.press();
        }
    }

    /// Starts the pending press if the arm stands still. If the arm cannot reach the button of that press, returns the
    /// button and the reason.
    pub fn go_on(&mut self) -> Option<(ButtonId, AbortReason)> {
        let halts = self.arm.halts() || self.arm.mode.is_stopped();
        let button = self.next.take_if(|_| !halts)?;
        self.arm.set_out(button).err().map(|why| (button, why.into()))
    }

    pub fn cycle(&mut self, now: SessionTime) -> ArmCycleReport {
        self.at = now;
        if self.idle && self.arm.is_out() {
            self.arm.go_home();
        }
        self.hand.cycle(now, |hand| self.arm.distance(hand));
        let cycle = self.arm.cycle(Some(self.hand.place()));
        self.on_button = cycle.felt.button_n > 0.0;
        if cycle.felt.human_n > 0.0 {
            self.hand.feels_the_arm();
        }
        ArmCycleReport { clicked: cycle.clicked, report: cycle.report, news: self.news(now, &cycle) }
    }

    fn news(&mut self, now: SessionTime, cycle: &ControlCycleResult) -> Vec<RobotEvent> {
        self.told.force_n = self.told.force_n.max(cycle.felt.human_n).max(cycle.felt.button_n);
        let (force_n, joint) = match cycle.report {
            Some(PressFailure::Contact(force_n)) => (Some(rounded(force_n, 10.0)), None),
            Some(PressFailure::Fault(joint)) => (None, Some(joint as u8 + 1)),
            _ => (None, None),
        };
        let mut news: Vec<RobotEvent> = self.safety(force_n, joint).into_iter().collect();
        let told = &mut self.told;
        let (phase, moving) = (self.arm.phase(), self.arm.moves());
        let comes_to_rest = told.moving && !moving;
        let is_old = moving && now >= told.at + TOLD_EVERY;
        if !news.is_empty() || phase != told.phase || comes_to_rest || is_old {
            let place = self.hand.place();
            news.push(RobotEvent::Move(ArmSample {
                phase,
                joints: self.arm.joints().map(|angle| rounded(angle, 1e4)),
                force_n: rounded(told.force_n, 10.0),
                hand_m: Some([place.at_m.x, place.at_m.y, place.at_m.z].map(|length| rounded(length, 1e3))),
                hand_away_m: Some(rounded(self.arm.distance(&place), 1e3)),
            }));
            (told.at, told.phase, told.moving, told.force_n) = (now, phase, moving, 0.0);
        }
        news.extend(cycle.touched_n.map(|force_n| RobotEvent::Touched { force_n: rounded(force_n, 10.0) }));
        news
    }

    /// Tells the arm that the robot has no press to make: the arm stays idle until the next press.
    pub(crate) fn has_nothing_to_do(&mut self) {
        self.idle = true;
    }

    pub fn stop(&mut self) -> Option<RobotEvent> {
        self.arm.stop(SafetyMode::EmergencyStop);
        self.safety(None, None)
    }

    /// Tells the simulated hand that the person intends to press the button at this position on the table (metres) at
    /// the predicted time `at`.
    pub fn human_means(&mut self, now: SessionTime, button_m: [f64; 2], at: SessionTime) {
        self.hand.means(now, button_m, at);
    }

    /// Tells the simulated hand that the person has pressed the button at this position on the table (metres).
    pub fn human_pressed(&mut self, now: SessionTime, button_m: [f64; 2]) {
        self.hand.pressed(now, button_m);
    }

    fn safety(&mut self, force_n: Option<f64>, joint: Option<u8>) -> Option<RobotEvent> {
        let mode = self.arm.mode;
        let changed = std::mem::replace(&mut self.told.mode, mode) != mode;
        changed.then_some(RobotEvent::Safety { mode, force_n, joint })
    }

    pub fn resume(&mut self, now: SessionTime) -> Option<RobotEvent> {
        self.at = self.at.max(now);
        self.arm.resume();
        self.safety(None, None)
    }

    pub fn postpone(&mut self, by: SessionTime) {
        self.at = self.at + by;
        self.told.at = self.told.at + by;
        self.hand.postpone(by);
    }
}
