//! What each order needs, and what of it is there already: on its place, ready elsewhere, or in work.

use tomcom_core::kitchen::{ContentId, DishId, Kitchen, LocationId, LocationKind, State};

/// Largest number of processing steps from an ingredient's storage to an item of a dish that is looked for.
const MAX_STEPS: u32 = 4;

/// An order with the items of its true recipe.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct OrderNeeds {
    pub order: LocationId,
    pub dish: DishId,
    /// In the order of the recipe file.
    pub items: Vec<NeededItem>,
}

/// An item of an order's recipe.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct NeededItem {
    pub item: ContentId,
    pub progress: ItemProgress,
}

/// How far an item of an order is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ItemProgress {
    /// In the order's stack.
    Stacked,
    /// Ready at this location, but not in the stack.
    Ready(LocationId),
    /// This location holds what becomes the item by processing.
    InWork(LocationId),
    Missing,
}

/// The needs of all orders. What is there counts for one item only: first for the upper order, and what is ready
/// before what is in work.
pub fn order_needs(kitchen: &Kitchen, state: State) -> Vec<OrderNeeds> {
    let mut free: Vec<(LocationId, ContentId)> = kitchen
        .location_ids()
        .filter(|&location| kitchen.location(location).kind != LocationKind::Order)
        .map(|location| (location, state.content(location)))
        .filter(|(_, content)| !content.is_empty())
        .collect();
    let mut orders: Vec<OrderNeeds> = kitchen
        .wanted(state)
        .map(|(order, dish)| {
            let items = &kitchen.content(kitchen.dish(dish).stack()).items;
            let items = items.iter().map(|&item| NeededItem { item, progress: ItemProgress::Missing }).collect();
            OrderNeeds { order, dish, items }
        })
        .collect();
    for needs in &mut orders {
        let fits = |&(location, content): &(LocationId, ContentId)| {
            let content = kitchen.content(content);
            let is_base = content.is_stack() || location == kitchen.board || location == kitchen.plate;
            is_base && content.items.iter().all(|item| needs.items.iter().any(|needed| needed.item == *item))
        };
        // Of several stacks that fit, the order gets the one with most items.
        let size = |index: &usize| kitchen.content(free[*index].1).items.len();
        let found =
            (0..free.len()).filter(|&index| fits(&free[index])).max_by_key(|index| (size(index), free.len() - index));
        let Some(found) = found else { continue };
        let (_, stack) = free.swap_remove(found);
        for needed in &mut needs.items {
            if kitchen.content(stack).items.contains(&needed.item) {
                needed.progress = ItemProgress::Stacked;
            }
        }
        free.sort_by_key(|(location, _)| *location);
    }
    for is_ready in [true, false] {
        for needed in orders.iter_mut().flat_map(|needs| &mut needs.items) {
            if needed.progress != ItemProgress::Missing {
                continue;
            }
            let serves = |&(_, content): &(LocationId, ContentId)| match is_ready {
                true => content == needed.item,
                false => becomes(kitchen, content, needed.item),
            };
            if let Some(found) = free.iter().position(serves) {
                let (location, _) = free.remove(found);
                needed.progress = if is_ready { ItemProgress::Ready(location) } else { ItemProgress::InWork(location) };
            }
        }
    }
    orders
}

/// Whether processing makes this item of the content, in one or more steps.
pub fn becomes(kitchen: &Kitchen, content: ContentId, item: ContentId) -> bool {
    fn within(kitchen: &Kitchen, content: ContentId, item: ContentId, steps: u32) -> bool {
        steps > 0
            && kitchen
                .processes
                .iter()
                .flat_map(|process| &process.steps)
                .any(|&(from, to)| from == content && (to == item || within(kitchen, to, item, steps - 1)))
    }
    within(kitchen, content, item, MAX_STEPS)
}
