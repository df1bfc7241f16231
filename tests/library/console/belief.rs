//! The belief panel, and the track of estimates behind it.

use crossterm::event::KeyCode;
use tomcom_core::base::time::SessionTime;
use tomcom_session::event::{Event, TrialEndReason};
use tomcom_session::history::belief_track;
use tomcom_session::settings::{ParticipantKind, WizardVisibility};

use super::{SIZES, Stage, panels};
use crate::check_snapshot;

#[test]
fn one_belief_is_looked_at_over_time_and_then_the_next() {
    let mut stage = Stage::sushi(ParticipantKind::Simulated);
    let all = panels(&stage);
    let aspects = stage.session.kitchen.aspects.len();
    let mut seen = Vec::new();
    for _ in 0..3 {
        stage.control('b');
        let focus = stage.model.belief_focus.expect("a belief is shown");
        seen.push(stage.session.kitchen.aspects[focus.index()].name.clone());
        assert_eq!(panels(&stage), ["belief", "recommendation"], "the belief alone, with the offer's line");
        stage.wait(1.0);
    }
    assert_eq!(seen, ["order_2", "recipe of tuna nigiri", "robot_hand"], "the longest first");
    stage.key(KeyCode::Esc);
    assert_eq!((panels(&stage), stage.model.belief_focus), (all, None), "esc leaves it");
    for _ in 0..3 {
        stage.wait(1.0);
        stage.control('b');
    }
    for size in SIZES {
        stage.shows(size, &["robot hand: thinks raw tuna 52 %, is cut tuna", "probability of the truth"]);
    }
    check_snapshot("console", "belief_over_time_120x40", stage.screen((120, 40)));
    for _ in 0..aspects - 2 {
        stage.wait(1.0);
        stage.control('b');
    }
    assert_eq!(stage.model.belief_focus, None, "after the last one none");
}

#[test]
fn the_belief_has_the_room_of_the_recommendation_where_there_is_none() {
    let mut stage = Stage::sushi(ParticipantKind::Simulated);
    stage.session.spec.console.visibility = WizardVisibility::Belief;
    let screen = stage.shows((120, 40), &["13 other beliefs are right", "order 2: probability of crab maki"]);
    assert!(!screen.contains("Signals by benefit"), "{screen}");
}

/// The chart is on the trial's clock: in a pause and after the trial nothing moves, and a long pause removes nothing.
#[test]
fn the_chart_of_a_belief_stands_while_the_trial_does() {
    let mut stage = Stage::sushi(ParticipantKind::Simulated);
    stage.control('b');
    // As a running session does: gaze goes on in a pause and after the trial, and old estimates are forgotten.
    let wait = |stage: &mut Stage, seconds: u32| {
        for _ in 0..5 * seconds {
            let now = stage.model.now.as_secs_f64() + 0.2;
            stage.look(now, 0.4, 0.35);
            stage.estimate(&[], true);
            stage.model.belief.forget(&stage.session, stage.model.now, belief_track::SHOWN_S);
        }
    };
    let charts = |stage: &Stage| {
        SIZES.map(|size| {
            let screen = stage.screen(size);
            let lines: Vec<&str> = screen.lines().skip_while(|line| !line.contains("Beliefs")).collect();
            lines[..lines.len() - 2].join("\n")
        })
    };
    stage.at(23.0, Event::TrialPaused);
    let paused = charts(&stage);
    wait(&mut stage, 300);
    assert_eq!(charts(&stage), paused, "in a pause");
    let moments = stage.model.belief.until(stage.model.now).len();
    assert!(moments < 20, "estimates that are the same are kept once: {moments}");
    stage.at(324.0, Event::TrialResumed);
    assert_eq!(charts(&stage), paused, "it goes on where it stood");
    wait(&mut stage, 10);
    assert_ne!(charts(&stage), paused, "in the running trial it moves");
    stage.at(335.0, Event::TrialEnded { reason: TrialEndReason::Time });
    let over = charts(&stage);
    wait(&mut stage, 120);
    assert_eq!(charts(&stage), over, "after the trial");
}

/// A long session needs no more memory than a short one, and still knows since when what is believed wrong.
#[test]
fn the_belief_forgets_what_no_panel_shows() {
    let mut stage = Stage::new("sushi", ParticipantKind::Simulated);
    stage.at(1.0, Event::TrialStarted);
    stage.estimate(&[("cooking_pot", "rice raw", 0.9)], false);
    let aspect = stage.session.kitchen.location_named("cooking_pot").expect("a pot").index();
    for second in 2..3600 {
        stage.model.now = SessionTime::from_secs_f64(f64::from(second));
        let p = if second % 2 == 0 { 0.8 } else { 0.9 };
        stage.estimate(&[("cooking_pot", "rice raw", p)], false);
        stage.model.belief.forget(&stage.session, stage.model.now, belief_track::SHOWN_S);
        let moments = stage.model.belief.until(stage.model.now);
        assert!(moments.len() <= 200, "{} moments", moments.len());
        assert!(second < 70 || moments[0].time.as_secs_f64() <= f64::from(second) - belief_track::SHOWN_S);
        assert_eq!(belief_track::wrong_since(moments, aspect), Some(SessionTime::from_secs_f64(1.0)));
    }
    stage.model.now = SessionTime::from_secs_f64(3700.0);
    stage.estimate(&[("cooking_pot", "empty", 0.9)], true);
    assert_eq!(belief_track::wrong_since(stage.model.belief.until(stage.model.now), aspect), None);
}
