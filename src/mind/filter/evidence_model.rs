//! The models that define the likelihood of what the human does.

use super::order_focus::OrderFocus;
use crate::kitchen::Kitchen;
use crate::mind::choice::ChoiceModel;
use crate::mind::model::InferenceSettings;

/// The models that define the likelihood of an action of the human.
pub struct EvidenceModel<'a> {
    /// The kitchen, with the rules of its buttons.
    pub kitchen: &'a Kitchen,
    /// The human's choice model.
    pub choice: &'a ChoiceModel,
    /// Sample sizes of the inference, and settings for which evidence the inference uses.
    pub inference: &'a InferenceSettings,
    /// For each button of the human, the bit set of locations at which the human looks before the press.
    pub watched: &'a [u32],
    /// The expected lapse (share of slips) of this person; `None`: the lapse of the choice model.
    pub lapse: Option<f64>,
    /// Which orders the human considers.
    pub focus: &'a OrderFocus,
}
