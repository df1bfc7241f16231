//! The arm in the physics: it presses every button, stops for people, and what it does when something is wrong.
//!
//! The full experiments (`cargo test --release --test library arm:: -- --ignored --nocapture`) do what the short ones do, more often.

mod contacts;
mod presses;
mod reach;
mod real;
mod sessions;

use std::sync::LazyLock;

use tomcom_arm::controller::{ArmController, ControlCycleResult};
use tomcom_arm::physics::CYCLE_S;
use tomcom_arm::physics::bodies::HandPose;
use tomcom_arm::worker::PressFailure;
use tomcom_core::base::rng::Stream;
use tomcom_core::robot::ArmPhase;

use crate::support::*;

static SUSHI: LazyLock<Arc<Kitchen>> = LazyLock::new(|| kitchen("sushi"));
/// Building one takes a while, as it settles.
static AT_REST: LazyLock<ArmController> = LazyLock::new(|| ArmController::new(&SUSHI));

fn any_button(random: &mut Stream) -> ButtonId {
    ButtonId(random.random_range(0..SUSHI.buttons[Agent::Robot.index()].len()) as u8)
}

/// What came of a press.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Came {
    Clicked(ButtonId),
    Not(PressFailure),
}

fn came(cycle: &ControlCycleResult) -> Option<Came> {
    cycle.clicked.map(Came::Clicked).or(cycle.report.map(Came::Not))
}

/// Lets it go on until something comes of its press, or for so long; when that was, in seconds.
fn until_report(arm: &mut ArmController, hand: Option<HandPose>, at_most_s: f64) -> (Option<Came>, f64) {
    let mut since_s = 0.0;
    while since_s < at_most_s {
        since_s += CYCLE_S;
        if arm.phase() == ArmPhase::Hovers {
            arm.press();
        }
        if let Some(report) = came(&arm.cycle(hand)) {
            // Then it stands for a moment, and can set out for something else.
            while arm.halts() && !arm.mode.is_stopped() {
                since_s += CYCLE_S;
                arm.cycle(hand);
            }
            return (Some(report), since_s);
        }
    }
    (None, since_s)
}

fn at(sorted: &[f64], share: f64) -> f64 {
    sorted[((sorted.len() - 1) as f64 * share) as usize]
}

/// An arm that no joint leaves its place by more than this, in radians, stands still: a hand that rests on it shakes it a little.
const STILL_RAD: f64 = 0.003;
