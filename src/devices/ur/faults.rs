//! What goes wrong on command: lines that the person beside the simulated controller types.

use super::controller::SimulatedController;

/// Longest break of the connections and longest delay, in seconds: more is a slip of the pen.
const MOST_S: f64 = 600.0;

/// Something that goes wrong, or ends.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Fault {
    ProtectiveStop,
    EmergencyStop,
    /// The emergency stop's button is pulled out again.
    Reset,
    /// The motor of a joint is lost; the first has the number 0.
    Joint(usize),
    /// The program is stopped at the teach pendant.
    StopProgram,
    PowerOff,
    /// A hand at this place in the controller's base frame in metres, or none.
    Hand(Option<[f64; 3]>),
    /// Every connection ends, and none is accepted for this many seconds.
    Disconnect(f64),
    /// Bytes take this many seconds, to twice as long, in each direction.
    Slow(f64),
}

/// What can be typed.
pub const HELP: &str = "\
protective-stop      stop the arm on its path
emergency-stop       press the emergency stop; reset pulls it out again
stop-program         stop the program at the teach pendant
power-off            switch the arm's power off
joint N              lose the motor of joint N, 1 to 6
hand X Y Z           put a hand there (metres, the controller's base frame); hand off takes it away
disconnect SECONDS   end every connection, and accept none for so long
slow MS              delay bytes by MS to 2 MS milliseconds in each direction; slow 0 ends it
help                 print this list";

impl Fault {
    /// Reads a line; `None` asks for help.
    ///
    /// # Errors
    /// What is wrong with the line, and what would be right.
    pub fn read(line: &str) -> Result<Option<Fault>, String> {
        let words: Vec<&str> = line.split_whitespace().collect();
        let number = |word: &str| word.parse::<f64>().ok().filter(|number| number.is_finite());
        let seconds = |word: &str, per_s: f64| {
            number(word).map(|number| number / per_s).filter(|seconds| (0.0..=MOST_S).contains(seconds))
        };
        let fault = match words[..] {
            ["help"] => return Ok(None),
            ["protective-stop"] => Some(Fault::ProtectiveStop),
            ["emergency-stop"] => Some(Fault::EmergencyStop),
            ["reset"] => Some(Fault::Reset),
            ["stop-program"] => Some(Fault::StopProgram),
            ["power-off"] => Some(Fault::PowerOff),
            ["joint", joint] => {
                joint.parse().ok().filter(|joint| (1..=6).contains(joint)).map(|joint: usize| Fault::Joint(joint - 1))
            }
            ["hand", "off"] => Some(Fault::Hand(None)),
            ["hand", x, y, z] => match (number(x), number(y), number(z)) {
                (Some(x), Some(y), Some(z)) => Some(Fault::Hand(Some([x, y, z]))),
                _ => None,
            },
            ["disconnect", word] => seconds(word, 1.0).map(Fault::Disconnect),
            ["slow", word] => seconds(word, 1000.0).map(Fault::Slow),
            _ => None,
        };
        fault.map(Some).ok_or_else(|| format!("{:?} is not understood; help prints what is", line.trim()))
    }

    /// Lets it happen to the controller; what happens to the connections is the server's.
    pub fn happen(self, controller: &mut SimulatedController) {
        match self {
            Fault::ProtectiveStop => controller.protective_stop("on command"),
            Fault::EmergencyStop => controller.emergency_stop(),
            Fault::Reset => controller.reset_emergency_stop(),
            Fault::Joint(joint) => controller.fail_joint(joint),
            Fault::StopProgram => controller.stop_program("it was stopped at the teach pendant"),
            Fault::PowerOff => controller.power_off(),
            Fault::Hand(at_m) => controller.put_hand(at_m),
            Fault::Disconnect(_) | Fault::Slow(_) => {}
        }
    }
}
