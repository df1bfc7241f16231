//! An exact shortest path search over presses: the oracle for costs to go. Plain A* over whole states with a bound that is
//! admissible for obvious reasons, and nothing shared with the fast computation but the rules.

use std::collections::{BinaryHeap, HashMap};
use std::hash::{BuildHasherDefault, Hasher};

use tomcom_core::kitchen::{
    Agent, ButtonAction, ContentId, Kitchen, LocationId, LocationKind, OrderContent, Recipes, State,
};

/// By component: presses from every location and content; the last row, at content 0, is from a storage.
type Distances = HashMap<ContentId, Vec<Vec<u32>>>;

/// Exact costs to go by search.
pub struct Oracle<'a> {
    kitchen: &'a Kitchen,
    /// `[component][location][content]`: presses until this single item lies on the board as the component, if nothing is
    /// ever in the way.
    alone: Distances,
    /// The same if a place can be used only by what already lies there, for every place where something is processed.
    without: Vec<(LocationId, Distances)>,
}

const FAR: u32 = 100;

/// A quick hash of the 16 bytes of a state.
#[derive(Default)]
struct StateHasher(u64);

impl Hasher for StateHasher {
    fn write(&mut self, bytes: &[u8]) {
        for chunk in bytes.chunks(8) {
            let mut word = [0; 8];
            word[..chunk.len()].copy_from_slice(chunk);
            self.0 = tomcom_core::base::rng::mix(self.0 ^ u64::from_le_bytes(word));
        }
    }

    fn finish(&self) -> u64 {
        self.0
    }
}

impl<'a> Oracle<'a> {
    pub fn new(kitchen: &'a Kitchen) -> Oracle<'a> {
        let mut components: Vec<ContentId> =
            kitchen.contents.iter().filter(|c| c.is_stack()).flat_map(|c| c.items.clone()).collect();
        components.sort();
        components.dedup();
        let distances = |closed: Option<LocationId>| {
            components.iter().map(|&component| (component, alone(kitchen, component, closed))).collect()
        };
        let mut stations: Vec<LocationId> = kitchen.processes.iter().filter_map(|process| process.place).collect();
        stations.sort();
        stations.dedup();
        let without = stations.into_iter().map(|station| (station, distances(Some(station)))).collect();
        Oracle { kitchen, alone: distances(None), without }
    }

    /// The least number of presses until the orders at `orders` are served; `None` beyond four million expansions.
    pub fn cost(&mut self, start: State, recipes: &Recipes, orders: &[LocationId]) -> Option<u32> {
        let mut start = start;
        for &order in &self.kitchen.orders {
            if !orders.contains(&order) || !matches!(start.order(order), OrderContent::Dish(_)) {
                start.set_order(order, OrderContent::None);
            }
        }
        let mut open = BinaryHeap::new();
        let mut costs: HashMap<State, u32, BuildHasherDefault<StateHasher>> = HashMap::default();
        let bound = self.bound(start, recipes);
        open.push((std::cmp::Reverse(bound), 0u32, start));
        costs.insert(start, 0);
        let mut expansions = 0;
        while let Some((std::cmp::Reverse(_), cost, state)) = open.pop() {
            if costs[&state] < cost {
                continue;
            }
            if self.kitchen.wanted(state).next().is_none() {
                return Some(cost);
            }
            expansions += 1;
            if expansions > 4_000_000 {
                return None;
            }
            let useful = self.useful(state, recipes);
            for agent in Agent::BOTH {
                let held = state.content(self.kitchen.hands[agent.index()]);
                for button in &self.kitchen.buttons[agent.index()] {
                    // Something that no wanted dish can use is best thrown away once it is in a hand.
                    let in_the_way = !held.is_empty() && !useful[held.index()];
                    if in_the_way && matches!(button.action, ButtonAction::Use(_)) {
                        continue;
                    }
                    let Some(next) = self.kitchen.act(state, recipes, agent, button.action) else { continue };
                    let next = self.simplified(next, &self.useful(next, recipes));
                    let next_cost = cost + 1;
                    if costs.get(&next).is_none_or(|&known| known > next_cost) {
                        costs.insert(next, next_cost);
                        let bound = self.bound(next, recipes);
                        open.push((std::cmp::Reverse(next_cost + bound), next_cost, next));
                    }
                }
            }
        }
        None
    }

    /// Which contents a wanted dish can still use.
    fn useful(&self, state: State, recipes: &Recipes) -> Vec<bool> {
        let mut useful = vec![false; self.kitchen.contents.len()];
        for (_, dish) in self.kitchen.wanted(state) {
            let target = &self.kitchen.content(recipes.get(dish)).items;
            for (index, content) in self.kitchen.contents.iter().enumerate().skip(1) {
                useful[index] |= match content.is_stack() {
                    true => content.items.iter().all(|item| target.contains(item)),
                    false => target.iter().any(|item| self.alone[item].iter().any(|place| place[index] < FAR)),
                };
            }
        }
        useful
    }

    /// All contents of no use are alike: the first of them stands for all.
    fn simplified(&self, state: State, useful: &[bool]) -> State {
        let useless = (1..useful.len()).find(|&content| !useful[content]);
        let mut simple = state;
        for index in self.kitchen.orders.len()..self.kitchen.locations.len() {
            let place = LocationId(index as u8);
            let content = state.content(place);
            if let (false, false, Some(useless)) = (content.is_empty(), useful[content.index()], useless) {
                simple.set_content(place, ContentId(useless as u8));
            }
        }
        simple
    }

    /// Every wanted dish needs its components on the board (each press moves or changes only one item or stack, so presses
    /// for different ones add up) and then pick up, put down, serve.
    fn bound(&self, state: State, recipes: &Recipes) -> u32 {
        let kitchen = self.kitchen;
        let places = || (kitchen.orders.len()..kitchen.locations.len()).map(|index| LocationId(index as u8));
        let mut sum = 0;
        let mut needs: Vec<ContentId> = Vec::new();
        let mut finished: Vec<LocationId> = Vec::new();
        for (_, dish) in kitchen.wanted(state) {
            let target = recipes.get(dish);
            let last = |place: LocationId| match kitchen.location(place).kind {
                _ if place == kitchen.plate => 1,
                LocationKind::Hand(_) => 2,
                _ => 3,
            };
            let full = places().filter(|&place| state.content(place) == target && !finished.contains(&place));
            if let Some(place) = full.min_by_key(|&place| last(place)) {
                sum += last(place);
                finished.push(place);
            } else {
                sum += 3;
                needs.extend(&kitchen.content(target).items);
            }
        }
        needs.sort();
        // In half presses: what is in a stack costs its share of bringing the stack.
        let mut halves = 0;
        for group in needs.chunk_by(|a, b| a == b) {
            let mut presses = self.sources(state, group[0], &self.alone[&group[0]], group.len());
            presses.sort();
            halves += presses[..group.len()].iter().sum::<u32>();
        }
        sum += halves.div_ceil(2);
        sum + self.in_the_way(state, recipes, &needs, finished.contains(&kitchen.plate))
    }

    /// Half presses of every source of a component: what lies somewhere, and `count` from the storages.
    fn sources(&self, state: State, component: ContentId, distance: &[Vec<u32>], count: usize) -> Vec<u32> {
        let kitchen = self.kitchen;
        let at = |index: usize| {
            let place = LocationId(index as u8);
            let content = state.content(place);
            let items = &kitchen.content(content).items;
            match items.len() {
                0 => FAR,
                1 => 2 * distance[index][content.index()],
                _ if !items.contains(&component) => FAR,
                _ if place == kitchen.board => 0,
                size if matches!(kitchen.location(place).kind, LocationKind::Hand(_)) => 2 / size as u32,
                size => 4 / size as u32,
            }
        };
        let from_storage = 2 * distance[kitchen.locations.len()][0];
        (kitchen.orders.len()..kitchen.locations.len()).map(at).chain((0..count).map(|_| from_storage)).collect()
    }

    /// What no wanted dish can use has to be picked up where it blocks the board, the plate, or a place without which some
    /// component cannot be had; and has to leave the hands again, but one that may hold it to the end.
    fn in_the_way(&self, state: State, recipes: &Recipes, needs: &[ContentId], served_from_plate: bool) -> u32 {
        let kitchen = self.kitchen;
        let useful = self.useful(state, recipes);
        let useless = |place: LocationId| {
            let content = state.content(place);
            !content.is_empty() && !useful[content.index()]
        };
        let mut picked = u32::from(!needs.is_empty() && useless(kitchen.board));
        let plate_wanted = !needs.is_empty() || kitchen.wanted(state).next().is_some() && !served_from_plate;
        picked += u32::from(plate_wanted && useless(kitchen.plate));
        for (station, distances) in &self.without {
            let cut_off = |component: &&ContentId| {
                self.sources(state, **component, &distances[*component], 1).iter().all(|&presses| presses >= FAR)
            };
            let counted = *station == kitchen.board || *station == kitchen.plate;
            if !counted && useless(*station) && needs.iter().any(|component| cut_off(&component)) {
                picked += 1;
            }
        }
        if picked == 0 && needs.is_empty() {
            return 0;
        }
        let held = kitchen.hands.iter().filter(|&&hand| useless(hand)).count() as u32;
        picked + (picked + held).saturating_sub(1)
    }
}

/// Presses until an item lies on the board as `component`, by place and content; the last row: from a storage.
/// Nothing can be put down at a `closed` place.
fn alone(kitchen: &Kitchen, component: ContentId, closed: Option<LocationId>) -> Vec<Vec<u32>> {
    let places = kitchen.locations.len();
    let mut presses = vec![vec![FAR; kitchen.contents.len()]; places + 1];
    presses[kitchen.board.index()][component.index()] = 0;
    loop {
        let before = presses.clone();
        for agent in Agent::BOTH {
            let hand = kitchen.hands[agent.index()];
            for button in &kitchen.buttons[agent.index()] {
                for item in 1..kitchen.contents.len() {
                    let id = ContentId(item as u8);
                    match button.action {
                        ButtonAction::Take(taken) if taken == id => {
                            presses[places][0] = presses[places][0].min(presses[hand.index()][item] + 1);
                        }
                        ButtonAction::Use(place) => {
                            let put = presses[place.index()][item] + 1;
                            if kitchen.accepts(place, id) && Some(place) != closed {
                                presses[hand.index()][item] = presses[hand.index()][item].min(put);
                            }
                            let pick = presses[hand.index()][item] + 1;
                            presses[place.index()][item] = presses[place.index()][item].min(pick);
                        }
                        ButtonAction::Process(process) => {
                            let place = kitchen.processes[usize::from(process)].place.unwrap_or(hand);
                            if let Some(result) = kitchen.processed(process, id) {
                                let after = presses[place.index()][result.index()] + 1;
                                presses[place.index()][item] = presses[place.index()][item].min(after);
                            }
                        }
                        _ => {}
                    }
                }
            }
        }
        if before == presses {
            return presses;
        }
    }
}
