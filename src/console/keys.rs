//! The key table, from which key handling, hint line, help and the key labels on the screen follow.
//!
//! Keys of signals and buttons come from the kitchen's layout file, all other keys from `super::table`; a key file
//! ([`super::keymap`]) can change both. The space bar always stops the robot, in every view and layer.

use super::chord::KeyChord;
use super::key_action::{
    KeyAction, KeyBinding, KeyError, KeyErrorSource, KeyFileTable, KeyLayer, ManualAction, RaterAction,
};
use super::keymap::KeyFileBindings;
use super::playback::ReplayAction;
use super::table;
use tomcom_core::communication::Signal;
use tomcom_core::kitchen::{ButtonId, Kitchen, LocationId};
use tomcom_session::replay::ReplayLandmark;
use tomcom_session::settings::{ParticipantKind, SessionSpec};

/// Key bindings of a console: the key table.
#[derive(Clone, Debug)]
pub struct KeyBindings {
    /// Key bindings in the order of the help.
    pub bindings: Vec<KeyBinding>,
    /// Key of the signal about each location, by which the timeline marks signals.
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
        let Consoles { comparing, mut bindings, .. } =
            Consoles::from_bindings(lines(kitchen, map)?, KeyFileTable::Console);
        let marks = marks(kitchen, &bindings);
        let at_keyboard = spec.participant.kind == ParticipantKind::Keyboard;
        let highlights = spec.highlights(kitchen);
        bindings.retain(|line| match &line.action {
            KeyAction::Signal(id, Signal::Highlight(_)) => highlights.holds(*id),
            KeyAction::Press(_) | KeyAction::SwitchLayer => at_keyboard,
            KeyAction::Move(_) => false,
            KeyAction::Note(index) => *index < spec.console.notes.len(),
            KeyAction::Hand(ManualAction::AskProbe | ManualAction::SkipProbe) => spec.probes.is_some(),
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
        let Consoles { comparing, coding, mut bindings } =
            Consoles::from_bindings(lines(kitchen, map)?, KeyFileTable::Replay);
        let marks = marks(kitchen, &bindings);
        bindings.retain(|line| line.section == KeyFileTable::Replay && !line.chords.is_empty());
        Ok(KeyBindings { bindings, marks, comparing, coding })
    }

    /// Adds the keys of the comparison of wizard and assistant.
    pub fn with_comparison(mut self) -> KeyBindings {
        self.bindings.append(&mut self.comparing);
        self
    }

    /// Adds the keys of a rater: letters of signals then code false beliefs, so no letter quits the program, and the
    /// arrow keys select an error. Removes keys that would reveal estimates or sent signals to the rater.
    pub fn with_coding(mut self, kitchen: &Kitchen) -> KeyBindings {
        use ReplayAction::{BackTo, On};
        use ReplayLandmark::{FalseBelief, Signal};
        self.bindings.retain(|line| {
            let tells = matches!(line.action, KeyAction::Move(On(FalseBelief | Signal) | BackTo(FalseBelief | Signal)));
            !tells && line.action != KeyAction::Belief
        });
        for line in &mut self.bindings {
            let marks = &self.marks;
            line.chords.retain(|chord| !marks.contains(&Some(*chord)));
            if let Some((rate, help)) = table::choosing(&line.action) {
                (line.action, line.help) = (KeyAction::Rate(rate), help.to_string());
            }
        }
        for line in &mut self.coding {
            let marks = &self.marks;
            line.chords.retain(|chord| !marks.contains(&Some(*chord)));
        }
        self.bindings.append(&mut self.coding);
        self.bindings.extend(table::causes(kitchen, &self.marks));
        self.bindings.retain(|line| !line.chords.is_empty());
        self
    }

    /// The key binding of a key in a layer (wizard's or participant's keys).
    pub fn find(&self, layer: KeyLayer, chord: KeyChord) -> Option<&KeyBinding> {
        let acts = |line: &&KeyBinding| line.chords.contains(&chord) && line.layer.is_none_or(|only| only == layer);
        self.bindings.iter().find(acts)
    }

    /// The key that sends the signal about a kitchen location.
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

/// Key bindings of a console: those of the comparison, those of a rater, and all others.
struct Consoles {
    comparing: Vec<KeyBinding>,
    coding: Vec<KeyBinding>,
    bindings: Vec<KeyBinding>,
}

impl Consoles {
    fn from_bindings(lines: Vec<KeyBinding>, section: KeyFileTable) -> Consoles {
        let (mut comparing, others): (Vec<KeyBinding>, Vec<KeyBinding>) =
            lines.into_iter().partition(|line| matches!(line.action, KeyAction::Differ(_)));
        let (mut coding, bindings): (Vec<KeyBinding>, Vec<KeyBinding>) =
            others.into_iter().partition(|line| matches!(line.action, KeyAction::Rate(_)));
        for some in [&mut comparing, &mut coding] {
            some.retain(|line| line.section == section && !line.chords.is_empty());
        }
        Consoles { comparing, coding, bindings }
    }
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
