//! The channels of an export.

use serde_json::Value;

use super::schemas;

/// A channel of messages.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum MessageChannel {
    /// Joint angles of the arm.
    Joints,
    /// Poses of the arm's links and of the participant's hand.
    Frames,
    /// Force on the arm, distance of the hand, what the arm does.
    Arm,
    /// The recording in words.
    Log,
    /// Events as the log has them, but samples.
    Events,
    /// Gaze samples.
    Gaze,
    /// Beliefs: those of simulated participants, and estimates.
    Beliefs,
}

impl MessageChannel {
    /// All channels, in their order.
    pub const ALL: [MessageChannel; 7] = [
        MessageChannel::Joints,
        MessageChannel::Frames,
        MessageChannel::Arm,
        MessageChannel::Log,
        MessageChannel::Events,
        MessageChannel::Gaze,
        MessageChannel::Beliefs,
    ];

    /// Name of the channel.
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

    /// Name of its type.
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

    /// The JSON Schema of its type.
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
