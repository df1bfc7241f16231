//! Which presses are errors.

use tomcom::kitchen::cost_to_go::CostToGo;
use tomcom::kitchen::{Agent, OrderContent};
use tomcom::measures::errors::{PressJudge, PressVerdict};

use super::{at, kitchen};

/// The verdict on the human's last press of a list by both agents, one second apart but for the last one, that comes
/// `after_s` after the one before it; orders of these dishes are present.
fn verdict(dishes: &[&str], presses: &[(Agent, &str)], after_s: f64) -> PressVerdict {
    let kitchen = kitchen();
    let mut cost = CostToGo::new(kitchen.clone());
    let mut judge = PressJudge::new(kitchen.clone());
    let mut state = kitchen.empty_state();
    for (order, dish) in kitchen.orders.iter().zip(dishes) {
        let dish = kitchen.dishes.iter().position(|known| known.name == *dish).expect("a dish of the menu");
        state.set_order(*order, OrderContent::Dish(tomcom::kitchen::DishId(dish as u8)));
    }
    let mut last = None;
    for (index, (agent, name)) in presses.iter().enumerate() {
        let button = kitchen.button_named(*agent, name).expect("a button");
        let is_last = index + 1 == presses.len();
        let now = at(if is_last { index as f64 - 1.0 + after_s } else { index as f64 });
        let press = kitchen.try_press(state, *agent, button);
        match agent {
            Agent::Robot => judge.others_changed(now, press.before, press.after),
            Agent::Human => last = Some(judge.human_pressed(&mut cost, now, &press)),
        }
        state = press.after;
    }
    last.expect("a press of the human")
}

#[test]
fn errors_are_presses_that_lose_more_than_the_best_one() {
    use Agent::{Human, Robot};
    let good = verdict(&["crab maki"], &[(Human, "take crab")], 1.0);
    assert_eq!(good, PressVerdict { regret: 0, excess: 0, race: false, error: false });
    // The wrong shellfish has to be thrown away.
    let wrong = verdict(&["crab maki"], &[(Human, "take shrimp")], 1.0);
    assert_eq!((wrong.excess, wrong.error), (2, true));
    let nothing_to_cut = verdict(&["crab maki"], &[(Human, "cut")], 1.0);
    assert_eq!((nothing_to_cut.regret, nothing_to_cut.error), (1, true));
    // Without an order no press is better than another.
    assert!(!verdict(&[], &[(Human, "cut")], 1.0).error);
    // The robot was faster at the board by a quarter of a second, or by two.
    let both = [(Human, "take nori"), (Robot, "take nori"), (Robot, "assembly_board"), (Human, "assembly_board")];
    let (race, late) = (verdict(&["crab maki"], &both, 0.25), verdict(&["crab maki"], &both, 2.0));
    assert_eq!((race.race, race.error, late.race, late.error), (true, false, false, true));
}
