//! Counts of robot events other than presses, and of the wizard's interventions in the robot: in a trial that is
//! replayed, and summed by kind of arm.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

use crate::trial_statistics::TrialStatistics;
use tomcom_core::base::time::SessionTime;
use tomcom_core::communication::Sender;
use tomcom_core::robot::{AbortReason, SafetyMode};
use tomcom_session::Event;
use tomcom_session::event::TrialEndReason;
use tomcom_session::settings::ArmKind;

#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct RobotEventSummary {
    /// Contact statistics of a simulated physical arm; `None` for a timed arm, which has no contacts.
    pub arm: Option<ArmSafetySummary>,
    pub emergency_stops: u64,
    /// Number of aborted robot presses by the reason of aborting; reasons that did not occur are absent.
    pub given_up: BTreeMap<AbortReason, u64>,
    pub held: u64,
    pub skipped: u64,
    pub driven: u64,
    pub corrected: u64,
}

#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct ArmSafetySummary {
    pub protective_stops: u64,
    /// Number of stops because a joint did not follow its commanded motion.
    pub faults: u64,
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

#[derive(Clone, Debug)]
pub struct RobotEventTally {
    pub figures: RobotEventSummary,
    pub ended: Option<TrialEndReason>,
    mode: SafetyMode,
    clock: SessionTime,
}

impl RobotEventTally {
    pub fn new(arm: ArmKind) -> RobotEventTally {
        let arm = arm.has_joints().then(ArmSafetySummary::default);
        let figures = RobotEventSummary { arm, ..RobotEventSummary::default() };
        RobotEventTally { figures, ended: None, mode: SafetyMode::Normal, clock: SessionTime::ZERO }
    }

    /// `clock`: of the trial; `was_on`: whether the trial was on before the event.
    pub fn note(&mut self, event: &Event, clock: SessionTime, was_on: bool) {
        self.pass_time(clock);
        if let Event::RobotSafety { mode, .. } = event {
            self.mode = *mode;
        }
        if was_on {
            self.count(event);
        }
    }

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
}

#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct RobotArmTotals {
    pub kind: ArmKind,
    pub trials: u64,
    #[serde(flatten)]
    pub robot: RobotEventSummary,
}

/// Groups trials by kind of robot arm; kinds without trials are left out.
pub fn by_arm(trials: &[&TrialStatistics]) -> Vec<RobotArmTotals> {
    let of = |name: &str| {
        let mut of_kind = trials.iter().filter(|trial| trial.arm.name() == name).peekable();
        let kind = of_kind.peek()?.arm;
        let mut group = RobotArmTotals { kind, trials: 0, robot: RobotEventSummary::default() };
        for trial in of_kind {
            group.trials += 1;
            group.robot.add(&trial.robot);
        }
        Some(group)
    };
    ["timed", "physics", "ur"].into_iter().filter_map(of).collect()
}
