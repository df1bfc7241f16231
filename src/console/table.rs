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
    let keys = [KeyChord::ctrl('k'), KeyChord::char(':')];
    line("palette", &keys, KeyAction::Palette, CONSOLE, help, Some("find"))
}

/// An entry of the key table: name in key files, keys, action, heading in the help, help text, label in the hint line.
fn line(
    name: &str,
    keys: &[KeyChord],
    action: KeyAction,
    group: &'static str,
    help: &str,
    footer: Option<&'static str>,
) -> KeyBinding {
    let (name, help) = (name.to_string(), help.to_string());
    KeyBinding { section: KeyFileTable::Console, name, chords: keys.to_vec(), action, group, help, footer, layer: None }
}

/// An entry of the key table for a manual intervention. The hint line shows such an entry only where it is the next
/// step.
fn manual(name: &str, key: char, action: ManualAction, group: &'static str, help: &str) -> KeyBinding {
    line(name, &[KeyChord::ctrl(key)], KeyAction::Manual(action), group, help, None)
}

fn plain(code: KeyCode) -> [KeyChord; 1] {
    [KeyChord::plain(code)]
}

/// Default key table of a live session, in the order of help and hint line; the kitchen's layout file assigns the
/// letters.
pub fn live(kitchen: &Kitchen) -> Vec<KeyBinding> {
    let wizards = |line: KeyBinding| KeyBinding { layer: Some(KeyLayer::Wizard), ..line };
    let mut lines = vec![
        line(
            "stop_robot",
            &[KeyChord::SPACE],
            KeyAction::StopRobot,
            ROBOT,
            "stop the robot, at once",
            Some("STOP ROBOT"),
        ),
        line(
            "resume_robot",
            &[KeyChord::ctrl('r')],
            KeyAction::ResumeRobot,
            ROBOT,
            "resume the robot after a stop",
            Some("resume robot"),
        ),
        manual("hold_robot", 'p', ManualAction::HoldRobot, ROBOT, "hold the robot, or release it"),
        manual("skip_press", 's', ManualAction::SkipPress, ROBOT, "skip the robot's present press"),
        manual("drive_robot", 'd', ManualAction::DriveRobot, ROBOT, "choose the robot's next press"),
        manual("confirm_arm", 'y', ManualAction::ConfirmArm, ROBOT, "confirm the next step of the real arm's set-up"),
        line(
            "start_pause",
            &[KeyChord::char('.')],
            KeyAction::Advance,
            TRIAL,
            "start, pause or resume the trial",
            Some("start/pause"),
        ),
        line(
            "end_trial",
            &[KeyChord::ctrl('e')],
            KeyAction::EndTrial,
            TRIAL,
            "end the trial (asks first)",
            Some("end"),
        ),
        manual("preflight", 'f', ManualAction::Preflight, TRIAL, "show the preflight checks"),
        manual("check_gaze", 'v', ManualAction::Calibrate, TRIAL, "check gaze accuracy with targets"),
        manual("correct", 'u', ManualAction::Correct, TRIAL, "correct what a place of the kitchen holds"),
        manual("abort_trial", 'x', ManualAction::Abort, TRIAL, "abort the trial (asks why)"),
        manual("ask_probe", 'a', ManualAction::AskProbe, TRIAL, "ask for a freeze probe"),
        line(
            "skip_probe",
            &plain(Delete),
            KeyAction::Manual(ManualAction::SkipProbe),
            TRIAL,
            "skip the rest of a freeze probe (asks why)",
            None,
        ),
        manual("redo_trial", 'n', ManualAction::Redo, TRIAL, "repeat an aborted or excluded trial"),
        manual("exclude_trial", 'l', ManualAction::Exclude, TRIAL, "exclude the trial, or include it again"),
        line(
            "switch_keys",
            &plain(Tab),
            KeyAction::SwitchLayer,
            CONSOLE,
            "switch between keys of wizard and participant",
            Some("switch"),
        ),
    ];
    lines.extend(signals(kitchen));
    let accept = "send the signal on offer";
    lines.push(wizards(line("accept", &plain(Enter), KeyAction::Accept, SIGNALS, accept, Some("send offer"))));
    let take_back = "take back the signal on the display";
    lines.push(wizards(line(
        "take_back",
        &plain(Backspace),
        KeyAction::TakeBack,
        SIGNALS,
        take_back,
        Some("take back"),
    )));
    for index in 0..MAX_NOTES {
        let digit = char::from(b'1' + index as u8);
        let footer = (index == 0).then_some("note");
        let name = format!("note_{digit}");
        let help = format!("record note {digit} of the session file");
        lines.push(wizards(line(&name, &[KeyChord::char(digit)], KeyAction::Note(index), NOTES, &help, footer)));
    }
    let help = "mark the time; while no trial runs: type a note";
    lines.push(wizards(line(
        "note_in_words",
        &[KeyChord::char('0')],
        KeyAction::Manual(ManualAction::NoteInWords),
        NOTES,
        help,
        Some("type note"),
    )));
    lines.extend(buttons(kitchen));
    lines.extend(looks());
    lines.extend(times());
    lines.extend(differences());
    lines.extend([
        line("belief", &[KeyChord::ctrl('b')], KeyAction::Belief, CONSOLE, BELIEF, None),
        palette("list all actions, with search"),
        line("help", &[KeyChord::char('?')], KeyAction::Help, CONSOLE, "show this help", Some("help")),
        line("quit", &[KeyChord::ctrl('c')], KeyAction::Quit, CONSOLE, "quit tomcom (asks first)", Some("quit")),
    ]);
    lines
}

pub fn replay() -> Vec<KeyBinding> {
    use ReplayAction::{BackTo, On};
    let moves = [
        ("step_forward", plain(Right), ReplayAction::StepForward, "go to the next event", Some("step")),
        ("step_back", plain(Left), ReplayAction::StepBack, "go to the previous event", None),
        ("next_error", [KeyChord::char('e')], On(ReplayLandmark::Error), "go to the next error", Some("error")),
        ("last_error", [KeyChord::char('w')], BackTo(ReplayLandmark::Error), "go to the previous error", None),
        ("next_signal", [KeyChord::char('s')], On(ReplayLandmark::Signal), "go to the next signal", Some("signal")),
        ("last_signal", [KeyChord::char('a')], BackTo(ReplayLandmark::Signal), "go to the previous signal", None),
        ("next_marker", [KeyChord::char('m')], On(ReplayLandmark::Marker), "go to the next note", None),
        ("last_marker", [KeyChord::char('n')], BackTo(ReplayLandmark::Marker), "go to the previous note", None),
        (
            "next_false_belief",
            [KeyChord::char('b')],
            On(ReplayLandmark::FalseBelief),
            "go to the next estimated false belief",
            Some("false belief"),
        ),
        (
            "last_false_belief",
            [KeyChord::char('v')],
            BackTo(ReplayLandmark::FalseBelief),
            "go to the previous estimated false belief",
            None,
        ),
        ("seek_forward", plain(PageDown), ReplayAction::SeekForward, "go ten seconds forward", Some("10 s")),
        ("seek_back", plain(PageUp), ReplayAction::SeekBack, "go ten seconds back", None),
        ("faster", [KeyChord::char('+')], ReplayAction::Faster, "play the recording faster", Some("speed")),
        ("slower", [KeyChord::char('-')], ReplayAction::Slower, "play the recording slower", None),
        ("to_start", plain(Home), ReplayAction::ToStart, "go to the beginning, before the trial", None),
        ("to_end", plain(End), ReplayAction::ToEnd, "go to the end; follow a growing recording", Some("start/end")),
    ];
    let of_move =
        |name, keys: &[KeyChord], to, help, footer| line(name, keys, KeyAction::Move(to), REPLAY, help, footer);
    let mut lines = vec![
        of_move(
            "play_pause",
            &[KeyChord::char('.')],
            ReplayAction::PlayPause,
            "play or pause the recording",
            Some("play/pause"),
        ),
        line("quit", &[KeyChord::ctrl('c')], KeyAction::Quit, CONSOLE, "quit", Some("quit")),
        line("belief", &[KeyChord::ctrl('b')], KeyAction::Belief, CONSOLE, BELIEF, None),
        palette("list all actions; type 2:13 or error 7 to go there"),
        line("help", &[KeyChord::char('?')], KeyAction::Help, CONSOLE, "show this help", Some("help")),
    ];
    lines.extend(looks());
    lines.extend(differences());
    lines.extend(codes());
    lines.extend(moves.map(|(name, keys, to, help, footer)| of_move(name, &keys, to, help, footer)));
    lines.into_iter().map(|line| KeyBinding { section: KeyFileTable::Replay, ..line }).collect()
}

/// Key bindings of a rater's codes, active only while errors are coded.
fn codes() -> [KeyBinding; 9] {
    let code =
        |name, keys: &[KeyChord], rate, help, footer| line(name, keys, KeyAction::Rate(rate), CODING, help, footer);
    let cause = |name, key, kind: ErrorCauseKind| {
        let help = format!("{}: {}", kind.title(), kind.definition());
        line(name, &[KeyChord::char(key)], KeyAction::Rate(RaterAction::Cause(kind)), CODING, &help, None)
    };
    [
        code(
            "code_next",
            &plain(Enter),
            RaterAction::Next,
            "go to the next error, or to the selected error",
            Some("next error"),
        ),
        code("code_last", &plain(Backspace), RaterAction::Last, "go to the previous error", None),
        cause("slip", '1', ErrorCauseKind::Slip),
        cause("race", '2', ErrorCauseKind::Race),
        cause("other_cause", '3', ErrorCauseKind::Other),
        cause("mixed_up_buttons", '4', ErrorCauseKind::Buttons),
        code(
            "clear_code",
            &plain(Delete),
            RaterAction::Clear,
            "remove the code of the present error",
            Some("remove code"),
        ),
        code(
            "undo_code",
            &[KeyChord::char('u'), KeyChord::ctrl('z')],
            RaterAction::Undo,
            "undo the last change of a code",
            Some("undo"),
        ),
        code("redo_code", &[KeyChord::ctrl('y')], RaterAction::Redo, "redo the undone change of a code", Some("redo")),
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
        Some(line(&kitchen.location(id).name, &[chord], KeyAction::Rate(RaterAction::Belief(id)), CODING, &help, None))
    };
    marks.iter().enumerate().filter_map(cause).collect()
}

/// Key bindings of the differences between wizard and assistant, active only in a comparison.
fn differences() -> [KeyBinding; 2] {
    let differ = |name, key, step, help, footer| {
        line(name, &[KeyChord::ctrl(key)], KeyAction::Differ(step), COMPARISON, help, footer)
    };
    [
        differ("next_difference", 'g', ComparisonAction::Next, "select the next difference of signals", Some("next")),
        differ(
            "last_difference",
            't',
            ComparisonAction::Last,
            "select the previous difference of signals",
            Some("previous"),
        ),
    ]
}

/// Key bindings that change which panels the screen shows.
fn looks() -> [KeyBinding; 6] {
    let look = |name, code, look, help, footer| line(name, &plain(code), KeyAction::Look(look), CONSOLE, help, footer);
    let of_control =
        |name, key, at, help, footer| line(name, &[KeyChord::ctrl(key)], KeyAction::Look(at), CONSOLE, help, footer);
    [
        of_control("next_panel", 'w', ViewAction::Next, "go to the next panel", Some("panels")),
        look("last_panel", BackTab, ViewAction::Last, "go to the previous panel", None),
        of_control(
            "open_panel",
            'o',
            ViewAction::Open,
            "show the panel at full size; in a comparison, the selected difference",
            Some("full size"),
        ),
        look("all_panels", Esc, ViewAction::All, "one step back; from the first view: quit", Some("back")),
        look("back", Up, ViewAction::Back, "scroll the panel back", None),
        look("forward", Down, ViewAction::Forward, "scroll the panel forward again", None),
    ]
}

/// Left and right arrow keys in a live session: they scroll the timeline. In a replay, they go from event to event
/// instead.
fn times() -> [KeyBinding; 2] {
    let time = |name, code, look, help| line(name, &plain(code), KeyAction::Look(look), CONSOLE, help, None);
    [
        time("earlier", Left, ViewAction::Earlier, "scroll the timeline 5 s back"),
        time("later", Right, ViewAction::Later, "scroll the timeline 5 s forward"),
    ]
}

fn signals(kitchen: &Kitchen) -> impl Iterator<Item = KeyBinding> {
    communication::signals(kitchen, HighlightSet::ALL).into_iter().map(|(id, signal)| {
        let location = kitchen.location(id);
        let help = wording::command(&signal);
        let keys: Vec<KeyChord> = location.signal_key.map(KeyChord::of_letter).into_iter().collect();
        let bound = line(&location.name, &keys, KeyAction::Signal(id, signal), SIGNALS, &help, None);
        KeyBinding { section: KeyFileTable::Signals, layer: Some(KeyLayer::Wizard), ..bound }
    })
}

fn buttons(kitchen: &Kitchen) -> impl Iterator<Item = KeyBinding> {
    kitchen.buttons[Agent::Human.index()].iter().enumerate().map(|(index, button)| {
        let keys: Vec<KeyChord> = button.key.map(KeyChord::of_letter).into_iter().collect();
        let help = button.name.replace('_', " ");
        let bound = line(&button.name, &keys, KeyAction::Press(ButtonId(index as u8)), BUTTONS, &help, None);
        KeyBinding { section: KeyFileTable::Buttons, layer: Some(KeyLayer::Participant), ..bound }
    })
}
