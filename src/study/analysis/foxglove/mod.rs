//! Recordings as messages on channels, which robotics tools such as Foxglove read from MCAP files: joints, frames and
//! log in Foxglove's own types; gaze, beliefs and events in types of this program. All messages are JSON, and each type
//! has a JSON Schema.

mod channels;
mod messages;
mod schemas;

pub use self::channels::McapChannel;
pub use self::messages::{McapMessage, McapMessageConverter};
