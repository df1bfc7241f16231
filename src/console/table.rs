//! The lines of the table of keys, as they are before a key file changes them.

use crossterm::event::KeyCode::{
    self, BackTab, Backspace, Delete, Down, End, Enter, Esc, Home, Left, PageDown, PageUp, Right, Tab, Up,
};

use super::chord::Chord;
use super::coding::Rate;
use super::comparison::Step;
use super::hands::Hand;
use super::keys::{Action, Binding, Layer, Section};
use super::panels::Look;
use super::playback::{Landmark, Move};
use crate::communication::{self, Signal};
use crate::kitchen::{Agent, ButtonId, Kitchen, LocationId};
use crate::measures::coding::Kind;
use crate::session::settings::MAX_NOTES;

const SIGNALS: &str = "Signals to the participant";
const TRIAL: &str = "Trial";
const MARKERS: &str = "Markers";
const REPLAY: &str = "Recording";
const ROBOT: &str = "Robot";
const BUTTONS: &str = "The participant's buttons";
const CONSOLE: &str = "Console";
const COMPARISON: &str = "Wizard and assistant";
const CODING: &str = "Why it was an error";

/// What the key does that looks at one aspect of the belief.
const BELIEF: &str = "one belief over time; again: the next";

/// A line of the console: name in key files, keys, what it does, heading, help, and what the footer says.
fn line(
    name: &str,
    keys: &[Chord],
    action: Action,
    group: &'static str,
    help: &str,
    footer: Option<&'static str>,
) -> Binding {
    let (name, help) = (name.to_string(), help.to_string());
    Binding { section: Section::Console, name, chords: keys.to_vec(), action, group, help, footer, layer: None }
}

/// A line of the experimenter's hands; the footer shows it when it matters.
fn hand(name: &str, key: char, hand: Hand, group: &'static str, help: &str) -> Binding {
    line(name, &[Chord::ctrl(key)], Action::Hand(hand), group, help, None)
}

fn plain(code: KeyCode) -> [Chord; 1] {
    [Chord::plain(code)]
}

/// Everything that a live session can bind, in the order of help and footer; the letters are the layout's.
pub fn live(kitchen: &Kitchen) -> Vec<Binding> {
    let wizards = |line: Binding| Binding { layer: Some(Layer::Wizard), ..line };
    let mut lines = vec![
        line("stop_robot", &[Chord::SPACE], Action::StopRobot, ROBOT, "stop the robot, at once", Some("STOP ROBOT")),
        line(
            "resume_robot",
            &[Chord::ctrl('r')],
            Action::ResumeRobot,
            ROBOT,
            "resume it after a stop",
            Some("resume robot"),
        ),
        hand("hold_robot", 'p', Hand::HoldRobot, ROBOT, "hold it, release it"),
        hand("skip_press", 's', Hand::SkipPress, ROBOT, "skip its press"),
        hand("drive_robot", 'd', Hand::DriveRobot, ROBOT, "choose its next press"),
        line("start_pause", &[Chord::char('.')], Action::Advance, TRIAL, "start, pause, resume", Some("start/pause")),
        line("end_trial", &[Chord::ctrl('e')], Action::EndTrial, TRIAL, "end the trial (asks first)", Some("end")),
        hand("preflight", 'f', Hand::Preflight, TRIAL, "what is ready for it"),
        hand("check_gaze", 'v', Hand::Calibrate, TRIAL, "check the gaze by targets"),
        hand("correct", 'k', Hand::Correct, TRIAL, "correct what lies where"),
        hand("abort_trial", 'x', Hand::Abort, TRIAL, "abort it (asks why)"),
        hand("redo_trial", 'n', Hand::Redo, TRIAL, "do an aborted one again"),
        hand("exclude_trial", 'l', Hand::Exclude, TRIAL, "exclude it, include it"),
        line(
            "switch_keys",
            &plain(Tab),
            Action::SwitchLayer,
            CONSOLE,
            "switch between wizard and participant",
            Some("switch"),
        ),
    ];
    lines.extend(signals(kitchen));
    let accept = "accept the top recommendation";
    lines.push(wizards(line("accept", &plain(Enter), Action::Accept, SIGNALS, accept, Some("accept"))));
    let take_back = "take the shown signal back";
    lines.push(wizards(line("take_back", &plain(Backspace), Action::TakeBack, SIGNALS, take_back, Some("take back"))));
    for index in 0..MAX_NOTES {
        let digit = char::from(b'1' + index as u8);
        let footer = (index == 0).then_some("note");
        let name = format!("note_{digit}");
        let help = format!("note {digit} of the session");
        lines.push(wizards(line(&name, &[Chord::char(digit)], Action::Note(index), MARKERS, &help, footer)));
    }
    let help = "a note in words, when paused";
    lines.push(wizards(line(
        "note_in_words",
        &[Chord::char('0')],
        Action::Hand(Hand::NoteInWords),
        MARKERS,
        help,
        None,
    )));
    lines.extend(buttons(kitchen));
    lines.extend(looks(Right, Left));
    lines.extend(differences());
    lines.extend([
        line("belief", &[Chord::ctrl('b')], Action::Belief, CONSOLE, BELIEF, None),
        line("help", &[Chord::char('?')], Action::Help, CONSOLE, "this help", Some("help")),
        line("quit", &[Chord::ctrl('c')], Action::Quit, CONSOLE, "quit (asks first)", Some("quit")),
    ]);
    lines
}

/// Everything that the console over a recording can bind.
pub fn replay() -> Vec<Binding> {
    let moves = [
        ("step_forward", plain(Right), Move::StepForward, "to the next event", Some("step")),
        ("step_back", plain(Left), Move::StepBack, "to the last event", None),
        ("next_error", [Chord::char('e')], Move::On(Landmark::Error), "to the next error", Some("error")),
        ("last_error", [Chord::char('w')], Move::BackTo(Landmark::Error), "to the error before", None),
        ("next_signal", [Chord::char('s')], Move::On(Landmark::Signal), "to the next signal", None),
        ("last_signal", [Chord::char('a')], Move::BackTo(Landmark::Signal), "to the signal before", None),
        ("next_marker", [Chord::char('m')], Move::On(Landmark::Marker), "to the next marker", None),
        ("last_marker", [Chord::char('n')], Move::BackTo(Landmark::Marker), "to the marker before", None),
        ("next_false_belief", [Chord::char('b')], Move::On(Landmark::FalseBelief), "to the next false belief", None),
        (
            "last_false_belief",
            [Chord::char('v')],
            Move::BackTo(Landmark::FalseBelief),
            "to the false belief before",
            None,
        ),
        ("seek_forward", plain(PageDown), Move::SeekForward, "ten seconds on", Some("10 s")),
        ("seek_back", plain(PageUp), Move::SeekBack, "ten seconds back", None),
        ("faster", [Chord::char('+')], Move::Faster, "faster", Some("speed")),
        ("slower", [Chord::char('-')], Move::Slower, "slower", None),
        ("to_start", plain(Home), Move::ToStart, "to the beginning", None),
        ("to_end", plain(End), Move::ToEnd, "to the end; stays there if the recording grows", Some("ends")),
    ];
    let of_move = |name, keys: &[Chord], to, help, footer| line(name, keys, Action::Move(to), REPLAY, help, footer);
    let quit = [Chord::char('q'), Chord::ctrl('c')];
    let mut lines = vec![
        of_move("play_pause", &[Chord::char('.')], Move::PlayPause, "play, pause", Some("play/pause")),
        line("quit", &quit, Action::Quit, CONSOLE, "quit", Some("quit")),
        line("belief", &[Chord::ctrl('b')], Action::Belief, CONSOLE, BELIEF, None),
        line("help", &[Chord::char('?')], Action::Help, CONSOLE, "this help", Some("help")),
    ];
    lines.extend(looks(Tab, BackTab));
    lines.extend(differences());
    lines.extend(codes());
    lines.extend(moves.map(|(name, keys, to, help, footer)| of_move(name, &keys, to, help, footer)));
    lines.into_iter().map(|line| Binding { section: Section::Replay, ..line }).collect()
}

/// What a rater says about errors; only where they are coded.
fn codes() -> [Binding; 6] {
    let code = |name, key: Chord, rate, help, footer| line(name, &[key], Action::Rate(rate), CODING, help, footer);
    let cause = |name, key, kind, help| code(name, Chord::char(key), Rate::Cause(kind), help, None);
    [
        code("code_next", Chord::plain(Enter), Rate::Next, "to the next error", Some("next error")),
        code("code_last", Chord::plain(Backspace), Rate::Last, "to the error before", None),
        Binding { footer: Some("slip"), ..cause("slip", '1', Kind::Slip, "a slip: nothing was believed wrong") },
        Binding { footer: Some("race"), ..cause("race", '2', Kind::Race, "a race: the robot was quicker") },
        Binding { footer: Some("other"), ..cause("other_cause", '3', Kind::Other, "another cause") },
        code("clear_code", Chord::plain(Delete), Rate::Clear, "not coded after all", None),
    ]
}

/// What was believed wrong, by the letters of the signals.
pub fn causes(kitchen: &Kitchen, marks: &[Option<Chord>]) -> Vec<Binding> {
    let cause = |(index, mark): (usize, &Option<Chord>)| {
        let (id, chord) = (LocationId(index as u8), (*mark)?);
        let help = format!("wrong about {}", kitchen.location(id).label());
        let footer = (index == 0).then_some("wrong about ...");
        Some(line(&kitchen.location(id).name, &[chord], Action::Rate(Rate::Belief(id)), CODING, &help, footer))
    };
    marks.iter().enumerate().filter_map(cause).collect()
}

/// Where wizard and assistant differ; only where they are compared.
fn differences() -> [Binding; 3] {
    let differ =
        |name, key, step, help, footer| line(name, &[Chord::ctrl(key)], Action::Differ(step), COMPARISON, help, footer);
    [
        differ("open_difference", 'o', Step::Open, "what each knew where they differ", Some("difference")),
        differ("next_difference", 'g', Step::Next, "the next difference", Some("next")),
        differ("last_difference", 't', Step::Last, "the difference before", Some("before")),
    ]
}

/// What is on the screen.
fn looks(next: KeyCode, last: KeyCode) -> [Binding; 5] {
    let look = |name, code, look, help, footer| line(name, &plain(code), Action::Look(look), CONSOLE, help, footer);
    [
        look("next_panel", next, Look::Next, "the next panel alone", Some("panels")),
        look("last_panel", last, Look::Last, "the panel before, alone", None),
        look("all_panels", Esc, Look::All, "all panels, and now again", Some("all panels")),
        look("back", Up, Look::Back, "further back in events or timeline", None),
        look("forward", Down, Look::Forward, "forward again", None),
    ]
}

fn signals(kitchen: &Kitchen) -> impl Iterator<Item = Binding> {
    communication::signals(kitchen, true).into_iter().map(|(id, signal)| {
        let location = kitchen.location(id);
        let help = match signal {
            Signal::ShowRecipe(_) => format!("show the recipe of {}", location.label()),
            Signal::Highlight(_) => format!("highlight {}", location.label()),
        };
        let keys: Vec<Chord> = location.signal_key.map(Chord::of_letter).into_iter().collect();
        let bound = line(&location.name, &keys, Action::Signal(id, signal), SIGNALS, &help, None);
        Binding { section: Section::Signals, layer: Some(Layer::Wizard), ..bound }
    })
}

fn buttons(kitchen: &Kitchen) -> impl Iterator<Item = Binding> {
    kitchen.buttons[Agent::Human.index()].iter().enumerate().map(|(index, button)| {
        let keys: Vec<Chord> = button.key.map(Chord::of_letter).into_iter().collect();
        let help = button.name.replace('_', " ");
        let bound = line(&button.name, &keys, Action::Press(ButtonId(index as u8)), BUTTONS, &help, None);
        Binding { section: Section::Buttons, layer: Some(Layer::Participant), ..bound }
    })
}
