//! Messages of a Rerun stream, kept for viewers that connect later, up to a limit in bytes; every viewer reads the kept
//! messages from a position of its own.
//!
//! Pieces (chunks) of an entity's data arrive several times per second, and each has an overhead of some kilobytes. A
//! number of pieces is merged into one, which needs a fraction of the memory. Beyond the limit the oldest pieces are
//! removed, but never the newest piece of an entity: a viewer that connects late still sees the present state. Of data
//! without a time only the newest is kept.

use std::collections::{BTreeMap, BTreeSet, HashMap};

/// Number of pieces of an entity's data that are merged into one.
const MERGED: usize = 64;
/// Number of an entity's newest pieces that are left unmerged. A viewer that keeps up has read all older pieces, so it
/// never receives a piece twice as part of a merged piece.
const RECENT: usize = 16;

/// A function that merges pieces of one entity; returns the merged piece with its size in bytes, or `None` if the
/// pieces cannot be merged.
pub(super) type Merge<M> = fn(&[M]) -> Option<(M, usize)>;

/// A piece (chunk) of the stream, with data of one entity.
#[derive(Debug)]
struct KeptPiece<M> {
    message: M,
    bytes: usize,
    /// Entity to which the piece belongs; `None` for pieces that are kept for ever.
    entity: Option<String>,
}

/// Bookkeeping of the kept pieces of one entity.
#[derive(Debug, Default)]
struct KeptEntity {
    newest: u64,
    /// Numbers of the entity's pieces that are not merged yet, oldest first.
    unmerged: Vec<u64>,
}

/// The kept messages of a Rerun stream.
#[derive(Debug)]
pub(super) struct KeptMessages<M> {
    most_bytes: usize,
    merge: Merge<M>,
    bytes: usize,
    /// Pieces of the stream by number, in the order of arrival.
    pieces: BTreeMap<u64, KeptPiece<M>>,
    /// Numbers of pieces that may be removed, since there is a newer piece of the same entity.
    outdated: BTreeSet<u64>,
    entities: HashMap<String, KeptEntity>,
    /// Numbers of messages without a time, by the name of what they say.
    timeless: HashMap<String, u64>,
    next: u64,
}

impl<M: Clone> KeptMessages<M> {
    /// An empty collection of messages; `most_bytes` limits the size of pieces that may be removed.
    pub fn new(most_bytes: usize, merge: Merge<M>) -> KeptMessages<M> {
        let (pieces, outdated) = (BTreeMap::new(), BTreeSet::new());
        let (entities, timeless) = (HashMap::new(), HashMap::new());
        KeptMessages { most_bytes, merge, bytes: 0, pieces, outdated, entities, timeless, next: 0 }
    }

    /// Adds a message of this size in bytes, which is kept until another one of this name comes, and for ever without a
    /// name.
    pub fn add_timeless(&mut self, message: M, bytes: usize, name: Option<String>) {
        let number = self.insert(message, bytes, None);
        if let Some(outdated) = name.and_then(|name| self.timeless.insert(name, number)) {
            self.remove(outdated);
        }
    }

    fn insert(&mut self, message: M, bytes: usize, entity: Option<&str>) -> u64 {
        let number = self.next;
        self.next += 1;
        self.bytes += bytes;
        self.pieces.insert(number, KeptPiece { message, bytes, entity: entity.map(str::to_string) });
        number
    }

    /// Adds a piece of an entity's data, of this size in bytes.
    pub fn add(&mut self, message: M, bytes: usize, name: &str) {
        let number = self.insert(message, bytes, Some(name));
        let kept =
            self.entities.entry(name.to_string()).or_insert_with(|| KeptEntity { newest: number, unmerged: vec![] });
        if kept.newest != number {
            self.outdated.insert(kept.newest);
            kept.newest = number;
        }
        kept.unmerged.push(number);
        if kept.unmerged.len() >= MERGED + RECENT {
            let numbers: Vec<u64> = kept.unmerged.drain(..MERGED).collect();
            self.merge(&numbers, name);
        }
        self.forget();
    }

    /// The first kept message whose number is at least `from`, with the message's number.
    pub fn next(&self, from: u64) -> Option<(u64, M)> {
        self.pieces.range(from..).next().map(|(number, piece)| (*number, piece.message.clone()))
    }

    /// Size of all kept messages in bytes.
    #[cfg(test)]
    fn bytes(&self) -> usize {
        self.bytes
    }

    /// Replaces these pieces by one merged piece. The merged piece gets the number of the last one: a viewer that has
    /// read that number has read all of them.
    fn merge(&mut self, numbers: &[u64], entity: &str) {
        let there: Vec<M> =
            numbers.iter().filter_map(|number| self.pieces.get(number)).map(|p| p.message.clone()).collect();
        let (Some((message, bytes)), Some(&last)) = ((self.merge)(&there), numbers.last()) else { return };
        numbers.iter().for_each(|number| self.remove(*number));
        self.bytes += bytes;
        self.pieces.insert(last, KeptPiece { message, bytes, entity: Some(entity.to_string()) });
        self.outdated.insert(last);
    }

    fn remove(&mut self, number: u64) {
        self.outdated.remove(&number);
        if let Some(piece) = self.pieces.remove(&number) {
            self.bytes -= piece.bytes;
        }
    }

    /// Removes the oldest pieces that may be removed, until the size limit is met.
    fn forget(&mut self) {
        while self.bytes > self.most_bytes {
            let Some(oldest) = self.outdated.first().copied() else { return };
            let entity = self.pieces.get(&oldest).and_then(|piece| piece.entity.clone());
            if let Some(kept) = entity.and_then(|entity| self.entities.get_mut(&entity)) {
                kept.unmerged.retain(|number| *number != oldest);
            }
            self.remove(oldest);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn join(pieces: &[String]) -> Option<(String, usize)> {
        Some((pieces.join("+"), 10))
    }

    fn all(kept: &KeptMessages<String>) -> Vec<(u64, String)> {
        let (mut from, mut found) = (0, Vec::new());
        while let Some((number, message)) = kept.next(from) {
            from = number + 1;
            found.push((number, message));
        }
        found
    }

    #[test]
    fn what_stays_and_the_newest_of_each_entity_are_kept_whatever_comes() {
        let mut kept = KeptMessages::new(100, |_: &[String]| None);
        for step in 0..3 {
            kept.add_timeless(format!("layout {step}"), 500, Some("layout".to_string()));
        }
        kept.add("seldom".to_string(), 10, "kitchen/plate");
        for step in 0..1000 {
            kept.add(format!("gaze {step}"), 10, "human/gaze");
        }
        let found: Vec<String> = all(&kept).into_iter().map(|(_, message)| message).collect();
        assert_eq!(found, ["layout 2", "seldom", "gaze 999"], "only what may go has gone");
        kept.add("later".to_string(), 10, "kitchen/plate");
        assert!(!all(&kept).iter().any(|(_, message)| message == "seldom"), "a newer one took its place");
    }

    #[test]
    fn the_oldest_go_first_and_memory_is_bounded() {
        let mut kept = KeptMessages::new(100, |_: &[String]| None);
        for step in 0..1000 {
            kept.add(format!("gaze {step}"), 7, "human/gaze");
            assert!(kept.bytes() <= 100);
        }
        let found = all(&kept);
        let numbers: Vec<u64> = found.iter().map(|(number, _)| *number).collect();
        assert_eq!(numbers, (1000 - 14..1000).collect::<Vec<u64>>());
        // Test: a slow viewer continues with the oldest message that is still kept.
        assert_eq!(kept.next(3).map(|(number, _)| number), Some(1000 - 14));
        assert_eq!(kept.next(1000), None);
    }

    #[test]
    fn pieces_are_merged_and_nobody_misses_one() {
        let mut kept = KeptMessages::new(1 << 20, join);
        for step in 0..MERGED + RECENT {
            kept.add(format!("{step}"), 100, "human/gaze");
        }
        let merged = (0..MERGED).map(|step| step.to_string()).collect::<Vec<_>>().join("+");
        let found = all(&kept);
        assert_eq!((found.len(), &found[0]), (1 + RECENT, &(MERGED as u64 - 1, merged.clone())));
        assert_eq!(kept.bytes(), 10 + 100 * RECENT);
        // Test: a viewer that has read some of the merged pieces gets the whole merged piece; a viewer that has read
        // all of them gets the next piece.
        assert_eq!(kept.next(10).map(|(_, message)| message), Some(merged));
        assert_eq!(kept.next(MERGED as u64), Some((MERGED as u64, MERGED.to_string())));
    }

    #[test]
    fn a_viewer_that_keeps_up_gets_every_piece_once() {
        let mut kept = KeptMessages::new(1 << 20, join);
        let (mut from, mut read) = (0, Vec::new());
        for step in 0..1000 {
            kept.add(step.to_string(), 100, ["human/gaze", "robot/arm"][step % 2]);
            // Test: the viewer has not yet read the last few pieces.
            if step % 10 == 9 {
                while let Some((number, message)) = kept.next(from) {
                    (from, read) = (number + 1, [read, vec![message]].concat());
                }
            }
        }
        assert_eq!(read, (0..1000).map(|step| step.to_string()).collect::<Vec<String>>());
    }

    #[test]
    fn merged_pieces_go_like_others() {
        let mut kept = KeptMessages::new(500, join);
        for step in 0..100_000 {
            kept.add(format!("{step}"), 1, ["a", "b", "c"][step % 3]);
            assert!(kept.bytes() <= 500, "{} at {step}", kept.bytes());
        }
        assert!(all(&kept).iter().any(|(_, message)| message.contains('+')), "room enough for merged pieces");
        assert!(kept.entities.values().all(|entity| entity.unmerged.len() < MERGED + RECENT));
    }
}
