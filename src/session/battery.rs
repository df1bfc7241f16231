//! A battery of cohorts: simulated people whom the assistant's model of the human was not fitted to, to see what the estimate and the
//! assistant are worth with them.

use serde::Deserialize;
use toml::Spanned;

use super::settings::{Condition, GazeSource, SessionSpec};
use crate::communication::settings::Shadow;
use crate::participant::population::Population;

/// A file with a battery of cohorts.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct BatterySpec {
    /// The session file of all cohorts, relative to the battery's file.
    pub session: Spanned<String>,
    /// The cohorts, in the order of the table.
    #[serde(rename = "cohort")]
    pub cohorts: Vec<CohortSpec>,
}

/// One cohort of a battery, by what is other than in the session file.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct CohortSpec {
    /// Its name in the table.
    pub name: Spanned<String>,
    /// Whether there is simulated gaze, if not as in the session file.
    pub gaze: Option<Spanned<GazeSource>>,
    /// The population; what it does not name has its default, as in a session file.
    pub population: Option<Population>,
}

impl CohortSpec {
    /// The settings of the cohort's trials, in which the assistant acts by itself or nobody sends signals.
    pub fn settings(&self, session: &SessionSpec, condition: Condition) -> SessionSpec {
        let mut spec = session.clone();
        spec.plan = None;
        spec.trial.condition = condition;
        // Advice that nobody sees would only take time.
        spec.assistant.shadow = Shadow::Off;
        if let Some(gaze) = &self.gaze {
            spec.participant.gaze = *gaze.get_ref();
        }
        if let Some(population) = &self.population {
            spec.participant.population = Some(population.clone());
        }
        spec
    }
}
