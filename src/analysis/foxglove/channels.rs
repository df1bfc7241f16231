//! Channels of messages in an export to MCAP files.

use serde_json::Value;

use super::schemas;

/// Channel of messages in an MCAP file.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum MessageChannel {
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

impl MessageChannel {
    /// All channels of an MCAP file, in their order.
    pub const ALL: [MessageChannel; 7] = [
        MessageChannel::Joints,
        MessageChannel::Frames,
        MessageChannel::Arm,
        MessageChannel::Log,
        MessageChannel::Events,
        MessageChannel::Gaze,
        MessageChannel::Beliefs,
    ];

    /// Name of the channel, called its topic.
    pub fn topic(self) -> &'static str {
        match self {
            MessageChannel::Joints => "/robot/joints",
            MessageChannel::Frames => "/tf",
            MessageChannel::Arm => "/robot/arm",
            MessageChannel::Log => "/log",
            MessageChannel::Events => "/events",
            MessageChannel::Gaze => "/gaze",
            MessageChannel::Beliefs => "/beliefs",
        }
    }

    /// Name of the type of the channel's messages.
    pub fn schema_name(self) -> &'static str {
        match self {
            MessageChannel::Joints => "foxglove.JointStates",
            MessageChannel::Frames => "foxglove.FrameTransforms",
            MessageChannel::Arm => "tomcom.Arm",
            MessageChannel::Log => "foxglove.Log",
            MessageChannel::Events => "tomcom.Event",
            MessageChannel::Gaze => "tomcom.Gaze",
            MessageChannel::Beliefs => "tomcom.Beliefs",
        }
    }

    /// JSON Schema of the channel's messages.
    pub fn schema(self) -> Value {
        let mut schema = match self {
            MessageChannel::Joints => schemas::joints(),
            MessageChannel::Frames => schemas::frames(),
            MessageChannel::Arm => schemas::arm(),
            MessageChannel::Log => schemas::log(),
            MessageChannel::Events => schemas::event(),
            MessageChannel::Gaze => schemas::gaze(),
            MessageChannel::Beliefs => schemas::beliefs(),
        };
        schema["title"] = self.schema_name().into();
        schema
    }
}
