//! What a participant believes when it presses, and why it presses what it presses, for the record.

use super::beliefs::ParticipantBeliefs;
use super::decision::good_presses;
use crate::kitchen::cost_to_go::CostToGo;
use crate::kitchen::{AspectId, AspectKind, ButtonId, ContentId, Kitchen, Recipes, State};
use crate::mind::{AspectBelief, BeliefWitness, WORTH_TELLING};

/// Writes down every aspect: the value held most likely, the probability that is given to the truth, and those of all
/// values that are worth telling.
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

/// Six digits are enough for a probability in a log.
fn rounded(p: f64) -> f64 {
    (p * 1e6).round() / 1e6
}

/// Why the person presses what it believes to help: because it does, or because of the belief without which it would not
/// seem to.
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
        let said = format!("believes {}: {}", aspect.name, aspect.labels[value]);
        let (mut mended, mut recalled) = (believed, held);
        match aspect.kind {
            AspectKind::Location(location) => mended.set_code(location, state.code(location)),
            AspectKind::Recipe(dish) => recalled.set(dish, ContentId(aspect.values[0])),
        }
        if !is_good(cost, mended, &recalled) {
            return said;
        }
        wrong.push(said);
    }
    match wrong.is_empty() {
        true => "as it is, by a detour".to_string(),
        false => wrong.join(", "),
    }
}
