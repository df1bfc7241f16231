//! Parallel processing of independent items.

use std::sync::{Mutex, MutexGuard};

use rayon::prelude::*;

/// Processes all items on all processors; results keep the order of the items. `done` is called after each item.
pub fn each<T: Sync, R: Send>(items: &[T], work: impl Fn(&T) -> R + Sync, done: impl Fn() + Sync) -> Vec<R> {
    each_with(items, || (), |(), item| work(item), done)
}

/// Processes all items on all processors, with a worker state per thread that is kept from item to item.
pub fn each_with<T: Sync, R: Send, W: Send>(
    items: &[T],
    own: impl Fn() -> W + Sync,
    work: impl Fn(&mut W, &T) -> R + Sync,
    done: impl Fn() + Sync,
) -> Vec<R> {
    WorkerPool::new(own).each(items, work, done)
}

/// Worker states (such as caches) change computing time, never results.
pub struct WorkerPool<W, F: Fn() -> W> {
    own: F,
    idle: Mutex<Vec<W>>,
}

impl<W: Send, F: Fn() -> W + Sync> WorkerPool<W, F> {
    /// A pool whose worker states are created by calling `own`, at most once per thread.
    pub fn new(own: F) -> WorkerPool<W, F> {
        WorkerPool { own, idle: Mutex::new(Vec::new()) }
    }

    /// Processes all items on all processors; results keep the order of the items. `done` is called after each item.
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
        // Items take long and differ in duration, so items are distributed to threads one by one.
        items.par_iter().with_max_len(1).map(one).collect()
    }

    fn idle(&self) -> MutexGuard<'_, Vec<W>> {
        self.idle.lock().unwrap_or_else(|poisoned| poisoned.into_inner())
    }
}
