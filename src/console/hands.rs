//! The experimenter's hands at the console: keys that correct the kitchen and the robot, and the lists that they open.

use super::message::Command;
use super::model::{Dialog, Level, Model};
use super::note::Line;
use super::picker::{Answer, Picked, Picker, Question};
use super::update::send;
use super::words;
use crate::communication::Sender;
use crate::kitchen::Agent;
use crate::session::{Event, Phase, Session};
use crossterm::event::KeyCode;

/// What a key of the hands does.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Hand {
    /// Say what really lies at a location.
    Correct,
    /// Hold the robot before its next press, or release it.
    HoldRobot,
    /// The robot gives up its press and decides anew.
    SkipPress,
    /// Choose the robot's next press.
    DriveRobot,
    /// Abort the trial, for a reason.
    Abort,
    /// Do a trial again that was aborted or excluded.
    Redo,
    /// Show what is ready for the trial, and what is not.
    Preflight,
    /// Check the calibration of the eye tracker.
    Calibrate,
    /// Write a note in words.
    NoteInWords,
    /// Leave the trial out of the analysis, for a reason; or take that back.
    Exclude,
}

/// Does what a key of the hands says, or asks.
pub(super) fn act(model: &mut Model, session: &Session, hand: Hand) -> Option<Command> {
    let by = Sender::Wizard;
    match hand {
        Hand::Correct if !matches!(session.phase, Phase::Running | Phase::Paused) => {
            refuse(model, "the kitchen is corrected during a trial")
        }
        Hand::Correct => ask(model, Question::Place),
        Hand::HoldRobot if session.robot.held => {
            send(model, session, Event::RobotReleased { by }, Level::Done, "the robot goes on by itself")
        }
        Hand::HoldRobot => send(model, session, Event::RobotHeld { by }, Level::Done, "the robot is held"),
        Hand::SkipPress => send(model, session, Event::RobotSkipped { by }, Level::Done, "skipped"),
        Hand::DriveRobot if !session.is_running() => refuse(model, "the robot is driven while the trial runs"),
        Hand::DriveRobot if session.robot.stopped => refuse(model, "the robot is stopped: let it go on first"),
        Hand::DriveRobot => ask(model, Question::Button),
        Hand::Abort if !matches!(session.phase, Phase::Running | Phase::Paused) => {
            refuse(model, "there is no trial to abort")
        }
        Hand::Abort => ask(model, Question::Abort),
        Hand::Preflight if session.phase != Phase::Ready => refuse(model, "the trial was started already"),
        Hand::Preflight => {
            model.dialog = Some(Dialog::Preflight);
            None
        }
        Hand::NoteInWords if session.phase != Phase::Paused => {
            refuse(model, "notes in words only when paused: the space bar has to stop the robot")
        }
        Hand::NoteInWords => {
            model.dialog = Some(Dialog::Note(Line::default()));
            None
        }
        Hand::Calibrate => super::calibration::begin(model, session),
        Hand::Redo => redo(model, session),
        Hand::Exclude if session.excluded.is_some() => {
            send(model, session, Event::TrialIncluded, Level::Done, "the trial is no longer excluded")
        }
        Hand::Exclude if matches!(session.phase, Phase::Ready | Phase::Closed) => {
            refuse(model, "there is no trial to exclude")
        }
        Hand::Exclude => ask(model, Question::Exclude),
    }
}

fn redo(model: &mut Model, session: &Session) -> Option<Command> {
    match session.phase {
        Phase::Over(_) if session.aborted.is_some() || session.excluded.is_some() => Some(Command::Redo),
        Phase::Over(_) => refuse(model, "only a trial that was aborted or excluded is done again"),
        _ => refuse(model, "abort the trial first"),
    }
}

fn refuse(model: &mut Model, reason: &str) -> Option<Command> {
    model.say(Level::Refused, reason);
    None
}

fn ask(model: &mut Model, question: Question) -> Option<Command> {
    model.dialog = Some(Dialog::Pick(Picker::new(question)));
    None
}

/// A key on the line for a note.
pub(super) fn write(model: &mut Model, session: &Session, mut line: Line, code: KeyCode) -> Option<Command> {
    model.dialog = None;
    match code {
        KeyCode::Esc => None,
        KeyCode::Enter if line.text().is_empty() => None,
        KeyCode::Enter => {
            let note = line.text();
            send(model, session, Event::Marker { note }, Level::Done, "the note is kept")
        }
        _ => {
            line.key(code);
            model.dialog = Some(Dialog::Note(line));
            None
        }
    }
}

/// A key in an open list.
pub(super) fn pick(model: &mut Model, session: &Session, mut picker: Picker, code: KeyCode) -> Option<Command> {
    let answer = match picker.key(session, code) {
        Picked::Nothing => {
            model.dialog = Some(Dialog::Pick(picker));
            return None;
        }
        Picked::Left => {
            // From the second question back to the first.
            let back = matches!(picker.question, Question::Content(_)).then(|| Picker::new(Question::Place));
            model.dialog = back.map(Dialog::Pick);
            return None;
        }
        Picked::This(answer) => answer,
    };
    model.dialog = None;
    let kitchen = &session.kitchen;
    match (picker.question, answer) {
        (_, Answer::Place(place)) => ask(model, Question::Content(place)),
        (Question::Content(place), Answer::Content(content)) => {
            let (location, content) = (kitchen.location(place), kitchen.content(content).name.clone());
            let words = format!("corrected: {} holds {content}", location.label());
            let event = Event::KitchenCorrected { location: location.name.clone(), content };
            send(model, session, event, Level::Done, &words)
        }
        (_, Answer::Button(button)) => {
            let words = format!("the robot sets out for {}", words::button(kitchen, Agent::Robot, button));
            let button = kitchen.button(Agent::Robot, button).name.clone();
            send(model, session, Event::RobotDriven { by: Sender::Wizard, button }, Level::Done, &words)
        }
        (Question::Abort, Answer::Reason(reason)) => {
            send(model, session, Event::TrialAborted { reason }, Level::Done, "aborted")
        }
        (_, Answer::Reason(reason)) => {
            let words = format!("excluded: {reason}");
            send(model, session, Event::TrialExcluded { reason }, Level::Done, &words)
        }
        (_, Answer::Content(_)) => None,
    }
}
