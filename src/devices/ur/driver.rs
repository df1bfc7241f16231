//! The driver of a real UR5: carries out a session's orders leg by leg, and tells what the arm does. It has neither sockets
//! nor a clock; [`super::link`] gives it both, tests give it a simulated controller.
//!
//! The way to a button is the planner's of the simulated arm, checked against table and own links. The program in the
//! controller (`examples/ur_press.script`) follows one leg of it at a time, and stops by itself without our heartbeat. The
//! driver sends a leg only where the last one is over, or where the arm stands.

mod way;

use std::collections::VecDeque;

use tomcom_arm::body::{TOLD_EVERY, rounded};
use tomcom_arm::controller::STILL_RAD_S;
use tomcom_arm::kinematics::SerialArm;
use tomcom_arm::reach::{ArmSurroundings, ButtonPoses, UnreachableReason};
use tomcom_arm::real_arm::ArmOrder;
use tomcom_core::base::text::count;
use tomcom_core::kitchen::{Agent, ButtonId, Kitchen};
use tomcom_core::robot::{ArmPhase, ArmSample, ArmStage, JOINTS, SafetyMode};
use tomcom_session::Event;
use tomcom_session::preflight_checks::{PreflightCheck, PreflightVerdict};

use super::client::{ArmInputs, ArmReading};
use super::controller::{INPUTS, ProgramState, RobotMode};
use super::motion::tcp;
use way::{Leg, Task};

/// The program in the controller.
pub const PROGRAM: &str = include_str!("../../../examples/ur_press.script");
/// Share of the speed in a dry run, in thousandths.
const DRY_RUN: i32 = 100;
/// How far the tip may be from where this program computes it, in metres: more is another arm, or another tool.
const OFF_M: f64 = 0.005;
/// Longest time for power and brakes, for the start of the program, and to unlock, in seconds; time between tries to unlock.
const POWERS_WITHIN_S: f64 = 60.0;
const STARTS_WITHIN_S: f64 = 5.0;
const UNLOCKS_WITHIN_S: f64 = 15.0;
const UNLOCKS_EVERY_S: f64 = 1.0;
/// Why the arm does not run, until the wizard resumes it.
const SAFETY_STOP: &str = "its safety system stopped it";

/// What follows from a reading.
#[derive(Clone, Debug, PartialEq)]
pub enum DriverAction {
    /// For the session.
    Tell(Box<Event>),
    /// A command for the dashboard server.
    Dashboard(&'static str),
    /// The controller is to run [`PROGRAM`].
    Upload,
}

/// What the controller says that it is.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct ArmIdentity {
    pub model: String,
    pub software: String,
    /// Whether it takes orders from other computers; `None` where the controller does not know the question.
    pub is_remote: Option<bool>,
}

/// Whether the program runs in the controller.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Program {
    Stopped,
    /// It was sent at this time, in seconds.
    Sent(f64),
    Runs,
}

/// A press of a button under the arm.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Touch {
    button: ButtonId,
    has_clicked: bool,
}

#[derive(Clone, Debug)]
pub struct UrDriver {
    arm: SerialArm,
    around: ArmSurroundings,
    names: Vec<String>,
    poses: Vec<Result<ButtonPoses, UnreachableReason>>,
    /// For each button of the robot, the participant's button at its place, if a person presses.
    shared: Vec<Option<String>>,
    /// Share of the speed in thousandths.
    speed: i32,
    identity: ArmIdentity,
    stage: ArmStage,
    found: String,
    safety: SafetyMode,
    program: Program,
    /// When the power was asked for, and whether the brakes were.
    powers: Option<(f64, bool)>,
    /// When the next try to let the arm go on is due, if the wizard wants that, and when unlocking was tried first.
    resumes: Option<(f64, Option<f64>)>,
    wants_dry_run: bool,
    /// Whether the wizard has confirmed a dry run.
    is_tried: bool,
    order: ArmOrder,
    /// The order that is carried out, or has failed.
    over: u32,
    task: Task,
    legs: VecDeque<Leg>,
    active: Option<Leg>,
    /// Number of the active leg, or of the last.
    number: i32,
    heartbeat: i32,
    /// Whether the active leg is given up as soon as the arm stands.
    drops: bool,
    misses: u32,
    touch: Option<Touch>,
    last: Option<ArmReading>,
    /// Phase and time in seconds of the last sample, and whether the arm moved then.
    told: (Option<ArmPhase>, f64, bool),
    waiting: Vec<DriverAction>,
}

impl UrDriver {
    /// A driver without connection. `speed` is the share of the full speed; `with_person` says that presses of buttons
    /// without the arm are the participant's.
    pub fn new(kitchen: &Kitchen, speed: f64, with_person: bool) -> UrDriver {
        let arm = SerialArm::ur5();
        let around = ArmSurroundings { table_m: kitchen.table_height_m, obstacles: Vec::new() };
        let [human, robot] = [Agent::Human, Agent::Robot].map(|agent| &kitchen.buttons[agent.index()]);
        let shared = robot.iter().map(|button| {
            let same = human.iter().find(|other| other.at_m == button.at_m);
            same.filter(|_| with_person).map(|other| other.name.clone())
        });
        UrDriver {
            names: robot.iter().map(|button| button.name.clone()).collect(),
            poses: robot.iter().map(|button| arm.at_button(button.at_m, &around)).collect(),
            shared: shared.collect(),
            arm,
            around,
            speed: (speed * 1000.0).round() as i32,
            identity: ArmIdentity::default(),
            stage: ArmStage::Lost,
            found: String::new(),
            safety: SafetyMode::Normal,
            program: Program::Stopped,
            powers: None,
            resumes: None,
            wants_dry_run: false,
            is_tried: false,
            order: ArmOrder { stands: true, ..ArmOrder::default() },
            over: 0,
            task: Task::Rest,
            legs: VecDeque::new(),
            active: None,
            number: 0,
            heartbeat: 0,
            drops: false,
            misses: 0,
            touch: None,
            last: None,
            told: (None, 0.0, false),
            waiting: Vec::new(),
        }
    }

    pub fn stage(&self) -> ArmStage {
        self.stage
    }

    /// The controller is connected, and says what it is.
    pub fn introduce(&mut self, identity: ArmIdentity) {
        self.identity = identity;
    }

    // Orders.

    pub fn order(&mut self, order: ArmOrder) {
        self.order = order;
    }

    /// Nobody gives orders: the arm stands.
    pub fn stand(&mut self) {
        self.order.stands = true;
    }

    /// Another recording begins, which knows nothing of the arm.
    pub fn begin(&mut self) {
        (self.over, self.order, self.told.0) = (0, ArmOrder { stands: true, ..ArmOrder::default() }, None);
        self.waiting.push(tell(self.stage_event()));
        if self.safety != SafetyMode::Normal {
            self.waiting.push(tell(safety_event(self.safety)));
        }
    }

    /// The wizard confirms what the arm asks for in this stage, or lets it go on.
    pub fn confirm(&mut self, stage: ArmStage) {
        if stage != self.stage {
            return;
        }
        match stage {
            ArmStage::Off => {
                self.powers = Some((f64::INFINITY, false));
                self.waiting.push(DriverAction::Dashboard("power on"));
            }
            ArmStage::Untried => match self.geometry() {
                Ok(()) if self.program == Program::Runs => self.begin_dry_run(),
                Ok(()) => (self.wants_dry_run, self.resumes) = (true, Some((0.0, None))),
                Err(why) => self.to(ArmStage::Untried, why),
            },
            ArmStage::Tried => {
                self.is_tried = true;
                self.to(ArmStage::Ready, "");
            }
            ArmStage::Stopped => self.resumes = Some((0.0, None)),
            ArmStage::Lost | ArmStage::Starts | ArmStage::DryRun | ArmStage::Ready => {}
        }
    }

    /// The wizard stops the robot: a dry run ends. Other motions stand by their order.
    pub fn stop(&mut self) {
        if self.stage == ArmStage::DryRun {
            self.give_up_way();
            self.task = Task::Rest;
            self.to(ArmStage::Untried, "the wizard stopped the dry run");
        }
    }

    // What comes from the controller.

    /// The connection is lost.
    pub fn lose(&mut self, why: &str) -> Vec<DriverAction> {
        (self.last, self.powers, self.resumes) = (None, None, None);
        self.program_ends();
        self.to(ArmStage::Lost, why);
        std::mem::take(&mut self.waiting)
    }

    /// Takes what the controller reports at this time in seconds. [`Self::inputs`] then has what it is to read.
    pub fn step(&mut self, reading: &ArmReading, now_s: f64) -> Vec<DriverAction> {
        self.heartbeat = self.heartbeat.wrapping_add(1);
        if self.safety != reading.safety {
            self.safety = reading.safety;
            self.waiting.push(tell(safety_event(self.safety)));
            if self.safety.is_stopped() && self.stage == ArmStage::Stopped {
                self.to(ArmStage::Stopped, SAFETY_STOP);
            }
        }
        self.feel(reading);
        self.last = Some(*reading);
        self.follow_power(reading, now_s);
        if matches!(self.stage, ArmStage::Ready | ArmStage::DryRun) || self.drops {
            self.drive(reading);
        }
        self.sample(reading, now_s);
        std::mem::take(&mut self.waiting)
    }

    /// What the program in the controller is to read now.
    pub fn inputs(&self) -> ArmInputs {
        let share = match self.stage {
            _ if self.drops => 0,
            ArmStage::DryRun => DRY_RUN,
            ArmStage::Ready if !self.order.stands => self.speed,
            _ => 0,
        };
        let wire = self.touch.map(|touch| touch.button.index()).filter(|number| *number < INPUTS);
        let leg = self.active.as_ref();
        ArmInputs {
            heartbeat: self.heartbeat,
            leg: self.number,
            presses: leg.is_some_and(|leg| leg.presses),
            takes_ms: leg.map_or(0, |leg| (leg.takes_s * 1000.0).ceil() as i32),
            share,
            wire: wire.map_or(-1, |number| number as i32),
            poses: leg.map_or([[0.0; JOINTS]; 4], |leg| leg.poses),
        }
    }

    fn stage_event(&self) -> Event {
        Event::RobotStage { stage: self.stage, found: self.found.clone() }
    }

    fn to(&mut self, stage: ArmStage, found: impl Into<String>) {
        let found = found.into();
        if (self.stage, &self.found) != (stage, &found) {
            (self.stage, self.found) = (stage, found);
            self.waiting.push(tell(self.stage_event()));
        }
    }

    fn follow_power(&mut self, reading: &ArmReading, now_s: f64) {
        if reading.mode != RobotMode::Running as i32 {
            self.program_ends();
            self.resumes = None;
            return self.follow_switch(reading, now_s);
        }
        if self.powers.take().is_some() && self.is_tried {
            self.resumes = Some((now_s, None));
        }
        if reading.safety.is_stopped() {
            self.program_ends();
            return self.unlock(reading.safety, now_s);
        }
        let plays = reading.runtime == ProgramState::Playing as u32;
        match self.program {
            Program::Runs if plays || reading.safety == SafetyMode::Safeguard => {}
            Program::Runs => {
                self.program_ends();
                self.to(ArmStage::Stopped, "somebody stopped its program, or our heartbeat came late");
            }
            Program::Sent(_) if plays => {
                (self.program, self.resumes, self.misses) = (Program::Runs, None, 0);
                if self.wants_dry_run {
                    self.begin_dry_run();
                } else {
                    self.to(if self.is_tried { ArmStage::Ready } else { ArmStage::Untried }, "");
                }
            }
            Program::Sent(at_s) if now_s - at_s < STARTS_WITHIN_S => {}
            Program::Sent(_) => {
                self.program_ends();
                self.resumes = None;
                self.to(ArmStage::Stopped, "its program does not start: see the messages on the teach pendant");
            }
            // The program takes the leg that it finds at its start for an old one.
            Program::Stopped if self.resumes.is_some() && reading.leg == self.number => {
                self.program = Program::Sent(now_s);
                self.waiting.push(DriverAction::Upload);
                self.to(ArmStage::Starts, "its program starts");
            }
            Program::Stopped if self.resumes.is_some() => {}
            Program::Stopped => match self.stage {
                ArmStage::Untried | ArmStage::Stopped => {}
                _ if self.is_tried => self.to(ArmStage::Stopped, "its program is to be started"),
                _ => self.to(ArmStage::Untried, ""),
            },
        }
    }

    /// Without power, or while it comes on.
    fn follow_switch(&mut self, reading: &ArmReading, now_s: f64) {
        let Some((since_s, released)) = self.powers else {
            let why = if reading.safety.is_stopped() { reading.safety.name() } else { "" };
            return self.to(ArmStage::Off, why);
        };
        let since_s = since_s.min(now_s);
        if now_s - since_s > POWERS_WITHIN_S {
            self.powers = None;
            return self.to(ArmStage::Off, "the power did not come on: see the teach pendant");
        }
        let releases = reading.mode == RobotMode::Idle as i32 && !released;
        if releases {
            self.waiting.push(DriverAction::Dashboard("brake release"));
        }
        self.powers = Some((since_s, released || releases));
        self.to(ArmStage::Starts, "the power comes on, and the brakes open");
    }

    fn unlock(&mut self, safety: SafetyMode, now_s: f64) {
        match self.resumes {
            None if self.stage == ArmStage::Stopped => {}
            None => self.to(ArmStage::Stopped, SAFETY_STOP),
            Some(_) if safety != SafetyMode::ProtectiveStop => {
                self.resumes = None;
                self.to(ArmStage::Stopped, format!("end the {} at the teach pendant", safety.name().to_lowercase()));
            }
            Some((due_s, first_s)) if now_s >= due_s => {
                let first_s = first_s.unwrap_or(now_s);
                if now_s - first_s > UNLOCKS_WITHIN_S {
                    self.resumes = None;
                    return self.to(ArmStage::Stopped, "it cannot be unlocked from here: see the teach pendant");
                }
                self.resumes = Some((now_s + UNLOCKS_EVERY_S, Some(first_s)));
                let commands = ["close safety popup", "unlock protective stop"].map(DriverAction::Dashboard);
                self.waiting.extend(commands);
                self.to(ArmStage::Starts, "it is unlocked, at the earliest 5 s after the stop");
            }
            Some(_) => {}
        }
    }

    fn program_ends(&mut self) {
        (self.program, self.task, self.wants_dry_run) = (Program::Stopped, Task::Rest, false);
        self.legs.clear();
        (self.active, self.drops) = (None, false);
    }

    // What the session is told.

    /// Tells clicks: under the arm its own, elsewhere those of a person.
    fn feel(&mut self, reading: &ArmReading) {
        let Some(before) = self.last else { return };
        let closed = reading.inputs & !before.inputs;
        for number in (0..self.names.len().min(INPUTS)).filter(|number| closed >> number & 1 == 1) {
            match self.touch.filter(|touch| touch.button.index() == number) {
                Some(touch) => self.click(touch),
                None => {
                    let press = |button: &String| {
                        let button = button.clone();
                        tell(Event::Press { agent: Agent::Human, button, at_ns: None, button_box: false })
                    };
                    self.waiting.extend(self.shared[number].as_ref().map(press));
                }
            }
        }
    }

    fn sample(&mut self, reading: &ArmReading, now_s: f64) {
        let phase = match (&self.active, &self.task) {
            (Some(leg), _) => leg.phase,
            (None, Task::Waits(..)) => ArmPhase::Hovers,
            (None, _) => ArmPhase::Rests,
        };
        let moves = !is_still(reading);
        let (told, at_s, moved) = self.told;
        let is_old = moves && now_s - at_s >= TOLD_EVERY.as_secs_f64();
        if told != Some(phase) || moved && !moves || is_old {
            self.told = (Some(phase), now_s, moves);
            let joints = reading.joints.map(|angle| rounded(angle, 1e4));
            let force_n = rounded(reading.force_n, 10.0);
            let sample = ArmSample { phase, joints, force_n, ..ArmSample::default() };
            self.waiting.push(tell(Event::RobotMoves(sample)));
        }
    }

    // Checks.

    /// Whether the arm is where this program computes it to be.
    fn geometry(&self) -> Result<(), String> {
        let Some(reading) = &self.last else { return Err("nothing is known of the arm".to_string()) };
        let [x, y, z, ..] = reading.tip;
        let here = tcp(&self.arm, &reading.joints).translation.vector;
        let off_m = (here - nalgebra::Vector3::new(x, y, z)).norm();
        if off_m < OFF_M {
            return Ok(());
        }
        let off_mm = off_m * 1000.0;
        Err(format!(
            "the tip is {off_mm:.0} mm from where a UR5 has it: it is another arm, or its tool centre point is not the \
             stick's tip"
        ))
    }

    /// The checks of arm and controller before a trial.
    pub fn checks(&self) -> Vec<PreflightCheck> {
        use PreflightVerdict::{Failed, Warning};
        let Some(reading) = &self.last else { return Vec::new() };
        let ArmIdentity { model, software, is_remote } = &self.identity;
        let found = format!("{model}, software {software}");
        let controller = match is_remote {
            Some(false) => {
                let remedy = "switch it to remote control at the teach pendant";
                PreflightCheck::new("controller", Failed, format!("{found}; it takes no orders"), remedy)
            }
            _ => PreflightCheck::ok("controller", found),
        };
        let far = self.poses.iter().zip(&self.names).find_map(|(poses, name)| Some((name, poses.err()?)));
        let reach = match (far, self.geometry()) {
            (Some((name, why)), _) => {
                PreflightCheck::new("reach", Failed, format!("{name} stands {}", why.words()), "another layout")
            }
            (None, Err(why)) => {
                let remedy = "set the tool centre point at the teach pendant; docs/real-arm.md has the stick's length";
                PreflightCheck::new("reach", Failed, why, remedy)
            }
            (None, Ok(())) => {
                let buttons = count(self.names.len() as u64, "button", "buttons");
                PreflightCheck::ok(
                    "reach",
                    format!("{buttons} within reach and clear; payload {:.2} kg", reading.payload_kg),
                )
            }
        };
        let share = self.speed as f64 / 10.0;
        let slider = match reading.slider {
            slider if slider < 0.99 => {
                let found =
                    format!("the speed slider is at {:.0} %, beside the session's {share:.0} %", slider * 100.0);
                PreflightCheck::new("arm speed", Warning, found, "set the slider at the teach pendant to 100 %")
            }
            _ => PreflightCheck::ok("arm speed", format!("{share:.0} % of the full speed")),
        };
        vec![controller, reach, slider]
    }
}

fn is_still(reading: &ArmReading) -> bool {
    reading.speeds.iter().all(|speed| speed.abs() < STILL_RAD_S)
}

fn tell(event: Event) -> DriverAction {
    DriverAction::Tell(Box::new(event))
}

fn safety_event(mode: SafetyMode) -> Event {
    Event::RobotSafety { mode, force_n: None, joint: None }
}
