//! Drop-outs of the tracker in whole simulated sessions: in them the estimate is worse than with full gaze and hardly worse than without
//! any, and it does not jump where they begin or end.

use tomcom_core::mind::filter::BeliefFilter;
use tomcom_session::tracker::GazeGapSpec;

use crate::support::*;

/// Seed and number of the sessions.
const SEED: u64 = 61;
const TRIALS: u64 = 6;
/// Without samples for so long, gaze is not known any more, in seconds: longer than a blink.
const GONE_S: f64 = 0.5;
/// What rounding, and forgetting within a second, may add to a change of an expected probability.
const SLACK: f64 = 1e-3;

/// What the tracker does.
#[derive(Clone, Copy, PartialEq)]
enum Tracker {
    Full,
    /// Drop-outs of 1 to 60 s in about half of the time.
    DropsOut,
    Missing,
}

fn settings(files: &SessionSetup, tracker: Tracker) -> SessionSpec {
    let mut spec = files.spec.clone();
    (spec.seed, spec.trial.condition, spec.robot.arm) = (SEED, Condition::None, ArmKind::Timed);
    spec.assistant.shadow = tomcom_core::communication::settings::ShadowMode::Off;
    match tracker {
        Tracker::Full => {}
        Tracker::DropsOut => {
            spec.tracker.gaps = Some(GazeGapSpec { every_s: 14.0, shortest_s: 1.0, longest_s: 60.0 });
        }
        Tracker::Missing => spec.participant.gaze = GazeSource::None,
    }
    spec
}

/// Squared error of the estimate about a location before a press of the human, and whether gaze was gone at that time.
struct Judged {
    error: f64,
    gone: bool,
}

/// Plays a session; at each end of a drop-out `edge` gets the filter from before, the engine after the first sample, and its time.
fn play(
    files: &SessionSetup,
    kitchen: &Arc<Kitchen>,
    trial: u64,
    tracker: Tracker,
    mut edge: impl FnMut(Edge, &BeliefFilter, &SessionEngine),
) -> Vec<Judged> {
    let mut engine =
        SessionEngine::new(kitchen.clone(), settings(files, tracker), trial, CostToGo::new(kitchen.clone()));
    let _ = engine.input(SessionTime::ZERO, Event::TrialStarted);
    let (mut judged, mut held): (Vec<Judged>, Vec<bool>) = (Vec::new(), Vec::new());
    let mut seen = SessionTime::ZERO;
    // The filter in a drop-out, after the last event.
    let mut inside: Option<BeliefFilter> = None;
    while engine.session().phase == TrialPhase::Running {
        let now = engine.next_due().expect("a running session has a next event");
        let is_gone = now.secs_since(seen) > GONE_S;
        if is_gone && inside.is_none() {
            let filter = engine.follower().filter.clone();
            edge(Edge::Begin { last: seen }, &filter, &engine);
            inside = Some(filter);
        }
        let events: Vec<TimestampedEvent> = engine.fire();
        for stamped in &events {
            match &stamped.event {
                Event::Gaze(_) => {
                    if let Some(filter) = inside.take() {
                        edge(Edge::End { first: stamped.time }, &filter, &engine);
                    }
                    seen = stamped.time;
                }
                Event::ParticipantBelieves(witness) => {
                    held = witness.aspects.iter().map(|aspect| aspect.p_truth >= 0.5).collect();
                }
                Event::BeliefEstimated(estimate) => {
                    let of_locations = kitchen.aspects.iter().zip(&estimate.aspects).zip(&held);
                    let of_locations =
                        of_locations.filter(|((aspect, _), _)| matches!(aspect.kind, AspectKind::Location(_)));
                    judged.extend(of_locations.map(|((_, estimated), held)| {
                        let error = f64::from(u8::from(*held)) - estimated.p_truth;
                        Judged { error: error * error, gone: is_gone }
                    }));
                }
                _ => {}
            }
        }
        if inside.is_some() && !events.is_empty() {
            inside = Some(engine.follower().filter.clone());
        }
    }
    judged
}

/// An end of a drop-out.
enum Edge {
    /// The last sample before it came at this time.
    Begin { last: SessionTime },
    /// The first sample after it came at this time.
    End { first: SessionTime },
}

/// Expected probability of the truth about each location, as far as the filter knows at this time.
fn known(filter: &BeliefFilter, kitchen: &Arc<Kitchen>, state: State, at: SessionTime) -> Vec<f64> {
    let mut filter = filter.clone();
    filter.advance(at, &mut CostToGo::new(kitchen.clone()));
    let locations = kitchen.aspects.iter().enumerate().filter(|(_, one)| matches!(one.kind, AspectKind::Location(_)));
    locations.map(|(index, _)| filter.belief().p_truth(kitchen, state, AspectId(index as u8))).collect()
}

fn largest_change(before: &[f64], after: &[f64]) -> f64 {
    before.iter().zip(after).map(|(before, after)| (before - after).abs()).fold(0.0, f64::max)
}

fn later(time: SessionTime, seconds: f64) -> SessionTime {
    time + at(seconds)
}

#[test]
fn the_estimate_does_not_jump_where_a_drop_out_begins_or_ends() {
    let files = session_file("default");
    let kitchen = Arc::new(files.kitchen.kitchen.clone());
    let (human, looking) = (&files.spec.human, &files.spec.human.looking);
    // What plausible looks, and what a look that rests on a place, may at most tell within a time.
    let plausible = |seconds: f64| 1.0 - (-looking.looks_hz.max(looking.other_looks_hz) * seconds).exp() + SLACK;
    let seen = |seconds: f64| 1.0 - (-human.perception.reading_rate_hz * seconds).exp() + SLACK;
    let (mut begins, mut ends, mut moved) = (0, 0, 0.0_f64);
    for trial in 0..TRIALS {
        play(&files, &kitchen, trial, Tracker::DropsOut, |edge, filter, engine| {
            let state = engine.session().state;
            match edge {
                Edge::Begin { last } => {
                    begins += 1;
                    let at = |seconds: f64| known(filter, &kitchen, state, later(last, seconds));
                    let before = at(0.0);
                    // A blink right before may have used up the time that counts as one.
                    for seconds in [0.01, 0.1, looking.blink_s, 1.0] {
                        let (change, most) = (largest_change(&before, &at(seconds)), plausible(seconds));
                        assert!(change <= most, "trial {trial}, {last:?}: {change} of at most {most} in {seconds} s");
                        moved = moved.max(change);
                    }
                }
                Edge::End { first } => {
                    ends += 1;
                    // The first sample stands for the time of one sample before it.
                    let sample_s = human.perception.max_sample_s;
                    let before = known(filter, &kitchen, state, first - at(sample_s));
                    let after = known(&engine.follower().filter, &kitchen, state, first);
                    for (index, (before, after)) in before.iter().zip(&after).enumerate() {
                        // The area around the fixation may reach places beside the one that is looked at.
                        let most = seen(sample_s);
                        let change = (before - after).abs();
                        assert!(
                            change <= most,
                            "trial {trial}, {first:?}, location {index}: {change} of at most {most}"
                        );
                    }
                }
            }
        });
    }
    assert!(begins >= 60 && ends >= 60, "{begins} drop-outs begin and {ends} end");
    assert!(moved > 0.1, "in the first second without gaze something is learned: {moved}");
}

#[test]
fn in_drop_outs_the_estimate_is_worse_than_with_full_gaze_and_hardly_worse_than_with_none() {
    let files = session_file("default");
    let kitchen = Arc::new(files.kitchen.kitchen.clone());
    let mut sums = [0.0; 3];
    let (mut gone, mut all) = (0, 0);
    for trial in 0..TRIALS {
        let [full, gaps, none] = [Tracker::Full, Tracker::DropsOut, Tracker::Missing]
            .map(|tracker| play(&files, &kitchen, trial, tracker, |_, _, _| ()));
        assert!(full.len() == gaps.len() && gaps.len() == none.len(), "the tracker changes nothing in the session");
        all += gaps.len();
        for ((full, gaps), none) in full.iter().zip(&gaps).zip(&none).filter(|((_, gaps), _)| gaps.gone) {
            gone += 1;
            [full.error, gaps.error, none.error].iter().zip(&mut sums).for_each(|(error, sum)| *sum += error);
        }
    }
    let share = f64::from(gone) / all as f64;
    assert!((0.3..0.7).contains(&share), "gaze is gone at {share} of the presses");
    let [full, gaps, none] = sums.map(|sum| sum / f64::from(gone));
    // What was seen before a drop-out is of no use in it with the model `plain`: these people differ from it.
    assert!(
        full < 0.8 * gaps && gaps < 1.1 * none,
        "{full} with full gaze, {gaps} with drop-outs, {none} without gaze"
    );
}
