//! What the robot did in the trials of a study, by kind of arm.

use serde::Serialize;

use super::robot_tally::RobotSummary;
use super::trial::Trial;
use crate::session::settings::ArmKind;

/// The figures of the trials with one kind of arm together.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ArmGroup {
    pub kind: ArmKind,
    pub trials: u64,
    #[serde(flatten)]
    pub robot: RobotSummary,
}

/// By kind of arm, those that occur.
pub fn by_arm(trials: &[&Trial]) -> Vec<ArmGroup> {
    let of = |kind: ArmKind| {
        let mut group = ArmGroup { kind, trials: 0, robot: RobotSummary::default() };
        for trial in trials.iter().filter(|trial| trial.arm == kind) {
            group.trials += 1;
            group.robot.add(&trial.robot);
        }
        (group.trials > 0).then_some(group)
    };
    [ArmKind::Timed, ArmKind::Physics].into_iter().filter_map(of).collect()
}
