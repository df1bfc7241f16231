//! Stops and faults of the arm alone: protective and emergency stops, a joint that gives way, a button that does not click, a way that is blocked.

use nalgebra::Point3;
use tomcom_arm::kinematics::SerialArm;
use tomcom_arm::physics::bodies::HandPose;
use tomcom_arm::reach::UnreachableReason;
use tomcom_arm::reach::{Capsule, Obstruction};
use tomcom_arm::worker::PressFailure;
use tomcom_core::kitchen::{Agent, ButtonId};
use tomcom_core::robot::JOINTS;
use tomcom_core::robot::SafetyMode;

use super::{AT_REST, Came, SUSHI, until_report};

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
fn an_emergency_stop_halts_it_at_once_until_it_is_resumed() {
    let mut arm = AT_REST.clone();
    arm.set_out(ButtonId(1)).expect("a way");
    until_report(&mut arm, None, 1.2);
    assert!(arm.moves());
    arm.stop(SafetyMode::EmergencyStop);
    until_report(&mut arm, None, 0.3);
    assert!(!arm.moves());
    let there = arm.joints();
    until_report(&mut arm, None, 5.0);
    let drift = (0..JOINTS).map(|joint| (arm.joints()[joint] - there[joint]).abs()).fold(0.0, f64::max);
    assert!(drift < 1e-3, "{drift}");
    arm.resume();
    arm.set_out(ButtonId(1)).expect("a way");
    assert_eq!(until_report(&mut arm, None, 10.0).0, Some(Came::Clicked(ButtonId(1))));
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
fn a_button_that_does_not_click_is_given_up() {
    let mut arm = AT_REST.clone();
    arm.set_out(ButtonId(2)).expect("a way");
    arm.world().jam(2);
    assert_eq!(until_report(&mut arm, None, 10.0).0, Some(Came::Not(PressFailure::NoClick(ButtonId(2)))));
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
