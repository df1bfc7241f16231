//! A connection to the Real-Time Data Exchange interface, from the controller's side: bytes in, bytes out. The other side is
//! [`super::client`].
//!
//! A package is its length in two bytes, the letter of its kind, and what it carries, big endian. A client negotiates
//! version 2 of the protocol, sets up recipes (lists of variables) of outputs and inputs, and starts; then each output
//! recipe is sent at its frequency, and each package of an input recipe sets its variables.

use thiserror::Error;

use super::controller::{ControllerMessage, Level, SimulatedController};
use super::motion::CYCLE_S;
use super::variables::{self, Datum, Output, View};

/// Length of the header, in bytes.
const HEADER: usize = 3;
/// Longest list of variables, in bytes, as in the manufacturer's controllers.
const MOST_NAMES: usize = 2048;
/// Number of recipes that one connection can set up: their numbers are a byte, and 0 means none.
const MOST_RECIPES: usize = 255;

/// Why a connection is closed.
#[derive(Clone, Debug, Error, PartialEq, Eq)]
pub enum RtdeFault {
    #[error("a package of {0} bytes; it has at least {HEADER}")]
    Length(u16),
    #[error("a package {0:?} before version 2 of the protocol was agreed on; only version 2 is served")]
    Version(char),
    #[error("a package {0:?}, which is none of V v M U O I S P")]
    Kind(char),
    #[error("a package {0:?} that is too short or too long")]
    Content(char),
}

/// Puts the header before what a package carries.
pub fn package(kind: u8, carried: &[u8]) -> Vec<u8> {
    let length = u16::try_from(HEADER + carried.len()).expect("packages of a few kilobytes");
    let mut bytes = length.to_be_bytes().to_vec();
    bytes.push(kind);
    bytes.extend(carried);
    bytes
}

/// Puts packages together from the pieces in which they arrive.
#[derive(Clone, Debug, Default)]
pub struct PackageReader(Vec<u8>);

impl PackageReader {
    pub fn extend(&mut self, bytes: &[u8]) {
        self.0.extend(bytes);
    }

    /// The letter of the next whole package, and what it carries; `None` until it is whole.
    ///
    /// # Errors
    /// Its length cannot be.
    pub fn take_package(&mut self) -> Result<Option<(u8, Vec<u8>)>, RtdeFault> {
        let Some(head) = self.0.first_chunk::<HEADER>() else { return Ok(None) };
        let (length, kind) = (u16::from_be_bytes([head[0], head[1]]), head[2]);
        if usize::from(length) < HEADER {
            return Err(RtdeFault::Length(length));
        }
        if self.0.len() < usize::from(length) {
            return Ok(None);
        }
        let rest = self.0.split_off(usize::from(length));
        let whole = std::mem::replace(&mut self.0, rest);
        Ok(Some((kind, whole[HEADER..].to_vec())))
    }
}

#[derive(Clone, Debug)]
struct OutputRecipe {
    variables: Vec<Output>,
    /// Seconds from one package to the next.
    period_s: f64,
    next_s: f64,
}

/// One client.
#[derive(Clone, Debug, Default)]
pub struct RtdeConnection {
    /// Tells connections apart, for the inputs that they claim.
    id: u64,
    packages: PackageReader,
    is_agreed: bool,
    is_started: bool,
    outputs: Vec<OutputRecipe>,
    inputs: Vec<Vec<(String, Datum)>>,
}

impl RtdeConnection {
    pub fn new(id: u64) -> RtdeConnection {
        RtdeConnection { id, ..RtdeConnection::default() }
    }

    /// Takes bytes from the client, and returns the answers.
    ///
    /// # Errors
    /// Why the connection has to be closed.
    pub fn take(&mut self, bytes: &[u8], controller: &mut SimulatedController) -> Result<Vec<u8>, RtdeFault> {
        self.packages.extend(bytes);
        let mut answers = Vec::new();
        while let Some((kind, carried)) = self.packages.take_package()? {
            answers.extend(self.answer(kind, &carried, controller)?);
        }
        Ok(answers)
    }

    /// Gives back the inputs that the connection has claimed.
    pub fn leave(&self, controller: &mut SimulatedController) {
        controller.claimed.retain(|_, owner| *owner != self.id);
    }

    fn answer(&mut self, kind: u8, carried: &[u8], controller: &mut SimulatedController) -> Result<Vec<u8>, RtdeFault> {
        let letter = char::from(kind);
        match kind {
            b'V' => {
                let version = <[u8; 2]>::try_from(carried).map_err(|_| RtdeFault::Content(letter))?;
                let is_served = u16::from_be_bytes(version) == 2;
                self.is_agreed |= is_served;
                Ok(package(kind, &[u8::from(is_served)]))
            }
            b'v' => {
                let numbers: Vec<u8> = controller.series.version().iter().flat_map(|part| part.to_be_bytes()).collect();
                Ok(package(kind, &numbers))
            }
            b'M' => Ok(Vec::new()),
            b'U' | b'O' | b'I' | b'S' | b'P' if !self.is_agreed => Err(RtdeFault::Version(letter)),
            b'O' => self.set_up_outputs(carried, controller),
            b'I' => self.set_up_inputs(carried, controller),
            b'S' => {
                self.is_started = !self.outputs.is_empty() || !self.inputs.is_empty();
                self.outputs.iter_mut().for_each(|recipe| recipe.next_s = controller.now_s());
                Ok(package(kind, &[u8::from(self.is_started)]))
            }
            b'P' => {
                self.is_started = false;
                Ok(package(kind, &[1]))
            }
            b'U' => self.take_inputs(carried, controller).map(|()| Vec::new()),
            _ => Err(RtdeFault::Kind(letter)),
        }
    }

    fn set_up_outputs(&mut self, carried: &[u8], controller: &SimulatedController) -> Result<Vec<u8>, RtdeFault> {
        let (hertz, names) = carried.split_first_chunk::<8>().ok_or(RtdeFault::Content('O'))?;
        let names = names_of(names).ok_or(RtdeFault::Content('O'))?;
        let hertz = f64::from_be_bytes(*hertz);
        let most = controller.series.hertz();
        let hertz = if hertz > 0.0 { hertz.min(most) } else { most };
        let found: Vec<Option<Output>> = names.iter().map(|name| variables::output(name)).collect();
        let view = View::new(controller, 1.0);
        let kinds: Vec<&str> =
            found.iter().map(|output| output.map_or("NOT_FOUND", |output| output.read(&view).into())).collect();
        let complete: Option<Vec<Output>> = found.into_iter().collect();
        let mut recipe = 0;
        if let Some(variables) = complete.filter(|all| !all.is_empty() && self.outputs.len() < MOST_RECIPES) {
            self.outputs.push(OutputRecipe { variables, period_s: 1.0 / hertz, next_s: controller.now_s() });
            recipe = self.outputs.len() as u8;
        }
        Ok(package(b'O', &[&[recipe], kinds.join(",").as_bytes()].concat()))
    }

    fn set_up_inputs(&mut self, carried: &[u8], controller: &mut SimulatedController) -> Result<Vec<u8>, RtdeFault> {
        let names = names_of(carried).ok_or(RtdeFault::Content('I'))?;
        let of_another = |name: &str| controller.claimed.get(name).is_some_and(|owner| *owner != self.id);
        let kinds: Vec<&str> = names
            .iter()
            .map(|name| match variables::input(name) {
                None => "NOT_FOUND",
                Some(_) if of_another(name) => "IN_USE",
                Some(datum) => datum.into(),
            })
            .collect();
        let is_possible = !kinds.iter().any(|kind| matches!(*kind, "NOT_FOUND" | "IN_USE"));
        let mut recipe = 0;
        if is_possible && !names.is_empty() && self.inputs.len() < MOST_RECIPES {
            let variables = names.iter().filter_map(|name| Some((name.clone(), variables::input(name)?)));
            self.inputs.push(variables.collect());
            controller.claimed.extend(names.iter().map(|name| (name.clone(), self.id)));
            recipe = self.inputs.len() as u8;
        }
        Ok(package(b'I', &[&[recipe], kinds.join(",").as_bytes()].concat()))
    }

    fn take_inputs(&mut self, carried: &[u8], controller: &mut SimulatedController) -> Result<(), RtdeFault> {
        let wrong = RtdeFault::Content('U');
        let (number, mut bytes) = carried.split_first().ok_or(wrong.clone())?;
        let recipe = usize::from(*number).checked_sub(1).and_then(|at| self.inputs.get(at)).ok_or(wrong.clone())?;
        let mut package = Vec::new();
        for (name, kind) in recipe {
            package.push((name.as_str(), kind.read(&mut bytes).ok_or(wrong.clone())?));
        }
        if !bytes.is_empty() {
            return Err(wrong);
        }
        // Inputs count before the start as well: a client without outputs need not start.
        variables::set(controller, &package);
        Ok(())
    }

    /// The output packages that are due when this share of the controller's last cycle has passed.
    pub fn outputs(&mut self, controller: &SimulatedController, share: f64) -> Vec<u8> {
        let mut bytes = Vec::new();
        if !self.is_started {
            return bytes;
        }
        let view = View::new(controller, share);
        let now_s = controller.now_s() - (1.0 - share) * CYCLE_S;
        for (at, recipe) in self.outputs.iter_mut().enumerate() {
            // Sums of periods are rounded.
            if recipe.next_s > now_s + 1e-6 {
                continue;
            }
            recipe.next_s = (recipe.next_s + recipe.period_s).max(now_s);
            let mut carried = vec![at as u8 + 1];
            recipe.variables.iter().for_each(|output| output.read(&view).write(&mut carried));
            bytes.extend(package(b'U', &carried));
        }
        bytes
    }

    /// A message of the controller, for a client that has agreed on the protocol.
    pub fn message(&self, message: &ControllerMessage) -> Option<Vec<u8>> {
        if !self.is_agreed || message.level == Level::Info {
            return None;
        }
        let (source, text) = (b"tomcom", message.text.as_bytes());
        let text = &text[..text.len().min(usize::from(u8::MAX))];
        let (text_length, source_length) = (text.len() as u8, source.len() as u8);
        let carried = [&[text_length], text, &[source_length], source, &[message.level as u8]].concat();
        Some(package(b'M', &carried))
    }
}

/// The names in a list with commas, of which the last may end in one.
fn names_of(bytes: &[u8]) -> Option<Vec<String>> {
    let text = std::str::from_utf8(bytes).ok().filter(|text| text.len() <= MOST_NAMES)?;
    Some(text.split(',').map(str::trim).filter(|name| !name.is_empty()).map(str::to_string).collect())
}
