//! The distinct draws of a belief sample: draws with equal values give one world.

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
pub(super) struct Alike {
    key: Key,
    pub(super) first: usize,
    pub(super) draws: u32,
}

/// The groups of equal draws in one belief sample.
#[derive(Clone, Debug, Default)]
pub(super) struct DistinctDraws {
    pub(super) groups: Vec<Alike>,
    /// The values of the aspects with several values in the belief sample, by draw.
    keys: Vec<Key>,
}

impl DistinctDraws {
    /// Groups `states` draws by equality of their values; `rows` has a row of values for each aspect of which there are
    /// several.
    pub(super) fn tell_apart(&mut self, states: usize, rows: &[u8]) {
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
