//! Tables of one kitchen for the cost to go that hold for all goals, with the journeys of single items.

use std::ops::Range;

use crate::kitchen::{Agent, ButtonAction, ContentId, Kitchen, LocationId, LocationKind};

#[derive(Clone, Debug)]
pub struct KitchenTables {
    /// Numbers of presses that bring items through processing steps onto the board.
    pub journeys: JourneyTables,
    pub first: usize,
    pub last: usize,
    /// The location index of each agent's hand.
    pub hands: [usize; 2],
    pub board: usize,
    pub plate: usize,
    /// Places where any content can be put down temporarily.
    spare: Vec<usize>,
    /// Value of freeing each location, in half presses, when items are compared.
    pub in_the_way: Vec<u16>,
    /// All actions except taking from a storage and serving, each action once.
    pub moves: Vec<(Agent, ButtonAction)>,
    /// Location of each processing step; `None` for a step that is done in the hand.
    pub process_place: Vec<Option<usize>>,
    /// `[location * contents + content]`: whether the location, when empty, accepts the content.
    accepts: Vec<bool>,
    contents: usize,
    is_hand: Vec<bool>,
    /// For each location, the number of presses that serve a complete stack from there, without obstacles.
    last_presses: Vec<u32>,
}

impl KitchenTables {
    pub fn new(kitchen: &Kitchen) -> KitchenTables {
        let contents = kitchen.contents.len();
        let first = kitchen.orders.len();
        let last = kitchen.locations.len();
        let accepts = kitchen.tables.accepts.clone();
        let hands = kitchen.hands.map(|hand| hand.index());
        let (board, plate) = (kitchen.board.index(), kitchen.plate.index());
        let takes_all = |&location: &usize| (1..contents).all(|item| accepts[location * contents + item]);
        let spare = (first..last).filter(|location| !hands.contains(location) && *location != board);
        let spare = spare.filter(takes_all).collect();
        let journeys = JourneyTables::new(kitchen);
        let in_the_way = |location: usize| match location {
            _ if location == board || location == plate => 4,
            _ if hands.contains(&location) => 2,
            _ if journeys.bit[location] != 0 => 1,
            _ => 0,
        };
        let last_presses = |location: usize| match location {
            _ if location == plate => 1,
            _ if hands.contains(&location) => 2,
            _ => 3,
        };
        KitchenTables {
            first,
            last,
            hands,
            board,
            plate,
            spare,
            in_the_way: (0..last).map(in_the_way).collect(),
            moves: moves(kitchen),
            process_place: kitchen.processes.iter().map(|process| process.place.map(|place| place.index())).collect(),
            accepts,
            contents,
            is_hand: (0..last).map(|location| hands.contains(&location)).collect(),
            last_presses: (0..last).map(last_presses).collect(),
            journeys,
        }
    }

    /// Index range of the physical locations: all locations but the orders.
    #[inline]
    pub fn places(&self) -> Range<usize> {
        self.first..self.last
    }

    #[inline]
    pub fn is_hand(&self, location: usize) -> bool {
        self.is_hand[location]
    }

    #[inline]
    pub fn accepts(&self, location: usize, content: ContentId) -> bool {
        self.accepts[location * self.contents + content.index()]
    }

    /// Number of presses that serve a complete stack from the location with this index, without obstacles.
    #[inline]
    pub fn last_presses(&self, location: usize) -> u32 {
        self.last_presses[location]
    }

    #[inline]
    pub fn free(&self, state: &CompactState) -> FreeMask {
        let mut free = 0;
        for location in self.places() {
            if state[location] == 0 {
                free |= self.journeys.bit[location];
            }
        }
        if self.spare.iter().any(|&place| state[place] == 0) {
            free |= self.journeys.spare_bit;
        }
        free
    }
}

/// All actions except taking from a storage and serving, each once: an action at a place has the same effect for both
/// agents.
fn moves(kitchen: &Kitchen) -> Vec<(Agent, ButtonAction)> {
    let mut moves: Vec<(Agent, ButtonAction)> = Vec::new();
    for agent in Agent::BOTH {
        for button in &kitchen.buttons[agent.index()] {
            let counts = match button.action {
                ButtonAction::Take(_) | ButtonAction::Serve(_) => false,
                ButtonAction::Process(process) if kitchen.processes[usize::from(process)].place.is_some() => {
                    !moves.iter().any(|(_, other)| *other == button.action)
                }
                _ => true,
            };
            if counts {
                moves.push((agent, button.action));
            }
        }
    }
    moves
}

/// Largest number of target dishes (ordered dishes that are still to be served), see
/// `MAX_ORDERS` of `compile`.
pub const MAX_TARGETS: usize = 2;
/// The class of useless contents (obstacles); class 0 is empty.
pub const USELESS: u8 = 1;

/// A state in compact form: for every physical location, by index, the class of its content.
pub type CompactState = [u8; 16];

// Journeys: number of presses that bring one item from its place to the board in the form that a recipe needs, for
// every combination of free hands and places. One breadth-first search per component and combination fills the tables
// when a kitchen is loaded.

/// Marks an item's journey that is impossible.
pub const NEVER: u8 = u8::MAX;

/// Bit mask of hands and places that are free: bit 0 the human's hand, bit 1 the robot's hand, then one bit per
/// processing place, and a last bit for any place where an item can be put down temporarily.
pub type FreeMask = usize;

/// Tables of the lengths of items' journeys to the board, over (free mask, component, location, content).
#[derive(Clone, Debug)]
pub struct JourneyTables {
    /// Places where items are processed, in the order of their mask bits from bit 2 on.
    pub stations: Vec<LocationId>,
    /// Mask bit of each location; 0 for locations that no journey of an item uses.
    pub bit: Vec<FreeMask>,
    /// The mask bit for a place where an item can be put down temporarily.
    pub spare_bit: FreeMask,
    pub all_free: FreeMask,
    /// The components: items that are part of a dish.
    pub components: Vec<ContentId>,
    contents: usize,
    locations: usize,
    /// `[((mask * components + component) * locations + location) * contents + content]`: number of presses of the
    /// journey to the board.
    presses: Vec<u8>,
    /// `[mask * components + component]`: number of presses for an item that is still in a storage, including the press
    /// that takes the item.
    storage_presses: Vec<u8>,
}

/// Bit mask of the hands and places that must be free for an item's journey to be possible.
pub type JourneyNeeds = u16;

impl JourneyTables {
    pub fn new(kitchen: &Kitchen) -> JourneyTables {
        let mut stations: Vec<LocationId> = kitchen.processes.iter().filter_map(|process| process.place).collect();
        stations.sort_unstable();
        stations.dedup();
        let mut bit = vec![0; kitchen.locations.len()];
        for agent in Agent::BOTH {
            bit[kitchen.hands[agent.index()].index()] = 1 << agent.index();
        }
        for (index, station) in stations.iter().enumerate() {
            bit[station.index()] = 4 << index;
        }
        let spare_bit = 4 << stations.len();
        let mut components: Vec<ContentId> = kitchen
            .contents
            .iter()
            .filter(|content| content.is_stack())
            .flat_map(|content| content.items.clone())
            .collect();
        components.sort_unstable();
        components.dedup();
        let mut journeys = JourneyTables {
            stations,
            bit,
            spare_bit,
            all_free: 2 * spare_bit - 1,
            components,
            contents: kitchen.contents.len(),
            locations: kitchen.locations.len(),
            presses: Vec::new(),
            storage_presses: Vec::new(),
        };
        journeys.fill(kitchen);
        journeys
    }

    /// The index of an item among the components (items of dishes); `None` if no dish contains the item.
    pub fn component(&self, item: ContentId) -> Option<usize> {
        self.components.iter().position(|&component| component == item)
    }

    /// Number of presses until `content`, now at `location`, lies on the board as this component. The mask `free` must
    /// include the item's own place.
    #[inline]
    pub fn presses(&self, free: FreeMask, component: usize, location: usize, content: u8) -> u8 {
        let row = (free * self.components.len() + component) * self.locations + location;
        self.presses[row * self.contents + usize::from(content)]
    }

    /// Number of presses until this component, taken from a storage, lies on the board.
    #[inline]
    pub fn storage_presses(&self, free: FreeMask, component: usize) -> u8 {
        self.storage_presses[free * self.components.len() + component]
    }

    /// The single bits of the free mask without which the journey of this content is impossible.
    pub fn needs(&self, component: usize, location: usize, content: u8) -> JourneyNeeds {
        self.indispensable(|free| self.presses(free | self.bit[location], component, location, content))
    }

    /// The single bits of the free mask without which the journey of an item from a storage is impossible.
    pub fn storage_needs(&self, component: usize) -> JourneyNeeds {
        self.indispensable(|free| self.storage_presses(free, component))
    }

    fn indispensable(&self, presses: impl Fn(FreeMask) -> u8) -> JourneyNeeds {
        let bits = (0..JourneyNeeds::BITS).map(|bit| 1 << bit).filter(|bit| self.all_free & bit != 0);
        bits.filter(|&bit| presses(self.all_free & !bit) == NEVER).map(|bit| bit as JourneyNeeds).sum()
    }

    fn fill(&mut self, kitchen: &Kitchen) {
        for free in 0..=self.all_free {
            let steps = self.steps(kitchen, free);
            for component in 0..self.components.len() {
                let presses = self.search(kitchen, &steps, self.components[component]);
                let take = |agent: Agent| {
                    let hand = kitchen.hands[agent.index()].index();
                    let is_free = free & (1 << agent.index()) != 0;
                    kitchen.buttons[agent.index()].iter().filter_map(move |button| match button.action {
                        ButtonAction::Take(item) if is_free => Some((hand, item)),
                        _ => None,
                    })
                };
                let taken = Agent::BOTH.into_iter().flat_map(take).map(|(hand, item)| presses[self.place(hand, item)]);
                let best = taken.min();
                self.storage_presses.push(best.unwrap_or(NEVER).saturating_add(1));
                self.presses.extend_from_slice(&presses[..self.locations * self.contents]);
            }
        }
    }

    /// Index of an item at a location in the search's tables; the last location is the spare place.
    fn place(&self, location: usize, item: ContentId) -> usize {
        location * self.contents + item.index()
    }

    /// All single presses with these hands and places free, from place to place, which are the same for all components.
    fn steps(&self, kitchen: &Kitchen, free: FreeMask) -> Vec<(usize, usize)> {
        let mut steps = Vec::new();
        for location in 0..=self.locations {
            for item in (1..self.contents).map(|item| ContentId(item as u8)) {
                let from = self.place(location, item);
                let to = self.successors(kitchen, free, location, item);
                steps.extend(to.map(|(to, item)| (from, self.place(to, item))));
            }
        }
        steps
    }

    /// Searches backwards from the component in a hand beside the board: number of presses by place.
    fn search(&self, kitchen: &Kitchen, steps: &[(usize, usize)], component: ContentId) -> Vec<u8> {
        let mut presses = vec![NEVER; (self.locations + 1) * self.contents];
        for hand in kitchen.hands {
            presses[self.place(hand.index(), component)] = 1;
        }
        // Journeys are short, so relaxing all steps until nothing changes any more is fast enough.
        loop {
            let mut changed = false;
            for &(from, to) in steps {
                let through = presses[to].saturating_add(1);
                if through < presses[from] {
                    presses[from] = through;
                    changed = true;
                }
            }
            if !changed {
                break;
            }
        }
        presses[self.place(kitchen.board.index(), component)] = 0;
        presses
    }

    /// Locations to which one press can bring an item that is at `location`.
    fn successors<'a>(
        &'a self,
        kitchen: &'a Kitchen,
        free: FreeMask,
        location: usize,
        item: ContentId,
    ) -> impl Iterator<Item = (usize, ContentId)> + 'a {
        let spare = self.locations;
        let kind = (location < spare).then(|| kitchen.locations[location].kind);
        let in_hand = match kind {
            Some(LocationKind::Hand(agent)) => Some(agent),
            _ => None,
        };
        let processed = kitchen.processes.iter().enumerate().filter_map(move |(index, process)| {
            let here = match (process.place, in_hand) {
                (Some(place), None) => place.index() == location,
                (None, Some(agent)) => process.agents[agent.index()],
                _ => false,
            };
            here.then(|| kitchen.processed(index as u8, item)).flatten().map(|result| (location, result))
        });
        let pick_up = Agent::BOTH.into_iter().filter_map(move |agent| {
            let can = in_hand.is_none() && free & (1 << agent.index()) != 0;
            can.then(|| (kitchen.hands[agent.index()].index(), item))
        });
        let put_down = self.stations.iter().filter_map(move |&station| {
            let can = in_hand.is_some() && free & self.bit[station.index()] != 0 && kitchen.accepts(station, item);
            can.then_some((station.index(), item))
        });
        let put_aside = (in_hand.is_some() && free & self.spare_bit != 0).then_some((spare, item));
        processed.chain(pick_up).chain(put_down).chain(put_aside)
    }
}
