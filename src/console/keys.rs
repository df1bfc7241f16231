//! The key table, from which key handling, hint line, help and the key labels on the screen follow; and key files, which
//! change it.
//!
//! Keys of signals and buttons come from the kitchen's layout file, all other keys from `super::table`; a key file can
//! change both. The space bar always stops the robot, in every view and layer.

use std::collections::BTreeMap;
use std::fmt::{self, Write};
use std::ops::Range;

use serde::Deserialize;
use serde::de::{Deserializer, Error, SeqAccess, Visitor};
use toml::Spanned;

use super::chord::KeyChord;
use super::console_model::ReplayAction;
use super::key_action::{
    KeyAction, KeyBinding, KeyError, KeyErrorSource, KeyFileTable, KeyLayer, ManualAction, RaterAction,
};
use super::table;
use tomcom_core::communication::Signal;
use tomcom_core::kitchen::{ButtonId, Kitchen, LocationId};
use tomcom_session::replay::ReplayLandmark;
use tomcom_session::settings::{ParticipantKind, SessionSpec};

/// Key bindings of a console: the key table.
#[derive(Clone, Debug, Default)]
pub struct KeyBindings {
    /// Key bindings in the order of the help.
    pub bindings: Vec<KeyBinding>,
    marks: Vec<Option<KeyChord>>,
    /// Key bindings that are active only in a comparison of wizard and assistant.
    comparing: Vec<KeyBinding>,
    /// Key bindings that are active only while a rater codes errors.
    coding: Vec<KeyBinding>,
}

impl KeyBindings {
    /// The key table of a live session.
    ///
    /// # Errors
    /// A key has two meanings, or an entry of the key file is invalid.
    pub fn live(kitchen: &Kitchen, spec: &SessionSpec, map: &KeyFileBindings) -> Result<KeyBindings, KeyError> {
        let mut bindings = lines(kitchen, map)?;
        let comparing = take(&mut bindings, KeyFileTable::Console, |action| matches!(action, KeyAction::Differ(_)));
        let marks = marks(kitchen, &bindings);
        let at_keyboard = spec.participant.kind == ParticipantKind::Keyboard;
        let highlights = spec.highlights(kitchen);
        bindings.retain(|line| match &line.action {
            KeyAction::Signal(id, Signal::Highlight(_)) => highlights.holds(*id),
            KeyAction::Press(_) | KeyAction::SwitchLayer => at_keyboard,
            KeyAction::Move(_) => false,
            KeyAction::Note(index) => *index < spec.console.notes.len(),
            KeyAction::Manual(ManualAction::AskProbe | ManualAction::SkipProbe) => spec.probes.is_some(),
            KeyAction::Manual(ManualAction::ConfirmArm) => spec.robot.arm.is_real(),
            _ => line.section != KeyFileTable::Replay,
        });
        bindings.retain(|line| !line.chords.is_empty());
        for line in &mut bindings {
            if let KeyAction::Note(index) = line.action {
                line.help.clone_from(&spec.console.notes[index]);
            }
        }
        Ok(KeyBindings { bindings, marks, comparing, coding: Vec::new() })
    }

    /// The key table of a wizard training: signals, and keys that affect only the screen.
    ///
    /// # Errors
    /// The errors of [`KeyBindings::live`]: a key with two meanings, or an invalid entry of the key file.
    pub fn training(kitchen: &Kitchen, spec: &SessionSpec, map: &KeyFileBindings) -> Result<KeyBindings, KeyError> {
        let mut keys = KeyBindings::live(kitchen, spec, map)?;
        keys.bindings.retain(|line| {
            matches!(
                line.action,
                KeyAction::Signal(..)
                    | KeyAction::Advance
                    | KeyAction::Look(_)
                    | KeyAction::Palette
                    | KeyAction::Help
                    | KeyAction::Quit
            )
        });
        Ok(keys)
    }

    /// The key table of a replay.
    ///
    /// # Errors
    /// The errors of [`KeyBindings::live`]: a key with two meanings, or an invalid entry of the key file.
    pub fn replay(kitchen: &Kitchen, map: &KeyFileBindings) -> Result<KeyBindings, KeyError> {
        let mut bindings = lines(kitchen, map)?;
        let comparing = take(&mut bindings, KeyFileTable::Replay, |action| matches!(action, KeyAction::Differ(_)));
        let coding = take(&mut bindings, KeyFileTable::Replay, |action| matches!(action, KeyAction::Rate(_)));
        let marks = marks(kitchen, &bindings);
        bindings.retain(|line| line.section == KeyFileTable::Replay && !line.chords.is_empty());
        Ok(KeyBindings { bindings, marks, comparing, coding })
    }

    pub fn with_comparison(mut self) -> KeyBindings {
        self.bindings.append(&mut self.comparing);
        self
    }

    /// Adds the keys of a rater: letters of signals then code false beliefs, and the arrow keys select an error. Removes
    /// keys that would reveal estimates or sent signals to the rater.
    pub fn with_coding(mut self, kitchen: &Kitchen) -> KeyBindings {
        use ReplayAction::{BackTo, On};
        use ReplayLandmark::{FalseBelief, Signal};
        self.bindings.retain(|line| {
            let tells = matches!(line.action, KeyAction::Move(On(FalseBelief | Signal) | BackTo(FalseBelief | Signal)));
            !tells && line.action != KeyAction::Belief
        });
        for line in &mut self.bindings {
            if let Some((rate, help)) = table::choosing(&line.action) {
                (line.action, line.help) = (KeyAction::Rate(rate), help.to_string());
            }
        }
        self.bindings.append(&mut self.coding);
        for line in &mut self.bindings {
            line.chords.retain(|chord| !self.marks.contains(&Some(*chord)));
        }
        self.bindings.extend(table::causes(kitchen, &self.marks));
        self.bindings.retain(|line| !line.chords.is_empty());
        self
    }

    /// The key binding of a key in a layer (wizard's or participant's keys).
    pub fn find(&self, layer: KeyLayer, chord: KeyChord) -> Option<&KeyBinding> {
        let acts = |line: &&KeyBinding| line.chords.contains(&chord) && line.layer.is_none_or(|only| only == layer);
        self.bindings.iter().find(acts)
    }

    pub fn of_signal(&self, location: LocationId) -> Option<KeyChord> {
        let is_it = |line: &&KeyBinding| matches!(line.action, KeyAction::Signal(about, _) if about == location);
        self.bindings.iter().find(is_it).and_then(|line| line.chords.first().copied())
    }

    /// The key with which a rater codes a false belief about a location.
    pub fn of_belief(&self, location: LocationId) -> Option<KeyChord> {
        self.chord_for(&KeyAction::Rate(RaterAction::Belief(location)))
    }

    /// Key of the signal about a location as the timeline shows it, also in a replay, where no signal can be sent.
    pub fn mark(&self, location: LocationId) -> Option<KeyChord> {
        self.marks.get(location.index()).copied().flatten()
    }

    /// The participant's key that presses a kitchen button.
    pub fn of_button(&self, button: ButtonId) -> Option<KeyChord> {
        self.chord_for(&KeyAction::Press(button))
    }

    /// The first key of an action at the console.
    pub fn chord_for(&self, action: &KeyAction) -> Option<KeyChord> {
        self.bindings.iter().find(|line| line.action == *action).and_then(|line| line.chords.first().copied())
    }
}

/// Takes the bindings of these actions out of a table; those in this section of a key file are active in some uses of the
/// console.
fn take(lines: &mut Vec<KeyBinding>, section: KeyFileTable, is_it: fn(&KeyAction) -> bool) -> Vec<KeyBinding> {
    let taken = lines.extract_if(.., |line| is_it(&line.action));
    taken.filter(|line| line.section == section && !line.chords.is_empty()).collect()
}

/// All key bindings of the live console and of the replay for a kitchen, after a key file is applied. No key has two
/// meanings under any settings.
///
/// # Errors
/// A key with two meanings, or an invalid entry of the key file.
pub fn lines(kitchen: &Kitchen, map: &KeyFileBindings) -> Result<Vec<KeyBinding>, KeyError> {
    let mut live = table::live(kitchen);
    let mut replay = table::replay();
    map.apply(&mut live, &mut replay)?;
    for lines in [&live, &replay] {
        // The keys of the layout file are checked last, so that an error message about a conflict names the layout.
        let (ours, letters): (Vec<&KeyBinding>, Vec<&KeyBinding>) =
            lines.iter().partition(|line| matches!(line.section, KeyFileTable::Console | KeyFileTable::Replay));
        let ordered: Vec<&KeyBinding> = ours.into_iter().chain(letters).collect();
        for (index, line) in ordered.iter().enumerate() {
            for earlier in ordered[..index].iter().filter(|earlier| earlier.meets(line)) {
                if let Some(chord) = line.chords.iter().find(|chord| earlier.chords.contains(chord)) {
                    return Err(clash(map, earlier, line, *chord));
                }
            }
        }
    }
    live.extend(replay);
    Ok(live)
}

/// The error about a key with two meanings, located in the key file or else in the layout file.
fn clash(map: &KeyFileBindings, earlier: &KeyBinding, line: &KeyBinding, chord: KeyChord) -> KeyError {
    let (name, layer) = (chord.name(), line.layer.unwrap_or(KeyLayer::Wizard));
    let in_file = map.place(line).map(|place| (place, line, earlier));
    let in_file = in_file.or_else(|| map.place(earlier).map(|place| (place, earlier, line)));
    match in_file {
        Some((span, line, other)) => KeyError {
            place: KeyErrorSource::File(span),
            found: format!("the key \"{name}\" for {}, which is taken by {} ({})", line.name, other.name, other.help),
            remedy: format!("another key for one of the two; the key of {} is set in [{}]", other.name, other.section),
        },
        None => KeyError {
            place: KeyErrorSource::Layout(layer, line.letter().unwrap_or(' ')),
            found: format!("the key \"{name}\" for \"{}\", which the console has for \"{}\"", line.name, earlier.help),
            remedy: "another key, a letter for instance".to_string(),
        },
    }
}

fn marks(kitchen: &Kitchen, lines: &[KeyBinding]) -> Vec<Option<KeyChord>> {
    let key = |index: usize| {
        let is_it = |line: &&KeyBinding| matches!(line.action, KeyAction::Signal(about, _) if about.index() == index);
        lines.iter().find(is_it).and_then(|line| line.chords.first().copied())
    };
    (0..kitchen.locations.len()).map(key).collect()
}

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

    pub(super) fn place(&self, line: &KeyBinding) -> Option<Range<usize>> {
        self.entry(line).map(|(name, keys)| name.span().start..keys.span().end)
    }

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

    /// Removes from the palette and from the probe actions, unless the key file assigns them keys, every key that the
    /// file assigns to another action. Key files in old recordings may not know these newer actions.
    fn spare_keys(&self, lines: &mut [KeyBinding]) {
        let is_given = |line: &&KeyBinding| self.entry(line).is_some();
        let given: Vec<KeyChord> = lines.iter().filter(is_given).flat_map(|line| line.chords.clone()).collect();
        let is_young = |action: &KeyAction| {
            let probes = [ManualAction::AskProbe, ManualAction::SkipProbe].map(KeyAction::Manual);
            *action == KeyAction::Palette || probes.contains(action)
        };
        for line in lines.iter_mut().filter(|line| is_young(&line.action) && self.entry(line).is_none()) {
            line.chords.retain(|chord| !given.contains(chord));
        }
    }
}

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
