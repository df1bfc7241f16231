//! The trial's clock and the number of served orders on the participant's display.

use tomcom_core::base::time::SessionTime;
use tomcom_devices::sight::{TrialClockState, scene, sight, time_left};
use tomcom_session::Event;
use tomcom_session::engine::SessionEngine;
use tomcom_session::event::TrialEndReason;
use tomcom_session::wall_display::DisplaySpec;

use super::display::{engine, files};

#[test]
fn clock_and_number_of_served_orders_are_shown_where_the_session_says_so() {
    let at = SessionTime::from_secs_f64;
    for shown in [false, true] {
        let mut files = files("sessions/default.toml");
        (files.spec.display.clock, files.spec.display.served) = (shown, shown);
        files.spec.trial.seconds = 600.0;
        let mut engine = engine(files);
        let expect = |engine: &SessionEngine, now_s: f64, clock, left_s| {
            let (seen, left) = (sight(engine.session()), time_left(engine.session(), at(now_s)));
            let wanted = shown.then_some(clock).flatten();
            assert_eq!((seen.clock, seen.served), (wanted, shown.then_some(0)), "at {now_s} s");
            assert_eq!(left.map(SessionTime::as_secs_f64), shown.then_some(left_s), "at {now_s} s");
        };
        let give = |engine: &mut SessionEngine, now_s, event| assert_eq!(engine.input(at(now_s), event).refused, None);
        expect(&engine, 1.0, None, 600.0);
        give(&mut engine, 2.0, Event::TrialStarted);
        expect(&engine, 12.0, Some(TrialClockState::Goes), 590.0);
        // It stands in a pause, and goes on from there.
        give(&mut engine, 12.0, Event::TrialPaused);
        expect(&engine, 50.0, Some(TrialClockState::Stands), 590.0);
        give(&mut engine, 62.0, Event::TrialResumed);
        expect(&engine, 72.0, Some(TrialClockState::Goes), 580.0);
        give(&mut engine, 72.0, Event::TrialEnded { reason: TrialEndReason::Wizard });
        expect(&engine, 99.0, Some(TrialClockState::Stands), 580.0);
        let scene = scene(engine.session());
        assert_eq!((scene.clock, scene.served, scene.sound), (shown, shown, false));
    }
    let usual = toml::from_str::<DisplaySpec>("").expect("settings");
    assert!(!usual.served && !usual.clock && !usual.sound);
}
