//! What the human learns from its own press: it knows what it pressed and whether that had an effect.
//!
//! Its belief is conditioned on effect or no effect, and moved on by the rules. Where one location decides, that is exact:
//! a Dirichlet that is restricted to some of its values is a Dirichlet of their alphas. Where hand and location decide
//! together (see [`super::exchange`]), or plate, order and recipe (see [`super::serving`]), only the shares of the kinds of contents
//! that the rules treat alike are drawn; how a kind's share is divided among its contents is independent of that and stays
//! exactly as it is.

use crate::kitchen::{Agent, AspectId, ButtonAction, ContentId, Kitchen};
use crate::mind::dirichlet::{Dirichlet, DirichletBelief};

/// So much of every belief is doubt, spread as expected: what is left when something happens that was held impossible.
pub const DOUBT: f64 = 1e-6;

/// Restricts a Dirichlet to the values that `keep`, and lets each become another: exact.
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

/// Learns from a press that works at one location alone; whether it was one.
pub fn learn_alone(kitchen: &Kitchen, belief: &mut DirichletBelief, action: ButtonAction, effective: bool) -> bool {
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
            // It is empty now, or was so before.
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
        ButtonAction::Use(_) | ButtonAction::Serve(_) => return false,
    }
    true
}

fn value_of(kitchen: &Kitchen, aspect: AspectId, content: ContentId) -> usize {
    kitchen.aspects[aspect.index()].index_of(content.0).unwrap_or(0)
}
