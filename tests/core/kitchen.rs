//! The kitchen: what is computed from the files, the rules of the task, and the files that cannot be.

use std::path::PathBuf;
use std::sync::Arc;

use rand::RngExt;
use tomcom_core::base::rng::stream;
use tomcom_core::kitchen::cost_to_go::CostToGo;
use tomcom_core::kitchen::{
    Agent, AspectId, ButtonId, ContentId, DishId, Kitchen, LocationId, LocationKind, OrderContent, State,
};

use crate::files::{load, place, read};

fn layouts() -> Vec<Kitchen> {
    let entries = std::fs::read_dir(place("layouts")).expect("the folder layouts");
    let mut paths: Vec<PathBuf> = entries.map(|entry| entry.expect("an entry").path()).collect();
    paths.sort();
    assert!(paths.len() > 1, "a second kitchen of another dish");
    paths.iter().map(load).collect()
}

/// Plays presses given as "human: take rice" from an empty kitchen with these orders; `!` marks an ineffective press.
fn check(kitchen: &Kitchen, orders: &[&str], presses: &[&str], expected: &[(&str, &str)]) -> State {
    let recipes = kitchen.true_recipes();
    let mut state = kitchen.empty_state();
    for (&location, name) in kitchen.orders.iter().zip(orders) {
        state.set_order(location, OrderContent::Dish(kitchen.dish_named(name).expect("a dish of the menu")));
    }
    for press in presses {
        let (who, name) = press.split_once(": ").expect("agent: button");
        let agent = if who.ends_with("human") { Agent::Human } else { Agent::Robot };
        let button = kitchen.button_named(agent, name).unwrap_or_else(|| panic!("the button of {press}"));
        let after = kitchen.press(state, &recipes, agent, button);
        assert_eq!(after.is_none(), who.starts_with('!'), "{press}");
        state = after.unwrap_or(state);
    }
    for (location, content) in expected {
        let id = kitchen.location_named(location).expect("a location");
        let aspect = AspectId::of_location(id);
        assert_eq!(kitchen.aspects[aspect.index()].labels[kitchen.true_value(state, aspect)], *content, "{location}");
    }
    state
}

#[test]
fn the_state_space_has_the_size_of_the_paper() {
    let kitchen = load("layouts/sushi.toml");
    let size = |name: &str| kitchen.aspects.iter().find(|aspect| aspect.name == name).map(|a| a.values.len());
    for name in ["human_hand", "robot_hand", "assembly_board", "plate", "counter"] {
        assert_eq!(size(name), Some(37), "{name}");
    }
    assert_eq!(size("cutting_board"), Some(21));
    assert_eq!(size("cooking_pot"), Some(15));
    assert_eq!(size("order_1"), Some(8));
    assert_eq!(size("order_2"), Some(8));
    assert_eq!(size("rolling_mat"), Some(6));
    for (dish, variants) in [
        ("salmon nigiri", 5),
        ("tuna nigiri", 5),
        ("salmon maki", 5),
        ("tuna maki", 5),
        ("shrimp nigiri", 4),
        ("crab maki", 4),
    ] {
        assert_eq!(size(&format!("recipe of {dish}")), Some(variants), "{dish}");
    }
    assert_eq!(kitchen.aspects.len(), 16);
    assert_eq!(kitchen.state_count(), 83_878_450_387_200_000);
}

#[test]
fn contents_are_the_items_and_all_stacks() {
    let of_size = |kitchen: &Kitchen, size| kitchen.contents.iter().filter(|c| c.items.len() == size).count();
    let sushi = load("layouts/sushi.toml");
    assert_eq!([0, 1, 2, 3].map(|size| of_size(&sushi, size)), [1, 14, 14, 8]);
    let off_menu: Vec<&str> =
        sushi.contents[29..].iter().map(|c| c.name.as_str()).filter(|n| n.contains('+')).collect();
    assert_eq!(off_menu, ["rice cooked + nori + shrimp cut", "rice shaped + nori + crab cut"]);
    let burger = load("layouts/burger.toml");
    assert_eq!([0, 1, 2, 3, 4].map(|size| of_size(&burger, size)), [1, 12, 23, 28, 12]);
}

#[test]
fn look_alikes_are_mutual_and_differ_in_one_ingredient() {
    for kitchen in layouts() {
        for (index, content) in kitchen.contents.iter().enumerate() {
            for &alike in &content.look_alikes {
                let twin = kitchen.content(alike);
                assert!(twin.look_alikes.contains(&ContentId(index as u8)), "{} and {}", content.name, twin.name);
                let shared = content.items.iter().filter(|item| twin.items.contains(item)).count();
                assert_eq!(shared + 1, content.items.len(), "{} and {}", content.name, twin.name);
            }
        }
    }
}

#[test]
fn a_recipe_can_be_taken_for_what_the_specification_says() {
    let kitchen = load("layouts/sushi.toml");
    let variants = |name: &str| {
        let dish = kitchen.dishes.iter().find(|dish| dish.name == name).expect("a dish");
        dish.variants.iter().map(|&variant| kitchen.content(variant).name.as_str()).collect::<Vec<_>>()
    };
    let salmon_maki = ["salmon maki", "tuna maki", "rice cooked + nori + shrimp cut", "crab maki", "salmon nigiri"];
    assert_eq!(variants("salmon maki"), salmon_maki);
    let crab_maki = ["crab maki", "rice cooked + nori + shrimp cut", "rice shaped + nori + crab cut", "shrimp nigiri"];
    let mut found = variants("crab maki");
    assert_eq!(found[0], "crab maki");
    found.sort_unstable();
    let mut expected = crab_maki;
    expected.sort_unstable();
    assert_eq!(found, expected);
}

#[test]
fn items_are_taken_put_down_picked_up_and_thrown_away() {
    let kitchen = load("layouts/sushi.toml");
    let presses = ["human: take rice", "!human: take nori", "human: cooking_pot", "!human: trash", "!human: counter"];
    check(&kitchen, &[], &presses, &[("cooking_pot", "rice raw"), ("human_hand", "empty")]);
    let presses = ["robot: take tuna", "robot: counter", "human: counter", "!robot: counter"];
    check(&kitchen, &[], &presses, &[("human_hand", "tuna raw"), ("counter", "empty")]);
    let presses = ["human: take crab", "!human: rolling_mat", "human: trash"];
    check(&kitchen, &[], &presses, &[("human_hand", "empty"), ("rolling_mat", "empty")]);
    let presses = ["human: take rice", "human: counter", "robot: take nori", "!robot: counter"];
    check(&kitchen, &[], &presses, &[("counter", "rice raw"), ("robot_hand", "nori")]);
}

#[test]
fn processes_change_what_they_are_for_and_nothing_else() {
    let kitchen = load("layouts/sushi.toml");
    let presses = ["human: take rice", "!human: shape", "human: cooking_pot", "robot: cook", "!robot: cook"];
    check(&kitchen, &[], &presses, &[("cooking_pot", "rice cooked")]);
    let presses = ["human: take crab", "human: cutting_board", "!human: cut", "human: cutting_board"];
    check(&kitchen, &[], &presses, &[("human_hand", "crab raw")]);
    assert!(kitchen.button_named(Agent::Robot, "shape").is_none(), "only the human shapes");
    assert!(kitchen.button_named(Agent::Robot, "take crab").is_none(), "shellfish is the human's");
    assert!(kitchen.button_named(Agent::Human, "take tuna").is_none(), "tuna is the robot's");
}

/// A salmon maki from an empty kitchen, in the least number of presses.
fn salmon_maki() -> Vec<&'static str> {
    let presses = "human: take rice, human: cooking_pot, human: cook, human: cooking_pot, \
                   human: assembly_board, human: take nori, human: assembly_board, robot: take salmon, \
                   robot: cutting_board, human: cut, robot: cutting_board, robot: assembly_board, \
                   human: assembly_board, human: plate, robot: serve 2";
    presses.split(", ").collect()
}

#[test]
fn only_the_ordered_dish_is_served() {
    let kitchen = load("layouts/sushi.toml");
    check(&kitchen, &["tuna maki", "salmon maki"], &salmon_maki(), &[("order_2", "served"), ("plate", "empty")]);
    let before = &salmon_maki()[..14];
    let wrong = [before, &["!human: serve 1", "!robot: serve 1", "!human: serve 2"]].concat();
    check(&kitchen, &["tuna maki", "salmon nigiri"], &wrong, &[("plate", "salmon maki"), ("order_1", "tuna maki")]);
}

#[test]
fn stacking_takes_one_of_each_slot() {
    let kitchen = load("layouts/sushi.toml");
    let again = [&salmon_maki()[..7], &["human: take nori", "!human: assembly_board"]].concat();
    check(&kitchen, &[], &again, &[("assembly_board", "rice cooked + nori"), ("human_hand", "nori")]);
    let raw = [&salmon_maki()[..8], &["!robot: assembly_board"]].concat();
    check(&kitchen, &[], &raw, &[("robot_hand", "salmon raw")]);
    let carried = [&salmon_maki()[..7], &["human: assembly_board", "human: rolling_mat"]].concat();
    check(&kitchen, &[], &carried, &[("assembly_board", "empty"), ("rolling_mat", "rice cooked + nori")]);
}

#[test]
fn a_burger_is_made_of_four_things_in_fourteen_presses() {
    let kitchen = load("layouts/burger.toml");
    let presses = "human: take soy, human: grill_plate, robot: grill, human: grill_plate, human: board, \
                   robot: take dark bun, robot: board, robot: take lettuce, robot: board, human: take cheese, \
                   human: board, human: board, human: tray, human: serve 1";
    let presses: Vec<&str> = presses.split(", ").collect();
    check(&kitchen, &["leaf burger"], &presses, &[("order", "served"), ("tray", "empty")]);
    let sliced = ["human: take tomato", "human: slice", "!human: slice", "!human: grill_plate", "human: board"];
    check(&kitchen, &[], &sliced, &[("board", "tomato sliced")]);
}

/// All the ingredients in the kitchen, sorted.
fn ingredients(kitchen: &Kitchen, state: State) -> Vec<usize> {
    let places = kitchen.location_ids().filter(|&place| kitchen.location(place).kind != LocationKind::Order);
    let contents = places.map(|place| state.content(place));
    let items = contents.flat_map(|content| kitchen.content(content).items.clone());
    let mut all: Vec<usize> = items.filter_map(|item| kitchen.content(item).ingredient).collect();
    all.sort_unstable();
    all
}

#[test]
fn random_presses_create_and_lose_nothing() {
    use tomcom_core::kitchen::ButtonAction;
    for kitchen in layouts() {
        let mut random = stream(1, "kitchen test", 0);
        let recipes = kitchen.true_recipes();
        let mut state = kitchen.empty_state();
        for _ in 0..20_000 {
            if random.random_bool(0.01) {
                let order = kitchen.orders[random.random_range(0..kitchen.orders.len())];
                let dish = DishId(random.random_range(0..kitchen.dishes.len()) as u8);
                state.set_order(order, OrderContent::Dish(dish));
            }
            let agent = Agent::BOTH[random.random_range(0..2)];
            let button = ButtonId(random.random_range(0..kitchen.buttons[agent.index()].len()) as u8);
            let before = ingredients(&kitchen, state);
            let Some(next) = kitchen.press(state, &recipes, agent, button) else { continue };
            assert_ne!(next, state, "an effective press changes something");
            let may_lie = |at: LocationId| kitchen.aspects[at.index()].index_of(next.code(at)).is_some();
            assert!(kitchen.location_ids().all(may_lie), "everything lies where it may");
            let after = ingredients(&kitchen, next).len();
            let held = kitchen.content(state.content(kitchen.hands[agent.index()])).items.len();
            match kitchen.button(agent, button).action {
                ButtonAction::Take(_) => assert_eq!(after, before.len() + 1),
                ButtonAction::Trash => assert_eq!(after, before.len() - held),
                ButtonAction::Serve(_) => {
                    assert_eq!(after, before.len() - kitchen.content(state.content(kitchen.plate)).items.len())
                }
                ButtonAction::Use(_) | ButtonAction::Process(_) => assert_eq!(ingredients(&kitchen, next), before),
            }
            state = next;
        }
    }
}

#[test]
fn a_kitchen_that_is_too_large_is_refused() {
    let mut layout = read("layouts/sushi.toml");
    for accepts in ["[\"bases\"]", "[\"ingredients\"]", "[\"ingredients\", \"dishes\"]"] {
        layout = layout.replace(&format!("accepts = {accepts}"), "accepts = [\"anything\"]");
    }
    let refused = Kitchen::from_toml(&layout, &read("recipes/sushi.toml"));
    let message = refused.expect_err("37^8 is too many").to_string();
    assert!(message.contains("3512479453921 ways to fill the locations"), "{message}");
}

/// The tiny kitchen with a third topping, so that a place that accepts everything has 8 contents, and with so many places
/// like that beside the hands and the board.
fn of_eight_contents(places: usize, plate: &str) -> Result<Kitchen, String> {
    let third = "looks_like = [\"ham\"]\n\n[[ingredient]]\nname = \"cheese\"\nlooks_like = [\"ham\"]";
    let recipes = read("tests/kitchens/tiny-recipes.toml")
        .replace("looks_like = [\"salami\"]", "looks_like = [\"salami\", \"cheese\"]")
        .replace("looks_like = [\"ham\"]", third)
        .replace("\"ham\", \"salami\"]", "\"ham\", \"salami\", \"cheese\"]");
    let recipes = recipes + "\n[[dish]]\nname = \"cheese bread\"\nitems = [\"bread\", \"cheese\"]\n";
    let accepts = format!("accepts = [\"{plate}\"]");
    let mut layout = read("tests/kitchens/tiny.toml").replace("accepts = [\"dishes\"]", &accepts);
    layout += "\n[[storage]]\nagent = \"human\"\ningredient = \"cheese\"\n\
               display = { x = 0.90, y = 0.75, w = 0.08, h = 0.10 }\nbutton = { at_m = [0.64, -0.04], key = \"w\" }\n";
    layout = layout.replace("width_m = 1.5", "width_m = 6.0").replace("height_m = 0.84375", "height_m = 3.375");
    for (index, key) in (0..places).zip("dfghjkvbnm".chars()) {
        let column = index as f64;
        layout += &format!(
            "\n[[place]]\nname = \"shelf_{index}\"\naccepts = [\"anything\"]\n\
             display = {{ x = {:.2}, y = 0.62, w = 0.05, h = 0.05 }}\n\
             button = {{ at_m = [{:.2}, 0.0], key = \"{key}\" }}\n",
            0.1 + 0.08 * column,
            0.3 + 0.05 * column,
        );
    }
    Kitchen::from_toml(&layout, &recipes).map_err(|error| format!("{error}: {}", error.remedy))
}

/// Keys of the cost to go have 38 bits for the state: 13 places of 8 contents have 2^39 states. With a plate of 4 contents
/// there are 2^38, the most that is admitted, and every state has its own cost.
#[test]
fn the_largest_kitchen_has_a_key_for_every_state() {
    let refused = of_eight_contents(9, "anything").expect_err("too many");
    assert!(refused.contains("549755813888 ways to fill the locations"), "{refused}");
    assert!(refused.contains("at most 274877906944"), "{refused}");
    let kitchen = Arc::new(of_eight_contents(9, "dishes").expect("at the limit"));
    let recipes = kitchen.true_recipes();
    let physical: Vec<LocationId> = kitchen.location_ids().skip(kitchen.orders.len()).collect();
    let mut shared = CostToGo::new(kitchen.clone());
    for number in 0..30 {
        let mut random = stream(10, "states at the limit", number);
        let mut state = kitchen.empty_state();
        state.set_order(kitchen.orders[0], OrderContent::Dish(DishId(0)));
        for &location in &physical {
            let content = ContentId(random.random_range(0..kitchen.contents.len()) as u8);
            if kitchen.accepts(location, content) {
                state.set_content(location, content);
            }
        }
        // States that differ in the highest digits only have equal keys if bits are cut.
        for content in 0..kitchen.contents.len() {
            state.set_content(*physical.last().expect("places"), ContentId(content as u8));
            let alone = CostToGo::new(kitchen.clone()).all_orders(state, &recipes);
            assert_eq!(shared.all_orders(state, &recipes), alone, "state {number}, content {content}");
        }
    }
}

/// The sushi kitchen with other words.
fn reworded(words: &str) -> Kitchen {
    let recipes = read("recipes/sushi.toml").split("\n[words.de]").next().expect("the first part").to_string();
    Kitchen::from_toml(&read("layouts/sushi.toml"), &format!("{recipes}\n{words}")).expect("a kitchen")
}

#[test]
fn contents_are_worded_by_default_and_as_the_recipe_file_says_while_names_stay() {
    let kitchen = load("layouts/sushi.toml");
    let wording = |kitchen: &Kitchen, name: &str| kitchen.worded(name).to_string();
    for (name, words) in [
        ("empty", "empty"),
        ("nori", "nori"),
        ("rice cooked", "cooked rice"),
        ("rice cooked + nori", "cooked rice + nori"),
        ("rice shaped + nori + crab cut", "shaped rice + nori + cut crab"),
        ("salmon maki", "salmon maki"),
        ("served", "served"),
    ] {
        assert_eq!(wording(&kitchen, name), words);
    }
    let own = "[words.en]\n\"rice cooked\" = \"boiled rice\"\n\"crab maki\" = \"crab roll\"\n";
    let kitchen = reworded(own);
    for (name, words) in
        [("rice cooked + nori", "boiled rice + nori"), ("rice raw", "raw rice"), ("crab maki", "crab roll")]
    {
        assert_eq!(wording(&kitchen, name), words);
        assert!(kitchen.content_named(name).is_some(), "the name in logs stays: {name}");
    }
    let order = kitchen.location_named("order_1").expect("an order");
    let mut state = kitchen.empty_state();
    state.set_order(order, OrderContent::Dish(kitchen.dish_named("crab maki").expect("a dish")));
    assert_eq!(kitchen.content_label(state, order), "crab roll");
    let without = reworded("");
    assert_eq!(wording(&without, "rice cooked"), "cooked rice");
    assert!(without.words.in_language("de").is_empty());
}

#[test]
fn a_dish_is_called_by_its_name_also_where_that_looks_like_a_stack() {
    let recipes = read("recipes/sushi.toml").replace("crab maki", "crab + maki");
    let kitchen = Kitchen::from_toml(&read("layouts/sushi.toml"), &recipes).expect("a kitchen");
    assert_eq!(kitchen.worded("crab + maki"), "crab + maki");
    let stack = kitchen.content(kitchen.content_named("crab + maki").expect("a stack"));
    assert!(stack.is_dish && stack.wording == "crab + maki", "{stack:?}");
    assert_eq!(kitchen.worded("rice cooked + nori"), "cooked rice + nori");
}
