//! What a participant learns about the kitchen in the instruction: the action of each button, and how items are made.

use tomcom_core::kitchen::{Agent, ButtonAction, ButtonId, ContentId, Kitchen, LocationId};

/// Longest chain of processing steps from an ingredient to a part of a dish.
const MOST_STEPS: usize = 8;

/// How an item is made: the processing step, and the item to which the step is applied.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ItemPreparation {
    /// The processing step, as an index into the kitchen's list [`Kitchen::processes`].
    pub process: u8,
    /// The item before the processing step.
    pub from: ContentId,
    /// Place of the processing step; `None` if the step is done in the hand of the agent who presses.
    pub place: Option<LocationId>,
}

/// The task as the participant knows it: the human's buttons by their actions, and the processing steps of every item.
#[derive(Clone, Debug)]
pub struct TaskKnowledge {
    takes: Vec<Option<ButtonId>>,
    uses: Vec<Option<ButtonId>>,
    processes: Vec<Option<ButtonId>>,
    serves: Vec<Option<ButtonId>>,
    /// The human's button that throws away what the hand holds.
    pub trash: Option<ButtonId>,
    makings: Vec<Option<ItemPreparation>>,
    is_station: Vec<bool>,
}

impl TaskKnowledge {
    /// Complete and correct knowledge of a kitchen's buttons and processing steps.
    pub fn new(kitchen: &Kitchen) -> TaskKnowledge {
        let mut knowledge = TaskKnowledge {
            takes: vec![None; kitchen.contents.len()],
            uses: vec![None; kitchen.locations.len()],
            processes: vec![None; kitchen.processes.len()],
            serves: vec![None; kitchen.locations.len()],
            trash: None,
            makings: vec![None; kitchen.contents.len()],
            is_station: vec![false; kitchen.locations.len()],
        };
        for (index, button) in kitchen.buttons[Agent::Human.index()].iter().enumerate() {
            let id = Some(ButtonId(index as u8));
            match button.action {
                ButtonAction::Take(item) => knowledge.takes[item.index()] = id,
                ButtonAction::Use(location) => knowledge.uses[location.index()] = id,
                ButtonAction::Process(process) => knowledge.processes[usize::from(process)] = id,
                ButtonAction::Serve(order) => knowledge.serves[order.index()] = id,
                ButtonAction::Trash => knowledge.trash = id,
            }
        }
        for (index, process) in kitchen.processes.iter().enumerate() {
            if let Some(place) = process.place {
                knowledge.is_station[place.index()] = true;
            }
            for &(from, to) in &process.steps {
                let making = ItemPreparation { process: index as u8, from, place: process.place };
                knowledge.makings[to.index()].get_or_insert(making);
            }
        }
        knowledge.is_station[kitchen.board.index()] = true;
        knowledge.is_station[kitchen.plate.index()] = true;
        knowledge
    }

    /// The human's button that takes this item from a storage.
    pub fn take(&self, item: ContentId) -> Option<ButtonId> {
        self.takes[item.index()]
    }

    /// The human's button of a place, which puts an item down there or picks one up.
    pub fn at(&self, place: LocationId) -> Option<ButtonId> {
        self.uses[place.index()]
    }

    /// The human's button of a processing step.
    pub fn process(&self, process: u8) -> Option<ButtonId> {
        self.processes[usize::from(process)]
    }

    /// The human's button that serves an order.
    pub fn serve(&self, order: LocationId) -> Option<ButtonId> {
        self.serves[order.index()]
    }

    /// Whether items are stacked, processed or served at a place, so that the place is more than a parking place.
    pub fn is_station(&self, place: LocationId) -> bool {
        self.is_station[place.index()]
    }

    /// How an item is made; `None` for an item that comes from a storage.
    pub fn making(&self, item: ContentId) -> Option<ItemPreparation> {
        self.makings[item.index()]
    }

    /// The number of processing steps from `content` to `part`; `None` if the content cannot become that part.
    pub fn steps_to(&self, content: ContentId, part: ContentId) -> Option<u8> {
        let mut item = part;
        for steps in 0..MOST_STEPS {
            if item == content {
                return Some(steps as u8);
            }
            item = self.making(item)?.from;
        }
        None
    }

    /// The next processing step of `content` on the way to `part`; `None` if the content is that part already, or can
    /// never become it.
    pub fn next_making(&self, content: ContentId, part: ContentId) -> Option<ItemPreparation> {
        let mut item = part;
        for _ in 0..MOST_STEPS {
            let making = self.making(item)?;
            if making.from == content {
                return Some(making);
            }
            item = making.from;
        }
        None
    }

    /// The ingredient, taken from a storage, from which a part is made.
    pub fn ingredient(&self, part: ContentId) -> ContentId {
        let mut item = part;
        for _ in 0..MOST_STEPS {
            match self.making(item) {
                Some(making) => item = making.from,
                None => break,
            }
        }
        item
    }
}
