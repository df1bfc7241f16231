//! A session as streams of the Lab Streaming Layer (LSL): name, channels, metadata and samples of each stream. Sending
//! the samples is left to the caller.

mod marker_text;
mod stream_description;
mod stream_samples;

pub use self::marker_text::{code, event_text};
pub use self::stream_description::{MetadataNode, SOURCE, StreamChannel, StreamDescription, describe};
pub use self::stream_samples::{LslSampleConverter, LslSampleValues, StreamSample};
