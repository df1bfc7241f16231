//! Why a press of the human was an error, in words. The reason follows from the true state and recipes, the press and
//! the human's best press: it is the same live, in replays, and for raters, and tells nothing about beliefs.

use super::order_needs::{ItemProgress, NeededItem, OrderNeeds, becomes, order_needs};
use super::{event_words, wording};
use tomcom_core::base::text::count;
use tomcom_core::base::time::SessionTime;
use tomcom_core::kitchen::rules::NoEffectReason;
use tomcom_core::kitchen::{Agent, ButtonAction, ContentId, Kitchen, LocationId, State};
use tomcom_core::measures::JudgedPress;

/// An error of the human with its reason.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ExplainedError {
    /// Session time of the press.
    pub time: SessionTime,
    /// "take salmon", "cooking pot".
    pub press: String,
    /// "order 1 needs tuna", "the hand is empty".
    pub why: String,
    /// The reason with cost and cause, which raters are not shown.
    pub with_cause: String,
}

impl ExplainedError {
    /// The errors among judged presses. Their reasons need no cost to go beyond that of the judgements.
    pub fn among<'a>(
        kitchen: &'a Kitchen,
        judged: &'a [JudgedPress],
    ) -> impl Iterator<Item = ExplainedError> + use<'a> {
        judged.iter().filter(|press| press.verdict.error).map(move |press| ExplainedError {
            time: press.time,
            press: wording::button(kitchen, Agent::Human, press.button),
            why: why(kitchen, press),
            with_cause: with_cause(kitchen, press),
        })
    }
}

/// Why this press was an error, what it costs, and its cause where that is known: "order 1 has nori already; costs 2
/// presses; cause: false belief about robot hand". Not for raters, who find the causes.
pub fn with_cause(kitchen: &Kitchen, press: &JudgedPress) -> String {
    let (why, cost) = (why(kitchen, press), event_words::error(kitchen, press));
    let cost = cost.strip_prefix("error, ").unwrap_or(&cost);
    // Where there is no other reason, the cost is the reason.
    if cost.starts_with(&why) { cost.to_string() } else { format!("{why}; {cost}") }
}

/// Why this press was an error: why it had no effect; else what the orders need instead; else the better press.
pub fn why(kitchen: &Kitchen, press: &JudgedPress) -> String {
    let (state, action) = (press.before, kitchen.button(Agent::Human, press.button).action);
    let orders = order_needs(kitchen, state);
    match kitchen.no_effect(state, Agent::Human, press.button) {
        Some((NoEffectReason::NotServed, order)) => return not_served(kitchen, state, &orders, order),
        Some((why, about)) => return wording::because(kitchen, why, about, kitchen.content_label(state, about)),
        None => {}
    }
    let hand = kitchen.hands[Agent::Human.index()];
    let held = state.content(hand);
    let told = match action {
        ButtonAction::Take(item) => taken(kitchen, &orders, item),
        ButtonAction::Process(process) => {
            let place = kitchen.processes[usize::from(process)].place.unwrap_or(hand);
            kitchen.processed(process, state.content(place)).and_then(|made| made_for_nothing(kitchen, &orders, made))
        }
        ButtonAction::Use(place) if place == kitchen.board && !held.is_empty() => {
            stacked(kitchen, state, &orders, place, held)
        }
        ButtonAction::Trash => needed_by(kitchen, &orders, hand, held),
        ButtonAction::Use(_) | ButtonAction::Serve(_) => None,
    };
    told.unwrap_or_else(|| match press.verdict.best {
        Some(best) => format!("{} would be better", wording::button(kitchen, Agent::Human, best)),
        None => format!("costs {}", count(press.verdict.excess.unsigned_abs(), "press", "presses")),
    })
}

fn label(kitchen: &Kitchen, location: LocationId) -> String {
    kitchen.location(location).label()
}

fn word(kitchen: &Kitchen, content: ContentId) -> &str {
    &kitchen.content(content).wording
}

/// "cut tuna + nori".
fn list(kitchen: &Kitchen, items: impl Iterator<Item = ContentId>) -> String {
    items.map(|item| word(kitchen, item)).collect::<Vec<_>>().join(" + ")
}

/// Whether an order's recipe has this item.
fn has(needs: &OrderNeeds, item: ContentId) -> bool {
    needs.items.iter().any(|needed| needed.item == item)
}

/// Whether an item becomes this item of a recipe, or is it.
fn serves(kitchen: &Kitchen, content: ContentId, item: ContentId) -> bool {
    content == item || becomes(kitchen, content, item)
}

/// Why an ingredient is not to be taken from the storage: it is there already, an order needs another one in its place, or
/// no order uses it.
fn taken(kitchen: &Kitchen, orders: &[OrderNeeds], item: ContentId) -> Option<String> {
    let name = |item: ContentId| {
        let storage = kitchen.storages.iter().find(|storage| serves(kitchen, storage.item, item));
        storage.map_or_else(|| word(kitchen, item).to_string(), |storage| storage.label.clone())
    };
    let all = || orders.iter().flat_map(|needs| needs.items.iter().map(move |needed| (needs.order, needed)));
    let is_missing = |needed: &NeededItem| needed.progress == ItemProgress::Missing;
    if all().any(|(_, needed)| is_missing(needed) && serves(kitchen, item, needed.item)) {
        return None;
    }
    if let Some((order, needed)) = all().find(|(_, needed)| serves(kitchen, item, needed.item)) {
        let (order, name) = (label(kitchen, order), name(item));
        return Some(match needed.progress {
            ItemProgress::Ready(at) | ItemProgress::InWork(at) => {
                format!("{name} for {order} is there: {}", label(kitchen, at))
            }
            ItemProgress::Stacked | ItemProgress::Missing => format!("{order} has {name} already"),
        });
    }
    // Items that cannot be stacked on each other stand in each other's place.
    let forms: Vec<ContentId> = (0..kitchen.contents.len())
        .map(|index| ContentId(index as u8))
        .filter(|&to| serves(kitchen, item, to))
        .collect();
    let is_instead = |needed: &NeededItem| forms.iter().all(|&form| kitchen.stacked(needed.item, form).is_none());
    // With several orders nobody knows which of them the press was for.
    let instead = all().find(|(_, needed)| is_missing(needed) && is_instead(needed)).filter(|_| orders.len() == 1);
    Some(match instead {
        Some((order, needed)) => format!("{} needs {}", label(kitchen, order), name(needed.item)),
        None => format!("no order needs {}", name(item)),
    })
}

/// Why an item is not to be made: no order has a use for it.
fn made_for_nothing(kitchen: &Kitchen, orders: &[OrderNeeds], made: ContentId) -> Option<String> {
    let is_open = |progress: ItemProgress| !matches!(progress, ItemProgress::Stacked | ItemProgress::Ready(_));
    let mut items = orders.iter().flat_map(|needs| &needs.items);
    let is_needed = items.any(|needed| is_open(needed.progress) && serves(kitchen, made, needed.item));
    (!is_needed).then(|| format!("no order needs {}", word(kitchen, made)))
}

/// Why a content does not belong on the stack: no order's recipe has these items together.
fn stacked(
    kitchen: &Kitchen,
    state: State,
    orders: &[OrderNeeds],
    board: LocationId,
    held: ContentId,
) -> Option<String> {
    let below = state.content(board);
    let stack = if below.is_empty() { held } else { kitchen.stacked(below, held)? };
    let stack = &kitchen.content(stack).items;
    if orders.iter().any(|needs| stack.iter().all(|&item| has(needs, item))) {
        return None;
    }
    // The order that the stack is nearest to; ties go to the upper one.
    let fitting = |needs: &&OrderNeeds| stack.iter().filter(|&&item| has(needs, item)).count();
    let nearest = orders.iter().rev().max_by_key(fitting).filter(|needs| fitting(needs) > 0 || orders.len() == 1);
    let put = &kitchen.content(held).items;
    let Some(nearest) = nearest else { return Some(format!("no order needs {}", word(kitchen, held))) };
    let wrong: Vec<ContentId> = put.iter().copied().filter(|&item| !has(nearest, item)).collect();
    if wrong.is_empty() {
        return Some(format!("it fits no order with {}", word(kitchen, below)));
    }
    Some(instead(kitchen, nearest, &wrong))
}

/// "order 1 needs shaped rice, not cooked rice": the order's items that the wrong ones could stand for, else all that
/// are missing.
fn instead(kitchen: &Kitchen, needs: &OrderNeeds, wrong: &[ContentId]) -> String {
    let of_ingredient = |item: ContentId| kitchen.content(item).ingredient;
    let open =
        || needs.items.iter().filter(|needed| needed.progress != ItemProgress::Stacked).map(|needed| needed.item);
    let alike = open().filter(|&item| wrong.iter().any(|&other| of_ingredient(other) == of_ingredient(item)));
    let alike: Vec<ContentId> = alike.collect();
    let right: Vec<ContentId> = if alike.is_empty() { open().collect() } else { alike };
    let (order, wrong) = (label(kitchen, needs.order), list(kitchen, wrong.iter().copied()));
    format!("{order} needs {}, not {wrong}", list(kitchen, right.into_iter()))
}

/// What the plate's content lacks, or has too much, for the order.
fn not_served(kitchen: &Kitchen, state: State, orders: &[OrderNeeds], order: LocationId) -> String {
    let on_plate = &kitchen.content(state.content(kitchen.plate)).items;
    let Some(needs) = orders.iter().find(|needs| needs.order == order) else {
        return format!("{} asks for no dish", label(kitchen, order));
    };
    let missing = needs.items.iter().map(|needed| needed.item).filter(|item| !on_plate.contains(item));
    let missing = list(kitchen, missing);
    let extra: Vec<ContentId> = on_plate.iter().copied().filter(|&item| !has(needs, item)).collect();
    match extra.is_empty() {
        true => format!("{} needs {missing}", label(kitchen, order)),
        false => format!("{} needs {missing}, not {}", label(kitchen, order), list(kitchen, extra.into_iter())),
    }
}

/// That an order counts on what the hand holds.
fn needed_by(kitchen: &Kitchen, orders: &[OrderNeeds], hand: LocationId, held: ContentId) -> Option<String> {
    let counts_on = |needs: &&OrderNeeds| {
        let in_hand = [ItemProgress::Ready(hand), ItemProgress::InWork(hand)];
        let stack = &kitchen.content(held).items;
        let is_its_stack = stack.len() > 1 && stack.iter().all(|&item| has(needs, item));
        is_its_stack || needs.items.iter().any(|needed| in_hand.contains(&needed.progress))
    };
    let needs = orders.iter().find(counts_on)?;
    Some(format!("{} needs {}", label(kitchen, needs.order), word(kitchen, held)))
}
