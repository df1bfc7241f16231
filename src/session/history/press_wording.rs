//! Wording of what a press took, put or made.

use tomcom_core::kitchen::{Agent, ButtonAction, ButtonId, Kitchen, LocationId, State};

/// What a press with an effect took, put or made, in words: "takes cooked rice", "puts nori"; `None` where
/// the button's name says it. The states are those before and after the press.
pub(super) fn effect(
    kitchen: &Kitchen,
    agent: Agent,
    button: ButtonId,
    (before, after): (State, State),
) -> Option<String> {
    let content = |state: State, at: LocationId| kitchen.content_label(state, at);
    let hand = kitchen.hands[agent.index()];
    match kitchen.button(agent, button).action {
        ButtonAction::Take(_) => None,
        ButtonAction::Use(_) if before.content(hand).is_empty() => Some(format!("takes {}", content(after, hand))),
        ButtonAction::Use(place) if before.content(place).is_empty() => Some(format!("puts {}", content(before, hand))),
        ButtonAction::Use(_) => Some(format!("stacks {}", content(before, hand))),
        ButtonAction::Process(process) => {
            let place = kitchen.processes[usize::from(process)].place.unwrap_or(hand);
            Some(format!("makes {}", content(after, place)))
        }
        ButtonAction::Trash => Some(format!("discards {}", content(before, hand))),
        ButtonAction::Serve(order) => Some(format!("serves {}", content(before, order))),
    }
}
