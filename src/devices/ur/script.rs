//! Reads the part of URScript that the simulated controller runs: definitions, assignments, `if`, `while`, and calls.
//!
//! A function is read into instructions with jumps, so that a running program can wait in any place for a motion to end.
//! What takes time is a statement, or the whole right side of an assignment, and never a part of an expression.

use thiserror::Error;

/// Longest script, in bytes.
pub const MOST_BYTES: usize = 1 << 20;
/// Deepest nesting of blocks and expressions: reading them is recursive.
const DEEPEST: u32 = 64;

/// What is wrong with a script, or went wrong while it ran.
#[derive(Clone, Debug, Error, PartialEq, Eq)]
#[error("line {line}: {found}")]
pub struct ScriptError {
    /// The first line is 1.
    pub line: u32,
    pub found: String,
}

#[derive(Clone, Debug, PartialEq)]
pub enum Expression {
    Number(f64),
    Truth(bool),
    Text(String),
    Name(String),
    List(Vec<Expression>),
    /// `p[x, y, z, rx, ry, rz]`: metres, and a rotation vector in radians.
    Pose(Vec<Expression>),
    Item(Box<Expression>, Box<Expression>),
    Call(Call),
    Not(Box<Expression>),
    Negative(Box<Expression>),
    /// One of `OPERATORS`, between these two.
    Binary(&'static str, Box<Expression>, Box<Expression>),
}

/// Operators between two values; those of a later list bind stronger, and `not` stands at the place of the empty one.
const OPERATORS: [&[&str]; 6] =
    [&["or", "xor"], &["and"], &[], &["==", "!=", "<", ">", "<=", ">="], &["+", "-"], &["*", "/", "%"]];

#[derive(Clone, Debug, PartialEq)]
pub struct Call {
    pub name: String,
    /// Each with its name, if it has one, as in `a=1.2`.
    pub arguments: Vec<(Option<String>, Expression)>,
}

/// Where an assignment puts a value.
#[derive(Clone, Debug, PartialEq)]
pub struct Target {
    pub name: String,
    pub is_global: bool,
    pub item: Option<Expression>,
}

#[derive(Clone, Debug, PartialEq)]
pub enum Instruction {
    /// A call as a statement or as the right side of an assignment: it can take time.
    Call(Call, Option<Target>),
    Assign(Target, Expression),
    Jump(usize),
    JumpUnless(Expression, usize),
    Return(Option<Expression>),
}

#[derive(Clone, Debug, PartialEq)]
pub struct Function {
    pub name: String,
    pub parameters: Vec<(String, Option<Expression>)>,
    /// Each with its line.
    pub code: Vec<(u32, Instruction)>,
}

/// A script that was read: the function that runs comes first.
#[derive(Clone, Debug, PartialEq)]
pub struct Script {
    pub functions: Vec<Function>,
}

impl Script {
    /// Reads a script: one definition with further definitions inside, or statements alone.
    ///
    /// # Errors
    /// The first place that is not in the supported part of URScript.
    pub fn read(text: &str) -> Result<Script, ScriptError> {
        let tokens = tokens(text)?;
        let mut reader = Reader { tokens: &tokens, at: 0, depth: 0, functions: Vec::new() };
        let mut main = Function { name: "script".to_string(), parameters: Vec::new(), code: Vec::new() };
        reader.block(&mut main, &mut Vec::new())?;
        if reader.peek() != &Token::End {
            return Err(reader.unexpected("a statement"));
        }
        let mut functions = reader.functions;
        // A definition alone is the program; the controller runs it without a call.
        if main.code.is_empty() && !functions.is_empty() {
            let last = functions.len() - 1;
            functions.swap(0, last);
        } else {
            functions.insert(0, main);
        }
        Ok(Script { functions })
    }
}

#[derive(Clone, Debug, PartialEq)]
enum Token {
    Word(String),
    Number(f64),
    Text(String),
    Symbol(&'static str),
    /// The end of a line outside of brackets.
    Line,
    End,
}

const SYMBOLS: [&str; 21] =
    ["==", "!=", "<=", ">=", "<", ">", "=", "+", "-", "*", "/", "%", "(", ")", "[", "]", ",", ":", ";", "{", "}"];

fn tokens(text: &str) -> Result<Vec<(u32, Token)>, ScriptError> {
    let mut found = Vec::new();
    let (mut line, mut brackets, mut rest) = (1, 0_u32, text);
    while let Some(first) = rest.chars().next() {
        let mut taken = first.len_utf8();
        match first {
            '\n' => {
                if brackets == 0 {
                    found.push((line, Token::Line));
                }
                line += 1;
            }
            '#' => taken = rest.find('\n').unwrap_or(rest.len()),
            '"' | '\'' => {
                let body = &rest[1..];
                let end = body.find(first).filter(|end| !body[..*end].contains('\n'));
                let end = end.ok_or_else(|| ScriptError { line, found: "a text that does not end".to_string() })?;
                found.push((line, Token::Text(body[..end].to_string())));
                taken = end + 2;
            }
            _ if first.is_whitespace() => {}
            _ if first.is_alphabetic() || first == '_' => {
                let is_part = |letter: char| letter.is_alphanumeric() || letter == '_';
                taken = rest.find(|letter| !is_part(letter)).unwrap_or(rest.len());
                found.push((line, Token::Word(rest[..taken].to_string())));
            }
            _ if first.is_ascii_digit() || first == '.' => {
                taken = number_length(rest);
                let number = rest[..taken]
                    .parse()
                    .map_err(|_| ScriptError { line, found: format!("{:?}, which is no number", &rest[..taken]) })?;
                found.push((line, Token::Number(number)));
            }
            _ => {
                let symbol = SYMBOLS.iter().find(|symbol| rest.starts_with(**symbol));
                let symbol = symbol.ok_or_else(|| ScriptError { line, found: format!("{first:?}") })?;
                match *symbol {
                    "(" | "[" => brackets += 1,
                    ")" | "]" => brackets = brackets.saturating_sub(1),
                    _ => {}
                }
                taken = symbol.len();
                found.push((line, if *symbol == ";" { Token::Line } else { Token::Symbol(symbol) }));
            }
        }
        rest = &rest[taken..];
    }
    found.push((line, Token::Line));
    found.push((line, Token::End));
    Ok(found)
}

/// The length of the number at the beginning of a text, in bytes: digits, a point, an exponent.
fn number_length(text: &str) -> usize {
    let mut before = ' ';
    let ends = |letter: char| {
        let is_sign_of_exponent = matches!(letter, '+' | '-') && matches!(before, 'e' | 'E');
        before = letter;
        !matches!(letter, '0'..='9' | '.' | 'e' | 'E') && !is_sign_of_exponent
    };
    text.find(ends).unwrap_or(text.len())
}

/// Reads tokens into functions.
struct Reader<'a> {
    tokens: &'a [(u32, Token)],
    at: usize,
    depth: u32,
    functions: Vec<Function>,
}

/// The jumps out of a loop whose ends are not known yet.
#[derive(Default)]
struct Loop {
    begins: usize,
    breaks: Vec<usize>,
}

const BLOCK_WORDS: [&str; 3] = ["end", "else", "elif"];

impl Reader<'_> {
    fn peek(&self) -> &Token {
        self.tokens.get(self.at).map_or(&Token::End, |(_, token)| token)
    }

    fn line(&self) -> u32 {
        self.tokens.get(self.at).or(self.tokens.last()).map_or(1, |(line, _)| *line)
    }

    fn wrong<T>(&self, found: impl Into<String>) -> Result<T, ScriptError> {
        Err(ScriptError { line: self.line(), found: found.into() })
    }

    fn unexpected(&self, wanted: &str) -> ScriptError {
        let found = match self.peek() {
            Token::Word(word) => word.clone(),
            Token::Number(number) => number.to_string(),
            Token::Text(text) => format!("{text:?}"),
            Token::Symbol(symbol) => (*symbol).to_string(),
            Token::Line => "the end of the line".to_string(),
            Token::End => "the end of the script".to_string(),
        };
        ScriptError { line: self.line(), found: format!("found {found} where {wanted} is expected") }
    }

    fn take(&mut self, symbol: &'static str) -> bool {
        let is_next = self.peek() == &Token::Symbol(symbol);
        self.at += usize::from(is_next);
        is_next
    }

    fn need(&mut self, symbol: &'static str) -> Result<(), ScriptError> {
        if self.take(symbol) { Ok(()) } else { Err(self.unexpected(symbol)) }
    }

    fn is_word(&self, word: &str) -> bool {
        matches!(self.peek(), Token::Word(found) if found == word)
    }

    fn take_word(&mut self, word: &str) -> bool {
        let is_next = self.is_word(word);
        self.at += usize::from(is_next);
        is_next
    }

    fn name(&mut self) -> Result<String, ScriptError> {
        match self.peek() {
            Token::Word(word) => {
                let word = word.clone();
                self.at += 1;
                Ok(word)
            }
            _ => Err(self.unexpected("a name")),
        }
    }

    fn deeper(&mut self) -> Result<(), ScriptError> {
        self.depth += 1;
        if self.depth > DEEPEST { self.wrong(format!("more than {DEEPEST} levels")) } else { Ok(()) }
    }

    /// Statements up to `end`, `else`, `elif` or the end of the script.
    fn block(&mut self, into: &mut Function, loops: &mut Vec<Loop>) -> Result<(), ScriptError> {
        self.deeper()?;
        loop {
            while self.peek() == &Token::Line {
                self.at += 1;
            }
            let is_over = BLOCK_WORDS.iter().any(|word| self.is_word(word));
            if is_over || self.peek() == &Token::End {
                break;
            }
            self.statement(into, loops)?;
        }
        self.depth -= 1;
        Ok(())
    }

    fn statement(&mut self, into: &mut Function, loops: &mut Vec<Loop>) -> Result<(), ScriptError> {
        let line = self.line();
        let Token::Word(word) = self.peek().clone() else { return Err(self.unexpected("a statement")) };
        match word.as_str() {
            "def" => return self.definition(),
            "if" => return self.choice(into, loops),
            "while" => return self.repetition(into, loops),
            "thread" | "sec" | "for" | "struct" => return self.wrong(format!("{word} is not supported")),
            "break" | "continue" => {
                self.at += 1;
                let at = into.code.len();
                match (loops.last_mut(), word.as_str()) {
                    (None, _) => return self.wrong(format!("{word} outside of a loop")),
                    (Some(inner), "break") => {
                        inner.breaks.push(at);
                        into.code.push((line, Instruction::Jump(usize::MAX)));
                    }
                    (Some(inner), _) => into.code.push((line, Instruction::Jump(inner.begins))),
                }
            }
            "pass" => self.at += 1,
            "return" => {
                self.at += 1;
                let is_bare = self.peek() == &Token::Line;
                let value = if is_bare { None } else { Some(self.expression()?) };
                into.code.push((line, Instruction::Return(value)));
            }
            _ => {
                let instruction = self.assignment_or_call()?;
                into.code.push((line, instruction));
            }
        }
        match self.peek() {
            Token::Line => self.at += 1,
            Token::End => {}
            _ => return Err(self.unexpected("the end of the line")),
        }
        Ok(())
    }

    fn assignment_or_call(&mut self) -> Result<Instruction, ScriptError> {
        let is_global = self.take_word("global");
        if !is_global {
            self.take_word("local");
        }
        let begin = self.at;
        let name = self.name()?;
        let item = if self.take("[") {
            let item = self.expression()?;
            self.need("]")?;
            Some(item)
        } else {
            None
        };
        if !self.take("=") {
            self.at = begin;
            return match self.expression()? {
                Expression::Call(call) => Ok(Instruction::Call(call, None)),
                _ => self.wrong("a value with which nothing is done"),
            };
        }
        let target = Target { name, is_global, item };
        Ok(match self.expression()? {
            Expression::Call(call) => Instruction::Call(call, Some(target)),
            value => Instruction::Assign(target, value),
        })
    }

    fn head(&mut self) -> Result<Expression, ScriptError> {
        self.at += 1;
        let condition = self.expression()?;
        self.need(":")?;
        Ok(condition)
    }

    fn need_end(&mut self) -> Result<(), ScriptError> {
        if self.take_word("end") { Ok(()) } else { Err(self.unexpected("end")) }
    }

    fn choice(&mut self, into: &mut Function, loops: &mut Vec<Loop>) -> Result<(), ScriptError> {
        let mut ends = Vec::new();
        loop {
            let line = self.line();
            let condition = self.head()?;
            let test = into.code.len();
            into.code.push((line, Instruction::JumpUnless(condition, usize::MAX)));
            self.block(into, loops)?;
            ends.push(into.code.len());
            into.code.push((self.line(), Instruction::Jump(usize::MAX)));
            let otherwise = into.code.len();
            if let Instruction::JumpUnless(_, to) = &mut into.code[test].1 {
                *to = otherwise;
            }
            if !self.is_word("elif") {
                break;
            }
        }
        if self.take_word("else") {
            self.need(":")?;
            self.block(into, loops)?;
        }
        self.need_end()?;
        let after = into.code.len();
        for end in ends {
            into.code[end].1 = Instruction::Jump(after);
        }
        Ok(())
    }

    fn repetition(&mut self, into: &mut Function, loops: &mut Vec<Loop>) -> Result<(), ScriptError> {
        let (line, begins) = (self.line(), into.code.len());
        let condition = self.head()?;
        into.code.push((line, Instruction::JumpUnless(condition, usize::MAX)));
        loops.push(Loop { begins, breaks: vec![begins] });
        self.block(into, loops)?;
        self.need_end()?;
        into.code.push((line, Instruction::Jump(begins)));
        let after = into.code.len();
        for at in loops.pop().unwrap_or_default().breaks {
            match &mut into.code[at].1 {
                Instruction::JumpUnless(_, to) | Instruction::Jump(to) => *to = after,
                _ => {}
            }
        }
        Ok(())
    }

    fn definition(&mut self) -> Result<(), ScriptError> {
        self.at += 1;
        let name = self.name()?;
        self.need("(")?;
        let parameters = self.list(")", |reader| {
            let parameter = reader.name()?;
            let default = if reader.take("=") { Some(reader.expression()?) } else { None };
            Ok((parameter, default))
        })?;
        self.need(":")?;
        let mut function = Function { name, parameters, code: Vec::new() };
        self.block(&mut function, &mut Vec::new())?;
        self.need_end()?;
        self.functions.push(function);
        Ok(())
    }

    fn expression(&mut self) -> Result<Expression, ScriptError> {
        self.deeper()?;
        let found = self.binary(0);
        self.depth -= 1;
        found
    }

    /// Operators from this level of binding on; a higher level binds stronger.
    fn binary(&mut self, level: usize) -> Result<Expression, ScriptError> {
        if level == OPERATORS.len() {
            return self.unary();
        }
        if level == 2 && self.take_word("not") {
            self.deeper()?;
            let inner = self.binary(2)?;
            self.depth -= 1;
            return Ok(Expression::Not(Box::new(inner)));
        }
        let mut left = self.binary(level + 1)?;
        while let Some(operator) = self.operator(level) {
            self.at += 1;
            let right = self.binary(level + 1)?;
            left = Expression::Binary(operator, Box::new(left), Box::new(right));
        }
        Ok(left)
    }

    fn operator(&self, level: usize) -> Option<&'static str> {
        let word = match self.peek() {
            Token::Word(word) => word.as_str(),
            Token::Symbol(symbol) => symbol,
            _ => return None,
        };
        OPERATORS[level].iter().copied().find(|operator| *operator == word)
    }

    fn unary(&mut self) -> Result<Expression, ScriptError> {
        if self.take("-") {
            self.deeper()?;
            let inner = self.unary()?;
            self.depth -= 1;
            return Ok(Expression::Negative(Box::new(inner)));
        }
        let mut value = self.operand()?;
        while self.take("[") {
            let item = self.expression()?;
            self.need("]")?;
            value = Expression::Item(Box::new(value), Box::new(item));
        }
        Ok(value)
    }

    fn operand(&mut self) -> Result<Expression, ScriptError> {
        if self.take("(") {
            let inner = self.expression()?;
            self.need(")")?;
            return Ok(inner);
        }
        if self.take("[") {
            return Ok(Expression::List(self.list("]", Self::expression)?));
        }
        let value = match self.peek().clone() {
            Token::Number(number) => Expression::Number(number),
            Token::Text(text) => Expression::Text(text),
            Token::Word(_) => return self.word(),
            _ => return Err(self.unexpected("a value")),
        };
        self.at += 1;
        Ok(value)
    }

    fn word(&mut self) -> Result<Expression, ScriptError> {
        let word = self.name()?;
        Ok(match word.as_str() {
            "True" | "true" => Expression::Truth(true),
            "False" | "false" => Expression::Truth(false),
            "p" if self.take("[") => {
                let parts = self.list("]", Self::expression)?;
                if parts.len() != 6 {
                    return self.wrong(format!("a pose with {} numbers; it has 6", parts.len()));
                }
                Expression::Pose(parts)
            }
            _ if self.take("(") => Expression::Call(Call { name: word, arguments: self.arguments()? }),
            _ => Expression::Name(word),
        })
    }

    /// What `read` reads, with commas between, up to the closing bracket.
    fn list<T>(
        &mut self,
        closing: &'static str,
        read: impl Fn(&mut Self) -> Result<T, ScriptError>,
    ) -> Result<Vec<T>, ScriptError> {
        let mut items = Vec::new();
        while !self.take(closing) {
            items.push(read(self)?);
            if !self.take(",") {
                self.need(closing)?;
                break;
            }
        }
        Ok(items)
    }

    fn arguments(&mut self) -> Result<Vec<(Option<String>, Expression)>, ScriptError> {
        self.list(")", |reader| {
            let named = match (reader.peek().clone(), reader.tokens.get(reader.at + 1)) {
                (Token::Word(name), Some((_, Token::Symbol("=")))) => {
                    reader.at += 2;
                    Some(name)
                }
                _ => None,
            };
            Ok((named, reader.expression()?))
        })
    }
}

/// Gathers scripts from the bytes of a connection: a definition up to its `end`, or a single line.
#[derive(Clone, Debug, Default)]
pub struct ScriptGatherer {
    line: Vec<u8>,
    script: String,
    depth: u32,
}

impl ScriptGatherer {
    /// The scripts that these bytes complete.
    ///
    /// # Errors
    /// The script is too long.
    pub fn take(&mut self, bytes: &[u8]) -> Result<Vec<String>, ScriptError> {
        let mut complete = Vec::new();
        for &byte in bytes {
            if self.line.len() + self.script.len() > MOST_BYTES {
                *self = ScriptGatherer::default();
                return Err(ScriptError { line: 1, found: format!("a script of more than {MOST_BYTES} bytes") });
            }
            self.line.push(byte);
            if byte == b'\n' {
                complete.extend(self.end_line());
            }
        }
        Ok(complete)
    }

    fn end_line(&mut self) -> Option<String> {
        let line = String::from_utf8_lossy(&std::mem::take(&mut self.line)).into_owned();
        self.script += &line;
        // A line that cannot be read opens nothing; what is wrong is told when the script is read.
        for (_, token) in tokens(&line).unwrap_or_default() {
            let Token::Word(word) = token else { continue };
            match word.as_str() {
                "def" | "sec" | "thread" | "struct" | "if" | "while" | "for" => self.depth += 1,
                "end" => self.depth = self.depth.saturating_sub(1),
                _ => {}
            }
        }
        if self.depth > 0 {
            return None;
        }
        let script = std::mem::take(&mut self.script);
        let says_something = script.lines().any(|line| !line.trim().is_empty() && !line.trim().starts_with('#'));
        says_something.then_some(script)
    }
}
