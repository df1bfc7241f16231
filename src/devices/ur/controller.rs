//! The simulated controller: power, brakes, safety, the running program, inputs and outputs, and the arm in the physics
//! simulation. It has no clock: [`SimulatedController::cycle`] is 8 ms of its time.

use std::collections::BTreeMap;

use nalgebra::Vector3;
use tomcom_arm::controller::{DEVIATION_CYCLES, DEVIATION_RAD, MAY_TOUCH_M};
use tomcom_arm::inverse::controller_from_base;
use tomcom_arm::kinematics::SerialArm;
use tomcom_arm::physics::PhysicsWorld;
use tomcom_arm::physics::bodies::HandPose;
use tomcom_arm::reach::{ArmSurroundings, BUTTON_M, resting_pose};
use tomcom_core::kitchen::{Agent, Kitchen};
use tomcom_core::robot::{JOINTS, JointAngles, SafetyMode};

use super::motion::{CYCLE_S, JointCommand, SAFETY_STOP_RAD_S2};
use super::program::{Program, Step, Wait};
use super::script::{Script, ScriptError};

/// Number of general-purpose registers of each kind of number.
pub const REGISTERS: usize = 48;
/// Number of digital inputs: 8 standard, 8 configurable, 2 of the tool.
pub const INPUTS: usize = 18;
/// Time that the power takes to come on, and the brakes to release, in seconds.
const POWERS_S: f64 = 1.0;
const RELEASES_S: f64 = 1.0;
/// Time after a protective stop before which it is not unlocked, in seconds, as in the manufacturer's controllers.
const LOCKED_S: f64 = 5.0;
/// Distance of the tip from a button's middle within which the tip touches the button, in metres.
const OVER_M: f64 = 0.02;

/// The generation of controllers that this one passes for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Series {
    /// PolyScope 3, with outputs at up to 125 Hz.
    Cb3,
    /// PolyScope 5, with outputs at up to 500 Hz.
    E,
}

impl Series {
    /// Major, minor, bugfix and build number of the software that the controller says it has.
    pub fn version(self) -> [u32; 4] {
        match self {
            Series::Cb3 => [3, 15, 8, 106_339],
            Series::E => [5, 11, 6, 1_010_000],
        }
    }

    /// The highest frequency of its outputs in hertz.
    pub fn hertz(self) -> f64 {
        match self {
            Series::Cb3 => 125.0,
            Series::E => 500.0,
        }
    }
}

/// With the numbers of RTDE's `robot_mode`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, strum::Display)]
#[strum(serialize_all = "SCREAMING_SNAKE_CASE")]
pub enum RobotMode {
    Booting = 2,
    PowerOff = 3,
    Idle = 5,
    Running = 7,
}

/// With the numbers of RTDE's `runtime_state`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, strum::Display)]
#[strum(serialize_all = "UPPERCASE")]
pub enum ProgramState {
    Stopped = 1,
    Playing = 2,
    Paused = 4,
}

/// With the numbers of RTDE's text messages.
#[derive(Clone, Copy, Debug, PartialEq, Eq, strum::Display)]
#[strum(serialize_all = "lowercase")]
pub enum Level {
    Error = 1,
    Warning = 2,
    Info = 3,
}

/// What the controller tells its clients and the person beside it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ControllerMessage {
    pub level: Level,
    pub text: String,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum WatchdogAction {
    Ignore,
    Pause,
    Stop,
}

#[derive(Clone, Debug, PartialEq)]
pub(super) struct Watchdog {
    pub variable: String,
    pub period_s: f64,
    pub since_s: f64,
    pub action: WatchdogAction,
}

/// Registers in one direction.
#[derive(Clone, Debug, PartialEq)]
pub struct Registers {
    pub bits: u128,
    pub integers: [i32; REGISTERS],
    pub doubles: [f64; REGISTERS],
}

impl Default for Registers {
    fn default() -> Registers {
        Registers { bits: 0, integers: [0; REGISTERS], doubles: [0.0; REGISTERS] }
    }
}

impl Registers {
    pub fn set_bit(&mut self, bit: usize, on: bool) {
        self.bits = self.bits & !(1 << bit) | u128::from(on) << bit;
    }
}

/// The arm at the end of a cycle.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ArmState {
    pub actual: JointAngles,
    pub actual_speeds: JointAngles,
    pub target: JointAngles,
    pub target_speeds: JointAngles,
    /// The force of the surroundings on the tool, in newtons, in the controller's base frame.
    pub force_n: [f64; 3],
}

impl ArmState {
    /// The force, and the torques, which the simulation does not have.
    pub fn tcp_force(&self) -> [f64; 6] {
        let [x, y, z] = self.force_n;
        [x, y, z, 0.0, 0.0, 0.0]
    }
}

#[derive(Clone, Debug)]
pub struct SimulatedController {
    pub series: Series,
    pub(super) arm: SerialArm,
    world: PhysicsWorld,
    around: ArmSurroundings,
    /// Places of the robot's buttons on the table in the frame of the arm's base, in metres.
    buttons_m: Vec<[f64; 2]>,
    pub(super) command: JointCommand,
    before: ArmState,
    now: ArmState,
    cycles: u64,
    mode: RobotMode,
    /// The mode that follows at this time in seconds; then perhaps the next.
    next_modes: Vec<(f64, RobotMode)>,
    safety: SafetyMode,
    stopped_s: f64,
    program: Option<Program>,
    state: ProgramState,
    pending: Option<Wait>,
    /// When the program's last wait ended, in seconds: waits shorter than a cycle add up.
    pub(super) awake_s: f64,
    pub(super) watchdogs: Vec<Watchdog>,
    /// Programs that can be loaded by name, and the name of the loaded one.
    programs: BTreeMap<String, String>,
    loaded: Option<String>,
    pub inputs: Registers,
    pub outputs: Registers,
    /// When clients last sent an input variable, in seconds.
    updated: BTreeMap<String, f64>,
    /// Which connection may set an input variable.
    pub(super) claimed: BTreeMap<String, u64>,
    /// The share of the speed that the slider allows, from 0 to 1.
    pub speed_slider: f64,
    pub digital_inputs: u64,
    pub digital_outputs: u64,
    pub analog_outputs: [f64; 2],
    pub payload_kg: f64,
    hand: Option<HandPose>,
    failed_joint: Option<usize>,
    deviating_cycles: u32,
    messages: Vec<ControllerMessage>,
}

impl SimulatedController {
    /// A controller without power, whose arm stands above the middle of the robot's buttons of this kitchen.
    pub fn new(kitchen: &Kitchen, series: Series) -> SimulatedController {
        let arm = SerialArm::ur5();
        let around = ArmSurroundings { table_m: kitchen.table_height_m, obstacles: Vec::new() };
        let buttons_m: Vec<[f64; 2]> = kitchen.buttons[Agent::Robot.index()].iter().map(|button| button.at_m).collect();
        let poses: Vec<_> = buttons_m.iter().filter_map(|&place| arm.at_button(place, &around).ok()).collect();
        let here = resting_pose(&poses.iter().collect::<Vec<_>>());
        let world = PhysicsWorld::new(&arm, &here, &buttons_m, around.table_m);
        let at_rest = ArmState { actual: here, target: here, ..ArmState::default() };
        SimulatedController {
            series,
            arm,
            world,
            around,
            buttons_m,
            command: JointCommand::new(here),
            before: at_rest,
            now: at_rest,
            cycles: 0,
            mode: RobotMode::PowerOff,
            next_modes: Vec::new(),
            safety: SafetyMode::Normal,
            stopped_s: 0.0,
            program: None,
            state: ProgramState::Stopped,
            pending: None,
            awake_s: 0.0,
            watchdogs: Vec::new(),
            programs: BTreeMap::new(),
            loaded: None,
            inputs: Registers::default(),
            outputs: Registers::default(),
            updated: BTreeMap::new(),
            claimed: BTreeMap::new(),
            speed_slider: 1.0,
            digital_inputs: 0,
            digital_outputs: 0,
            analog_outputs: [0.0; 2],
            payload_kg: 0.0,
            hand: None,
            failed_joint: None,
            deviating_cycles: 0,
            messages: Vec::new(),
        }
    }

    /// Seconds of the controller's time since it began.
    pub fn now_s(&self) -> f64 {
        self.cycles as f64 * CYCLE_S
    }

    pub fn mode(&self) -> RobotMode {
        self.mode
    }

    pub fn safety(&self) -> SafetyMode {
        self.safety
    }

    pub fn state(&self) -> ProgramState {
        self.state
    }

    /// The line of the running program, or 0.
    pub fn line(&self) -> u32 {
        self.program.as_ref().map_or(0, Program::line)
    }

    /// Takes what the controller has to tell since the last call.
    pub fn take_messages(&mut self) -> Vec<ControllerMessage> {
        std::mem::take(&mut self.messages)
    }

    pub(super) fn tell(&mut self, level: Level, text: impl Into<String>) {
        self.messages.push(ControllerMessage { level, text: text.into() });
    }

    /// The arm at this share of the last cycle: outputs faster than the cycles go evenly from one to the next.
    pub fn arm_at(&self, share: f64) -> ArmState {
        let (before, now) = (&self.before, &self.now);
        let between = |one: &JointAngles, two: &JointAngles| {
            std::array::from_fn(|joint| one[joint] + (two[joint] - one[joint]) * share)
        };
        ArmState {
            actual: between(&before.actual, &now.actual),
            actual_speeds: between(&before.actual_speeds, &now.actual_speeds),
            target: between(&before.target, &now.target),
            target_speeds: between(&before.target_speeds, &now.target_speeds),
            force_n: now.force_n,
        }
    }

    /// The places of the robot's buttons in the controller's base frame, at their tops, in metres. The contact of each is
    /// the digital input with its number, as far as there are inputs.
    pub fn buttons(&self) -> Vec<[f64; 3]> {
        let turn = controller_from_base();
        let top_m = self.around.table_m + BUTTON_M;
        self.buttons_m.iter().map(|[x, y]| (turn * Vector3::new(*x, *y, top_m)).into()).collect()
    }

    // Power, brakes, safety.

    pub fn power_on(&mut self) {
        if self.mode == RobotMode::PowerOff && !self.safety.is_stopped() {
            self.mode = RobotMode::Booting;
            self.next_modes = vec![(self.now_s() + POWERS_S, RobotMode::Idle)];
        }
    }

    pub fn power_off(&mut self) {
        self.stop_program("the power goes off");
        // Without power the brakes fall in.
        self.command = JointCommand::new(self.command.angles);
        self.next_modes.clear();
        self.mode = RobotMode::PowerOff;
    }

    /// Releases the brakes; an arm without power gets power first.
    pub fn release_brakes(&mut self) {
        self.power_on();
        let powered_s = self.next_modes.last().map_or(self.now_s(), |(at, _)| *at);
        if matches!(self.mode, RobotMode::Idle | RobotMode::Booting) && !self.safety.is_stopped() {
            self.next_modes.push((powered_s + RELEASES_S, RobotMode::Running));
        }
    }

    /// Stops the arm on its path; a running program pauses.
    pub fn protective_stop(&mut self, why: &str) {
        if self.safety.is_stopped() {
            return;
        }
        (self.safety, self.stopped_s) = (SafetyMode::ProtectiveStop, self.now_s());
        self.pause_program();
        self.tell(Level::Error, format!("protective stop: {why}"));
    }

    /// Releases a protective stop.
    ///
    /// # Errors
    /// The answer that the manufacturer's dashboard server gives where it does not.
    pub fn unlock(&mut self) -> Result<(), &'static str> {
        if self.safety == SafetyMode::ProtectiveStop && self.now_s() - self.stopped_s < LOCKED_S {
            return Err(
                "Cannot unlock protective stop until 5s after occurrence. Always inspect cause of protective stop before unlocking",
            );
        }
        if self.safety == SafetyMode::ProtectiveStop {
            self.safety = SafetyMode::Normal;
        }
        Ok(())
    }

    pub fn emergency_stop(&mut self) {
        (self.safety, self.stopped_s) = (SafetyMode::EmergencyStop, self.now_s());
        self.stop_program("emergency stop");
        self.command.stop(SAFETY_STOP_RAD_S2);
        self.next_modes.clear();
        self.tell(Level::Error, "emergency stop");
    }

    /// Pulls the emergency stop's button out again: the arm then has no power.
    pub fn reset_emergency_stop(&mut self) {
        if self.safety == SafetyMode::EmergencyStop {
            (self.safety, self.mode) = (SafetyMode::Normal, RobotMode::PowerOff);
        }
    }

    /// Starts the safety system again after a fault: the arm then has no power.
    pub fn restart_safety(&mut self) {
        if self.safety == SafetyMode::Fault {
            (self.safety, self.mode, self.failed_joint) = (SafetyMode::Normal, RobotMode::PowerOff, None);
        }
    }

    /// Disables the motor of a joint; the first has the number 0.
    pub fn fail_joint(&mut self, joint: usize) {
        self.failed_joint = Some(joint);
        self.world.fail(Some(joint));
    }

    /// Puts a hand at this place in the controller's base frame, in metres, or takes it away.
    pub fn put_hand(&mut self, at_m: Option<[f64; 3]>) {
        let in_base = |at_m: [f64; 3]| controller_from_base().inverse() * Vector3::from(at_m);
        let table_m = self.around.table_m;
        self.hand = at_m.map(|at_m| HandPose::reaching(in_base(at_m).into(), table_m));
    }

    // Programs.

    /// Makes a program loadable under this name.
    pub fn add_program(&mut self, name: &str, text: &str) {
        self.programs.insert(name.to_string(), text.to_string());
    }

    /// Loads a program by its name; the ending does not matter. Whether there is one.
    pub fn load(&mut self, path: &str) -> bool {
        let stem = |name: &str| {
            let file = name.rsplit('/').next().unwrap_or(name);
            file.rsplit_once('.').map_or(file, |(stem, _)| stem).to_string()
        };
        let found = self.programs.keys().find(|name| stem(name) == stem(path)).cloned();
        let Some(found) = found else { return false };
        self.stop_program("another program is loaded");
        self.loaded = Some(found);
        true
    }

    pub fn loaded(&self) -> Option<&str> {
        self.loaded.as_deref()
    }

    /// The name of the running program, or of the loaded one.
    pub fn program_name(&self) -> Option<&str> {
        self.program.as_ref().map(Program::name).or(self.loaded())
    }

    /// Goes on with a paused program, or starts the loaded one. Whether it does.
    pub fn play(&mut self) -> bool {
        if self.mode != RobotMode::Running || self.safety.is_stopped() {
            return false;
        }
        if self.state == ProgramState::Paused {
            // A watchdog counts from now on.
            let now_s = self.now_s();
            self.watchdogs.iter_mut().for_each(|watchdog| watchdog.since_s = now_s);
            self.state = ProgramState::Playing;
            return true;
        }
        let text = self.loaded.as_ref().and_then(|name| self.programs.get(name)).cloned();
        text.is_some_and(|text| self.run_script(&text))
    }

    /// Runs a script instead of the present program. Whether it begins; why not is a message.
    pub fn run_script(&mut self, text: &str) -> bool {
        if self.mode != RobotMode::Running || self.safety.is_stopped() {
            let (mode, safety) = (self.mode, self.safety.name());
            self.tell(
                Level::Error,
                format!("the script does not run: the robot's mode is {mode}, its safety mode {safety}"),
            );
            return false;
        }
        match Script::read(text) {
            Ok(script) => {
                self.stop_program("another script begins");
                self.program = Some(Program::new(script));
                (self.state, self.pending, self.awake_s) = (ProgramState::Playing, None, self.now_s());
                true
            }
            Err(error) => {
                self.tell(Level::Error, format!("the script does not run: {error}"));
                false
            }
        }
    }

    /// Pauses a running program: the arm stops on its path. Whether a program was running.
    pub fn pause_program(&mut self) -> bool {
        let plays = self.state == ProgramState::Playing;
        if plays {
            self.state = ProgramState::Paused;
        }
        plays
    }

    /// Ends the program; the arm brakes.
    pub fn stop_program(&mut self, why: &str) {
        if let Some(program) = self.program.take() {
            let name = program.name().to_string();
            self.tell(Level::Info, format!("{name} stopped: {why}"));
            self.end_program();
        }
    }

    fn end_program(&mut self) {
        (self.program, self.state, self.pending) = (None, ProgramState::Stopped, None);
        self.watchdogs.clear();
        self.command.stop(SAFETY_STOP_RAD_S2);
    }

    /// Notes that a client sent this input variable.
    pub(super) fn note_update(&mut self, variable: &str) {
        self.updated.insert(variable.to_string(), self.now_s());
    }

    fn check_watchdogs(&mut self) {
        if self.state != ProgramState::Playing {
            return;
        }
        let now_s = self.now_s();
        let silent = |watchdog: &&Watchdog| {
            let last_s = self.updated.get(&watchdog.variable).copied().unwrap_or(0.0).max(watchdog.since_s);
            now_s - last_s > watchdog.period_s + CYCLE_S / 2.0
        };
        let Some(watchdog) = self.watchdogs.iter().find(silent) else { return };
        let (variable, action) = (watchdog.variable.clone(), watchdog.action);
        match action {
            WatchdogAction::Ignore => {}
            WatchdogAction::Pause => {
                self.tell(Level::Warning, format!("the program pauses: {variable} was not sent in time"));
                self.pause_program();
            }
            WatchdogAction::Stop => self.stop_program(&format!("{variable} was not sent in time")),
        }
    }

    fn run_program(&mut self) {
        while self.state == ProgramState::Playing && self.is_awake() {
            let Some(mut program) = self.program.take() else { return };
            let step = program.run(self);
            self.program = Some(program);
            match step {
                Ok(Step::Ended) => self.end_program(),
                Ok(Step::Waits(wait)) => self.pending = Some(wait),
                Err(ScriptError { line, found }) => {
                    self.tell(Level::Error, format!("the program fails in line {line}: {found}"));
                    self.stop_program("it failed");
                }
            }
        }
    }

    /// Whether what the program waits for has come.
    fn is_awake(&mut self) -> bool {
        let now_s = self.now_s();
        let at_s = match self.pending {
            None => now_s,
            Some(Wait::Motion) if self.command.motion.is_none() => now_s,
            // Sums of waits are rounded.
            Some(Wait::Until(at_s)) if at_s <= now_s + 1e-9 => at_s.max(now_s - CYCLE_S),
            Some(_) => return false,
        };
        (self.pending, self.awake_s) = (None, at_s);
        true
    }

    // The cycle.

    /// Goes on by 8 ms.
    pub fn cycle(&mut self) {
        self.cycles += 1;
        if self.next_modes.first().is_some_and(|(at, _)| *at <= self.now_s()) {
            self.mode = self.next_modes.remove(0).1;
        }
        self.check_watchdogs();
        self.run_program();
        if self.mode == RobotMode::Running {
            self.move_arm();
        }
        self.aim();
        let felt = self.world.cycle(&self.command.angles, self.hand);
        let (actual, actual_speeds) = self.world.joints();
        let on_tool = Vector3::z() * felt.button_n - Vector3::from(felt.onto_human_n);
        let force_n = controller_from_base() * on_tool;
        self.before = self.now;
        self.now = ArmState {
            actual,
            actual_speeds,
            target: self.command.angles,
            target_speeds: self.command.speeds,
            force_n: force_n.into(),
        };
        self.judge(felt.human_n + felt.button_n);
        self.read_buttons();
    }

    fn move_arm(&mut self) {
        let holds = self.state == ProgramState::Paused || self.safety.is_stopped();
        let share = if self.safety.is_stopped() { 1.0 } else { self.speed_slider };
        let prior = self.command.clone();
        let moved = self.command.cycle(&self.arm, share, holds);
        let fault = moved.err().or_else(|| self.fault());
        if let Some(fault) = fault {
            self.command = prior;
            self.protective_stop(fault);
            self.stop_program(fault);
            self.command.stop(SAFETY_STOP_RAD_S2);
            // A stop goes on where the arm was going, and cannot fail.
            let _ = self.command.cycle(&self.arm, 1.0, false);
        }
        if self.safety == SafetyMode::EmergencyStop && self.command.is_still() {
            self.mode = RobotMode::PowerOff;
        }
    }

    /// Why the arm must not go where it is commanded to; nothing while it is stopped.
    fn fault(&self) -> Option<&'static str> {
        if self.safety.is_stopped() || self.command.is_still() {
            return None;
        }
        if !self.arm.is_within_limits(&self.command.angles) {
            return Some("a joint is at its limit");
        }
        self.arm.in_the_way(&self.command.angles, &self.around).map(|_| "the arm would hit the table or itself")
    }

    /// Activates the button under the tip in the physics.
    fn aim(&mut self) {
        let tip = self.arm.tip(&self.world.joints().0).translation.vector;
        let is_low = tip.z < self.around.table_m + BUTTON_M + MAY_TOUCH_M;
        let under = |[x, y]: &[f64; 2]| (tip.x - x).hypot(tip.y - y) < OVER_M;
        self.world.aim_at(self.buttons_m.iter().position(under).filter(|_| is_low));
    }

    fn judge(&mut self, force_n: f64) {
        if force_n > SafetyMode::Normal.threshold_n() {
            self.protective_stop(&format!("a contact of {force_n:.0} N"));
        }
        let off = |joint: usize| (self.now.actual[joint] - self.now.target[joint]).abs();
        let deviates = (0..JOINTS).any(|joint| off(joint) > DEVIATION_RAD);
        self.deviating_cycles = if deviates { self.deviating_cycles + 1 } else { 0 };
        if self.deviating_cycles < DEVIATION_CYCLES || self.safety.is_stopped() {
            return;
        }
        match self.failed_joint {
            None => self.protective_stop("the arm does not follow its command"),
            Some(joint) => {
                (self.safety, self.stopped_s) = (SafetyMode::Fault, self.now_s());
                self.stop_program("a joint does not follow its command");
                self.world.brake();
                self.command = JointCommand::new(self.world.joints().0);
                (self.mode, self.deviating_cycles) = (RobotMode::PowerOff, 0);
                self.tell(Level::Error, format!("fault: joint {} does not follow its command", joint + 1));
            }
        }
    }

    fn read_buttons(&mut self) {
        let wired = (1_u64 << self.buttons_m.len().min(INPUTS)) - 1;
        let pressed = self.world.aimed_at().filter(|_| self.world.is_pressed());
        let closed = pressed.filter(|button| *button < INPUTS).map_or(0, |button| 1 << button);
        self.digital_inputs = self.digital_inputs & !wired | closed;
    }
}
