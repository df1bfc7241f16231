//! Exports recordings as MCAP files, each beside its log.

use std::collections::BTreeMap;
use std::io;
use std::path::{Path, PathBuf};

use mcap::records::{MessageHeader, Metadata};
use mcap::{McapError, WriteOptions, Writer};
use serde::Serialize;

use crate::analysis::foxglove::{McapChannel, McapMessage, McapMessageConverter};
use crate::files::recordings::open_closed;
use tomcom_core::base::text::{PathText, count};
use tomcom_core::kitchen::cost_to_go::CostToGo;
use tomcom_session::LogHeader;
use tomcom_session::files::file_error::{FileError, FileResult};
use tomcom_session::files::overwrite;
use tomcom_session::files::replace_file::Replacement;
use tomcom_session::follower::SessionFollower;
use tomcom_session::log::MCAP_NAME;
use tomcom_session::study_arm::StudyArm;

#[derive(Clone, Debug, Serialize)]
pub struct McapSummary {
    pub file: PathText,
    pub messages: BTreeMap<&'static str, u32>,
}

/// Exports a recording as an MCAP file in the recording's folder. Errors: the recording cannot be read or is still
/// being written, the path is not a recording's folder, or the file cannot be written.
pub fn export(recording: &Path) -> FileResult<McapSummary> {
    let mut log = open_closed(recording)?;
    let folder = log.folder().to_path_buf();
    let unwritable =
        |reason: io::Error| FileError::not_written(&folder, reason, "a folder of a recording, which can be written to");
    let mut file = McapFile::create(&folder).map_err(unwritable)?;
    let session = log.session();
    let cost = CostToGo::new(session.kitchen.clone());
    let (mut follower, maker) = (SessionFollower::new(session, cost), McapMessageConverter::default());
    while let Some(line) = log.next_line()? {
        follower.apply(&line.stamped).map_err(|error| log.refused(&line, error))?;
        maker
            .messages(&line.stamped, &follower)
            .iter()
            .try_for_each(|message| file.write(message))
            .map_err(unwritable)?;
    }
    let about = about(&folder, &log.header, follower.session.study_arm());
    let (file, messages) = file.finish(about).map_err(unwritable)?;
    Ok(McapSummary { file: file.into(), messages })
}

/// Metadata of the recording in the MCAP file. `arm`: study arm as it was carried out. Times in the file are session
/// times; `started` is the wall clock time of session time 0.
fn about(folder: &Path, header: &LogHeader, arm: StudyArm) -> BTreeMap<String, String> {
    let spec = &header.session;
    let name = folder.file_name().unwrap_or_default().to_string_lossy().into_owned();
    let mut about = BTreeMap::from([
        ("recording".to_string(), name),
        ("participant".to_string(), spec.participant.code.clone()),
        ("condition".to_string(), spec.trial.condition.name().to_string()),
        ("arm".to_string(), arm.name().to_string()),
        ("trial".to_string(), header.trial.to_string()),
        ("program".to_string(), header.program.clone()),
        ("log_version".to_string(), header.version.to_string()),
        ("times".to_string(), "session time: nanoseconds since the beginning of the recording".to_string()),
    ]);
    if let Some(started) = header.started.as_ref().filter(|_| header.continues.is_none()) {
        about.insert("started".to_string(), started.clone());
    }
    about
}

pub fn describe(summaries: &[McapSummary]) -> String {
    let line = |one: &McapSummary| {
        let messages = one.messages.iter().filter(|(_, messages)| **messages > 0);
        let messages: Vec<String> = messages.map(|(topic, messages)| format!("{topic} {messages}")).collect();
        format!("  {}: {}\n", one.file.display(), messages.join(", "))
    };
    let lines: String = summaries.iter().map(line).collect();
    format!("{}:\n{lines}", count(summaries.len() as u64, "MCAP", "MCAPs"))
}

const BEGINS: &[u8] = b"\x89MCAP0\r\n";
const LIBRARY: &str = "tomcom";
const ENCODING: &str = "json";
const SCHEMA_ENCODING: &str = "jsonschema";

/// An MCAP file that is being written. The file gets its final name when it is complete.
pub struct McapFile {
    writer: Writer<Replacement>,
    channels: BTreeMap<&'static str, (u16, u32)>,
    path: PathBuf,
}

impl McapFile {
    /// Creates the MCAP file of the recording in this folder. An earlier file of this program is replaced. Errors: the
    /// name is taken by a file of another program, or the file cannot be written.
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
            let schema = writer.add_schema(channel.schema_name, SCHEMA_ENCODING, schema.as_bytes()).map_err(reason)?;
            let number = writer.add_channel(schema, channel.topic, ENCODING, &BTreeMap::new()).map_err(reason)?;
            channels.insert(channel.topic, (number, 0));
        }
        Ok(McapFile { writer, channels, path })
    }

    pub fn write(&mut self, message: &McapMessage) -> io::Result<()> {
        let Some((channel, sequence)) = self.channels.get_mut(message.topic) else { return Ok(()) };
        let header = MessageHeader {
            channel_id: *channel,
            sequence: *sequence,
            log_time: message.logged.0,
            publish_time: message.published.0,
        };
        *sequence += 1;
        self.writer.write_to_known_channel(&header, message.content.to_string().as_bytes()).map_err(reason)
    }

    /// Gives the file its name; returns its path, and the number of messages by channel.
    pub fn finish(mut self, about: BTreeMap<String, String>) -> io::Result<(PathBuf, BTreeMap<&'static str, u32>)> {
        self.writer.write_metadata(&Metadata { name: LIBRARY.to_string(), metadata: about }).map_err(reason)?;
        self.writer.finish().map_err(reason)?;
        self.writer.into_inner().finish()?;
        let counts = self.channels.iter().map(|(topic, (_, messages))| (*topic, *messages)).collect();
        Ok((self.path, counts))
    }
}

fn reason(error: McapError) -> io::Error {
    match error {
        McapError::Io(reason) => reason,
        error => io::Error::other(error),
    }
}
