//! A connection to the Real-Time Data Exchange interface, from the client's side: bytes in, bytes out. It negotiates, reads
//! what the driver needs of the controller, and writes what the program in the controller reads.

use thiserror::Error;
use tomcom_core::robot::{JointAngles, SafetyMode};

use super::rtde::{PackageReader, RtdeFault, package};
use super::variables::{Datum, safety_mode};

/// What is read, in this order, 125 times a second.
const OUTPUTS: [&str; 15] = [
    "actual_q",
    "actual_qd",
    "actual_TCP_force",
    "robot_mode",
    "safety_mode",
    "runtime_state",
    "target_speed_fraction",
    "actual_digital_input_bits",
    "output_int_register_24",
    "output_int_register_25",
    "output_int_register_26",
    "output_double_register_24",
    "output_double_register_25",
    "input_int_register_25",
    "actual_TCP_pose",
];
const HERTZ: f64 = 125.0;
/// First register of the program, and its number of whole numbers and of decimals: see `examples/ur_press.script`.
const FIRST: usize = 24;
const INTEGERS: usize = 6;
const DOUBLES: usize = 24;

/// Why a connection is of no use.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum ClientFault {
    #[error("{0}")]
    Package(#[from] RtdeFault),
    #[error("the controller does not know version 2 of the protocol: its software is older than 3.4")]
    Version,
    #[error("the controller has no variable {0}: its software is older than 3.9")]
    Unknown(String),
    #[error("another program writes {0}: end it, or its fieldbus")]
    InUse(String),
    #[error("an answer {0:?} that is too short, too long, or of another type")]
    Content(char),
    #[error("the controller does not start to send")]
    NotStarted,
}

/// What the controller reports.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ArmReading {
    pub joints: JointAngles,
    /// Radians per second.
    pub speeds: JointAngles,
    /// Force at the tool in newtons.
    pub force_n: f64,
    /// RTDE's number of the robot's mode.
    pub mode: i32,
    pub safety: SafetyMode,
    /// RTDE's number of the program's state.
    pub runtime: u32,
    /// Share of the speed that the slider allows.
    pub slider: f64,
    /// Digital inputs that are on, a bit each.
    pub inputs: u64,
    /// Number of the last leg that is over, and what came of it.
    pub done: i32,
    pub result: i32,
    /// Whether the program lets the arm stand.
    pub stands: bool,
    /// By how much the force grew at most in the last leg, in newtons.
    pub grew_n: f64,
    pub payload_kg: f64,
    /// The number of the leg that arrived last.
    pub leg: i32,
    /// Where the controller says that the tool centre point is, in its base frame: metres, and a rotation vector.
    pub tip: [f64; 6],
}

/// What the program in the controller reads: see `examples/ur_press.script`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ArmInputs {
    pub heartbeat: i32,
    /// Number of the leg.
    pub leg: i32,
    pub presses: bool,
    pub takes_ms: i32,
    /// In thousandths of the full speed.
    pub share: i32,
    /// Digital input of the button's contact, or -1.
    pub wire: i32,
    pub poses: [JointAngles; 4],
}

/// What came from the controller.
#[derive(Clone, Debug, PartialEq)]
pub enum ClientNews {
    Reading(Box<ArmReading>),
    /// A warning or an error in its words.
    Message(String),
}

/// One connection.
#[derive(Clone, Debug, Default)]
pub struct RtdeClient {
    packages: PackageReader,
    outputs: Vec<Datum>,
    inputs: Vec<Datum>,
    is_started: bool,
}

impl RtdeClient {
    /// What a new connection begins with.
    pub fn hello() -> Vec<u8> {
        package(b'V', &2_u16.to_be_bytes())
    }

    /// Takes bytes from the controller; returns what is to be sent, and what they tell.
    ///
    /// # Errors
    /// Why the connection is of no use.
    pub fn take(&mut self, bytes: &[u8]) -> Result<(Vec<u8>, Vec<ClientNews>), ClientFault> {
        self.packages.extend(bytes);
        let (mut send, mut news) = (Vec::new(), Vec::new());
        while let Some((kind, carried)) = self.packages.take_package()? {
            match kind {
                b'V' if carried == [1] => {
                    let wanted = [&HERTZ.to_be_bytes()[..], OUTPUTS.join(",").as_bytes()].concat();
                    send.extend(package(b'O', &wanted));
                }
                b'V' => return Err(ClientFault::Version),
                b'O' => {
                    self.outputs = kinds(&carried, &OUTPUTS.map(str::to_string), 'O')?;
                    send.extend(package(b'I', input_names().join(",").as_bytes()));
                }
                b'I' => {
                    self.inputs = kinds(&carried, &input_names(), 'I')?;
                    send.extend(package(b'S', &[]));
                }
                b'S' if carried == [1] => self.is_started = true,
                b'S' => return Err(ClientFault::NotStarted),
                b'U' => news.extend(self.reading(&carried)?.map(|reading| ClientNews::Reading(Box::new(reading)))),
                b'M' => news.extend(message(&carried).map(ClientNews::Message)),
                _ => {}
            }
        }
        Ok((send, news))
    }

    /// A package of inputs; nothing before the handshake is over.
    pub fn inputs(&self, inputs: &ArmInputs) -> Vec<u8> {
        if !self.is_started {
            return Vec::new();
        }
        let ArmInputs { heartbeat, leg, presses, takes_ms, share, wire, poses } = *inputs;
        let integers = [heartbeat, leg, i32::from(presses), takes_ms, share, wire].map(Datum::Int32);
        let mut carried = vec![1];
        integers.iter().for_each(|number| number.write(&mut carried));
        poses.as_flattened().iter().for_each(|angle| Datum::Double(*angle).write(&mut carried));
        package(b'U', &carried)
    }

    fn reading(&self, carried: &[u8]) -> Result<Option<ArmReading>, ClientFault> {
        let wrong = ClientFault::Content('U');
        let Some((1, mut bytes)) = carried.split_first().map(|(recipe, rest)| (*recipe, rest)) else { return Ok(None) };
        let mut values = Vec::new();
        for kind in &self.outputs {
            values.push(kind.read(&mut bytes).ok_or(wrong.clone())?);
        }
        use Datum::{Double, Int32, Uint32, Uint64, Vector6d};
        let [
            Vector6d(joints),
            Vector6d(speeds),
            Vector6d([x, y, z, ..]),
            Int32(mode),
            Int32(safety),
            Uint32(runtime),
            Double(slider),
            Uint64(inputs),
            Int32(done),
            Int32(result),
            Int32(stands),
            Double(grew_n),
            Double(payload_kg),
            Int32(leg),
            Vector6d(tip),
        ] = values[..]
        else {
            return Err(wrong);
        };
        Ok(Some(ArmReading {
            joints,
            speeds,
            force_n: (x * x + y * y + z * z).sqrt(),
            mode,
            safety: safety_mode(safety),
            runtime,
            slider,
            inputs,
            done,
            result,
            stands: stands == 1,
            grew_n,
            payload_kg,
            leg,
            tip,
        }))
    }
}

fn input_names() -> Vec<String> {
    let numbers = |kind: &str, count: usize| {
        (FIRST..FIRST + count).map(|at| format!("input_{kind}_register_{at}")).collect::<Vec<_>>()
    };
    [numbers("int", INTEGERS), numbers("double", DOUBLES)].concat()
}

/// The types of a recipe's variables, from the answer to its setup.
fn kinds(carried: &[u8], names: &[String], letter: char) -> Result<Vec<Datum>, ClientFault> {
    let wrong = || ClientFault::Content(letter);
    let (recipe, text) = carried.split_first().ok_or_else(wrong)?;
    let kinds: Vec<&str> = std::str::from_utf8(text).map_err(|_| wrong())?.split(',').collect();
    for (kind, name) in kinds.iter().zip(names) {
        match *kind {
            "NOT_FOUND" => return Err(ClientFault::Unknown(name.clone())),
            "IN_USE" => return Err(ClientFault::InUse(name.clone())),
            _ => {}
        }
    }
    let found: Option<Vec<Datum>> = kinds.into_iter().map(|kind| kind.parse().ok()).collect();
    found.filter(|found| found.len() == names.len() && *recipe == 1).ok_or_else(wrong)
}

/// The words of a text message.
fn message(carried: &[u8]) -> Option<String> {
    let (length, rest) = carried.split_first()?;
    Some(String::from_utf8_lossy(rest.get(..usize::from(*length))?).into_owned())
}
