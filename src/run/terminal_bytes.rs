//! Bytes from the terminal as messages to the console: keys, mouse, focus and pasted text.
//!
//! The space bar stops the robot, so no byte that came before may keep it from doing so. The parsers of crossterm and of
//! the crates derived from it drop the byte at which an escape sequence turns out to be invalid, and wait for the end of
//! an incomplete one without a time limit. Here a space ends every incomplete sequence and counts as a key, except
//! within a paste that ends; and after `SILENCE` without a byte, an incomplete sequence is given up. Bytes and times
//! are given to the parser, so it depends neither on a clock nor on how the bytes are split into reads.

use std::time::{Duration, Instant};

use crossterm::event::{KeyCode, KeyEvent, KeyEventKind, KeyModifiers};

use crate::console::ConsoleMessage;

/// Time without a byte after which an incomplete sequence is given up: terminals send a sequence at once.
const SILENCE: Duration = Duration::from_millis(50);
/// Time without further text after which a paste without an end is given up.
const UNENDED: Duration = Duration::from_secs(1);
/// Number of bytes of a paste that are kept; no text field takes nearly as much.
const MAX_PASTE: usize = 64 << 10;
/// Number of parameter bytes of a sequence that are kept; those of keys and mouse are shorter.
const MAX_PARAMETERS: usize = 64;
/// Sequence at the end of pasted text.
const PASTE_END: &[u8] = b"\x1b[201~";

const ESC: u8 = 0x1b;
const BEL: u8 = 0x07;

/// Parser of the bytes that the terminal sends.
#[derive(Debug, Default)]
pub struct TerminalParser {
    state: ParserState,
    /// Time at which the present incomplete sequence is given up; `None` if the last sequence was complete.
    deadline: Option<Instant>,
}

/// What the bytes since the last complete sequence are the beginning of.
#[derive(Debug, Default)]
enum ParserState {
    #[default]
    Ground,
    /// `ESC`: the key, a key with alt, or a longer sequence.
    Escape,
    /// A character of which these bytes of its UTF-8 form were read, typed with alt or without.
    Character { bytes: Vec<u8>, alt: bool },
    /// `ESC [`, with the sequence's parameters.
    Csi(Vec<u8>),
    /// `ESC [ [`: a function key of the Linux console.
    LinuxKey,
    /// `ESC O`: an arrow or function key.
    Ss3,
    /// `ESC [ M`, with the number of bytes still to come: the oldest form of mouse reports. Terminals are asked for newer
    /// ones, so these bytes are skipped; but a space among them counts as the space bar.
    OldMouse(u8),
    /// A string for programs, such as an answer to a query: `ESC` and this byte, until `ESC \` or BEL; `is_empty` says
    /// that nothing has followed yet.
    ControlString { opener: u8, is_empty: bool },
    /// `ESC` within a string for programs: the string's end, if `\` follows.
    StringEnd,
    /// `ESC [ 200 ~`: pasted text.
    Paste(OpenPaste),
}

/// Pasted text whose end was not read yet.
#[derive(Debug, Default)]
struct OpenPaste {
    bytes: Vec<u8>,
    /// Number of bytes beyond those that are kept.
    beyond: usize,
    /// Number of bytes of [`PASTE_END`] that were read last.
    matched: usize,
    /// Whether the last bytes are an incomplete escape sequence.
    in_sequence: bool,
}

impl TerminalParser {
    /// Reads the bytes that arrived by this time, and returns what they mean.
    pub fn read(&mut self, bytes: &[u8], now: Instant) -> Vec<ConsoleMessage> {
        let mut messages = Vec::new();
        let mut is_text = false;
        for &byte in bytes {
            is_text |= self.take(byte, &mut messages);
        }
        self.deadline = match (&self.state, self.deadline) {
            (ParserState::Ground, _) => None,
            // What a key sends while it is held down must not keep a paste open.
            (ParserState::Paste(_), Some(deadline)) if !is_text => Some(deadline),
            (ParserState::Paste(_), _) => Some(now + UNENDED),
            _ => Some(now + SILENCE),
        };
        messages
    }

    /// Time at which an incomplete sequence is to be given up, if no byte arrives before ([`TerminalParser::expire`]).
    pub fn deadline(&self) -> Option<Instant> {
        self.deadline
    }

    /// Gives up an incomplete sequence whose time is over, and returns the keys that its bytes can mean.
    pub fn expire(&mut self, now: Instant) -> Vec<ConsoleMessage> {
        if self.deadline.is_none_or(|deadline| now < deadline) {
            return Vec::new();
        }
        self.deadline = None;
        let alt = |letter: u8| vec![typed(char::from(letter), true)];
        match std::mem::take(&mut self.state) {
            ParserState::Escape | ParserState::StringEnd => vec![press(KeyCode::Esc, KeyModifiers::NONE)],
            ParserState::Csi(parameters) if parameters.is_empty() => alt(b'['),
            ParserState::Ss3 => alt(b'O'),
            ParserState::ControlString { opener, is_empty: true } => alt(opener),
            ParserState::Paste(paste) => paste.give_up(),
            _ => Vec::new(),
        }
    }

    /// Reads a byte; returns whether it is text of a paste, which keeps the paste open.
    fn take(&mut self, byte: u8, messages: &mut Vec<ConsoleMessage>) -> bool {
        if let ParserState::Paste(paste) = &mut self.state {
            let is_text = paste.push(byte);
            if paste.matched == PASTE_END.len()
                && let ParserState::Paste(paste) = std::mem::take(&mut self.state)
            {
                messages.push(ConsoleMessage::Paste(Some(paste.text())));
            }
            return is_text;
        }
        self.state = match (std::mem::take(&mut self.state), byte) {
            (ParserState::OldMouse(left), 0x20..) => {
                if byte == b' ' {
                    messages.push(typed(' ', false));
                }
                if left > 1 { ParserState::OldMouse(left - 1) } else { ParserState::Ground }
            }
            // The space bar ends whatever came before.
            (ParserState::Escape, b' ') => begin(byte, true, messages),
            (_, b' ') => begin(byte, false, messages),
            (ParserState::Escape | ParserState::StringEnd, ESC) => {
                messages.push(press(KeyCode::Esc, KeyModifiers::NONE));
                ParserState::Escape
            }
            (ParserState::ControlString { .. }, ESC) => ParserState::StringEnd,
            (_, ESC) => ParserState::Escape,
            (ParserState::StringEnd, b'\\') => ParserState::Ground,
            (ParserState::Escape | ParserState::StringEnd, b'[') => ParserState::Csi(Vec::new()),
            (ParserState::Escape | ParserState::StringEnd, b'O') => ParserState::Ss3,
            (ParserState::Escape | ParserState::StringEnd, b']' | b'P' | b'X' | b'^' | b'_') => {
                ParserState::ControlString { opener: byte, is_empty: true }
            }
            (ParserState::Escape | ParserState::StringEnd, _) => begin(byte, true, messages),
            (ParserState::Character { mut bytes, alt }, 0x80..=0xbf) => {
                bytes.push(byte);
                character(bytes, alt, messages)
            }
            (ParserState::Csi(mut parameters), 0x21..=0x3f) => {
                // The rest of a longer sequence, which is none of keys or mouse, is skipped.
                if parameters.len() < MAX_PARAMETERS {
                    parameters.push(byte);
                }
                ParserState::Csi(parameters)
            }
            (ParserState::Csi(parameters), 0x40..=0x7e) => sequence(&parameters, byte, messages),
            (ParserState::LinuxKey, b'A'..=b'E') => {
                messages.push(press(KeyCode::F(1 + byte - b'A'), KeyModifiers::NONE));
                ParserState::Ground
            }
            // Old terminals put the modifiers here.
            (ParserState::Ss3, b'0'..=b'9' | b';') => ParserState::Ss3,
            (ParserState::Ss3, 0x40..=0x7e) => {
                messages.extend(letter_key(byte).map(|code| press(code, KeyModifiers::NONE)));
                ParserState::Ground
            }
            (ParserState::ControlString { .. }, BEL) => ParserState::Ground,
            (ParserState::ControlString { opener, .. }, 0x21..) => {
                ParserState::ControlString { opener, is_empty: false }
            }
            // The byte belongs to nothing that came before.
            (_, _) => begin(byte, false, messages),
        };
        if matches!(self.state, ParserState::Paste(_)) {
            // The time of the sequence that begins a paste is not the paste's.
            self.deadline = None;
        }
        false
    }
}

impl OpenPaste {
    /// Reads a byte; returns whether it is text that no held key sends: neither a space nor part of a sequence.
    fn push(&mut self, byte: u8) -> bool {
        let is_text = !self.in_sequence && byte != ESC && byte != b' ';
        self.in_sequence = byte == ESC || (self.in_sequence && !(matches!(byte, 0x40..=0x7e) && byte != b'['));
        if byte == PASTE_END[self.matched] {
            self.matched += 1;
            return is_text;
        }
        for &passed in &PASTE_END[..std::mem::take(&mut self.matched)] {
            self.keep(passed);
        }
        match byte {
            ESC => self.matched = 1,
            _ => self.keep(byte),
        }
        is_text
    }

    fn keep(&mut self, byte: u8) {
        match self.bytes.len() < MAX_PASTE {
            true => self.bytes.push(byte),
            false => self.beyond += 1,
        }
    }

    /// The pasted text. What is beyond the kept bytes is replaced by as many signs, so that the text is too long for
    /// every field, and is refused as a whole.
    fn text(self) -> String {
        let mut text = String::from_utf8_lossy(&self.bytes).into_owned();
        text.extend(std::iter::repeat_n('…', self.beyond.min(MAX_PASTE)));
        text
    }

    /// What a paste without an end means: its text is dropped, but a space in it may have been the space bar. Terminals
    /// with kitty's keyboard protocol send the space bar as a sequence, with the number 32.
    fn give_up(self) -> Vec<ConsoleMessage> {
        let has_space = self.beyond > 0
            || self.bytes.iter().any(|byte| matches!(byte, 0 | b' '))
            || self.bytes.windows(4).any(|part| part == b"\x1b[32");
        let mut messages = vec![ConsoleMessage::Paste(None)];
        if has_space {
            messages.push(press(KeyCode::Char(' '), KeyModifiers::NONE));
        }
        messages
    }
}

/// Reads a byte that begins a key.
fn begin(byte: u8, alt: bool, messages: &mut Vec<ConsoleMessage>) -> ParserState {
    let with_alt = if alt { KeyModifiers::ALT } else { KeyModifiers::NONE };
    let ctrl = |letter: u8| press(KeyCode::Char(char::from(letter)), with_alt | KeyModifiers::CONTROL);
    messages.push(match byte {
        b'\r' => press(KeyCode::Enter, with_alt),
        b'\t' => press(KeyCode::Tab, with_alt),
        0x7f => press(KeyCode::Backspace, with_alt),
        0 => ctrl(b' '),
        0x01..=0x1a => ctrl(byte - 1 + b'a'),
        0x1c..=0x1f => ctrl(byte - 0x1c + b'4'),
        0x20..=0x7e => typed(char::from(byte), alt),
        // Bytes that begin no character are dropped.
        _ => return character(vec![byte], alt, messages),
    });
    ParserState::Ground
}

/// Reads the character of these bytes, if they are all of its bytes.
fn character(bytes: Vec<u8>, alt: bool, messages: &mut Vec<ConsoleMessage>) -> ParserState {
    match std::str::from_utf8(&bytes) {
        Ok(text) => messages.extend(text.chars().map(|letter| typed(letter, alt))),
        Err(error) if error.error_len().is_none() => return ParserState::Character { bytes, alt },
        // The bytes are no character.
        Err(_) => {}
    }
    ParserState::Ground
}

/// Reads a sequence `ESC [`, parameters, final byte.
fn sequence(parameters: &[u8], last: u8, messages: &mut Vec<ConsoleMessage>) -> ParserState {
    let fields = fields(parameters.strip_prefix(b"<").unwrap_or(parameters));
    let first = fields.first().map_or(0, |field| field[0]);
    let [mask, kind] = fields.get(1).map_or([1, 1], |field| [field[0].max(1), field[1]]);
    let modifiers = modifiers(mask);
    let kind = match kind {
        2 => KeyEventKind::Repeat,
        3 => KeyEventKind::Release,
        _ => KeyEventKind::Press,
    };
    let key = |code, modifiers| ConsoleMessage::Key(KeyEvent::new_with_kind(code, modifiers, kind));
    messages.extend(match (parameters, last) {
        ([b'<', ..], b'M' | b'm') => report(&fields).and_then(|report| mouse(report, last == b'm')),
        // Answers to queries.
        ([b'<' | b'=' | b'>' | b'?', ..], _) => None,
        ([], b'M') => return ParserState::OldMouse(3),
        ([], b'[') => return ParserState::LinuxKey,
        ([], b'I') => Some(ConsoleMessage::Focus(true)),
        ([], b'O') => Some(ConsoleMessage::Focus(false)),
        (_, b'M') => {
            report(&fields).and_then(|[button, column, row]| mouse([button.checked_sub(0x20)?, column, row], false))
        }
        (b"200", b'~') => return ParserState::Paste(OpenPaste::default()),
        (_, b'~') => numbered_key(first).map(|code| key(code, modifiers)),
        (_, b'u') => {
            let shifted = fields.first().map(|field| field[1]).filter(|_| modifiers.contains(KeyModifiers::SHIFT));
            let shifted = shifted.and_then(char::from_u32).filter(|letter| !letter.is_control());
            match shifted {
                Some(letter) => Some(key(KeyCode::Char(letter), modifiers - KeyModifiers::SHIFT)),
                None => coded_key(first, modifiers).map(|code| key(code, modifiers)),
            }
        }
        (_, b'Z') => Some(key(KeyCode::BackTab, modifiers | KeyModifiers::SHIFT)),
        _ => letter_key(last).map(|code| key(code, modifiers)),
    });
    ParserState::Ground
}

/// Parameters of a sequence: fields that are separated by `;`, each with its first two numbers, which are separated by
/// `:`. A number that is missing or too large is 0.
fn fields(parameters: &[u8]) -> Vec<[u32; 2]> {
    let number = |digits: Option<&[u8]>| {
        let digits = std::str::from_utf8(digits.unwrap_or_default()).ok();
        digits.and_then(|digits| digits.parse().ok()).unwrap_or(0)
    };
    let field = |field: &[u8]| {
        let mut numbers = field.split(|&byte| byte == b':');
        [number(numbers.next()), number(numbers.next())]
    };
    parameters.split(|&byte| byte == b';').map(field).collect()
}

/// Numbers of a mouse report: button, column and row.
fn report(fields: &[[u32; 2]]) -> Option<[u32; 3]> {
    let [button, column, row] = fields else { return None };
    Some([button[0], column[0], row[0]])
}

/// The mouse report of a button, a column and a row, both counted from 1 (xterm's control sequences, "Mouse Tracking").
fn mouse([button, column, row]: [u32; 3], is_release: bool) -> Option<ConsoleMessage> {
    const MOVES: u32 = 0x20;
    let cell = |at: u32| u16::try_from(at.checked_sub(1)?).ok();
    let (column, row) = (cell(column)?, cell(row)?);
    Some(match (button & 0xc3, button & MOVES != 0) {
        (0, false) if !is_release => ConsoleMessage::Click(column, row),
        (0x40, false) => ConsoleMessage::Wheel(column, row, 1),
        (0x41, false) => ConsoleMessage::Wheel(column, row, -1),
        _ => ConsoleMessage::Pointer(column, row),
    })
}

/// Modifiers in a parameter, which is 1 more than the sum of the held ones.
fn modifiers(mask: u32) -> KeyModifiers {
    const HELD: [(u32, KeyModifiers); 6] = [
        (1, KeyModifiers::SHIFT),
        (2, KeyModifiers::ALT),
        (4, KeyModifiers::CONTROL),
        (8, KeyModifiers::SUPER),
        (16, KeyModifiers::HYPER),
        (32, KeyModifiers::META),
    ];
    let held = HELD.iter().filter(|(bit, _)| (mask - 1) & bit != 0);
    held.fold(KeyModifiers::NONE, |all, (_, modifier)| all | *modifier)
}

fn letter_key(letter: u8) -> Option<KeyCode> {
    Some(match letter {
        b'A' => KeyCode::Up,
        b'B' => KeyCode::Down,
        b'C' => KeyCode::Right,
        b'D' => KeyCode::Left,
        b'F' => KeyCode::End,
        b'H' => KeyCode::Home,
        b'M' => KeyCode::Enter,
        b'P'..=b'S' => KeyCode::F(1 + letter - b'P'),
        _ => return None,
    })
}

fn numbered_key(number: u32) -> Option<KeyCode> {
    Some(match number {
        1 | 7 => KeyCode::Home,
        2 => KeyCode::Insert,
        3 => KeyCode::Delete,
        4 | 8 => KeyCode::End,
        5 => KeyCode::PageUp,
        6 => KeyCode::PageDown,
        11..=15 => KeyCode::F(number as u8 - 10),
        17..=21 => KeyCode::F(number as u8 - 11),
        23..=24 => KeyCode::F(number as u8 - 12),
        _ => return None,
    })
}

/// The key with this number in kitty's keyboard protocol, `ESC [ number u`; `None` for keys that no key table can name,
/// such as the modifiers themselves.
fn coded_key(number: u32, modifiers: KeyModifiers) -> Option<KeyCode> {
    const KEYPAD: &[u8] = b"0123456789./*-+";
    Some(match number {
        9 if modifiers.contains(KeyModifiers::SHIFT) => KeyCode::BackTab,
        9 => KeyCode::Tab,
        13 | 57414 => KeyCode::Enter,
        27 => KeyCode::Esc,
        127 => KeyCode::Backspace,
        57399..=57413 => KeyCode::Char(char::from(KEYPAD[(number - 57399) as usize])),
        57415 => KeyCode::Char('='),
        57416 => KeyCode::Char(','),
        57417 => KeyCode::Left,
        57418 => KeyCode::Right,
        57419 => KeyCode::Up,
        57420 => KeyCode::Down,
        57421 => KeyCode::PageUp,
        57422 => KeyCode::PageDown,
        57423 => KeyCode::Home,
        57424 => KeyCode::End,
        57425 => KeyCode::Insert,
        57426 => KeyCode::Delete,
        // The other keys of the protocol, in Unicode's private area.
        57344..=63743 => return None,
        _ => KeyCode::Char(char::from_u32(number).filter(|letter| !letter.is_control())?),
    })
}

/// A typed character. A capital counts as typed with shift.
fn typed(letter: char, alt: bool) -> ConsoleMessage {
    let shift = if letter.is_uppercase() { KeyModifiers::SHIFT } else { KeyModifiers::NONE };
    press(KeyCode::Char(letter), if alt { shift | KeyModifiers::ALT } else { shift })
}

fn press(code: KeyCode, modifiers: KeyModifiers) -> ConsoleMessage {
    ConsoleMessage::Key(KeyEvent::new(code, modifiers))
}
