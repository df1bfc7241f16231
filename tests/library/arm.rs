//! The arm in the physics: it presses every button, stops for people, and what it does when something is wrong.
//!
//! The full experiments (`cargo test --release --test library arm:: -- --ignored --nocapture`) do what the short ones do, more often.

use std::path::Path;
use std::sync::{Arc, LazyLock};

use nalgebra::{Point3, Vector3};
use rand::RngExt;
use tomcom::arm::clearance::{Capsule, Obstruction};
use tomcom::arm::controller::{ControlCycle, PhysicalArm};
use tomcom::arm::kinematics::Arm;
use tomcom::arm::physics::CYCLE_S;
use tomcom::arm::physics::hand::HandPose;
use tomcom::arm::reach::Unreachable;
use tomcom::arm::reaching::{ReachingBehaviour, ReachingHand};
use tomcom::arm::report::PressFailure;
use tomcom::arm::trajectory::JOINT_SPEED_RAD_S;
use tomcom::base::rng::{Stream, stream};
use tomcom::base::time::SessionTime;
use tomcom::communication::Sender;
use tomcom::communication::settings::Shadow;
use tomcom::edge::files::{read_kitchen, read_session};
use tomcom::kitchen::cost_to_go::CostToGo;
use tomcom::kitchen::{Agent, ButtonId, Kitchen};
use tomcom::robot::AbortReason;
use tomcom::robot::moment::{ArmPhase, ArmSample, JOINTS, JointAngles};
use tomcom::robot::safety::SafetyMode;
use tomcom::run::engine::Engine;
use tomcom::session::Event;
use tomcom::session::settings::{ArmKind, GazeSource, ParticipantKind};

static SUSHI: LazyLock<Kitchen> =
    LazyLock::new(|| read_kitchen(Path::new("layouts/sushi.toml")).expect("the kitchen loads").kitchen);
/// Building one takes a while, as it settles.
static AT_REST: LazyLock<PhysicalArm> = LazyLock::new(|| PhysicalArm::new(&SUSHI));

fn any_button(random: &mut Stream) -> ButtonId {
    ButtonId(random.random_range(0..SUSHI.buttons[Agent::Robot.index()].len()) as u8)
}

/// What came of a press.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Came {
    Clicked(ButtonId),
    Not(PressFailure),
}

fn came(cycle: &ControlCycle) -> Option<Came> {
    cycle.clicked.map(Came::Clicked).or(cycle.report.map(Came::Not))
}

/// Lets it go on until something comes of its press, or for so long; when that was, in seconds.
fn until_report(arm: &mut PhysicalArm, hand: Option<HandPose>, at_most_s: f64) -> (Option<Came>, f64) {
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

fn fastest(joints: &JointAngles) -> f64 {
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
        missed += usize::from(report != Some(Came::Clicked(button)) || (tip.x - x).hypot(tip.y - y) > 0.01);
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
const STILL_RAD: f64 = 0.003;

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
    let model = Arm::ur5();
    let tip = |arm: &PhysicalArm| model.tip(&arm.joints()).translation.vector;
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
        let ControlCycle { report, felt, touched_n, .. } = arm.cycle(Some(hand));
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
         {:.3} s, {} restarted; in the {} others the tip moved at most {:.3} m/s",
        found.tried,
        found.peaks_n.len(),
        found.untold,
        found.still_after_s.len(),
        found.late,
        at(&found.still_after_s, 1.0),
        found.restarted,
        found.light_m_s.len(),
        found.light_m_s.last().copied().unwrap_or(0.0),
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
fn it_presses_every_button_and_keeps_its_limits() {
    presses(100);
}

#[test]
fn it_stops_for_hands_in_its_way() {
    check_contacts(100);
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

/// Of the bits of all joint angles of the presses below: in debug and in release builds, on every machine.
const JOINTS_CRC: u32 = 0x120d_0c2b;

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
    let low_m = Arm::ur5().tip(&arm.joints()).translation.z;
    arm.resume();
    until_report(&mut arm, None, 2.0);
    assert!(Arm::ur5().tip(&arm.joints()).translation.z > low_m + 0.01, "it goes up first");
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
    assert!(Arm::ur5().tip(&arm.joints()).translation.z > 0.02, "it did not fall on the table");
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
    assert_eq!(arm.set_out(ButtonId(0)), Err(Unreachable::Blocked(Obstruction::Obstacle)));
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
    assert_eq!(until_report(&mut arm, None, 15.0).0, Some(Came::Clicked(ButtonId(3))));
}

/// A session at the keyboard, in which nobody presses anything by himself, in this kitchen.
fn session(kitchen: Kitchen) -> Engine {
    let mut spec = read_session(Path::new("sessions/default.toml")).expect("the default session").spec;
    assert_eq!(spec.robot.arm, ArmKind::Physics);
    (spec.participant.kind, spec.participant.gaze) = (ParticipantKind::Keyboard, GazeSource::None);
    spec.assistant.shadow = Shadow::Off;
    let kitchen = Arc::new(kitchen);
    Engine::new(kitchen.clone(), spec, 0, CostToGo::new(kitchen))
}

/// Lets the session go on until such an event, or for so long; everything that happened.
fn until(engine: &mut Engine, at_most_s: f64, is_it: impl Fn(&Event) -> bool) -> Vec<Event> {
    let end = engine.session().time + SessionTime::from_secs_f64(at_most_s);
    let mut seen = Vec::new();
    while engine.next_due().is_some_and(|due| due <= end) {
        let events = engine.fire().into_iter().map(|stamped| stamped.event);
        seen.extend(events);
        if seen.iter().any(&is_it) {
            return seen;
        }
    }
    // The time goes by all the same.
    seen.extend(
        engine.input(end, Event::Marker { note: String::new() }).events.into_iter().map(|stamped| stamped.event),
    );
    seen
}

fn is_robots_press(event: &Event) -> bool {
    matches!(event, Event::Press { agent: Agent::Robot, .. })
}

fn aborts(events: &[Event]) -> Vec<AbortReason> {
    let reason = |event: &Event| match event {
        Event::RobotAborts { reason, .. } => Some(*reason),
        _ => None,
    };
    events.iter().filter_map(reason).collect()
}

fn modes(events: &[Event]) -> Vec<SafetyMode> {
    let mode = |event: &Event| match event {
        Event::RobotSafety { mode, .. } => Some(*mode),
        _ => None,
    };
    events.iter().filter_map(mode).collect()
}

fn input(engine: &mut Engine, event: Event) -> Vec<Event> {
    let outcome = engine.input(engine.session().time, event);
    assert_eq!(outcome.refused, None);
    outcome.events.into_iter().map(|stamped| stamped.event).collect()
}

/// A session whose trial runs, with its arm on its way.
fn on_its_way() -> Engine {
    let mut engine = session(SUSHI.clone());
    input(&mut engine, Event::TrialStarted);
    until(&mut engine, 10.0, |event| matches!(event, Event::RobotMoves(moment) if moment.phase == ArmPhase::Travels));
    engine
}

#[test]
fn a_session_tells_what_the_arm_does_until_its_press() {
    let mut engine = on_its_way();
    let seen = until(&mut engine, 10.0, is_robots_press);
    let told: Vec<&ArmSample> = seen
        .iter()
        .filter_map(|event| if let Event::RobotMoves(moment) = event { Some(moment) } else { None })
        .collect();
    let time_s = engine.session().time.as_secs_f64();
    assert!((1.0..4.0).contains(&time_s), "{time_s} s");
    assert!(told.len() as f64 <= 14.0 * time_s + 6.0, "{} moments in {time_s} s", told.len());
    assert!(told.iter().any(|moment| moment.phase == ArmPhase::Presses));
    assert_eq!(modes(&seen), [], "nobody is near");
    let felt = until(&mut engine, 1.0, |event| matches!(event, Event::RobotMoves(moment) if moment.force_n > 0.0));
    let force_n = engine.session().robot.arm.last.expect("it was told").1.force_n;
    assert!(!felt.is_empty() && (2.0..30.0).contains(&force_n), "the button was pressed with {force_n} N");
}

/// A stop that the session tells so; then nothing moves or is pressed until the wizard lets the arm go on.
fn check_stop(engine: &mut Engine, seen: &[Event], mode: SafetyMode, reason: AbortReason) {
    assert_eq!(modes(seen).last(), Some(&mode), "{seen:?}");
    assert_eq!(aborts(seen), [reason]);
    assert!(engine.session().robot.stopped);
    until(engine, 1.0, |_| false);
    let there = engine.session().robot.arm.last.expect("it was told").1.joints;
    let meanwhile = until(engine, 30.0, |event| is_robots_press(event) || matches!(event, Event::RobotIntends { .. }));
    assert!(!meanwhile.iter().any(|event| is_robots_press(event) || matches!(event, Event::RobotIntends { .. })));
    let now = engine.robot().arm().expect("an arm in the physics").joints();
    assert!((0..JOINTS).all(|joint| (now[joint] - there[joint]).abs() < STILL_RAD), "it stays where it is");
    engine.robot().arm().expect("an arm in the physics").world().fail(None);
    let resumed = input(engine, Event::RobotResumed);
    assert_eq!(modes(&resumed), [SafetyMode::Normal]);
    let after = until(engine, 20.0, is_robots_press);
    assert!(after.iter().any(is_robots_press), "it goes on: {after:?}");
}

#[test]
fn a_session_stops_its_arm_when_it_touches_somebody() {
    let mut engine = on_its_way();
    // Somebody whose hand the arm does not see coming, on the button that it goes for.
    engine.robot().arm().expect("an arm in the physics").watches_hands = false;
    let board = SUSHI.button_named(Agent::Robot, "assembly_board").expect("a shared button");
    let name = SUSHI.button(Agent::Robot, board).name.clone();
    let pressed = || Event::Press { agent: Agent::Human, button: name.clone(), at_ns: None };
    input(&mut engine, Event::RobotHeld { by: Sender::Wizard });
    input(&mut engine, pressed());
    until(&mut engine, 1.0, |_| false);
    let mut seen = input(&mut engine, Event::RobotDriven { by: Sender::Wizard, button: name.clone() });
    assert_eq!(aborts(&seen), [AbortReason::Driven]);
    seen.clear();
    for _ in 0..5 {
        // So that the hand stays there.
        input(&mut engine, pressed());
        seen.extend(until(&mut engine, 1.0, |event| matches!(event, Event::RobotTouched { .. })));
    }
    input(&mut engine, Event::RobotReleased { by: Sender::Wizard });
    let told = |event: &Event| if let Event::RobotTouched { force_n } = event { Some(*force_n) } else { None };
    let force_n = seen.iter().find_map(told).expect("the contact is told");
    assert!((60.0..150.0).contains(&force_n), "{force_n} N");
    check_stop(&mut engine, &seen, SafetyMode::ProtectiveStop, AbortReason::Contact);
}

#[test]
fn a_session_stops_its_arm_at_the_wizards_key_and_where_a_joint_is_at_fault() {
    let mut engine = on_its_way();
    let seen = input(&mut engine, Event::RobotStopped);
    check_stop(&mut engine, &seen, SafetyMode::EmergencyStop, AbortReason::Stopped);
    let mut engine = on_its_way();
    engine.robot().arm().expect("an arm in the physics").world().fail(Some(1));
    let seen = until(&mut engine, 2.0, |event| matches!(event, Event::RobotAborts { .. }));
    assert!(seen.iter().any(|event| matches!(event, Event::RobotSafety { joint: Some(2), .. })));
    check_stop(&mut engine, &seen, SafetyMode::Fault, AbortReason::Fault);
}

#[test]
fn the_wizards_key_counts_where_the_arm_has_stopped_by_itself_too() {
    let mut engine = on_its_way();
    engine.robot().arm().expect("an arm in the physics").world().fail(Some(1));
    until(&mut engine, 2.0, |event| matches!(event, Event::RobotAborts { .. }));
    assert_eq!(modes(&input(&mut engine, Event::RobotStopped)), [SafetyMode::EmergencyStop]);
    let again = engine.input(engine.session().time, Event::RobotStopped);
    assert!(again.refused.is_some(), "it is stopped by the wizard already");
}

/// In a session whose kitchen or arm is changed so, every press is given up for this reason, and tried again later.
fn check_given_up(change: impl Fn(&mut Kitchen), meddle: impl Fn(&mut PhysicalArm), reason: AbortReason) {
    let mut kitchen = SUSHI.clone();
    change(&mut kitchen);
    let mut engine = session(kitchen);
    meddle(engine.robot().arm().expect("an arm in the physics"));
    let mut seen = input(&mut engine, Event::TrialStarted);
    seen.extend(until(&mut engine, 20.0, is_robots_press));
    let given_up = aborts(&seen);
    assert!(given_up.len() > 3 && given_up.iter().all(|one| *one == reason), "{given_up:?}");
    assert!(!seen.iter().any(is_robots_press));
    assert!(given_up.len() < 40, "what went wrong is left out for a while: {}", given_up.len());
}

#[test]
fn a_press_that_cannot_be_made_is_given_up_for_a_reason() {
    let moved = |at_m: [f64; 2]| {
        move |kitchen: &mut Kitchen| {
            kitchen.buttons[Agent::Robot.index()].iter_mut().for_each(|button| button.at_m = at_m)
        }
    };
    let nothing = |_: &mut PhysicalArm| ();
    check_given_up(moved([1.1, 0.2]), nothing, AbortReason::OutOfReach);
    check_given_up(moved([0.89, 0.0]), nothing, AbortReason::Singular);
    let walled = |arm: &mut PhysicalArm| {
        for button in &SUSHI.buttons[Agent::Robot.index()] {
            let [x, y] = button.at_m;
            let ends_m = [Point3::new(x, y, 0.0), Point3::new(x, y, 0.5)];
            arm.around().obstacles.push(Capsule { ends_m, radius_m: 0.03 });
        }
    };
    check_given_up(|_| (), walled, AbortReason::Obstructed);
    let jammed = |arm: &mut PhysicalArm| {
        (0..SUSHI.buttons[Agent::Robot.index()].len()).for_each(|button| arm.world().jam(button))
    };
    check_given_up(|_| (), jammed, AbortReason::NoClick);
}

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
