//! Channels of messages in an export to MCAP files.

use serde_json::Value;

use super::schemas;

/// Channel of messages in an MCAP file (a recording format of robotics tools).
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum McapChannel {
    /// Channel of the joint angles of the robot's arm.
    Joints,
    /// Channel of the poses of the arm's links and of the participant's hand.
    Frames,
    /// Channel of the force on the arm, the distance of the participant's hand, and what the arm does.
    Arm,
    /// Channel of the recording's events in words.
    Log,
    /// Channel of the events as in the log, without gaze and arm samples.
    Events,
    /// Channel of the gaze samples.
    Gaze,
    /// Channel of the beliefs of simulated participants, and of the assistant's estimates.
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

    /// Name (topic) of the channel in an MCAP file.
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
