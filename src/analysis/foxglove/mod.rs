//! Recordings as messages on channels, as robotics tools read them: joints, frames and log in Foxglove's well-known types, gaze, beliefs
//! and events in types of this program. All are JSON, and each has its JSON Schema.

mod channels;
mod messages;
mod schemas;

pub use self::channels::MessageChannel;
pub use self::messages::{ChannelMessage, MessageMaker};
