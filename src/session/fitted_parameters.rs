//! Parameters of the human model that were fitted to single persons: which person's a recording uses.

use serde::{Deserialize, Serialize};

/// Whose parameters a recording uses, where the file of its human model has parameters of persons.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum ParametersOf {
    /// The participant's own.
    Person,
    /// The population's: the file has none of this participant.
    Population,
}
