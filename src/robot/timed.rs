//! The timed robot: carries out the task policy with presses that take a while, as an arm would. It knows no events and
//! no clock: it is told the time and the state, and answers what it does.

use rand_distr::{Distribution, LogNormal};

use super::policy::{self, Decision};
use super::{AbortReason, IdleReason};
use crate::base::rng::{Stream, stream};
use crate::base::time::SessionTime;
use crate::kitchen::cost_to_go::{Care, CostToGo};
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

/// A press that was skipped is not decided for again within this time, in seconds.
pub const SKIP_S: f64 = 5.0;

/// A press that the arm is on its way to.
#[derive(Clone, Copy, Debug)]
struct Errand {
    button: ButtonId,
    /// When the arm touches the button.
    until: SessionTime,
    /// The wizard chose it: it is done, useful or not.
    driven: bool,
}

/// The arm's press in time: on its way, idle, held or stopped.
#[derive(Clone, Debug)]
pub struct TimedRobot {
    random: Stream,
    duration_s: LogNormal<f64>,
    busy: Option<Errand>,
    stopped: bool,
    /// It sets out for nothing by itself and waits before the button that it has set out for.
    held: bool,
    /// The press that the wizard chose, until the arm sets out for it.
    driven: Option<ButtonId>,
    /// The press that the wizard skipped, and until when.
    skipped: Option<(ButtonId, SessionTime)>,
    /// Why it was said to be idle, and the state that it last decided for.
    idle: Option<(IdleReason, State)>,
}

impl TimedRobot {
    /// A robot at rest. `press_s` is the median duration of a press in seconds, `spread` the standard deviation of its
    /// logarithm.
    pub fn new(press_s: f64, spread: f64, seed: u64, trial: u64) -> TimedRobot {
        let median = press_s.max(0.05);
        let duration_s = LogNormal::new(median.ln(), spread.clamp(0.0, 2.0)).expect("a finite mean and spread");
        TimedRobot {
            random: stream(seed, "robot", trial),
            duration_s,
            busy: None,
            stopped: false,
            held: false,
            driven: None,
            skipped: None,
            idle: None,
        }
    }

    /// When the arm touches the button that it is on its way to, or may decide again for what was skipped. The time may
    /// have passed: an arm that was held touches as soon as it is released.
    pub fn next_due(&self) -> Option<SessionTime> {
        match (self.busy, self.idle) {
            (Some(errand), _) => (!self.held || errand.driven).then_some(errand.until),
            (None, Some((IdleReason::Skipped, _))) if !self.held => self.skipped.map(|(_, until)| until),
            _ => None,
        }
    }

    /// Sets out for what the wizard chose; else decides what to do if the arm is free and the state is another one than
    /// that of the last decision.
    pub fn decide(
        &mut self,
        kitchen: &Kitchen,
        cost: &mut CostToGo,
        now: SessionTime,
        state: State,
    ) -> Option<RobotDeed> {
        if self.stopped || self.busy.is_some() {
            return None;
        }
        if let Some(button) = self.driven.take() {
            return Some(self.set_out(now, button, true));
        }
        if self.skipped.take_if(|(_, until)| *until <= now).is_some() {
            self.idle = None;
        }
        if self.held || self.idle.is_some_and(|(_, decided)| decided == state) {
            return None;
        }
        let skipped = self.skipped.map(|(button, _)| button);
        match policy::decide(kitchen, cost, state, skipped, &mut self.random) {
            Decision::Press(button) => Some(self.set_out(now, button, false)),
            Decision::Idle(reason) => {
                let said = self.idle.replace((reason, state)).map(|(said, _)| said);
                (said != Some(reason)).then_some(RobotDeed::Idle(reason))
            }
        }
    }

    fn set_out(&mut self, now: SessionTime, button: ButtonId, driven: bool) -> RobotDeed {
        let until = now + SessionTime::from_secs_f64(self.duration_s.sample(&mut self.random));
        self.busy = Some(Errand { button, until, driven });
        self.idle = None;
        RobotDeed::Intend { button, until }
    }

    /// The arm touches the button: presses it if that is still one of the best presses or the wizard chose it, else gives
    /// it up.
    pub fn touch(&mut self, kitchen: &Kitchen, cost: &mut CostToGo, state: State) -> Option<RobotDeed> {
        let Errand { button, driven, .. } = self.busy.take()?;
        let recipes = kitchen.true_recipes();
        match driven || policy::best_presses(kitchen, cost, Care::Exact, state, &recipes).contains(&button) {
            true => Some(RobotDeed::Press(button)),
            false => Some(RobotDeed::Abort(button, AbortReason::NoLongerUseful)),
        }
    }

    /// Something else than a press changed the state: what is no longer useful is given up at once.
    pub fn reconsider(&mut self, kitchen: &Kitchen, cost: &mut CostToGo, state: State) -> Option<RobotDeed> {
        let errand = self.busy.filter(|errand| !errand.driven)?;
        match policy::best_presses(kitchen, cost, Care::Exact, state, &kitchen.true_recipes()).contains(&errand.button)
        {
            true => None,
            false => self.give_up(AbortReason::NoLongerUseful),
        }
    }

    fn give_up(&mut self, reason: AbortReason) -> Option<RobotDeed> {
        self.busy.take().map(|errand| RobotDeed::Abort(errand.button, reason))
    }

    /// The wizard stops the robot; it gives up what it is on its way to.
    pub fn stop(&mut self) -> Option<RobotDeed> {
        self.stopped = true;
        self.idle = None;
        self.driven = None;
        self.give_up(AbortReason::Stopped)
    }

    /// The wizard holds the robot before its next press, or lets it go.
    pub fn hold(&mut self, held: bool) {
        self.held = held;
        self.idle = None;
    }

    /// The wizard skips the press that the arm is on its way to; it is not decided for again for a while.
    pub fn skip(&mut self, now: SessionTime) -> Option<RobotDeed> {
        let errand = self.busy?;
        self.skipped = Some((errand.button, now + SessionTime::from_secs_f64(SKIP_S)));
        self.give_up(AbortReason::Skipped)
    }

    /// The wizard chooses the next press; the arm gives up what it is on its way to.
    pub fn drive(&mut self, button: ButtonId) -> Option<RobotDeed> {
        self.driven = Some(button);
        self.give_up(AbortReason::Driven)
    }

    /// The wizard lets the robot go on.
    pub fn resume(&mut self) {
        self.stopped = false;
    }

    /// The trial is over: the arm rests.
    pub fn rest(&mut self) {
        self.busy = None;
        self.idle = None;
        self.driven = None;
        self.skipped = None;
    }

    /// A pause of this length is over.
    pub fn postpone(&mut self, by: SessionTime) {
        if let Some(errand) = &mut self.busy {
            errand.until = errand.until + by;
        }
        if let Some((_, until)) = &mut self.skipped {
            *until = *until + by;
        }
    }
}
