//! The arm in the physics: it presses every button, stops for people, and what it does when something is wrong.
//!
//! The full experiments (`cargo test --release --test arm -- --ignored --nocapture`) do what the short ones do, more often.

use std::path::Path;
use std::sync::LazyLock;

use nalgebra::{Point3, Vector3};
use rand::RngExt;
use tomcom::base::rng::{Stream, stream};
use tomcom::edge::files::read_kitchen;
use tomcom::kitchen::{Agent, ButtonId, Kitchen};
use tomcom::robot::arm::{ArmPhase, PhysicalArm, Report};
use tomcom::robot::clearance::{Capsule, InTheWay};
use tomcom::robot::kinematics::{Arm, JOINTS, Joints};
use tomcom::robot::physics::CYCLE_S;
use tomcom::robot::physics::hand::HandPlace;
use tomcom::robot::reach::Unreachable;
use tomcom::robot::safety::SafetyMode;
use tomcom::robot::trajectory::JOINT_SPEED_RAD_S;

static SUSHI: LazyLock<Kitchen> =
    LazyLock::new(|| read_kitchen(Path::new("layouts/sushi.toml")).expect("the kitchen loads").kitchen);
/// Building one takes a while, as it settles.
static AT_REST: LazyLock<PhysicalArm> = LazyLock::new(|| PhysicalArm::new(&SUSHI));

fn any_button(random: &mut Stream) -> ButtonId {
    ButtonId(random.random_range(0..SUSHI.buttons[Agent::Robot.index()].len()) as u8)
}

/// Lets it go on until it reports something, or for so long; when that was, in seconds.
fn until_report(arm: &mut PhysicalArm, hand: Option<HandPlace>, at_most_s: f64) -> (Option<Report>, f64) {
    let mut since_s = 0.0;
    while since_s < at_most_s {
        since_s += CYCLE_S;
        if arm.phase() == ArmPhase::Hovers {
            arm.press();
        }
        if let Some(report) = arm.cycle(hand) {
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

fn fastest(joints: &Joints) -> f64 {
    joints.iter().fold(0.0, |most, value| most.max(value.abs()))
}

fn at(sorted: &[f64], share: f64) -> f64 {
    sorted[((sorted.len() - 1) as f64 * share) as usize]
}

fn presses(count: usize) {
    let mut arm = AT_REST.clone();
    let mut random = stream(5, "presses", 0);
    let (mut took_s, mut speed, mut missed) = (Vec::new(), 0.0_f64, 0);
    let model = Arm::ur5();
    for _ in 0..count {
        let button = any_button(&mut random);
        arm.set_out(button).expect("a way");
        let mut since_s = 0.0;
        let report = loop {
            let (report, took_s) = until_report(&mut arm, None, CYCLE_S);
            since_s += took_s;
            let (joints, speeds) = arm.world().joints();
            speed = speed.max(fastest(&speeds));
            assert!(model.is_within_limits(&joints));
            if report.is_some() || since_s > 20.0 {
                break report;
            }
        };
        let tip = model.tip(&arm.joints()).translation.vector;
        let [x, y] = SUSHI.button(Agent::Robot, button).at_m;
        missed += usize::from(report != Some(Report::Clicked(button)) || (tip.x - x).hypot(tip.y - y) > 0.01);
        took_s.push(since_s);
    }
    took_s.sort_by(f64::total_cmp);
    let [least, median, most] = [0.0, 0.5, 1.0].map(|share| at(&took_s, share));
    println!(
        "{count} presses: {missed} missed; {least:.2} to {most:.2} s, median {median:.2} s; joints up to {speed:.3} rad/s"
    );
    assert_eq!(missed, 0);
    assert!((2.0..=3.0).contains(&median), "{median} s");
    // On straight legs the tip's speed counts, and the joints stay below it, too.
    assert!(speed < JOINT_SPEED_RAD_S * 1.01, "{speed} rad/s");
}

/// An arm that no joint leaves its place by more than this, in radians, stands still: a hand that rests on it shakes it a little.
const STILL_RAD: f64 = 0.01;

/// What came of hands that were put into the arm's way.
#[derive(Default)]
struct Contacts {
    tried: usize,
    /// Contacts that the arm has to stop for, and those that it did not notice.
    strong: usize,
    unnoticed: usize,
    restarted: usize,
    /// The greatest force of each contact, and how long until the arm stood still.
    peaks_n: Vec<f64>,
    still_after_s: Vec<f64>,
}

/// A hand that is put into the arm's way at a random moment: from the human's side to near the tip, as fast as hands go
/// that are not thrown.
fn put_hand(found: &mut Contacts, watches_hands: bool, random: &mut Stream) {
    found.tried += 1;
    let mut arm = AT_REST.clone();
    arm.watches_hands = watches_hands;
    let total_s = arm.set_out(any_button(random)).expect("a way");
    let _ = until_report(&mut arm, None, random.random::<f64>() * 0.9 * total_s);
    let mut within = |half: f64| (random.random::<f64>() - 0.5) * 2.0 * half;
    let tip = Arm::ur5().tip(&arm.joints()).translation.vector;
    let aim = tip + Vector3::new(within(0.05), within(0.05), 0.06 + within(0.05));
    let from = Vector3::new(aim.x + 0.25, aim.y + within(0.2), 0.15);
    let step = (aim - from).normalize() * (0.4 + within(0.2)) * CYCLE_S;
    let steps = ((aim - from).norm() + 0.05) / step.norm();
    let (mut place, mut peak_n, mut is_strong) = (from, 0.0_f64, false);
    let (mut stopped_s, mut now_s, mut since_stop) = (None, 0.0, Vec::new());
    for cycle in 0..(3.0 / CYCLE_S) as usize {
        now_s += CYCLE_S;
        place += if (cycle as f64) < steps && stopped_s.is_none() { step } else { Vector3::zeros() };
        let hand = HandPlace { at_m: Point3::from(place), elbow_m: Point3::new(place.x + 0.28, place.y, 0.12) };
        if arm.phase() == ArmPhase::Hovers {
            arm.press();
        }
        let (report, felt) = arm.cycle_felt(Some(hand));
        peak_n = peak_n.max(felt.human_n);
        // The threshold of the normal mode counts here, also where less stops it.
        is_strong |= felt.human_n > tomcom::robot::safety::STOP_N;
        if let Some(Report::Contact(_)) = report {
            stopped_s = Some(now_s);
        }
        since_stop.extend(stopped_s.map(|since_s: f64| (now_s - since_s, arm.joints())));
    }
    if peak_n == 0.0 {
        return;
    }
    found.peaks_n.push(peak_n);
    found.strong += usize::from(is_strong);
    let Some((_, end)) = since_stop.last() else {
        found.unnoticed += usize::from(is_strong);
        return;
    };
    let is_elsewhere = |joints: &Joints| (0..JOINTS).any(|joint| (joints[joint] - end[joint]).abs() > STILL_RAD);
    let moved = since_stop.iter().rev().find(|(_, joints)| is_elsewhere(joints));
    let still_after_s = moved.map_or(0.0, |(after_s, _)| *after_s);
    found.still_after_s.push(still_after_s);
    found.restarted += usize::from(arm.mode != SafetyMode::ProtectiveStop);
}

fn contacts(count: usize, watches_hands: bool) -> Contacts {
    let mut random = stream(6, "contacts", 0);
    let mut found = Contacts::default();
    while found.still_after_s.len() < count && found.tried < 20 * count {
        put_hand(&mut found, watches_hands, &mut random);
    }
    found.peaks_n.sort_by(f64::total_cmp);
    found.still_after_s.sort_by(f64::total_cmp);
    let how = if watches_hands { "with" } else { "without" };
    let [median_n, high_n, most_n] = [0.5, 0.95, 1.0].map(|share| at(&found.peaks_n, share));
    let above = found.peaks_n.iter().filter(|peak_n| **peak_n > 150.0).count();
    println!(
        "{how} speed and separation: {} hands put in the way, {} touched, {} stopped the arm; {} of more than 60 N, {} \
         of them unnoticed; peak force median {median_n:.0} N, 95 % {high_n:.0} N, most {most_n:.0} N, {above} above 150 \
         N; still after at most {:.3} s, {} restarted",
        found.tried,
        found.peaks_n.len(),
        found.still_after_s.len(),
        found.strong,
        found.unnoticed,
        at(&found.still_after_s, 1.0),
        found.restarted,
    );
    found
}

fn check_contacts(count: usize) {
    let with = contacts(count, true);
    assert_eq!(with.still_after_s.len(), count);
    assert_eq!((with.unnoticed, with.restarted), (0, 0));
    assert!(at(&with.still_after_s, 1.0) < 0.5);
    assert!(at(&with.peaks_n, 1.0) < 150.0);
    let without = contacts(count, false);
    assert_eq!((without.unnoticed, without.restarted), (0, 0));
    assert!(at(&without.peaks_n, 0.5) > at(&with.peaks_n, 0.5), "what speed and separation is good for");
}

#[test]
fn it_presses_every_button_and_keeps_its_limits() {
    presses(40);
}

#[test]
fn it_stops_for_hands_in_its_way() {
    check_contacts(20);
}

#[test]
#[ignore = "takes minutes"]
fn a_thousand_presses() {
    presses(1000);
}

#[test]
#[ignore = "takes minutes"]
fn a_thousand_contacts() {
    check_contacts(1000);
}

/// The bits of all joint angles of some presses: to be compared between builds and processes.
#[test]
#[ignore = "prints, and checks nothing"]
fn print_joints() {
    let mut arm = PhysicalArm::new(&SUSHI);
    let mut random = stream(7, "presses", 0);
    for _ in 0..10 {
        arm.set_out(any_button(&mut random)).expect("a way");
        until_report(&mut arm, None, 20.0);
        println!("joints {:x?}", arm.joints().map(f64::to_bits));
    }
}

#[test]
fn the_same_presses_move_the_joints_the_same_way_bit_for_bit() {
    let run = || {
        let mut arm = AT_REST.clone();
        let mut bits = Vec::new();
        for button in [3, 0, 5] {
            arm.set_out(ButtonId(button)).expect("a way");
            while until_report(&mut arm, None, CYCLE_S).0.is_none() {
                bits.extend(arm.joints().map(f64::to_bits));
            }
        }
        bits
    };
    assert_eq!(run(), run());
}

/// A hand just above the table at the arm's tip, or beside it.
fn hand_at([x, y, z]: [f64; 3]) -> HandPlace {
    HandPlace { at_m: Point3::new(x, y, z), elbow_m: Point3::new(x + 0.28, y, z) }
}

#[test]
fn after_a_protective_stop_only_the_wizard_lets_it_go_on_and_then_it_goes_up_and_presses() {
    let mut arm = AT_REST.clone();
    arm.watches_hands = false;
    arm.set_out(ButtonId(0)).expect("a way");
    let [x, y] = SUSHI.button(Agent::Robot, ButtonId(0)).at_m;
    // The hand lies on the button.
    let (report, _) = until_report(&mut arm, Some(hand_at([x, y, 0.05])), 10.0);
    assert!(matches!(report, Some(Report::Contact(force_n)) if force_n > 60.0), "{report:?}");
    assert_eq!(arm.mode, SafetyMode::ProtectiveStop);
    assert_eq!(until_report(&mut arm, None, 5.0).0, None);
    assert!(!arm.moves() && !arm.is_busy() && arm.mode == SafetyMode::ProtectiveStop, "the hand is gone, it stays");
    let low_m = Arm::ur5().tip(&arm.joints()).translation.z;
    arm.resume();
    until_report(&mut arm, None, 2.0);
    assert!(Arm::ur5().tip(&arm.joints()).translation.z > low_m + 0.01, "it goes up first");
    arm.set_out(ButtonId(0)).expect("a way");
    assert_eq!(until_report(&mut arm, None, 10.0).0, Some(Report::Clicked(ButtonId(0))));
}

#[test]
fn a_hand_in_the_way_makes_it_wait_and_then_give_the_press_up() {
    let mut arm = AT_REST.clone();
    arm.set_out(ButtonId(0)).expect("a way");
    let [x, y] = SUSHI.button(Agent::Robot, ButtonId(0)).at_m;
    let (report, after_s) = until_report(&mut arm, Some(hand_at([x, y, 0.05])), 30.0);
    assert_eq!(report, Some(Report::Blocked(ButtonId(0))));
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
    assert_eq!(until_report(&mut arm, None, 10.0).0, Some(Report::Clicked(ButtonId(1))));
}

#[test]
fn a_joint_that_gives_way_is_a_fault_and_the_brakes_hold() {
    let mut arm = AT_REST.clone();
    arm.set_out(ButtonId(1)).expect("a way");
    until_report(&mut arm, None, 1.0);
    arm.world().fail(Some(1));
    let (report, after_s) = until_report(&mut arm, None, 2.0);
    assert_eq!(report, Some(Report::Fault(1)));
    assert!(after_s < 0.5 && arm.mode == SafetyMode::Fault);
    until_report(&mut arm, None, 1.0);
    assert!(!arm.moves());
    assert!(Arm::ur5().tip(&arm.joints()).translation.z > 0.02, "it did not fall on the table");
}

#[test]
fn a_button_that_does_not_click_is_given_up() {
    let mut arm = AT_REST.clone();
    arm.set_out(ButtonId(2)).expect("a way");
    arm.world().jam(2);
    assert_eq!(until_report(&mut arm, None, 10.0).0, Some(Report::NoClick(ButtonId(2))));
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
    assert_eq!(arm.set_out(ButtonId(0)), Err(Unreachable::Blocked(InTheWay::Obstacle)));
    // Between two buttons it is gone over.
    let mut arm = AT_REST.clone();
    arm.set_out(ButtonId(0)).expect("a way");
    until_report(&mut arm, None, 10.0);
    let mut direct = arm.clone();
    let direct_s = direct.set_out(ButtonId(3)).expect("a way");
    until_report(&mut direct, None, direct_s / 2.0);
    let midway = Arm::ur5().tip(&direct.joints()).translation.vector;
    arm.around().obstacles.push(post(0.12, midway.x, midway.y));
    let around_s = arm.set_out(ButtonId(3)).expect("a way over it");
    assert!(around_s > direct_s, "{around_s} s instead of {direct_s} s");
    assert_eq!(until_report(&mut arm, None, 15.0).0, Some(Report::Clicked(ButtonId(3))));
}
