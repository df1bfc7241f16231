//! The robot's hand on the participant's display: where it is told to be, and that nothing of what comes is told.

use tomcom_core::kitchen::ButtonAction;
use tomcom_devices::sight::{RobotHand, RobotHandPose, scene};
use tomcom_session::TimelineEvent;
use tomcom_session::wall_display::RobotDepiction;

use super::display::{engine, files};
use crate::support::*;

/// Time from pose to pose, in seconds, as in a live session.
const STEP_S: f64 = 0.05;

fn session_with(arm: ArmKind, shown: RobotDepiction) -> SessionEngine {
    let mut files = files("sessions/default.toml");
    files.spec.robot.arm = arm;
    files.spec.display.arm = shown;
    engine(files)
}

/// Lets a trial run, and returns the hand's poses with the number of the robot's presses at each.
fn poses(
    engine: &mut SessionEngine,
    seconds: f64,
    mut each: impl FnMut(u32, &mut SessionEngine),
) -> Vec<(RobotHandPose, u32)> {
    let mut hand = RobotHand::new(engine.session()).expect("it is shown");
    assert_eq!(engine.input(SessionTime::ZERO, Event::TrialStarted).refused, None);
    let mut poses = Vec::new();
    for step in 0..(seconds / STEP_S) as u32 {
        let now = at(STEP_S * f64::from(step));
        while engine.next_due().is_some_and(|due| due <= now) {
            engine.fire();
        }
        each(step, engine);
        let session = engine.session();
        poses.push((hand.at(session, now), session.presses[Agent::Robot.index()]));
    }
    poses
}

/// The middle of the place of each press of the robot so far.
fn pressed_places(session: &Session) -> Vec<[f64; 2]> {
    let kitchen = &session.kitchen;
    let presses = session.timeline.iter().filter_map(|entry| match entry.what {
        TimelineEvent::Press { agent: Agent::Robot, button, .. } => Some(kitchen.button(Agent::Robot, button).action),
        _ => None,
    });
    presses.map(|action| middle(kitchen, action)).collect()
}

fn middle(kitchen: &Kitchen, action: ButtonAction) -> [f64; 2] {
    let hand = kitchen.hands[Agent::Robot.index()];
    let location = match action {
        ButtonAction::Take(item) => {
            let is_it = |storage: &&tomcom_core::kitchen::IngredientStorage| {
                storage.agent == Agent::Robot && storage.item == item
            };
            return kitchen.storages.iter().find(is_it).expect("a storage").display.centre();
        }
        ButtonAction::Use(location) | ButtonAction::Serve(location) => location,
        ButtonAction::Process(process) => kitchen.processes[usize::from(process)].place.unwrap_or(hand),
        ButtonAction::Trash => hand,
    };
    kitchen.location(location).display.centre()
}

fn apart(a: [f64; 2], b: [f64; 2]) -> f64 {
    (a[0] - b[0]).hypot(a[1] - b[1])
}

#[test]
fn the_hand_is_at_the_place_of_each_press_and_never_jumps() {
    // Where two buttons are near each other, and their places are not, the physical arm's hand is quick.
    for (arm, most) in [(ArmKind::Timed, 0.12), (ArmKind::Physics, 0.25)] {
        let mut engine = session_with(arm, RobotDepiction::Hand);
        let poses = poses(&mut engine, 60.0, |_, _| ());
        let places = pressed_places(engine.session());
        assert!(places.len() > 10, "{arm:?}: {} presses", places.len());
        for pair in poses.windows(2) {
            let [(before, _), (after, presses)] = pair else { unreachable!() };
            let moved = apart([before.x, before.y], [after.x, after.y]);
            assert!(moved < most, "{arm:?}: {moved:.3} of the display in {STEP_S} s");
            if pair[0].1 < *presses {
                let place = places[*presses as usize - 1];
                let away = apart(place, [before.x, before.y]).min(apart(place, [after.x, after.y]));
                let down = before.down.max(after.down);
                assert!(away < 0.02 && down > 0.5, "{arm:?}, press {presses}: {away:.3} away, {down:.2} down");
            }
        }
    }
}

#[test]
fn the_page_is_told_a_pose_and_nothing_of_what_comes() {
    let mut engine = session_with(ArmKind::Timed, RobotDepiction::Hand);
    for (pose, _) in poses(&mut engine, 60.0, |_, _| ()) {
        let told = serde_json::to_value(pose).expect("a pose is JSON");
        assert_eq!(told, json!({"x": pose.x, "y": pose.y, "down": pose.down}));
        assert!([pose.x, pose.y, pose.down].iter().all(|value| (0.0..=1.0).contains(value)), "{told}");
    }
    // Until it sets out, two presses with different goals look alike: the pose is that of the last one.
    let setting_out = |engine: &SessionEngine| engine.session().robot.intention.map(|(_, since, _)| since);
    let mut engine = session_with(ArmKind::Timed, RobotDepiction::Hand);
    let mut hand = RobotHand::new(engine.session()).expect("it is shown");
    let rest = hand.at(engine.session(), SessionTime::ZERO);
    assert_eq!(engine.input(SessionTime::ZERO, Event::TrialStarted).refused, None);
    let since = setting_out(&engine).expect("it sets out at once");
    assert_eq!(hand.at(engine.session(), since), rest);
}

#[test]
fn a_stopped_robot_stands_still_and_goes_on_from_there() {
    let mut engine = session_with(ArmKind::Timed, RobotDepiction::Hand);
    let (stop, resume) = (250, 330);
    let poses = poses(&mut engine, 40.0, |step, engine| {
        let event = match step {
            step if step == stop => Event::RobotStopped,
            step if step == resume => Event::RobotResumed,
            _ => return,
        };
        let outcome = engine.input(engine.session().time, event);
        assert_eq!(outcome.refused, None);
    });
    let places: Vec<[f64; 2]> = poses.iter().map(|(pose, _)| [pose.x, pose.y]).collect();
    assert!(places[stop as usize..resume as usize].iter().all(|place| *place == places[stop as usize]));
    assert!(places[resume as usize..].iter().any(|place| apart(*place, places[stop as usize]) > 0.1));
    assert!(places.windows(2).all(|pair| apart(pair[0], pair[1]) < 0.12), "it does not jump");
}

#[test]
fn a_robot_without_a_press_to_make_rests_at_its_place() {
    let mut engine = session_with(ArmKind::Timed, RobotDepiction::Hand);
    let rest = RobotHand::new(engine.session()).expect("it is shown").at(engine.session(), SessionTime::ZERO);
    // Stopped and held by the wizard it has no press to make; stopped, it stays where it is.
    let (stop, resume) = (250, 300);
    let poses = poses(&mut engine, 25.0, |step, engine| {
        let by = Sender::Wizard;
        let events = match step {
            step if step == stop => vec![Event::RobotStopped, Event::RobotHeld { by }],
            step if step == resume => vec![Event::RobotResumed],
            _ => return,
        };
        for event in events {
            assert_eq!(engine.input(engine.session().time, event).refused, None);
        }
    });
    let [stopped, goes, rests] = [resume as usize - 1, resume as usize + 12, poses.len() - 1].map(|at| poses[at].0);
    assert!(apart([stopped.x, stopped.y], [rest.x, rest.y]) > 0.05, "it was stopped away from its place: {stopped:?}");
    assert_eq!(stopped, poses[stop as usize + 1].0);
    assert_ne!(goes, stopped);
    assert_eq!(rests, rest);
}

#[test]
fn a_session_says_how_the_robot_is_shown() {
    let shown = |arm: RobotDepiction| {
        let mut files = files("sessions/default.toml");
        files.spec.display.arm = arm;
        let engine = engine(files);
        (RobotHand::new(engine.session()).is_some(), scene(engine.session()).arm)
    };
    assert_eq!(shown(RobotDepiction::Arm), (true, "arm"));
    assert_eq!(shown(RobotDepiction::None), (false, "none"));
    let of_file = |path: &str| read_session(path.as_ref()).expect("a session file").spec.display.arm;
    assert_eq!(of_file("sessions/default.toml"), RobotDepiction::Hand);
    assert_eq!(of_file("sessions/burger.toml"), RobotDepiction::Hand, "where the file says nothing");
    assert_eq!(of_file("sessions/study.toml"), RobotDepiction::Hand, "the example is for people without a real robot");
}
