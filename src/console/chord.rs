//! A key of the keyboard, with its names in key files and on the screen.

use std::fmt;

use crossterm::event::{KeyCode, KeyEvent, KeyModifiers};

/// Special keys: name in key files, name on the screen, and key code.
const NAMED: [(&str, &str, KeyCode); 16] = [
    ("space", "space", KeyCode::Char(' ')),
    ("tab", "tab", KeyCode::Tab),
    ("backtab", "shift-tab", KeyCode::BackTab),
    ("enter", "enter", KeyCode::Enter),
    ("backspace", "bksp", KeyCode::Backspace),
    ("esc", "esc", KeyCode::Esc),
    ("insert", "ins", KeyCode::Insert),
    ("delete", "del", KeyCode::Delete),
    ("left", "left", KeyCode::Left),
    ("right", "right", KeyCode::Right),
    ("up", "up", KeyCode::Up),
    ("down", "down", KeyCode::Down),
    ("pgup", "pgup", KeyCode::PageUp),
    ("pgdn", "pgdn", KeyCode::PageDown),
    ("home", "home", KeyCode::Home),
    ("end", "end", KeyCode::End),
];

/// Letters that most terminals report as another key when they are pressed together with ctrl.
const SENT_AS: [(char, &str); 4] = [('h', "backspace"), ('i', "tab"), ('j', "enter"), ('m', "enter")];

/// Error text that describes valid key names.
const REMEDY: &str = "a key: a character such as \"k\", a letter with ctrl such as \"ctrl+k\", f1 to f12, or one of \
                      space, tab, backtab, enter, backspace, esc, insert, delete, left, right, up, down, pgup, pgdn, \
                      home, end";

/// A key of the keyboard, pressed with or without ctrl.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct KeyChord {
    pub code: KeyCode,
    pub ctrl: bool,
}

impl KeyChord {
    /// Key chord of the space bar, without ctrl.
    pub const SPACE: KeyChord = KeyChord::plain(KeyCode::Char(' '));

    /// Key chord of this key without ctrl.
    pub const fn plain(code: KeyCode) -> KeyChord {
        KeyChord { code, ctrl: false }
    }

    /// The key that types this character, without ctrl.
    pub const fn char(key: char) -> KeyChord {
        KeyChord::plain(KeyCode::Char(key))
    }

    pub const fn ctrl(key: char) -> KeyChord {
        KeyChord { code: KeyCode::Char(key), ctrl: true }
    }

    /// The key chord of a terminal's key event. Capitals count as small letters, so that caps lock has no effect; the
    /// space bar counts as pressed without ctrl, so that it stops the robot in any case.
    pub fn from_event(key: &KeyEvent) -> KeyChord {
        let code = match key.code {
            KeyCode::Char(letter) => KeyCode::Char(small(letter)),
            other => other,
        };
        let ctrl = key.modifiers.contains(KeyModifiers::CONTROL) && code != KeyCode::Char(' ');
        KeyChord { code, ctrl }
    }

    /// The key chord for a letter that a kitchen's layout file assigns.
    pub fn of_letter(letter: char) -> KeyChord {
        KeyChord::char(small(letter))
    }

    /// Parses the name of a key in a key file.
    ///
    /// # Errors
    /// The text found, and a description of a valid one.
    pub fn parse(name: &str) -> Result<KeyChord, (String, String)> {
        let wrong = |found: String| Err((found, REMEDY.to_string()));
        if let Some(rest) = name.strip_prefix("ctrl+") {
            let letter = single(rest).map(small).filter(char::is_ascii_lowercase);
            let Some(letter) = letter else {
                return wrong(format!("\"{name}\": ctrl can be combined only with a letter from a to z"));
            };
            return match SENT_AS.iter().find(|(other, _)| *other == letter) {
                Some((_, other)) => wrong(format!("\"{name}\", a key that most terminals send as {other}")),
                None => Ok(KeyChord::ctrl(letter)),
            };
        }
        if let Some((_, _, code)) = NAMED.iter().find(|(known, _, _)| *known == name) {
            return Ok(KeyChord::plain(*code));
        }
        let function = name.strip_prefix('f').and_then(|number| number.parse::<u8>().ok());
        if let Some(number @ 1..=12) = function.filter(|number| name == format!("f{number}")) {
            return Ok(KeyChord::plain(KeyCode::F(number)));
        }
        match single(name) {
            Some(' ') => wrong("\" \"".to_string()),
            Some(letter) if small(letter) != letter => {
                wrong(format!("\"{name}\": because of caps lock, a capital letter counts as its small letter"))
            }
            Some(letter) if !letter.is_control() => Ok(KeyChord::char(letter)),
            _ => wrong(format!("\"{name}\", which is not the name of a key")),
        }
    }

    /// The chord's name in key files: "ctrl+r", "backspace".
    pub fn name(&self) -> String {
        let plain = match (self.code, self.named()) {
            (_, Some((name, _))) => name.to_string(),
            (KeyCode::Char(key), _) => key.to_string(),
            (other, _) => other.to_string().to_lowercase(),
        };
        if self.ctrl { format!("ctrl+{plain}") } else { plain }
    }

    fn named(&self) -> Option<(&'static str, &'static str)> {
        NAMED.iter().find(|(_, _, code)| *code == self.code).map(|(name, short, _)| (*name, *short))
    }
}

/// Writes the chord's name on the screen: "^r", "bksp".
impl fmt::Display for KeyChord {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if self.ctrl {
            f.write_str("^")?;
        }
        match (self.code, self.named()) {
            (_, Some((_, short))) => f.write_str(short),
            (KeyCode::Char(key), _) => write!(f, "{key}"),
            (other, _) => write!(f, "{other}"),
        }
    }
}

fn small(letter: char) -> char {
    letter.to_lowercase().next().unwrap_or(letter)
}

fn single(text: &str) -> Option<char> {
    let mut letters = text.chars();
    letters.next().filter(|_| letters.next().is_none())
}
