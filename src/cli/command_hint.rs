//! Hints in messages about arguments: which command takes a path that stands in the place of a command, and how the values
//! of an option are separated.

use std::path::Path;

use clap::CommandFactory;
use clap::builder::StyledStr;
use clap::error::{ContextKind, ContextValue, ErrorKind};

use super::args::Cli;
use tomcom_session::log::LOG_NAME;

/// Adds to the message about an unknown command which command takes a file of this name, to that about an option's values
/// how they are separated, to that about --csv which command writes tables, and to that about a missing argument an example of
/// the command; other messages, and those about a word that is like a command, stay as they are.
pub(super) fn add(mut error: clap::Error) -> clap::Error {
    if let Some(example) = example(&error) {
        error.insert(ContextKind::Suggested, ContextValue::StyledStrs(vec![StyledStr::from(example)]));
        return error;
    }
    // One of the values would be suggested alone, or another format.
    let better = with_commas(&error).map(|hint| (ContextKind::SuggestedValue, hint));
    if let Some((worse, hint)) = better.or_else(|| Some((ContextKind::SuggestedArg, tables(&error)?))) {
        error.remove(worse);
        error.insert(ContextKind::Suggested, ContextValue::StyledStrs(vec![StyledStr::from(hint)]));
        return error;
    }
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

/// The first example in the help of the command that lacks an argument.
fn example(error: &clap::Error) -> Option<String> {
    let (ErrorKind::MissingRequiredArgument, Some(ContextValue::StyledStr(usage))) =
        (error.kind(), error.get(ContextKind::Usage))
    else {
        return None;
    };
    let usage = usage.to_string();
    let name = usage.split_whitespace().skip_while(|word| *word != "tomcom").nth(1)?;
    let help = Cli::command().find_subcommand(name)?.get_after_help()?.to_string();
    let (_, example) = help.split_once("Example")?.1.split_once(": ")?;
    let continued = example.lines().take_while(|line| line.ends_with('\\')).count();
    let lines = example.lines().take(continued + 1).map(|line| line.trim_end_matches('\\').trim());
    Some(format!("for example: {}", lines.collect::<Vec<&str>>().join(" ")))
}

/// Where tables come from, for somebody who asks another command for them.
fn tables(error: &clap::Error) -> Option<String> {
    let Some(ContextValue::String(option)) = error.get(ContextKind::InvalidArg) else { return None };
    let is_it = error.kind() == ErrorKind::UnknownArgument && option == "--csv";
    is_it.then(|| "tables (CSV) are written by 'tomcom study'".to_string())
}

/// How several values of an option are typed, where other signs than commas separate them.
fn with_commas(error: &clap::Error) -> Option<String> {
    let text = |kind| match error.get(kind)? {
        ContextValue::String(text) => Some(text),
        _ => None,
    };
    let option = text(ContextKind::InvalidArg)?.strip_prefix("--")?.split(' ').next()?;
    let is_list = |command: &clap::Command| {
        command.get_arguments().any(|one| one.get_long() == Some(option) && one.get_value_delimiter().is_some())
    };
    let value = text(ContextKind::InvalidValue)?;
    let values: Vec<&str> = value.split([';', ':', '+', '|', '/', ' ']).filter(|value| !value.is_empty()).collect();
    let is_it = values.len() > 1 && Cli::command().get_subcommands().any(is_list);
    is_it.then(|| format!("commas separate the values: --{option} {}", values.join(",")))
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
