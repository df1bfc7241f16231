//! The human hand in the physics: when it sets out, where it goes, and what it keeps off.

use nalgebra::Point3;
use tomcom_arm::physics::bodies::HandPose;
use tomcom_arm::reaching::{ReachingBehaviour, ReachingHand};
use tomcom_core::base::rng::stream;
use tomcom_core::base::time::SessionTime;
use tomcom_core::kitchen::{Agent, ButtonId};

use super::SUSHI;

/// Lets a hand go on by itself until this time; how near it came to something at this place, in metres.
fn hand_goes_on(hand: &mut ReachingHand, now: &mut SessionTime, until_s: f64, arm_at: Point3<f64>) -> f64 {
    let (end, mut nearest_m) = (SessionTime::from_secs_f64(until_s), f64::INFINITY);
    while let Some(next) = hand.next_move(*now).filter(|next| *next <= end) {
        *now = next;
        let away = |place: &HandPose| (place.at_m - arm_at).norm();
        hand.cycle(next, away);
        nearest_m = nearest_m.min(away(&hand.place()));
    }
    nearest_m
}

#[test]
fn a_hand_is_at_its_button_when_it_presses_goes_back_and_keeps_off_the_arm() {
    let hand = || {
        ReachingHand::new(
            &SUSHI,
            ReachingBehaviour { heedless: 0.0, ..ReachingBehaviour::SIMULATED },
            stream(1, "hand", 0),
        )
    };
    let far = Point3::new(-1.0, 0.0, 1.0);
    let (mut free, mut now) = (hand(), SessionTime::ZERO);
    let [x, y] = SUSHI.button(Agent::Human, ButtonId(0)).at_m;
    let rests_m = free.place().at_m;
    assert_eq!(free.next_move(now), None, "at rest nothing is due");
    free.means(now, [x, y], SessionTime::from_secs_f64(2.0));
    assert!(
        free.next_move(now).is_some_and(|begins| begins.as_secs_f64() > 1.0),
        "it sets out in time, and not before"
    );
    hand_goes_on(&mut free, &mut now, 2.01, far);
    assert!((free.place().at_m - Point3::new(x, y, 0.05)).norm() < 0.03, "{:?}", free.place());
    free.pressed(now, [x, y]);
    hand_goes_on(&mut free, &mut now, 10.0, far);
    assert_eq!((free.place().at_m, free.next_move(now)), (rests_m, None));
    // With the arm on its button it comes no nearer than a few centimetres, and after a while goes back.
    let (mut careful, mut now) = (hand(), SessionTime::ZERO);
    careful.pressed(now, [x, y]);
    let nearest_m = hand_goes_on(&mut careful, &mut now, 10.0, Point3::new(x, y, 0.05));
    assert!((0.05..0.1).contains(&nearest_m), "{nearest_m} m");
    assert_eq!(careful.place().at_m, rests_m);
}
