//! Slips of the hand: which other button is hit, and how often.

use tomcom_core::base::rng::stream;
use tomcom_core::kitchen::{Agent, ButtonId, Kitchen};
use tomcom_people::participant::hand::slipped_button;
use tomcom_people::participant::population::Population;

use super::behaviour::{Bench, exactly, unmoved};
use crate::files::{self, kitchen};

const DRAWS: u32 = 40_000;

/// The smallest kitchen, with caps of these colours by the name of the button; the others have none.
fn tiny(colours: &[(&str, &str)]) -> Kitchen {
    let read = |name: &str| files::read(format!("tests/kitchens/{name}.toml"));
    let mut layout = read("tiny");
    for (key, colour) in colours {
        let key = format!("key = \"{key}\"");
        assert_eq!(layout.matches(&key).count(), 1, "one button has {key}");
        layout = layout.replace(&key, &format!("{key}, colour = \"{colour}\""));
    }
    Kitchen::from_toml(&layout, &read("tiny-recipes")).expect("a kitchen")
}

fn button(kitchen: &Kitchen, name: &str) -> ButtonId {
    kitchen.button_named(Agent::Human, name).expect("a button")
}

/// Shares of the slips from this button, by the button that is hit.
fn shares(kitchen: &Kitchen, meant: ButtonId) -> Vec<f64> {
    let mut random = stream(1, "slips", 0);
    let mut hits = vec![0_u32; kitchen.buttons[Agent::Human.index()].len()];
    for _ in 0..DRAWS {
        hits[slipped_button(kitchen, meant, &mut random).expect("there are other buttons").index()] += 1;
    }
    hits.into_iter().map(|count| f64::from(count) / f64::from(DRAWS)).collect()
}

/// Whether the shares of these buttons are as expected, within five standard errors of the draws.
fn check(kitchen: &Kitchen, shares: &[f64], expected: &[(&str, f64)]) {
    for &(name, share) in expected {
        let found = shares[button(kitchen, name).index()];
        let error = (share * (1.0 - share) / f64::from(DRAWS)).sqrt();
        assert!((found - share).abs() <= 5.0 * error, "{name}: {found}, not {share}");
    }
}

#[test]
fn without_colours_distance_alone_decides() {
    let kitchen = tiny(&[]);
    let found = shares(&kitchen, button(&kitchen, "board"));
    // 0.12, 0.204, 0.24 and 0.312 m from the board's button: exp(-1), exp(-2.889), exp(-4), exp(-6.778) of 0.4430.
    check(&kitchen, &found, &[("serve 1", 0.8304), ("take salami", 0.1256), ("plate", 0.0413), ("take ham", 0.0026)]);
    assert!(found[button(&kitchen, "trash").index()] < 0.000_1, "nobody hits the far end of the table");
    assert!(found[button(&kitchen, "board").index()] == 0.0, "a slip hits another button");
}

#[test]
fn buttons_of_like_colour_are_hit_twice_as_often() {
    // Plate (0.24 m away) and salami (0.204 m) have the colour of the board, the next button has another one.
    let kitchen = tiny(&[("a", "yellow"), ("s", "yellow"), ("r", "yellow"), ("1", "red")]);
    let found = shares(&kitchen, button(&kitchen, "board"));
    check(&kitchen, &found, &[("serve 1", 0.7117), ("take salami", 0.2153), ("plate", 0.0709), ("take ham", 0.0022)]);
    // A button without a colour is like no other, not even like another one without a colour.
    let kitchen = tiny(&[("s", "yellow"), ("1", "red")]);
    let found = shares(&kitchen, button(&kitchen, "board"));
    check(&kitchen, &found, &[("serve 1", 0.8304), ("take salami", 0.1256), ("plate", 0.0413), ("take ham", 0.0026)]);
}

#[test]
fn a_slip_is_never_the_intended_button() {
    for name in ["sushi", "burger"] {
        let kitchen = kitchen(name);
        for meant in 0..kitchen.buttons[Agent::Human.index()].len() {
            let found = shares(&kitchen, ButtonId(meant as u8));
            assert_eq!(found[meant], 0.0, "{name}: button {meant}");
            let hit = found.iter().filter(|share| **share > 0.01).count();
            assert!(hit >= 2, "{name}: only one button is hit instead of button {meant}");
        }
    }
}

#[test]
fn people_slip_as_often_as_their_trait_says() {
    let never = exactly(0.000_001);
    let clumsy = Population {
        slip: exactly(0.3),
        look_alike_slip: never,
        thoughtless: never,
        // Presses at the end of one's patience do not slip.
        patience_s: exactly(1000.0),
        ..unmoved()
    };
    let (mut all, mut slips) = (0, 0);
    for seed in 0..40 {
        let mut bench = Bench::new(&clumsy, seed);
        bench.order("order_1", "crab maki");
        bench.order("order_2", "shrimp nigiri");
        bench.pass(60.0);
        for ((_, pressed), reason) in bench.presses.iter().zip(&bench.reasons) {
            all += 1;
            if let Some(meant) = reason.cause.strip_prefix("slip: hit a button nearby, meant ") {
                assert_ne!(bench.kitchen.button(Agent::Human, *pressed).name, meant, "seed {seed}");
                slips += 1;
            }
        }
    }
    let share = f64::from(slips) / f64::from(all);
    let error = (0.3 * 0.7 / f64::from(all)).sqrt();
    assert!((share - 0.3).abs() < 5.0 * error, "{slips} slips in {all} presses");
}
