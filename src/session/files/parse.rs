//! Parses files that people write (TOML). Every error names the file, the line, what was found and what would be valid.

use std::ops::Range;
use std::path::Path;

use serde::de::DeserializeOwned;

use crate::SessionSpec;
use crate::files::file_error::{FileError, FileResult, place_of};
use crate::questionnaire::Questionnaire;
use crate::tutorial::Tutorial;
use tomcom_core::base::text::did_you_mean;
use tomcom_core::kitchen::files::LayoutSpec;
use tomcom_core::kitchen::files::RecipesSpec;
use tomcom_core::mind::model::HumanModel;

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FileKind {
    Session,
    Layout,
    Recipes,
    HumanModel,
    Keys,
    Questionnaire,
    Tutorial,
    Language,
    Battery,
}

impl FileKind {
    /// The kind of file that a text is, by the tables in it.
    fn from_text(text: &str) -> Option<FileKind> {
        let table: toml::Table = text.parse().ok()?;
        let has = |keys: &[&str]| keys.iter().any(|key| table.contains_key(*key));
        match () {
            () if has(&["cohort"]) => Some(FileKind::Battery),
            () if has(&["recipes", "storage", "place"]) => Some(FileKind::Layout),
            () if has(&["ingredient", "slot", "dish"]) => Some(FileKind::Recipes),
            () if has(&["scale", "item"]) => Some(FileKind::Questionnaire),
            () if has(&["layout"]) => Some(FileKind::Session),
            () if has(&["step"]) => Some(FileKind::Tutorial),
            () if has(&["language"]) => Some(FileKind::Language),
            () if has(&["model", "prior", "perception", "transition", "decision"]) => Some(FileKind::HumanModel),
            () if has(&["console", "replay", "signals", "buttons"]) => Some(FileKind::Keys),
            () => None,
        }
    }

    /// What such a file is, and what would be right in the place of another one.
    fn words(self) -> (&'static str, &'static str) {
        match self {
            FileKind::Session => ("a session file", "a session file, like sessions/default.toml"),
            FileKind::Layout => ("a layout file", "a layout file, like layouts/sushi.toml"),
            FileKind::Recipes => ("a recipe file", "a recipe file, like recipes/sushi.toml"),
            FileKind::HumanModel => (
                "a file with parameters of the human model",
                "parameters of the human model, like those that tomcom fit writes",
            ),
            FileKind::Keys => ("a key file", "a key file, as tomcom keys prints it"),
            FileKind::Questionnaire => {
                ("a questionnaire", "a questionnaire, like sessions/questionnaires/acceptance.toml")
            }
            FileKind::Tutorial => ("a tutorial", "a tutorial, like sessions/tutorials/sushi.toml"),
            FileKind::Language => (
                "words of the participant's display",
                "words of the participant's display, lines like \"rice\" = \"riz\"",
            ),
            FileKind::Battery => ("a battery of cohorts", "a battery of cohorts, like sessions/people/robustness.toml"),
        }
    }
}

/// A type into which files of one kind are parsed.
pub trait ParsedFile: DeserializeOwned {
    const KIND: FileKind;
}

impl ParsedFile for SessionSpec {
    const KIND: FileKind = FileKind::Session;
}

impl ParsedFile for LayoutSpec {
    const KIND: FileKind = FileKind::Layout;
}

impl ParsedFile for RecipesSpec {
    const KIND: FileKind = FileKind::Recipes;
}

impl ParsedFile for Questionnaire {
    const KIND: FileKind = FileKind::Questionnaire;
}

impl ParsedFile for Tutorial {
    const KIND: FileKind = FileKind::Tutorial;
}

impl ParsedFile for HumanModel {
    const KIND: FileKind = FileKind::HumanModel;
}

/// If the text is a file of another kind, the error says so.
pub fn parse<T: ParsedFile>(path: &Path, text: &str) -> FileResult<T> {
    let (_, right_file) = T::KIND.words();
    toml::from_str(text).map_err(|error| match FileKind::from_text(text).filter(|kind| *kind != T::KIND) {
        Some(other) => FileError::at(path, text, None, other.words().0.to_string(), right_file.to_string()),
        None => {
            let (span, (found, right)) = if let Some((span, line, right)) = mended(text, &error) {
                (Some(span), (line, Some(right)))
            } else if let Some((span, error)) = stray_table::<T>(text, &error) {
                (Some(span), told::<T>("", &error))
            } else {
                (error.span(), told::<T>(text, &error))
            };
            let remedy = right.map_or(right_file.to_string(), |right| format!("{right}; in {right_file}"));
            FileError::at(path, text, span, found, remedy)
        }
    })
}

/// A line that lacks a quote or a bracket, with its place, and the line that was probably meant. The parser may notice only
/// on the next line.
fn mended(text: &str, error: &toml::de::Error) -> Option<(Range<usize>, String, String)> {
    let parses = |text: &str| text.parse::<toml::Table>().is_ok();
    if parses(text) {
        return None;
    }
    let is_right = |line: &str| parses(line) || parses(&format!("list = [\n{line}\n]"));
    let at = error.span()?.start;
    let end = at + text.get(at..)?.find('\n').unwrap_or(text.len() - at);
    let mut starts = 0;
    let lines = text[..end].split_inclusive('\n').map(|line| {
        starts += line.len();
        (starts - line.len(), line.split("# ").next().unwrap_or(line).trim())
    });
    let lines: Vec<(usize, &str)> = lines.filter(|(_, line)| !line.is_empty() && !line.starts_with('#')).collect();
    let place = |start: usize, line: &str| start..start + line.len();
    let Some(&(start, line)) = lines.iter().rev().take(2).find(|(_, line)| !is_right(line)) else {
        // A list over several lines, of which the parser finds out at the next setting.
        lines.last().filter(|(_, line)| parses(line))?;
        let is_within = |line: &str| line.starts_with('[') || !line.ends_with(']');
        let mut before = lines.iter().rev().skip(1).take_while(|(_, line)| is_within(line));
        let &(start, line) = before.find(|(_, line)| line.ends_with('['))?;
        return Some((place(start, line), format!("{line} without its end"), "] after the last entry".to_string()));
    };
    let (text, closing) = line.split_at(line.trim_end_matches([',', ']', '}', ' ']).len());
    let meant = [format!("{text}\"{closing}"), format!("{line}]"), format!("[{line}"), format!("{line}}}")];
    let right = meant.into_iter().find(|line| is_right(line))?;
    Some((place(start, line), line.to_string(), right.trim_end_matches(',').to_string()))
}

/// The place of a table that no such file has, and the error about it, where the parser misses what stands in it: a
/// misspelt `[plan]`, beside `[plan.familiarisation]`.
fn stray_table<T: DeserializeOwned>(text: &str, error: &toml::de::Error) -> Option<(Range<usize>, toml::de::Error)> {
    let known = settings_of::<T>("").filter(|_| error.message().starts_with("missing field"))?;
    let table: toml::Table = text.parse().ok()?;
    let stray = table.keys().find(|name| !known.contains(name))?;
    Some((place_of(text, stray, 0)?, toml::from_str::<T>(&format!("[{stray}]\n")).err()?))
}

/// What the parser found, and what it expected instead, if it says so.
fn told<T: DeserializeOwned>(text: &str, error: &toml::de::Error) -> (String, Option<String>) {
    let message = error.message();
    if let Some((found, right)) = error.span().and_then(|span| no_value(text, span.start)) {
        return (found, Some(right));
    }
    if let Some((found, expected)) = message.split_once(", expected ") {
        let unknown = found.strip_prefix("unknown field `").and_then(|found| found.strip_suffix('`'));
        if let Some(place) = unknown.and_then(|name| Some(format!("{name} {}", places_of::<T>(name)?))) {
            return (found.to_string(), Some(place));
        }
        if let Some(name) = unknown {
            return (format!("{found}{}", did_you_mean(name, names_in(expected))), Some(type_name(expected)));
        }
        let found = error.span().and_then(|span| Some((setting_at(text, span)?, found)));
        return match found {
            Some((setting, found)) if found.starts_with("unknown variant ") => {
                let near = did_you_mean(found.split('`').nth(1).unwrap_or_default(), names_in(expected));
                (format!("{setting}, which is not known{near}"), Some(type_name(expected)))
            }
            Some((setting, _)) => (setting, Some(type_name(expected))),
            None => (message.split(", expected ").next().unwrap_or(message).to_string(), Some(type_name(expected))),
        };
    }
    let (span, value) = match error.span().and_then(|span| Some((span.clone(), text.get(span)?))) {
        Some((span, value)) if !value.is_empty() && !value.contains('\n') => (span, value),
        _ => return (message.to_string(), None),
    };
    // Which words are right the parser says only of a text.
    if message == "wanted string or table"
        && let Err(error) = toml::from_str::<T>(&[&text[..span.start], "\"\"", &text[span.end..]].concat())
        && let Some((_, words)) = error.message().split_once(", expected ")
    {
        return (value.to_string(), Some(type_name(words)));
    }
    if message.starts_with("invalid IP") {
        let setting = setting_at(text, span).unwrap_or(value.to_string());
        return (setting, Some("an address of numbers, like \"192.168.1.10\"".to_string()));
    }
    (format!("{value}: {message}"), None)
}

/// A setting whose value is none in TOML, with what was probably meant: most often a word without quotes, of which the
/// parser says only what else a value can begin with. `None` if the line at this place of the text is none of these.
fn no_value(text: &str, at: usize) -> Option<(String, String)> {
    if text.parse::<toml::Table>().is_ok() {
        return None;
    }
    let start = text.get(..at)?.rfind('\n').map_or(0, |end| end + 1);
    let (key, line) = text[start..].lines().next()?.split_once('=')?;
    let (key, value) = (key.trim(), line.split('#').next()?.trim());
    let is_setting = |value: &str| format!("{key} = {value}").parse::<toml::Table>().is_ok();
    let goes_on =
        value.starts_with('{') || (value.starts_with('[') && !value.ends_with(']')) || value.contains("\"\"\"");
    if value.is_empty() || goes_on || is_setting(line) {
        return None;
    }
    let is_number = |value: &str| value.starts_with(|first: char| first.is_ascii_digit() || first == '-');
    let quoted = |value: &str| match value.trim() {
        value if is_setting(value) => value.to_string(),
        value => format!("\"{}\"", value.trim_matches(['"', '\''])),
    };
    let (right, rule) = match value.strip_prefix('[').and_then(|list| list.strip_suffix(']')) {
        Some(list) => {
            (format!("[{}]", list.split(',').map(quoted).collect::<Vec<_>>().join(", ")), "words stand between quotes")
        }
        None if is_number(value) => (value.replace(',', "."), "decimals follow a point"),
        None => (quoted(value), "words stand between quotes, numbers, true and false do not"),
    };
    is_setting(&right).then(|| (format!("{key} = {value}"), format!("{key} = {right}: {rule}")))
}

/// The setting whose value, or part of whose value, stands at this place of a text: `tau = "high"`, or `"both" in
/// conditions`. `None` if that is not on one line.
fn setting_at(text: &str, span: Range<usize>) -> Option<String> {
    let (before, value) = (text.get(..span.start)?, text.get(span)?);
    let line = before.rsplit('\n').next().unwrap_or(before);
    let (key, between) = line.rsplit_once('=')?;
    let key = key.rsplit(['{', ',', '\n']).next().unwrap_or(key).trim();
    if key.is_empty() || value.is_empty() || value.contains('\n') {
        return None;
    }
    Some(if between.trim().is_empty() { format!("{key} = {value}") } else { format!("{value} in {key}") })
}

/// What was expected, with types of Rust by names that people know who write settings, and words in quotes.
fn type_name(expected: &str) -> String {
    let name = match expected {
        "u8" => "a whole number from 0 to 255",
        "u16" => "a whole number from 0 to 65535",
        // Most settings have narrower bounds, which are checked and reported by other code.
        "u32" | "u64" | "usize" => "a whole number, not below 0",
        "i64" => "a whole number",
        "f32" | "f64" => "a number",
        "a boolean" => "true or false",
        "a string" => "a text in quotes",
        "a sequence" => "a list, in [ ]",
        "a map" => "a table of settings",
        _ if expected.starts_with("struct ") => "a table of settings",
        _ if expected.contains('"') => expected,
        _ => return expected.replace('`', "\""),
    };
    name.to_string()
}

const NOBODY: &str = "no_setting_has_this_name";
/// Number of tables within tables that are looked into.
const DEEPEST: usize = 3;
/// A setting that more tables have than these has no place of its own, such as a name.
const MOST_PLACES: usize = 3;

/// Where files that are parsed into `T` have a setting of this name, in words: "under [human.decision]". `None` if no
/// table has it, or too many. The parser of `T` is asked: it refuses a setting that no file has, and names those that
/// the table could have.
fn places_of<T: DeserializeOwned>(setting: &str) -> Option<String> {
    let mut tables = Vec::new();
    collect::<T>("", setting, DEEPEST, &mut tables);
    if tables.is_empty() || tables.len() > MOST_PLACES {
        return None;
    }
    let place = |table: &String| match (table.as_str(), settings_of::<T>(&joined(table, setting))) {
        (_, Some(_)) => format!("as [{}]", joined(table, setting)),
        ("", None) => "above the first table".to_string(),
        (table, None) => format!("under [{table}]"),
    };
    Some(tables.iter().map(place).collect::<Vec<_>>().join(", or "))
}

fn collect<T: DeserializeOwned>(table: &str, setting: &str, depth: usize, tables: &mut Vec<String>) {
    let Some(names) = settings_of::<T>(table) else { return };
    if names.iter().any(|name| name == setting) {
        tables.push(table.to_string());
    }
    if depth > 0 {
        names.iter().for_each(|name| collect::<T>(&joined(table, name), setting, depth - 1, tables));
    }
}

fn joined(table: &str, name: &str) -> String {
    if table.is_empty() { name.to_string() } else { format!("{table}.{name}") }
}

/// `None` if it is no table.
fn settings_of<T: DeserializeOwned>(table: &str) -> Option<Vec<String>> {
    let header = if table.is_empty() { String::new() } else { format!("[{table}]\n") };
    let error = toml::from_str::<T>(&format!("{header}{NOBODY} = 0\n")).err()?;
    let expected = error.message().strip_prefix(&format!("unknown field `{NOBODY}`, expected "))?;
    Some(names_in(expected).map(str::to_string).collect())
}

/// The names in what a parser expected: "one of `tau`, `lapse`".
fn names_in(expected: &str) -> impl Iterator<Item = &str> {
    expected.split('`').skip(1).step_by(2)
}
