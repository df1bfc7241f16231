//! Runs a script: one instruction after the other, until something takes time.

use std::collections::BTreeMap;

use super::controller::SimulatedController;
use super::script::{Call, Expression, Instruction, Script, ScriptError, Target};

/// Number of instructions without one that takes time after which a program counts as caught in a loop.
const MOST_INSTRUCTIONS: u32 = 20_000;
/// Largest value of a variable: items of a list with those of lists inside, letters of a text.
const MOST_ITEMS: usize = 1000;
/// Deepest nesting of the program's calls.
const MOST_FRAMES: usize = 64;

#[derive(Clone, Debug, PartialEq)]
pub enum Value {
    Number(f64),
    Truth(bool),
    Text(String),
    List(Vec<Value>),
    Pose([f64; 6]),
}

impl Value {
    pub fn list(numbers: &[f64]) -> Value {
        Value::List(numbers.iter().copied().map(Value::Number).collect())
    }

    fn number(&self) -> Option<f64> {
        if let Value::Number(number) = self { Some(*number) } else { None }
    }

    fn size(&self) -> usize {
        match self {
            Value::List(items) => 1 + items.iter().map(Value::size).sum::<usize>(),
            Value::Text(text) => text.len(),
            _ => 1,
        }
    }

    pub(super) fn words(&self) -> String {
        match self {
            Value::Number(number) => number.to_string(),
            Value::Truth(true) => "True".to_string(),
            Value::Truth(false) => "False".to_string(),
            Value::Text(text) => text.clone(),
            Value::List(items) => format!("[{}]", items.iter().map(Value::words).collect::<Vec<_>>().join(", ")),
            Value::Pose(pose) => format!("p[{}]", pose.map(|part| part.to_string()).join(", ")),
        }
    }
}

/// The values with which a function is called.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Arguments {
    pub by_place: Vec<Value>,
    pub by_name: Vec<(String, Value)>,
}

impl Arguments {
    pub fn get(&self, name: &str, place: usize) -> Option<&Value> {
        let named = self.by_name.iter().find(|(one, _)| one == name).map(|(_, value)| value);
        named.or_else(|| self.by_place.get(place))
    }

    /// The argument as what it is to be.
    fn read<'a, T>(
        &'a self,
        name: &str,
        place: usize,
        wanted: &str,
        read: impl Fn(&'a Value) -> Option<T>,
    ) -> Result<T, String> {
        let value = self.get(name, place).ok_or_else(|| format!("{name} is missing"))?;
        read(value).ok_or_else(|| format!("{name} is {}; it is {wanted}", value.words()))
    }

    pub fn number(&self, name: &str, place: usize) -> Result<f64, String> {
        self.read(name, place, "a number", |value| value.number().filter(|number| number.is_finite()))
    }

    pub fn number_or(&self, name: &str, place: usize, otherwise: f64) -> Result<f64, String> {
        if self.get(name, place).is_none() { Ok(otherwise) } else { self.number(name, place) }
    }

    pub fn truth(&self, name: &str, place: usize) -> Result<bool, String> {
        self.read(name, place, "True or False", |value| match value {
            Value::Truth(truth) => Some(*truth),
            _ => None,
        })
    }

    pub fn text(&self, name: &str, place: usize) -> Result<&str, String> {
        self.read(name, place, "a text", |value| match value {
            Value::Text(text) => Some(text.as_str()),
            _ => None,
        })
    }

    /// Six numbers: a list, or a pose.
    pub fn six(&self, name: &str, place: usize) -> Result<[f64; 6], String> {
        self.read(name, place, "a list of 6 finite numbers, or a pose", |value| {
            let numbers: [f64; 6] = match value {
                Value::Pose(pose) => *pose,
                Value::List(items) => items.iter().map(Value::number).collect::<Option<Vec<_>>>()?.try_into().ok()?,
                _ => return None,
            };
            numbers.iter().all(|number| number.is_finite()).then_some(numbers)
        })
    }

    pub fn six_or(&self, name: &str, place: usize, otherwise: [f64; 6]) -> Result<[f64; 6], String> {
        if self.get(name, place).is_none() { Ok(otherwise) } else { self.six(name, place) }
    }

    /// Fails where there are more arguments than the function has, or one by a name that it does not have.
    pub fn are_among(&self, names: &[&str]) -> Result<(), String> {
        if self.by_place.len() > names.len() {
            return Err(format!("{} values; it takes {}", self.by_place.len(), names.len()));
        }
        match self.by_name.iter().find(|(name, _)| !names.contains(&name.as_str())) {
            Some((name, _)) => Err(format!("no argument {name}; it takes {}", names.join(", "))),
            None => Ok(()),
        }
    }
}

/// What a program waits for before its next instruction.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Wait {
    /// Until this time of the controller, in seconds.
    Until(f64),
    /// Until the present motion has ended.
    Motion,
}

/// What a function of the controller gives back.
#[derive(Clone, Debug, PartialEq)]
pub enum Outcome {
    Value(Value),
    Nothing,
    Waits(Wait),
    /// The program ends.
    Halts,
}

#[derive(Clone, Debug, PartialEq)]
pub enum Step {
    Waits(Wait),
    Ended,
}

#[derive(Clone, Debug)]
struct Frame {
    function: usize,
    at: usize,
    locals: BTreeMap<String, Value>,
    /// Where the caller wants the value.
    into: Option<Target>,
}

/// A running script.
#[derive(Clone, Debug)]
pub struct Program {
    script: Script,
    globals: BTreeMap<String, Value>,
    frames: Vec<Frame>,
}

impl Program {
    pub fn new(script: Script) -> Program {
        let frame = Frame { function: 0, at: 0, locals: BTreeMap::new(), into: None };
        Program { script, globals: BTreeMap::new(), frames: vec![frame] }
    }

    pub fn name(&self) -> &str {
        &self.script.functions[0].name
    }

    /// The line of the next instruction.
    pub fn line(&self) -> u32 {
        let frame = self.frames.last();
        let at = frame.and_then(|frame| self.script.functions[frame.function].code.get(frame.at));
        at.map_or(0, |(line, _)| *line)
    }

    /// Runs until something takes time.
    ///
    /// # Errors
    /// The instruction that cannot be carried out.
    pub fn run(&mut self, host: &mut SimulatedController) -> Result<Step, ScriptError> {
        for _ in 0..MOST_INSTRUCTIONS {
            let line = self.line();
            let step = self.step(host).map_err(|found| ScriptError { line, found })?;
            if let Some(step) = step {
                return Ok(step);
            }
        }
        let found = format!("{MOST_INSTRUCTIONS} instructions, and none that takes time, such as sync()");
        Err(ScriptError { line: self.line(), found })
    }

    fn step(&mut self, host: &mut SimulatedController) -> Result<Option<Step>, String> {
        let Some(frame) = self.frames.last_mut() else { return Ok(Some(Step::Ended)) };
        let Some((_, instruction)) = self.script.functions[frame.function].code.get(frame.at).cloned() else {
            return self.leave(None, host);
        };
        frame.at += 1;
        match instruction {
            Instruction::Jump(to) => frame.at = to,
            Instruction::JumpUnless(condition, to) => match self.value(&condition, host)? {
                Value::Truth(true) => {}
                Value::Truth(false) => self.frames.last_mut().into_iter().for_each(|frame| frame.at = to),
                other => return Err(format!("{} as a condition", other.words())),
            },
            Instruction::Assign(target, value) => {
                let value = self.value(&value, host)?;
                self.assign(target, value, host)?;
            }
            Instruction::Return(value) => {
                let value = value.map(|value| self.value(&value, host)).transpose()?;
                return self.leave(value, host);
            }
            Instruction::Call(call, target) => return self.call(&call, target, host),
        }
        Ok(None)
    }

    fn call(
        &mut self,
        call: &Call,
        target: Option<Target>,
        host: &mut SimulatedController,
    ) -> Result<Option<Step>, String> {
        let arguments = self.arguments(call, host)?;
        if let Some(function) = self.script.functions.iter().position(|one| one.name == call.name) {
            return self.enter(function, arguments, target, host).map(|()| None);
        }
        match builtin(call, &arguments, host)? {
            Outcome::Halts => {
                self.frames.clear();
                Ok(Some(Step::Ended))
            }
            Outcome::Waits(wait) => Ok(Some(Step::Waits(wait))),
            Outcome::Nothing if target.is_some() => Err(format!("{} gives no value", call.name)),
            Outcome::Nothing => Ok(None),
            Outcome::Value(value) => {
                if let Some(target) = target {
                    self.assign(target, value, host)?;
                }
                Ok(None)
            }
        }
    }

    fn enter(
        &mut self,
        function: usize,
        arguments: Arguments,
        into: Option<Target>,
        host: &mut SimulatedController,
    ) -> Result<(), String> {
        if self.frames.len() >= MOST_FRAMES {
            return Err(format!("more than {MOST_FRAMES} calls inside one another"));
        }
        let parameters = self.script.functions[function].parameters.clone();
        let names: Vec<&str> = parameters.iter().map(|(name, _)| name.as_str()).collect();
        arguments.are_among(&names)?;
        let mut locals = BTreeMap::new();
        for (place, (name, default)) in parameters.iter().enumerate() {
            let value = match (arguments.get(name, place), default) {
                (Some(value), _) => value.clone(),
                (None, Some(default)) => self.value(default, host)?,
                (None, None) => return Err(format!("{name} is missing")),
            };
            locals.insert(name.clone(), value);
        }
        self.frames.push(Frame { function, at: 0, locals, into });
        Ok(())
    }

    fn leave(&mut self, value: Option<Value>, host: &mut SimulatedController) -> Result<Option<Step>, String> {
        let left = self.frames.pop();
        match (self.frames.is_empty(), left.and_then(|frame| frame.into), value) {
            (true, ..) => Ok(Some(Step::Ended)),
            (false, None, _) => Ok(None),
            (false, Some(_), None) => Err("a function without a value, whose value is wanted".to_string()),
            (false, Some(target), Some(value)) => self.assign(target, value, host).map(|()| None),
        }
    }

    fn put(&mut self, target: Target, value: Value) -> Result<(), String> {
        if value.size() > MOST_ITEMS {
            return Err(format!("{} would have more than {MOST_ITEMS} items", target.name));
        }
        let is_local = self.frames.last().is_some_and(|frame| frame.locals.contains_key(&target.name));
        if target.is_global || !is_local && self.globals.contains_key(&target.name) {
            self.globals.insert(target.name, value);
        } else if let Some(frame) = self.frames.last_mut() {
            frame.locals.insert(target.name, value);
        }
        Ok(())
    }

    fn assign(&mut self, target: Target, value: Value, host: &mut SimulatedController) -> Result<(), String> {
        let Some(item) = &target.item else { return self.put(target, value) };
        let (item, mut whole) = (self.value(item, host)?, self.variable(&target.name)?);
        match (&mut whole, &value) {
            (Value::List(items), _) => {
                let at = place(&item, items.len())?;
                items[at] = value;
            }
            (Value::Pose(parts), Value::Number(number)) => parts[place(&item, 6)?] = *number,
            _ => return Err(format!("{} is {}; it has no items", target.name, whole.words())),
        }
        self.put(target, whole)
    }

    fn variable(&self, name: &str) -> Result<Value, String> {
        let local = self.frames.last().and_then(|frame| frame.locals.get(name));
        let value = local.or_else(|| self.globals.get(name)).cloned();
        value.ok_or_else(|| format!("no variable {name}"))
    }

    fn arguments(&mut self, call: &Call, host: &mut SimulatedController) -> Result<Arguments, String> {
        let mut arguments = Arguments::default();
        for (name, value) in &call.arguments {
            let value = self.value(value, host)?;
            match name {
                Some(name) => arguments.by_name.push((name.clone(), value)),
                None => arguments.by_place.push(value),
            }
        }
        Ok(arguments)
    }

    fn value(&mut self, expression: &Expression, host: &mut SimulatedController) -> Result<Value, String> {
        Ok(match expression {
            Expression::Number(number) => Value::Number(*number),
            Expression::Truth(truth) => Value::Truth(*truth),
            Expression::Text(text) => Value::Text(text.clone()),
            Expression::Name(name) => self.variable(name)?,
            Expression::List(items) => {
                Value::List(items.iter().map(|item| self.value(item, host)).collect::<Result<_, _>>()?)
            }
            Expression::Pose(parts) => {
                let number = |value: Value| value.number().ok_or_else(|| format!("{} in a pose", value.words()));
                let parts = parts.iter().map(|part| self.value(part, host).and_then(number));
                Value::Pose(parts.collect::<Result<Vec<_>, _>>()?.try_into().map_err(|_| "a pose has 6 numbers")?)
            }
            Expression::Item(whole, item) => {
                let (whole, item) = (self.value(whole, host)?, self.value(item, host)?);
                match &whole {
                    Value::List(items) => items[place(&item, items.len())?].clone(),
                    Value::Pose(parts) => Value::Number(parts[place(&item, 6)?]),
                    _ => return Err(format!("an item of {}", whole.words())),
                }
            }
            Expression::Call(call) => {
                if self.script.functions.iter().any(|one| one.name == call.name) {
                    return Err(format!("{} inside of an expression: assign its value to a variable first", call.name));
                }
                let arguments = self.arguments(call, host)?;
                match builtin(call, &arguments, host)? {
                    Outcome::Value(value) => value,
                    _ => return Err(format!("{} gives no value", call.name)),
                }
            }
            Expression::Not(inner) => match self.value(inner, host)? {
                Value::Truth(truth) => Value::Truth(!truth),
                other => return Err(format!("not {}", other.words())),
            },
            Expression::Negative(inner) => match self.value(inner, host)? {
                Value::Number(number) => Value::Number(-number),
                other => return Err(format!("-{}", other.words())),
            },
            Expression::Binary(operator, left, right) => {
                let left = self.value(left, host)?;
                // The right side of a decided condition is not computed.
                if matches!((*operator, &left), ("and", Value::Truth(false)) | ("or", Value::Truth(true))) {
                    return Ok(left);
                }
                combined(operator, &left, &self.value(right, host)?)?
            }
        })
    }
}

fn builtin(call: &Call, arguments: &Arguments, host: &mut SimulatedController) -> Result<Outcome, String> {
    let outcome = host.call(&call.name, arguments);
    let outcome = outcome.ok_or_else(|| format!("no function {}, or none that is supported", call.name))?;
    outcome.map_err(|found| format!("{}: {found}", call.name))
}

fn place(item: &Value, length: usize) -> Result<usize, String> {
    match item {
        Value::Number(number) if *number >= 0.0 && number.fract() == 0.0 && (*number as usize) < length => {
            Ok(*number as usize)
        }
        _ => Err(format!("item {} of {length}", item.words())),
    }
}

fn combined(operator: &str, left: &Value, right: &Value) -> Result<Value, String> {
    Ok(match (operator, left, right) {
        ("==", ..) => Value::Truth(left == right),
        ("!=", ..) => Value::Truth(left != right),
        ("and", Value::Truth(one), Value::Truth(two)) => Value::Truth(*one && *two),
        ("or", Value::Truth(one), Value::Truth(two)) => Value::Truth(*one || *two),
        ("xor", Value::Truth(one), Value::Truth(two)) => Value::Truth(one != two),
        ("<", Value::Number(one), Value::Number(two)) => Value::Truth(one < two),
        (">", Value::Number(one), Value::Number(two)) => Value::Truth(one > two),
        ("<=", Value::Number(one), Value::Number(two)) => Value::Truth(one <= two),
        (">=", Value::Number(one), Value::Number(two)) => Value::Truth(one >= two),
        ("+", Value::Number(one), Value::Number(two)) => Value::Number(one + two),
        ("-", Value::Number(one), Value::Number(two)) => Value::Number(one - two),
        ("*", Value::Number(one), Value::Number(two)) => Value::Number(one * two),
        ("/" | "%", Value::Number(_), Value::Number(0.0)) => return Err("a division by 0".to_string()),
        ("/", Value::Number(one), Value::Number(two)) => Value::Number(one / two),
        ("%", Value::Number(one), Value::Number(two)) => Value::Number(one % two),
        _ => return Err(format!("{} and {}, which do not go together", left.words(), right.words())),
    })
}
