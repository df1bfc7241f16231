//! A battery of cohorts: populations of simulated people to whom the assistant's human model was not fitted, to test
//! how well the estimate and the assistant work with other people.

use serde::Deserialize;
use toml::Spanned;

use crate::SessionSpec;
use crate::settings::{Condition, GazeSource};
use tomcom_core::communication::settings::ShadowMode;
use tomcom_people::participant::population::Population;

#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct BatterySpec {
    /// Relative to the battery's file.
    pub session: Spanned<String>,
    /// In the order of the results table.
    #[serde(rename = "cohort")]
    pub cohorts: Vec<CohortSpec>,
}

#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct CohortSpec {
    pub name: Spanned<String>,
    /// `None`: as in the session file.
    pub gaze: Option<Spanned<GazeSource>>,
    /// `None`: as in the session file. Traits that are not named have their defaults.
    pub population: Option<Population>,
}

impl CohortSpec {
    /// The settings of the cohort's simulated trials.
    pub fn settings(&self, session: &SessionSpec, condition: Condition) -> SessionSpec {
        let mut spec = session.clone();
        spec.plan = None;
        spec.trial.condition = condition;
        // Nobody would see the assistant's advice in these trials, so the advice is not computed.
        spec.assistant.shadow = ShadowMode::Off;
        if let Some(gaze) = &self.gaze {
            spec.participant.gaze = *gaze.get_ref();
        }
        if let Some(population) = &self.population {
            spec.participant.population = Some(population.clone());
        }
        spec
    }
}
