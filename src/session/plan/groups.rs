//! Starting groups of a study: the orders in which participants have the conditions, balanced for carry-over effects
//! between trials.

use serde::Serialize;

use crate::study_arm::StudyArm;

/// A starting group: an order of the study's conditions.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct StartingGroup {
    /// Name of the starting group: "AB" if the first condition of the plan comes first.
    pub name: String,
    /// The study arm of each trial of a participant in this group, in order.
    pub conditions: Vec<StudyArm>,
}

/// The orders of a Williams design (Williams 1949) for `count` conditions, as indices; the plan's own order is first if
/// it is one of them. Every condition is equally often in every position, and equally often directly after every other
/// one. An odd number of conditions needs twice as many orders.
pub fn orders(count: usize) -> Vec<Vec<usize>> {
    if count == 0 {
        return vec![Vec::new()];
    }
    // The sequence 0, 1, n-1, 2, n-2, ...: the differences between neighbours are all different modulo n.
    let first = |place: usize| if place % 2 == 1 { place.div_ceil(2) } else { (count - place / 2) % count };
    let mut all: Vec<Vec<usize>> =
        (0..count).map(|shift| (0..count).map(|place| (first(place) + shift) % count).collect()).collect();
    if count % 2 == 1 && count > 1 {
        let mirrored: Vec<Vec<usize>> = all.iter().map(|order| order.iter().rev().copied().collect()).collect();
        all.extend(mirrored);
    }
    all.sort();
    all
}
