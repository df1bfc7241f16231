//! The Lab Streaming Layer (LSL): its library is loaded when a session asks for LSL; separate threads send streams and
//! read gaze.
//!
//! LSL needs no Cargo feature: a build gains one small package (`libloading`), and the library is loaded only if a
//! session asks for it. Crates that contain liblsl need a C++ compiler and have an old version (`lsl-sys`), or are GPL
//! (`rlsl`).

mod configuration;
mod gaze_inlet;
#[allow(unsafe_code)]
mod library;
mod outlets;

pub use configuration::LslError;
pub use gaze_inlet::{channel_names, follow, missing_channel};
pub use library::{DiscoveredLslStream, LslLibrary};
pub use outlets::{
    LslCounts, LslSampleConverter, LslSampleValues, LslStreams, MetadataNode, SOURCE, StreamChannel, StreamDescription,
    StreamSample, code, describe, event_text,
};

use std::path::absolute;
use std::sync::mpsc::Receiver;
use std::time::Duration;

use tomcom_session::settings::{LslGazeSpec, LslSpec};

/// Longest time for which the program's end waits for the end of a thread that uses liblsl.
const END: Duration = Duration::from_secs(2);
/// Period of comparing LSL's clock with this computer's.
const COMPARE: Duration = Duration::from_secs(1);

/// Waits, when it is dropped, for the end of a thread, since liblsl must not be in use when the program ends. What ends
/// the thread, the other end of its channel, must be dropped before this value.
#[derive(Debug)]
pub struct LslThreadGuard(Receiver<()>);

impl Drop for LslThreadGuard {
    fn drop(&mut self) {
        // An LSL library that hangs does not delay the end of the program beyond the time limit.
        let _ = self.0.recv_timeout(END);
    }
}

/// Loads the LSL library that the settings name, or the installed library.
///
/// # Errors
/// The LSL library is missing or too old.
pub fn load(spec: Option<&LslSpec>) -> Result<LslLibrary, LslError> {
    let path = spec.and_then(|spec| spec.library.as_deref());
    // The path is made absolute, since the system's loader would look for a bare file name in other folders.
    let path = path.map(|path| absolute(path).unwrap_or_else(|_| path.into()));
    LslLibrary::load(path.as_deref(), &configuration::configuration())
}

/// Streams from other programs that are the session's gaze stream: more than one if the settings do not tell them apart.
/// The search takes `patience_s` seconds.
pub fn gaze_streams(library: LslLibrary, stream: &LslGazeSpec, patience_s: f64) -> Vec<DiscoveredLslStream> {
    library.resolve(&predicate(stream), library::MOST_FOUND, patience_s)
}

/// What of a stream tells it apart from others, in words.
pub fn described(found: &DiscoveredLslStream) -> String {
    let [name, content, host] = found.identity();
    let source = match found.source() {
        none if none.is_empty() => "no source_id".to_string(),
        source => format!("source_id \"{source}\""),
    };
    format!("\"{name}\" of type \"{content}\" on {host}, {source}")
}

/// Search expression that finds the session's gaze stream by what the settings name, but no stream of this program.
fn predicate(stream: &LslGazeSpec) -> String {
    let wanted = [
        ("name", &stream.name),
        ("type", &stream.content),
        ("source_id", &stream.source_id),
        ("hostname", &stream.host),
    ];
    let wanted = wanted.iter().filter_map(|(field, value)| Some(format!("{field}='{}'", value.as_ref()?)));
    wanted.chain([not_own()]).collect::<Vec<_>>().join(" and ")
}

/// LSL streams of numbers from other programs, which could be gaze. The search takes `patience_s` seconds.
pub fn streams_of_numbers(library: LslLibrary, patience_s: f64) -> Vec<DiscoveredLslStream> {
    let mut found = library.resolve(&format!("channel_count>1 and {}", not_own()), library::MOST_FOUND, patience_s);
    found.retain(|stream| !stream.is_text());
    found
}

/// Search expression for LSL streams that other programs offer.
fn not_own() -> String {
    format!("not(starts-with(source_id,'{SOURCE}-'))")
}
