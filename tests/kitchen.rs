//! The kitchen: what is computed from the files.

use std::path::Path;

use tomcom::edge::files::read_kitchen;
use tomcom::kitchen::Kitchen;

fn sushi() -> Kitchen {
    read_kitchen(Path::new("layouts/sushi.toml")).expect("the sushi kitchen loads").kitchen
}

#[test]
fn the_state_space_has_the_size_of_the_paper() {
    let kitchen = sushi();
    let sizes: Vec<(&str, usize)> = kitchen.aspects.iter().map(|a| (a.name.as_str(), a.values.len())).collect();
    println!("{sizes:?}");
    assert_eq!(kitchen.state_count(), 83_878_450_387_200_000);
}
