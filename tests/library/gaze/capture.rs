//! What Pupil Capture's detectors and its recorder tell, and what is made of it.

use std::time::{Duration, Instant};

use rmpv::Value;
use tomcom_core::gaze::tags::SurfaceHomography;
use tomcom_devices::pupil::eye_events::{BlinkMerger, FixationFragment, FixationMerger};
use tomcom_devices::pupil::message::{self, CaptureNotification, PupilBlink};
use tomcom_devices::pupil::recorder::{CaptureAction, CaptureRecordingControl, CaptureRequest};
use tomcom_devices::pupil::{CaptureConfiguration, follow};
use tomcom_session::preflight_checks;
use tomcom_session::tracker::TrackerEvent;

use super::engine;
use crate::support::*;

/// Published by Pupil's own detectors: see tests/pupil/README.md.
const MESSAGES: &[u8] = include_bytes!("../../pupil/online_detectors.msgpack");

/// Time of arrival in seconds, topic and payload of the recorded messages.
fn messages() -> Vec<(f64, String, Vec<u8>)> {
    let mut rest = MESSAGES;
    let mut found = Vec::new();
    while !rest.is_empty() {
        let Ok(Value::Array(parts)) = rmpv::decode::read_value(&mut rest) else { panic!("a list") };
        let [Value::F64(at_s), topic, Value::Binary(payload)] = parts.as_slice() else { panic!("three parts") };
        found.push((*at_s, topic.as_str().expect("a topic").to_string(), payload.clone()));
    }
    found
}

/// Fixations and blinks of messages that arrive at these times.
fn merge(messages: &[(f64, String, Vec<u8>)]) -> (Vec<FixationFragment>, Vec<PupilBlink>) {
    let start = Instant::now();
    let (mut fixations, mut blinks) = (FixationMerger::default(), BlinkMerger::default());
    let (mut whole, mut lids) = (Vec::new(), Vec::new());
    for (at_s, topic, payload) in messages {
        let now = start + Duration::from_secs_f64(*at_s);
        whole.extend(fixations.expire(now));
        lids.extend(blinks.expire(now));
        let told = message::read(topic.as_bytes(), payload, "wall");
        assert_eq!(told.malformed, 0);
        for window in told.fixations {
            whole.extend(fixations.take(window, now));
        }
        lids.extend(told.blink.into_iter().flat_map(|blink| blinks.take(blink, now)).flatten());
    }
    whole.extend(fixations.end());
    lids.extend(blinks.end());
    (whole, lids)
}

#[test]
fn windows_of_one_fixation_are_one_fixation_and_repeated_onsets_one_blink() {
    let messages = messages();
    let count = |wanted: &str| messages.iter().filter(|(_, topic, _)| topic == wanted).count();
    assert_eq!((count("fixations"), count("blinks")), (106, 21), "what Capture sent");
    let (fixations, blinks) = merge(&messages);
    // The gaze rested for these times, and was sampled every 33 ms.
    let lasted_s: Vec<f64> = fixations.iter().map(|found| found.span_s[1] - found.span_s[0]).collect();
    let truth_s = [1.94, 0.60, 0.45, 1.10, 0.41];
    assert_eq!(lasted_s.len(), truth_s.len() + 1, "{lasted_s:?}");
    for (lasted_s, truth_s) in lasted_s.iter().zip(truth_s) {
        assert!((lasted_s - truth_s).abs() < 0.045, "{lasted_s} of {truth_s} s");
    }
    assert!(fixations.windows(2).all(|pair| pair[0].span_s[1] < pair[1].span_s[0]), "{fixations:?}");
    // Three blinks of 0.2 s.
    let kinds: Vec<bool> = blinks.iter().map(|blink| blink.is_onset).collect();
    assert_eq!(kinds, [true, false].repeat(3));
    for blink in blinks.chunks(2) {
        let lasted_s = blink[1].timestamp - blink[0].timestamp;
        assert!((0.2..0.4).contains(&lasted_s), "{lasted_s} s");
    }
}

#[test]
fn a_fixation_ends_with_silence_and_ids_may_begin_anew() {
    let start = Instant::now();
    let at = |ms: u64| start + Duration::from_millis(ms);
    let window = |id, begin_s: f64, x: Option<f64>| FixationFragment {
        id,
        at: x.map(|x| [x, 0.5]),
        span_s: [begin_s, begin_s + 0.3],
        dispersion_deg: 1.0,
        confidence: 0.8,
    };
    let mut merger = FixationMerger::default();
    assert_eq!(merger.take(window(7, 10.0, Some(0.2)), at(0)), None);
    assert_eq!(merger.take(window(7, 10.1, None), at(100)), None);
    assert_eq!(merger.take(window(7, 10.2, Some(0.4)), at(200)), None);
    assert_eq!(merger.expire(at(600)), None);
    let over = merger.expire(at(700)).expect("it is over");
    assert_eq!((over.id, over.span_s, over.confidence), (7, [10.0, 10.5], 0.8));
    let [x, y] = over.at.expect("a position");
    assert!((x - 0.3).abs() < 1e-12 && y == 0.5, "{x}, {y}");
    assert_eq!((merger.expire(at(9000)), merger.end()), (None, None));
    // The detector was restarted: the same number much later.
    assert_eq!(merger.take(window(0, 20.0, None), at(10_000)), None);
    let over = merger.take(window(0, 25.0, None), at(10_100)).expect("another fixation");
    assert_eq!(over.span_s, [20.0, 20.3]);
}

#[test]
fn blinks_without_an_onset_are_none_and_an_onset_after_a_pause_is_another() {
    let start = Instant::now();
    let at = |ms: u64| start + Duration::from_millis(ms);
    let blink = |is_onset, timestamp| PupilBlink { is_onset, confidence: 0.9, timestamp };
    let mut merger = BlinkMerger::default();
    assert_eq!(merger.take(blink(false, 1.0), at(0)), [None, None]);
    assert_eq!(merger.take(blink(true, 2.0), at(100)), [None, Some(blink(true, 2.0))]);
    assert_eq!(merger.take(blink(true, 2.03), at(130)), [None, None]);
    // The lids opened too slowly for the detector.
    assert_eq!(merger.take(blink(true, 9.0), at(7000)), [None, Some(blink(true, 9.0))]);
    assert_eq!(merger.take(blink(false, 9.2), at(7200)), [None, None]);
    assert_eq!(merger.take(blink(false, 9.3), at(7300)), [None, None]);
    assert_eq!(merger.take(blink(true, 9.5), at(7500)), [Some(blink(false, 9.3)), Some(blink(true, 9.5))]);
    assert_eq!(merger.take(blink(false, 9.7), at(7700)), [None, None]);
    assert_eq!((merger.expire(at(8000)), merger.expire(at(8200))), (None, Some(blink(false, 9.7))));
}

/// What Capture is asked, in words.
fn words(actions: Vec<CaptureAction>) -> Vec<String> {
    let word = |action| match action {
        CaptureAction::Start(name) => format!("R {name}"),
        CaptureAction::Stop => "r".to_string(),
        CaptureAction::Annotate { label, at, not_before } => match not_before.filter(|begun| *begun > at) {
            Some(begun) => format!("{label}, {} ms late", (begun - at).as_millis()),
            None => label,
        },
        CaptureAction::Tell(told) => format!("{told:?}"),
        CaptureAction::Report(_) => "report".to_string(),
    };
    actions.into_iter().map(word).collect()
}

fn request(goes_on: bool) -> CaptureRequest {
    CaptureRequest::Record { name: "P07".to_string(), goes_on }
}

struct Desk {
    recorder: CaptureRecordingControl,
    start: Instant,
}

impl Desk {
    fn new(records: bool) -> Desk {
        Desk { recorder: CaptureRecordingControl::new(records), start: Instant::now() }
    }

    fn at(&self, ms: u64) -> Instant {
        self.start + Duration::from_millis(ms)
    }

    fn connected(&mut self, ms: u64, is_same_run: bool) -> Vec<String> {
        words(self.recorder.connected(self.at(ms), is_same_run, true))
    }

    fn record(&mut self, ms: u64) -> Vec<String> {
        words(self.recorder.order(request(false), self.at(ms)))
    }

    fn annotate(&mut self, ms: u64, label: &str, state: &[&str]) -> Vec<String> {
        let request = self.annotation(ms, label, state);
        words(self.recorder.order(request, self.at(ms)))
    }

    fn annotation(&self, ms: u64, label: &str, state: &[&str]) -> CaptureRequest {
        let state = state.iter().map(|label| label.to_string()).collect();
        CaptureRequest::Annotate { label: label.to_string(), at: self.at(ms), state }
    }

    fn stop(&mut self, ms: u64) -> Vec<String> {
        words(self.recorder.order(CaptureRequest::StopRecording, self.at(ms)))
    }

    fn stop_answered(&mut self, ms: u64) -> Vec<String> {
        words(self.recorder.stop_answered(self.at(ms)))
    }

    fn started(&mut self, ms: u64, name: &str) -> Vec<String> {
        words(self.recorder.heard(CaptureNotification::Started(name.to_string()), self.at(ms)))
    }

    fn stopped(&mut self, ms: u64) -> Vec<String> {
        words(self.recorder.heard(CaptureNotification::Stopped, self.at(ms)))
    }

    fn pass(&mut self, ms: u64) -> Vec<String> {
        words(self.recorder.pass(self.at(ms)))
    }

    /// A trial that Capture records since 100 ms.
    fn running() -> Desk {
        let mut desk = Desk::new(true);
        assert!(desk.connected(0, false).is_empty());
        assert_eq!(desk.record(20), ["R P07"]);
        assert!(desk.annotate(20, "trial started", &["trial running"]).is_empty(), "it does not record yet");
        assert_eq!(desk.started(100, "P07"), ["Begun", "trial started, 80 ms late"]);
        desk
    }
}

#[test]
fn the_start_of_the_trial_is_annotated_once_capture_records_and_its_end_before_the_recording_ends() {
    let mut desk = Desk::running();
    assert_eq!(
        desk.annotate(500, "signal shown: rice", &["trial running", "signal shown: rice"]),
        ["signal shown: rice"]
    );
    assert_eq!(desk.annotate(900, "trial ended", &[]), ["trial ended"]);
    assert!(desk.stop(900).is_empty(), "Capture has not read the annotation yet");
    // The next trial begins when this recording is over.
    assert!(desk.record(1000).is_empty());
    assert_eq!(desk.recorder.due(), Some(desk.at(1400)));
    assert_eq!(desk.pass(1400), ["r"]);
    assert!(desk.recorder.due().is_none(), "Capture answers, or the connection is lost");
    assert_eq!(desk.stop_answered(1410), ["R P07"]);
    assert!(desk.stopped(1420).is_empty());
    assert_eq!(desk.started(1440, "P07"), ["Begun"]);
}

#[test]
fn a_recording_of_the_lab_is_annotated_and_never_ended() {
    // It runs already: nothing is announced.
    let mut desk = Desk::new(true);
    desk.connected(0, false);
    assert_eq!(desk.record(0), ["R P07"]);
    assert!(desk.annotate(0, "trial started", &["trial running"]).is_empty());
    assert!(desk.pass(2999).is_empty());
    assert_eq!(desk.pass(3000), ["NotBegun", "trial started"]);
    assert_eq!(desk.annotate(5000, "trial ended", &[]), ["trial ended"]);
    assert!(desk.stop(5000).is_empty() && desk.recorder.due().is_none());
    // It began under another name just then.
    let mut desk = Desk::new(true);
    desk.connected(0, false);
    desk.record(0);
    assert_eq!(desk.started(50, "lab"), ["NotBegun"]);
    assert!(desk.stop(5000).is_empty() && desk.recorder.due().is_none());
    // The lab ends ours, and begins another one, whose name Capture kept.
    let mut desk = Desk::running();
    assert_eq!(desk.stopped(2000), ["Ended"]);
    assert!(desk.started(2500, "P07").is_empty());
    assert!(desk.stop(5000).is_empty() && desk.recorder.due().is_none());
}

#[test]
fn a_recording_that_begins_late_is_ours() {
    let mut desk = Desk::new(true);
    desk.connected(0, false);
    desk.record(0);
    assert!(desk.annotate(0, "trial started", &["trial running"]).is_empty());
    assert_eq!(desk.pass(3000), ["NotBegun", "trial started"]);
    // What was annotated before is not in it.
    assert_eq!(desk.started(4000, "P07"), ["Begun", "trial running"]);
    assert!(desk.stop(5000).is_empty());
    assert_eq!(desk.pass(5500), ["r"]);
}

#[test]
fn a_new_recording_of_a_restarted_capture_gets_the_state_of_the_trial() {
    let mut desk = Desk::running();
    desk.annotate(500, "signal shown: rice", &["trial paused", "signal shown: rice"]);
    desk.recorder.disconnected();
    let waiting = desk.annotation(7000, "trial resumed", &["trial running"]);
    desk.recorder.queue(waiting);
    assert_eq!(desk.connected(9000, false), ["R P07"]);
    let told = ["Begun", "trial paused", "signal shown: rice", "trial resumed, 2100 ms late"];
    assert_eq!(desk.started(9100, "P07"), told);
    // A trial that ended meanwhile is recorded no more.
    let mut desk = Desk::running();
    desk.recorder.disconnected();
    let waiting = desk.annotation(7000, "trial ended", &[]);
    desk.recorder.queue(waiting);
    desk.recorder.queue(CaptureRequest::StopRecording);
    assert!(desk.connected(9000, false).is_empty());
}

#[test]
fn a_recording_goes_on_through_a_loss_of_the_network() {
    // The same Capture: our recording runs, and is not announced again.
    let mut desk = Desk::running();
    desk.recorder.disconnected();
    assert_eq!(desk.connected(9000, true), ["R P07"]);
    assert_eq!(desk.pass(12_000), ["trial running"]);
    assert!(desk.stop(13_000).is_empty());
    assert_eq!(desk.pass(13_500), ["r"]);
    // It was lost when the recording was about to end.
    let mut desk = Desk::running();
    desk.annotate(900, "trial ended", &[]);
    desk.stop(900);
    desk.recorder.disconnected();
    assert_eq!(desk.connected(9000, true), ["r"]);
    // The trial ended meanwhile: what is ours is ended.
    let mut desk = Desk::running();
    desk.recorder.disconnected();
    desk.recorder.queue(CaptureRequest::StopRecording);
    assert_eq!(desk.connected(9000, true), ["r"]);
}

#[test]
fn a_recording_whose_end_capture_did_not_answer_is_ended_after_the_next_connection() {
    let mut desk = Desk::running();
    assert!(desk.stop(900).is_empty());
    assert_eq!(desk.pass(1400), ["r"]);
    assert!(desk.record(1500).is_empty(), "Capture has not answered yet");
    // The request failed: the connection is lost, and Capture records on.
    desk.recorder.disconnected();
    assert_eq!(desk.connected(9000, true), ["r"]);
    assert_eq!(desk.stop_answered(9010), ["R P07"], "the next recording begins after the end of the last");
    // A restarted Capture does not record.
    let mut desk = Desk::running();
    desk.stop(900);
    assert_eq!(desk.pass(1400), ["r"]);
    desk.recorder.disconnected();
    assert!(desk.connected(9000, false).is_empty());
}

#[test]
fn a_recording_that_was_ours_before_a_kill_is_ours_in_the_continued_trial() {
    // It runs on: Capture announces nothing, and it is ended with the trial.
    let mut desk = Desk::new(true);
    desk.recorder.queue(request(true));
    let annotation = desk.annotation(0, "trial running", &["trial running"]);
    desk.recorder.queue(annotation);
    assert_eq!(desk.connected(0, false), ["R P07"]);
    assert_eq!(desk.pass(3000), ["GoesOn", "trial running"]);
    assert_eq!(desk.annotate(5000, "trial ended", &[]), ["trial ended"]);
    assert!(desk.stop(5000).is_empty());
    assert_eq!(desk.pass(5500), ["r"]);
    // Capture was closed meanwhile, or its recording was ended: a new one begins.
    let mut desk = Desk::new(true);
    desk.connected(0, false);
    assert_eq!(words(desk.recorder.order(request(true), desk.at(10))), ["R P07"]);
    assert_eq!(desk.started(60, "P07"), ["Begun"]);
    assert!(desk.stop(900).is_empty());
    assert_eq!(desk.pass(1400), ["r"]);
    // The lab ends ours and begins its own just then: that one is the lab's.
    let own: [fn(&mut Desk) -> Vec<String>; 2] =
        [|desk| desk.started(60, "lab"), |desk| [desk.stopped(50), desk.pass(3010)].concat()];
    for lab in own {
        let mut desk = Desk::new(true);
        desk.connected(0, false);
        words(desk.recorder.order(request(true), desk.at(10)));
        assert_eq!(lab(&mut desk), ["NotBegun"]);
        assert!(desk.stop(5000).is_empty() && desk.recorder.due().is_none());
    }
    // Capture is restarted before it is known whose recording runs.
    let mut desk = Desk::new(true);
    desk.connected(0, false);
    words(desk.recorder.order(request(true), desk.at(10)));
    desk.recorder.disconnected();
    assert_eq!(desk.connected(1000, false), ["R P07"]);
    assert_eq!(desk.pass(4000), ["NotBegun"]);
}

#[test]
fn a_recording_of_the_tracker_is_ours_in_the_log_until_it_ends() {
    use tomcom_session::tracker::TrackerRecording::{Begun, Ended, GoesOn, NotAnnotated, NotBegun};
    let mut engine = engine(|spec| spec.participant.gaze = GazeSource::Pupil);
    assert!(!engine.session().tracker.is_recording());
    for (state, is_ours) in [(NotBegun, false), (Begun, true), (NotAnnotated, true), (Ended, false), (GoesOn, true)] {
        let outcome = engine.input(SessionTime::ZERO, Event::Tracker(TrackerEvent::Recording { state }));
        assert_eq!((outcome.refused, engine.session().tracker.is_recording()), (None, is_ours), "{state:?}");
    }
}

#[tokio::test]
async fn requests_wait_for_a_capture_that_is_not_there_without_filling_their_channel() {
    let free = std::net::TcpListener::bind("127.0.0.1:0").and_then(|listener| listener.local_addr()).expect("a port");
    let map = SurfaceHomography::new([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]]).expect("a map");
    let (address, surface) = ("127.0.0.1".to_string(), "wall".to_string());
    let (_news, orders) = follow(CaptureConfiguration { address, port: free.port(), surface, map, records: true });
    let room = orders.capacity();
    for _ in 0..room {
        orders.try_send(request(false)).expect("room");
    }
    let until = Instant::now() + Duration::from_secs(300);
    while orders.capacity() < room {
        assert!(Instant::now() < until, "nobody takes the requests: {} of {room} places are free", orders.capacity());
        tokio::time::sleep(Duration::from_millis(20)).await;
    }
}

#[test]
fn without_recording_capture_is_annotated_all_the_same() {
    let mut desk = Desk::new(false);
    assert!(desk.connected(0, false).is_empty());
    assert!(desk.record(10).is_empty());
    assert_eq!(desk.annotate(10, "trial started", &["trial running"]), ["trial started"]);
    desk.recorder.disconnected();
    assert_eq!(desk.connected(900, false), ["trial running"]);
    assert_eq!(desk.annotate(2000, "trial ended", &[]), ["trial ended"]);
    assert!(desk.stop(2000).is_empty() && desk.recorder.due().is_none());
}

#[test]
fn annotations_wait_for_the_plugin_that_records_them() {
    let mut desk = Desk::new(true);
    let now = desk.at(0);
    assert!(words(desk.recorder.connected(now, false, false)).is_empty());
    assert!(desk.record(100).is_empty());
    assert!(desk.annotate(100, "trial started", &["trial running"]).is_empty());
    let now = desk.at(200);
    assert_eq!(words(desk.recorder.listens(now)), ["R P07"]);
    assert_eq!(desk.started(300, "P07"), ["Begun", "trial started, 200 ms late"]);
    // It never listens: that is told, and nothing waits for it any more.
    let mut desk = Desk::new(false);
    let now = desk.at(0);
    words(desk.recorder.connected(now, false, false));
    assert!(desk.annotate(100, "trial started", &[]).is_empty());
    assert_eq!(desk.pass(1500), ["NotAnnotated", "trial started"]);
}

#[test]
fn where_only_other_surfaces_are_seen_their_names_are_told() {
    let mut engine = engine(|spec| spec.participant.gaze = GazeSource::Pupil);
    let mut check = |event: TrackerEvent| {
        let outcome = engine.input(SessionTime::ZERO, Event::Tracker(event));
        assert_eq!(outcome.refused, None);
        let checks = preflight_checks::participant(engine.session(), SessionTime::ZERO, "^v", None);
        let found = checks.into_iter().find(|check| check.name == "eye tracker").expect("a check of the tracker");
        format!("{}: {}", found.found, found.remedy.unwrap_or_default())
    };
    check(TrackerEvent::Connected { device: "Pupil Capture 3.5".to_string() });
    assert!(
        check(TrackerEvent::DisplayLost)
            .starts_with("Pupil Capture 3.5, does not see \"wall\": keep the display tags in view")
    );
    let names = ["Surface 1", "table"].map(str::to_string).to_vec();
    assert_eq!(
        check(TrackerEvent::OtherSurfaces { names }),
        "Pupil Capture 3.5, sees \"Surface 1\", not \"wall\": \
         set surface = \"Surface 1\" or \"table\" under [tracker], or name the surface \"wall\" in Capture"
    );
    assert!(check(TrackerEvent::DisplayFound).starts_with("Pupil Capture 3.5, sees the display"));
    // After that nothing is known of other surfaces any more.
    assert!(check(TrackerEvent::DisplayLost).contains("does not see"));
}
