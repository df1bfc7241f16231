//! Key files: their format, how a key file changes the key table, and how the key table is written as a key file.

use std::collections::BTreeMap;
use std::fmt::{self, Write};
use std::ops::Range;

use serde::Deserialize;
use serde::de::{Deserializer, Error, SeqAccess, Visitor};
use toml::Spanned;

use super::chord::KeyChord;
use super::key_action::ManualAction;
use super::key_action::{KeyAction, KeyBinding, KeyError, KeyErrorSource, KeyFileTable};

/// A parsed key file: for each table, action names with their keys. Actions that are not in the file keep their keys.
#[derive(Clone, Debug, Default, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct KeyFileBindings {
    console: Table,
    replay: Table,
    signals: Table,
    buttons: Table,
}

type Table = BTreeMap<Spanned<String>, Spanned<Names>>;

/// The keys of one action in a key file: `"q"`, `["q", "ctrl+c"]`, or none: `[]`.
#[derive(Clone, Debug, Default)]
struct Names(Vec<String>);

impl<'de> Deserialize<'de> for Names {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Names, D::Error> {
        struct OneOrMore;
        impl<'de> Visitor<'de> for OneOrMore {
            type Value = Names;

            fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
                f.write_str("a key such as \"f5\", or a list of keys such as [\"f5\", \"ctrl+k\"]")
            }

            fn visit_str<E: Error>(self, name: &str) -> Result<Names, E> {
                Ok(Names(vec![name.to_string()]))
            }

            fn visit_seq<A: SeqAccess<'de>>(self, mut names: A) -> Result<Names, A::Error> {
                let mut keys = Vec::new();
                while let Some(name) = names.next_element()? {
                    keys.push(name);
                }
                Ok(Names(keys))
            }
        }
        deserializer.deserialize_any(OneOrMore)
    }
}

impl KeyFileBindings {
    fn table(&self, section: KeyFileTable) -> &Table {
        match section {
            KeyFileTable::Console => &self.console,
            KeyFileTable::Replay => &self.replay,
            KeyFileTable::Signals => &self.signals,
            KeyFileTable::Buttons => &self.buttons,
        }
    }

    fn entry(&self, line: &KeyBinding) -> Option<(&Spanned<String>, &Spanned<Names>)> {
        self.table(line.section).iter().find(|(name, _)| *name.get_ref() == line.name)
    }

    /// Byte range of a key binding's entry in the key file.
    pub(super) fn place(&self, line: &KeyBinding) -> Option<Range<usize>> {
        self.entry(line).map(|(name, keys)| name.span().start..keys.span().end)
    }

    /// Applies the key file to the key tables of the live console and of the replay.
    pub(super) fn apply(&self, live: &mut [KeyBinding], replay: &mut [KeyBinding]) -> Result<(), KeyError> {
        for section in [KeyFileTable::Console, KeyFileTable::Replay, KeyFileTable::Signals, KeyFileTable::Buttons] {
            let known = || live.iter().chain(replay.iter()).filter(move |line| line.section == section);
            for name in self.table(section).keys() {
                if !known().any(|line| line.name == *name.get_ref()) {
                    let names: Vec<&str> = known().map(|line| line.name.as_str()).collect();
                    return Err(KeyError {
                        place: KeyErrorSource::File(name.span()),
                        found: format!("\"{}\", which is no action with a key in [{section}]", name.get_ref()),
                        remedy: format!("one of {}", names.join(", ")),
                    });
                }
            }
        }
        for line in live.iter_mut().chain(replay.iter_mut()) {
            if let Some((_, names)) = self.entry(line) {
                line.chords = chords(line, names)?;
            }
        }
        for lines in [live, replay] {
            self.spare_keys(lines);
        }
        Ok(())
    }
}

impl KeyFileBindings {
    /// Removes from the palette and from the probe actions, unless the key file assigns them keys, every key that the
    /// file assigns to another action. Key files in old recordings may not know these newer actions.
    fn spare_keys(&self, lines: &mut [KeyBinding]) {
        let is_given = |line: &&KeyBinding| self.entry(line).is_some();
        let given: Vec<KeyChord> = lines.iter().filter(is_given).flat_map(|line| line.chords.clone()).collect();
        let is_young = |action: &KeyAction| {
            let probes = [ManualAction::AskProbe, ManualAction::SkipProbe].map(KeyAction::Hand);
            *action == KeyAction::Palette || probes.contains(action)
        };
        for line in lines.iter_mut().filter(|line| is_young(&line.action) && self.entry(line).is_none()) {
            line.chords.retain(|chord| !given.contains(chord));
        }
    }
}

/// The keys that the key file assigns to an action.
fn chords(line: &KeyBinding, names: &Spanned<Names>) -> Result<Vec<KeyChord>, KeyError> {
    let wrong = |found: String, remedy: &str| {
        let place = KeyErrorSource::File(names.span());
        Err(KeyError { place, found: format!("{} = {found}", line.name), remedy: remedy.to_string() })
    };
    let mut chords = Vec::new();
    for name in &names.get_ref().0 {
        match KeyChord::parse(name) {
            Ok(chord) if chord == KeyChord::SPACE && line.action != KeyAction::StopRobot => {
                return wrong(
                    "\"space\", the key that always stops the robot".to_string(),
                    "another key: the space bar always stops the robot",
                );
            }
            Ok(chord) if chords.contains(&chord) => {
                return wrong(format!("\"{name}\" twice"), "each key once");
            }
            Ok(chord) => chords.push(chord),
            Err((found, remedy)) => return wrong(found, &remedy),
        }
    }
    match line.action {
        KeyAction::StopRobot if !chords.contains(&KeyChord::SPACE) => wrong(
            format!("{:?}, keys for the robot stop without the space bar", names.get_ref().0),
            "\"space\", or a list with \"space\" and other keys: the space bar is the robot stop, always",
        ),
        KeyAction::Quit if chords.is_empty() => {
            wrong("[]".to_string(), "a key: without one the program cannot be quit")
        }
        _ => Ok(chords),
    }
}

/// Writes the whole key table as a key file with a comment for each action; reading it back gives the same table.
pub fn write(lines: &[KeyBinding]) -> String {
    let mut text = String::from(
        "# The keys of tomcom's console, ready to be changed. A session file names this file (relative to itself):\n\
         #\n#     [console]\n#     keys = \"keys.toml\"\n#\n\
         # A key is a character such as \"k\", a letter with ctrl such as \"ctrl+k\", f1 to f12, or one of space, \
         tab,\n\
         # backtab, enter, backspace, esc, insert, delete, left, right, up, down, pgup, pgdn, home, end.\n\
         # Several keys for one thing: [\"f1\", \"?\"]; none: []. What is left out stays as it is.\n",
    );
    let tables = [
        (KeyFileTable::Console, "the console of a live session; \"space\" belongs to stop_robot alone"),
        (KeyFileTable::Replay, "the console over a recording"),
        (KeyFileTable::Signals, "the wizard's signals, by location; what is left out is as the layout says"),
        (KeyFileTable::Buttons, "the participant's buttons, for a person at the keyboard; else as the layout says"),
    ];
    for (section, about) in tables {
        let own: Vec<&KeyBinding> = lines.iter().filter(|line| line.section == section).collect();
        let entries: Vec<String> = own.iter().map(|line| entry(line)).collect();
        let widest = entries.iter().map(|entry| entry.chars().count()).max().unwrap_or(0);
        // Writing to a string in memory cannot fail.
        let _ = writeln!(text, "\n[{section}]  # {about}");
        for (line, entry) in own.iter().zip(&entries) {
            let _ = writeln!(text, "{entry:widest$}  # {}", line.help);
        }
    }
    text
}

fn entry(line: &KeyBinding) -> String {
    let quoted = |text: &str| toml::Value::from(text).to_string();
    let is_bare = line.name.chars().all(|letter| letter.is_ascii_alphanumeric() || letter == '_' || letter == '-');
    let name = if is_bare { line.name.clone() } else { quoted(&line.name) };
    let keys: Vec<String> = line.chords.iter().map(|chord| quoted(&chord.name())).collect();
    match keys.as_slice() {
        [key] => format!("{name} = {key}"),
        keys => format!("{name} = [{}]", keys.join(", ")),
    }
}
