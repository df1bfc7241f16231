//! The robot in a running session: turns the robot's activities into events, and tells it about events that concern it.

use super::SessionEngine;
use crate::{Event, TimestampedEvent};
use tomcom_arm::worker::RobotTaskExecutor;
use tomcom_core::base::time::SessionTime;
use tomcom_core::kitchen::{Agent, ButtonId, KitchenChange};
use tomcom_core::robot::RobotEvent;
use tomcom_people::participant::SimulatedParticipant;

impl SessionEngine {
    /// The session's robot, for experiments with the robot's arm.
    pub fn robot(&mut self) -> &mut RobotTaskExecutor {
        &mut self.robot
    }

    pub(super) fn let_robot_act(&mut self, now: SessionTime) {
        let kitchen = self.session().kitchen.clone();
        let state = self.session().state;
        for event in self.robot.act(&kitchen, &mut self.follower.cost, now, state) {
            self.record_robot(now, event);
        }
    }

    pub(super) fn record_robot(&mut self, now: SessionTime, event: RobotEvent) {
        let kitchen = self.session().kitchen.clone();
        let name = |button: ButtonId| kitchen.button(Agent::Robot, button).name.clone();
        let event = match event {
            RobotEvent::Intend { button, until, initiative } => {
                Event::RobotIntends { button: name(button), until_ns: until, initiative }
            }
            RobotEvent::Press(button) => Event::Press { agent: Agent::Robot, button: name(button), at_ns: None },
            RobotEvent::Abort(button, reason) => Event::RobotAborts { button: name(button), reason },
            RobotEvent::Idle { reason, waits_for } => {
                let human = &kitchen.buttons[Agent::Human.index()];
                let awaited = human.iter().enumerate().filter(|(index, _)| waits_for >> index & 1 == 1);
                Event::RobotIdles { reason, waits_for: awaited.map(|(_, button)| button.name.clone()).collect() }
            }
            RobotEvent::Move(moment) => Event::RobotMoves(moment),
            RobotEvent::Safety { mode, force_n, joint } => Event::RobotSafety { mode, force_n, joint },
            RobotEvent::Touched { force_n } => Event::RobotTouched { force_n },
        };
        self.record_own(now, event);
    }

    /// Tells the robot about an applied event (an intervention of the wizard, or a press of the human); returns the
    /// robot's reactions.
    pub(super) fn tell_robot(&mut self, stamped: &TimestampedEvent, change: &KitchenChange) -> Vec<RobotEvent> {
        let kitchen = self.session().kitchen.clone();
        let now = stamped.time;
        if let Some(press) = change.human_press() {
            self.robot.human_pressed(now, kitchen.button(Agent::Human, press.button).at_m);
        }
        let reaction = match &stamped.event {
            Event::TrialStarted => {
                self.robot.start(now);
                None
            }
            Event::RobotStopped => return self.robot.stop(),
            Event::RobotResumed => self.robot.resume(now),
            Event::RobotHeld { .. } => {
                self.robot.hold(true);
                None
            }
            Event::RobotReleased { .. } => {
                self.robot.hold(false);
                None
            }
            Event::RobotSkipped { .. } => self.robot.skip(now),
            Event::RobotDriven { .. } => {
                let button = self.session().robot.driven_to;
                button.and_then(|button| self.robot.drive(button))
            }
            Event::KitchenCorrected { .. } => {
                let state = self.session().state;
                self.robot.reconsider(&kitchen, &mut self.follower.cost, now, state)
            }
            _ => None,
        };
        reaction.into_iter().collect()
    }

    /// Starts the hand motion of a simulated participant in time for the participant's next press.
    pub(super) fn let_hand_follow(&mut self, now: SessionTime) {
        if let Some((button, at)) = self.participant.as_ref().and_then(SimulatedParticipant::next_press) {
            let button_m = self.session().kitchen.button(Agent::Human, button).at_m;
            self.robot.human_means(now, button_m, at);
        }
    }
}
