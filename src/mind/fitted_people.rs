//! A file with parameters of the human model: those of the population, and those of persons who differ from the
//! population.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

use super::choice_parameters::ChoiceParameters;
use super::fitting::HumanModelParameter;
use super::model::{HumanModel, InferenceSettings, LookingModel, PerceptionModel, PriorModel, TransitionModel};
use super::signal_model::SignalModel;

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

/// Content of a file with parameters of the human model.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct HumanModelFile {
    prior: PriorModel,
    perception: PerceptionModel,
    looking: LookingModel,
    transition: TransitionModel,
    decision: ChoiceParameters,
    signal: SignalModel,
    inference: InferenceSettings,
    /// Parameters of single persons; `None` if the file has none.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub people: Option<FittedPeople>,
}

impl HumanModelFile {
    /// The content of a file with these parameters of the population and of persons.
    pub fn new(population: HumanModel, people: Option<FittedPeople>) -> HumanModelFile {
        let HumanModel { prior, perception, looking, transition, decision, signal, inference } = population;
        HumanModelFile { prior, perception, looking, transition, decision, signal, inference, people }
    }

    /// The parameters of the population, which hold for everybody if the file has no persons.
    pub fn population(&self) -> HumanModel {
        let HumanModelFile { prior, perception, looking, transition, decision, signal, inference, .. } = self.clone();
        HumanModel { prior, perception, looking, transition, decision, signal, inference }
    }
}
