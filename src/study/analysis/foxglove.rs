//! Recordings as messages on channels, which robotics tools such as Foxglove read from MCAP files: joints, frames and
//! log in Foxglove's own types; gaze, beliefs and events in types of this program. All messages are JSON, and each type
//! has a JSON Schema.

use std::collections::BTreeMap;

use serde_json::{Map, Value, json};

use tomcom_arm::kinematics::SerialArm;
use tomcom_core::base::time::SessionTime;
use tomcom_core::robot::{ArmSample, JOINT_NAMES};
use tomcom_session::TimestampedEvent;
use tomcom_session::event::Event;
use tomcom_session::follower::SessionFollower;
use tomcom_session::history::event_words;

/// A channel of an MCAP file: its topic, the name of the type of its messages, and the JSON Schema of that type without title.
pub struct McapChannel {
    pub topic: &'static str,
    pub schema_name: &'static str,
    untitled: fn() -> Value,
}

const JOINTS: &str = "/robot/joints";
const FRAMES: &str = "/tf";
const ARM: &str = "/robot/arm";
const LOG: &str = "/log";
/// As in the log, without gaze and arm samples.
const EVENTS: &str = "/events";
const GAZE: &str = "/gaze";
const BELIEFS: &str = "/beliefs";

impl McapChannel {
    pub const ALL: [McapChannel; 7] = [
        McapChannel { topic: JOINTS, schema_name: "foxglove.JointStates", untitled: joints_schema },
        McapChannel { topic: FRAMES, schema_name: "foxglove.FrameTransforms", untitled: frames_schema },
        McapChannel { topic: ARM, schema_name: "tomcom.Arm", untitled: arm_schema },
        McapChannel { topic: LOG, schema_name: "foxglove.Log", untitled: log_schema },
        McapChannel { topic: EVENTS, schema_name: "tomcom.Event", untitled: event_schema },
        McapChannel { topic: GAZE, schema_name: "tomcom.Gaze", untitled: gaze_schema },
        McapChannel { topic: BELIEFS, schema_name: "tomcom.Beliefs", untitled: beliefs_schema },
    ];

    pub fn schema(&self) -> Value {
        let mut schema = (self.untitled)();
        schema["title"] = self.schema_name.into();
        schema
    }
}

const BASE: &str = "base_link";
/// Severity "information" in Foxglove's message type `Log`.
const INFO: u8 = 2;
const WARNING: u8 = 3;

#[derive(Clone, Debug, PartialEq)]
pub struct McapMessage {
    pub topic: &'static str,
    pub logged: SessionTime,
    pub published: SessionTime,
    pub content: Value,
}

#[derive(Debug)]
pub struct McapMessageConverter {
    arm: SerialArm,
}

impl Default for McapMessageConverter {
    fn default() -> McapMessageConverter {
        McapMessageConverter { arm: SerialArm::ur5() }
    }
}

impl McapMessageConverter {
    pub fn messages(&self, stamped: &TimestampedEvent, follower: &SessionFollower) -> Vec<McapMessage> {
        let now = stamped.time;
        let message = |topic, content| McapMessage { topic, logged: now, published: now, content };
        match &stamped.event {
            Event::Gaze(sample) => {
                let taken = sample.taken_ns.unwrap_or(now);
                let mut content = json!({
                    "timestamp": time(taken), "seq": stamped.seq, "x": sample.x, "y": sample.y, "confidence": sample.confidence,
                });
                if let Some(device_ns) = sample.device_ns {
                    content["device_ns"] = json!(device_ns);
                }
                let logged = message(GAZE, content);
                vec![McapMessage { published: taken, ..logged }]
            }
            Event::RobotMoves(sample) => self.moves(now, sample).map(|(topic, content)| message(topic, content)).into(),
            _ => {
                let mut all = vec![message(EVENTS, event(stamped))];
                all.extend(beliefs(stamped).map(|content| message(BELIEFS, content)));
                all.extend(words(stamped, follower).map(|content| message(LOG, content)));
                all
            }
        }
    }

    fn moves(&self, now: SessionTime, sample: &ArmSample) -> [(&'static str, Value); 3] {
        let joint = |(name, angle): (&&str, &f64)| json!({ "name": name, "position": angle });
        let joints: Vec<Value> = JOINT_NAMES.iter().zip(&sample.joints).map(joint).collect();
        let links = self.arm.links.iter().zip(self.arm.forward(&sample.joints)).skip(1);
        let mut frames: Vec<Value> = links
            .map(|(link, place)| {
                let (at, turned) = (place.translation.vector, place.rotation);
                frame(now, &link.name, [at.x, at.y, at.z], [turned.i, turned.j, turned.k, turned.w])
            })
            .collect();
        frames.extend(sample.hand_m.map(|hand_m| frame(now, "hand", hand_m, [0.0, 0.0, 0.0, 1.0])));
        let mut arm = json!({ "timestamp": time(now), "phase": sample.phase, "force_n": sample.force_n });
        if let Some(away_m) = sample.hand_away_m {
            arm["hand_away_m"] = json!(away_m);
        }
        [
            (JOINTS, json!({ "timestamp": time(now), "joints": joints })),
            (FRAMES, json!({ "transforms": frames })),
            (ARM, arm),
        ]
    }
}

fn frame(now: SessionTime, name: &str, [x, y, z]: [f64; 3], [i, j, k, w]: [f64; 4]) -> Value {
    json!({
        "timestamp": time(now),
        "parent_frame_id": BASE,
        "child_frame_id": name,
        "translation": { "x": x, "y": y, "z": z },
        "rotation": { "x": i, "y": j, "z": k, "w": w },
    })
}

fn time(time: SessionTime) -> Value {
    json!({ "sec": time.0 / 1_000_000_000, "nsec": time.0 % 1_000_000_000 })
}

fn event(stamped: &TimestampedEvent) -> Value {
    let mut fields = match serde_json::to_value(&stamped.event) {
        Ok(Value::Object(fields)) => fields,
        _ => Map::new(),
    };
    fields.remove("kind");
    json!({ "timestamp": time(stamped.time), "seq": stamped.seq, "kind": stamped.event.kind(), "event": fields })
}

fn beliefs(stamped: &TimestampedEvent) -> Option<Value> {
    let values = |values: &BTreeMap<String, f64>| -> Vec<Value> {
        values.iter().map(|(value, p)| json!({ "value": value, "p": p })).collect()
    };
    let (source, press, aspects): (&str, Option<u64>, Vec<Value>) = match &stamped.event {
        Event::ParticipantBelieves(belief) => {
            let about = belief.aspects.iter().map(|about| {
                json!({
                    "aspect": about.aspect, "believes": about.believes, "p_truth": about.p_truth, "values": values(&about.values),
                })
            });
            ("participant", None, about.collect())
        }
        Event::BeliefEstimated(estimate) => {
            let about = estimate.aspects.iter().map(|about| {
                json!({
                    "aspect": about.aspect, "believes": about.believes, "p_truth": about.p_truth, "precision": about.precision,
                    "values": values(&about.values),
                })
            });
            ("estimate", Some(estimate.press), about.collect())
        }
        _ => return None,
    };
    let mut content =
        json!({ "timestamp": time(stamped.time), "seq": stamped.seq, "source": source, "aspects": aspects });
    if let Some(press) = press {
        content["press"] = json!(press);
    }
    Some(content)
}

fn words(stamped: &TimestampedEvent, follower: &SessionFollower) -> Option<Value> {
    let line = event_words::line(stamped, follower)?;
    let is_error = || follower.judged.last().is_some_and(|press| press.seq == stamped.seq && press.verdict.error);
    let level = match &stamped.event {
        Event::Press { .. } if is_error() => WARNING,
        Event::TrialAborted { .. } | Event::RobotTouched { .. } | Event::ClockJumped { .. } | Event::FocusLost => {
            WARNING
        }
        _ => INFO,
    };
    Some(json!({
        "timestamp": time(stamped.time),
        "level": level,
        "message": line.trim(),
        "name": stamped.event.kind(),
        "file": "events.jsonl",
        "line": stamped.seq,
    }))
}

// JSON Schemas of the messages. Those for joints, frames and log are Foxglove's types, with the fields that are used.

fn time_schema(description: &str) -> Value {
    json!({
        "type": "object",
        "title": "time",
        "description": description,
        "properties": {
            "sec": { "type": "integer", "minimum": 0 },
            "nsec": { "type": "integer", "minimum": 0, "maximum": 999_999_999 },
        },
    })
}

fn number(description: &str) -> Value {
    json!({ "type": "number", "description": description })
}

fn text(description: &str) -> Value {
    json!({ "type": "string", "description": description })
}

fn whole(description: &str) -> Value {
    json!({ "type": "integer", "description": description })
}

/// JSON Schema of an object; its fields are required unless `optional` names them.
fn object(description: &str, properties: Value, optional: &[&str]) -> Value {
    let fields = properties.as_object().into_iter().flatten().map(|(name, _)| name.as_str());
    let required: Vec<&str> = fields.filter(|name| !optional.contains(name)).collect();
    json!({ "type": "object", "description": description, "properties": properties, "required": required })
}

fn list(description: &str, items: Value) -> Value {
    json!({ "type": "array", "description": description, "items": items })
}

fn vector(title: &str, axes: &[&str], description: &str) -> Value {
    let fields: serde_json::Map<String, Value> = axes.iter().map(|axis| ((*axis).to_string(), number(axis))).collect();
    let mut found = object(description, fields.into(), &[]);
    found["title"] = title.into();
    found
}

fn joints_schema() -> Value {
    let joint = json!({ "name": text("Name of the joint"), "position": number("Angle in radians") });
    let mut joint = object("The state of a single joint", joint, &[]);
    joint["title"] = "foxglove.JointState".into();
    let fields = json!({ "timestamp": time_schema("Session time"), "joints": list("The joints of the arm, from the base on", joint) });
    object("The joints of the robot's arm", fields, &[])
}

fn frames_schema() -> Value {
    let frame = json!({
        "timestamp": time_schema("Session time"),
        "parent_frame_id": text("The frame of the arm's base"),
        "child_frame_id": text("Name of the link, or hand for the middle of the participant's hand"),
        "translation": vector("foxglove.Vector3", &["x", "y", "z"], "Place in metres"),
        "rotation": vector("foxglove.Quaternion", &["x", "y", "z", "w"], "Orientation"),
    });
    let mut frame = object("A frame in another one", frame, &[]);
    frame["title"] = "foxglove.FrameTransform".into();
    object("Frames of the arm's links and of the hand", json!({ "transforms": list("The frames", frame) }), &[])
}

fn log_schema() -> Value {
    let levels = ["UNKNOWN", "DEBUG", "INFO", "WARNING", "ERROR", "FATAL"].into_iter().enumerate();
    let levels: Vec<Value> = levels.map(|(level, title)| json!({ "title": title, "const": level })).collect();
    let level = json!({
        "title": "foxglove.LogLevel",
        "description": "2: information; 3, warning: an error of the participant, or something that went wrong",
        "oneOf": levels,
    });
    let fields = json!({
        "timestamp": time_schema("Session time"),
        "level": level,
        "message": text("What happened, with the time on the trial's clock"),
        "name": text("Kind of the event"),
        "file": text("The log"),
        "line": whole("Number of the event in the log"),
    });
    object("The recording in words", fields, &[])
}

fn arm_schema() -> Value {
    let fields = json!({
        "timestamp": time_schema("Session time"),
        "phase": text("What the arm does: rests, retracts, travels, hovers, presses"),
        "force_n": number("The greatest contact force in newtons since the message before"),
        "hand_away_m": number("Distance of the participant's hand from the arm, in metres"),
    });
    object("The arm's work beside the joints", fields, &[])
}

fn event_schema() -> Value {
    let fields = json!({
        "timestamp": time_schema("Session time"),
        "seq": whole("Number of the event in the log, from 0"),
        "kind": text("Kind of the event"),
        "event": { "type": "object", "description": "All further fields of the event, as the log has them" },
    });
    object("An event of the session's log", fields, &[])
}

fn gaze_schema() -> Value {
    let fields = json!({
        "timestamp": time_schema("Session time at which the sample was taken; when it arrived, where the tracker tells no time"),
        "seq": whole("Number of the sample in the log"),
        "x": number("Fraction of the display's width, from its left edge; as recorded"),
        "y": number("Fraction of the display's height, from its upper edge; as recorded"),
        "confidence": number("The tracker's confidence, 0 to 1"),
        "device_ns": whole("Time on the tracker's own clock, in nanoseconds"),
    });
    object("A gaze sample on the participant's display", fields, &["device_ns"])
}

fn beliefs_schema() -> Value {
    let value = json!({ "value": text("The value"), "p": number("Its probability") });
    let aspect = json!({
        "aspect": text("A place of the kitchen, or the recipe of a dish"),
        "believes": text("The likeliest value"),
        "p_truth": number("Probability of the true value"),
        "precision": number("Estimates: the sum of the parameters of the Dirichlet distribution"),
        "values": list("Every value with at least 1 %", object("A value", value, &[])),
    });
    let fields = json!({
        "timestamp": time_schema("Session time"),
        "seq": whole("Number of the event in the log"),
        "source": text("participant: what a simulated participant believed; estimate: the estimate"),
        "press": whole("Number of the press that an estimate belongs to"),
        "aspects": list("What is believed", object("The belief about one aspect", aspect, &["precision"])),
    });
    object("Beliefs about the kitchen before a press of the participant", fields, &["press"])
}
