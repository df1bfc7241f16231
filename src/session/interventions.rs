//! Manual interventions of the experimenter: correcting the kitchen, holding, skipping and driving the robot, aborting
//! and excluding trials. This file has the preconditions and state changes of these interventions.

use super::event::Event;
use super::phase::TrialPhase;
use super::session_state::Session;
use tomcom_core::communication::Sender;
use tomcom_core::kitchen::{ContentId, LocationKind};

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
            refuse_if(phase != TrialPhase::Running, "the robot's presses can be skipped only while the trial runs")?;
            refuse_if(robot.intention.is_none(), "the robot is not on its way to a press")
        }
        Event::RobotDriven { by, .. } => {
            by_the_wizard(*by)?;
            refuse_if(phase != TrialPhase::Running, "the robot's press can be chosen only while the trial runs")?;
            refuse_if(robot.stopped, "the robot is stopped: resume it first")
        }
        Event::TrialAborted { .. } => {
            refuse_if(!matches!(phase, TrialPhase::Running | TrialPhase::Paused), "no trial runs that could be aborted")
        }
        Event::TrialExcluded { .. } => {
            refuse_if(phase == TrialPhase::Ready, "no trial has begun that could be excluded")?;
            refuse_if(session.excluded.is_some(), "the trial is excluded already")
        }
        Event::TrialIncluded => refuse_if(session.excluded.is_none(), "the trial is not excluded"),
        _ => Ok(()),
    }
}

fn by_the_wizard(by: Sender) -> Result<(), &'static str> {
    if by == Sender::Wizard {
        Ok(())
    } else {
        Err("only the wizard can hold the robot, skip its presses and choose \
                                                   them")
    }
}

fn admit_correction(session: &Session, location: &str, content: &str) -> Result<(), &'static str> {
    if !matches!(session.phase, TrialPhase::Running | TrialPhase::Paused) {
        return Err("the kitchen can be corrected only during a trial");
    }
    if session.is_frozen() {
        // The probe's questions are about the kitchen as it was when the task was frozen.
        return Err("the kitchen can be corrected only after the freeze probe");
    }
    let kitchen = &session.kitchen;
    let place = kitchen.location_named(location).ok_or("the kitchen has no location with this name")?;
    let what = kitchen.content_named(content).ok_or("the kitchen has no content with this name")?;
    match () {
        () if kitchen.location(place).kind == LocationKind::Order => {
            Err("orders are shown by the program, and cannot be corrected")
        }
        () if session.state.content(place) == what => Err("the program assumes this content already"),
        () if what != ContentId::EMPTY && !kitchen.accepts(place, what) => Err("this content cannot be at this place"),
        () => Ok(()),
    }
}
