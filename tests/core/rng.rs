//! Named random streams.

use rand::RngExt;
use tomcom_core::base::rng::{of_trial, shuffle, stream};

#[test]
fn streams_repeat_and_differ_by_name_seed_and_index() {
    let draw = |seed, name, index| stream(seed, name, index).random::<u64>();
    assert_eq!(draw(7, "robot", 0), draw(7, "robot", 0));
    assert_ne!(draw(7, "robot", 0), draw(7, "robot", 1));
    assert_ne!(draw(7, "robot", 0), draw(8, "robot", 0));
    assert_ne!(draw(7, "robot", 0), draw(7, "orders", 0));
    assert_ne!(of_trial(7, 0), of_trial(7, 1));
    assert_ne!(of_trial(7, 0), of_trial(8, 0));
}

#[test]
fn a_seed_shuffles_a_list_always_into_the_same_order() {
    let mut list: Vec<u8> = (0..8).collect();
    shuffle(&mut list, &mut stream(7, "shuffle", 0));
    assert_eq!(list, [2, 4, 7, 6, 5, 1, 3, 0]);
}
