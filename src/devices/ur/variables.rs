//! The variables of RTDE: their types, where outputs come from, and what inputs set.
//!
//! What the simulation does not have, such as currents and temperatures, is 0.

use tomcom_arm::physics::CYCLE_S;
use tomcom_core::robot::{JOINTS, SafetyMode};

use super::controller::{ArmState, ProgramState, REGISTERS, RobotMode, SimulatedController};
use super::motion::{norm, six, tcp, tcp_speed};

/// A value as it goes over the connection: big endian. The answer to a setup names its type in capitals.
#[derive(Clone, Copy, Debug, PartialEq, strum::EnumString, strum::IntoStaticStr)]
#[strum(serialize_all = "UPPERCASE")]
pub enum Datum {
    Bool(bool),
    Uint8(u8),
    Uint32(u32),
    Uint64(u64),
    Int32(i32),
    Double(f64),
    Vector3d([f64; 3]),
    Vector6d([f64; 6]),
    Vector6int32([i32; 6]),
}

impl Datum {
    pub fn write(&self, into: &mut Vec<u8>) {
        match self {
            Datum::Bool(value) => into.push(u8::from(*value)),
            Datum::Uint8(value) => into.push(*value),
            Datum::Uint32(value) => into.extend(value.to_be_bytes()),
            Datum::Uint64(value) => into.extend(value.to_be_bytes()),
            Datum::Int32(value) => into.extend(value.to_be_bytes()),
            Datum::Double(value) => into.extend(value.to_be_bytes()),
            Datum::Vector3d(values) => values.iter().for_each(|value| into.extend(value.to_be_bytes())),
            Datum::Vector6d(values) => values.iter().for_each(|value| into.extend(value.to_be_bytes())),
            Datum::Vector6int32(values) => values.iter().for_each(|value| into.extend(value.to_be_bytes())),
        }
    }

    /// Reads a value of the same type from the beginning of the bytes, which then go on after it; `None` if they end
    /// before.
    pub fn read(&self, bytes: &mut &[u8]) -> Option<Datum> {
        Some(match self {
            Datum::Bool(_) => Datum::Bool(taken::<1>(bytes)?[0] != 0),
            Datum::Uint8(_) => Datum::Uint8(taken::<1>(bytes)?[0]),
            Datum::Uint32(_) => Datum::Uint32(u32::from_be_bytes(taken(bytes)?)),
            Datum::Uint64(_) => Datum::Uint64(u64::from_be_bytes(taken(bytes)?)),
            Datum::Int32(_) => Datum::Int32(i32::from_be_bytes(taken(bytes)?)),
            Datum::Double(_) => Datum::Double(f64::from_be_bytes(taken(bytes)?)),
            Datum::Vector3d(_) => Datum::Vector3d(several(bytes, f64::from_be_bytes)?),
            Datum::Vector6d(_) => Datum::Vector6d(several(bytes, f64::from_be_bytes)?),
            Datum::Vector6int32(_) => Datum::Vector6int32(several(bytes, i32::from_be_bytes)?),
        })
    }
}

fn taken<const LENGTH: usize>(bytes: &mut &[u8]) -> Option<[u8; LENGTH]> {
    let (head, tail) = bytes.split_first_chunk::<LENGTH>()?;
    *bytes = tail;
    Some(*head)
}

fn several<Number: Copy + Default, const LENGTH: usize, const COUNT: usize>(
    bytes: &mut &[u8],
    read: fn([u8; LENGTH]) -> Number,
) -> Option<[Number; COUNT]> {
    let mut values = [Number::default(); COUNT];
    for value in &mut values {
        *value = read(taken(bytes)?);
    }
    Some(values)
}

/// The controller at one moment of its last cycle.
pub struct View<'a> {
    pub controller: &'a SimulatedController,
    /// How much of the last cycle has passed, from 0 to 1.
    pub share: f64,
    arm: ArmState,
}

impl View<'_> {
    pub fn new(controller: &SimulatedController, share: f64) -> View<'_> {
        View { controller, share, arm: controller.arm_at(share) }
    }
}

type Read = fn(&View) -> Datum;

/// A safety mode's name at the dashboard server, its number in RTDE, and its bits in `safety_status_bits`: one for the
/// mode, 7 for an emergency stop, 10 for any stop.
pub(super) fn safety_codes(safety: SafetyMode) -> (&'static str, i32, u32) {
    let (name, number, bits) = match safety {
        SafetyMode::Normal => ("NORMAL", 1, 1),
        SafetyMode::Reduced => ("REDUCED", 2, 1 << 1),
        SafetyMode::ProtectiveStop => ("PROTECTIVE_STOP", 3, 1 << 2),
        SafetyMode::Safeguard => ("SAFEGUARD_STOP", 5, 1 << 4),
        SafetyMode::EmergencyStop => ("ROBOT_EMERGENCY_STOP", 7, 1 << 6 | 1 << 7),
        SafetyMode::Fault => ("FAULT", 9, 1 << 9),
    };
    (name, number, bits | u32::from(safety.is_stopped()) << 10)
}

/// The safety mode behind RTDE's number: those of other generations and options count as the nearest of the program's.
pub fn safety_mode(number: i32) -> SafetyMode {
    match number {
        1 => SafetyMode::Normal,
        2 => SafetyMode::Reduced,
        3 | 4 => SafetyMode::ProtectiveStop,
        // 12 and 13: stops of the automatic mode, and of the enabling device.
        5 | 12 | 13 => SafetyMode::Safeguard,
        6 | 7 => SafetyMode::EmergencyStop,
        _ => SafetyMode::Fault,
    }
}

/// RTDE's number of a joint's mode.
fn joint_mode(mode: RobotMode) -> i32 {
    match mode {
        RobotMode::PowerOff => 239,
        RobotMode::Booting => 247,
        RobotMode::Idle => 255,
        RobotMode::Running => 253,
    }
}

fn status_bits(view: &View) -> u32 {
    let powered = u32::from(view.controller.mode() > RobotMode::PowerOff);
    powered | u32::from(view.controller.state() == ProgramState::Playing) << 1
}

const NONE_OF_SIX: Read = |_| Datum::Vector6d([0.0; 6]);
const NO_NUMBER: Read = |_| Datum::Double(0.0);

/// The output variables beside the registers.
const OUTPUTS: &[(&str, Read)] = &[
    ("timestamp", |view| Datum::Double(view.controller.now_s() - (1.0 - view.share) * CYCLE_S)),
    ("target_q", |view| Datum::Vector6d(view.arm.target)),
    ("target_qd", |view| Datum::Vector6d(view.arm.target_speeds)),
    ("target_qdd", NONE_OF_SIX),
    ("target_current", NONE_OF_SIX),
    ("target_moment", NONE_OF_SIX),
    ("actual_q", |view| Datum::Vector6d(view.arm.actual)),
    ("actual_qd", |view| Datum::Vector6d(view.arm.actual_speeds)),
    ("actual_current", NONE_OF_SIX),
    ("actual_current_window", NONE_OF_SIX),
    ("joint_control_output", NONE_OF_SIX),
    ("actual_TCP_pose", |view| Datum::Vector6d(six(&tcp(&view.controller.arm, &view.arm.actual)))),
    ("actual_TCP_speed", |view| {
        Datum::Vector6d(tcp_speed(&view.controller.arm, &view.arm.actual, &view.arm.actual_speeds))
    }),
    ("actual_TCP_force", |view| Datum::Vector6d(view.arm.tcp_force())),
    ("target_TCP_pose", |view| Datum::Vector6d(six(&tcp(&view.controller.arm, &view.arm.target)))),
    ("target_TCP_speed", |view| {
        Datum::Vector6d(tcp_speed(&view.controller.arm, &view.arm.target, &view.arm.target_speeds))
    }),
    ("tcp_offset", |view| Datum::Vector6d(six(&view.controller.arm.flange_from_tip()))),
    ("tcp_force_scalar", |view| Datum::Double(norm(&view.arm.force_n))),
    ("ft_raw_wrench", NONE_OF_SIX),
    ("actual_digital_input_bits", |view| Datum::Uint64(view.controller.digital_inputs)),
    ("actual_digital_output_bits", |view| Datum::Uint64(view.controller.digital_outputs)),
    ("joint_temperatures", NONE_OF_SIX),
    ("actual_execution_time", NO_NUMBER),
    ("robot_mode", |view| Datum::Int32(view.controller.mode() as i32)),
    ("joint_mode", |view| Datum::Vector6int32([joint_mode(view.controller.mode()); JOINTS])),
    ("safety_mode", |view| Datum::Int32(safety_codes(view.controller.safety()).1)),
    ("safety_status", |view| Datum::Int32(safety_codes(view.controller.safety()).1)),
    ("safety_status_bits", |view| Datum::Uint32(safety_codes(view.controller.safety()).2)),
    ("robot_status_bits", |view| Datum::Uint32(status_bits(view))),
    ("actual_tool_accelerometer", |_| Datum::Vector3d([0.0; 3])),
    // How the safety system slows the arm down; the slider is target_speed_fraction.
    ("speed_scaling", |view| Datum::Double(if view.controller.safety().is_stopped() { 0.0 } else { 1.0 })),
    ("target_speed_fraction", |view| Datum::Double(view.controller.speed_slider)),
    ("actual_momentum", NO_NUMBER),
    ("actual_main_voltage", NO_NUMBER),
    ("actual_robot_voltage", NO_NUMBER),
    ("actual_robot_current", NO_NUMBER),
    ("actual_joint_voltage", NONE_OF_SIX),
    ("runtime_state", |view| Datum::Uint32(view.controller.state() as u32)),
    ("elbow_position", |_| Datum::Vector3d([0.0; 3])),
    ("standard_analog_input0", NO_NUMBER),
    ("standard_analog_input1", NO_NUMBER),
    ("standard_analog_output0", |view| Datum::Double(view.controller.analog_outputs[0])),
    ("standard_analog_output1", |view| Datum::Double(view.controller.analog_outputs[1])),
    ("payload", |view| Datum::Double(view.controller.payload_kg)),
    ("payload_cog", |_| Datum::Vector3d([0.0; 3])),
    ("payload_inertia", NONE_OF_SIX),
    ("script_control_line", |view| Datum::Uint32(view.controller.line())),
];

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Register {
    Integer(usize),
    Double(usize),
    Bit(usize),
    /// 32 bits from this one on.
    Bits(usize),
}

impl Register {
    /// The register that a variable's name means, without `input_` or `output_`.
    fn named(name: &str) -> Option<Register> {
        let number = |prefix: &str, most: usize| {
            let digits = name.strip_prefix(prefix)?;
            digits.parse::<usize>().ok().filter(|number| *number < most && number.to_string() == digits)
        };
        match name {
            "bit_registers0_to_31" => return Some(Register::Bits(0)),
            "bit_registers32_to_63" => return Some(Register::Bits(32)),
            _ => {}
        }
        number("int_register_", REGISTERS)
            .map(Register::Integer)
            .or_else(|| number("double_register_", REGISTERS).map(Register::Double))
            .or_else(|| number("bit_register_", 128).filter(|bit| *bit >= 64).map(Register::Bit))
    }
}

/// An output variable.
#[derive(Clone, Copy, Debug)]
pub enum Output {
    Plain(usize),
    /// Whether it is a register of the outputs; inputs can be read back.
    Register(bool, Register),
}

/// The output variable of this name.
pub fn output(name: &str) -> Option<Output> {
    if let Some(at) = OUTPUTS.iter().position(|(one, _)| *one == name) {
        return Some(Output::Plain(at));
    }
    let of = |prefix: &str| name.strip_prefix(prefix).and_then(Register::named);
    let written = of("output_").map(|register| Output::Register(true, register));
    written.or_else(|| of("input_").map(|register| Output::Register(false, register)))
}

impl Output {
    pub fn read(self, view: &View) -> Datum {
        let (is_output, register) = match self {
            Output::Plain(at) => return OUTPUTS[at].1(view),
            Output::Register(is_output, register) => (is_output, register),
        };
        let registers = if is_output { &view.controller.outputs } else { &view.controller.inputs };
        match register {
            Register::Integer(at) => Datum::Int32(registers.integers[at]),
            Register::Double(at) => Datum::Double(registers.doubles[at]),
            Register::Bit(at) => Datum::Bool(registers.bits >> at & 1 == 1),
            Register::Bits(first) => Datum::Uint32((registers.bits >> first) as u32),
        }
    }
}

/// The input variables beside the registers, each with a value of its type.
const INPUTS: [(&str, Datum); 12] = [
    ("speed_slider_mask", Datum::Uint32(0)),
    ("speed_slider_fraction", Datum::Double(0.0)),
    ("standard_digital_output_mask", Datum::Uint8(0)),
    ("standard_digital_output", Datum::Uint8(0)),
    ("configurable_digital_output_mask", Datum::Uint8(0)),
    ("configurable_digital_output", Datum::Uint8(0)),
    ("tool_digital_output_mask", Datum::Uint8(0)),
    ("tool_digital_output", Datum::Uint8(0)),
    ("standard_analog_output_mask", Datum::Uint8(0)),
    ("standard_analog_output_type", Datum::Uint8(0)),
    ("standard_analog_output_0", Datum::Double(0.0)),
    ("standard_analog_output_1", Datum::Double(0.0)),
];

/// A value of the type of the input variable of this name.
pub fn input(name: &str) -> Option<Datum> {
    if let Some((_, kind)) = INPUTS.iter().find(|(one, _)| *one == name) {
        return Some(*kind);
    }
    let register = Register::named(name.strip_prefix("input_")?)?;
    Some(match register {
        Register::Integer(_) => Datum::Int32(0),
        Register::Double(_) => Datum::Double(0.0),
        Register::Bit(_) => Datum::Bool(false),
        Register::Bits(_) => Datum::Uint32(0),
    })
}

/// Sets what the inputs of a package set: a mask beside a value says which of its bits count.
pub fn set(controller: &mut SimulatedController, package: &[(&str, Datum)]) {
    let of = |name: &str| package.iter().find(|(one, _)| *one == name).map(|(_, value)| *value);
    for (name, value) in package {
        controller.note_update(name);
        let registers = &mut controller.inputs;
        match (name.strip_prefix("input_").and_then(Register::named), value) {
            (Some(Register::Integer(at)), Datum::Int32(number)) => registers.integers[at] = *number,
            (Some(Register::Double(at)), Datum::Double(number)) => registers.doubles[at] = *number,
            (Some(Register::Bit(at)), Datum::Bool(on)) => registers.set_bit(at, *on),
            (Some(Register::Bits(first)), Datum::Uint32(bits)) => {
                (0..32).for_each(|bit| registers.set_bit(first + bit, bits >> bit & 1 == 1));
            }
            _ => {}
        }
    }
    if let (Some(Datum::Uint32(1..)), Some(Datum::Double(share))) =
        (of("speed_slider_mask"), of("speed_slider_fraction"))
        && share.is_finite()
    {
        controller.speed_slider = share.clamp(0.0, 1.0);
    }
    for (first, name) in [(0, "standard"), (8, "configurable"), (16, "tool")] {
        let values = (of(&format!("{name}_digital_output_mask")), of(&format!("{name}_digital_output")));
        if let (Some(Datum::Uint8(mask)), Some(Datum::Uint8(bits))) = values {
            let (mask, bits) = (u64::from(mask) << first, u64::from(bits) << first);
            controller.digital_outputs = controller.digital_outputs & !mask | bits & mask;
        }
    }
    if let Some(Datum::Uint8(mask)) = of("standard_analog_output_mask") {
        for (at, name) in ["standard_analog_output_0", "standard_analog_output_1"].iter().enumerate() {
            if let (true, Some(Datum::Double(level))) = (mask >> at & 1 == 1, of(name)) {
                controller.analog_outputs[at] = level;
            }
        }
    }
}
