//! The one table of keys: it makes the bindings, the footer, the help and the badges at the things in the kitchen.
//!
//! Letters of signals and buttons stand in the layout, all other keys in [`super::table`]; a key file
//! ([`super::keymap`]) may change both. The space bar is the robot stop in every view and layer, whatever a file says.

use std::fmt;
use std::ops::Range;

use super::chord::Chord;
use super::coding::Rate;
use super::comparison::Step;
use super::hands::Hand;
use super::keymap::KeyMap;
use super::panels::Look;
use super::playback::Move;
use super::table;
use crate::communication::Signal;
use crate::kitchen::{Agent, ButtonId, Kitchen, LocationId, LocationKind};
use crate::session::settings::{ParticipantKind, SessionSpec};

/// Which hand plays: the wizard's keys, or the buttons of a person who plays the participant.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Layer {
    Wizard,
    Participant,
}

/// What a key does.
#[derive(Clone, Debug, PartialEq)]
pub enum Action {
    Signal(LocationId, Signal),
    Press(ButtonId),
    /// Send the signal that is recommended most.
    Accept,
    TakeBack,
    /// A marker with this note of the session's.
    Note(usize),
    /// Start, pause or resume the trial.
    Advance,
    EndTrial,
    StopRobot,
    ResumeRobot,
    SwitchLayer,
    Hand(Hand),
    Move(Move),
    Look(Look),
    /// One aspect of the belief over time, then the next one.
    Belief,
    /// Where wizard and assistant differ.
    Differ(Step),
    /// Code an error.
    Rate(Rate),
    Help,
    Quit,
}

/// The tables of a key file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Section {
    /// What the console of a live session does.
    Console,
    /// What the console over a recording does.
    Replay,
    /// The signals, by location.
    Signals,
    /// The participant's buttons, by name.
    Buttons,
}

/// The name of the table.
impl fmt::Display for Section {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Section::Console => "console",
            Section::Replay => "replay",
            Section::Signals => "signals",
            Section::Buttons => "buttons",
        })
    }
}

/// One line of the table.
#[derive(Clone, Debug)]
pub struct Binding {
    /// Where it stands in a key file, and its name there.
    pub section: Section,
    pub name: String,
    /// Its keys; the first is the one that is shown.
    pub chords: Vec<Chord>,
    pub action: Action,
    /// The heading that it stands under in the help.
    pub group: &'static str,
    pub help: String,
    /// What the footer says, if it is in the footer.
    pub footer: Option<&'static str>,
    /// The layer that it works in; `None`: in every layer.
    pub layer: Option<Layer>,
}

impl Binding {
    /// Whether two lines can act at the same time, so that they need different keys.
    fn meets(&self, other: &Binding) -> bool {
        self.layer.is_none() || other.layer.is_none() || self.layer == other.layer
    }

    fn letter(&self) -> Option<char> {
        match self.chords.first()?.code {
            crossterm::event::KeyCode::Char(letter) => Some(letter),
            _ => None,
        }
    }
}

/// Where a wrong key stands.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum KeyPlace {
    /// In the key file, at these bytes.
    File(Range<usize>),
    /// In the layout, as the key of a signal (the wizard's) or of a button (the participant's).
    Layout(Layer, char),
}

/// A key that cannot be.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{found}")]
pub struct KeyError {
    pub place: KeyPlace,
    pub found: String,
    pub remedy: String,
}

/// The table.
#[derive(Clone, Debug)]
pub struct Keys {
    pub bindings: Vec<Binding>,
    /// How the signal about each location is written in the timeline: its key.
    marks: Vec<Option<Chord>>,
    /// The lines that act only where wizard and assistant are compared.
    comparing: Vec<Binding>,
    /// The lines that act only where errors are coded.
    coding: Vec<Binding>,
}

impl Keys {
    /// The table of a live session.
    ///
    /// # Errors
    /// A key with two meanings, or a line of the key file that cannot be.
    pub fn live(kitchen: &Kitchen, spec: &SessionSpec, map: &KeyMap) -> Result<Keys, KeyError> {
        let Consoles { comparing, mut bindings, .. } = Consoles::of(lines(kitchen, map)?, Section::Console);
        let marks = marks(kitchen, &bindings);
        let at_keyboard = spec.participant.kind == ParticipantKind::Keyboard;
        bindings.retain(|line| match &line.action {
            Action::Signal(id, _) => {
                spec.signals.own_hand || kitchen.location(*id).kind != LocationKind::Hand(Agent::Human)
            }
            Action::Press(_) | Action::SwitchLayer => at_keyboard,
            Action::Move(_) => false,
            Action::Note(index) => *index < spec.console.notes.len(),
            _ => line.section != Section::Replay,
        });
        bindings.retain(|line| !line.chords.is_empty());
        for line in &mut bindings {
            if let Action::Note(index) = line.action {
                line.help.clone_from(&spec.console.notes[index]);
            }
        }
        Ok(Keys { bindings, marks, comparing, coding: Vec::new() })
    }

    /// The table of a training: the signals, and what the console itself needs.
    ///
    /// # Errors
    /// As of [`Keys::live`].
    pub fn training(kitchen: &Kitchen, spec: &SessionSpec, map: &KeyMap) -> Result<Keys, KeyError> {
        let mut keys = Keys::live(kitchen, spec, map)?;
        keys.bindings.retain(|line| {
            matches!(line.action, Action::Signal(..) | Action::Advance | Action::Look(_) | Action::Help | Action::Quit)
        });
        Ok(keys)
    }

    /// The table of a replay.
    ///
    /// # Errors
    /// As of [`Keys::live`].
    pub fn replay(kitchen: &Kitchen, map: &KeyMap) -> Result<Keys, KeyError> {
        let Consoles { comparing, coding, mut bindings } = Consoles::of(lines(kitchen, map)?, Section::Replay);
        let marks = marks(kitchen, &bindings);
        bindings.retain(|line| line.section == Section::Replay && !line.chords.is_empty());
        Ok(Keys { bindings, marks, comparing, coding })
    }

    /// The same with the keys of the comparison.
    pub fn with_comparison(mut self) -> Keys {
        self.bindings.append(&mut self.comparing);
        self
    }

    /// The same with the keys of a rater: the letters of the signals say what was believed wrong, and so no letter quits.
    pub fn with_coding(mut self, kitchen: &Kitchen) -> Keys {
        for line in &mut self.bindings {
            let marks = &self.marks;
            line.chords.retain(|chord| !marks.contains(&Some(*chord)));
        }
        self.bindings.append(&mut self.coding);
        self.bindings.extend(table::causes(kitchen, &self.marks));
        self.bindings.retain(|line| !line.chords.is_empty());
        self
    }

    /// What a key means in a layer.
    pub fn find(&self, layer: Layer, chord: Chord) -> Option<&Binding> {
        let acts = |line: &&Binding| line.chords.contains(&chord) && line.layer.is_none_or(|only| only == layer);
        self.bindings.iter().find(acts)
    }

    /// The key of the signal about a location.
    pub fn of_signal(&self, location: LocationId) -> Option<Chord> {
        let is_it = |line: &&Binding| matches!(line.action, Action::Signal(about, _) if about == location);
        self.bindings.iter().find(is_it).and_then(|line| line.chords.first().copied())
    }

    /// The key with which a rater says that something was believed wrong about a location.
    pub fn of_belief(&self, location: LocationId) -> Option<Chord> {
        self.of(&Action::Rate(Rate::Belief(location)))
    }

    /// How the signal about a location is written in the timeline, also in a replay, where no key sends it.
    pub fn mark(&self, location: LocationId) -> Option<Chord> {
        self.marks.get(location.index()).copied().flatten()
    }

    /// The participant's key of a button.
    pub fn of_button(&self, button: ButtonId) -> Option<Chord> {
        self.of(&Action::Press(button))
    }

    /// The key of an action of the console.
    pub fn of(&self, action: &Action) -> Option<Chord> {
        self.bindings.iter().find(|line| line.action == *action).and_then(|line| line.chords.first().copied())
    }
}

/// The lines of a console: those that compare, those that code errors, and all the others.
struct Consoles {
    comparing: Vec<Binding>,
    coding: Vec<Binding>,
    bindings: Vec<Binding>,
}

impl Consoles {
    fn of(lines: Vec<Binding>, section: Section) -> Consoles {
        let (mut comparing, others): (Vec<Binding>, Vec<Binding>) =
            lines.into_iter().partition(|line| matches!(line.action, Action::Differ(_)));
        let (mut coding, bindings): (Vec<Binding>, Vec<Binding>) =
            others.into_iter().partition(|line| matches!(line.action, Action::Rate(_)));
        for some in [&mut comparing, &mut coding] {
            some.retain(|line| line.section == section && !line.chords.is_empty());
        }
        Consoles { comparing, coding, bindings }
    }
}

/// Every line of both consoles for a kitchen, with the keys of a key file; no key has two meanings, whatever the
/// session's settings are.
///
/// # Errors
/// A key with two meanings, or a line of the key file that cannot be.
pub fn lines(kitchen: &Kitchen, map: &KeyMap) -> Result<Vec<Binding>, KeyError> {
    let mut live = table::live(kitchen);
    let mut replay = table::replay();
    map.apply(&mut live, &mut replay)?;
    for lines in [&live, &replay] {
        // The keys of the layout are checked last, so that they are what a message is about.
        let (ours, letters): (Vec<&Binding>, Vec<&Binding>) =
            lines.iter().partition(|line| matches!(line.section, Section::Console | Section::Replay));
        let ordered: Vec<&Binding> = ours.into_iter().chain(letters).collect();
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

/// The message about a key with two meanings, at the line of the key file that is to blame, or else of the layout.
fn clash(map: &KeyMap, earlier: &Binding, line: &Binding, chord: Chord) -> KeyError {
    let (name, layer) = (chord.name(), line.layer.unwrap_or(Layer::Wizard));
    let in_file = map.place(line).map(|place| (place, line, earlier));
    let in_file = in_file.or_else(|| map.place(earlier).map(|place| (place, earlier, line)));
    match in_file {
        Some((span, line, other)) => KeyError {
            place: KeyPlace::File(span),
            found: format!("the key \"{name}\" for {}, which is taken by {} ({})", line.name, other.name, other.help),
            remedy: format!("another key for one of them; {} has its own in [{}]", other.name, other.section),
        },
        None => KeyError {
            place: KeyPlace::Layout(layer, line.letter().unwrap_or(' ')),
            found: format!("the key \"{name}\" for \"{}\", which the console has for \"{}\"", line.name, earlier.help),
            remedy: "another key, a letter for instance".to_string(),
        },
    }
}

fn marks(kitchen: &Kitchen, lines: &[Binding]) -> Vec<Option<Chord>> {
    let key = |index: usize| {
        let is_it = |line: &&Binding| matches!(line.action, Action::Signal(about, _) if about.index() == index);
        lines.iter().find(is_it).and_then(|line| line.chords.first().copied())
    };
    (0..kitchen.locations.len()).map(key).collect()
}
