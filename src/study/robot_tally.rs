//! What the robot did in a trial beside its presses, and what the wizard did with it by hand.

use std::collections::BTreeMap;

use serde::Serialize;

use crate::base::time::SessionTime;
use crate::communication::Sender;
use crate::robot::AbortReason;
use crate::robot::safety::SafetyMode;
use crate::session::Event;
use crate::session::event::EndReason;
use crate::session::settings::ArmKind;

/// What is counted of the robot while a trial is on, pauses included.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct RobotSummary {
    /// Of an arm in the physics; a timed one has nothing to feel with.
    pub arm: Option<ArmSummary>,
    /// The wizard stopped it.
    pub emergency_stops: u64,
    /// Presses that it gave up, by reason; what is not there did not occur.
    pub given_up: BTreeMap<AbortReason, u64>,
    /// What the wizard did by hand: held it, skipped a press, chose one, put right what is in the kitchen.
    pub held: u64,
    pub skipped: u64,
    pub driven: u64,
    pub corrected: u64,
}

/// What an arm in the physics felt.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct ArmSummary {
    /// Times that it stopped because it felt somebody, and because a joint did not follow.
    pub protective_stops: u64,
    pub faults: u64,
    /// Times that somebody touched it, and the largest force of these in newtons; none without any.
    pub contacts: u64,
    pub peak_force_n: Option<f64>,
    /// Seconds on the trial's clock that it was slowed by a hand near it, and that it waited for one.
    pub reduced_s: f64,
    pub safeguard_s: f64,
}

impl ArmSummary {
    /// Somebody was felt with this force in newtons, if it was told.
    fn felt(&mut self, force_n: Option<f64>) {
        self.peak_force_n = self.peak_force_n.into_iter().chain(force_n).reduce(f64::max);
    }
}

impl RobotSummary {
    /// Presses given up for a reason; none where this arm cannot have it.
    pub fn given_up(&self, reason: AbortReason) -> Option<u64> {
        let count = self.given_up.get(&reason).copied();
        (self.arm.is_some() || !reason.is_of_physics()).then(|| count.unwrap_or(0))
    }

    /// Adds what was counted in another trial.
    pub fn add(&mut self, other: &RobotSummary) {
        self.emergency_stops += other.emergency_stops;
        for (&reason, count) in &other.given_up {
            *self.given_up.entry(reason).or_default() += count;
        }
        self.held += other.held;
        self.skipped += other.skipped;
        self.driven += other.driven;
        self.corrected += other.corrected;
        if let Some(other) = &other.arm {
            let arm = self.arm.get_or_insert_default();
            arm.protective_stops += other.protective_stops;
            arm.faults += other.faults;
            arm.contacts += other.contacts;
            arm.felt(other.peak_force_n);
            arm.reduced_s += other.reduced_s;
            arm.safeguard_s += other.safeguard_s;
        }
    }
}

/// Counts along a recording.
#[derive(Clone, Debug)]
pub struct RobotTally {
    figures: RobotSummary,
    /// Why the trial ended, once it did.
    pub ended: Option<EndReason>,
    mode: SafetyMode,
    /// Until when the seconds are counted.
    clock: SessionTime,
}

impl RobotTally {
    pub fn new(arm: ArmKind) -> RobotTally {
        let arm = (arm == ArmKind::Physics).then(ArmSummary::default);
        let figures = RobotSummary { arm, ..RobotSummary::default() };
        RobotTally { figures, ended: None, mode: SafetyMode::Normal, clock: SessionTime::ZERO }
    }

    /// Takes note of an event at this time of the trial's clock; `was_on`: the trial had begun before it, and was not over.
    pub fn note(&mut self, event: &Event, clock: SessionTime, was_on: bool) {
        self.pass_time(clock);
        if let Event::RobotSafety { mode, .. } = event {
            self.mode = *mode;
        }
        if was_on {
            self.count(event);
        }
    }

    /// Seconds pass in the mode that held until now.
    fn pass_time(&mut self, clock: SessionTime) {
        let seconds = clock.secs_since(self.clock);
        self.clock = clock;
        let Some(arm) = &mut self.figures.arm else { return };
        match self.mode {
            SafetyMode::Reduced => arm.reduced_s += seconds,
            SafetyMode::Safeguard => arm.safeguard_s += seconds,
            _ => {}
        }
    }

    fn count(&mut self, event: &Event) {
        let figures = &mut self.figures;
        match event {
            Event::TrialEnded { reason } => self.ended = Some(*reason),
            Event::TrialAborted { .. } => self.ended = Some(EndReason::Aborted),
            Event::RobotStopped => figures.emergency_stops += 1,
            Event::RobotAborts { reason, .. } => *figures.given_up.entry(*reason).or_default() += 1,
            Event::RobotHeld { by: Sender::Wizard } => figures.held += 1,
            Event::RobotSkipped { by: Sender::Wizard } => figures.skipped += 1,
            Event::RobotDriven { by: Sender::Wizard, .. } => figures.driven += 1,
            Event::KitchenCorrected { .. } => figures.corrected += 1,
            Event::RobotSafety { mode, force_n, .. } => {
                let Some(arm) = &mut figures.arm else { return };
                arm.protective_stops += u64::from(*mode == SafetyMode::ProtectiveStop);
                arm.faults += u64::from(*mode == SafetyMode::Fault);
                arm.felt(*force_n);
            }
            Event::RobotTouched { force_n } => {
                let Some(arm) = &mut figures.arm else { return };
                arm.contacts += 1;
                arm.felt(Some(*force_n));
            }
            _ => {}
        }
    }

    pub fn into_figures(self) -> RobotSummary {
        self.figures
    }
}
