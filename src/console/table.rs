//! The default key table: all actions with their keys and texts, before a key file changes them.

use crossterm::event::KeyCode;
use crossterm::event::KeyCode::{
    BackTab, Backspace, Delete, Down, End, Enter, Esc, Home, Left, PageDown, PageUp, Right, Tab, Up,
};

use super::chord::KeyChord;
use super::console_model::{ComparisonAction, ReplayAction};
use super::key_action::{KeyAction, KeyBinding, KeyFileTable, KeyLayer, ManualAction, RaterAction, ViewAction};
use tomcom_core::communication::{self, HighlightSet};
use tomcom_core::kitchen::{Agent, ButtonId, Kitchen, LocationId};
use tomcom_core::measures::raters::ErrorCauseKind;
use tomcom_session::history::wording;
use tomcom_session::replay::ReplayLandmark;
use tomcom_session::settings::MAX_NOTES;

const SIGNALS: &str = "Signals to the participant";
const TRIAL: &str = "Trial";
const NOTES: &str = "Notes";
const REPLAY: &str = "Recording";
const ROBOT: &str = "Robot";
const BUTTONS: &str = "The participant's buttons";
const CONSOLE: &str = "Console";
const COMPARISON: &str = "Signals compared";
const CODING: &str = "Causes of errors";

/// Help text of the key that shows one state aspect of the belief over time.
const BELIEF: &str = "show one belief over time; again: the next belief";

/// Key binding of the palette, from which every other action can be found.
fn palette(help: &str) -> KeyBinding {
    line("palette", &[KeyChord::ctrl('k'), KeyChord::char(':')], KeyAction::Palette, CONSOLE, help, "find")
}

/// An entry of the key table: name in key files, keys, action, heading in the help, help text, label in the hint line
/// (empty if it has none).
fn line(
    name: &str,
    keys: &[KeyChord],
    action: KeyAction,
    group: &'static str,
    help: &str,
    footer: &'static str,
) -> KeyBinding {
    let (section, name, help) = (KeyFileTable::Console, name.to_string(), help.to_string());
    let footer = Some(footer).filter(|label| !label.is_empty());
    KeyBinding { section, name, chords: keys.to_vec(), action, group, help, footer, layer: None }
}

/// An entry of the key table for a manual intervention. The hint line shows such an entry only where it is the next
/// step.
fn manual(name: &str, key: char, action: ManualAction, group: &'static str, help: &str) -> KeyBinding {
    line(name, &ctrl(key), KeyAction::Manual(action), group, help, "")
}

fn plain(code: KeyCode) -> [KeyChord; 1] {
    [KeyChord::plain(code)]
}

fn sign(key: char) -> [KeyChord; 1] {
    [KeyChord::char(key)]
}

fn ctrl(key: char) -> [KeyChord; 1] {
    [KeyChord::ctrl(key)]
}

/// Default key table of a live session, in the order of help and hint line; the kitchen's layout file assigns the
/// letters.
pub fn live(kitchen: &Kitchen) -> Vec<KeyBinding> {
    let skip_probe = KeyAction::Manual(ManualAction::SkipProbe);
    let switch_keys = "switch between keys of wizard and participant";
    let mut lines = vec![
        line("stop_robot", &[KeyChord::SPACE], KeyAction::StopRobot, ROBOT, "stop the robot, at once", "STOP ROBOT"),
        line(
            "resume_robot",
            &ctrl('r'),
            KeyAction::ResumeRobot,
            ROBOT,
            "resume the robot after a stop",
            "resume robot",
        ),
        manual("hold_robot", 'p', ManualAction::HoldRobot, ROBOT, "hold the robot, or release it"),
        manual("skip_press", 's', ManualAction::SkipPress, ROBOT, "skip the robot's present press"),
        manual("drive_robot", 'd', ManualAction::DriveRobot, ROBOT, "choose the robot's next press"),
        manual("confirm_arm", 'y', ManualAction::ConfirmArm, ROBOT, "confirm the next step of the real arm's set-up"),
        line("start_pause", &sign('.'), KeyAction::Advance, TRIAL, "start, pause or resume the trial", "start/pause"),
        line("end_trial", &ctrl('e'), KeyAction::EndTrial, TRIAL, "end the trial (asks first)", "end"),
        manual("preflight", 'f', ManualAction::Preflight, TRIAL, "show the preflight checks"),
        manual("check_gaze", 'v', ManualAction::Calibrate, TRIAL, "check gaze accuracy with targets"),
        manual("correct", 'u', ManualAction::Correct, TRIAL, "correct what a place of the kitchen holds"),
        manual("abort_trial", 'x', ManualAction::Abort, TRIAL, "abort the trial (asks why)"),
        manual("ask_probe", 'a', ManualAction::AskProbe, TRIAL, "ask for a freeze probe"),
        line("skip_probe", &plain(Delete), skip_probe, TRIAL, "skip the rest of a freeze probe (asks why)", ""),
        manual("redo_trial", 'n', ManualAction::Redo, TRIAL, "repeat an aborted or excluded trial"),
        manual("exclude_trial", 'l', ManualAction::Exclude, TRIAL, "exclude the trial, or include it again"),
        line("switch_keys", &plain(Tab), KeyAction::SwitchLayer, CONSOLE, switch_keys, "switch"),
    ];
    lines.extend(signals(kitchen));
    lines.extend(wizards().into_iter().map(|line| KeyBinding { layer: Some(KeyLayer::Wizard), ..line }));
    lines.extend(buttons(kitchen));
    lines.extend(looks());
    lines.extend(times());
    lines.extend(differences());
    lines.extend([
        line("belief", &ctrl('b'), KeyAction::Belief, CONSOLE, BELIEF, ""),
        palette("list all actions, with search"),
        line("help", &sign('?'), KeyAction::Help, CONSOLE, "show this help", "help"),
        line("quit", &ctrl('c'), KeyAction::Quit, CONSOLE, "quit tomcom (asks first)", "quit"),
    ]);
    lines
}

/// Offers and notes, which only the wizard has.
fn wizards() -> Vec<KeyBinding> {
    let take_back = "take back the signal on the display";
    let mut lines = vec![
        line("accept", &plain(Enter), KeyAction::Accept, SIGNALS, "send the signal on offer", "send offer"),
        line("take_back", &plain(Backspace), KeyAction::TakeBack, SIGNALS, take_back, "take back"),
    ];
    for index in 0..MAX_NOTES {
        let digit = char::from(b'1' + index as u8);
        let footer = if index == 0 { "note" } else { "" };
        let help = format!("record note {digit} of the session file");
        lines.push(line(&format!("note_{digit}"), &sign(digit), KeyAction::Note(index), NOTES, &help, footer));
    }
    let in_words = KeyAction::Manual(ManualAction::NoteInWords);
    let help = "mark the time; while no trial runs: type a note";
    lines.push(line("note_in_words", &sign('0'), in_words, NOTES, help, "type note"));
    lines
}

pub fn replay() -> Vec<KeyBinding> {
    use ReplayAction::{BackTo, On};
    use ReplayLandmark::{Error, FalseBelief, Marker, Signal};
    let to = |name, keys: [KeyChord; 1], to, help, footer| line(name, &keys, KeyAction::Move(to), REPLAY, help, footer);
    let mut lines = vec![
        to("play_pause", sign('.'), ReplayAction::PlayPause, "play or pause the recording", "play/pause"),
        line("quit", &ctrl('c'), KeyAction::Quit, CONSOLE, "quit", "quit"),
        line("belief", &ctrl('b'), KeyAction::Belief, CONSOLE, BELIEF, ""),
        palette("list actions; go to 2:13, error 7 or typed words"),
        line("help", &sign('?'), KeyAction::Help, CONSOLE, "show this help", "help"),
    ];
    lines.extend(looks());
    lines.extend(differences());
    lines.extend(codes());
    lines.extend([
        to("step_forward", plain(Right), ReplayAction::StepForward, "go to the next event", "step"),
        to("step_back", plain(Left), ReplayAction::StepBack, "go to the previous event", ""),
        to("next_error", sign('e'), On(Error), "go to the next error", "error"),
        to("last_error", sign('w'), BackTo(Error), "go to the previous error", ""),
        to("next_signal", sign('s'), On(Signal), "go to the next signal", "signal"),
        to("last_signal", sign('a'), BackTo(Signal), "go to the previous signal", ""),
        to("next_marker", sign('m'), On(Marker), "go to the next note", "note"),
        to("last_marker", sign('n'), BackTo(Marker), "go to the previous note", ""),
        to("next_false_belief", sign('b'), On(FalseBelief), "go to the next estimated false belief", "false belief"),
        to("last_false_belief", sign('v'), BackTo(FalseBelief), "go to the previous estimated false belief", ""),
        to("seek_forward", plain(PageDown), ReplayAction::SeekForward, "go ten seconds forward", "10 s"),
        to("seek_back", plain(PageUp), ReplayAction::SeekBack, "go ten seconds back", ""),
        to("faster", sign('+'), ReplayAction::Faster, "play the recording faster", "speed"),
        to("slower", sign('-'), ReplayAction::Slower, "play the recording slower", ""),
        to("to_start", plain(Home), ReplayAction::ToStart, "go to the beginning, before the trial", ""),
        to("to_end", plain(End), ReplayAction::ToEnd, "go to the end; follow a growing recording", "start/end"),
    ]);
    lines.into_iter().map(|line| KeyBinding { section: KeyFileTable::Replay, ..line }).collect()
}

/// Key bindings of a rater's codes, active only while errors are coded.
fn codes() -> [KeyBinding; 9] {
    let code =
        |name, keys: &[KeyChord], rate, help, footer| line(name, keys, KeyAction::Rate(rate), CODING, help, footer);
    let cause = |name, key, kind: ErrorCauseKind| {
        let help = format!("{}: {}", kind.title(), kind.definition());
        line(name, &sign(key), KeyAction::Rate(RaterAction::Cause(kind)), CODING, &help, "")
    };
    let undo_keys = [KeyChord::char('u'), KeyChord::ctrl('z')];
    let next = "go to the next error, or to the selected error";
    [
        code("code_next", &plain(Enter), RaterAction::Next, next, "next"),
        code("code_last", &plain(Backspace), RaterAction::Last, "go to the previous error", ""),
        cause("slip", '1', ErrorCauseKind::Slip),
        cause("race", '2', ErrorCauseKind::Race),
        cause("other_cause", '3', ErrorCauseKind::Other),
        cause("mixed_up_buttons", '4', ErrorCauseKind::Buttons),
        code("clear_code", &plain(Delete), RaterAction::Clear, "remove the code of the present error", "remove code"),
        code("undo_code", &undo_keys, RaterAction::Undo, "undo the last change of a code", "undo"),
        code("redo_code", &ctrl('y'), RaterAction::Redo, "redo the undone change of a code", "redo"),
    ]
}

/// What an arrow key does while a rater codes: it selects an error of the list.
pub fn choosing(action: &KeyAction) -> Option<(RaterAction, &'static str)> {
    match action {
        KeyAction::Look(ViewAction::Back) => {
            Some((RaterAction::ChooseEarlier, "select the error above; enter goes to it"))
        }
        KeyAction::Look(ViewAction::Forward) => {
            Some((RaterAction::ChooseLater, "select the error below; enter goes to it"))
        }
        _ => None,
    }
}

/// Key bindings with which a rater codes false beliefs, one for each location, on the letters of the signals.
pub fn causes(kitchen: &Kitchen, marks: &[Option<KeyChord>]) -> Vec<KeyBinding> {
    let cause = |(index, mark): (usize, &Option<KeyChord>)| {
        let (id, chord) = (LocationId(index as u8), (*mark)?);
        let help = format!("{} {}", ErrorCauseKind::Belief.title(), kitchen.location(id).label());
        let footer = if marks[..index].iter().all(Option::is_none) { "belief" } else { "" };
        let rate = KeyAction::Rate(RaterAction::Belief(id));
        Some(line(&kitchen.location(id).name, &[chord], rate, CODING, &help, footer))
    };
    marks.iter().enumerate().filter_map(cause).collect()
}

/// Key bindings of the differences between wizard and assistant, active only in a comparison.
fn differences() -> [KeyBinding; 2] {
    let differ = |name, key, to, help, footer| line(name, &ctrl(key), KeyAction::Differ(to), COMPARISON, help, footer);
    let last = "select the previous difference of signals";
    [
        differ("next_difference", 'g', ComparisonAction::Next, "select the next difference of signals", "next"),
        differ("last_difference", 't', ComparisonAction::Last, last, "previous"),
    ]
}

/// An entry of the key table that changes which panels or which time the screen shows.
fn look(name: &str, keys: [KeyChord; 1], look: ViewAction, help: &str, footer: &'static str) -> KeyBinding {
    line(name, &keys, KeyAction::Look(look), CONSOLE, help, footer)
}

/// Key bindings that change which panels the screen shows.
fn looks() -> [KeyBinding; 6] {
    let open = "show the panel, or a difference, at full size";
    let all = "one step back; from the first view: quit";
    [
        look("next_panel", ctrl('w'), ViewAction::Next, "go to the next panel", "panels"),
        look("last_panel", plain(BackTab), ViewAction::Last, "go to the previous panel", ""),
        look("open_panel", ctrl('o'), ViewAction::Open, open, "full size"),
        look("all_panels", plain(Esc), ViewAction::All, all, "back"),
        look("back", plain(Up), ViewAction::Back, "scroll the panel back", ""),
        look("forward", plain(Down), ViewAction::Forward, "scroll the panel forward again", ""),
    ]
}

/// Left and right arrow keys in a live session: they scroll the timeline. In a replay, they go from event to event
/// instead.
fn times() -> [KeyBinding; 2] {
    [
        look("earlier", plain(Left), ViewAction::Earlier, "scroll the timeline 5 s back", ""),
        look("later", plain(Right), ViewAction::Later, "scroll the timeline 5 s forward", ""),
    ]
}

fn signals(kitchen: &Kitchen) -> impl Iterator<Item = KeyBinding> {
    communication::signals(kitchen, HighlightSet::ALL).into_iter().map(|(id, signal)| {
        let location = kitchen.location(id);
        let help = wording::command(&signal);
        let keys: Vec<KeyChord> = location.signal_key.map(KeyChord::of_letter).into_iter().collect();
        let bound = line(&location.name, &keys, KeyAction::Signal(id, signal), SIGNALS, &help, "");
        KeyBinding { section: KeyFileTable::Signals, layer: Some(KeyLayer::Wizard), ..bound }
    })
}

fn buttons(kitchen: &Kitchen) -> impl Iterator<Item = KeyBinding> {
    kitchen.buttons[Agent::Human.index()].iter().enumerate().map(|(index, button)| {
        let keys: Vec<KeyChord> = button.key.map(KeyChord::of_letter).into_iter().collect();
        let help = button.name.replace('_', " ");
        let bound = line(&button.name, &keys, KeyAction::Press(ButtonId(index as u8)), BUTTONS, &help, "");
        KeyBinding { section: KeyFileTable::Buttons, layer: Some(KeyLayer::Participant), ..bound }
    })
}
