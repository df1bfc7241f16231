//! What each order needs, and what of it is there already: on its place, ready elsewhere, or in work; once all is there,
//! which step is left.
//!
//! Two orders can need the same content, and it counts for one of them only. It stays with that order as it is moved,
//! stacked and processed, as long as it can still become something that the order needs; so no tick moves unless
//! something is moved. What is new counts for the order that a stack was begun for, else for the older one.

use crate::{TimelineEntry, TimelineEvent};
use tomcom_core::kitchen::state::MAX_LOCATIONS;
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
    /// Once nothing is missing or in work.
    pub last_step: Option<LastStep>,
    /// Whether a stack was begun for it, and for no other order: it is worked on.
    pub is_begun: bool,
}

/// The next of the steps from an order's items to its served dish.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LastStep {
    /// Items are ready, but not in the stack.
    Stack,
    /// The whole stack is at this location, not on the plate.
    Plate(LocationId),
    Serve,
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

/// Which order the content of each location counts for, followed over a trial.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct OrderWork {
    /// By location.
    counts_for: [Option<LocationId>; MAX_LOCATIONS],
    /// By location of an order: number of orders that appeared before it and with it.
    appeared: [usize; MAX_LOCATIONS],
    orders: usize,
    state: State,
}

impl OrderWork {
    pub fn follow(&mut self, kitchen: &Kitchen, entries: &[TimelineEntry]) {
        for entry in entries {
            match entry.what {
                TimelineEvent::Press { before, after, .. } => {
                    self.move_to(kitchen, before);
                    self.move_to(kitchen, after);
                }
                TimelineEvent::OrderShown { order } => {
                    self.orders += 1;
                    self.appeared[order.index()] = self.orders;
                }
                _ => {}
            }
        }
    }

    /// The needs of all orders in a state that follows.
    pub fn needs(&mut self, kitchen: &Kitchen, state: State) -> Vec<OrderNeeds> {
        self.carry(kitchen, state);
        self.settle(kitchen)
    }

    fn move_to(&mut self, kitchen: &Kitchen, state: State) {
        if state != self.state {
            self.carry(kitchen, state);
            self.settle(kitchen);
        }
    }

    /// Carries what counts for an order along with the contents that moved.
    fn carry(&mut self, kitchen: &Kitchen, state: State) {
        let (before, counted) = (self.state, self.counts_for);
        let changed: Vec<LocationId> = kitchen.changed(before, state).collect();
        let left = |place: &LocationId| state.content(*place).is_empty() && !before.content(*place).is_empty();
        let is_order = |place: LocationId| kitchen.location(place).kind == LocationKind::Order;
        let sources: Vec<LocationId> = changed.iter().copied().filter(|&place| !is_order(place)).filter(left).collect();
        for &place in &changed {
            if is_order(place) {
                self.counts_for.iter_mut().filter(|of| **of == Some(place)).for_each(|of| *of = None);
                continue;
            }
            let (was, is) = (before.content(place), state.content(place));
            let mut from = sources.iter().filter(|source| !was.is_empty() || before.content(**source) == is);
            self.counts_for[place.index()] = match is.is_empty() {
                true => None,
                // A stack stays the one that it was, whatever is laid on it.
                false => counted[place.index()].or_else(|| from.find_map(|source| counted[source.index()])),
            };
        }
        self.state = state;
    }

    /// Gives what counts for no order, or no longer for its order, to an order that needs it.
    fn settle(&mut self, kitchen: &Kitchen) -> Vec<OrderNeeds> {
        let (state, was) = (self.state, self.counts_for);
        let mut orders: Vec<OrderNeeds> = kitchen
            .wanted(state)
            .map(|(order, dish)| {
                let items = &kitchen.content(kitchen.dish(dish).stack()).items;
                let items = items.iter().map(|&item| NeededItem { item, progress: ItemProgress::Missing }).collect();
                OrderNeeds { order, dish, items, last_step: None, is_begun: false }
            })
            .collect();
        let mut turns: Vec<usize> = (0..orders.len()).collect();
        turns.sort_by_key(|&index| self.appeared[orders[index].order.index()]);
        let mut free: Vec<(LocationId, ContentId)> = kitchen
            .location_ids()
            .filter(|&location| kitchen.location(location).kind != LocationKind::Order)
            .map(|location| (location, state.content(location)))
            .filter(|(_, content)| !content.is_empty())
            .collect();
        self.counts_for = [None; MAX_LOCATIONS];
        // Of several stacks that an order could have, it gets the one with most items.
        let is_base = |&(location, content): &(LocationId, ContentId)| {
            kitchen.content(content).is_stack() || location == kitchen.board || location == kitchen.plate
        };
        let mut bases: Vec<(LocationId, ContentId)> = free.iter().copied().filter(is_base).collect();
        bases.sort_by_key(|(_, content)| std::cmp::Reverse(kitchen.content(*content).items.len()));
        for is_kept in [true, false] {
            bases.retain(|&(location, content)| {
                let items = &kitchen.content(content).items;
                let takes = |needs: &OrderNeeds| {
                    !needs.is_begun
                        && (!is_kept || was[location.index()] == Some(needs.order))
                        && items.iter().all(|item| needs.items.iter().any(|needed| needed.item == *item))
                };
                let Some(&index) = turns.iter().find(|&&index| takes(&orders[index])) else { return true };
                let needs = &mut orders[index];
                needs.is_begun = true;
                self.counts_for[location.index()] = Some(needs.order);
                for needed in needs.items.iter_mut().filter(|needed| items.contains(&needed.item)) {
                    needed.progress = ItemProgress::Stacked;
                }
                free.retain(|(other, _)| *other != location);
                false
            });
        }
        // Who began a stack goes on with it.
        turns.sort_by_key(|&index| !orders[index].is_begun);
        for (is_kept, is_ready) in [(true, true), (true, false), (false, true), (false, false)] {
            for &index in &turns {
                let OrderNeeds { order, items, .. } = &mut orders[index];
                for needed in items.iter_mut().filter(|needed| needed.progress == ItemProgress::Missing) {
                    let serves = |&(location, content): &(LocationId, ContentId)| {
                        (!is_kept || was[location.index()] == Some(*order))
                            && match is_ready {
                                true => content == needed.item,
                                false => becomes(kitchen, content, needed.item),
                            }
                    };
                    if let Some(found) = free.iter().position(serves) {
                        let (location, _) = free.remove(found);
                        self.counts_for[location.index()] = Some(*order);
                        needed.progress = match is_ready {
                            true => ItemProgress::Ready(location),
                            false => ItemProgress::InWork(location),
                        };
                    }
                }
            }
        }
        let is_only = orders.iter().filter(|needs| needs.is_begun).count() == 1;
        for needs in &mut orders {
            needs.is_begun &= is_only;
            needs.last_step = self.last_step(kitchen, needs);
        }
        orders
    }

    fn last_step(&self, kitchen: &Kitchen, needs: &OrderNeeds) -> Option<LastStep> {
        let is_there = |needed: &NeededItem| matches!(needed.progress, ItemProgress::Stacked | ItemProgress::Ready(_));
        let whole = kitchen.dish(needs.dish).stack();
        let has_whole = |place: &LocationId| {
            self.counts_for[place.index()] == Some(needs.order) && self.state.content(*place) == whole
        };
        match kitchen.location_ids().find(has_whole) {
            Some(place) if place == kitchen.plate => Some(LastStep::Serve),
            Some(place) => Some(LastStep::Plate(place)),
            None => needs.items.iter().all(is_there).then_some(LastStep::Stack),
        }
    }
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
