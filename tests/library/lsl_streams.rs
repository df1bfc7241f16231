//! Streams of the Lab Streaming Layer: what they are called, what their channels are, and what is sent of a session. And gaze that comes
//! in.

use strum::VariantArray;
use tomcom_devices::lsl::{LslError, load};
use tomcom_devices::lsl::{
    LslSampleConverter, LslSampleValues, StreamDescription, StreamSample, code, describe, event_text,
};
use tomcom_session::follower::SessionFollower;
use tomcom_session::history::belief_track::BeliefSnapshot;
use tomcom_session::questionnaire::AnswerValue;
use tomcom_session::settings::{GazeOrigin, GazeUnit, LslGazeSpec, LslOutlet, LslSpec};
use tomcom_session::tracker::TrackerEvent;
use tomcom_session::tutorial::TutorialEvent;

use crate::support::*;

/// Name of the recording.
const RECORDING: &str = "2026-03-14-P07-1";

/// The default session, which sends these streams.
fn spec(outlets: &[LslOutlet]) -> SessionSpec {
    let mut spec = session_file("default").spec;
    spec.participant.code = "P07".to_string();
    spec.lsl = Some(LslSpec { outlets: outlets.to_vec(), ..LslSpec::default() });
    spec
}

fn stamped(event: Event) -> TimestampedEvent {
    TimestampedEvent { seq: 7, time: SessionTime(1_500_000_000), event }
}

/// All samples of a golden recording with these streams, with the log's events and the session at its end.
fn sent(name: &str, outlets: &[LslOutlet]) -> (Vec<StreamSample>, Vec<Value>, Session) {
    let path = format!("tests/golden/{name}.jsonl");
    let mut log = LogReader::open(Path::new(&path)).expect("a golden recording");
    let session = log.session();
    let mut follower = SessionFollower::new(session.clone(), CostToGo::new(session.kitchen.clone())).without_causes();
    let mut wanted = session;
    wanted.spec.lsl = spec(outlets).lsl;
    let (mut maker, mut samples) = (LslSampleConverter::new(&wanted, RECORDING), Vec::new());
    while let Some(line) = log.next_line().expect("a line") {
        let event = line.stamped;
        follower.apply(&event).expect("it applies");
        let (session, belief) = (&follower.session, follower.filter.belief());
        let snapshot =
            BeliefSnapshot::new(&session.kitchen, session.state, belief, event.time, event.event.is_sample());
        samples.extend(maker.samples(std::slice::from_ref(&event), session, &follower.judged, &snapshot));
    }
    let text = fs::read_to_string(&path).expect("the log");
    let events = text.lines().skip(1).map(|line| serde_json::from_str(line).expect("an event")).collect();
    (samples, events, follower.session)
}

fn texts(sample: &StreamSample) -> &[String] {
    match &sample.values {
        LslSampleValues::Texts(texts) => texts,
        LslSampleValues::Numbers(_) => panic!("numbers in {:?}", sample.outlet),
    }
}

fn numbers(sample: &StreamSample) -> &[f64] {
    match &sample.values {
        LslSampleValues::Numbers(numbers) => numbers,
        LslSampleValues::Texts(_) => panic!("texts in {:?}", sample.outlet),
    }
}

#[test]
fn every_event_but_samples_is_a_marker_with_the_fields_of_the_log() {
    for name in ["format-3-hand", "format-3-simulated", "format-3-offers", "format-3-probes"] {
        let (samples, events, _) = sent(name, LslOutlet::VARIANTS);
        let is_event = |sample: &&StreamSample| match &sample.values {
            LslSampleValues::Texts(texts) => !texts[0].contains(RECORDING),
            LslSampleValues::Numbers(_) => true,
        };
        let of = |outlet| samples.iter().filter(is_event).filter(move |sample| sample.outlet == outlet);
        let is_sample = |event: &&Value| event["kind"] == "gaze" || event["kind"] == "robot_moves";
        let wanted: Vec<&Value> = events.iter().filter(|event| !is_sample(event)).collect();
        let told: Vec<&StreamSample> = of(LslOutlet::Events).collect();
        let codes: Vec<&StreamSample> = of(LslOutlet::Markers).collect();
        assert_eq!((told.len(), codes.len()), (wanted.len(), wanted.len()), "{name}");
        for ((sample, code), event) in told.iter().zip(&codes).zip(&wanted) {
            let mut found: Value = serde_json::from_str(&texts(sample)[0]).expect("JSON");
            let left_out = found.as_object_mut().and_then(|fields| fields.remove("left_out")).unwrap_or(json!([]));
            let mut event = (*event).clone();
            for field in left_out.as_array().into_iter().flatten().filter_map(Value::as_str) {
                let removed = event.as_object_mut().and_then(|fields| fields.remove(field));
                // Whether somebody was unsure of a probe's question is left out, too: then the log has no such field.
                assert!(removed.is_some() || event["did"] == "answered", "{field} is no field of {event}");
            }
            assert_eq!(found, event, "{name}");
            assert_eq!((sample.time.0, code.time.0), (event["t_ns"].as_u64().unwrap_or(0), sample.time.0));
            assert!(texts(code)[0].starts_with(event["kind"].as_str().unwrap_or("?")), "{name}: {code:?}");
        }
        let gaze = events.iter().filter(|event| event["kind"] == "gaze").count();
        assert_eq!(of(LslOutlet::Gaze).count(), gaze, "{name}");
    }
}

#[test]
fn codes_name_what_an_event_is_about() {
    let (samples, _, _) = sent("format-3-offers", &[LslOutlet::Markers]);
    let codes: Vec<&str> = samples.iter().map(|sample| texts(sample)[0].as_str()).collect();
    assert_eq!(codes[..2], [&format!("recording/{RECORDING}"), "trial_started"]);
    for wanted in ["press/human/", "press/robot/", "robot_intends/", "order_shown/", "offer_opened/", "advised"] {
        assert!(codes.iter().any(|code| code.starts_with(wanted)), "{wanted} in {codes:?}");
    }
    let shown = |json: Value| code(&stamped(serde_json::from_value(json).expect("an event")));
    let signal = json!({ "kind": "signal_shown", "by": "wizard", "signal": { "highlight": "cooking_pot" } });
    assert_eq!(shown(signal), "signal_shown/wizard/highlight/cooking_pot");
    assert_eq!(shown(json!({ "kind": "trial_ended", "reason": "presses" })), "trial_ended/presses");
    assert_eq!(shown(json!({ "kind": "signal_drawn", "signal": 12 })), "signal_drawn");
    assert_eq!(shown(json!({ "kind": "tracker", "what": "display_lost" })), "tracker/display_lost");
}

/// Whoever is in the network can read a stream.
#[test]
fn what_people_typed_and_names_of_devices_are_not_sent() {
    let secret = "Anna".to_string();
    let answer = AnswerValue::Text(secret.clone());
    let events = [
        (Event::Marker { note: secret.clone(), observer: None }, "marker", "note"),
        (Event::TrialAborted { reason: secret.clone() }, "trial_aborted", "reason"),
        (Event::TrialExcluded { reason: secret.clone() }, "trial_excluded", "reason"),
        (Event::Tracker(TrackerEvent::Connected { device: secret.clone() }), "tracker/connected", "device"),
        (Event::Tracker(TrackerEvent::Lost { reason: secret.clone() }), "tracker/lost", "reason"),
        (
            Event::Protocol(ProtocolEvent::ItemAnswered { item: "age".to_string(), answer }),
            "protocol/item_answered/age",
            "answer",
        ),
        (Event::Probe(ProbeEvent::Skipped { probe: 1, reason: secret.clone() }), "probe/skipped", "reason"),
        (
            Event::Protocol(ProtocolEvent::CriterionWaived { reason: secret.clone() }),
            "protocol/criterion_waived",
            "reason",
        ),
    ];
    for (event, wanted, field) in events {
        let event = stamped(event);
        assert_eq!(code(&event), wanted);
        let text = event_text(&event);
        let told: Value = serde_json::from_str(&text).expect("JSON");
        assert!(!text.contains(&secret), "{text}");
        assert_eq!((&told["left_out"], &told["seq"]), (&json!([field]), &json!(7)));
    }
}

#[test]
fn answers_to_probes_and_in_the_tutorial_are_not_sent_nor_whether_somebody_was_unsure() {
    let answered = |answer: Option<&str>, confidence| {
        let (answer, on) = (answer.map(str::to_string), AnswerDevice::Display);
        Event::Probe(ProbeEvent::Answered { probe: 1, question: 2, answer, confidence, on })
    };
    let chosen = |choice| {
        let event = TutorialEvent::Answered { step: "recipes".to_string(), choice };
        Event::Protocol(ProtocolEvent::Tutorial(event))
    };
    for (one, other, fields) in [
        (answered(Some("rice raw"), Some(3)), answered(None, None), json!(["answer", "confidence"])),
        (chosen(1), chosen(2), json!(["choice"])),
    ] {
        let [one, other] = [one, other].map(|event| event_text(&stamped(event)));
        assert_eq!(one, other);
        let told: Value = serde_json::from_str(&one).expect("JSON");
        assert_eq!(told["left_out"], fields);
    }
}

#[test]
fn presses_say_whether_they_did_anything_and_were_errors() {
    let (samples, events, session) = sent("format-3-probes", &[LslOutlet::Presses]);
    let presses: Vec<&Value> = events.iter().filter(|event| event["kind"] == "press").collect();
    assert_eq!(samples.len(), presses.len());
    let mut counts: BTreeMap<Vec<&str>, usize> = BTreeMap::new();
    for (sample, press) in samples.iter().zip(presses) {
        let [agent, button, effective, error] = texts(sample) else { panic!("{sample:?}") };
        assert_eq!(
            (agent.as_str(), button.as_str()),
            (press["agent"].as_str().unwrap(), press["button"].as_str().unwrap())
        );
        assert!(["yes", "no"].contains(&effective.as_str()) && error.is_empty() == (agent == "robot"), "{sample:?}");
        *counts.entry(vec![agent.as_str(), effective.as_str(), error.as_str()]).or_default() += 1;
    }
    let sum = |agent, effective| -> usize {
        let is = |(key, _): &(&Vec<&str>, &usize)| key[0] == agent && key[1] == effective;
        counts.iter().filter(is).map(|(_, count)| count).sum()
    };
    let effective = session
        .timeline
        .iter()
        .filter(|entry| matches!(entry.what, tomcom_session::TimelineEvent::Press { no_effect: None, .. }));
    assert_eq!(sum("human", "yes") + sum("robot", "yes"), effective.count(), "{counts:?}");
    assert!(counts.iter().any(|(key, _)| key[2] == "yes"), "an error among {counts:?}");
}

#[test]
fn beliefs_and_net_benefits_are_the_logs() {
    let (samples, events, session) = sent("format-3-offers", &[LslOutlet::Beliefs, LslOutlet::NetBenefit]);
    let [beliefs, benefits] = [LslOutlet::Beliefs, LslOutlet::NetBenefit]
        .map(|outlet| describe(&spec(&[outlet]), &session.kitchen).remove(0));
    let labels = |stream: &StreamDescription| -> Vec<String> {
        stream.channels.iter().map(|channel| channel.label.clone()).collect()
    };
    let (aspects, signals) = (labels(&beliefs), labels(&benefits));
    let mut told = 0;
    let mut offered = samples.iter().filter(|sample| sample.outlet == LslOutlet::NetBenefit);
    for event in &events {
        if event["kind"] == "advised" {
            let sample = offered.next().expect("a sample of each recommendation");
            assert_eq!(sample.time.0, event["for_ns"].as_u64().unwrap());
            for (label, value) in signals.iter().zip(numbers(sample)) {
                let (kind, place) = label.split_once('/').expect("kind and place");
                let options = event["options"].as_array().expect("options");
                let option = options.iter().find(|option| option["signal"][kind] == place);
                match option {
                    Some(option) => assert_eq!(option["net"].as_f64(), Some(*value), "{label}"),
                    None => assert!(value.is_nan(), "{label}: {value}"),
                }
                told += usize::from(option.is_some());
            }
        }
        if event["kind"] == "belief_estimated" {
            // The estimate before the press: that of the last sample before it.
            let at = event["t_ns"].as_u64().unwrap();
            let is_before = |sample: &&StreamSample| sample.outlet == LslOutlet::Beliefs && sample.time.0 < at;
            let Some(sample) = samples.iter().rev().find(is_before) else { continue };
            let off: Vec<f64> = event["aspects"]
                .as_array()
                .expect("aspects")
                .iter()
                .map(|about| {
                    let place = aspects.iter().position(|name| about["aspect"] == name.as_str()).expect("a channel");
                    (numbers(sample)[place] - about["p_truth"].as_f64().unwrap()).abs()
                })
                .collect();
            assert!(off.iter().sum::<f64>() / (off.len() as f64) < 0.1, "{off:?}");
        }
    }
    assert!(offered.next().is_none() && told > 50, "{told} benefits");
    assert!(
        samples
            .iter()
            .flat_map(|sample| match sample.outlet {
                LslOutlet::Beliefs => numbers(sample).to_vec(),
                _ => Vec::new(),
            })
            .all(|p| (0.0..=1.0).contains(&p))
    );
}

#[test]
fn streams_are_named_after_the_participant_and_described_with_the_layout() {
    let kitchen = session_file("default").kitchen.kitchen;
    let streams = describe(&spec(LslOutlet::VARIANTS), &kitchen);
    let names: Vec<&str> = streams.iter().map(|stream| stream.name.as_str()).collect();
    assert_eq!(names[..2], ["tomcom-markers-P07", "tomcom-events-P07"]);
    let counts: Vec<usize> = streams.iter().map(|stream| stream.channels.len()).collect();
    assert_eq!(counts, [1, 1, 4, kitchen.aspects.len(), counts[4], 3, 6]);
    for stream in &streams {
        assert!(stream.source.starts_with("tomcom-P07-"), "{}", stream.source);
        let metadata = stream.metadata();
        let channels = &metadata[0];
        assert_eq!((channels.name, channels.inside.len()), ("channels", stream.channels.len()));
        let layout = metadata.iter().find(|node| node.name == "layout").expect("the layout");
        let locations = layout.inside.iter().find(|node| node.name == "locations").expect("locations");
        assert_eq!(locations.inside.len(), kitchen.locations.len());
        assert!(stream.is_text || stream.channels.iter().all(|channel| !channel.unit.is_empty()));
    }
    let (samples, _, _) = sent("format-3-simulated", &[LslOutlet::Gaze]);
    assert!(!samples.is_empty() && samples.iter().all(|sample| sample.outlet == LslOutlet::Gaze));
    let mut session =
        LogReader::open(Path::new("tests/golden/format-3-simulated.jsonl")).expect("a recording").session();
    session.spec.lsl = spec(&[LslOutlet::Markers]).lsl;
    let opening = LslSampleConverter::new(&session, RECORDING).opening(&session, session.time);
    assert_eq!(
        opening.iter().map(|sample| texts(sample)[0].as_str()).collect::<Vec<_>>(),
        [format!("recording/{RECORDING}")]
    );
}

#[test]
fn gaze_of_every_unit_and_origin_is_a_fraction_of_the_display() {
    let stream = |unit, origin, size| LslGazeSpec {
        name: Some("tracker".to_string()),
        content: None,
        source_id: None,
        host: None,
        x: "x".to_string(),
        y: "y".to_string(),
        confidence: None,
        unit,
        origin,
        size,
    };
    let display_m = [2.0, 1.0];
    let cases = [
        (GazeUnit::Normalised, GazeOrigin::TopLeft, None, [0.25, 0.75]),
        (GazeUnit::Normalised, GazeOrigin::BottomLeft, None, [0.25, 0.25]),
        (GazeUnit::Normalised, GazeOrigin::Centre, Some([2.0, 2.0]), [-0.5, -0.5]),
        (GazeUnit::Pixels, GazeOrigin::TopLeft, Some([1920.0, 1080.0]), [480.0, 810.0]),
        (GazeUnit::Metres, GazeOrigin::Centre, None, [-0.5, -0.25]),
        (GazeUnit::Metres, GazeOrigin::TopLeft, Some([4.0, 2.0]), [1.0, 1.5]),
    ];
    for (unit, origin, size, point) in cases {
        assert_eq!(stream(unit, origin, size).to_display(point, display_m), [0.25, 0.75], "{unit:?} {origin:?}");
    }
}

#[test]
fn a_library_that_is_missing_or_another_one_is_named_with_a_remedy() {
    let library = |path: &str| LslSpec { library: Some(path.to_string()), ..LslSpec::default() };
    let missing = load(Some(&library("/nowhere/liblsl.so"))).expect_err("no library");
    assert!(matches!(&missing, LslError::Missing(reason) if reason.contains("/nowhere/liblsl.so")), "{missing}");
    assert!(missing.remedy().contains("pip install pylsl"));
    let none = load(Some(&library("Cargo.toml"))).expect_err("no library");
    assert!(matches!(none, LslError::Missing(_)), "{none}");
    #[cfg(target_os = "linux")]
    {
        let maps = fs::read_to_string("/proc/self/maps").expect("the libraries of this process");
        let mut paths = maps.lines().filter_map(|line| Some(&line[line.find('/')?..]));
        let libc = paths.find(|path| path.contains("libc.so") || path.contains("libc-")).expect("the C library");
        let other = load(Some(&library(libc))).expect_err("another library");
        assert!(other.to_string().contains("is no liblsl") && other.to_string().contains("it lacks lsl_"), "{other}");
    }
}
