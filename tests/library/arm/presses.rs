//! The arm alone: presses, stops and faults; and the human hand beside it.

use std::f64::consts::FRAC_PI_2;

use nalgebra::Point3;
use tomcom_arm::kinematics::SerialArm;
use tomcom_arm::physics::CYCLE_S;
use tomcom_arm::physics::bodies::HandPose;
use tomcom_arm::reach::UnreachableReason;
use tomcom_arm::reach::{Capsule, Obstruction};
use tomcom_arm::reaching::{ReachingBehaviour, ReachingHand};
use tomcom_arm::trajectory::JOINT_SPEED_RAD_S;
use tomcom_arm::worker::PressFailure;
use tomcom_core::robot::JointAngles;
use tomcom_core::robot::SafetyMode;

use super::{AT_REST, Came, SUSHI, any_button, at, until_report};
use crate::support::*;

fn fastest(joints: &JointAngles) -> f64 {
    joints.iter().fold(0.0, |most, value| most.max(value.abs()))
}

fn presses(count: usize) {
    let mut arm = AT_REST.clone();
    let mut random = stream(5, "presses", 0);
    let (mut took_s, mut speed, mut missed) = (Vec::new(), 0.0_f64, 0);
    let (mut before, mut moved) = (arm.joints(), 0.0_f64);
    let model = SerialArm::ur5();
    for _ in 0..count {
        let button = any_button(&mut random);
        arm.set_out(button).expect("a way");
        let mut since_s = 0.0;
        let report = loop {
            let (report, took_s) = until_report(&mut arm, None, CYCLE_S);
            since_s += took_s;
            let (joints, speeds) = arm.world().joints();
            speed = speed.max(fastest(&speeds));
            moved = moved.max(fastest(&std::array::from_fn(|joint| (joints[joint] - before[joint]) / took_s)));
            before = joints;
            assert!(model.is_within_limits(&joints));
            if report.is_some() || since_s > 20.0 {
                break report;
            }
        };
        let tip = model.tip(&arm.joints()).translation.vector;
        let [x, y] = SUSHI.button(Agent::Robot, button).at_m;
        missed += usize::from(report != Some(Came::Clicked(button)) || (tip.x - x).hypot(tip.y - y) > 0.01);
        took_s.push(since_s);
    }
    took_s.sort_by(f64::total_cmp);
    let [least, median, most] = [0.0, 0.5, 1.0].map(|share| at(&took_s, share));
    println!(
        "{count} presses: {missed} missed; {least:.2} to {most:.2} s, median {median:.2} s; joints up to {speed:.3} rad/s, \
         by their angles {moved:.3} rad/s"
    );
    assert_eq!(missed, 0);
    assert!((2.0..=3.0).contains(&median), "{median} s");
    // On straight legs the tip's speed counts, and the joints stay below it, too.
    assert!(speed < JOINT_SPEED_RAD_S * 1.01, "{speed} rad/s");
    // Nothing jumps where the physics begins and ends.
    assert!(moved < JOINT_SPEED_RAD_S * 1.05, "{moved} rad/s");
}

#[test]
fn it_presses_every_button_and_keeps_its_limits() {
    presses(100);
}

#[test]
#[ignore = "takes minutes"]
fn a_thousand_presses() {
    presses(1000);
}

/// Of the bits of all joint angles of the presses below: in debug and in release builds, on every machine.
const JOINTS_CRC: u32 = 0x1a2b_6a9a;

#[test]
fn the_same_presses_move_the_joints_the_same_way_bit_for_bit() {
    let run = || {
        let mut arm = AT_REST.clone();
        let mut bits = crc32fast::Hasher::new();
        for button in [3, 0, 5] {
            arm.set_out(ButtonId(button)).expect("a way");
            while until_report(&mut arm, None, CYCLE_S).0.is_none() {
                arm.joints().iter().for_each(|angle| bits.update(&angle.to_bits().to_le_bytes()));
            }
        }
        bits.finalize()
    };
    let bits = run();
    println!("joint angles: {bits:#010x}");
    assert_eq!(bits, run());
    assert_eq!(bits, JOINTS_CRC);
}

/// A hand just above the table at the arm's tip, or beside it.
fn hand_at([x, y, z]: [f64; 3]) -> HandPose {
    HandPose { at_m: Point3::new(x, y, z), elbow_m: Point3::new(x + 0.28, y, z) }
}

#[test]
fn after_a_protective_stop_only_the_wizard_lets_it_go_on_and_then_it_goes_up_and_presses() {
    let mut arm = AT_REST.clone();
    arm.watches_hands = false;
    arm.set_out(ButtonId(0)).expect("a way");
    let [x, y] = SUSHI.button(Agent::Robot, ButtonId(0)).at_m;
    // The hand lies on the button.
    let (report, _) = until_report(&mut arm, Some(hand_at([x, y, 0.05])), 10.0);
    assert!(matches!(report, Some(Came::Not(PressFailure::Contact(force_n))) if force_n > 60.0), "{report:?}");
    assert_eq!(arm.mode, SafetyMode::ProtectiveStop);
    assert_eq!(until_report(&mut arm, None, 5.0).0, None);
    assert!(!arm.moves() && !arm.is_busy() && arm.mode == SafetyMode::ProtectiveStop, "the hand is gone, it stays");
    let low_m = SerialArm::ur5().tip(&arm.joints()).translation.z;
    arm.resume();
    until_report(&mut arm, None, 2.0);
    assert!(SerialArm::ur5().tip(&arm.joints()).translation.z > low_m + 0.01, "it goes up first");
    arm.set_out(ButtonId(0)).expect("a way");
    assert_eq!(until_report(&mut arm, None, 10.0).0, Some(Came::Clicked(ButtonId(0))));
}

#[test]
fn a_hand_in_the_way_makes_it_wait_and_then_give_the_press_up() {
    let mut arm = AT_REST.clone();
    arm.set_out(ButtonId(0)).expect("a way");
    let [x, y] = SUSHI.button(Agent::Robot, ButtonId(0)).at_m;
    let (report, after_s) = until_report(&mut arm, Some(hand_at([x, y, 0.05])), 30.0);
    assert_eq!(report, Some(Came::Not(PressFailure::Blocked(ButtonId(0)))));
    assert!(after_s > 4.0, "{after_s} s");
    assert!(!arm.mode.is_stopped(), "nobody was touched");
}

#[test]
fn a_joint_that_gives_way_is_a_fault_and_the_brakes_hold() {
    let mut arm = AT_REST.clone();
    arm.set_out(ButtonId(1)).expect("a way");
    until_report(&mut arm, None, 1.0);
    arm.world().fail(Some(1));
    let (report, after_s) = until_report(&mut arm, None, 2.0);
    assert_eq!(report, Some(Came::Not(PressFailure::Fault(1))));
    assert!(after_s < 0.5 && arm.mode == SafetyMode::Fault);
    until_report(&mut arm, None, 1.0);
    assert!(!arm.moves());
    assert!(SerialArm::ur5().tip(&arm.joints()).translation.z > 0.02, "it did not fall on the table");
}

#[test]
fn a_way_that_is_blocked_goes_over_what_stands_there_or_is_refused() {
    let [x, y] = SUSHI.button(Agent::Robot, ButtonId(0)).at_m;
    let post = |height_m: f64, x: f64, y: f64| Capsule {
        ends_m: [Point3::new(x, y, 0.0), Point3::new(x, y, height_m)],
        radius_m: 0.03,
    };
    let mut arm = AT_REST.clone();
    arm.around().obstacles.push(post(0.5, x, y));
    assert_eq!(arm.set_out(ButtonId(0)), Err(UnreachableReason::Blocked(Obstruction::Obstacle)));
    // Between two buttons it is gone over.
    let mut arm = AT_REST.clone();
    arm.set_out(ButtonId(0)).expect("a way");
    until_report(&mut arm, None, 10.0);
    let mut direct = arm.clone();
    let direct_s = direct.set_out(ButtonId(3)).expect("a way");
    until_report(&mut direct, None, direct_s / 2.0);
    let midway = SerialArm::ur5().tip(&direct.joints()).translation.vector;
    arm.around().obstacles.push(post(0.12, midway.x, midway.y));
    let around_s = arm.set_out(ButtonId(3)).expect("a way over it");
    assert!(around_s > direct_s, "{around_s} s instead of {direct_s} s");
    assert_eq!(until_report(&mut arm, None, 15.0).0, Some(Came::Clicked(ButtonId(3))));
}

/// Lets a hand go on by itself until this time; how near it came to an arm that is so far away, in metres.
fn hand_goes_on(hand: &mut ReachingHand, now: &mut SessionTime, until_s: f64, away: impl Fn(&HandPose) -> f64) -> f64 {
    let (end, mut nearest_m) = (SessionTime::from_secs_f64(until_s), f64::INFINITY);
    while let Some(next) = hand.next_move(*now).filter(|next| *next <= end) {
        *now = next;
        hand.cycle(next, &away);
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
    let far = |_: &HandPose| 1.0;
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
    let nearest_m = hand_goes_on(&mut careful, &mut now, 10.0, |place| (place.at_m - Point3::new(x, y, 0.05)).norm());
    assert!((0.05..0.1).contains(&nearest_m), "{nearest_m} m");
    assert_eq!(careful.place().at_m, rests_m);
}

/// An emergency stop left the arm so, over a hand that reached for the assembly board.
const OVER_THE_HAND: JointAngles = [-0.2018, -1.4533, 1.9836, -2.1011, -FRAC_PI_2, 0.0];

#[test]
fn a_hand_below_an_arm_that_stands_draws_back_and_does_not_wait_for_it() {
    let mut hand = ReachingHand::new(&SUSHI, ReachingBehaviour::UNSEEN, stream(1, "hand", 0));
    let (arm, rests_m, mut now) = (SerialArm::ur5(), hand.place().at_m, SessionTime::ZERO);
    let away = |place: &HandPose| arm.distance(&OVER_THE_HAND, place);
    let button =
        |name: &str| SUSHI.button(Agent::Human, SUSHI.button_named(Agent::Human, name).expect("a button")).at_m;
    hand.pressed(now, button("take rice"));
    hand_goes_on(&mut hand, &mut now, 0.9, |_| 1.0);
    hand.pressed(now, button("assembly_board"));
    let comes_s = now.as_secs_f64() + 0.47;
    hand_goes_on(&mut hand, &mut now, comes_s, |_| 1.0);
    let nearest_m = hand_goes_on(&mut hand, &mut now, 10.0, away);
    assert!((0.02..0.06).contains(&nearest_m), "it came below the arm: {nearest_m} m");
    assert_eq!((hand.place().at_m, hand.next_move(now)), (rests_m, None), "the arm's way is free again");
}
