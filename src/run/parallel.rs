//! Independent work on all processors.

use std::sync::{Mutex, MutexGuard};

use rayon::prelude::*;

/// Does the same with every item on all processors; the results have the order of the items. `done` is called after each.
pub fn each<T: Sync, R: Send>(items: &[T], work: impl Fn(&T) -> R + Sync, done: impl Fn() + Sync) -> Vec<R> {
    each_with(items, || (), |(), item| work(item), done)
}

/// The same, where every thread has something of its own from item to item.
pub fn each_with<T: Sync, R: Send, W: Send>(
    items: &[T],
    own: impl Fn() -> W + Sync,
    work: impl Fn(&mut W, &T) -> R + Sync,
    done: impl Fn() + Sync,
) -> Vec<R> {
    WorkerPool::new(own).each(items, work, done)
}

/// Threads with something of their own that lasts: a cache, say, which changes the time that work takes, and not what comes
/// of it.
pub struct WorkerPool<W, F: Fn() -> W> {
    own: F,
    /// What nobody works with at the moment.
    idle: Mutex<Vec<W>>,
}

impl<W: Send, F: Fn() -> W + Sync> WorkerPool<W, F> {
    /// Workers who make what they need with `own`, at most once for each thread.
    pub fn new(own: F) -> WorkerPool<W, F> {
        WorkerPool { own, idle: Mutex::new(Vec::new()) }
    }

    /// Does the same with every item; the results have the order of the items. `done` is called after each.
    pub fn each<T: Sync, R: Send>(
        &self,
        items: &[T],
        work: impl Fn(&mut W, &T) -> R + Sync,
        done: impl Fn() + Sync,
    ) -> Vec<R> {
        let one = |item: &T| {
            let idle = self.idle().pop();
            let mut mine = idle.unwrap_or_else(&self.own);
            let result = work(&mut mine, item);
            self.idle().push(mine);
            done();
            result
        };
        // Items take long and differ, so each is given out by itself.
        items.par_iter().with_max_len(1).map(one).collect()
    }

    fn idle(&self) -> MutexGuard<'_, Vec<W>> {
        self.idle.lock().unwrap_or_else(|poisoned| poisoned.into_inner())
    }
}
