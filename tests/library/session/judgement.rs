//! Which presses are errors.

use std::fs;
use std::path::Path;

use tomcom::edge::files::read_session;
use tomcom::run::recording_list::{RecordingListDetail, list};
use tomcom_core::kitchen::cost_to_go::CostToGo;
use tomcom_core::kitchen::{Agent, OrderContent};
use tomcom_core::measures::errors::{PressJudge, PressVerdict};
use tomcom_session::engine::{InputResult, SessionEngine};
use tomcom_session::follower::SessionFollower;
use tomcom_session::log::LogWriter;
use tomcom_session::probes::ProbeEvent;
use tomcom_session::{Event, LogHeader, Session, TimestampedEvent};

use super::probes::on_request;
use super::{at, kitchen, press};

/// The verdict on the human's last press of a list by both agents, one second apart but for the last one, that comes
/// `after_s` after the one before it; orders of these dishes are present.
fn verdict(dishes: &[&str], presses: &[(Agent, &str)], after_s: f64) -> PressVerdict {
    let kitchen = kitchen();
    let mut cost = CostToGo::new(kitchen.clone());
    let mut judge = PressJudge::new(kitchen.clone());
    let mut state = kitchen.empty_state();
    for (order, dish) in kitchen.orders.iter().zip(dishes) {
        let dish = kitchen.dishes.iter().position(|known| known.name == *dish).expect("a dish of the menu");
        state.set_order(*order, OrderContent::Dish(tomcom_core::kitchen::DishId(dish as u8)));
    }
    let mut last = None;
    for (index, (agent, name)) in presses.iter().enumerate() {
        let button = kitchen.button_named(*agent, name).expect("a button");
        let is_last = index + 1 == presses.len();
        let now = at(if is_last { index as f64 - 1.0 + after_s } else { index as f64 });
        let press = kitchen.try_press(state, *agent, button);
        match agent {
            Agent::Robot => judge.others_changed(now, press.before, press.after),
            Agent::Human => last = Some(judge.human_pressed(&mut cost, now, &press)),
        }
        state = press.after;
    }
    last.expect("a press of the human")
}

#[test]
fn errors_are_presses_that_lose_more_than_the_best_one() {
    use Agent::{Human, Robot};
    let good = verdict(&["crab maki"], &[(Human, "take crab")], 1.0);
    assert_eq!(good, PressVerdict { regret: 0, excess: 0, race: false, error: false, is_proven: true });
    // The wrong shellfish has to be thrown away.
    let wrong = verdict(&["crab maki"], &[(Human, "take shrimp")], 1.0);
    assert_eq!((wrong.excess, wrong.error), (2, true));
    let nothing_to_cut = verdict(&["crab maki"], &[(Human, "cut")], 1.0);
    assert_eq!((nothing_to_cut.regret, nothing_to_cut.error), (1, true));
    // Without an order no press is better than another.
    assert!(!verdict(&[], &[(Human, "cut")], 1.0).error);
    // The robot was faster at the board by a quarter of a second, or by two.
    let both = [(Human, "take nori"), (Robot, "take nori"), (Robot, "assembly_board"), (Human, "assembly_board")];
    let (race, late) = (verdict(&["crab maki"], &both, 0.25), verdict(&["crab maki"], &both, 2.0));
    assert_eq!((race.race, race.error, late.race, late.error), (true, false, false, true));
}

/// The events of a session in which a freeze probe stands between a correction of the wizard and a press at its place.
fn press_after_a_probe() -> (SessionEngine, Vec<TimestampedEvent>) {
    let mut engine = on_request(|_| ());
    let corrected = Event::KitchenCorrected { location: "human_hand".to_string(), content: "nori".to_string() };
    let skipped = ProbeEvent::Skipped { probe: 1, reason: "phone".to_string() };
    let inputs = [
        (0.0, Event::TrialStarted),
        (0.4, corrected),
        (0.5, Event::Probe(ProbeEvent::Requested)),
        (1.0, Event::Probe(skipped)),
        // The probe ends at 4 s, after its count down.
        (4.1, press("cut")),
    ];
    let mut events = Vec::new();
    for (seconds, event) in inputs {
        let InputResult { events: new, refused } = engine.input(at(seconds), event.clone());
        assert_eq!(refused, None, "{event:?}");
        events.extend(new);
    }
    (engine, events)
}

#[test]
fn a_freeze_probe_is_no_time_for_the_next_press_wherever_presses_are_judged() {
    let (engine, events) = press_after_a_probe();
    let spec = &engine.session().spec;
    let mut follower = SessionFollower::new(Session::new(kitchen(), spec.clone(), 0), CostToGo::new(kitchen()));
    events.iter().for_each(|stamped| drop(follower.apply(stamped).expect("its own events")));
    let verdict = follower.judged.last().expect("a press").verdict;
    assert!(verdict.excess >= 1 && verdict.race && !verdict.error, "{verdict:?}");
    // The list of recordings judges by itself.
    let files = read_session(Path::new("sessions/default.toml")).expect("the default session");
    let out = Path::new(env!("CARGO_TARGET_TMPDIR")).join("judged-after-a-probe");
    let _ = fs::remove_dir_all(&out);
    let header = LogHeader::new(spec.clone(), 0, files.kitchen.layout, files.kitchen.recipes);
    let mut log = LogWriter::create_live(&out, "2026-03-14", &header).expect("a recording");
    events.iter().for_each(|stamped| log.append(stamped).expect("written"));
    drop(log);
    let (listed, _) = list(&out, RecordingListDetail::WithErrors, |_| (), || ()).expect("a recording");
    assert_eq!(listed.recordings[0].errors, Some(0));
}
