//! The unbounded scale on which parameters are searched: points on that scale, the human models that the points stand
//! for, and the bounds of a search.

use tomcom_core::mind::fitting::HumanModelParameter;
use tomcom_core::mind::model::HumanModel;
use tomcom_session::ranges;

/// The human model whose `parameters` have the values of a point on the scale of the fit; other parameters as in
/// `base`.
pub fn model_at(base: &HumanModel, parameters: &[HumanModelParameter], at: &[f64]) -> HumanModel {
    let mut model = base.clone();
    parameters.iter().zip(at).for_each(|(parameter, &scaled)| parameter.set(&mut model, parameter.from_scale(scaled)));
    model
}

/// The point on the scale of the fit that stands for the parameters of a human model.
pub fn point_of(model: &HumanModel, parameters: &[HumanModelParameter]) -> Vec<f64> {
    parameters.iter().map(|one| one.to_scale(one.get(model))).collect()
}

/// Bounds of the search for each parameter, on the scale of the fit.
pub fn bounds_of(parameters: &[HumanModelParameter]) -> Vec<[f64; 2]> {
    parameters.iter().map(|one| one.bounds().map(|end| one.to_scale(end))).collect()
}

/// Whether the parameters are valid, that is, whether a human model with these parameters is possible.
pub fn is_possible(model: &HumanModel) -> bool {
    ranges::check_human_model(model).is_ok() && model.fault().is_none()
}
