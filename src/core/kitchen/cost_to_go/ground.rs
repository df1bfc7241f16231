//! Tables of one kitchen for the cost to go that hold for all goals.

use std::ops::Range;

use crate::kitchen::{Agent, ButtonAction, ContentId, Kitchen, LocationId};

use super::classes::CompactState;
use super::journeys::{FreeMask, JourneyTables};

/// Tables of one kitchen for the cost to go that hold for all goals.
#[derive(Clone, Debug)]
pub struct KitchenTables {
    /// Numbers of presses that bring items through processing steps onto the board.
    pub journeys: JourneyTables,
    /// Index of the first physical location.
    pub first: usize,
    /// One past the index of the last physical location.
    pub last: usize,
    /// The location index of each agent's hand.
    pub hands: [usize; 2],
    /// The location index of the board.
    pub board: usize,
    /// The location index of the plate.
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
    /// Computes the cost-to-go tables of this kitchen.
    pub fn new(kitchen: &Kitchen) -> KitchenTables {
        let contents = kitchen.contents.len();
        let first = kitchen.orders.len();
        let last = kitchen.locations.len();
        let id = |index: usize| LocationId(index as u8);
        let content = |index: usize| ContentId(index as u8);
        let mut accepts = vec![false; last * contents];
        for location in first..last {
            for item in 1..contents {
                accepts[location * contents + item] = kitchen.accepts(id(location), content(item));
            }
        }
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

    /// Whether the location with this index is a hand.
    #[inline]
    pub fn is_hand(&self, location: usize) -> bool {
        self.is_hand[location]
    }

    /// Whether the location `location`, when empty, accepts the content `content`.
    #[inline]
    pub fn accepts(&self, location: usize, content: ContentId) -> bool {
        self.accepts[location * self.contents + content.index()]
    }

    /// Number of presses that serve a complete stack from the location with this index, without obstacles.
    #[inline]
    pub fn last_presses(&self, location: usize) -> u32 {
        self.last_presses[location]
    }

    /// Bit mask of the free hands and places in a state.
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
