//! The robot at work: carries out the task policy with presses that take a while. How long they take follows from chance
//! (the timed arm) or from the arm in the physics. It knows no events and no clock: it is told the time and the state, and
//! answers what it does.

use rand_distr::{Distribution, LogNormal};

use super::body::SteppedArm;
#[cfg(feature = "physics")]
use super::controller::PhysicalArm;
use super::report::PressFailure;
use crate::base::rng::{Stream, stream};
use crate::base::time::SessionTime;
use crate::kitchen::cost_to_go::{CostToGo, Fidelity};
use crate::kitchen::{ButtonId, Kitchen, State};
use crate::robot::policy::{self, PolicyDecision};
use crate::robot::{AbortReason, IdleReason, RobotActivity};

/// A press that was skipped is not decided for again within this time, in seconds.
pub const SKIP_S: f64 = 5.0;

/// A press that the arm is on its way to.
#[derive(Clone, Copy, Debug)]
struct OngoingPress {
    button: ButtonId,
    /// When the arm touches the button.
    until: SessionTime,
    /// The wizard chose it: it is done, useful or not.
    driven: bool,
}

/// The robot's presses in time: on its way, idle, held or stopped.
#[derive(Clone, Debug)]
pub struct Robot {
    random: Stream,
    duration_s: LogNormal<f64>,
    busy: Option<OngoingPress>,
    stopped: bool,
    /// It sets out for nothing by itself and waits before the button that it has set out for.
    held: bool,
    /// The press that the wizard chose, until the arm sets out for it.
    driven: Option<ButtonId>,
    /// The presses that the wizard skipped or that went wrong, and until when they are left out.
    skipped: Vec<(ButtonId, SessionTime)>,
    /// Why it was said to be idle, and the state that it last decided for.
    idle: Option<(IdleReason, State)>,
    /// The arm in the physics; none: presses take a while by chance.
    body: Option<Box<SteppedArm>>,
}

impl Robot {
    /// A robot at rest, whose arm is timed. `press_s` is the median duration of a press in seconds, `spread` the standard
    /// deviation of its logarithm.
    pub fn new(press_s: f64, spread: f64, seed: u64, trial: u64) -> Robot {
        let median = press_s.max(0.05);
        let duration_s = LogNormal::new(median.ln(), spread.clamp(0.0, 2.0)).expect("a finite mean and spread");
        Robot {
            random: stream(seed, "robot", trial),
            duration_s,
            busy: None,
            stopped: false,
            held: false,
            driven: None,
            skipped: Vec::new(),
            idle: None,
            body: None,
        }
    }

    /// The same robot with an arm in the physics, which decides how long its presses take.
    pub fn with_body(self, body: SteppedArm) -> Robot {
        Robot { body: Some(Box::new(body)), ..self }
    }

    /// The arm in the physics, for experiments with it.
    #[cfg(feature = "physics")]
    pub fn arm(&mut self) -> Option<&mut PhysicalArm> {
        self.body.as_mut().map(|body| &mut body.arm)
    }

    /// When it does something next: touches the button that it is on its way to, moves its arm on for a cycle, or may decide
    /// again for what was skipped. The time may have passed: an arm that was held touches as soon as it is released.
    pub fn next_due(&self) -> Option<SessionTime> {
        let again = match (self.busy, self.idle) {
            (None, Some((IdleReason::Skipped, _))) if !self.held => self.skipped.iter().map(|(_, until)| *until).min(),
            _ => None,
        };
        let moves = match (&self.body, self.busy) {
            (Some(body), _) => body.next_due(!self.waits()),
            (None, Some(errand)) => (!self.held || errand.driven).then_some(errand.until),
            (None, None) => None,
        };
        again.into_iter().chain(moves).min()
    }

    /// Whether the wizard holds it before the button that it has set out for.
    fn waits(&self) -> bool {
        self.held && self.busy.is_none_or(|errand| !errand.driven)
    }

    /// Sets out for what the wizard chose; else decides what to do if the arm is free and the state is another one than
    /// that of the last decision.
    pub fn decide(
        &mut self,
        kitchen: &Kitchen,
        cost: &mut CostToGo,
        now: SessionTime,
        state: State,
    ) -> Option<RobotActivity> {
        if self.stopped || self.busy.is_some() {
            return None;
        }
        if let Some(button) = self.driven.take() {
            return Some(self.set_out(now, button, true));
        }
        let skipped = self.skipped.len();
        self.skipped.retain(|(_, until)| *until > now);
        if self.skipped.len() < skipped {
            self.idle = None;
        }
        if self.held || self.idle.is_some_and(|(_, decided)| decided == state) {
            return None;
        }
        let skipped: Vec<ButtonId> = self.skipped.iter().map(|(button, _)| *button).collect();
        match policy::decide(kitchen, cost, state, &skipped, &mut self.random) {
            PolicyDecision::Press(button) => Some(self.set_out(now, button, false)),
            PolicyDecision::Idle(reason) => {
                if let Some(body) = &mut self.body {
                    body.has_nothing_to_do();
                }
                let said = self.idle.replace((reason, state)).map(|(said, _)| said);
                (said != Some(reason)).then_some(RobotActivity::Idle(reason))
            }
        }
    }

    fn set_out(&mut self, now: SessionTime, button: ButtonId, driven: bool) -> RobotActivity {
        let takes_s = match &mut self.body {
            None => self.duration_s.sample(&mut self.random),
            Some(body) => match body.set_out(now, button) {
                Ok(takes_s) => takes_s,
                Err(why) => {
                    self.leave_out(now, button);
                    return RobotActivity::Abort(button, why);
                }
            },
        };
        let until = now + SessionTime::from_secs_f64(takes_s);
        self.busy = Some(OngoingPress { button, until, driven });
        self.idle = None;
        RobotActivity::Intend { button, until }
    }

    /// What is due now: the timed arm touches its button, that in the physics goes on for a cycle.
    pub fn act(
        &mut self,
        kitchen: &Kitchen,
        cost: &mut CostToGo,
        now: SessionTime,
        state: State,
    ) -> Vec<RobotActivity> {
        let may_press = !self.waits();
        let Some(body) = &mut self.body else { return self.touch(kitchen, cost, state).into_iter().collect() };
        let mut deeds = Vec::new();
        if let Some((button, why)) = body.go_on() {
            deeds.extend(self.go_without(now, button, why));
            return deeds;
        }
        if let Some(errand) = self.busy.filter(|_| body.asks(may_press, state)) {
            match is_useful(kitchen, cost, state, errand) {
                true => body.go_for_it(may_press, state),
                false => {
                    body.give_up();
                    self.busy = None;
                    deeds.push(RobotActivity::Abort(errand.button, AbortReason::NoLongerUseful));
                }
            }
        }
        let cycle = body.cycle(now);
        deeds.extend(cycle.news);
        if let Some(button) = cycle.clicked {
            self.busy = None;
            deeds.push(RobotActivity::Press(button));
        }
        deeds.extend(cycle.report.and_then(|report| self.follow(now, report)));
        deeds
    }

    /// What follows for the press that it was on its way to.
    fn follow(&mut self, now: SessionTime, report: PressFailure) -> Option<RobotActivity> {
        let (button, reason) = match report {
            PressFailure::Contact(_) => return self.halt(AbortReason::Contact),
            PressFailure::Fault(_) => return self.halt(AbortReason::Fault),
            PressFailure::Blocked(button) => (button, AbortReason::HandInTheWay),
            PressFailure::NoClick(button) => (button, AbortReason::NoClick),
        };
        self.go_without(now, button, reason)
    }

    /// Gives a press up that went wrong, and leaves it out for a while.
    fn go_without(&mut self, now: SessionTime, button: ButtonId, reason: AbortReason) -> Option<RobotActivity> {
        self.leave_out(now, button);
        self.give_up(reason)
    }

    /// Stopped until the wizard lets it go on; it gives up what it is on its way to.
    fn halt(&mut self, reason: AbortReason) -> Option<RobotActivity> {
        self.stopped = true;
        self.idle = None;
        self.driven = None;
        self.give_up(reason)
    }

    /// This press is not decided for for a while.
    fn leave_out(&mut self, now: SessionTime, button: ButtonId) {
        self.skipped.push((button, now + SessionTime::from_secs_f64(SKIP_S)));
        self.idle = None;
    }

    /// The timed arm touches the button: presses it if that is still one of the best presses or the wizard chose it, else
    /// gives it up.
    fn touch(&mut self, kitchen: &Kitchen, cost: &mut CostToGo, state: State) -> Option<RobotActivity> {
        let errand = self.busy.take()?;
        match is_useful(kitchen, cost, state, errand) {
            true => Some(RobotActivity::Press(errand.button)),
            false => Some(RobotActivity::Abort(errand.button, AbortReason::NoLongerUseful)),
        }
    }

    /// Something else than a press changed the state: what is no longer useful is given up at once.
    pub fn reconsider(&mut self, kitchen: &Kitchen, cost: &mut CostToGo, state: State) -> Option<RobotActivity> {
        let errand = self.busy?;
        match is_useful(kitchen, cost, state, errand) {
            true => None,
            false => self.give_up(AbortReason::NoLongerUseful),
        }
    }

    fn give_up(&mut self, reason: AbortReason) -> Option<RobotActivity> {
        let errand = self.busy.take()?;
        if let Some(body) = &mut self.body {
            body.give_up();
        }
        Some(RobotActivity::Abort(errand.button, reason))
    }

    /// The wizard stops the robot; it gives up what it is on its way to.
    pub fn stop(&mut self) -> Vec<RobotActivity> {
        let safety = self.body.as_mut().and_then(|body| body.stop());
        let given_up = self.halt(AbortReason::Stopped);
        safety.into_iter().chain(given_up).collect()
    }

    /// The wizard holds the robot before its next press, or lets it go.
    pub fn hold(&mut self, held: bool) {
        self.held = held;
        self.idle = None;
    }

    /// The wizard skips the press that the arm is on its way to, instead of what was left out before; it is not decided for
    /// again for a while.
    pub fn skip(&mut self, now: SessionTime) -> Option<RobotActivity> {
        let errand = self.busy?;
        self.skipped.clear();
        self.leave_out(now, errand.button);
        self.give_up(AbortReason::Skipped)
    }

    /// The wizard chooses the next press; the arm gives up what it is on its way to.
    pub fn drive(&mut self, button: ButtonId) -> Option<RobotActivity> {
        self.driven = Some(button);
        self.give_up(AbortReason::Driven)
    }

    /// The wizard lets the robot go on.
    pub fn resume(&mut self, now: SessionTime) -> Option<RobotActivity> {
        self.stopped = false;
        self.body.as_mut()?.resume(now)
    }

    /// The person means to press the button at this place of the table (metres) at `at`, as far as is known now.
    pub fn human_means(&mut self, now: SessionTime, button_m: [f64; 2], at: SessionTime) {
        if let Some(body) = &mut self.body {
            body.human_means(now, button_m, at);
        }
    }

    /// The person has pressed the button at this place of the table (metres).
    pub fn human_pressed(&mut self, now: SessionTime, button_m: [f64; 2]) {
        if let Some(body) = &mut self.body {
            body.human_pressed(now, button_m);
        }
    }

    /// The trial is over: the arm rests.
    pub fn rest(&mut self) {
        self.busy = None;
        self.idle = None;
        self.driven = None;
        self.skipped.clear();
    }

    /// A pause of this length is over.
    pub fn postpone(&mut self, by: SessionTime) {
        if let Some(errand) = &mut self.busy {
            errand.until = errand.until + by;
        }
        for (_, until) in &mut self.skipped {
            *until = *until + by;
        }
        if let Some(body) = &mut self.body {
            body.postpone(by);
        }
    }
}

/// Whether a press is still one of the best, or the wizard chose it.
fn is_useful(kitchen: &Kitchen, cost: &mut CostToGo, state: State, errand: OngoingPress) -> bool {
    let best =
        |cost: &mut CostToGo| policy::best_presses(kitchen, cost, Fidelity::Exact, state, &kitchen.true_recipes());
    errand.driven || best(cost).contains(&errand.button)
}
