//! The distinct worlds of a belief sample: draws with equal values give one world.

use crate::base::bits::ones;
use crate::kitchen::{AspectId, Kitchen, World};

use super::evidence::{BeliefSampler, Sample, UNDRAWN};
use super::look_news::ValueSeenByLook;
use super::order_focus::considered;

/// The draws of one belief sample that give the same world: index of the first draw, and number of draws.
#[derive(Clone, Copy, Debug)]
pub(super) struct Run {
    pub(super) world: u32,
    pub(super) first: u32,
    pub(super) draws: u32,
}

/// The values of up to 32 aspects, one byte each.
type Key = [u64; 4];
/// Number of values in one of the four parts of a key.
const KEY_PART: usize = (u64::BITS / u8::BITS) as usize;

/// The equal draws of one belief sample: their values, the index of the first draw, and the number of draws.
#[derive(Clone, Copy, Debug)]
struct Alike {
    key: Key,
    first: usize,
    draws: u32,
}

/// The groups of equal draws in one belief sample.
#[derive(Clone, Debug, Default)]
pub(super) struct DistinctDraws {
    groups: Vec<Alike>,
    /// The values of the aspects with several values in the belief sample, by draw.
    keys: Vec<Key>,
}

impl DistinctDraws {
    /// Groups `states` draws by equality of their values; `rows` has a row of values for each aspect of which there are
    /// several.
    fn tell_apart(&mut self, states: usize, rows: &[u8]) {
        self.groups.clear();
        if rows.is_empty() {
            return self.groups.push(Alike { key: Key::default(), first: 0, draws: states as u32 });
        }
        self.keys.clear();
        self.keys.resize(states, Key::default());
        for (index, row) in rows.chunks_exact(states).enumerate() {
            for (key, &value) in self.keys.iter_mut().zip(row) {
                let part = &mut key[index / KEY_PART];
                *part = *part << u8::BITS | u64::from(value);
            }
        }
        for (first, &key) in self.keys.iter().enumerate() {
            match self.groups.iter_mut().find(|alike| alike.key == key) {
                Some(alike) => alike.draws += 1,
                None => self.groups.push(Alike { key, first, draws: 1 }),
            }
        }
    }
}

impl BeliefSampler {
    /// Counts the distinct worlds of the newest belief sample.
    pub(super) fn count_worlds(&mut self, kitchen: &Kitchen, states: usize) {
        let index = self.samples.len() - 1;
        let Sample { rows, focus, .. } = self.samples[index];
        self.alike.tell_apart(states, &self.rows[rows..]);
        for group in 0..self.alike.groups.len() {
            let Alike { first, draws, .. } = self.alike.groups[group];
            let world = considered(kitchen, self.world_of(kitchen, index, first, states), focus);
            let world = self.worlds.count(world, draws);
            self.runs.push(Run { world, first: first as u32, draws });
        }
        self.samples[index].runs[1] = self.runs.len();
    }

    /// The world of one draw of a belief sample.
    fn world_of(&self, kitchen: &Kitchen, index: usize, draw: usize, states: usize) -> World {
        let aspects = self.urns.len();
        let Sample { mixed, rows, .. } = self.samples[index];
        let mut world = World::empty(kitchen);
        let firsts = &self.firsts[index * aspects..][..aspects];
        for (aspect, &value) in firsts.iter().enumerate().filter(|(_, value)| **value != UNDRAWN) {
            world.set_value(kitchen, AspectId(aspect as u8), usize::from(value));
        }
        for (aspect, row) in ones(mixed).zip(self.rows[rows..].chunks_exact(states)) {
            world.set_value(kitchen, AspectId(aspect as u8), usize::from(row[draw]));
        }
        world
    }

    /// Replaces the worlds of a belief sample by worlds with the values that the sample has learned from looks.
    pub(super) fn believe_news(&mut self, kitchen: &Kitchen, index: usize, news: [usize; 2], states: usize) {
        let Sample { runs: [first, last], focus, .. } = self.samples[index];
        for run in first..last {
            let Run { first, draws, .. } = self.runs[run];
            let mut world = self.world_of(kitchen, index, first as usize, states);
            for &ValueSeenByLook { aspect, value, .. } in &self.news[news[0]..news[1]] {
                world.set_value(kitchen, AspectId(aspect as u8), usize::from(value));
            }
            self.runs[run].world = self.worlds.count(considered(kitchen, world, focus), draws);
        }
    }
}
