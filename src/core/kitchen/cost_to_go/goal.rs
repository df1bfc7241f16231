//! A goal of the cost to go: the dishes that are still to be served (targets), with tables of the use of every content
//! for these dishes. Only that use matters: all useless contents form one class, the obstacles.

use super::ground::{CompactState, JourneyNeeds, JourneyTables, KitchenTables, MAX_TARGETS, NEVER, USELESS};
use crate::kitchen::{Agent, ButtonAction, ContentId, Kitchen, LocationId, State};

/// Value of an item at its place for one target dish, packed into one number so that the maximum of many values is
/// found without branches: a larger gain is better, ties go to the first location.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub struct ItemValue(u32);

impl ItemValue {
    /// Packs the value of an item: `gain`, in half presses, is the number of presses saved compared with a fresh item
    /// from a storage, plus the value of freeing the item's location.
    fn new(gain: u16, location: u8, fills: u8) -> ItemValue {
        ItemValue(u32::from_be_bytes([(gain >> 8) as u8, gain as u8, !location, fills]))
    }

    /// Bit set of the target dish's items that this item can become; 0 if a fresh item from a storage is nearer.
    #[inline]
    pub fn fills(self) -> u8 {
        self.0 as u8
    }

    #[inline]
    pub fn location(self) -> u8 {
        !((self.0 >> 8) as u8)
    }
}

/// A goal: a set of target dishes with tables over classes of contents.
#[derive(Clone, Debug)]
pub struct ServingGoal {
    /// The stacks (dishes) to be served, in ascending order of their ids.
    pub targets: Vec<ContentId>,
    pub class_of: Vec<u8>,
    /// For each class of contents, one content that belongs to the class.
    pub content: Vec<ContentId>,
    /// Representative of each content: the first content of the same class that allows the same presses.
    pub stands_for: Vec<ContentId>,
    /// `[target][class]`: bit j if the class is, or can become, the j-th item of the target dish.
    pub fills: [Vec<u8>; MAX_TARGETS],
    /// `[target][class]`: bit j if the class is the j-th item of the target dish and can be stacked as it is.
    pub ready: [Vec<u8>; MAX_TARGETS],
    /// `[target][location * classes + class]`: number of presses that bring the item to the board without obstacles.
    pub near: [Vec<u8>; MAX_TARGETS],
    /// `[target][location * classes + class]`: free hands and places that the presses in `near` require.
    pub near_needs: [Vec<JourneyNeeds>; MAX_TARGETS],
    /// `[target][location * classes + class]`: value of the item for the target dish.
    pub offers: [Vec<ItemValue>; MAX_TARGETS],
    /// `[target][j]`: number of presses that bring the target's j-th item from a storage to the board, and free hands
    /// and places required for that.
    pub fresh: [Vec<(u8, JourneyNeeds)>; MAX_TARGETS],
    /// For each target dish, the component index of its j-th item (see `journeys`).
    pub components: [Vec<usize>; MAX_TARGETS],
    pub complete: [u8; MAX_TARGETS],
    pub target_class: [u8; MAX_TARGETS],
    /// `[target][bits]`: the class of a stack of these items of the target dish.
    pub part_class: [Vec<u8>; MAX_TARGETS],
    /// For each class, whether more than one target dish can use its contents.
    pub is_shared: Vec<bool>,
    /// For each agent, the classes of the items in the agent's storages.
    pub takes: [Vec<u8>; 2],
    /// `[process][class]`: the class after the processing step if it is a useful class, else 0.
    pub becomes: Vec<Vec<u8>>,
    /// `[below * classes + above]`: the class of the stack if it is a useful class, else 0.
    pub stacks: Vec<u8>,
    first: usize,
    last: usize,
    /// `[(location - first) * contents + content]`: the content's class times the location's stride; the sum over all
    /// locations is the state's cache key.
    key_by_content: Vec<u64>,
    /// `[(location - first) * classes + class]`: the class times the location's stride in the cache key.
    key_by_class: Vec<u64>,
}

impl ServingGoal {
    pub fn new(kitchen: &Kitchen, ground: &KitchenTables, targets: Vec<ContentId>) -> ServingGoal {
        let journeys = &ground.journeys;
        let mut content = vec![ContentId::EMPTY];
        let mut class_of = vec![USELESS; kitchen.contents.len()];
        class_of[0] = 0;
        content.push(ContentId::EMPTY);
        let worth = |target: ContentId, content: usize| worth(kitchen, journeys, target, content);
        for (index, class) in class_of.iter_mut().enumerate().skip(1) {
            if targets.iter().any(|&target| worth(target, index) != 0) {
                *class = content.len() as u8;
                content.push(ContentId(index as u8));
            } else if content[usize::from(USELESS)].is_empty() {
                content[usize::from(USELESS)] = ContentId(index as u8);
            }
        }
        let mut goal = ServingGoal {
            stands_for: stands_for(kitchen, &class_of),
            class_of,
            fills: Default::default(),
            ready: Default::default(),
            near: Default::default(),
            near_needs: Default::default(),
            offers: Default::default(),
            is_shared: Vec::new(),
            fresh: Default::default(),
            components: Default::default(),
            complete: [0; MAX_TARGETS],
            target_class: [0; MAX_TARGETS],
            part_class: Default::default(),
            takes: Default::default(),
            becomes: Vec::new(),
            stacks: Vec::new(),
            first: kitchen.orders.len(),
            last: kitchen.locations.len(),
            key_by_content: Vec::new(),
            key_by_class: Vec::new(),
            content,
            targets,
        };
        for (index, &target) in goal.targets.iter().enumerate() {
            let items = &kitchen.content(target).items;
            goal.components[index] = items.iter().filter_map(|&item| journeys.component(item)).collect();
            goal.complete[index] = ((1u32 << items.len()) - 1) as u8;
            goal.target_class[index] = goal.class_of[target.index()];
            goal.part_class[index] = vec![0; usize::from(goal.complete[index]) + 1];
            for (class, &content) in goal.content.iter().enumerate() {
                let useful = class > usize::from(USELESS);
                goal.fills[index].push(if useful { worth(target, content.index()) } else { 0 });
                goal.ready[index].push(if useful { ready(kitchen, target, content) } else { 0 });
            }
        }
        for target in 0..goal.targets.len() {
            for class in 2..goal.content.len() {
                let bits = usize::from(goal.ready[target][class]);
                if bits != 0 {
                    goal.part_class[target][bits] = class as u8;
                }
            }
        }
        let shared =
            |class: usize| goal.fills.iter().filter(|fills| fills.get(class).is_some_and(|&f| f != 0)).count() > 1;
        goal.is_shared = (0..goal.content.len()).map(shared).collect();
        goal.fill_distances(kitchen, journeys);
        goal.fill_offers(ground);
        goal.fill_moves(kitchen);
        goal.fill_keys(kitchen);
        goal
    }

    /// Whether there are two different target dishes.
    #[inline]
    pub fn targets_differ(&self) -> bool {
        matches!(self.targets[..], [first, second] if first != second)
    }

    /// Number of presses of a task if its item is at location `at`, and free hands and places required for that.
    #[inline]
    pub fn way(&self, state: &CompactState, task: &DeliveryTask, at: u8) -> (u8, JourneyNeeds) {
        let target = usize::from(task.target);
        if at == STORAGE {
            return self.fresh[target][task.bits.trailing_zeros() as usize];
        }
        let index = usize::from(at) * self.content.len() + usize::from(state[usize::from(at)]);
        (self.near[target][index], self.near_needs[target][index])
    }

    /// Number of presses that bring an item of a class from a location onto the board for a target dish, without
    /// obstacles in the way.
    #[inline]
    pub fn presses_from(&self, target: u8, location: usize, class: u8) -> u8 {
        self.near[usize::from(target)][location * self.content.len() + usize::from(class)]
    }

    /// Whether the content at location `at` is the item of a task or can become that item.
    #[inline]
    pub fn fits(&self, state: &CompactState, task: &DeliveryTask, at: u8) -> bool {
        at == STORAGE || self.fills[usize::from(task.target)][usize::from(state[usize::from(at)])] == task.bits
    }

    /// Whether a task's item is on the board in its final (processed) form.
    #[inline]
    pub fn is_ready(&self, ground: &KitchenTables, state: &CompactState, task: &DeliveryTask) -> bool {
        let at = usize::from(task.at);
        at == ground.board && self.ready[usize::from(task.target)][usize::from(state[at])] == task.bits
    }

    fn fill_distances(&mut self, kitchen: &Kitchen, journeys: &JourneyTables) {
        for target in 0..self.targets.len() {
            for &component in &self.components[target] {
                let presses = journeys.storage_presses(journeys.all_free, component);
                self.fresh[target].push((presses, journeys.storage_needs(component)));
            }
            for location in 0..kitchen.locations.len() {
                let is_hand = kitchen.hands.iter().any(|hand| hand.index() == location);
                for (class, content) in self.content.iter().enumerate() {
                    let fills = self.fills[target][class];
                    let (presses, needs) = match fills.count_ones() {
                        0 => (NEVER, 0),
                        1 => {
                            let component = self.components[target][fills.trailing_zeros() as usize];
                            let free = journeys.all_free;
                            let presses = journeys.presses(free, component, location, content.0);
                            (presses, journeys.needs(component, location, content.0))
                        }
                        _ => (if is_hand { 1 } else { 2 }, 0),
                    };
                    self.near[target].push(presses);
                    self.near_needs[target].push(needs);
                }
            }
        }
    }

    fn fill_offers(&mut self, ground: &KitchenTables) {
        let classes = self.content.len();
        for target in 0..self.targets.len() {
            let offer = |(index, &near): (usize, &u8)| {
                let (location, fills) = (index / classes, self.fills[target][index % classes]);
                let of_bits = self.fresh[target].iter().enumerate().filter(|(bit, _)| fills & (1 << bit) != 0);
                let fresh: i16 = of_bits.map(|(_, (presses, _))| i16::from(*presses)).sum();
                match u16::try_from(fresh - i16::from(near)) {
                    Ok(saves) => ItemValue::new(2 * saves + ground.in_the_way[location], location as u8, fills),
                    Err(_) => ItemValue::default(),
                }
            };
            self.offers[target] = self.near[target].iter().enumerate().map(offer).collect();
        }
    }

    fn fill_moves(&mut self, kitchen: &Kitchen) {
        let useful = |class: u8| if class == USELESS { 0 } else { class };
        for agent in Agent::BOTH {
            let taken = kitchen.buttons[agent.index()].iter().filter_map(|button| match button.action {
                ButtonAction::Take(item) => Some(useful(self.class_of[item.index()])),
                _ => None,
            });
            self.takes[agent.index()] = taken.filter(|&class| class != 0).collect();
        }
        let result = |content: Option<ContentId>| content.map_or(0, |content| useful(self.class_of[content.index()]));
        let classes = &self.content;
        let becomes = (0..kitchen.processes.len() as u8).map(|process| {
            let of_class = |(class, &content): (usize, &ContentId)| match class <= usize::from(USELESS) {
                true => 0,
                false => result(kitchen.processed(process, content)),
            };
            classes.iter().enumerate().map(of_class).collect()
        });
        self.becomes = becomes.collect();
        let count = classes.len();
        self.stacks = vec![0; count * count];
        for below in 2..count {
            for above in 2..count {
                self.stacks[below * count + above] = result(kitchen.stacked(self.content[below], self.content[above]));
            }
        }
    }

    /// Cache key of a state: equal for states that are equivalent for this goal.
    #[inline]
    pub fn key_of_state(&self, state: State) -> u64 {
        let contents = self.class_of.len();
        let rows = self.key_by_content.chunks_exact(contents).enumerate();
        rows.map(|(row, parts)| parts[state.content(LocationId((self.first + row) as u8)).index()]).sum()
    }

    /// Contribution of a content at a physical location to the state's cache key.
    #[inline]
    pub fn key_part(&self, location: LocationId, content: ContentId) -> u64 {
        self.key_by_content[(location.index() - self.first) * self.class_of.len() + content.index()]
    }

    /// Cache key of a state that is given by classes of contents.
    #[inline]
    pub fn key_of_classes(&self, state: &CompactState) -> u64 {
        let rows = self.key_by_class.chunks_exact(self.content.len());
        rows.zip(&state[self.first..self.last]).map(|(parts, &class)| parts[usize::from(class)]).sum()
    }

    fn fill_keys(&mut self, kitchen: &Kitchen) {
        let mut stride = 1u64;
        for index in self.first..self.last {
            let location = LocationId(index as u8);
            let can_be = |&content: &usize| content == 0 || kitchen.accepts(location, ContentId(content as u8));
            let mut classes: Vec<u8> = (0..kitchen.contents.len()).filter(can_be).map(|c| self.class_of[c]).collect();
            classes.sort_unstable();
            classes.dedup();
            let digit = |class: u8| classes.iter().position(|&other| other == class).unwrap_or(0) as u64;
            self.key_by_content.extend(self.class_of.iter().map(|&class| digit(class) * stride));
            self.key_by_class.extend((0..self.content.len()).map(|class| digit(class as u8) * stride));
            stride = stride.saturating_mul(classes.len() as u64);
        }
    }
}

/// Bit set of the target dish's items that a content already is, or can become.
fn worth(kitchen: &Kitchen, journeys: &JourneyTables, target: ContentId, content: usize) -> u8 {
    let candidate = &kitchen.contents[content];
    if candidate.is_stack() {
        return ready(kitchen, target, ContentId(content as u8));
    }
    let reachable = |component: usize| {
        let free = journeys.all_free;
        (0..kitchen.locations.len()).any(|at| journeys.presses(free, component, at, content as u8) < NEVER)
    };
    let items = kitchen.content(target).items.iter().enumerate();
    let bits = items.filter(|(_, item)| journeys.component(**item).is_some_and(reachable)).map(|(bit, _)| 1 << bit);
    bits.sum()
}

/// Bit set of the target dish's items that a content consists of; 0 if the content also has other items.
fn ready(kitchen: &Kitchen, target: ContentId, content: ContentId) -> u8 {
    let wanted = &kitchen.content(target).items;
    let bit = |item: &ContentId| wanted.iter().position(|other| other == item).map(|bit| 1 << bit);
    kitchen.content(content).items.iter().map(bit).sum::<Option<u8>>().unwrap_or(0)
}

/// For each content, the first content of the same class that the same locations accept, the same processes change and
/// the same contents stack with. Presses with either content then lead to the same classes and costs to go.
fn stands_for(kitchen: &Kitchen, class_of: &[u8]) -> Vec<ContentId> {
    let contents = || (0..kitchen.contents.len()).map(|index| ContentId(index as u8));
    let locations = || (kitchen.orders.len()..kitchen.locations.len()).map(|index| LocationId(index as u8));
    let class = |content: Option<ContentId>| content.map(|content| class_of[content.index()]);
    let alike = |one: ContentId, other: ContentId| {
        class_of[one.index()] == class_of[other.index()]
            && locations().all(|at| kitchen.accepts(at, one) == kitchen.accepts(at, other))
            && (0..kitchen.processes.len() as u8)
                .all(|process| class(kitchen.processed(process, one)) == class(kitchen.processed(process, other)))
            && contents().all(|third| {
                class(kitchen.stacked(one, third)) == class(kitchen.stacked(other, third))
                    && class(kitchen.stacked(third, one)) == class(kitchen.stacked(third, other))
            })
    };
    contents().map(|one| contents().find(|&other| alike(one, other)).unwrap_or(one)).collect()
}

/// Stands for the location of an item that is still in a storage.
pub const STORAGE: u8 = u8::MAX;

/// A task: an item to bring to the board, or a complete stack to serve.
#[derive(Clone, Copy, Debug, Default)]
pub struct DeliveryTask {
    pub target: u8,
    /// Bit set of the target dish's items that the task provides; all bits for a complete stack.
    pub bits: u8,
    /// The present location of the task's item, or [`STORAGE`].
    pub at: u8,
}

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
