//! What the program hears of its surroundings: clocks, and the colours of the terminal.

use std::time::Duration;

use tomcom::console::view::theme::TerminalBackground;
use tomcom::run::ask::background;
use tomcom::run::clock::SessionClock;
use tomcom_session::files::WallTime;

use crate::support::*;

#[test]
fn session_time_knows_no_wall_clock_and_stands_still_with_the_program() {
    let offset = SessionTime(5_000_000_000);
    let mut clock = SessionClock::start(offset);
    let (began, wall) = (clock.instant_of(offset), WallTime::now());
    let after = |ms: u64| began + Duration::from_millis(ms);
    let shows = |ms: u64| offset + SessionTime(ms * 1_000_000);
    let wall_after = |ms: i64| wall.after_millis(ms);
    assert_eq!(clock.at(after(400)), shows(400));
    assert_eq!(clock.jump_at(shows(400), wall_after(410)), None);
    // Test: the wall clock is set forward by an hour, then back again. Each jump is reported once, and no session
    // time passes.
    let told = clock.jump_at(shows(400), wall_after(3_600_400)).expect("a jump");
    assert!((told - 3_600_000).abs() < 100, "{told}");
    assert_eq!(clock.jump_at(shows(400), wall_after(3_600_400)), None);
    assert!(clock.jump_at(shows(400), wall_after(400)).is_some_and(|by_ms| by_ms < -3_599_000));
    // In this test, the computer is suspended for a minute.
    assert_eq!(clock.at(after(60_400)), shows(400));
    assert!(clock.jump_at(shows(400), wall_after(60_400)).is_some_and(|by_ms| (59_900..60_100).contains(&by_ms)));
    assert_eq!(clock.at(after(60_500)), shows(500));
    assert_eq!(clock.instant_of(shows(700)), after(60_700));
}

#[test]
fn a_colour_has_one_to_four_digits_and_everything_else_is_none() {
    let told = |colour: &str| background(&format!("\x1b]11;rgb:{colour}\x1b\\\x1b[?62;22c"));
    assert_eq!(told("0/0/0"), Some(TerminalBackground::Dark));
    assert_eq!(told("ffff/ffff/dddd"), Some(TerminalBackground::Light));
    for wrong in ["fffff/ffff/ffff", "ffffffff/ffffffff/ffffffff", "//", "0/0", "red/green/blue"] {
        assert_eq!(told(wrong), None, "{wrong}");
    }
    assert_eq!(background("\x1b[?62;22c"), None);
}
