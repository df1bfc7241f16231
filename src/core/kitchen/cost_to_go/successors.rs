//! Successor states: the states after single presses, over classes of contents.

use crate::kitchen::{Agent, ButtonAction};

use super::classes::{CompactState, MAX_TARGETS, USELESS};
use super::goal::ServingGoal;
use super::ground::KitchenTables;

/// Calls `visit` with every state after one press, without presses that can never help. Only items in `wanted` (a bit
/// set of items for each target dish) are taken from a storage.
pub fn successors(
    ground: &KitchenTables,
    goal: &ServingGoal,
    state: &CompactState,
    wanted: [u8; MAX_TARGETS],
    mut visit: impl FnMut(CompactState),
) {
    let is_wanted =
        |class: u8| (0..goal.targets.len()).any(|target| goal.fills[target][usize::from(class)] & wanted[target] != 0);
    for agent in Agent::BOTH {
        let hand = ground.hands[agent.index()];
        if state[hand] == 0 {
            for &class in goal.takes[agent.index()].iter().filter(|&&class| is_wanted(class)) {
                let mut next = *state;
                next[hand] = class;
                visit(next);
            }
        }
    }
    for &(agent, action) in &ground.moves {
        let hand = ground.hands[agent.index()];
        let held = state[hand];
        let mut next = *state;
        match action {
            ButtonAction::Use(location) => {
                let location = location.index();
                let there = state[location];
                match (held, there) {
                    (0, 0) => continue,
                    (0, _) => (next[hand], next[location]) = (there, 0),
                    // Useless contents are thrown away rather than put down somewhere.
                    (USELESS, _) => continue,
                    (_, 0) => {
                        if !ground.accepts(location, goal.content[usize::from(held)]) {
                            continue;
                        }
                        (next[hand], next[location]) = (0, held);
                    }
                    _ if location == ground.board => {
                        let stack = goal.stacks[usize::from(there) * goal.content.len() + usize::from(held)];
                        if stack == 0 {
                            continue;
                        }
                        (next[hand], next[location]) = (0, stack);
                    }
                    _ => continue,
                }
            }
            ButtonAction::Process(process) => {
                let place = ground.process_place[usize::from(process)].unwrap_or(hand);
                let result = goal.becomes[usize::from(process)][usize::from(state[place])];
                if result == 0 {
                    continue;
                }
                next[place] = result;
            }
            ButtonAction::Trash if held != 0 => next[hand] = 0,
            _ => continue,
        }
        visit(next);
    }
}
