//! Replays that are moved in time: forward, back, and to landmarks.

use std::cell::Cell;

use tomcom::console::console_model::ReplayAction;
use tomcom::run::seekable_replay::SeekableReplay;
use tomcom_session::TimelineEvent;
use tomcom_session::files::file_error::FileResult;
use tomcom_session::history::belief_track::BeliefHistory;
use tomcom_session::replay::ReplayLandmark;

use super::{SESSIONS, simulated};
use crate::support::*;

#[test]
fn a_recording_can_be_wound_forward_and_back() {
    for name in SESSIONS {
        let out = simulated(name, ArmKind::Physics, &format!("film-{name}"), 1, 3);
        let recording = only_recording(&out);
        let mut film = SeekableReplay::open(&recording).expect("it opens");
        let (length, events) = film.length();
        let mut straight = SeekableReplay::open(&recording).expect("it opens");
        let mut random = stream(5, "places of a film", 0);
        for _ in 0..20 {
            let position = random.random_range(0..=events);
            film.wind(position);
            straight = match straight.position <= position {
                true => straight,
                false => SeekableReplay::open(&recording).expect("it opens"),
            };
            while straight.position < position {
                straight.forward().expect("an event");
            }
            assert_eq!(film.position, position);
            assert_eq!(film.session.state, straight.session.state, "{name}: at {position} of {events}");
            assert_eq!(film.session.timeline, straight.session.timeline);
            assert_eq!(film.session.gaze, straight.session.gaze);
        }
        film.wind(0);
        let mut steps = 0;
        while film.position < events {
            film.wind(film.next_step());
            steps += 1;
        }
        assert_eq!(film.time(), length);
        for _ in 0..steps {
            film.wind(film.last_step());
        }
        assert_eq!(film.position, 0, "as many steps back as forward");
    }
}

/// A press and what the participant believed before it have the same time: time alone does not tell the estimate.
#[test]
fn a_position_shows_the_same_estimate_by_whatever_way_one_comes_there() {
    let out = simulated("default.toml", ArmKind::Timed, "ways", 1, 11);
    let recording = only_recording(&out);
    let mut film = SeekableReplay::open(&recording).expect("a recording");
    let error = film.landmark(ReplayLandmark::Error, true, false).expect("an error");
    film.wind(error);
    let (time, presses) = (film.time(), film.session.all_presses());
    let mut shown = BeliefHistory::default();
    film.show_beliefs(&mut shown);
    let after = shown.until(time).to_vec();
    let mut press = error;
    while film.session.all_presses() == presses {
        press = film.position;
        film.wind(film.last_step());
        // It is told where the screen has it: before the press.
        let named = film.named_event().expect("an event");
        assert!(!named.starts_with("estimated before"), "{named}");
    }
    assert_eq!(film.time(), time, "before the press, at its time");
    let before = film.position;
    assert_eq!(film.landmark(ReplayLandmark::Error, true, false), Some(error), "the error is ahead");
    assert_eq!(film.landmark(ReplayLandmark::Error, false, true), None, "it is the first one");
    let mut read = SeekableReplay::begin(&recording).expect("a recording");
    let left = Cell::new(before);
    read.read_while(|| left.replace(left.get().saturating_sub(1)) > 0).expect("events");
    assert_eq!(read.read_events(), before);
    let estimated = read.beliefs.until(time);
    assert_ne!(after, estimated, "the press is evidence");
    for way in [before, 0, error, film.length().1] {
        film.wind(way);
        film.show_beliefs(&mut shown);
        film.wind(before);
        film.show_beliefs(&mut shown);
        assert_eq!(shown.until(time), estimated, "by way of {way}");
    }
    film.wind(press);
    let named = film.named_event().expect("a press");
    assert!(named.starts_with("human presses ") && named.contains("(error, costs "), "{named}");
    film.wind(0);
    assert_eq!(film.named_event(), None);
    let mut blind = film.blinded();
    blind.wind(press);
    assert_eq!(blind.named_event(), None, "raters read no cause");
}

/// A console begins before the recording is read: the end is known at once, and what is read later is the same.
#[test]
fn a_recording_that_is_read_bit_by_bit_is_the_same_as_one_that_is_read_at_once() {
    let out = simulated("default.toml", ArmKind::Timed, "bit-by-bit", 1, 9811);
    let recording = only_recording(&out);
    let mut whole = SeekableReplay::open(&recording).expect("a recording");
    let mut slow = SeekableReplay::begin(&recording).expect("a recording");
    assert!(whole.is_read() && !slow.is_read() && !slow.is_cut());
    assert_eq!((slow.length(), slow.read_to()), (whole.length(), SessionTime::ZERO));
    let mut slices = 0;
    while !slow.is_read() {
        let left = Cell::new(1000);
        slow.read_while(|| left.replace(left.get() - 1) > 0).expect("events");
        slices += 1;
        // As somebody who follows a running session sees it: always its latest state.
        let (read, read_to) = (slow.read_events(), slow.read_to());
        assert_eq!(slow.until(read_to), read, "after {slices} slices");
        slow.wind(read);
        assert_eq!(slow.time(), read_to);
    }
    assert!(slices > 4, "{slices}");
    assert_eq!((slow.length(), slow.is_cut(), &slow.errors), (whole.length(), whole.is_cut(), &whole.errors));
    let (_, events) = whole.length();
    for position in [events, events / 3, events / 2, 1] {
        whole.wind(position);
        slow.wind(position);
        assert_eq!(whole.session, slow.session, "at {position}");
    }
}

/// What is before the trial is read, but a console begins at the trial's start.
#[test]
fn a_replay_knows_where_the_trial_begins_and_how_long_it_is() {
    let recording = Path::new("tests/golden/format-3-hand.jsonl");
    let mut whole = SeekableReplay::open(recording).expect("it opens");
    let mut slow = SeekableReplay::begin(recording).expect("it opens");
    slow.read_to_trial().expect("events");
    assert!(!slow.is_read(), "the rest is read later");
    let start = slow.trial_start();
    slow.wind(start);
    assert_eq!((slow.session.phase, slow.time()), (TrialPhase::Running, at(0.5)));
    assert!(slow.trial_length() > SessionTime::ZERO);
    whole.wind(whole.length().1);
    assert_eq!(whole.trial_length(), whole.session.trial_clock(whole.time()));
}

#[test]
fn a_blinded_replay_shows_no_signal_and_the_same_kitchen() {
    let recording = Path::new("tests/golden/format-3-hand.jsonl");
    let mut open = SeekableReplay::open(recording).expect("it opens");
    let mut blind = SeekableReplay::open(recording).expect("it opens").blinded();
    let is_signal = |film: &SeekableReplay| {
        let signals = film.session.timeline.iter();
        signals
            .filter(|entry| {
                matches!(entry.what, TimelineEvent::Noted(Event::SignalShown { .. } | Event::SignalEnded { .. }))
            })
            .count()
    };
    let (_, events) = open.length();
    for position in 0..=events {
        open.wind(position);
        blind.wind(position);
        assert_eq!(open.session.state, blind.session.state, "at {position}");
        assert!(blind.session.shown.is_none() && blind.session.advice.is_none() && is_signal(&blind) == 0);
    }
    assert!(is_signal(&open) > 0, "there are signals to be hidden");
    assert_eq!(open.errors, blind.errors);
    assert_eq!(blind.landmark(ReplayLandmark::Signal, false, false), None);
    assert!(blind.told_events().is_empty() && !open.told_events().is_empty());
    let signal = open.landmark(ReplayLandmark::Signal, false, false).expect("a signal");
    open.wind(signal);
    let named = open.named(ReplayLandmark::Signal).expect("a signal");
    let number = open.landmarks(ReplayLandmark::Signal).len();
    assert!(named.starts_with(&format!("signal {number} of {number}: ")), "{named}");
    assert!(named.contains(", by the wizard; ") && named.contains("looked at"), "{named}");
    // Steps do not stop where something is hidden.
    let steps = |film: &mut SeekableReplay| {
        film.wind(0);
        std::iter::from_fn(|| {
            let next = film.next_step();
            (film.position < events).then(|| film.wind(next))
        })
        .count()
    };
    assert!(steps(&mut blind) < steps(&mut open));
    // Advice of nothing is told, too.
    open.wind(0);
    while open.position < events {
        open.wind(open.next_step());
        assert_ne!(open.named_event().as_deref(), Some("advised"), "at {}", open.position);
    }
}

#[test]
fn a_replay_goes_from_one_error_signal_or_false_belief_to_the_next_and_back() {
    let out = simulated("default.toml", ArmKind::Timed, "landmarks", 1, 4);
    let recording = only_recording(&out);
    let mut film = SeekableReplay::open(&recording).expect("a recording");
    let mut errors: Vec<SessionTime> = film.errors.iter().map(|error| error.time).collect();
    errors.dedup();
    assert!(errors.len() > 2, "{errors:?}");
    let (mut visited, mut believed) = (Vec::new(), 0);
    while let Some(position) = film.landmark(ReplayLandmark::Error, true, false) {
        film.wind(position);
        visited.push(film.time());
        let named = film.named(ReplayLandmark::Error).expect("an error");
        assert!(named.starts_with(&format!("error {} of {}: ", visited.len(), errors.len())), "{named}");
        assert!(named.split(": ").count() > 2, "press and reason: {named}");
        assert!(named.contains("costs "), "the cost, and the cause where it is known: {named}");
        believed += usize::from(named.contains("; believed wrong before it, by the participant: "));
    }
    assert!(believed > 0, "what the participant itself believed");
    assert_eq!(visited, errors);
    // The palette finds events by their words: an error leads to its explanation.
    let told = film.told_events();
    assert!(told.iter().any(|(to, _)| *to == ReplayAction::ToNth(ReplayLandmark::Error, 1)), "{told:?}");
    let finds = |words: &str| told.iter().any(|(_, told)| told.contains(words));
    let kinds = ["; error 1: ", "  estimated false belief 1: "];
    assert!(kinds.into_iter().all(finds), "{told:?}");
    for (_, told) in &told {
        let why = told.split_once("; error ").and_then(|(press, error)| Some((press, error.split_once(": ")?.1)));
        assert!(why.is_none_or(|(press, why)| !press.ends_with(why)), "the reason once: {told}");
    }
    let back = film.landmark(ReplayLandmark::Error, false, false).expect("the error before");
    film.wind(back);
    assert_eq!(film.time(), errors[errors.len() - 2]);
    assert_eq!(film.landmark(ReplayLandmark::Signal, true, false), None, "nobody sends signals");
    film.wind(0);
    let wrong = film.landmark(ReplayLandmark::FalseBelief, true, false).expect("something is believed wrong");
    film.wind(wrong);
    assert_eq!(film.landmark(ReplayLandmark::FalseBelief, true, true), Some(wrong), "the one at which it stands");
    let named = film.named(ReplayLandmark::FalseBelief).expect("something is believed wrong");
    assert!(named.starts_with("estimated false belief "), "{named}");
    assert!(named.contains(": thinks ") && named.contains(", is "), "{named}");
    let moment = film.beliefs.until(film.time()).last().expect("an estimate");
    assert!(moment.held.iter().any(|held| held.is_false()), "{moment:?}");
    // A plan hides the estimate from its wizard; at the console of a simulated trial there was none.
    let log = recording.join(LOG_NAME);
    let text = fs::read_to_string(&log).expect("a log");
    let hidden = text.replacen("\"visibility\":\"recommendation\"", "\"visibility\":\"state\"", 1);
    assert_ne!(hidden, text);
    fs::write(&log, hidden).expect("written");
    let shown = |film: FileResult<SeekableReplay>| film.expect("a recording").session.spec.console.visibility;
    assert_eq!(shown(SeekableReplay::begin(&recording)), WizardVisibility::Belief);
    assert_eq!(shown(SeekableReplay::begin(&recording).map(SeekableReplay::blinded)), WizardVisibility::State);
}

#[test]
fn a_time_of_the_trials_clock_is_found_across_pauses() {
    let mut film = SeekableReplay::open(Path::new("tests/golden/format-3-hand.jsonl")).expect("it opens");
    let length = film.trial_length();
    for share in 0..=20 {
        let clock = SessionTime(length.0 / 20 * share);
        let time = film.at_clock(clock).expect("a time of the trial");
        let position = film.until(time);
        film.wind(position);
        assert_eq!(film.session.trial_clock(time), clock);
    }
    assert!(film.session.pauses.len() > 3, "{:?}", film.session.pauses);
    assert_eq!(film.at_clock(length + at(1.0)), None);
    // What is typed as it is shown stands after the event, and the end is there as it is shown.
    let (_, events) = film.length();
    film.wind(events);
    let shown = |clock: SessionTime| [clock.to_string(), clock.with_tenths(), clock.with_ms()];
    let errors: Vec<(SessionTime, [String; 3])> =
        film.errors.iter().map(|error| (error.time, shown(film.session.trial_clock_at(error.time)))).collect();
    assert!(errors.len() > 2, "{errors:?}");
    let typed = |text: &str| film.at_clock(SessionTime::from_clock(text).expect("a time"));
    for (time, shown) in errors {
        assert!(shown.iter().all(|text| typed(text).is_some_and(|typed| typed >= time)), "{shown:?}");
    }
    assert!(shown(length).iter().all(|text| typed(text).is_some()), "{length}");
}
