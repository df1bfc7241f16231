//! Starting groups of a study with their orders of conditions; the letters of a group's name stand for conditions.

use std::collections::{BTreeMap, BTreeSet};

use serde::Serialize;

use super::trial_statistics::TrialStatistics;
use tomcom_session::study_arm::StudyArm;

/// A starting group with its order of conditions, as the group's trials show it.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct GroupOrder {
    /// Name of the starting group, with a letter for each trial: "BAC".
    pub group: String,
    /// Planned condition of each trial of the group; `None` for a missing trial.
    pub order: Vec<Option<StudyArm>>,
    /// Number of participants in the starting group.
    pub participants: usize,
}

/// The starting groups of the trials that the analysis includes, sorted by name.
pub fn group_orders(trials: &[TrialStatistics]) -> Vec<GroupOrder> {
    let mut groups: BTreeMap<&str, (BTreeMap<u32, StudyArm>, BTreeSet<&str>)> = BTreeMap::new();
    for trial in trials.iter().filter(|trial| trial.counts()) {
        let (Some(group), Some(period)) = (&trial.group, trial.period) else { continue };
        let (order, participants) = groups.entry(group).or_default();
        order.insert(period, trial.planned_arm);
        participants.insert(&trial.participant);
    }
    let one = |(group, (order, participants)): (&str, (BTreeMap<u32, StudyArm>, BTreeSet<&str>))| GroupOrder {
        group: group.to_string(),
        order: (1..=group.chars().count() as u32).map(|period| order.get(&period).copied()).collect(),
        participants: participants.len(),
    };
    groups.into_iter().map(one).collect()
}

impl GroupOrder {
    /// The starting group as text: "BAC: wizard, unassisted, ToM-Com (2)".
    pub fn describe(&self) -> String {
        let order: Vec<&str> = self.order.iter().map(|arm| arm.map_or("?", StudyArm::title)).collect();
        format!("{}: {} ({})", self.group, order.join(", "), self.participants)
    }
}
