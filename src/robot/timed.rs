//! The timed robot: carries out the task policy with presses that take a while, as an arm would. It knows no events and
//! no clock: it is told the time and the state, and answers what it does.

use rand_distr::{Distribution, LogNormal};

use super::policy::{self, Decision};
use super::{AbortReason, IdleReason};
use crate::base::rng::{Stream, stream};
use crate::base::time::SessionTime;
use crate::kitchen::cost_to_go::CostToGo;
use crate::kitchen::{ButtonId, Kitchen, State};

/// What the robot does at a moment.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RobotDeed {
    /// Sets out to press a button, which it will touch at `until`.
    Intend { button: ButtonId, until: SessionTime },
    /// Presses the button that it set out for.
    Press(ButtonId),
    /// Gives up the press that it set out for.
    Abort(ButtonId, AbortReason),
    /// Begins to do nothing, or goes on doing nothing for another reason.
    Idle(IdleReason),
}

/// The arm's press in time: on its way, idle or stopped.
#[derive(Clone, Debug)]
pub struct TimedRobot {
    random: Stream,
    duration_s: LogNormal<f64>,
    /// The button that the arm is on its way to, and when it touches it.
    busy: Option<(ButtonId, SessionTime)>,
    stopped: bool,
    /// Why it was said to be idle, and the state that it last decided for.
    idle: Option<(IdleReason, State)>,
}

impl TimedRobot {
    /// A robot at rest. `press_s` is the median duration of a press in seconds, `spread` the standard deviation of its
    /// logarithm.
    pub fn new(press_s: f64, spread: f64, seed: u64, trial: u64) -> TimedRobot {
        let median = press_s.max(0.05);
        let duration_s = LogNormal::new(median.ln(), spread.clamp(0.0, 2.0)).expect("a finite mean and spread");
        TimedRobot { random: stream(seed, "robot", trial), duration_s, busy: None, stopped: false, idle: None }
    }

    /// When the arm touches the button that it is on its way to.
    pub fn next_due(&self) -> Option<SessionTime> {
        self.busy.map(|(_, until)| until)
    }

    /// Decides what to do if the arm is free and the state is another one than that of the last decision.
    pub fn decide(
        &mut self,
        kitchen: &Kitchen,
        cost: &mut CostToGo,
        now: SessionTime,
        state: State,
    ) -> Option<RobotDeed> {
        if self.stopped || self.busy.is_some() || self.idle.is_some_and(|(_, decided)| decided == state) {
            return None;
        }
        match policy::decide(kitchen, cost, state, &mut self.random) {
            Decision::Press(button) => {
                let until = now + SessionTime::from_secs_f64(self.duration_s.sample(&mut self.random));
                self.busy = Some((button, until));
                self.idle = None;
                Some(RobotDeed::Intend { button, until })
            }
            Decision::Idle(reason) => {
                let said = self.idle.replace((reason, state)).map(|(said, _)| said);
                (said != Some(reason)).then_some(RobotDeed::Idle(reason))
            }
        }
    }

    /// The arm touches the button: presses it if that is still one of the best presses, else gives it up.
    pub fn touch(&mut self, kitchen: &Kitchen, cost: &mut CostToGo, state: State) -> Option<RobotDeed> {
        let (button, _) = self.busy.take()?;
        match policy::best_presses(kitchen, cost, state).contains(&button) {
            true => Some(RobotDeed::Press(button)),
            false => Some(RobotDeed::Abort(button, AbortReason::NoLongerUseful)),
        }
    }

    /// The wizard stops the robot; it gives up what it is on its way to.
    pub fn stop(&mut self) -> Option<RobotDeed> {
        self.stopped = true;
        self.idle = None;
        self.busy.take().map(|(button, _)| RobotDeed::Abort(button, AbortReason::Stopped))
    }

    /// The wizard lets the robot go on.
    pub fn resume(&mut self) {
        self.stopped = false;
    }

    /// The trial is over: the arm rests.
    pub fn rest(&mut self) {
        self.busy = None;
        self.idle = None;
    }

    /// A pause of this length is over.
    pub fn postpone(&mut self, by: SessionTime) {
        if let Some((_, until)) = &mut self.busy {
            *until = *until + by;
        }
    }
}
