//! Causes of errors: false beliefs and slips.

use tomcom_core::kitchen::Agent;
use tomcom_core::kitchen::cost_to_go::CostToGo;
use tomcom_core::measures::attribution::{ErrorAttributor, ErrorCause};
use tomcom_core::measures::errors::PressJudge;
use tomcom_core::mind::choice::ChoiceParameters;

use super::{at, belief, state};
use crate::files::kitchen;

/// A press in a kitchen under a belief is an error, and for this reason: "slip", or the labels of its targets.
fn check(layout: &str, there: &[&str], falsely: &[&str], pressed: &str, why: &[&str]) {
    let kitchen = kitchen(layout);
    let mut cost = CostToGo::new(kitchen.clone());
    let state = state(&kitchen, there);
    let button = kitchen.button_named(Agent::Human, pressed).expect("a button");
    let press = kitchen.try_press(state, Agent::Human, button);
    let verdict = PressJudge::new(kitchen.clone()).human_pressed(&mut cost, at(1.0), &press);
    assert!(verdict.error, "{pressed} is no error: {verdict:?}");
    let attributor = ErrorAttributor::new(ChoiceParameters::default(), 1);
    for (sure, index) in [(1.0, 0), (0.97, 1), (0.97, 2), (0.97, 3)] {
        let belief = belief(&kitchen, state, falsely, sure);
        let cause = attributor.cause(&kitchen, &mut cost, &belief, &press, index);
        let found: Vec<String> = match cause {
            ErrorCause::Slip | ErrorCause::Planning => vec!["slip".to_string()],
            ErrorCause::Belief { target, with, .. } => {
                [Some(target), with].into_iter().flatten().map(|target| target.label(&kitchen)).collect()
            }
        };
        let mut sorted = found.clone();
        sorted.sort();
        assert_eq!(sorted, why, "{pressed} with {falsely:?} held to {sure}: {cause:?}");
    }
}

#[test]
fn a_confused_recipe_leads_to_the_wrong_ingredient() {
    let falsely = ["recipe of shrimp nigiri: rice shaped + nori + crab cut"];
    check("sushi", &["order_1: shrimp nigiri"], &falsely, "take crab", &["shrimp nigiri of order 1"]);
    let falsely = ["recipe of garden burger: light bun + cheese + soy grilled + tomato sliced"];
    check("burger", &["order: garden burger"], &falsely, "take tomato", &["garden burger of order"]);
}

#[test]
fn an_order_that_was_misread_counts_as_one_target_with_its_recipe() {
    check("sushi", &["order_1: crab maki"], &["order_1: shrimp nigiri"], "take shrimp", &["crab maki of order 1"]);
    let falsely = ["order: classic burger"];
    check("burger", &["order: garden burger"], &falsely, "take tomato", &["garden burger of order"]);
}

#[test]
fn an_error_without_a_false_belief_is_a_slip() {
    check("sushi", &["order_1: salmon maki", "human_hand: nori"], &[], "trash", &["slip"]);
    check("burger", &["order: garden burger", "human_hand: soy raw"], &[], "trash", &["slip"]);
    // A false belief that has nothing to do with it does not make it one.
    let falsely = ["recipe of tuna maki: crab maki", "counter: rice cooked"];
    check("sushi", &["order_1: salmon maki", "human_hand: nori"], &falsely, "trash", &["slip"]);
}

#[test]
fn what_is_done_already_is_done_again_by_those_who_did_not_see_it() {
    let there = ["order_1: tuna maki", "cooking_pot: rice cooked"];
    check("sushi", &there, &["cooking_pot: rice raw"], "cook", &["cooking pot"]);
    let there = ["order: garden burger", "grill_plate: soy grilled", "board: light bun + cheese"];
    check("burger", &there, &["grill_plate: soy raw"], "grill", &["grill plate"]);
}

#[test]
fn two_false_beliefs_that_each_suffice_are_named_together() {
    let there = ["order_1: salmon nigiri", "order_2: salmon maki"];
    let falsely = ["recipe of salmon nigiri: rice shaped + nori + crab cut", "recipe of salmon maki: crab maki"];
    let why = ["salmon maki of order 2", "salmon nigiri of order 1"];
    check("sushi", &there, &falsely, "take crab", &why);
    // Mending one of them alone leaves a good reason to press.
    check("sushi", &there, &falsely[..1], "take crab", &why[1..]);
}
