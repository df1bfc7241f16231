//! JSON Schemas of the messages. The messages for joints, frames and log are Foxglove's types of these names, with the
//! fields that are used.

use serde_json::{Value, json};

/// JSON Schema of a time, as Foxglove writes times in JSON.
fn time(description: &str) -> Value {
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

pub(super) fn joints() -> Value {
    let joint = json!({ "name": text("Name of the joint"), "position": number("Angle in radians") });
    let mut joint = object("The state of a single joint", joint, &[]);
    joint["title"] = "foxglove.JointState".into();
    let fields =
        json!({ "timestamp": time("Session time"), "joints": list("The joints of the arm, from the base on", joint) });
    object("The joints of the robot's arm", fields, &[])
}

pub(super) fn frames() -> Value {
    let frame = json!({
        "timestamp": time("Session time"),
        "parent_frame_id": text("The frame of the arm's base"),
        "child_frame_id": text("Name of the link, or hand for the middle of the participant's hand"),
        "translation": vector("foxglove.Vector3", &["x", "y", "z"], "Place in metres"),
        "rotation": vector("foxglove.Quaternion", &["x", "y", "z", "w"], "Orientation"),
    });
    let mut frame = object("A frame in another one", frame, &[]);
    frame["title"] = "foxglove.FrameTransform".into();
    object("Frames of the arm's links and of the hand", json!({ "transforms": list("The frames", frame) }), &[])
}

pub(super) fn log() -> Value {
    let level = json!({
        "title": "foxglove.LogLevel",
        "description": "2: information; 3, warning: an error of the participant, or something that went wrong",
        "oneOf": [
            { "title": "UNKNOWN", "const": 0 },
            { "title": "DEBUG", "const": 1 },
            { "title": "INFO", "const": 2 },
            { "title": "WARNING", "const": 3 },
            { "title": "ERROR", "const": 4 },
            { "title": "FATAL", "const": 5 },
        ],
    });
    let fields = json!({
        "timestamp": time("Session time"),
        "level": level,
        "message": text("What happened, with the time on the trial's clock"),
        "name": text("Kind of the event"),
        "file": text("The log"),
        "line": whole("Number of the event in the log"),
    });
    object("The recording in words", fields, &[])
}

pub(super) fn arm() -> Value {
    let fields = json!({
        "timestamp": time("Session time"),
        "phase": text("What the arm does: rests, retracts, travels, hovers, presses"),
        "force_n": number("The greatest contact force in newtons since the message before"),
        "hand_away_m": number("Distance of the participant's hand from the arm, in metres"),
    });
    object("The arm's work beside the joints", fields, &[])
}

pub(super) fn event() -> Value {
    let fields = json!({
        "timestamp": time("Session time"),
        "seq": whole("Number of the event in the log, from 0"),
        "kind": text("Kind of the event"),
        "event": { "type": "object", "description": "All further fields of the event, as the log has them" },
    });
    object("An event of the session's log", fields, &[])
}

pub(super) fn gaze() -> Value {
    let fields = json!({
        "timestamp": time("Session time at which the sample was taken; when it arrived, where the tracker tells no time"),
        "seq": whole("Number of the sample in the log"),
        "x": number("Fraction of the display's width, from its left edge; as recorded"),
        "y": number("Fraction of the display's height, from its upper edge; as recorded"),
        "confidence": number("The tracker's confidence, 0 to 1"),
        "device_ns": whole("Time on the tracker's own clock, in nanoseconds"),
    });
    object("A gaze sample on the participant's display", fields, &["device_ns"])
}

pub(super) fn beliefs() -> Value {
    let value = json!({ "value": text("The value"), "p": number("Its probability") });
    let aspect = json!({
        "aspect": text("A place of the kitchen, or the recipe of a dish"),
        "believes": text("The likeliest value"),
        "p_truth": number("Probability of the true value"),
        "precision": number("Estimates: the sum of the parameters of the Dirichlet distribution"),
        "values": list("Every value with at least 1 %", object("A value", value, &[])),
    });
    let fields = json!({
        "timestamp": time("Session time"),
        "seq": whole("Number of the event in the log"),
        "source": text("participant: what a simulated participant believed; estimate: the estimate"),
        "press": whole("Number of the press that an estimate belongs to"),
        "aspects": list("What is believed", object("The belief about one aspect", aspect, &["precision"])),
    });
    object("Beliefs about the kitchen before a press of the participant", fields, &["press"])
}
