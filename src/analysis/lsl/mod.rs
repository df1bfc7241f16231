//! A session as streams of the Lab Streaming Layer (LSL): the name, channels and metadata of each stream, and its samples. How they are
//! sent does not concern this module.

mod marker_text;
mod stream_description;
mod stream_samples;

pub use self::marker_text::{code, event_text};
pub use self::stream_description::{MetadataNode, SOURCE, StreamChannel, StreamDescription, describe};
pub use self::stream_samples::{SampleMaker, SampleValues, StreamSample};
