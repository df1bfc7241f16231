//! A file with parameters of the human model: those of the population, and those of persons who differ from the
//! population.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

use super::choice_parameters::GivenChoice;
use super::fitting::HumanModelParameter;
use super::model::{
    GivenHumanModel, GivenInference, GivenLooking, GivenPerception, GivenPrior, GivenTransition, HumanModel,
    HumanModelName,
};
use super::signal_model::GivenSignal;

/// Fitted parameters of persons by the persons' codes; parameters that a person's table leaves out are the
/// population's.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct FittedPeople(pub BTreeMap<String, BTreeMap<HumanModelParameter, f64>>);

impl FittedPeople {
    /// Sets in a model with the population's parameters those of the person with this code. Returns whether there are
    /// any.
    pub fn apply(&self, code: &str, model: &mut HumanModel) -> bool {
        let Some(own) = self.0.get(code) else { return false };
        own.iter().for_each(|(parameter, value)| parameter.set(model, *value));
        true
    }

    /// Removes this parameter of all persons, so that everybody has the population's value.
    pub fn forget(&mut self, parameter: HumanModelParameter) {
        self.0.values_mut().for_each(|own| {
            own.remove(&parameter);
        });
    }
}

/// Content of a file with parameters of the human model: those of the population, and those of persons.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(from = "GivenHumanModelFile")]
pub struct HumanModelFile {
    /// The parameters of the population, which hold for everybody if the file has no persons.
    #[serde(flatten)]
    pub population: HumanModel,
    /// Parameters of single persons; `None` if the file has none.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub people: Option<FittedPeople>,
}

/// What a file with parameters of the human model gives.
#[derive(Clone, Debug, Default, Deserialize)]
#[serde(default, deny_unknown_fields)]
struct GivenHumanModelFile {
    model: HumanModelName,
    prior: GivenPrior,
    perception: GivenPerception,
    looking: GivenLooking,
    transition: GivenTransition,
    decision: GivenChoice,
    signal: GivenSignal,
    inference: GivenInference,
    people: Option<FittedPeople>,
}

impl From<GivenHumanModelFile> for HumanModelFile {
    fn from(file: GivenHumanModelFile) -> HumanModelFile {
        let GivenHumanModelFile { model, prior, perception, looking, transition, decision, signal, .. } = file;
        let inference = file.inference;
        let given = GivenHumanModel { model, prior, perception, looking, transition, decision, signal, inference };
        HumanModelFile { population: given.into(), people: file.people }
    }
}
