//! Cost to go, searched and proven, against exact search, on states met in sessions and on states full of obstacles.
//!
//! Exact search takes up to seconds a state, so its results are kept in `src/research/tests/oracle/`: a line a state, with the least
//! presses for the first order and for all orders. Some of them are searched again in every run; all of them by
//! `cargo test -p tomcom-research --test research cost_to_go -- --ignored`.

use std::path::Path;
use std::sync::Arc;

use rand::RngExt;
use tomcom_core::base::rng::stream;
use tomcom_core::kitchen::cost_to_go::{CostToGo, Fidelity, ProofBudget, ProvenCost};
use tomcom_core::kitchen::{Agent, ButtonId, DishId, Kitchen, LocationId, OrderContent, State};

use crate::files::{self, kitchen};
use crate::oracle::Oracle;

/// States a sample.
const STATES: usize = 1000;
/// How many of them are searched again in every run.
const SEARCHED_AGAIN: usize = 4;

/// States after 60 random presses of both agents, with random orders: full of obstacles.
fn scrambled(kitchen: &Arc<Kitchen>) -> Vec<State> {
    let one = |index| {
        let mut random = stream(1, "scrambled", index as u64);
        let mut state = kitchen.empty_state();
        for &order in &kitchen.orders {
            state.set_order(order, OrderContent::Dish(DishId(random.random_range(0..kitchen.dishes.len()) as u8)));
        }
        for _ in 0..60 {
            let agent = Agent::BOTH[random.random_range(0..2)];
            let button = ButtonId(random.random_range(0..kitchen.buttons[agent.index()].len()) as u8);
            state = kitchen.press(state, &kitchen.true_recipes(), agent, button).unwrap_or(state);
        }
        state
    };
    (0..STATES).map(one).collect()
}

fn file(kitchen: &str, sample: &str) -> String {
    format!("src/research/tests/oracle/{kitchen}_{sample}.txt")
}

/// States with their exact costs: of the first order, and of all.
fn read(path: &str) -> Vec<(State, u32, u32)> {
    let text = files::read(path);
    let line = |line: &str| {
        let words: Vec<&str> = line.split_whitespace().collect();
        let bits = u128::from_str_radix(words[0], 16).expect("a state").to_le_bytes();
        let mut state = State::default();
        for (index, &code) in bits.iter().enumerate() {
            state.set_code(LocationId(index as u8), code);
        }
        (state, words[1].parse().expect("presses"), words[2].parse().expect("presses"))
    };
    text.lines().filter(|line| !line.starts_with('#')).map(line).collect()
}

/// The searched cost is never too low. It is too high in `too_high` of the states (for one order, for all orders), by at most
/// `most_off` presses. The proven cost is that of the exact search, for all of them.
fn check(kitchen_name: &str, sample: &str, too_high: [usize; 2], most_off: u32) {
    let kitchen = kitchen(kitchen_name);
    let recipes = kitchen.true_recipes();
    let known = read(&file(kitchen_name, sample));
    assert_eq!(known.len(), STATES);
    let mut oracle = Oracle::new(&kitchen);
    for (state, first, all) in known.iter().step_by(known.len() / SEARCHED_AGAIN) {
        assert_eq!(oracle.cost(*state, &recipes, &kitchen.orders[..1]), Some(*first));
        assert_eq!(oracle.cost(*state, &recipes, &kitchen.orders), Some(*all));
    }
    let mut cost = CostToGo::new(kitchen.clone());
    let mut found_too_high = [0; 2];
    for (state, first, all) in &known {
        let found = [cost.order(*state, &recipes, kitchen.orders[0]), cost.all_orders(*state, &recipes)];
        let proven = [
            cost.proven_order(*state, &recipes, kitchen.orders[0], &mut ProofBudget::default()),
            cost.proven_all_orders(*state, &recipes, &mut ProofBudget::default()),
        ];
        for (index, exact) in [*first, *all].into_iter().enumerate() {
            let what = format!("{kitchen_name}, {sample}, state {:x}, {index}", state.bits());
            assert_eq!(proven[index], ProvenCost { presses: exact, is_proven: true }, "{what}");
            assert!((exact..=exact + most_off).contains(&found[index]), "{what}: {} instead of {exact}", found[index]);
            found_too_high[index] += usize::from(found[index] > exact);
        }
    }
    assert_eq!(found_too_high, too_high, "{kitchen_name}, {sample}: the manual and the glossary say how many");
}

#[test]
fn sushi_states_met_in_sessions() {
    check("sushi", "met", [0, 2], 1);
}

#[test]
fn sushi_states_after_random_presses() {
    check("sushi", "scrambled", [1, 37], 2);
}

#[test]
fn burger_states_met_in_sessions() {
    check("burger", "met", [1, 1], 1);
}

#[test]
fn burger_states_after_random_presses() {
    check("burger", "scrambled", [0, 0], 2);
}

/// With nori on the board, nori and salmon on the counter and rice on the plate, salmon maki takes 8 presses: the robot takes
/// the nori away and keeps it. The search keeps what lies on the board, and finds 10.
#[test]
fn a_proof_finds_what_the_search_does_not() {
    let kitchen = kitchen("sushi");
    let recipes = kitchen.true_recipes();
    let mut state = kitchen.empty_state();
    let dish = kitchen.dishes.iter().position(|dish| dish.name == "salmon maki").expect("a dish of the menu");
    state.set_order(kitchen.orders[0], OrderContent::Dish(DishId(dish as u8)));
    for (place, content) in [("assembly_board", "nori"), ("counter", "nori + salmon cut"), ("plate", "rice cooked")] {
        let at = kitchen.location_named(place).expect("a place");
        state.set_content(at, kitchen.content_named(content).unwrap_or_else(|| panic!("no content {content}")));
    }
    let mut cost = CostToGo::new(kitchen.clone());
    let mut budget = ProofBudget::default();
    let proven = cost.proven_all_orders(state, &recipes, &mut budget);
    assert_eq!(Some(proven.presses), Oracle::new(&kitchen).cost(state, &recipes, &kitchen.orders));
    assert_eq!((cost.all_orders(state, &recipes), proven), (10, ProvenCost { presses: 8, is_proven: true }));
    // The budget that is left follows from the states, not from what was asked before.
    let mut again = ProofBudget::default();
    assert_eq!(cost.proven_all_orders(state, &recipes, &mut again), proven);
    assert_eq!(again, budget);
    assert!(budget != ProofBudget::default(), "it took a search");
}

/// Rollouts decide without search: the least share of these states in which the same presses of the human lead
/// nearer as with a search.
fn check_close(kitchen_name: &str, sample: &str, least_same: f64) {
    let kitchen = kitchen(kitchen_name);
    let recipes = kitchen.true_recipes();
    let mut cost = CostToGo::new(kitchen.clone());
    let known = read(&file(kitchen_name, sample));
    let mut nearer = |fidelity: Fidelity, state: State| cost.nearer(fidelity, state, &recipes, Agent::Human);
    let differ =
        known.iter().map(|(state, ..)| nearer(Fidelity::PlanBound, *state) ^ nearer(Fidelity::Searched, *state));
    let same = differ.filter(|&differ| differ == 0).count() as f64 / known.len() as f64;
    println!("{kitchen_name}, states {sample}: the same presses lead nearer in {same:.4}");
    assert!(same >= least_same);
}

#[test]
fn people_in_rollouts_know_what_leads_nearer() {
    check_close("sushi", "met", 0.98);
    check_close("sushi", "scrambled", 0.88);
    check_close("burger", "met", 0.99);
    check_close("burger", "scrambled", 0.98);
}

#[test]
fn a_decision_is_what_its_single_values_are() {
    for name in ["sushi", "burger"] {
        let kitchen = kitchen(name);
        let recipes = kitchen.true_recipes();
        let (mut together, mut single) = (CostToGo::new(kitchen.clone()), CostToGo::new(kitchen.clone()));
        for (state, agent) in scrambled(&kitchen).into_iter().zip(Agent::BOTH.into_iter().cycle()).take(200) {
            let here = single.all_orders(state, &recipes);
            for button in 0..kitchen.buttons[agent.index()].len() {
                let next = kitchen.press(state, &recipes, agent, ButtonId(button as u8));
                let after = next.map_or(here, |next| single.all_orders(next, &recipes));
                assert_eq!(u32::from(together.decision(state, &recipes, agent).after[button]), after);
            }
            assert_eq!(u32::from(together.decision(state, &recipes, agent).here), here);
        }
    }
}

/// Threads that share the caches read what one thread computes alone, also while others write: so many states meet in
/// few lines of the cache.
#[test]
fn threads_share_the_caches() {
    let kitchen = kitchen("sushi");
    let recipes = kitchen.true_recipes();
    let states: Vec<State> = scrambled(&kitchen).into_iter().take(300).collect();
    let decided = |cost: &mut CostToGo, state: &State| {
        let decision = cost.decision(*state, &recipes, Agent::Human);
        (decision.here, decision.after)
    };
    let alone: Vec<_> = states.iter().map(|state| decided(&mut CostToGo::new(kitchen.clone()), state)).collect();
    let shared = CostToGo::new(kitchen.clone());
    std::thread::scope(|scope| {
        for thread in 0..4 {
            let (mut cost, states, alone) = (shared.clone(), &states, &alone);
            scope.spawn(move || {
                for at in (0..20 * states.len()).map(|turn| (turn * 7 + thread * 31) % states.len()) {
                    assert_eq!(decided(&mut cost, &states[at]), alone[at]);
                }
            });
        }
    });
}

#[test]
#[ignore = "takes minutes"]
fn the_exact_costs_in_the_files_are_those_of_the_oracle() {
    for (name, sample) in [("burger", "met"), ("burger", "scrambled"), ("sushi", "met"), ("sushi", "scrambled")] {
        let kitchen = kitchen(name);
        let recipes = kitchen.true_recipes();
        let listed: Vec<State> = read(&file(name, sample)).into_iter().map(|(state, ..)| state).collect();
        let states = if sample == "met" { listed } else { scrambled(&kitchen) };
        let search = |states: &[State]| -> String {
            let mut oracle = Oracle::new(&kitchen);
            let line = |state: &State| {
                let mut exact = |orders| oracle.cost(*state, &recipes, orders).expect("within the oracle's limit");
                format!("{:x} {} {}\n", state.bits(), exact(&kitchen.orders[..1]), exact(&kitchen.orders))
            };
            states.iter().map(line).collect()
        };
        let halves = states.split_at(states.len() / 2);
        let lines = std::thread::scope(|scope| {
            let first = scope.spawn(|| search(halves.0));
            let second = search(halves.1);
            first.join().expect("the other half is searched") + &second
        });
        let text = format!("# state, least presses for the first order, for all orders\n{lines}");
        let path = file(name, sample);
        if files::read(&path) == text {
            continue;
        }
        let found = Path::new(env!("CARGO_TARGET_TMPDIR")).join(format!("{name}-{sample}.txt"));
        std::fs::write(&found, text).expect("the file can be written");
        panic!("{path}: the oracle finds other costs: {}", found.display());
    }
}
