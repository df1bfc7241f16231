//! Hands that are put into the arm's way: every contact is told, and stops the arm where it must.

use nalgebra::{Point3, Vector3};
use tomcom_arm::controller::{ArmController, ControlCycleResult};
use tomcom_arm::kinematics::SerialArm;
use tomcom_arm::physics::CYCLE_S;
use tomcom_arm::physics::bodies::HandPose;
use tomcom_arm::worker::PressFailure;
use tomcom_core::base::rng::Stream;
use tomcom_core::robot::SafetyMode;
use tomcom_core::robot::{ArmPhase, JOINTS, JointAngles};

use super::{AT_REST, STILL_RAD, any_button, at, until_report};
use crate::support::*;

/// What came of hands that were put into the arm's way. A contact is any force between arm and human. Every contact is told,
/// with its force; one above the threshold of the arm's mode stops it in the same cycle, and below that the arm was slow
/// already.
#[derive(Default)]
struct Contacts {
    tried: usize,
    /// Contacts that were not told, and of those above the threshold the ones that stopped the arm late or never.
    untold: usize,
    late: usize,
    restarted: usize,
    /// The greatest force of each contact; of those that stopped the arm, how long until it stood still, in seconds; of the
    /// others how fast the tip was when it touched, in metres a second.
    peaks_n: Vec<f64>,
    still_after_s: Vec<f64>,
    light_m_s: Vec<f64>,
    /// The greatest speed of a joint by its angles, in radians a second.
    fastest_rad_s: f64,
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
    let model = SerialArm::ur5();
    let tip = |arm: &ArmController| model.tip(&arm.joints()).translation.vector;
    let aim = tip(&arm) + Vector3::new(within(0.05), within(0.05), 0.06 + within(0.05));
    let from = Vector3::new(aim.x + 0.25, aim.y + within(0.2), 0.15);
    let step = (aim - from).normalize() * (0.4 + within(0.2)) * CYCLE_S;
    let steps = ((aim - from).norm() + 0.05) / step.norm();
    let (mut place, mut peak_n, mut told) = (from, 0.0_f64, false);
    let (mut stopped_s, mut now_s, mut since_stop, mut touched_m_s) = (None, 0.0, Vec::new(), 0.0_f64);
    for cycle in 0..(3.0 / CYCLE_S) as usize {
        now_s += CYCLE_S;
        place += if (cycle as f64) < steps && stopped_s.is_none() { step } else { Vector3::zeros() };
        let hand = HandPose { at_m: Point3::from(place), elbow_m: Point3::new(place.x + 0.28, place.y, 0.12) };
        if arm.phase() == ArmPhase::Hovers {
            arm.press();
        }
        let (threshold_n, was_stopped, tip_before) = (arm.mode.threshold_n(), arm.mode.is_stopped(), tip(&arm));
        let joints_before = arm.joints();
        let ControlCycleResult { report, felt, touched_n, .. } = arm.cycle(Some(hand));
        let moved = (0..JOINTS).map(|joint| (arm.joints()[joint] - joints_before[joint]).abs() / CYCLE_S);
        found.fastest_rad_s = moved.fold(found.fastest_rad_s, f64::max);
        if felt.human_n > 0.0 && !was_stopped {
            touched_m_s = touched_m_s.max((tip(&arm) - tip_before).norm() / CYCLE_S);
        }
        peak_n = peak_n.max(felt.human_n);
        told |= touched_n.is_some();
        let stops = matches!(report, Some(PressFailure::Contact(_)));
        // The mode of the cycle decides, which a hand that comes near may just have made stricter, never laxer.
        found.late += usize::from(felt.human_n > threshold_n && !was_stopped && !stops);
        stopped_s = stopped_s.or(stops.then_some(now_s));
        since_stop.extend(stopped_s.map(|since_s: f64| (now_s - since_s, arm.joints())));
    }
    if peak_n == 0.0 {
        return;
    }
    found.peaks_n.push(peak_n);
    found.untold += usize::from(!told);
    let Some((_, end)) = since_stop.last() else {
        found.light_m_s.push(touched_m_s);
        return;
    };
    let is_elsewhere = |joints: &JointAngles| (0..JOINTS).any(|joint| (joints[joint] - end[joint]).abs() > STILL_RAD);
    let moved = since_stop.iter().rev().find(|(_, joints)| is_elsewhere(joints));
    found.still_after_s.push(moved.map_or(0.0, |(after_s, _)| *after_s));
    found.restarted += usize::from(arm.mode != SafetyMode::ProtectiveStop);
}

fn contacts(count: usize, watches_hands: bool) -> Contacts {
    let mut random = stream(6, "contacts", 0);
    let mut found = Contacts::default();
    while found.peaks_n.len() < count && found.tried < 20 * count {
        put_hand(&mut found, watches_hands, &mut random);
    }
    for values in [&mut found.peaks_n, &mut found.still_after_s, &mut found.light_m_s] {
        values.sort_by(f64::total_cmp);
    }
    let how = if watches_hands { "with" } else { "without" };
    let [median_n, high_n, most_n] = [0.5, 0.95, 1.0].map(|share| at(&found.peaks_n, share));
    let above = found.peaks_n.iter().filter(|peak_n| **peak_n > 150.0).count();
    println!(
        "{how} speed and separation: {} hands put in the way, {} contacts, {} not told; peak force median {median_n:.0} N, \
         95 % {high_n:.0} N, most {most_n:.0} N, {above} above 150 N; {} stopped the arm, {} late, still after at most \
         {:.3} s, {} restarted; in the {} others the tip moved at most {:.3} m/s; joints up to {:.2} rad/s",
        found.tried,
        found.peaks_n.len(),
        found.untold,
        found.still_after_s.len(),
        found.late,
        at(&found.still_after_s, 1.0),
        found.restarted,
        found.light_m_s.len(),
        found.light_m_s.last().copied().unwrap_or(0.0),
        found.fastest_rad_s,
    );
    found
}

fn check_contacts(count: usize) {
    let with = contacts(count, true);
    assert_eq!(with.peaks_n.len(), count);
    assert_eq!((with.untold, with.late, with.restarted), (0, 0, 0));
    assert!(at(&with.still_after_s, 1.0) < 0.5);
    assert!(at(&with.peaks_n, 1.0) < 150.0);
    let without = contacts(count, false);
    assert_eq!((without.untold, without.late, without.restarted), (0, 0, 0));
    assert!(at(&without.peaks_n, 0.5) > at(&with.peaks_n, 0.5), "what speed and separation is good for");
}

#[test]
fn it_stops_for_hands_in_its_way() {
    check_contacts(100);
}

#[test]
#[ignore = "takes minutes"]
fn a_thousand_contacts() {
    check_contacts(1000);
}
