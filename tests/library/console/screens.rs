//! Whole screens at each size: what a wizard has to recognise at a glance, with colours and without.

use crossterm::event::KeyCode;
use ratatui::Terminal;
use ratatui::backend::TestBackend;
use ratatui::buffer::Cell;
use ratatui::style::{Color, Modifier};
use tomcom::console::console_model::{Dialog, NoticeLevel, Playback, RecordingStatus};
use tomcom::console::key_action::KeyLayer;
use tomcom::console::panels::{Panel, screen};
use tomcom::console::text_columns::squeeze;
use tomcom::console::view::theme::{TerminalBackground, TextRole, Theme};
use tomcom::console::{ConsoleMessage, update, view};
use tomcom_core::robot::{AbortReason, IdleReason, SafetyMode};
use tomcom_session::replay::ReplayLandmark;

use super::{SIZES, Stage, panels};
use crate::support::*;

#[test]
fn a_running_session_at_the_least_size() {
    let stage = Stage::sushi(ParticipantKind::Simulated);
    check_snapshot("console", "running_80x24", stage.screen((80, 24)));
}

#[test]
fn the_participants_keys_stand_at_their_places() {
    let sushi = Stage::sushi(ParticipantKind::Keyboard);
    let burger = Stage::new("burger", ParticipantKind::Keyboard);
    for (name, mut stage, size) in [("sushi", sushi, (80, 24)), ("burger", burger, (120, 40))] {
        assert_eq!(stage.key(KeyCode::Tab), None);
        assert_eq!(stage.model.layer, KeyLayer::Participant);
        check_snapshot("console", format!("participant_{name}_{}x{}", size.0, size.1), stage.screen(size));
    }
}

#[test]
fn text_that_is_cut_ends_with_an_ellipsis() {
    let shown = [(18, "cooked rice + nori"), (17, "cooked rice +nori"), (15, "cooked rice +n…"), (3, "co…")];
    for (columns, words) in shown {
        assert_eq!(squeeze("cooked rice + nori", columns, "…"), words);
    }
}

#[test]
fn a_replay_has_one_clock() {
    let mut stage = Stage::sushi(ParticipantKind::Simulated);
    stage.replays(Playback { trial_length: at(90.0), event: 40, events: 90, ..Playback::new("P01-1".to_string()) });
    for size in SIZES {
        let screen = stage.screen(size);
        assert!(screen.contains(" 0:19 of 1:30"), "{screen}");
        assert!(screen.lines().next().is_some_and(|head| head.contains(" 0:19 ")), "{screen}");
    }
    stage.model.playback.as_mut().expect("a replay").outside_film = Some("after the film");
    stage.shows_everywhere(&[" after the film, 0:19 of 1:30"]);
    stage.model.playback.as_mut().expect("a replay").outside_film = None;
    let ready = Stage::new("sushi", ParticipantKind::Simulated);
    stage.session = ready.session;
    stage.shows((80, 24), &["before the trial, 0:00 of 1:30"]);
}

#[test]
fn the_events_fill_the_place_of_what_the_wizard_may_not_see() {
    let mut stage = Stage::sushi(ParticipantKind::Simulated);
    stage.session.spec.console.visibility = WizardVisibility::State;
    stage.model.see(stage.model.now, GazeSample::new(0.30, 0.4, 0.97));
    check_snapshot("console", "state_only_120x40", stage.screen((120, 40)));
}

#[test]
fn only_the_place_of_the_latest_gaze_sample_is_looked_at_now() {
    let mut stage = Stage::sushi(ParticipantKind::Simulated);
    stage.session.spec.console.visibility = WizardVisibility::State;
    let kitchen = stage.session.kitchen.clone();
    stage.model.alone = Some(Panel::GazeMap);
    // A quarter of a second at one place, then at the next one.
    for (index, location) in kitchen.locations.iter().take(4).enumerate() {
        let [x, y] = location.display.centre();
        stage.look(23.0 + 0.25 * index as f64, x, y);
    }
    let screen = stage.screen((120, 40));
    let map = screen.lines().skip_while(|line| !line.contains("Gaze map")).collect::<Vec<_>>().join("\n");
    assert_eq!(map.matches(" now").count(), 1, "{map}");
    for age in ["0.2s", "0.5s", "0.8s"] {
        assert!(map.contains(age), "{age}:\n{map}");
    }
    stage.wait(0.3);
    assert!(!stage.screen((120, 40)).contains(" now"), "a gap in the gaze: {}", stage.screen((120, 40)));
}

#[test]
fn a_row_of_the_events_says_what_a_press_took_put_or_made() {
    let mut stage = Stage::sushi(ParticipantKind::Simulated);
    stage.press(22.7, Agent::Human, "counter");
    stage.model.alone = Some(Panel::Events);
    stage.shows(
        (120, 40),
        &[
            "human     take rice ",
            "human     cooking pot: puts raw rice",
            "human     cook: makes cooked rice",
            "human     cooking pot: takes cooked rice",
            "human     assembly board: stacks cooked rice",
            "robot     cut: makes cut tuna",
        ],
    );
}

#[test]
fn the_head_of_the_smallest_screen_tells_the_state_of_the_robot() {
    let mut stage = Stage::sushi(ParticipantKind::Simulated);
    let head = |stage: &Stage| stage.screen((80, 24)).lines().next().unwrap_or_default().to_string();
    for step in 0..120 {
        stage.look(23.0 + f64::from(step) / 120.0, 0.4, 0.4);
    }
    assert!(head(&stage).contains("120 Hz robot ok"), "{}", head(&stage));
    stage.at(24.1, Event::RobotStopped);
    assert!(head(&stage).contains("EMERGENCY STOP"), "{}", head(&stage));
}

#[test]
fn help_and_the_question_before_leaving() {
    let mut stage = Stage::sushi(ParticipantKind::Simulated);
    stage.key(KeyCode::Char('?'));
    assert!(matches!(&stage.model.dialog, Some(Dialog::Help(_))));
    stage.model.size = (80, 24);
    stage.shows((80, 24), &["help page 1 of 5", "space stop the robot, at once", "5 look at this later"]);
    stage.model.size = (120, 40);
    let help = stage.screen((120, 40));
    assert!(!help.contains('…'), "a line is cut: {help}");
    check_snapshot("console", "help_120x40", help);
    stage.model.size = (200, 60);
    assert!(stage.screen((200, 60)).contains("shift-tab go to the previous panel"), "keys with long names are whole");
    stage.wait(1.0);
    stage.key(KeyCode::Down);
    assert_eq!(stage.model.dialog, None, "all of it is seen: every key closes");
    stage.control('c');
    let question = ["Quit tomcom?", "The trial is not over.", "and can go on.", "y or ^c yes   any other key no"];
    stage.shows((80, 24), &question);
}

#[test]
fn the_help_has_first_the_keys_that_do_something_now_and_keeps_its_order_while_it_is_read() {
    let mut stage = Stage::sushi(ParticipantKind::Simulated);
    stage.model.size = (200, 60);
    stage.key(KeyCode::Char('?'));
    // The column of the help below the heading of the keys without an effect.
    let heading = "Keys without an effect now";
    let without = |screen: &str| {
        // The line of key hints below the help changes with what can be done.
        let above_hints = screen.lines().count() - 1;
        let below: Vec<&str> = screen.lines().take(above_hints).skip_while(|line| !line.contains(heading)).collect();
        let (before, _) = below.first().and_then(|line| line.split_once(heading)).expect("such keys");
        let column = before.chars().count();
        let text = |line: &&str| line.chars().skip(column).take(39).collect::<String>();
        below.iter().map(text).collect::<Vec<String>>().join("\n")
    };
    let idle = without(&stage.screen((200, 60)));
    for text in ["resume the robot after a stop", "check gaze accuracy", "show the preflight checks"] {
        assert!(idle.contains(text), "{text:?} does nothing while the trial runs:\n{idle}");
    }
    for text in ["stop the robot, at once", "start, pause or resume the trial", "quit tomcom"] {
        assert!(!idle.contains(text), "{text:?} does something while the trial runs:\n{idle}");
    }
    stage.at(23.0, Event::RobotStopped);
    assert_eq!(without(&stage.screen((200, 60))), idle, "no line moves while it is read");
}

#[test]
fn what_a_wizard_has_to_recognise_is_told_at_each_size() {
    let sushi = || Stage::sushi(ParticipantKind::Simulated);
    let mut paused = sushi();
    paused.at(22.6, Event::TrialPaused);
    let mut stopped = sushi();
    stopped.at(22.6, Event::RobotStopped);
    let mut highlight = sushi();
    let signal = Signal::Highlight("cutting_board".to_string());
    highlight.at(22.6, Event::SignalShown { by: Sender::Wizard, signal, offer: None });
    let alarm = lost_recording();
    let mut ascii = sushi();
    ascii.model.theme = Theme { colour: false, unicode: false, ground: TerminalBackground::Light };
    for size in SIZES {
        paused.shows(size, &["‖ PAUSED", ". resume"]);
        stopped.shows(size, &["EMERGENCY STOP", "^r resume"]);
        highlight.shows(size, &["highlight cutting board", "█[c]"]);
        let over = "session over, the recording ends here: no space left on the device";
        alarm.shows(size, &["ENDED EARLY", "RECORDING LOST", "EMERGENCY STOP", over]);
        assert!(ascii.screen(size).is_ascii(), "{}", ascii.screen(size));
    }
    check_snapshot("console", "alarm_80x24", alarm.screen((80, 24)));
    check_snapshot("console", "ascii_120x40", ascii.screen((120, 40)));
}

/// A session that ended as its recording could not be written.
fn lost_recording() -> Stage {
    let mut stage = Stage::sushi(ParticipantKind::Simulated);
    stage.at(22.6, Event::RobotStopped);
    stage.at(22.6, Event::SessionEnded);
    stage.model.recording = RecordingStatus::Lost;
    stage.model.say(NoticeLevel::Alarm, "session over, the recording ends here: no space left on the device");
    stage
}

#[test]
fn a_wizard_who_may_see_the_state_alone_is_told_of_no_belief() {
    let mut stage = Stage::sushi(ParticipantKind::Simulated);
    stage.session.spec.console.visibility = WizardVisibility::State;
    for size in SIZES {
        let screen = stage.shows(size, &["tuna nigiri", "unseen", "recipe of order 1"]);
        for words in ["thinks", "Beliefs", "beliefs", "Signals by benefit"] {
            assert!(!screen.contains(words), "{words} at {size:?} in\n{screen}");
        }
    }
}

#[test]
fn a_stopped_robot_is_seen_at_every_size_with_room_for_the_words() {
    let mut stage = Stage::sushi(ParticipantKind::Simulated);
    stage.at(22.7, Event::RobotStopped);
    for columns in (1..220).step_by(7) {
        for rows in (1..70).step_by(3) {
            let screen = stage.screen((columns, rows));
            let has_room = columns >= 14 && rows >= 2;
            assert_eq!(screen.contains("EMERGENCY STOP"), has_room, "{columns}x{rows}:\n{screen}");
        }
    }
}

#[test]
fn a_question_is_seen_in_the_smallest_window() {
    let mut stage = Stage::sushi(ParticipantKind::Simulated);
    stage.control('c');
    stage.shows((50, 12), &["Quit tomcom? y or the same key again: yes"]);
}

#[test]
fn notes_of_one_moment_stand_beside_each_other_in_the_timeline() {
    let row = |stage: &Stage, size: (u16, u16)| {
        let screen = stage.screen(size);
        let row = screen.lines().find(|line| line.contains(" notes "));
        row.unwrap_or_else(|| panic!("no row at {size:?}:\n{screen}")).to_string()
    };
    let before = Stage::sushi(ParticipantKind::Simulated);
    let mut stage = Stage::sushi(ParticipantKind::Simulated);
    for note in ["wrong recipe", "overlooked a change", "slip"] {
        stage.at(22.6, Event::Marker { note: note.to_string(), observer: None });
    }
    for size in &SIZES[1..] {
        let size = *size;
        assert!(!row(&before, size).contains("123") && row(&stage, size).contains("123"), "{}", row(&stage, size));
    }
}

#[test]
fn the_screen_stands_while_the_trial_stands() {
    let mut stage = Stage::sushi(ParticipantKind::Simulated);
    stage.at(22.6, Event::TrialPaused);
    let below_head = |stage: &Stage, size| stage.screen(size).lines().skip(1).map(str::to_string).collect::<Vec<_>>();
    for size in SIZES {
        stage.model.now = at(30.0);
        let early = below_head(&stage, size);
        stage.model.now = at(330.0);
        assert_eq!(below_head(&stage, size), early);
    }
    let events = stage.screen((200, 60));
    assert!(events.contains("0:18 human     ✗ take salmon"), "events have the trial's clock:\n{events}");
}

#[test]
fn a_card_tells_how_to_start_and_another_what_came_of_the_trial() {
    let mut stage = Stage::new("sushi", ParticipantKind::Simulated);
    stage.wait(1.0);
    stage.shows_everywhere(&["Ready to start", ". start the trial"]);
    let mut stage = Stage::sushi(ParticipantKind::Simulated);
    stage.at(30.0, Event::TrialEnded { reason: TrialEndReason::Wizard });
    stage.shows_everywhere(&[
        "0 served",
        "9 by the human",
        "2 in 9 presses of the human (22 %)",
        "2 by the wizard",
        "0:27",
    ]);
    check_snapshot("console", "over_120x40", stage.screen((120, 40)));
}

#[test]
fn the_keys_of_a_replay_and_the_served_orders_fit_the_smallest_console() {
    let mut stage = Stage::sushi(ParticipantKind::Simulated);
    let name = "2026-03-14-P01-1".to_string();
    stage.replays(Playback { playing: true, event: 43210, events: 59289, ..Playback::new(name) });
    stage.shows_everywhere(&["esc leave", "? help", "left/right step", "m note", "0 served", "play 1x", " recording "]);
}

#[test]
fn the_focus_goes_through_the_panels_and_opens_each_at_full_size() {
    let mut stage = Stage::sushi(ParticipantKind::Simulated);
    stage.model.size = (120, 40);
    for replayed in [false, true] {
        if replayed {
            stage.replays(Playback { event: 40, events: 90, ..Playback::new("P01-1".to_string()) });
        }
        for title in ["Orders", "Sushi kitchen", "Beliefs", "Last presses", "Timeline"] {
            stage.wait(0.2);
            assert_eq!(stage.control('w'), None);
            stage.shows((120, 40), &[&format!("╭ ▸ {title} ─")]);
        }
        stage.wait(0.2);
        assert_eq!(stage.key(KeyCode::Esc), None);
    }
    let mut stage = Stage::sushi(ParticipantKind::Simulated);
    stage.model.size = (80, 24);
    let all = panels(&stage);
    let mut seen = Vec::new();
    stage.control('w');
    stage.wait(0.2);
    stage.control('o');
    for _ in 0..8 {
        stage.wait(0.2);
        let screen = stage.screen((80, 24));
        assert!(screen.contains("STOP ROBOT") && screen.contains("esc back"), "{screen}");
        seen.extend(panels(&stage));
        assert_eq!(stage.control('w'), None);
    }
    // The offer's line is always seen.
    seen.retain(|panel| panel != "recommendation");
    assert_eq!(seen, ["orders", "orders", "kitchen", "belief", "presses", "gaze_map", "events", "timeline"]);
    assert_eq!(panels(&stage), all, "after the last panel, all panels");
    stage.model.alone = Some(Panel::Timeline);
    let now = stage.screen((80, 24));
    stage.wait(0.2);
    stage.key(KeyCode::Left);
    assert_eq!(stage.model.timeline_back_s, 5);
    assert_ne!(stage.screen((80, 24)), now, "an earlier time is seen");
    stage.wait(0.2);
    stage.key(KeyCode::Esc);
    assert_eq!((panels(&stage), stage.model.timeline_back_s), (all, 0));
    stage.session.spec.console.visibility = WizardVisibility::State;
    stage.model.alone = Some(Panel::Presses);
    stage.wait(0.2);
    stage.control('w');
    assert_eq!(panels(&stage), ["gaze_map"], "what may not be seen is left out");
    stage.wait(0.2);
    stage.key(KeyCode::Up);
    update(&mut stage.model, &stage.session, ConsoleMessage::Wheel(40, 12, 1));
    assert_eq!(stage.model.events_back, 0, "what is not seen does not move");
}

/// What each order needs and what of it is there, ingredient against ingredient; why a press was an error. Nothing of this
/// is cut at any size. What may be cut at 80x24: the timeline, the lists of events and of signals, the gaze map, charts of
/// beliefs, and all but the last presses.
#[test]
fn orders_and_errors_are_explained_at_every_size() {
    let mut stage = Stage::sushi(ParticipantKind::Simulated);
    let needs = ["□ shaped rice", "□ nori", "✓ cut tuna", "✓ cooked rice", "✓ nori", "□ cut crab"];
    let why = "✗ take salmon: order 1 needs tuna";
    let believed = ["thinks cut salmon", "thinks no order"];
    stage.shows_everywhere(&needs);
    stage.shows_everywhere(&[why]);
    stage.shows_everywhere(&believed);
    SIZES.iter().for_each(|size| stage.hides(*size, &["0:18.0"]));
    stage.replays(Playback::new("P01-1".to_string()));
    stage.shows_everywhere(&needs);
    // Which of the events of one second came first.
    stage.shows_everywhere(&[why, "0:18.0 human"]);
    stage.session.spec.console.visibility = WizardVisibility::State;
    stage.shows_everywhere(&needs);
    stage.shows_everywhere(&[why]);
    for size in SIZES {
        stage.hides(size, &["thinks"]);
    }
    // What is in work has a sign of its own.
    let [hand, raw] = [
        stage.session.kitchen.hands[Agent::Robot.index()].0,
        stage.session.kitchen.content_named("tuna raw").expect("a content").0,
    ];
    stage.session.state.set_code(LocationId(hand), raw);
    stage.shows_everywhere(&["◐ cut tuna"]);
    for size in [(120, 40), (200, 60)] {
        stage.shows(size, &["◐ now raw tuna"]);
    }
    // Whoever plays the participant at this keyboard has to remember the recipes.
    let mut stage = Stage::sushi(ParticipantKind::Keyboard);
    stage.key(KeyCode::Tab);
    for size in SIZES {
        stage.hides(size, &["□", "needs tuna"]);
    }
}

#[test]
fn an_order_whose_items_are_there_says_which_step_is_left() {
    let mut stage = Stage::new("sushi", ParticipantKind::Simulated);
    stage.at(1.0, Event::TrialStarted);
    for (order, dish) in [("order_1", "salmon nigiri"), ("order_2", "salmon nigiri")] {
        stage.at(1.0, Event::OrderShown { order: order.to_string(), dish: dish.to_string() });
    }
    let kitchen = stage.session.kitchen.clone();
    let holds = |stage: &mut Stage, places: &[(&str, &str)]| {
        stage.session.state = stage.session.kitchen.empty_state();
        for order in &kitchen.orders {
            stage
                .session
                .state
                .set_order(*order, OrderContent::Dish(kitchen.dish_named("salmon nigiri").expect("a dish")));
        }
        for (place, content) in places {
            let place = kitchen.location_named(place).expect("a place");
            stage.session.state.set_code(place, kitchen.content_named(content).expect("a content").0);
        }
    };
    let parts = [("assembly_board", "nori"), ("robot_hand", "rice shaped"), ("cutting_board", "salmon cut")];
    for (places, short, long) in [
        (&parts[..], "□ stack", "□ stack shaped rice + cut salmon"),
        (&[("assembly_board", "salmon nigiri")], "□ plate", "□ plate from assembly board"),
        (&[("plate", "salmon nigiri")], "□ serve", "□ serve"),
    ] {
        holds(&mut stage, places);
        stage.shows_everywhere(&[short]);
        for size in [(120, 40), (200, 60)] {
            stage.shows(size, &[long, "✓ shaped rice  ✓ nori  ✓ cut salmon"]);
        }
        stage.hides((120, 40), &["fits no order"]);
    }
    // A dish that nobody ordered keeps others from being served.
    holds(&mut stage, &[("plate", "tuna maki")]);
    stage.shows_everywhere(&["fits no order"]);
    // Whoever plays the participant at this keyboard has to know it.
    stage.model.layer = KeyLayer::Participant;
    stage.hides((120, 40), &["fits no order"]);
}

#[test]
fn the_robots_panel_says_what_is_so() {
    let mut stage = Stage::sushi(ParticipantKind::Simulated);
    stage.session.spec.robot.arm = ArmKind::Physics;
    stage.shows_everywhere(&["▸ counter"]);
    stage.shows((120, 40), &["▸robot comes", "presses made"]);
    // The hand is empty: there is nothing to put there any more.
    let hand = stage.session.kitchen.hands[Agent::Robot.index()];
    let held = stage.session.state;
    stage.session.state.set_code(hand, 0);
    stage.shows((120, 40), &["▸ counter: of no use now"]);
    stage.session.state = held;
    // What it waits for is named whole.
    stage.at(23.0, Event::RobotAborts { button: "counter".to_string(), reason: AbortReason::NoLongerUseful });
    let waits_for = ["take rice", "cutting_board"].map(str::to_string).to_vec();
    stage.at(23.0, Event::RobotIdles { reason: IdleReason::HumanTurn, waits_for });
    stage.shows((120, 40), &["waits: take rice or cutting board"]);
    stage.shows((200, 60), &["human's turn: take rice or cutting board"]);
    stage.shows((80, 24), &["waits: take rice or cu"]);
    // The reason of a stop stands there, whatever is said meanwhile.
    let until_ns = at(26.0);
    stage.at(23.5, Event::RobotIntends { button: "counter".to_string(), until_ns, initiative: true });
    stage.shows((120, 40), &["▸ counter alone"]);
    stage.press(23.6, Agent::Human, "trash");
    stage.hides((120, 40), &["alone"]);
    stage.at(24.0, Event::RobotSafety { mode: SafetyMode::ProtectiveStop, force_n: Some(98.0), joint: None });
    stage.model.say(NoticeLevel::Done, "signal sent");
    stage.shows((120, 40), &["contact with a person, 98 N", "^r resume", "signal sent"]);
    stage.shows((80, 24), &["contact, 98 N  ^r resume"]);
}

#[test]
fn a_loss_of_gaze_has_the_same_words_everywhere() {
    let mut stage = Stage::sushi(ParticipantKind::Simulated);
    stage.session.spec.participant.gaze = GazeSource::Json;
    stage.at(22.6, Event::Gaze(GazeSample::new(0.36, 0.35, 0.97)));
    for step in 1..=40 {
        stage.at(22.6 + 0.1 * f64::from(step), Event::Gaze(GazeSample::new(0.36, 0.35, 0.2)));
    }
    let lost = |stage: &Stage, capitals: &str, words: &str, why: &str| {
        stage.shows((80, 24), &[capitals, &format!("{words}: {why}; last: ")]);
        for size in [(120, 40), (200, 60)] {
            let screen = stage.shows(size, &[capitals, why]);
            assert_eq!(screen.matches(words).count(), 2, "gaze and beliefs say {words:?}:\n{screen}");
        }
    };
    lost(&stage, "GAZE UNUSABLE 4 s", "gaze unusable for 4 s", "confidence 0.20 < 0.6");
    stage.shows((80, 24), &["◂?"]);
    // The time goes on from the last usable sample, also in a pause.
    stage.wait(2.0);
    lost(&stage, "NO GAZE 6 s", "no gaze for 6 s", "no samples arrive");
    stage.model.gaze_closed = Some(stage.model.now);
    lost(&stage, "NO GAZE 6 s", "no gaze for 6 s", "its sender closed the connection");
    stage.at(29.6, Event::TrialPaused);
    lost(&stage, "NO GAZE 7 s", "no gaze for 7 s", "its sender closed the connection");
    // The timeline keeps the loss, two columns a second; in the first and last are the loss before and the pause.
    for size in [(120, 40), (200, 60)] {
        stage.shows(size, &[&format!("!{}", "─".repeat(12))]);
    }
    stage.at(29.6, Event::TrialResumed);
    stage.at(29.6, Event::TrialEnded { reason: TrialEndReason::Wizard });
    stage.shows_everywhere(&["gaze idle"]);
    stage.hides((120, 40), &[", now", "no gaze"]);
}

#[test]
fn the_head_never_loses_recording_gaze_and_robot() {
    let mut stage = Stage::sushi(ParticipantKind::Simulated);
    stage.session.spec.robot.arm = ArmKind::Physics;
    let safety = |mode| Event::RobotSafety { mode, force_n: None, joint: None };
    let robot = [
        (safety(SafetyMode::Normal), "robot ok"),
        (safety(SafetyMode::Reduced), "robot slow"),
        (safety(SafetyMode::Safeguard), "SAFEGUARD STOP"),
        (safety(SafetyMode::ProtectiveStop), "PROTECTIVE STOP"),
    ];
    let check = |stage: &Stage, words: &str| {
        for columns in (72..200).step_by(4) {
            let screen = stage.screen((columns, 40));
            let head = screen.lines().next().unwrap_or_default();
            for words in ["● rec", "NO GAZE", words] {
                assert!(head.contains(words), "{words} at {columns} columns: {head}");
            }
        }
    };
    for (event, words) in robot {
        stage.at(24.0, event);
        check(&stage, words);
        stage.session.phase = TrialPhase::Over(TrialEndReason::Wizard);
        // An arm that rests is slow no more, and no hand is in its way.
        let words = if ["robot slow", "SAFEGUARD STOP"].contains(&words) { "robot ok" } else { words };
        for columns in [80, 120] {
            let screen = stage.screen((columns, 40));
            assert!(screen.lines().next().is_some_and(|head| head.contains(words)), "{screen}");
        }
        stage.session.phase = TrialPhase::Running;
    }
}

/// Condition, clock and presses have one place each, whatever gaze and robot do and however long the trial is under way.
#[test]
fn the_head_keeps_condition_and_trial_in_their_places() {
    let mut stage = Stage::sushi(ParticipantKind::Simulated);
    stage.session.spec.trial.condition = Condition::None;
    stage.session.spec.robot.arm = ArmKind::Physics;
    stage.wait(1.0);
    let head = |stage: &Stage, columns| stage.screen((columns, 40)).lines().next().unwrap_or_default().to_string();
    let begins = |stage: &Stage, columns| {
        let head = head(stage, columns);
        ["P01", "unassisted", "/304", "● rec"]
            .map(|words| head.find(words).unwrap_or_else(|| panic!("{words}: {head}")))
    };
    let first = [80, 120, 160].map(|columns| begins(&stage, columns));
    for step in 0..120 {
        stage.look(24.0 + f64::from(step) / 120.0, 0.4, 0.4);
    }
    stage.at(25.1, Event::RobotSafety { mode: SafetyMode::Reduced, force_n: None, joint: None });
    assert_eq!([80, 120, 160].map(|columns| begins(&stage, columns)), first, "{}", head(&stage, 80));
    stage.at(400.0, Event::TrialPaused);
    stage.model.now = at(500.0);
    assert_eq!([80, 120, 160].map(|columns| begins(&stage, columns)[1]), first.map(|places| places[1]));
    stage.session.excluded = Some("phone".to_string());
    assert!(
        head(&stage, 120).contains("unassisted") && head(&stage, 120).contains("EXCLUDED"),
        "{}",
        head(&stage, 120)
    );
}

#[test]
fn what_the_wizard_sees_is_told_by_size_visibility_and_dialog() {
    let mut stage = Stage::sushi(ParticipantKind::Simulated);
    let mut rooms = Vec::new();
    for size in [(50, 12), (80, 24), (120, 40), (200, 60)] {
        stage.model.size = size;
        let seen = screen(&stage.session, &stage.model);
        assert_eq!(seen.panels.iter().any(|panel| panel == "belief"), seen.room != "too_small", "{seen:?}");
        rooms.push(seen.room);
    }
    assert_eq!(rooms, ["too_small", "small", "medium", "large"]);
    stage.session.spec.console.visibility = WizardVisibility::State;
    stage.control('u');
    let seen = screen(&stage.session, &stage.model);
    assert!(!seen.panels.iter().any(|panel| panel == "belief" || panel == "recommendation"), "{seen:?}");
    assert_eq!((seen.visibility, seen.dialog.as_deref()), (WizardVisibility::State, Some("correct_place")));
}

/// What the cells look like, a line for each row, a letter for each style: without colour nothing may rest on colour.
#[test]
fn without_colour_every_meaning_has_a_sign_or_a_weight() {
    let mut stage = Stage::sushi(ParticipantKind::Simulated);
    stage.model.theme = Theme { colour: false, unicode: true, ground: TerminalBackground::Dark };
    for (columns, rows) in SIZES {
        let mut terminal = Terminal::new(TestBackend::new(columns, rows)).expect("a test terminal");
        terminal.draw(|frame| view(&stage.session, &stage.model, frame)).expect("drawn");
        let buffer = terminal.backend().buffer();
        assert!(buffer.content.iter().all(|cell| cell.fg == Color::Reset && cell.bg == Color::Reset));
        let weights = |cell: &Cell| match cell.modifier {
            m if m.contains(Modifier::REVERSED) => '#',
            m if m.contains(Modifier::BOLD) => '*',
            m if m.contains(Modifier::DIM) => '-',
            _ if cell.symbol() == " " => ' ',
            _ => '.',
        };
        let lines: Vec<String> =
            buffer.content.chunks(usize::from(columns)).map(|row| row.iter().map(weights).collect()).collect();
        if (columns, rows) == SIZES[0] {
            check_snapshot("console", "no_color_80x24", lines.join("\n"));
        }
    }
}

/// The relative luminance of a colour (WCAG 2.1).
fn luminance(rgb: [u8; 3]) -> f64 {
    let linear = rgb.map(|value| match f64::from(value) / 255.0 {
        low if low <= 0.04045 => low / 12.92,
        high => ((high + 0.055) / 1.055).powf(2.4),
    });
    0.2126 * linear[0] + 0.7152 * linear[1] + 0.0722 * linear[2]
}

/// The contrast ratio of two colours, 1 to 21 (WCAG 2.1).
fn contrast(a: [u8; 3], b: [u8; 3]) -> f64 {
    let (a, b) = (luminance(a), luminance(b));
    (a.max(b) + 0.05) / (a.min(b) + 0.05)
}

/// A colour of the cube or the greys of xterm's 256, which are the same in every terminal.
fn xterm(index: u8) -> [u8; 3] {
    match index {
        0..=15 => panic!("{index} is one of the colours that everybody sets otherwise"),
        16..=231 => [36, 6, 1].map(|step| [0, 95, 135, 175, 215, 255][usize::from((index - 16) / step % 6)]),
        grey => [8 + 10 * (grey - 232); 3],
    }
}

#[test]
fn colours_keep_their_contrast_on_dark_and_light_terminals() {
    use TextRole::{Alarm, FalseBelief, Gaze, Human, Quiet, Robot, Signal};
    // Black, and the backgrounds of VS Code, One Dark and Solarized; white, and those of Solarized and GitHub's code.
    let dark = [[0, 0, 0], [0x1e, 0x1e, 0x1e], [0x28, 0x2c, 0x34], [0x00, 0x2b, 0x36]];
    let light = [[255, 255, 255], [0xfd, 0xf6, 0xe3], [0xf6, 0xf8, 0xfa]];
    for (ground, backgrounds) in [(TerminalBackground::Dark, &dark[..]), (TerminalBackground::Light, &light[..])] {
        let colour = |role| xterm(Theme::colour(ground, role).expect("a colour of its own"));
        for background in backgrounds {
            for role in [Quiet, Human, Robot, Signal, Gaze, Alarm, FalseBelief] {
                let ratio = contrast(colour(role), *background);
                assert!(ratio >= 4.5, "{role:?} on {background:02x?}: {ratio:.2}");
            }
            let ratio = contrast(colour(TextRole::Frame), *background);
            assert!(
                (1.5..4.5).contains(&ratio),
                "lines are there, and quieter than text, on {background:02x?}: {ratio:.2}"
            );
        }
        for other in [Quiet, Human, Robot, Signal, Gaze, Alarm] {
            assert_ne!(colour(other), colour(FalseBelief), "one colour is that of false beliefs alone");
        }
    }
}

#[test]
fn a_replay_says_at_which_landmark_it_stands_for_as_long_as_it_stands_there() {
    let mut stage = Stage::sushi(ParticipantKind::Simulated);
    let words = "error 1 of 17: take salmon: cause (simulated participant): false belief about recipe of crab maki (order 2); \
                 order 1 needs tuna; costs 2 presses";
    let landmark = Some((10, Some(ReplayLandmark::Error), words.to_string()));
    stage.replays(Playback { event: 10, events: 90, landmark, ..Playback::new("S001".to_string()) });
    stage.model.clock = at(3600.0);
    stage.shows_everywhere(&["error 1 of 17: take salmon", "costs 2 presses"]);
    // The text tells the beliefs before the press.
    stage.shows((120, 40), &["after the press"]);
    stage.model.say(NoticeLevel::Refused, "the recording has no later error");
    stage.shows_everywhere(&["the recording has no later error"]);
    stage.hides(SIZES[0], &["error 1 of 17"]);
    stage.model.clock = at(7200.0);
    stage.shows_everywhere(&["error 1 of 17: take salmon"]);
    stage.model.playback.as_mut().expect("a replay").event = 11;
    SIZES.iter().for_each(|size| stage.hides(*size, &["error 1 of 17"]));
    // What the lines of a small terminal cut, a dialog shows whole, for as long as it is read.
    let playback = stage.model.playback.as_mut().expect("a replay");
    let believed = "believed wrong before it, by the participant: recipe of crab maki (order 2): thinks raw crab, needs cut crab \
                    since 0:12";
    playback.landmark = Some((11, Some(ReplayLandmark::Error), format!("{words}; {believed}; the end")));
    stage.model.size = (80, 24);
    stage.shows((80, 24), &["error 1 of 17: take salmon", "^o shows all"]);
    stage.hides((80, 24), &["the end"]);
    stage.control('o');
    stage.model.clock = at(10800.0);
    stage.shows((80, 24), &["error 1 of 17: take salmon", "since 0:12", "the end", "any key closes"]);
    stage.key(KeyCode::Esc);
    assert_eq!(stage.model.dialog, None);
}
