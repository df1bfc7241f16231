//! Robot statistics of a study's trials, grouped by kind of robot arm.

use serde::Serialize;

use super::robot_tally::RobotEventSummary;
use super::trial_statistics::TrialStatistics;
use tomcom_session::settings::ArmKind;

/// Robot statistics summed over the trials with one kind of robot arm.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct RobotArmTotals {
    /// Kind of the robot's arm: timed or physical.
    pub kind: ArmKind,
    /// Number of trials with this kind of robot arm.
    pub trials: u64,
    /// Sums of the robot statistics over these trials.
    #[serde(flatten)]
    pub robot: RobotEventSummary,
}

/// Groups trials by kind of robot arm; kinds without trials are left out.
pub fn by_arm(trials: &[&TrialStatistics]) -> Vec<RobotArmTotals> {
    let of = |kind: ArmKind| {
        let mut group = RobotArmTotals { kind, trials: 0, robot: RobotEventSummary::default() };
        for trial in trials.iter().filter(|trial| trial.arm == kind) {
            group.trials += 1;
            group.robot.add(&trial.robot);
        }
        (group.trials > 0).then_some(group)
    };
    [ArmKind::Timed, ArmKind::Physics].into_iter().filter_map(of).collect()
}
