//! The robot's task policy: what it does next, and when it leaves the next press to the human.

use std::path::Path;
use std::sync::Arc;

use tomcom::base::rng::stream;
use tomcom::edge::files::read_kitchen;
use tomcom::kitchen::cost_to_go::CostToGo;
use tomcom::kitchen::{Agent, DishId, Kitchen, OrderContent, State};
use tomcom::robot::IdleReason;
use tomcom::robot::policy::{Decision, decide};

fn sushi() -> Arc<Kitchen> {
    Arc::new(read_kitchen(Path::new("layouts/sushi.toml")).expect("the sushi kitchen loads").kitchen)
}

/// The state with these orders and contents.
fn state(kitchen: &Kitchen, orders: &[&str], contents: &[(&str, &str)]) -> State {
    let mut state = kitchen.empty_state();
    for (&order, name) in kitchen.orders.iter().zip(orders) {
        let dish = kitchen.dishes.iter().position(|dish| dish.name == *name).expect("a dish of the menu");
        state.set_order(order, OrderContent::Dish(DishId(dish as u8)));
    }
    for (place, content) in contents {
        let place = kitchen.location_named(place).expect("a location");
        state.set_content(place, kitchen.content_named(content).expect("a content"));
    }
    state
}

/// Whatever chance says, the robot's decision is one of these: names of buttons, or why it idles.
fn check(orders: &[&str], contents: &[(&str, &str)], expected: &[&str]) {
    let kitchen = sushi();
    let state = state(&kitchen, orders, contents);
    let mut cost = CostToGo::new(kitchen.clone());
    let mut seen: Vec<String> = Vec::new();
    for index in 0..50 {
        let mut random = stream(1, "robot policy", index);
        let decision = match decide(&kitchen, &mut cost, state, None, &mut random) {
            Decision::Press(button) => kitchen.button(Agent::Robot, button).name.clone(),
            Decision::Idle(IdleReason::NoOrder) => "no order".to_string(),
            Decision::Idle(IdleReason::HumanTurn) => "human's turn".to_string(),
            Decision::Idle(IdleReason::Skipped) => "skipped".to_string(),
        };
        if !seen.contains(&decision) {
            seen.push(decision);
        }
    }
    seen.sort();
    assert_eq!(seen, expected, "orders {orders:?}, {contents:?}");
}

#[test]
fn it_begins_by_itself_with_any_part_that_it_can_fetch() {
    check(&["salmon maki"], &[], &["take nori", "take rice", "take salmon"]);
}

#[test]
fn it_rests_without_an_order() {
    check(&[], &[("robot_hand", "rice raw")], &["no order"]);
}

#[test]
fn it_leaves_to_the_human_what_only_the_human_can_do() {
    check(&["shrimp nigiri"], &[("assembly_board", "rice shaped + nori")], &["human's turn"]);
    check(
        &["salmon nigiri"],
        &[("assembly_board", "nori + salmon cut"), ("human_hand", "rice cooked")],
        &["human's turn"],
    );
}

#[test]
fn it_does_not_do_again_what_is_done() {
    check(&["tuna maki"], &[("assembly_board", "rice cooked + nori")], &["take tuna"]);
}

#[test]
fn it_works_on_the_order_that_is_nearer() {
    check(&["salmon nigiri", "tuna maki"], &[("assembly_board", "rice cooked + nori")], &["take tuna"]);
    check(&["tuna maki", "salmon nigiri"], &[("assembly_board", "rice shaped + nori")], &["take salmon"]);
}

#[test]
fn it_frees_what_it_blocks() {
    let contents = [("robot_hand", "salmon raw"), ("assembly_board", "rice cooked + nori")];
    check(&["tuna maki"], &contents, &["trash"]);
}
