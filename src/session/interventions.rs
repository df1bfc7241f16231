//! Manual interventions of the experimenter: correcting the kitchen, holding, skipping and driving the robot, aborting
//! and excluding trials. This file has the preconditions and state changes of these interventions.

use super::event::Event;
use super::phase::TrialPhase;
use super::session_state::Session;
use crate::communication::Sender;
use crate::kitchen::{ContentId, LocationKind};

/// Whether the session accepts a manual intervention of the experimenter now.
///
/// # Errors
/// Why the session refuses the event, in words for the wizard.
pub(super) fn admit(session: &Session, event: &Event) -> Result<(), &'static str> {
    let refuse_if = |refused: bool, reason: &'static str| if refused { Err(reason) } else { Ok(()) };
    let (phase, robot) = (session.phase, &session.robot);
    match event {
        Event::KitchenCorrected { location, content } => admit_correction(session, location, content),
        Event::RobotHeld { by } => by_the_wizard(*by).and(refuse_if(robot.held, "the robot is held already")),
        Event::RobotReleased { by } => by_the_wizard(*by).and(refuse_if(!robot.held, "the robot is not held")),
        Event::RobotSkipped { by } => {
            by_the_wizard(*by)?;
            refuse_if(phase != TrialPhase::Running, "presses are skipped while the trial runs")?;
            refuse_if(robot.intention.is_none(), "the robot is on its way to no press")
        }
        Event::RobotDriven { by, .. } => {
            by_the_wizard(*by)?;
            refuse_if(phase != TrialPhase::Running, "the robot's press can be chosen only while the trial runs")?;
            refuse_if(robot.stopped, "the robot is stopped: resume it first")
        }
        Event::TrialAborted { .. } => {
            refuse_if(!matches!(phase, TrialPhase::Running | TrialPhase::Paused), "there is no trial to abort")
        }
        Event::TrialExcluded { .. } => {
            refuse_if(phase == TrialPhase::Ready, "there is no trial to exclude")?;
            refuse_if(session.excluded.is_some(), "the trial is excluded already")
        }
        Event::TrialIncluded => refuse_if(session.excluded.is_none(), "the trial is not excluded"),
        _ => Ok(()),
    }
}

fn by_the_wizard(by: Sender) -> Result<(), &'static str> {
    if by == Sender::Wizard { Ok(()) } else { Err("only the wizard has hands on the robot") }
}

fn admit_correction(session: &Session, location: &str, content: &str) -> Result<(), &'static str> {
    if !matches!(session.phase, TrialPhase::Running | TrialPhase::Paused) {
        return Err("the kitchen can be corrected only during a trial");
    }
    if session.is_frozen() {
        // The kitchen is corrected after the probe, whose questions are about the kitchen as it was when the task was
        // frozen.
        return Err("the kitchen is corrected after the probe");
    }
    let kitchen = &session.kitchen;
    let place = kitchen.location_named(location).ok_or("there is no such location")?;
    let what = kitchen.content_named(content).ok_or("there is no such content")?;
    match () {
        () if kitchen.location(place).kind == LocationKind::Order => {
            Err("orders are shown by the program, and cannot be corrected")
        }
        () if session.state.content(place) == what => Err("that is what the program thinks"),
        () if what != ContentId::EMPTY && !kitchen.accepts(place, what) => Err("it cannot be there"),
        () => Ok(()),
    }
}
