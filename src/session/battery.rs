//! A battery of cohorts: populations of simulated people to whom the assistant's human model was not fitted, to test
//! how well the estimate and the assistant work with other people.

use serde::Deserialize;
use toml::Spanned;

use crate::SessionSpec;
use crate::settings::{Condition, GazeSource};
use tomcom_core::communication::settings::ShadowMode;
use tomcom_people::participant::population::Population;

/// A file with a battery of cohorts (populations of simulated people).
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct BatterySpec {
    /// The session file of all cohorts, relative to the battery's file.
    pub session: Spanned<String>,
    /// The cohorts of simulated people, in the order of the results table.
    #[serde(rename = "cohort")]
    pub cohorts: Vec<CohortSpec>,
}

/// A cohort of a battery: the population of its simulated people, and other differences from the session file.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct CohortSpec {
    /// Name of the cohort in the results table.
    pub name: Spanned<String>,
    /// The cohort's source of gaze, if it differs from that of the session file.
    pub gaze: Option<Spanned<GazeSource>>,
    /// The population of simulated people in the cohort; traits that are not named have their defaults, as in session
    /// files.
    pub population: Option<Population>,
}

impl CohortSpec {
    /// The settings of the cohort's simulated trials, in which the assistant acts by itself or nobody sends signals.
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
