//! Changes of the robot's state in a session, as events are applied.

use super::event::Event;
use super::session_state::Session;
use super::timeline_entry::TimelineEvent;
use tomcom_core::base::time::SessionTime;

/// Applies an event of the simulated arm to the session's state of the robot.
pub(super) fn arm(session: &mut Session, now: SessionTime, event: &Event) {
    match event {
        Event::RobotMoves(moment) => session.robot.arm.last = Some((now, *moment)),
        Event::RobotTouched { force_n } => session.note(now, TimelineEvent::ArmTouched { force_n: *force_n }),
        Event::RobotSafety { mode, force_n, joint } => {
            let arm = &mut session.robot.arm;
            (arm.mode, arm.stopped_by_n) = (*mode, *force_n);
            // A stop by the wizard has an event of its own, so only other stops are noted here.
            if mode.is_stopped() && !session.robot.stopped {
                session.robot.stopped = true;
                session.robot.idle = None;
                session.note(now, TimelineEvent::ArmStopped { mode: *mode, force_n: *force_n, joint: *joint });
            }
        }
        _ => {}
    }
}

/// Applies that the wizard stops the robot, or releases it.
pub(super) fn stop(session: &mut Session, now: SessionTime, stopped: bool) {
    session.robot.stopped = stopped;
    session.robot.idle = None;
    session.note(now, if stopped { TimelineEvent::RobotStopped } else { TimelineEvent::RobotResumed });
}

/// Applies that the wizard holds the robot, or lets it continue.
pub(super) fn hold(session: &mut Session, now: SessionTime, held: bool) {
    session.robot.held = held;
    session.robot.idle = None;
    session.note(now, if held { TimelineEvent::RobotHeld } else { TimelineEvent::RobotReleased });
}
