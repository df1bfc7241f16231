//! The robot: its task policy, what it does next and when it leaves the next press to the human.

use rand::RngExt;
use tomcom_core::base::rng::stream;
use tomcom_core::kitchen::cost_to_go::CostToGo;
use tomcom_core::kitchen::{Agent, ButtonId, DishId, Kitchen, OrderContent, State};
use tomcom_core::robot::IdleReason;
use tomcom_core::robot::policy::{PolicyDecision, decide, own_ways};

use crate::files::kitchen;

/// The state with these orders and contents.
fn state(kitchen: &Kitchen, orders: &[&str], contents: &[(&str, &str)]) -> State {
    let mut state = kitchen.empty_state();
    for (&order, name) in kitchen.orders.iter().zip(orders) {
        state.set_order(order, OrderContent::Dish(kitchen.dish_named(name).expect("a dish of the menu")));
    }
    for (place, content) in contents {
        let place = kitchen.location_named(place).expect("a location");
        state.set_content(place, kitchen.content_named(content).expect("a content"));
    }
    state
}

/// Whatever chance says, the robot's decision is one of these while the human is active: names of buttons, or why it
/// idles.
fn check(orders: &[&str], contents: &[(&str, &str)], expected: &[&str]) {
    decides(orders, contents, false, expected);
}

/// The same while the human is passive.
fn check_passive(orders: &[&str], contents: &[(&str, &str)], expected: &[&str]) {
    decides(orders, contents, true, expected);
}

fn decides(orders: &[&str], contents: &[(&str, &str)], is_passive: bool, expected: &[&str]) {
    let kitchen = kitchen("sushi");
    let state = state(&kitchen, orders, contents);
    let mut cost = CostToGo::new(kitchen.clone());
    let mut seen: Vec<String> = Vec::new();
    for index in 0..50 {
        let mut random = stream(1, "robot policy", index);
        let decision = match decide(&kitchen, &mut cost, state, is_passive, &[], &mut random) {
            PolicyDecision::Press(button) => kitchen.button(Agent::Robot, button).name.clone(),
            PolicyDecision::Idle(IdleReason::NoOrder) => "no order".to_string(),
            PolicyDecision::Idle(IdleReason::HumanTurn) => "human's turn".to_string(),
            PolicyDecision::Idle(IdleReason::Skipped) => "skipped".to_string(),
        };
        if !seen.contains(&decision) {
            seen.push(decision);
        }
    }
    seen.sort();
    assert_eq!(seen, expected, "orders {orders:?}, {contents:?}");
}

#[test]
fn while_the_human_is_active_it_works_on_what_is_nearest_and_leaves_the_rest_to_the_human() {
    // By itself with any part that it can fetch, of any order until the human works on one.
    check(&["salmon maki"], &[], &["take nori", "take rice", "take salmon"]);
    let orders = ["salmon maki", "tuna nigiri"];
    check(&orders, &[], &["take nori", "take rice", "take salmon", "take tuna"]);
    check(&orders, &[("human_hand", "salmon raw")], &["take nori", "take rice"]);
    check(&orders, &[("human_hand", "rice shaped")], &["take nori", "take tuna"]);
    check(&[], &[("robot_hand", "rice raw")], &["no order"]);
    // What only the human can do is left to the human.
    check(&["shrimp nigiri"], &[("assembly_board", "rice shaped + nori")], &["human's turn"]);
    let shaping = [("assembly_board", "nori + salmon cut"), ("human_hand", "rice cooked")];
    check(&["salmon nigiri"], &shaping, &["human's turn"]);
    // What is done is not done again, and of two orders the nearer one is worked on.
    check(&["tuna maki"], &[("assembly_board", "rice cooked + nori")], &["take tuna"]);
    check(&["salmon nigiri", "tuna maki"], &[("assembly_board", "rice cooked + nori")], &["take tuna"]);
    check(&["tuna maki", "salmon nigiri"], &[("assembly_board", "rice shaped + nori")], &["take salmon"]);
    // It frees what it blocks.
    let blocked = [("robot_hand", "salmon raw"), ("assembly_board", "rice cooked + nori")];
    check(&["tuna maki"], &blocked, &["trash"]);
}

/// The situation of a recording in which the robot stood for 165 s, although nine presses of its own would have served an
/// order.
const STOOD_STILL: [(&str, &str); 3] =
    [("assembly_board", "rice shaped + nori"), ("cooking_pot", "shrimp cooked"), ("robot_hand", "nori")];

#[test]
fn while_the_human_is_passive_it_serves_alone_and_puts_down_what_blocks_it() {
    let orders = ["shrimp nigiri", "crab maki"];
    check(&orders, &STOOD_STILL, &["human's turn"]);
    check_passive(&orders, &STOOD_STILL, &["counter", "rolling_mat"]);
    // Contents without use are thrown away, also if they could be put down.
    let useless = [STOOD_STILL[0], STOOD_STILL[1], ("robot_hand", "salmon raw")];
    check_passive(&orders, &useless, &["trash"]);
    // Of two orders it serves the one that it serves sooner, whichever is wanted where.
    let near = [("assembly_board", "rice cooked + nori"), ("cutting_board", "salmon cut"), ("cooking_pot", "tuna raw")];
    for orders in [["salmon maki", "tuna maki"], ["tuna maki", "salmon maki"]] {
        check_passive(&orders, &near, &["cutting_board"]);
    }
}

#[test]
fn while_the_human_is_passive_it_prepares_what_it_can_and_leaves_the_rest() {
    // Only the human can shape the rice, which the human holds, and nothing else is missing.
    let contents = [("assembly_board", "nori + salmon cut"), ("human_hand", "rice cooked")];
    check_passive(&["salmon nigiri"], &contents, &["human's turn"]);
    // It puts its nori down and prepares the other dish.
    let contents = [("assembly_board", "rice shaped + nori"), ("robot_hand", "nori")];
    check(&["shrimp nigiri", "crab maki"], &contents, &["human's turn"]);
    check_passive(&["shrimp nigiri", "crab maki"], &contents, &["counter", "plate", "rolling_mat"]);
    // The pot is where the human's crab has to go next, so that the robot's rice waits.
    let contents = [("human_hand", "crab raw"), ("robot_hand", "rice raw"), ("assembly_board", "nori")];
    check(&["crab maki"], &contents, &["cooking_pot"]);
    check_passive(&["crab maki"], &contents, &["human's turn"]);
}

/// A state after random presses of both agents, with two orders.
fn any_state(kitchen: &Kitchen, seed: u64) -> State {
    let mut random = stream(seed, "presses", 0);
    let mut state = kitchen.empty_state();
    for &order in &kitchen.orders {
        state.set_order(order, OrderContent::Dish(DishId(random.random_range(0..kitchen.dishes.len()) as u8)));
    }
    for _ in 0..60 {
        let agent = if random.random::<bool>() { Agent::Human } else { Agent::Robot };
        let button = ButtonId(random.random_range(0..kitchen.buttons[agent.index()].len()) as u8);
        let next = kitchen.press(state, &kitchen.true_recipes(), agent, button);
        state = next.filter(|next| kitchen.wanted(*next).count() == kitchen.orders.len()).unwrap_or(state);
    }
    state
}

#[test]
fn while_the_human_is_passive_it_never_goes_in_circles_and_serves_on_the_shortest_way() {
    let (mut served, mut idled) = (0, 0);
    for layout in ["sushi", "burger"] {
        let kitchen = kitchen(layout);
        let (mut cost, recipes) = (CostToGo::new(kitchen.clone()), kitchen.true_recipes());
        let presses = |cost: &mut CostToGo, state: State, order| {
            own_ways(&kitchen, cost, state, &recipes, order).map(|own| own.presses)
        };
        for seed in 0..60 {
            let mut state = any_state(&kitchen, seed);
            let mut random = stream(seed, "robot policy", 0);
            let mut visited = vec![state];
            loop {
                let orders = kitchen.orders.iter();
                let least = orders.filter_map(|&order| presses(&mut cost, state, order)).min();
                let PolicyDecision::Press(button) = decide(&kitchen, &mut cost, state, true, &[], &mut random) else {
                    assert_eq!(least, None, "{layout}, seed {seed}: it idles though it could serve, {state:?}");
                    idled += 1;
                    break;
                };
                state = kitchen.press(state, &recipes, Agent::Robot, button).expect("a press with an effect");
                assert!(!visited.contains(&state), "{layout}, seed {seed}: in circles, {visited:?}");
                visited.push(state);
                let is_served = kitchen.wanted(state).count() < kitchen.orders.len();
                if let Some(least) = least {
                    let left = least - 1;
                    assert!(is_served == (left == 0), "{layout}, seed {seed}");
                    let goes_on = kitchen.orders.iter().any(|&order| presses(&mut cost, state, order) == Some(left));
                    assert!(is_served || goes_on, "{layout}, seed {seed}: a longer way");
                }
                if is_served {
                    served += 1;
                    break;
                }
            }
        }
    }
    assert!(served > 20 && idled > 20, "{served}, {idled}");
}
