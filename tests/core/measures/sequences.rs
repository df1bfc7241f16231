//! Error sequences and false belief episodes.

use tomcom_core::base::time::SessionTime;
use tomcom_core::kitchen::{DishId, LocationId};
use tomcom_core::measures::JudgedPress;
use tomcom_core::measures::attribution::{ErrorCause, FalseBeliefTarget};
use tomcom_core::measures::errors::PressVerdict;
use tomcom_core::measures::sequences::{ErrorSequence, FalseBeliefTracker, sequences, sequences_any_aspect};

use super::{at, belief, state};
use crate::files::kitchen;

/// Presses by letters, one a second: `.` correct, `s` slip, `r` race, other letters belief related errors about that
/// location.
fn presses(text: &str) -> Vec<JudgedPress> {
    let press = |(index, letter): (usize, char)| {
        let cause = match letter {
            '.' | 'r' => None,
            's' => Some(ErrorCause::Slip),
            letter => {
                let target = FalseBeliefTarget::Place(LocationId(letter as u8 - b'A'));
                Some(ErrorCause::Belief { gain_nats: 2.0, target, with: None })
            }
        };
        let (race, error) = (letter == 'r', cause.is_some());
        let verdict = PressVerdict { regret: i32::from(error), excess: i32::from(error), race, error, is_proven: true };
        let before = kitchen("sushi").empty_state();
        JudgedPress { seq: index as u64, time: at(index as f64), before, verdict, belief_known: true, cause }
    };
    text.chars().enumerate().map(press).collect()
}

#[test]
fn an_order_and_its_recipe_are_one_false_belief() {
    let (order, tuna, salmon) = (LocationId(0), DishId(0), DishId(1));
    let targets = [
        FalseBeliefTarget::Order(order, Some(tuna)),
        FalseBeliefTarget::Order(order, Some(salmon)),
        FalseBeliefTarget::Recipe(tuna),
        FalseBeliefTarget::Order(LocationId(1), Some(tuna)),
    ];
    let mut all = presses("AAAA");
    for (press, target) in all.iter_mut().zip(targets) {
        press.cause = Some(ErrorCause::Belief { gain_nats: 2.0, target, with: None });
    }
    let found = sequences(&all);
    // The salmon that comes in place of the tuna is another false belief.
    let errors: Vec<&[usize]> = found.iter().map(|one| one.errors.as_slice()).collect();
    assert_eq!(errors, [&[0, 2, 3][..], &[1]]);
}

/// Sequences as target, length, beginning and recovery in seconds (-1: none).
fn told(sequences: &[ErrorSequence]) -> Vec<(char, u32, i32, i32)> {
    let tell = |one: &ErrorSequence| {
        let FalseBeliefTarget::Place(LocationId(place)) = one.target else { panic!("a place") };
        let recovered = one.recovered.map_or(-1, |time| time.as_secs_f64() as i32);
        (char::from(b'A' + place), one.length(), one.began.as_secs_f64() as i32, recovered)
    };
    sequences.iter().map(tell).collect()
}

#[test]
fn a_sequence_ends_where_more_than_three_presses_are_right() {
    let check = |text: &str, any_aspect: &[(char, u32, i32, i32)], related: &[(char, u32, i32, i32)]| {
        assert_eq!(told(&sequences(&presses(text))), related, "{text}");
        assert_eq!(told(&sequences_any_aspect(&presses(text))), any_aspect, "{text}, whatever the aspect");
    };
    check("", &[], &[]);
    check("..s.r.s", &[], &[]);
    check(".A.", &[('A', 1, 1, 2)], &[('A', 1, 1, 2)]);
    check("A...A", &[('A', 2, 0, -1)], &[('A', 2, 0, -1)]);
    check("A....A.", &[('A', 1, 0, 1), ('A', 1, 5, 6)], &[('A', 1, 0, 1), ('A', 1, 5, 6)]);
    // Slips and races are no correct presses, and are no part of a sequence.
    check("A..sr.As.", &[('A', 2, 0, 8)], &[('A', 2, 0, 8)]);
    // Whatever the errors are about; the most frequent target names the sequence, of equals the first.
    check("AB.BA.B...", &[('B', 5, 0, 7)], &[('A', 2, 0, 5), ('B', 3, 1, 7)]);
    check("BA.AB", &[('B', 4, 0, -1)], &[('B', 2, 0, -1), ('A', 2, 1, -1)]);
    // An error about something else is no correct press, but keeps nothing together.
    check("A..B..A.", &[('A', 3, 0, 7)], &[('A', 1, 0, 1), ('B', 1, 3, 4), ('A', 1, 6, 7)]);
}

#[test]
fn an_episode_lasts_from_the_change_that_was_missed_to_the_look_that_mends_it() {
    let kitchen = kitchen("sushi");
    let pot = kitchen.location_named("cooking_pot").expect("a pot");
    let raw = state(&kitchen, &["order_1: tuna maki", "cooking_pot: rice raw"]);
    let cooked = state(&kitchen, &["order_1: tuna maki", "cooking_pot: rice cooked"]);
    let unseen = ["cooking_pot: rice raw"];
    let confused = ["cooking_pot: rice raw", "recipe of crab maki: rice cooked + nori + shrimp cut"];
    let mut changed_at = vec![SessionTime::ZERO; kitchen.locations.len()];
    let mut episodes = FalseBeliefTracker::default();
    let believe = |episodes: &mut FalseBeliefTracker, seconds, state, falsely: &[&str], changed_at: &[SessionTime]| {
        episodes.believed(&kitchen, at(seconds), state, &belief(&kitchen, state, falsely, 0.9), changed_at);
    };
    let wrong = ErrorCause::Belief { gain_nats: 3.0, target: FalseBeliefTarget::Place(pot), with: None };
    believe(&mut episodes, 2.0, raw, &[], &changed_at);
    changed_at[pot.index()] = at(3.0);
    // A harmless false belief (the recipe) is no episode.
    believe(&mut episodes, 4.0, cooked, &confused, &changed_at);
    assert_eq!(episodes.harmful().count(), 0, "no error yet");
    episodes.erred(&kitchen, ErrorCause::Slip);
    episodes.erred(&kitchen, wrong);
    believe(&mut episodes, 6.0, cooked, &unseen, &changed_at);
    episodes.erred(&kitchen, wrong);
    let tell = |episodes: &FalseBeliefTracker| {
        let tell = |one: &tomcom_core::measures::sequences::FalseBeliefEpisode| {
            (one.began.as_secs_f64(), one.corrected.map(SessionTime::as_secs_f64), one.errors)
        };
        episodes.harmful().map(tell).collect::<Vec<_>>()
    };
    assert_eq!(tell(&episodes), [(3.0, None, 2)], "still open");
    believe(&mut episodes, 8.0, cooked, &[], &changed_at);
    assert_eq!(tell(&episodes), [(3.0, Some(8.0), 2)]);
    // An error that is put down to it afterwards finds no false belief.
    episodes.erred(&kitchen, wrong);
    assert_eq!(tell(&episodes), [(3.0, Some(8.0), 2)]);
}
