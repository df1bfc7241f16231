//! Writes a recording as an MCAP file, the container format of robotics tools.

use std::collections::BTreeMap;
use std::io;
use std::path::{Path, PathBuf};

use mcap::records::{MessageHeader, Metadata};
use mcap::{McapError, WriteOptions, Writer};

use crate::analysis::foxglove::{McapChannel, McapMessage};
use tomcom_session::files::overwrite;
use tomcom_session::files::replace_file::Replacement;
use tomcom_session::log::MCAP_NAME;

/// First bytes of every MCAP file (its magic number).
const BEGINS: &[u8] = b"\x89MCAP0\r\n";
/// Name of this program in the header of the MCAP file.
const LIBRARY: &str = "tomcom";
/// Encoding of an MCAP file's messages and of their schemas.
const ENCODING: &str = "json";
const SCHEMA_ENCODING: &str = "jsonschema";

/// An MCAP file that is being written. The file gets its final name when it is complete.
pub struct McapFile {
    writer: Writer<Replacement>,
    /// For each channel, its number in the file and its number of messages so far.
    channels: BTreeMap<McapChannel, (u16, u32)>,
    path: PathBuf,
}

impl McapFile {
    /// Creates the MCAP file of the recording in this folder. An earlier file of this program is replaced.
    ///
    /// # Errors
    /// The name is taken by a file of another program, or the file cannot be written.
    pub fn create(folder: &Path) -> io::Result<McapFile> {
        let path = folder.join(MCAP_NAME);
        let is_own = |head: &[u8]| {
            let written = LIBRARY.as_bytes();
            head.starts_with(BEGINS) && head.windows(written.len()).take(256).any(|part| part == written)
        };
        overwrite::check(&path, "an MCAP", is_own)?;
        let options = WriteOptions::new().library(format!("{LIBRARY} {}", env!("CARGO_PKG_VERSION"))).compression(None);
        let mut writer = options.create(Replacement::begin(&path)?).map_err(reason)?;
        let mut channels = BTreeMap::new();
        for channel in McapChannel::ALL {
            let schema = format!("{:#}", channel.schema());
            let schema =
                writer.add_schema(channel.schema_name(), SCHEMA_ENCODING, schema.as_bytes()).map_err(reason)?;
            let number = writer.add_channel(schema, channel.topic(), ENCODING, &BTreeMap::new()).map_err(reason)?;
            channels.insert(channel, (number, 0));
        }
        Ok(McapFile { writer, channels, path })
    }

    /// Writes a message to its channel in the MCAP file.
    ///
    /// # Errors
    /// The file cannot be written.
    pub fn write(&mut self, message: &McapMessage) -> io::Result<()> {
        let Some((channel, sequence)) = self.channels.get_mut(&message.channel) else { return Ok(()) };
        let header = MessageHeader {
            channel_id: *channel,
            sequence: *sequence,
            log_time: message.logged.0,
            publish_time: message.published.0,
        };
        *sequence += 1;
        self.writer.write_to_known_channel(&header, message.content.to_string().as_bytes()).map_err(reason)
    }

    /// Completes the MCAP file with these metadata about the recording, and gives it its final name; returns the file's
    /// path, and the number of messages by channel.
    ///
    /// # Errors
    /// The file cannot be written.
    pub fn finish(mut self, about: BTreeMap<String, String>) -> io::Result<(PathBuf, BTreeMap<&'static str, u32>)> {
        self.writer.write_metadata(&Metadata { name: LIBRARY.to_string(), metadata: about }).map_err(reason)?;
        self.writer.finish().map_err(reason)?;
        self.writer.into_inner().finish()?;
        let counts = self.channels.iter().map(|(channel, (_, messages))| (channel.topic(), *messages)).collect();
        Ok((self.path, counts))
    }
}

fn reason(error: McapError) -> io::Error {
    match error {
        McapError::Io(reason) => reason,
        error => io::Error::other(error),
    }
}
