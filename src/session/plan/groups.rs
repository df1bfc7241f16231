//! Starting groups: the possible orders of the conditions.

use serde::Serialize;

use crate::session::condition::Condition;

/// A starting group: an order of the conditions.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct StartingGroup {
    /// "AB": the first condition of the plan comes first.
    pub name: String,
    /// The condition of each trial.
    pub conditions: Vec<Condition>,
}

/// Every order of `count` conditions, as indices; the plan's own order first.
pub fn groups(count: usize) -> Vec<Vec<usize>> {
    if count == 0 {
        return vec![Vec::new()];
    }
    let mut all = Vec::new();
    for shorter in groups(count - 1) {
        for place in (0..count).rev() {
            let mut order = shorter.clone();
            order.insert(place, count - 1);
            all.push(order);
        }
    }
    all.sort();
    all
}
