//! Channels of messages in an export to MCAP files.

use serde_json::Value;

use super::schemas;

/// Channel of messages in an MCAP file.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum McapChannel {
    /// Joint angles of the arm.
    Joints,
    /// Poses of the arm's links and of the participant's hand.
    Frames,
    /// Force on the arm, distance of the participant's hand, and what the arm does.
    Arm,
    /// Events of the recording in words.
    Log,
    /// Events as in the log, without gaze and arm samples.
    Events,
    /// Gaze samples.
    Gaze,
    /// Beliefs of simulated participants, and the assistant's estimates.
    Beliefs,
}

impl McapChannel {
    /// All channels of an MCAP file, in their order.
    pub const ALL: [McapChannel; 7] = [
        McapChannel::Joints,
        McapChannel::Frames,
        McapChannel::Arm,
        McapChannel::Log,
        McapChannel::Events,
        McapChannel::Gaze,
        McapChannel::Beliefs,
    ];

    /// Name of the channel, called its topic.
    pub fn topic(self) -> &'static str {
        match self {
            McapChannel::Joints => "/robot/joints",
            McapChannel::Frames => "/tf",
            McapChannel::Arm => "/robot/arm",
            McapChannel::Log => "/log",
            McapChannel::Events => "/events",
            McapChannel::Gaze => "/gaze",
            McapChannel::Beliefs => "/beliefs",
        }
    }

    /// Name of the type of the channel's messages.
    pub fn schema_name(self) -> &'static str {
        match self {
            McapChannel::Joints => "foxglove.JointStates",
            McapChannel::Frames => "foxglove.FrameTransforms",
            McapChannel::Arm => "tomcom.Arm",
            McapChannel::Log => "foxglove.Log",
            McapChannel::Events => "tomcom.Event",
            McapChannel::Gaze => "tomcom.Gaze",
            McapChannel::Beliefs => "tomcom.Beliefs",
        }
    }

    /// JSON Schema of the channel's messages.
    pub fn schema(self) -> Value {
        let mut schema = match self {
            McapChannel::Joints => schemas::joints(),
            McapChannel::Frames => schemas::frames(),
            McapChannel::Arm => schemas::arm(),
            McapChannel::Log => schemas::log(),
            McapChannel::Events => schemas::event(),
            McapChannel::Gaze => schemas::gaze(),
            McapChannel::Beliefs => schemas::beliefs(),
        };
        schema["title"] = self.schema_name().into();
        schema
    }
}
