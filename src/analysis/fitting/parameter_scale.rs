//! The scale on which parameters are searched: points on it, the human models that they stand for, and the bounds of a search.

use crate::mind::fitting::HumanModelParameter;
use crate::mind::model::HumanModel;
use crate::session::ranges;

/// The model with these parameters at a point on the scale of the fit, and otherwise as `base`.
pub fn model_at(base: &HumanModel, parameters: &[HumanModelParameter], at: &[f64]) -> HumanModel {
    let mut model = base.clone();
    parameters.iter().zip(at).for_each(|(parameter, &scaled)| parameter.set(&mut model, parameter.from_scale(scaled)));
    model
}

/// The point on the scale of the fit that a model stands at.
pub fn point_of(model: &HumanModel, parameters: &[HumanModelParameter]) -> Vec<f64> {
    parameters.iter().map(|one| one.to_scale(one.get(model))).collect()
}

/// Bounds of the search, on the scale of the fit.
pub fn bounds_of(parameters: &[HumanModelParameter]) -> Vec<[f64; 2]> {
    parameters.iter().map(|one| one.bounds().map(|end| one.to_scale(end))).collect()
}

/// Whether there can be people with these parameters.
pub fn is_possible(model: &HumanModel) -> bool {
    ranges::check_human_model(model).is_ok() && model.fault().is_none()
}
