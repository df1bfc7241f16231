//! Hints in the message about an unknown command: a path is meant for a command that takes such a file.

use std::path::Path;

use clap::builder::StyledStr;
use clap::error::{ContextKind, ContextValue, ErrorKind};

use tomcom_session::log::LOG_NAME;

/// Adds to the message about an unknown command which command takes a file of this name; other messages, and those about
/// a word that is like a command, stay as they are.
pub(super) fn add(mut error: clap::Error) -> clap::Error {
    if error.kind() != ErrorKind::InvalidSubcommand {
        return error;
    }
    let Some(ContextValue::String(word)) = error.get(ContextKind::InvalidSubcommand) else { return error };
    let is_path = Path::new(word).exists() || word.contains(['/', '.']);
    let hint = StyledStr::from(hint(word));
    if error.get(ContextKind::SuggestedSubcommand).is_some() {
        if !is_path {
            return error;
        }
        // No command has such a name, however similar one is.
        error.remove(ContextKind::SuggestedSubcommand);
    }
    error.insert(ContextKind::Suggested, ContextValue::StyledStrs(vec![hint]));
    error
}

/// Which command takes this word as an argument.
fn hint(word: &str) -> String {
    let path = Path::new(word);
    let is_log = path.join(LOG_NAME).exists() || path.extension().is_some_and(|ending| ending == "jsonl");
    match (path.is_dir(), is_log) {
        (_, true) => format!("a recording is shown by 'tomcom replay {word}'"),
        (true, false) => format!("the recordings of a folder are listed by 'tomcom list {word}'"),
        (false, false) if path.exists() || path.extension().is_some_and(|ending| ending == "toml") => {
            format!("a session file is run by 'tomcom operate {word}'")
        }
        (false, false) => "'tomcom --help' lists the commands".to_string(),
    }
}
