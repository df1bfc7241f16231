//! A file with parameters of the human model: those of the population, and those in which persons differ from it.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

use super::choice_parameters::ChoiceParameters;
use super::fitting::HumanModelParameter;
use super::model::{
    AdaptModel, HumanModel, InferenceSettings, LookingModel, PerceptionModel, PriorModel, TransitionModel,
};
use super::signal_model::SignalModel;

/// Parameters of persons by their codes; what a person's table leaves out is as in the population.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct FittedPeople(pub BTreeMap<String, BTreeMap<HumanModelParameter, f64>>);

impl FittedPeople {
    /// Gives a model of the population the parameters of the person with this code. Returns whether there are any.
    pub fn apply(&self, code: &str, model: &mut HumanModel) -> bool {
        let Some(own) = self.0.get(code) else { return false };
        own.iter().for_each(|(parameter, value)| parameter.set(model, *value));
        true
    }

    /// Forgets this parameter of all persons: everybody has that of the population.
    pub fn forget(&mut self, parameter: HumanModelParameter) {
        self.0.values_mut().for_each(|own| {
            own.remove(&parameter);
        });
    }
}

/// What a file with parameters of the human model has.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct HumanModelFile {
    prior: PriorModel,
    perception: PerceptionModel,
    looking: LookingModel,
    transition: TransitionModel,
    decision: ChoiceParameters,
    signal: SignalModel,
    #[serde(skip_serializing_if = "AdaptModel::is_off")]
    adapt: AdaptModel,
    inference: InferenceSettings,
    /// Parameters of persons, if the file has any.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub people: Option<FittedPeople>,
}

impl HumanModelFile {
    /// A file with these parameters of the population and of persons.
    pub fn new(population: HumanModel, people: Option<FittedPeople>) -> HumanModelFile {
        let HumanModel { prior, perception, looking, transition, decision, signal, adapt, inference } = population;
        HumanModelFile { prior, perception, looking, transition, decision, signal, adapt, inference, people }
    }

    /// The parameters of the population, which are everybody's in a file without persons.
    pub fn population(&self) -> HumanModel {
        let HumanModelFile { prior, perception, looking, transition, decision, signal, adapt, inference, .. } =
            self.clone();
        HumanModel { prior, perception, looking, transition, decision, signal, adapt, inference }
    }
}
