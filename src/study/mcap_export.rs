//! Exports recordings as MCAP files, each beside its log.

use std::collections::BTreeMap;
use std::io;
use std::path::Path;

use serde::Serialize;

use crate::analysis::foxglove::McapMessageConverter;
use crate::files::mcap_file::McapFile;
use tomcom_core::base::text::PathText;
use tomcom_core::base::text::count;
use tomcom_core::kitchen::cost_to_go::CostToGo;
use tomcom_session::LogHeader;
use tomcom_session::files::file_error::{FileError, FileResult};
use tomcom_session::follower::SessionFollower;
use tomcom_session::log::{LOG_NAME, LogEnding, LogReader};
use tomcom_session::study_arm::StudyArm;

/// Summary of a recording's export as MCAP.
#[derive(Clone, Debug, Serialize)]
pub struct McapSummary {
    /// Path of the recording's MCAP file.
    pub file: PathText,
    /// Number of messages in each channel of the MCAP file.
    pub messages: BTreeMap<&'static str, u32>,
}

/// Exports a recording as an MCAP file in the recording's folder.
///
/// # Errors
/// The recording cannot be read or is still being written, the path is not a recording's folder, or the file cannot be
/// written.
pub fn export(recording: &Path) -> FileResult<McapSummary> {
    let mut log = LogReader::open(recording)?;
    let wrong =
        |found: &str, remedy: &str| Err(FileError::from_finding(recording, found.to_string(), remedy.to_string()));
    if log.ending() == LogEnding::Running {
        return wrong("a recording that is still being written", "a recording whose session is over");
    }
    if !log.path().ends_with(LOG_NAME) {
        return wrong(
            "a log that is not called events.jsonl",
            "the folder of a recording, into which its MCAP is written",
        );
    }
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

/// Summaries of MCAP exports as text for the terminal.
pub fn describe(summaries: &[McapSummary]) -> String {
    let line = |one: &McapSummary| {
        let messages = one.messages.iter().filter(|(_, messages)| **messages > 0);
        let messages: Vec<String> = messages.map(|(topic, messages)| format!("{topic} {messages}")).collect();
        format!("  {}: {}\n", one.file.display(), messages.join(", "))
    };
    let lines: String = summaries.iter().map(line).collect();
    format!("{}:\n{lines}", count(summaries.len() as u64, "MCAP", "MCAPs"))
}
