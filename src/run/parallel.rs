//! Independent work on all processors.

use std::sync::Mutex;

/// Does the same with every item on all processors; the results have the order of the items. `done` is called after each.
pub fn each<T: Sync, R: Send>(items: &[T], work: impl Fn(&T) -> R + Sync, done: impl Fn() + Sync) -> Vec<R> {
    each_with(items, || (), |(), item| work(item), done)
}

/// The same, where every thread has something of its own from item to item.
pub fn each_with<T: Sync, R: Send, W>(
    items: &[T],
    own: impl Fn() -> W + Sync,
    work: impl Fn(&mut W, &T) -> R + Sync,
    done: impl Fn() + Sync,
) -> Vec<R> {
    let left = Mutex::new(items.iter().enumerate());
    let results = Mutex::new(Vec::with_capacity(items.len()));
    let worker = || {
        let mut own = own();
        loop {
            let one = left.lock().unwrap_or_else(|poisoned| poisoned.into_inner()).next();
            let Some((index, item)) = one else { return };
            let result = work(&mut own, item);
            results.lock().unwrap_or_else(|poisoned| poisoned.into_inner()).push((index, result));
            done();
        }
    };
    let threads = std::thread::available_parallelism().map_or(1, |count| count.get()).min(items.len());
    std::thread::scope(|scope| {
        for _ in 0..threads {
            scope.spawn(worker);
        }
    });
    let mut results = results.into_inner().unwrap_or_else(|poisoned| poisoned.into_inner());
    results.sort_by_key(|(index, _)| *index);
    results.into_iter().map(|(_, result)| result).collect()
}
