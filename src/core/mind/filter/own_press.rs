//! The update of the estimate by the human's own press: the human knows which button was pressed and whether the press
//! was effective.
//!
//! The belief is conditioned on effective or ineffective, then transformed by the kitchen's rules. Where one location
//! determines the effect, the update is exact: a Dirichlet restricted to some of its values is a Dirichlet with their
//! alphas. Where hand and location (see [`super::exchange`]) or plate, order and recipe (see [`super::serving`])
//! determine the effect jointly, only the probabilities of classes of contents that the rules treat alike are sampled;
//! the distribution within a class is independent of these probabilities and stays exact.

use crate::kitchen::{Agent, AspectId, ButtonAction, ContentId, Kitchen};
use crate::mind::dirichlet::{Dirichlet, DirichletBelief};

/// Share of the expected distribution that is mixed into every draw, so that conditioning on an observation that is
/// impossible in a draw still gives a proper distribution.
pub const DOUBT: f64 = 1e-6;

/// Restricts a Dirichlet to the values for which `keep` holds, then maps each value by `becomes` (exact).
fn restrict(dirichlet: &Dirichlet, keep: impl Fn(usize) -> bool, becomes: impl Fn(usize) -> usize) -> Dirichlet {
    let mut mean = vec![0.0; dirichlet.mean().len()];
    let mut kept = 0.0;
    for (value, &m) in dirichlet.mean().iter().enumerate().filter(|(value, _)| keep(*value)) {
        kept += m;
        mean[becomes(value)] += m;
    }
    match kept > 0.0 {
        true => Dirichlet::new(mean, dirichlet.precision() * kept),
        false => dirichlet.clone(),
    }
}

/// Updates the estimate by a press whose effect depends on one location; other presses change nothing here.
pub fn learn_alone(kitchen: &Kitchen, belief: &mut DirichletBelief, action: ButtonAction, effective: bool) {
    let hand = AspectId::of_location(kitchen.hands[Agent::Human.index()]);
    let empty = value_of(kitchen, hand, ContentId::EMPTY);
    match action {
        ButtonAction::Take(item) => {
            let taken = value_of(kitchen, hand, item);
            let of_hand = &mut belief.aspects[hand.index()];
            *of_hand = match effective {
                true => restrict(of_hand, |_| true, |_| taken),
                false => restrict(of_hand, |value| value != empty, |value| value),
            };
        }
        ButtonAction::Trash => {
            // The hand is empty afterwards: an effective press emptied the hand, and before an ineffective press it was
            // empty already.
            let of_hand = &mut belief.aspects[hand.index()];
            *of_hand = restrict(of_hand, |_| true, |_| empty);
        }
        ButtonAction::Process(process) => {
            let place = kitchen.processes[usize::from(process)].place;
            let aspect = place.map_or(hand, AspectId::of_location);
            let values = &kitchen.aspects[aspect.index()];
            let result = |value: usize| {
                let made = kitchen.processed(process, ContentId(values.values[value]))?;
                values.index_of(made.0)
            };
            let of_place = &mut belief.aspects[aspect.index()];
            *of_place = restrict(
                of_place,
                |value| result(value).is_some() == effective,
                |value| result(value).unwrap_or(value),
            );
        }
        ButtonAction::Use(_) | ButtonAction::Serve(_) => {}
    }
}

fn value_of(kitchen: &Kitchen, aspect: AspectId, content: ContentId) -> usize {
    kitchen.aspects[aspect.index()].index_of(content.0).unwrap_or(0)
}
