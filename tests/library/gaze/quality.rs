//! Streams of samples: faults, delays and floods; the sampling rate, on which no estimate depends; and what counts as a look.

use tomcom_core::gaze::quality::{GazeFault, GazeRateLimiter};
use tomcom_core::kitchen::KitchenChange;
use tomcom_session::apply;
use tomcom_session::probes::ProbeOrigin;
use tomcom_study::analysis::seen_contents::LastSeenContents;
use tomcom_study::rater_episodes::{BeliefEvidence, BeliefEvidenceEvent};

use super::engine;
use crate::support::*;

/// Somebody at the keyboard, whose gaze another program tells.
fn tells_gaze(spec: &mut SessionSpec) {
    (spec.participant.kind, spec.participant.gaze) = (ParticipantKind::Keyboard, GazeSource::Json);
}

fn at_ms(ms: u64) -> SessionTime {
    SessionTime(ms * 1_000_000)
}

#[test]
fn what_is_wrong_with_a_stream_is_counted_by_kind_and_not_read() {
    let mut engine = engine(tells_gaze);
    assert_eq!(engine.input(at_ms(0), Event::TrialStarted).refused, None);
    let send = |engine: &mut SessionEngine, arrived: u64, taken: u64, x: f64| {
        let sample = GazeSample {
            device_ns: Some(taken as i64 + 5),
            taken_ns: Some(at_ms(taken)),
            ..GazeSample::new(x, 0.35, 0.9)
        };
        let before = engine.belief().clone();
        assert_eq!(engine.input(at_ms(arrived), Event::Gaze(sample)).refused, None);
        (*engine.belief() != before, engine.session().gaze.fault)
    };
    assert_eq!(send(&mut engine, 1000, 990, 0.40), (true, None));
    assert_eq!(send(&mut engine, 1000, 998, 0.40), (true, None));
    assert_eq!(send(&mut engine, 1002, 998, 0.40), (false, Some(GazeFault::Duplicate)));
    assert_eq!(send(&mut engine, 1003, 910, 0.40), (false, Some(GazeFault::OutOfOrder)));
    assert_eq!(send(&mut engine, 1600, 1010, 0.40), (false, Some(GazeFault::TooOld)));
    // One from the future counts as taken now; the stream goes on after it.
    assert_eq!(send(&mut engine, 1610, 9000, 0.40), (true, None));
    assert_eq!(send(&mut engine, 1620, 1618, 0.40), (true, None));
    let counts = engine.session().gaze.judge.counts;
    assert_eq!((counts.duplicate, counts.out_of_order, counts.too_old, counts.sum()), (1, 1, 1, 3));
    assert_eq!(engine.session().gaze.samples, 7);
}

#[test]
fn what_is_read_is_what_the_display_showed_when_the_sample_was_taken() {
    // Salmon is put down on the counter at 1000 ms; gaze of before and after arrives at 1100 ms.
    let p_salmon = |taken_ms: u64| {
        let mut engine = engine(|spec| {
            tells_gaze(spec);
            // Before the samples the gaze is unknown, and nothing is looked at.
            (spec.human.looking.looks_hz, spec.human.looking.other_looks_hz) = (0.0, 0.0);
            spec.human.looking.capture = 0.0;
        });
        let kitchen = engine.session().kitchen.clone();
        let counter = kitchen.location_named("counter").expect("a counter");
        let [x, y] = kitchen.location(counter).display.centre();
        let input = |engine: &mut SessionEngine, ms: u64, event: Event| {
            assert_eq!(engine.input(at_ms(ms), event).refused, None);
        };
        input(&mut engine, 0, Event::TrialStarted);
        let (location, content) = ("counter".to_string(), "salmon raw".to_string());
        input(&mut engine, 1000, Event::KitchenCorrected { location, content });
        for sample in 0..8 {
            let taken_ns = Some(at_ms(taken_ms + 5 * sample));
            input(&mut engine, 1100, Event::Gaze(GazeSample { taken_ns, ..GazeSample::new(x, y, 0.9) }));
        }
        let salmon = kitchen.content_named("salmon raw").expect("salmon").0;
        let value = kitchen.aspects[counter.index()].index_of(salmon).expect("a value");
        engine.belief().aspects[counter.index()].mean()[value]
    };
    let (before, after) = (p_salmon(940), p_salmon(1040));
    assert!(before < 0.05, "salmon was not there yet: {before}");
    assert!(after > 0.15, "salmon lay there: {after}");
}

#[test]
fn a_flood_is_let_through_at_the_rate_of_the_fastest_tracker() {
    let mut limit = GazeRateLimiter::default();
    let passed = |limit: &mut GazeRateLimiter, hz: u64, from_s: u64, seconds: u64| {
        let times = (0..hz * seconds).map(|n| SessionTime(from_s * 1_000_000_000 + n * 1_000_000_000 / hz));
        times.filter(|&time| limit.admits(time)).count() as u64
    };
    assert_eq!(passed(&mut limit, 1000, 0, 20), 20_000, "a fast tracker loses nothing");
    let flood = passed(&mut limit, 50_000, 20, 20);
    assert!((59_000..=60_001).contains(&flood), "{flood} of a flood");
}

#[test]
fn what_waited_while_the_program_stood_still_is_no_flood() {
    for (hz, seconds) in [(200, 6), (1000, 10), (2000, 10)] {
        let mut limit = GazeRateLimiter::default();
        let steady = (0..hz).filter(|n| limit.admits(SessionTime(n * 1_000_000_000 / hz))).count() as u64;
        // The program stands still; then all samples of that time arrive at once.
        let at_once = (0..hz * seconds).filter(|_| limit.admits(SessionTime((1 + seconds) * 1_000_000_000))).count();
        assert_eq!((steady, at_once as u64), (hz, hz * seconds), "{hz} Hz");
    }
}

/// The sampling rates that are shown after samples that arrive and were taken at these times, in ms.
fn rates(samples: impl IntoIterator<Item = (u64, Option<u64>)>) -> Vec<f64> {
    let mut engine = engine(tells_gaze);
    let mut shown = Vec::new();
    for (index, (arrived, taken)) in samples.into_iter().enumerate() {
        let x = 0.4 + index as f64 * 1e-5;
        let sample = GazeSample { taken_ns: taken.map(at_ms), ..GazeSample::new(x, 0.35, 0.9) };
        assert_eq!(engine.input(at_ms(arrived), Event::Gaze(sample)).refused, None);
        shown.extend(engine.session().gaze_hz(at_ms(arrived)));
    }
    shown
}

#[test]
fn the_rate_of_samples_that_arrive_together_is_the_trackers() {
    let most = |rates: &[f64]| rates.iter().copied().fold(0.0, f64::max);
    let last = |rates: &[f64]| rates.last().copied().unwrap_or(f64::NAN);
    // 880 samples of a tracker with 120 Hz in one datagram, without and with their times.
    let at_once = rates((0..880).map(|_| (10_000, None)));
    assert!(most(&at_once) <= 880.0, "{} Hz", most(&at_once));
    let with_times = rates((0..880).map(|sample| (10_000, Some(2_000 + sample * 25 / 3))));
    assert!((last(&with_times) - 120.0).abs() < 2.0 && most(&with_times) < 130.0, "{} Hz", most(&with_times));
    // Packets of 24 samples, five times a second.
    let packets = rates((0..1200).map(|sample| (1000 + sample / 24 * 200, None)));
    assert!(
        (last(&packets) - 120.0).abs() < 15.0 && most(&packets) < 250.0,
        "{} to {} Hz",
        last(&packets),
        most(&packets)
    );
    // One at a time: the rate is known soon, and stays.
    let steady = rates((0..480).map(|sample| (1000 + sample * 25 / 3, None)));
    assert!(steady[8..].iter().all(|hz| (hz - 120.0).abs() < 15.0), "{steady:?}");
    assert!(steady[120..].iter().all(|hz| (hz - 120.0).abs() < 3.0), "{steady:?}");
}

/// The estimate after a path of fixations, told at this rate; each a point and its length in seconds.
fn after_path(path: &[([f64; 2], f64)], hz: f64) -> Vec<Vec<f64>> {
    let mut engine = engine(tells_gaze);
    assert_eq!(engine.input(at(0.0), Event::TrialStarted).refused, None);
    let mut input = |time_s: f64, event: Event| assert_eq!(engine.input(at(time_s), event).refused, None);
    // What the robot's presses do to a belief is drawn, by the numbers of events, which are others at another rate.
    input(0.0, Event::RobotStopped);
    for (place, content) in [("counter", "salmon cut"), ("plate", "nori"), ("cutting_board", "tuna raw")] {
        input(0.5, Event::KitchenCorrected { location: place.to_string(), content: content.to_string() });
    }
    let total_s: f64 = path.iter().map(|(_, length_s)| length_s).sum();
    let samples = (total_s * hz).round() as usize;
    for sample in 0..samples {
        let time_s = (sample as f64 + 0.5) / hz;
        let mut until_s = 0.0;
        let here = path.iter().find(|(_, length_s)| {
            until_s += length_s;
            time_s < until_s - 1e-9
        });
        let [x, y] = here.unwrap_or(&path[path.len() - 1]).0;
        let taken_ns = Some(at(1.0 + time_s));
        input(1.0 + time_s, Event::Gaze(GazeSample { taken_ns, ..GazeSample::new(x, y, 0.95) }));
    }
    engine.belief().aspects.iter().map(|aspect| aspect.mean().to_vec()).collect()
}

fn apart(a: &[Vec<f64>], b: &[Vec<f64>]) -> f64 {
    let pairs = a.iter().flatten().zip(b.iter().flatten());
    pairs.map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
}

/// How far the estimates after random paths of so many fixations are apart between rates, at most: 120 and 200 Hz, and 30 Hz
/// from these. `length_s` makes the length of a fixation of a random number from 0 to 1.
fn apart_by_rate(fixations: usize, length_s: fn(f64) -> f64) -> [f64; 2] {
    let kitchen = kitchen("sushi");
    let (mut fast, mut slow) = (Vec::new(), Vec::new());
    for number in 0..12 {
        let mut random = stream(3, "paths", number);
        let mut fixation = |_| {
            let location = &kitchen.locations[random.random_range(0..kitchen.locations.len())];
            (location.display.centre(), length_s(random.random::<f64>()))
        };
        let path: Vec<([f64; 2], f64)> = (0..fixations).map(&mut fixation).collect();
        let estimates = [30.0, 120.0, 200.0].map(|hz| after_path(&path, hz));
        fast.push(apart(&estimates[1], &estimates[2]));
        slow.push(apart(&estimates[0], &estimates[1]).max(apart(&estimates[0], &estimates[2])));
    }
    let most = |values: &[f64]| values.iter().copied().fold(0.0, f64::max);
    [most(&fast), most(&slow)]
}

/// From 0.15 to 0.6 s.
fn of_any_length(share: f64) -> f64 {
    0.15 + 0.45 * share
}

#[test]
fn the_same_path_of_gaze_gives_the_same_estimate_at_every_rate() {
    let [fast, slow] = apart_by_rate(40, of_any_length);
    assert!(fast <= 0.02 && slow <= 0.02, "{fast} {slow}");
    // Where the samples of all rates tell when the eyes moved on, nothing else makes a difference, also after a few looks.
    let [fast, slow] = apart_by_rate(10, |share| (2.0 + (share * 5.0).floor()) / 10.0);
    assert!(fast <= 0.005 && slow <= 0.005, "{fast} {slow}");
}

/// Fixations of 0.15 and of 0.183 s give the same samples at 30 Hz. After one such look, at 5 readings a second, what was read
/// may differ by exp(-5 * 0.15) - exp(-5 * 0.183) = 0.07, which no estimate can know from the samples; more looks make it less.
#[test]
fn a_slow_tracker_leaves_open_when_the_eyes_moved_on() {
    let [fast, slow] = apart_by_rate(10, of_any_length);
    assert!(fast <= 0.02 && slow <= 0.07, "{fast} {slow}");
}

/// A session with what was last seen in it, event by event.
struct Look {
    session: Session,
    seen: LastSeenContents,
    trace: BeliefEvidence,
    seq: u64,
    hand: LocationId,
}

impl Look {
    /// A trial in which the robot has taken tuna at 4 s.
    fn changed() -> Look {
        let files = session_file("default");
        let session = Session::new(Arc::new(files.kitchen.kitchen), files.spec, 0);
        let hand = session.kitchen.hands[Agent::Robot.index()];
        let (seen, trace) = (LastSeenContents::default(), BeliefEvidence::default());
        let mut look = Look { session, seen, trace, seq: 0, hand };
        look.at(3.0, Event::TrialStarted);
        look.at(
            4.0,
            Event::Press { agent: Agent::Robot, button: "take tuna".to_string(), at_ns: None, button_box: false },
        );
        look
    }

    /// The same trial after the participant has looked at the tuna for 0.06 s.
    fn begun() -> Look {
        let mut look = Look::changed();
        look.gaze(4.5, 4);
        assert!(look.is_unseen(), "a look of 0.06 s is too short");
        look
    }

    fn at(&mut self, seconds: f64, event: Event) {
        let time = at(seconds);
        let stamped = TimestampedEvent { seq: self.seq, time, event };
        let applied = apply(&mut self.session, &stamped).expect("the event fits");
        self.seen.note(&self.session, &stamped.event, &applied.change);
        self.trace.note(&stamped, &applied.change, &self.session);
        self.seq += 1;
    }

    /// A gaze sample at the robot's hand that was taken and arrived at these times.
    fn late(&mut self, taken_s: f64, arrived_s: f64) {
        let [x, y] = self.session.kitchen.location(self.hand).display.centre();
        let taken_ns = Some(at(taken_s));
        self.at(arrived_s, Event::Gaze(GazeSample { taken_ns, ..GazeSample::new(x, y, 1.0) }));
    }

    /// This number of gaze samples at the robot's hand, 0.02 s apart.
    fn gaze(&mut self, from_s: f64, samples: u32) {
        let [x, y] = self.session.kitchen.location(self.hand).display.centre();
        for step in 0..samples {
            self.at(from_s + 0.02 * f64::from(step), Event::Gaze(GazeSample::new(x, y, 1.0)));
        }
    }

    fn is_unseen(&self) -> bool {
        self.seen.is_changed_unseen(self.hand)
    }
}

#[test]
fn a_look_goes_on_until_the_location_counts_as_seen() {
    let mut look = Look::begun();
    look.gaze(4.58, 3);
    assert!(!look.is_unseen(), "0.12 s");
}

#[test]
fn a_pause_and_a_freeze_probe_interrupt_looks() {
    let mut paused = Look::begun();
    paused.at(4.57, Event::TrialPaused);
    paused.at(14.0, Event::TrialResumed);
    paused.gaze(14.02, 4);
    assert!(paused.is_unseen(), "two looks of 0.06 s");
    paused.gaze(14.1, 3);
    assert!(!paused.is_unseen(), "the second one went on");
    let mut probed = Look::begun();
    let begun =
        ProbeEvent::Begun { probe: 1, origin: ProbeOrigin::Wizard, uses_estimate: false, questions: Vec::new() };
    probed.seen.note(&probed.session, &Event::Probe(begun), &KitchenChange::None);
    probed.gaze(4.58, 4);
    assert!(probed.is_unseen(), "two looks of 0.06 s");
}

/// Five samples of 0.12 s at the robot's hand, taken from `taken_s` on, all of which arrive at 4.15 s: after the change at 4 s.
fn arriving_after_the_change(taken_s: f64) -> Look {
    let mut look = Look::changed();
    for step in 0..5 {
        look.late(taken_s + 0.03 * f64::from(step), 4.15);
    }
    look
}

#[test]
fn a_look_counts_by_the_time_at_which_it_was_taken() {
    let looks =
        |look: &Look| look.trace.events.iter().any(|(_, event)| matches!(event, BeliefEvidenceEvent::Looked { .. }));
    let before = arriving_after_the_change(3.7);
    assert!(before.session.is_unseen(before.hand), "the mark on the wizard's screen, and the stratum of probes");
    assert!(before.is_unseen() && !looks(&before), "the old content was looked at");
    assert_eq!(before.session.gaze.looked_at[before.hand.index()], Some(at(3.82)));
    let after = arriving_after_the_change(4.01);
    assert!(!after.session.is_unseen(after.hand));
    assert!(!after.is_unseen() && looks(&after));
    // The duration of a look is that between samples, however they arrive: 0.06 s of the new content are too short.
    let across = arriving_after_the_change(3.94);
    assert!(!across.session.is_unseen(across.hand), "the gaze was there after the change");
    assert!(across.is_unseen() && !looks(&across));
}

/// A sample that arrives again, or late, says nothing about where the gaze is now.
#[test]
fn a_faulty_sample_ends_no_look() {
    let mut look = Look::changed();
    look.late(4.5, 4.5);
    look.late(4.56, 4.56);
    look.late(3.9, 4.57);
    look.late(4.61, 4.62);
    assert!(!look.is_unseen(), "0.11 s");
}

#[test]
fn the_scripted_wizard_sees_at_which_content_the_participant_looked() {
    let mut look = Look::changed();
    look.late(3.9, 4.1);
    assert_eq!((look.session.looked_at(), look.session.sees_present_content(look.hand)), (Some(look.hand), false));
    look.late(4.05, 4.15);
    assert_eq!((look.session.looked_at(), look.session.sees_present_content(look.hand)), (Some(look.hand), true));
}

/// A probe ends at 20 s: a sample that was taken before is no look at the kitchen, although it arrives after.
#[test]
fn a_sample_that_was_taken_during_a_probe_is_no_look_at_the_kitchen() {
    let look = |taken_s: f64| {
        let mut look = Look::changed();
        look.session.probes.ended_at = Some(at(20.0));
        look.late(taken_s, 20.05);
        (look.session.looked_at().is_some(), look.session.is_unseen(look.hand))
    };
    assert_eq!((look(19.9), look(20.01)), ((false, true), (true, false)));
}
