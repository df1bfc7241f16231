//! Parameters of the human model that were fitted to single persons: whose fitted parameters a recording uses.

use serde::{Deserialize, Serialize};

/// Whose parameters a recording uses, where the file of its human model has parameters of persons.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum ParameterSource {
    /// The recording uses the parameters fitted to its own participant.
    Person,
    /// The recording uses the population's parameters: the file has none of this participant.
    Population,
}
