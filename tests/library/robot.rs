//! The robot: its task policy, what it does next and when it leaves the next press to the human; and the motion of its arm.

use std::path::Path;
use std::sync::Arc;

use rand::RngExt;
use tomcom::edge::files::read_kitchen;
use tomcom_arm::clearance::{ArmSurroundings, Obstruction};
use tomcom_arm::inverse::{twist, wrapped};
use tomcom_arm::kinematics::SerialArm;
use tomcom_arm::motion::JointMotion;
use tomcom_arm::reach::{BUTTON_M, ButtonPoses, UnreachableReason, out_of_reach};
use tomcom_core::base::rng::stream;
use tomcom_core::base::time::SessionTime;
use tomcom_core::kitchen::cost_to_go::CostToGo;
use tomcom_core::kitchen::{Agent, ButtonId, DishId, Kitchen, OrderContent, State};
use tomcom_core::robot::IdleReason;
use tomcom_core::robot::initiative::own_ways;
use tomcom_core::robot::moment::JointAngles;
use tomcom_core::robot::policy::{PolicyDecision, decide};

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
    let kitchen = sushi();
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
fn it_begins_by_itself_with_any_part_that_it_can_fetch() {
    check(&["salmon maki"], &[], &["take nori", "take rice", "take salmon"]);
}

#[test]
fn it_begins_with_any_order_until_the_human_works_on_one() {
    let orders = ["salmon maki", "tuna nigiri"];
    check(&orders, &[], &["take nori", "take rice", "take salmon", "take tuna"]);
    check(&orders, &[("human_hand", "salmon raw")], &["take nori", "take rice"]);
    check(&orders, &[("human_hand", "rice shaped")], &["take nori", "take tuna"]);
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
    for layout in ["layouts/sushi.toml", "layouts/burger.toml"] {
        let kitchen = Arc::new(read_kitchen(Path::new(layout)).expect("a layout of the project").kitchen);
        let (mut cost, recipes) = (CostToGo::new(kitchen.clone()), kitchen.true_recipes());
        for seed in 0..60 {
            let mut state = any_state(&kitchen, seed);
            let mut random = stream(seed, "robot policy", 0);
            let mut visited = vec![state];
            loop {
                let ways =
                    kitchen.orders.iter().filter_map(|&order| own_ways(&kitchen, &mut cost, state, &recipes, order));
                let least = ways.map(|own| own.presses).min();
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
                    let mut ways = kitchen
                        .orders
                        .iter()
                        .filter_map(|&order| own_ways(&kitchen, &mut cost, state, &recipes, order));
                    let left = least - 1;
                    assert!(is_served == (left == 0), "{layout}, seed {seed}");
                    assert!(is_served || ways.any(|own| own.presses == left), "{layout}, seed {seed}: a longer way");
                }
                if is_served {
                    served += 1;
                    break;
                }
            }
        }
    }
    println!("served {served}, idled {idled}");
    assert!(served > 20 && idled > 20, "{served}, {idled}");
}

/// Where the tip of the arm is at this time, in metres.
fn tip_m(arm: &SerialArm, motion: &JointMotion, now_s: f64) -> [f64; 3] {
    let places = arm.forward(&motion.at(SessionTime::from_secs_f64(now_s)));
    places.last().expect("links").translation.vector.into()
}

#[test]
fn the_arm_touches_the_button_when_the_press_is_due_and_goes_over_the_others() {
    let arm = SerialArm::ur5();
    for layout in ["sushi", "burger"] {
        let path = Path::new("layouts").join(layout).with_extension("toml");
        let kitchen = read_kitchen(&path).expect("a layout of the project").kitchen;
        let mut motion = JointMotion::new(&kitchen, &arm);
        let top_m = kitchen.table_height_m + BUTTON_M;
        let mut now_s = 1.0;
        for (index, button) in kitchen.buttons[Agent::Robot.index()].iter().enumerate() {
            let (from, until_s) = (tip_m(&arm, &motion, now_s), now_s + 2.4);
            let at = SessionTime::from_secs_f64;
            motion.set_out(at(now_s), ButtonId(index as u8), at(until_s));
            let [x, y, z] = tip_m(&arm, &motion, until_s);
            let away_m = (x - button.at_m[0]).hypot(y - button.at_m[1]).hypot(z - top_m);
            assert!(away_m < 1e-3, "{layout}, {}: {away_m} m away", button.name);
            let start = tip_m(&arm, &motion, now_s);
            assert!((0..3).all(|axis| (start[axis] - from[axis]).abs() < 1e-9), "it sets out from where it is");
            for share in 0..=100 {
                let [_, _, z] = tip_m(&arm, &motion, now_s + 2.4 * f64::from(share) / 100.0);
                let is_moving_along = (15..=80).contains(&share);
                assert!(z > top_m - 1e-3 && (!is_moving_along || z > top_m + 0.04), "{layout}, {}: {z}", button.name);
            }
            motion.go_up(at(until_s));
            now_s = until_s;
        }
        motion.go_up(SessionTime::from_secs_f64(now_s));
        let [.., z] = tip_m(&arm, &motion, now_s + 1.0);
        assert!(z > top_m + 0.07, "it goes up after the last press");
    }
}

#[test]
fn an_arm_that_stands_stays_where_it_is() {
    let (arm, kitchen) = (SerialArm::ur5(), sushi());
    let mut motion = JointMotion::new(&kitchen, &arm);
    let at = SessionTime::from_secs_f64;
    motion.set_out(at(1.0), ButtonId(3), at(3.0));
    let there = motion.at(at(1.7));
    assert_ne!(there, motion.at(at(1.0)));
    motion.stand(at(1.7));
    assert_eq!(motion.at(at(60.0)), there);
}

#[test]
fn every_inverse_solution_reproduces_the_pose_and_the_joints_it_came_from_are_among_them() {
    let arm = SerialArm::ur5();
    let (mut worst, mut solutions, mut missing) = (0.0_f64, 0, 0);
    let mut random = stream(9, "poses", 0);
    for _ in 0..10_000 {
        let joints: JointAngles = std::array::from_fn(|_| (random.random::<f64>() * 2.0 - 1.0) * std::f64::consts::PI);
        let target = arm.tip(&joints);
        let found = arm.inverse(&target);
        solutions += found.len();
        worst = found.iter().map(|solution| twist(&arm.tip(solution), &target).amax()).fold(worst, f64::max);
        let is_it = |solution: &JointAngles| solution.iter().zip(joints).all(|(a, b)| wrapped(a - b).abs() < 1e-4);
        missing += usize::from(!found.iter().any(is_it));
    }
    println!("10000 poses: {solutions} solutions, at most {worst:.1e} away (m, rad); {missing} not found again");
    assert!(worst < 1e-6, "{worst}");
    assert_eq!(missing, 0);
}

#[test]
fn every_button_of_every_layout_is_within_reach_with_clearance() {
    let arm = SerialArm::ur5();
    for layout in ["layouts/sushi.toml", "layouts/burger.toml", "tests/kitchens/tiny.toml"] {
        let kitchen = read_kitchen(Path::new(layout)).expect("a layout of the project").kitchen;
        assert_eq!(out_of_reach(&kitchen), None, "{layout}");
        let around = ArmSurroundings { table_m: kitchen.table_height_m, obstacles: Vec::new() };
        for button in &kitchen.buttons[Agent::Robot.index()] {
            let ButtonPoses { above, touching } = arm.at_button(button.at_m, &around).expect("within reach");
            let tip = arm.tip(&touching);
            let away_m = (tip.translation.vector.xy() - nalgebra::Vector2::from(button.at_m)).norm();
            assert!(away_m < 1e-6 && (tip * nalgebra::Vector3::z()).z < -1.0 + 1e-9, "{}", button.name);
            let turns = above.iter().zip(touching).map(|(above, touching)| (above - touching).abs());
            assert!(turns.fold(0.0, f64::max) < 0.6, "{layout}, {}: one way to stand above it and on it", button.name);
        }
    }
}

#[test]
fn a_place_that_the_arm_cannot_press_at_is_told_with_the_reason() {
    let arm = SerialArm::ur5();
    let check = |at_m: [f64; 2], table_m: f64, expected: UnreachableReason| {
        let around = ArmSurroundings { table_m, obstacles: Vec::new() };
        assert_eq!(arm.at_button(at_m, &around), Err(expected), "{at_m:?}");
    };
    check([1.1, 0.2], 0.0, UnreachableReason::TooFar);
    check([0.05, 0.05], 0.0, UnreachableReason::TooFar);
    check([0.89, 0.0], 0.0, UnreachableReason::Singular);
    check([0.4, 0.0], 0.3, UnreachableReason::Blocked(Obstruction::Table));
}

/// Random joint angles and where the tip is then: x, y, z and the rotation's columns, in the frame of the base. For
/// comparison with other programs.
#[test]
#[ignore = "prints, and checks nothing"]
fn print_poses() {
    let arm = SerialArm::ur5();
    let mut random = stream(3, "poses", 0);
    for _ in 0..2000 {
        let joints: JointAngles = std::array::from_fn(|_| (random.random::<f64>() * 2.0 - 1.0) * std::f64::consts::TAU);
        let tip = arm.tip(&joints);
        let turn = tip.rotation.to_rotation_matrix();
        println!("pose {joints:?} {:?} {:?}", tip.translation.vector.as_slice(), turn.matrix().as_slice());
    }
}
