//! How much faster than real time the arm in the physics is, on one core: presses without anybody near, and with a hand that
//! it slows for.

use std::path::Path;
use std::time::Instant;

use nalgebra::Point3;
use tomcom_arm::controller::ArmController;
use tomcom_arm::physics::CYCLE_S;
use tomcom_arm::physics::bodies::HandPose;
use tomcom_core::kitchen::{Agent, ButtonId};
use tomcom_core::robot::ArmPhase;
use tomcom_session::files::read_kitchen;

/// So much is simulated, in seconds.
const SIMULATED_S: f64 = 300.0;

fn main() {
    let layout = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..").join("layouts/sushi.toml");
    let kitchen = read_kitchen(&layout).expect("the kitchen loads").kitchen;
    let hand = HandPose { at_m: Point3::new(0.72, 0.1, 0.1), elbow_m: Point3::new(1.0, 0.1, 0.1) };
    for (what, hand) in [("alone", None), ("with a hand near", Some(hand))] {
        let mut arm = ArmController::new(&kitchen);
        let buttons = kitchen.buttons[Agent::Robot.index()].len();
        let (began, mut presses) = (Instant::now(), 0);
        for _ in 0..(SIMULATED_S / CYCLE_S) as usize {
            match arm.phase() {
                ArmPhase::Rests => {
                    let _ = arm.set_out(ButtonId((presses * 5 % buttons) as u8));
                    presses += 1;
                }
                ArmPhase::Hovers => arm.press(),
                _ => {}
            }
            arm.cycle(hand);
        }
        let took_s = began.elapsed().as_secs_f64();
        println!("{what}: {:.0} times real time, {presses} presses", SIMULATED_S / took_s);
    }
}
