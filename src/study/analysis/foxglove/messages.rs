//! Messages for MCAP files into which the events of a log are converted.

use std::collections::BTreeMap;

use serde_json::{Map, Value, json};

use super::channels::McapChannel;
use crate::analysis::event_lines;
use tomcom_arm::kinematics::SerialArm;
use tomcom_core::base::time::SessionTime;
use tomcom_core::robot::{ArmSample, JOINT_NAMES};
use tomcom_session::TimestampedEvent;
use tomcom_session::event::Event;
use tomcom_session::follower::SessionFollower;

/// Name of the coordinate frame of the arm's base.
const BASE: &str = "base_link";
/// Severity "information" in Foxglove's message type `Log`.
const INFO: u8 = 2;
const WARNING: u8 = 3;

/// A message on a channel of an MCAP file.
#[derive(Clone, Debug, PartialEq)]
pub struct McapMessage {
    /// Channel of the MCAP file to which the message is written.
    pub channel: McapChannel,
    /// Session time at which the event was recorded.
    pub logged: SessionTime,
    /// Session time of what the message reports; for gaze, the time at which the sample was taken.
    pub published: SessionTime,
    /// Content of the message, as JSON.
    pub content: Value,
}

/// Converts the events of a session into messages of an MCAP file.
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
    /// The messages for an event that was just applied.
    pub fn messages(&self, stamped: &TimestampedEvent, follower: &SessionFollower) -> Vec<McapMessage> {
        let now = stamped.time;
        let message = |channel, content| McapMessage { channel, logged: now, published: now, content };
        match &stamped.event {
            Event::Gaze(sample) => {
                let taken = sample.taken_ns.unwrap_or(now);
                let mut content = json!({
                    "timestamp": time(taken), "seq": stamped.seq, "x": sample.x, "y": sample.y, "confidence": sample.confidence,
                });
                if let Some(device_ns) = sample.device_ns {
                    content["device_ns"] = json!(device_ns);
                }
                let logged = message(McapChannel::Gaze, content);
                vec![McapMessage { published: taken, ..logged }]
            }
            Event::RobotMoves(sample) => {
                self.moves(now, sample).map(|(channel, content)| message(channel, content)).into()
            }
            _ => {
                let mut all = vec![message(McapChannel::Events, event(stamped))];
                all.extend(beliefs(stamped).map(|content| message(McapChannel::Beliefs, content)));
                all.extend(words(stamped, follower).map(|content| message(McapChannel::Log, content)));
                all
            }
        }
    }

    /// The messages for an arm sample: joint angles, coordinate frames, and what the arm does.
    fn moves(&self, now: SessionTime, sample: &ArmSample) -> [(McapChannel, Value); 3] {
        let joint = |(name, angle): (&&str, &f64)| json!({ "name": name, "position": angle });
        let joints: Vec<Value> = JOINT_NAMES.iter().zip(&sample.joints).map(joint).collect();
        let links = self.arm.links.iter().zip(self.arm.forward(&sample.joints)).skip(1);
        let mut frames: Vec<Value> = links
            .map(|(link, place)| {
                let (at, turned) = (place.translation.vector, place.rotation);
                frame(now, &link.name, [at.x, at.y, at.z], [turned.i, turned.j, turned.k, turned.w])
            })
            .collect();
        frames.push(frame(now, "hand", sample.hand_m, [0.0, 0.0, 0.0, 1.0]));
        let arm = json!({
            "timestamp": time(now), "phase": sample.phase, "force_n": sample.force_n, "hand_away_m": sample.hand_away_m,
        });
        [
            (McapChannel::Joints, json!({ "timestamp": time(now), "joints": joints })),
            (McapChannel::Frames, json!({ "transforms": frames })),
            (McapChannel::Arm, arm),
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

/// The message that contains an event as in the log.
fn event(stamped: &TimestampedEvent) -> Value {
    let mut fields = match serde_json::to_value(&stamped.event) {
        Ok(Value::Object(fields)) => fields,
        _ => Map::new(),
    };
    fields.remove("kind");
    json!({ "timestamp": time(stamped.time), "seq": stamped.seq, "kind": stamped.event.kind(), "event": fields })
}

/// The message about beliefs; `None` unless the event is one of the two kinds that record beliefs.
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

/// The message that says in words what the event is; `None` for events without words.
fn words(stamped: &TimestampedEvent, follower: &SessionFollower) -> Option<Value> {
    let line = event_lines::line(stamped, follower)?;
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
