//! Presses and contacts in the physics, counted: limits are kept, nobody is touched without a stop, the joints come out bit for bit.

use tomcom_arm::kinematics::SerialArm;
use tomcom_arm::physics::CYCLE_S;
use tomcom_arm::trajectory::JOINT_SPEED_RAD_S;
use tomcom_core::base::rng::stream;
use tomcom_core::kitchen::{Agent, ButtonId};
use tomcom_core::robot::JointAngles;

use super::{AT_REST, Came, SUSHI, any_button, at, until_report};

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
