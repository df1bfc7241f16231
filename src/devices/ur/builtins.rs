//! The functions of URScript that the simulated controller has.

use super::controller::{INPUTS, Level, REGISTERS, SimulatedController, Watchdog, WatchdogAction};
use super::motion::{CYCLE_S, Motion, Path, inverse, isometry, norm, six, tcp, tcp_speed};
use super::program::{Arguments, Outcome, Value, Wait};

/// Default acceleration and speed of `movej` (radians) and `movel` (metres), and deceleration of a stop.
const MOVEJ: [f64; 2] = [1.4, 1.05];
const MOVEL: [f64; 2] = [1.2, 0.25];
/// Least time of `sleep`, in seconds: a program that only sleeps must not hold up the controller.
const LEAST_SLEEP_S: f64 = 0.001;
/// Least time constant of `servoj`, in seconds.
const LEAST_LOOKAHEAD_S: f64 = 0.03;

impl SimulatedController {
    /// Calls a function; `None` if there is none of this name.
    pub(super) fn call(&mut self, name: &str, arguments: &Arguments) -> Option<Result<Outcome, String>> {
        let found = match name {
            "movej" | "movel" => self.move_along(name, arguments),
            "servoj" => self.servo(arguments),
            "speedj" | "speedl" => self.at_speed(name, arguments),
            "stopj" | "stopl" => self.stop_motion(name, arguments),
            "sleep" => arguments.number("t", 0).map(|seconds| self.wait(seconds.max(LEAST_SLEEP_S))),
            "sync" => Ok(Outcome::Waits(Wait::Until(self.now_s() + CYCLE_S))),
            "halt" => Ok(Outcome::Halts),
            "textmsg" | "popup" => self.say(arguments),
            "rtde_set_watchdog" => self.set_watchdog(arguments),
            "set_payload" => arguments.number("m", 0).map(|kilograms| {
                self.payload_kg = kilograms;
                Outcome::Nothing
            }),
            _ => {
                return self
                    .register(name, arguments)
                    .or_else(|| self.reading(name, arguments))
                    .or_else(|| maths(name, arguments));
            }
        };
        Some(found)
    }

    fn wait(&self, seconds: f64) -> Outcome {
        Outcome::Waits(Wait::Until(self.awake_s + seconds))
    }

    fn move_along(&mut self, name: &str, arguments: &Arguments) -> Result<Outcome, String> {
        let (first, [acceleration, speed]) = if name == "movej" { ("q", MOVEJ) } else { ("pose", MOVEL) };
        arguments.are_among(&[first, "a", "v", "t", "r"])?;
        let goal = arguments.six(first, 0)?;
        let given_pose = matches!(arguments.get(first, 0), Some(Value::Pose(_)));
        let [a, v] = [arguments.number_or("a", 1, acceleration)?, arguments.number_or("v", 2, speed)?];
        let takes_s = arguments.number_or("t", 3, 0.0)?;
        if a <= 0.0 || v <= 0.0 || takes_s < 0.0 {
            return Err("an acceleration or a speed that is not above 0".to_string());
        }
        let here = self.command.angles;
        let path = match (name, given_pose) {
            ("movej", false) => Path::Joints { from: here, to: goal },
            ("movej", true) => {
                let to = inverse(&self.arm, &isometry(goal), &here).ok_or("the pose is out of reach")?;
                Path::Joints { from: here, to }
            }
            (_, true) => Path::Line { from: tcp(&self.arm, &here), to: isometry(goal) },
            (_, false) => Path::Line { from: tcp(&self.arm, &here), to: tcp(&self.arm, &goal) },
        };
        self.command.motion = Some(Motion::along(path, v, a, takes_s));
        Ok(Outcome::Waits(Wait::Motion))
    }

    fn servo(&mut self, arguments: &Arguments) -> Result<Outcome, String> {
        arguments.are_among(&["q", "a", "v", "t", "lookahead_time", "gain"])?;
        let lookahead_s = arguments.number_or("lookahead_time", 4, 0.1)?.max(LEAST_LOOKAHEAD_S);
        self.command.motion = Some(Motion::Follow { target: arguments.six("q", 0)?, lookahead_s });
        let takes_s = arguments.number_or("t", 3, self.step_s())?;
        Ok(self.wait(takes_s.max(self.step_s())))
    }

    fn step_s(&self) -> f64 {
        1.0 / self.series.hertz()
    }

    fn at_speed(&mut self, name: &str, arguments: &Arguments) -> Result<Outcome, String> {
        let (first, acceleration) = if name == "speedj" { ("qd", MOVEJ[0]) } else { ("xd", MOVEL[0]) };
        arguments.are_among(if name == "speedj" { &["qd", "a", "t"] } else { &["xd", "a", "t", "aRot"] })?;
        let speeds = arguments.six(first, 0)?;
        let acceleration = arguments.number_or("a", 1, acceleration)?;
        if acceleration <= 0.0 {
            return Err("an acceleration that is not above 0".to_string());
        }
        let fastest = speeds.iter().map(|speed| speed.abs()).fold(0.0, f64::max);
        self.command.motion = Some(match name {
            "speedj" => Motion::Turn { speeds, acceleration },
            _ => Motion::Move { speeds, acceleration },
        });
        let takes_s = arguments.number_or("t", 2, fastest / acceleration)?;
        Ok(self.wait(takes_s.max(self.step_s())))
    }

    fn stop_motion(&mut self, name: &str, arguments: &Arguments) -> Result<Outcome, String> {
        let a = arguments.number_or("a", 0, 2.0)?;
        if a <= 0.0 {
            return Err("a deceleration that is not above 0".to_string());
        }
        // Of a straight line, the leading joint slows down as the tool does.
        let leading = self.command.speeds.iter().map(|speed| speed.abs()).fold(0.0, f64::max);
        let tool_m_s = norm(&tcp_speed(&self.arm, &self.command.angles, &self.command.speeds)[..3]);
        let deceleration = if name == "stopl" && tool_m_s > 1e-3 { a * leading / tool_m_s } else { a };
        self.command.stop(deceleration);
        Ok(Outcome::Waits(Wait::Motion))
    }

    fn say(&mut self, arguments: &Arguments) -> Result<Outcome, String> {
        let text: String = arguments.by_place.iter().map(Value::words).collect();
        self.tell(Level::Info, text);
        Ok(Outcome::Nothing)
    }

    fn set_watchdog(&mut self, arguments: &Arguments) -> Result<Outcome, String> {
        arguments.are_among(&["variable_name", "min_frequency", "action"])?;
        let variable = arguments.text("variable_name", 0)?.to_string();
        if super::variables::input(&variable).is_none() {
            return Err(format!("{variable:?} is no input variable"));
        }
        let hertz = arguments.number("min_frequency", 1)?;
        if hertz <= 0.0 {
            return Err(format!("a least frequency of {hertz}; it is above 0"));
        }
        let action = match arguments.get("action", 2) {
            None => WatchdogAction::Pause,
            Some(Value::Text(text)) if text == "pause" => WatchdogAction::Pause,
            Some(Value::Text(text)) if text == "stop" => WatchdogAction::Stop,
            Some(Value::Text(text)) if text == "ignore" => WatchdogAction::Ignore,
            Some(other) => return Err(format!("action {}; there are pause, stop and ignore", other.words())),
        };
        let since_s = self.now_s();
        self.watchdogs.retain(|one| one.variable != variable);
        self.watchdogs.push(Watchdog { variable, period_s: 1.0 / hertz, since_s, action });
        Ok(Outcome::Nothing)
    }

    /// Registers, digital inputs and outputs.
    fn register(&mut self, name: &str, arguments: &Arguments) -> Option<Result<Outcome, String>> {
        let short = match name {
            _ if name.contains("_digital_") => return self.digital(name, arguments),
            _ => name.strip_suffix("_register").or_else(|| name.strip_suffix("_reg"))?,
        };
        let number = || place(arguments, "address", 0, REGISTERS);
        let bit = || place(arguments, "address", 0, 128);
        Some(match short {
            "read_input_integer" => number().map(|at| value(f64::from(self.inputs.integers[at]))),
            "read_input_float" => number().map(|at| value(self.inputs.doubles[at])),
            "read_input_boolean" => bit().map(|at| truth(self.inputs.bits >> at & 1 == 1)),
            "read_output_integer" => number().map(|at| value(f64::from(self.outputs.integers[at]))),
            "read_output_float" => number().map(|at| value(self.outputs.doubles[at])),
            "read_output_boolean" => bit().map(|at| truth(self.outputs.bits >> at & 1 == 1)),
            "write_output_integer" => number().and_then(|at| {
                self.outputs.integers[at] = arguments.number("value", 1)? as i32;
                Ok(Outcome::Nothing)
            }),
            "write_output_float" => number().and_then(|at| {
                self.outputs.doubles[at] = arguments.number("value", 1)?;
                Ok(Outcome::Nothing)
            }),
            "write_output_boolean" => bit().and_then(|at| {
                self.outputs.set_bit(at, arguments.truth("value", 1)?);
                Ok(Outcome::Nothing)
            }),
            _ => return None,
        })
    }

    /// A digital input or output, such as `get_standard_digital_in(n)`.
    fn digital(&mut self, name: &str, arguments: &Arguments) -> Option<Result<Outcome, String>> {
        let (what, way) = name.split_once("_digital_")?;
        let (verb, kind) = what.split_once('_')?;
        let (first, count) = match kind {
            "standard" => (0, 8),
            "configurable" => (8, 8),
            "tool" => (16, INPUTS - 16),
            _ => return None,
        };
        let bit = |bits: u64| place(arguments, "n", 0, count).map(|at| truth(bits >> (first + at) & 1 == 1));
        Some(match (verb, way) {
            ("get", "in") => bit(self.digital_inputs),
            ("get", "out") => bit(self.digital_outputs),
            ("set", "out") => place(arguments, "n", 0, count).and_then(|at| {
                let (at, on) = (first + at, arguments.truth("b", 1)?);
                self.digital_outputs = self.digital_outputs & !(1 << at) | u64::from(on) << at;
                Ok(Outcome::Nothing)
            }),
            _ => return None,
        })
    }

    /// What the program can ask about the arm.
    fn reading(&mut self, name: &str, arguments: &Arguments) -> Option<Result<Outcome, String>> {
        let arm = self.arm_at(1.0);
        Some(Ok(match name {
            "get_actual_joint_positions" => Outcome::Value(Value::list(&arm.actual)),
            "get_actual_joint_speeds" => Outcome::Value(Value::list(&arm.actual_speeds)),
            "get_target_joint_positions" => Outcome::Value(Value::list(&self.command.angles)),
            "get_target_joint_speeds" => Outcome::Value(Value::list(&self.command.speeds)),
            "get_actual_tcp_pose" => Outcome::Value(Value::Pose(six(&tcp(&self.arm, &arm.actual)))),
            "get_target_tcp_pose" => Outcome::Value(Value::Pose(six(&tcp(&self.arm, &self.command.angles)))),
            "get_actual_tcp_speed" => {
                Outcome::Value(Value::list(&tcp_speed(&self.arm, &arm.actual, &arm.actual_speeds)))
            }
            "get_tcp_force" => Outcome::Value(Value::list(&arm.tcp_force())),
            "force" => value(norm(&arm.force_n)),
            "get_steptime" => value(self.step_s()),
            "get_target_payload" => value(self.payload_kg),
            "is_steady" => truth(self.command.is_still()),
            "get_forward_kin" => {
                let joints = arguments.six_or("q", 0, arm.actual);
                return Some(joints.map(|joints| Outcome::Value(Value::Pose(six(&tcp(&self.arm, &joints))))));
            }
            "get_inverse_kin" => return Some(self.inverse_kin(arguments)),
            _ => return None,
        }))
    }

    fn inverse_kin(&self, arguments: &Arguments) -> Result<Outcome, String> {
        let near = arguments.six_or("qnear", 1, self.command.angles)?;
        let found = inverse(&self.arm, &isometry(arguments.six("x", 0)?), &near);
        found.map(|joints| Outcome::Value(Value::list(&joints))).ok_or_else(|| "the pose is out of reach".to_string())
    }
}

fn value(number: f64) -> Outcome {
    Outcome::Value(Value::Number(number))
}

fn truth(truth: bool) -> Outcome {
    Outcome::Value(Value::Truth(truth))
}

/// A whole number below `count`.
fn place(arguments: &Arguments, name: &str, at: usize, count: usize) -> Result<usize, String> {
    let number = arguments.number(name, at)?;
    let is_place = number >= 0.0 && number.fract() == 0.0 && (number as usize) < count;
    is_place.then_some(number as usize).ok_or_else(|| format!("{name} is {number}; there are 0 to {}", count - 1))
}

fn maths(name: &str, arguments: &Arguments) -> Option<Result<Outcome, String>> {
    let number = |place: usize| arguments.number("its value", place);
    let of_one = |compute: fn(f64) -> f64| Some(number(0).map(|one| value(compute(one))));
    let of_two = |compute: fn(f64, f64) -> f64| Some(number(0).and_then(|one| Ok(value(compute(one, number(1)?)))));
    match name {
        "sin" => of_one(f64::sin),
        "cos" => of_one(f64::cos),
        "tan" => of_one(f64::tan),
        "sqrt" => of_one(f64::sqrt),
        "floor" => of_one(f64::floor),
        "ceil" => of_one(f64::ceil),
        "d2r" => of_one(f64::to_radians),
        "r2d" => of_one(f64::to_degrees),
        "atan2" => of_two(f64::atan2),
        "pow" => of_two(f64::powf),
        "norm" => Some(match arguments.get("a", 0) {
            Some(Value::Number(one)) => Ok(value(one.abs())),
            _ => arguments.six("a", 0).map(|six| value(norm(&six))),
        }),
        "to_str" => Some(Ok(Outcome::Value(Value::Text(arguments.by_place.iter().map(Value::words).collect())))),
        "pose_trans" => Some(arguments.six("p_from", 0).and_then(|from| {
            let pose = isometry(from) * isometry(arguments.six("p_from_to", 1)?);
            Ok(Outcome::Value(Value::Pose(six(&pose))))
        })),
        _ => None,
    }
}
