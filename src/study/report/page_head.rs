//! Metadata in the head of a report: the program that wrote it, and the participants that it is about. `tomcom forget` finds reports
//! by it.

use std::collections::BTreeSet;

/// Name of the metadata with program and version.
const GENERATOR: &str = "generator";
/// Name of the metadata with the participants' codes.
const PARTICIPANTS: &str = "participants";
/// Program name before its version.
const PROGRAM: &str = "tomcom ";

/// Metadata of a report about these participants, as (name, content). Participants have the names that tables give them: letters,
/// digits, - and _.
pub(super) fn about<'a>(participants: impl Iterator<Item = &'a str>) -> [(&'static str, String); 2] {
    let participants: Vec<&str> = participants.collect::<BTreeSet<&str>>().into_iter().collect();
    [(GENERATOR, format!("{PROGRAM}{}", env!("CARGO_PKG_VERSION"))), (PARTICIPANTS, participants.join(" "))]
}

/// The participants of a report of this program; `None` for any other page.
pub fn participants(page: &str) -> Option<Vec<&str>> {
    let (head, _) = page.split_once("</head>")?;
    head.contains(&tag(GENERATOR, PROGRAM)).then_some(())?;
    let (_, content) = head.split_once(&tag(PARTICIPANTS, ""))?;
    let (content, _) = content.split_once('"')?;
    Some(content.split_whitespace().collect())
}

/// The beginning of a metadata tag, up to the beginning of its content.
fn tag(name: &str, begins: &str) -> String {
    format!("<meta name=\"{name}\" content=\"{begins}")
}
