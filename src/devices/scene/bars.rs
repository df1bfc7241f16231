//! Bars with the time of their beginning and of their end in their text, which are known when a bar is over: for streams that
//! are made from a log, whose rows need not come in the order of time.

use std::collections::BTreeMap;

use super::entity_content::{EntityData, EntityUpdate};
use super::{SceneUpdate, beliefs, looks, moment_on_clock};
use tomcom_core::base::time::SessionTime;

/// Whether a lane has bars of what happens in a trial.
fn is_bar(entity: &str) -> bool {
    [beliefs::ERRORS, beliefs::SIGNALS, looks::LOOKS].contains(&entity) || entity.starts_with(beliefs::WRONG_BELIEFS)
}

/// The bars that are not over, by their lane.
#[derive(Clone, Debug, Default)]
pub struct TimedBars {
    open: BTreeMap<String, SceneUpdate>,
}

impl TimedBars {
    /// The updates that can be written with this one: without the bars that begin in it, with those that end.
    pub fn take(&mut self, moment: &SceneUpdate) -> Vec<SceneUpdate> {
        let mut over = Vec::new();
        let mut rows = Vec::new();
        for row in &moment.rows {
            let EntityData::State(text, _) = &row.shown else {
                rows.push(row.clone());
                continue;
            };
            if !is_bar(&row.entity) {
                rows.push(row.clone());
                continue;
            }
            over.extend(self.open.remove(&row.entity).map(|open| timed(open, Some(moment.trial))));
            if text.is_empty() {
                rows.push(row.clone());
            } else {
                self.open.insert(row.entity.clone(), SceneUpdate { rows: vec![row.clone()], ..moment.clone() });
            }
        }
        over.push(SceneUpdate { rows, ..moment.clone() });
        over
    }

    /// The bars that last to the end of the recording.
    pub fn finish(self) -> impl Iterator<Item = SceneUpdate> {
        self.open.into_values().map(|open| timed(open, None))
    }
}

fn timed(open: SceneUpdate, until: Option<SessionTime>) -> SceneUpdate {
    let times = match until {
        Some(until) => format!("{} to {}", moment_on_clock(open.trial), moment_on_clock(until)),
        None => format!("from {} on", moment_on_clock(open.trial)),
    };
    let timed = |row: EntityUpdate| match row.shown {
        EntityData::State(text, colour) => {
            EntityUpdate::new(row.entity, EntityData::State(format!("{text} ({times})"), colour))
        }
        shown => EntityUpdate::new(row.entity, shown),
    };
    SceneUpdate { rows: open.rows.into_iter().map(timed).collect(), ..open }
}
