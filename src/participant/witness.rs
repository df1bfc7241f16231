//! Record of a participant's beliefs at a press, and of the cause of the press.

use super::decision::good_presses;
use super::true_beliefs::ParticipantBeliefs;
use crate::kitchen::cost_to_go::CostToGo;
use crate::kitchen::{AspectId, AspectKind, ButtonId, ContentId, Kitchen, Recipes, State};
use crate::mind::{AspectBelief, BeliefWitness, WORTH_TELLING};

/// Records every aspect: its most probable value, the probability of the true value, and all other probabilities worth logging.
pub fn witness(kitchen: &Kitchen, beliefs: &ParticipantBeliefs, state: State, cause: String) -> BeliefWitness {
    let of = |index: usize| {
        let (aspect, id) = (&kitchen.aspects[index], AspectId(index as u8));
        let values = aspect.labels.iter().zip(beliefs.distribution(id)).filter(|(_, p)| **p >= WORTH_TELLING);
        AspectBelief {
            aspect: aspect.name.clone(),
            believes: aspect.labels[beliefs.most_likely(id)].clone(),
            p_truth: rounded(beliefs.p_truth(kitchen, state, id)),
            values: values.map(|(label, &p)| (label.clone(), rounded(p))).collect(),
        }
    };
    BeliefWitness { aspects: (0..kitchen.aspects.len()).map(of).collect(), cause }
}

/// Rounds a probability to six decimals for the log.
fn rounded(p: f64) -> f64 {
    (p * 1e6).round() / 1e6
}

/// The cause of a useful press for the recording: "goal", or the belief without which the press would not seem useful.
pub fn cause(
    kitchen: &Kitchen,
    cost: &mut CostToGo,
    beliefs: &ParticipantBeliefs,
    state: State,
    button: ButtonId,
) -> String {
    let recipes = kitchen.true_recipes();
    let is_good = |cost: &mut CostToGo, state: State, recipes: &Recipes| {
        good_presses(kitchen, cost, state, recipes).iter().any(|(good, _)| *good == button)
    };
    if is_good(cost, state, &recipes) {
        return "as it is".to_string();
    }
    let (believed, held) = beliefs.point(kitchen);
    let mut wrong: Vec<String> = Vec::new();
    for (index, aspect) in kitchen.aspects.iter().enumerate() {
        let id = AspectId(index as u8);
        let value = beliefs.most_likely(id);
        if value == kitchen.true_value(state, id) {
            continue;
        }
        let description = format!("believes {}: {}", aspect.name, aspect.labels[value]);
        let (mut mended, mut recalled) = (believed, held);
        match aspect.kind {
            AspectKind::Location(location) => mended.set_code(location, state.code(location)),
            AspectKind::Recipe(dish) => recalled.set(dish, ContentId(aspect.values[0])),
        }
        if !is_good(cost, mended, &recalled) {
            return description;
        }
        wrong.push(description);
    }
    match wrong.is_empty() {
        true => "as it is, by a detour".to_string(),
        false => wrong.join(", "),
    }
}
