//! Recordings as MCAP: every event is a message, at its session time, as its schema says.

use mcap::MessageStream;
use tomcom_arm::kinematics::UR5;
use tomcom_core::robot::JOINT_NAMES;
use tomcom_study::analysis::foxglove::McapChannel;
use tomcom_study::mcap_export::export;

use crate::support::*;

/// A golden recording in a folder of its own.
fn golden(name: &str, test: &str) -> PathBuf {
    let folder = empty_folder(Path::new("mcap").join(test).join(name));
    fs::copy(format!("tests/golden/{name}.jsonl"), folder.join("events.jsonl")).expect("a golden recording");
    folder
}

/// The messages of a file: their topic, session time and content.
fn messages(file: &Path) -> Vec<(String, u64, Value)> {
    let bytes = fs::read(file).expect("an MCAP");
    let stream = MessageStream::new(&bytes).expect("an MCAP");
    let read = stream.map(|message| {
        let message = message.expect("a message");
        let content: Value = serde_json::from_slice(&message.data).expect("JSON");
        let schema = message.channel.schema.as_ref().expect("a schema");
        assert_eq!((message.channel.message_encoding.as_str(), schema.encoding.as_str()), ("json", "jsonschema"));
        (message.channel.topic.clone(), message.log_time, content)
    });
    read.collect()
}

/// Whether a value has the types and required fields of a schema of this program.
fn fits(schema: &Value, value: &Value) -> bool {
    let is_of_type = match schema["type"].as_str() {
        Some("object") => value.is_object(),
        Some("array") => value.is_array(),
        Some("string") => value.is_string(),
        Some("number") => value.is_number(),
        Some("integer") => value.is_u64() || value.is_i64(),
        _ => true,
    };
    let has_fields = schema["required"].as_array().into_iter().flatten().all(|name| {
        let name = name.as_str().expect("a name");
        value.get(name).is_some()
    });
    let known = schema["properties"].as_object();
    let fields_fit = value.as_object().into_iter().flatten().all(|(name, field)| match known {
        Some(known) => known.get(name).is_some_and(|schema| fits(schema, field)),
        None => true,
    });
    let items_fit = value.as_array().into_iter().flatten().all(|item| fits(&schema["items"], item));
    is_of_type && has_fields && fields_fit && items_fit
}

#[test]
fn every_event_is_a_message_at_its_session_time_and_as_its_schema_says() {
    let schemas: BTreeMap<&str, Value> =
        McapChannel::ALL.into_iter().map(|channel| (channel.topic, channel.schema())).collect();
    for name in ["format-3-hand", "format-3-simulated", "format-3-offers"] {
        let folder = golden(name, "messages");
        let text = fs::read_to_string(folder.join("events.jsonl")).expect("the log");
        let events: Vec<Value> =
            text.lines().skip(1).map(|line| serde_json::from_str(line).expect("an event")).collect();
        let told = export(&folder).expect("it is exported");
        assert_eq!(told.file.0, folder.join("recording.mcap"));
        let mut numbers = Vec::new();
        for (topic, time, content) in messages(&told.file) {
            assert!(fits(&schemas[topic.as_str()], &content), "{topic}: {content}");
            if topic != "/events" && topic != "/gaze" {
                continue;
            }
            let seq = content["seq"].as_u64().expect("a number");
            assert_eq!(events[seq as usize]["t_ns"], time);
            for (key, value) in content["event"].as_object().into_iter().flatten() {
                assert_eq!(&events[seq as usize][key], value, "{name} {seq}: {key}");
            }
            numbers.push(seq);
        }
        numbers.sort_unstable();
        assert_eq!(numbers, (0..events.len() as u64).collect::<Vec<u64>>(), "{name}");
        let believed = events
            .iter()
            .filter(|event| event["kind"] == "participant_believes" || event["kind"] == "belief_estimated");
        assert_eq!(told.messages["/beliefs"] as usize, believed.count(), "{name}");
    }
}

#[test]
fn a_file_of_somebody_else_is_left_and_an_own_one_replaced() {
    let folder = golden("format-3-simulated", "replaced");
    let file = folder.join("recording.mcap");
    fs::write(&file, "not ours").expect("written");
    let error = export(&folder).expect_err("refused").to_string();
    assert!(error.contains("not an MCAP of tomcom"), "{error}");
    assert_eq!(fs::read(&file).expect("left"), b"not ours");
    fs::remove_file(&file).expect("removed");
    export(&folder).expect("exported");
    let first = messages(&file);
    export(&folder).expect("exported again");
    // Not byte by byte: the crate lists the channels once more at the file's end, in an order of chance.
    assert!(!first.is_empty() && messages(&file) == first, "the same log gives the same messages");
    let entries = std::fs::read_dir(&folder).expect("a folder").flatten();
    let begun = entries.filter(|entry| entry.file_name().to_string_lossy().ends_with(".new"));
    assert_eq!(begun.count(), 0, "nothing half is left");
    let error = export(Path::new("tests/golden/format-3-simulated.jsonl")).expect_err("no folder").to_string();
    assert!(error.contains("a log that is not called events.jsonl"), "{error}");
}

#[test]
fn joints_have_the_names_of_the_arms_urdf() {
    let joints = UR5.split("<joint name=\"").skip(1).filter(|joint| joint.contains("type=\"revolute\""));
    let names: Vec<&str> = joints.filter_map(|joint| joint.split('"').next()).collect();
    assert_eq!(names, JOINT_NAMES);
    assert!(UR5.contains("<link name=\"base_link\""));
}
