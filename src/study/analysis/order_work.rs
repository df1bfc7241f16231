//! Effort for the orders of a trial: time from an order's appearance to its serving, and presses beyond the least
//! number.

use std::collections::BTreeMap;

use tomcom_core::base::time::SessionTime;
use tomcom_core::kitchen::cost_to_go::{CostToGo, ProofBudget};
use tomcom_core::kitchen::{Kitchen, KitchenChange, LocationId};
use tomcom_session::wizard_log::clock_at;
use tomcom_session::{Session, TimelineEvent};

/// Seconds from the appearance of each served order to its serving, on the trial's clock.
pub fn order_times(session: &Session) -> Vec<f64> {
    let mut shown: BTreeMap<LocationId, SessionTime> = BTreeMap::new();
    let mut times = Vec::new();
    for entry in &session.timeline {
        match entry.what {
            TimelineEvent::OrderShown { order } => {
                shown.insert(order, entry.time);
            }
            TimelineEvent::Served { order } => {
                let since = shown.remove(&order);
                times.extend(since.map(|since| clock_at(session, entry.time).secs_since(clock_at(session, since))));
            }
            _ => {}
        }
    }
    times
}

/// Running sum of the regret of both agents' presses, that is, of the presses that were lost.
#[derive(Clone, Copy, Debug, Default)]
pub struct RegretSum {
    lost: i64,
}

impl RegretSum {
    /// Adds the regret of the press that caused this change of the kitchen; other changes have no regret.
    pub fn note(&mut self, kitchen: &Kitchen, cost: &mut CostToGo, change: &KitchenChange) {
        let KitchenChange::Press { press, .. } = change else { return };
        let recipes = kitchen.true_recipes();
        self.lost += match press.before == press.after {
            true => 1,
            false => {
                let mut budget = ProofBudget::default();
                let mut least = |state| i64::from(cost.proven_all_orders(state, &recipes, &mut budget).presses);
                1 + least(press.after) - least(press.before)
            }
        };
    }

    /// Regret (lost presses) per served order; `None` if no order was served.
    pub fn per_order(&self, served: u64) -> Option<f64> {
        (served > 0).then(|| self.lost as f64 / served as f64)
    }
}
