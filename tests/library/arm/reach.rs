//! The arm's inverse kinematics, and whether it reaches its buttons.

use tomcom::run::files::read_kitchen;
use tomcom_arm::inverse::{twist, wrapped};
use tomcom_arm::kinematics::SerialArm;
use tomcom_arm::reach::{ArmSurroundings, Obstruction};
use tomcom_arm::reach::{ButtonPoses, UnreachableReason, out_of_reach};
use tomcom_core::robot::JointAngles;

use crate::support::*;

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
