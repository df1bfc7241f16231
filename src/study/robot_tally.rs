//! Counts of robot events other than presses, and of the wizard's interventions in the robot, while a trial is
//! replayed.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

use tomcom_core::base::time::SessionTime;
use tomcom_core::communication::Sender;
use tomcom_core::robot::AbortReason;
use tomcom_core::robot::SafetyMode;
use tomcom_session::Event;
use tomcom_session::event::TrialEndReason;
use tomcom_session::settings::ArmKind;

/// Robot statistics of a trial from its start to its end, pauses included.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct RobotEventSummary {
    /// Contact statistics of a simulated physical arm; `None` for a timed arm, which has no contacts.
    pub arm: Option<ArmSafetySummary>,
    /// Number of emergency stops by the wizard.
    pub emergency_stops: u64,
    /// Number of aborted robot presses by the reason of aborting; reasons that did not occur are absent.
    pub given_up: BTreeMap<AbortReason, u64>,
    /// Number of times that the wizard held the robot before its next press.
    pub held: u64,
    /// Number of times that the wizard skipped a press of the robot.
    pub skipped: u64,
    /// Number of times that the wizard chose the robot's next press.
    pub driven: u64,
    /// Number of times that the wizard corrected the content of a location.
    pub corrected: u64,
}

/// Safety and contact statistics of a simulated physical arm.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct ArmSafetySummary {
    /// Number of protective stops: the arm stopped because of a contact force.
    pub protective_stops: u64,
    /// Number of stops because a joint did not follow its commanded motion.
    pub faults: u64,
    /// Number of times that somebody touched the arm, including the contacts that stopped it.
    pub contacts: u64,
    /// Largest contact force, in newtons; null without contacts.
    pub peak_force_n: Option<f64>,
    /// Time on the trial's clock during which the arm moved more slowly because of a hand nearby, in seconds.
    pub reduced_s: f64,
    /// Time on the trial's clock during which the arm waited for a hand in its way, in seconds.
    pub safeguard_s: f64,
}

impl ArmSafetySummary {
    /// Counts a contact with the arm, with its force in newtons if the log has the force.
    fn felt(&mut self, force_n: Option<f64>) {
        self.peak_force_n = self.peak_force_n.into_iter().chain(force_n).reduce(f64::max);
    }
}

impl RobotEventSummary {
    /// Number of presses that the robot aborted for a reason; `None` if the reason cannot occur with this kind of arm.
    pub fn given_up(&self, reason: AbortReason) -> Option<u64> {
        let count = self.given_up.get(&reason).copied();
        (self.arm.is_some() || !reason.is_of_physics()).then(|| count.unwrap_or(0))
    }

    /// Adds the robot statistics of another trial to these.
    pub fn add(&mut self, other: &RobotEventSummary) {
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

/// Counts robot events while a recording is replayed.
#[derive(Clone, Debug)]
pub struct RobotEventTally {
    figures: RobotEventSummary,
    /// Reason why the trial ended; `None` before its end.
    pub ended: Option<TrialEndReason>,
    mode: SafetyMode,
    /// Time on the trial's clock up to which the durations of safety modes have been counted.
    clock: SessionTime,
}

impl RobotEventTally {
    /// An empty tally for a trial with this kind of arm.
    pub fn new(arm: ArmKind) -> RobotEventTally {
        let arm = (arm == ArmKind::Physics).then(ArmSafetySummary::default);
        let figures = RobotEventSummary { arm, ..RobotEventSummary::default() };
        RobotEventTally { figures, ended: None, mode: SafetyMode::Normal, clock: SessionTime::ZERO }
    }

    /// Counts an event at this time of the trial's clock; `was_on`: whether the trial had started and not ended before
    /// the event.
    pub fn note(&mut self, event: &Event, clock: SessionTime, was_on: bool) {
        self.pass_time(clock);
        if let Event::RobotSafety { mode, .. } = event {
            self.mode = *mode;
        }
        if was_on {
            self.count(event);
        }
    }

    /// Adds the time since the last event to the duration of the present safety mode.
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
            Event::TrialAborted { .. } => self.ended = Some(TrialEndReason::Aborted),
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

    /// The robot statistics counted so far.
    pub fn into_figures(self) -> RobotEventSummary {
        self.figures
    }
}
