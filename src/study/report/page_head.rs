//! Metadata in the head of a report: the program version and the participants' codes. `tomcom forget` finds reports by them.

use std::collections::BTreeSet;

/// Name of the metadata with program and version.
const GENERATOR: &str = "generator";
/// Name of the metadata with the participants' codes.
const PARTICIPANTS: &str = "participants";
/// Program name before its version.
const PROGRAM: &str = "tomcom ";

/// Metadata of a report about these participants, as (name, content). Names consist of letters, digits, - and _, as in tables.
pub(super) fn about<'a>(participants: impl Iterator<Item = &'a str>) -> [(&'static str, String); 2] {
    let participants: Vec<&str> = participants.collect::<BTreeSet<&str>>().into_iter().collect();
    [(GENERATOR, format!("{PROGRAM}{}", env!("CARGO_PKG_VERSION"))), (PARTICIPANTS, participants.join(" "))]
}

/// Participants of a report that this program wrote; `None` for any other page.
pub fn participants(page: &str) -> Option<Vec<&str>> {
    let (head, _) = page.split_once("</head>")?;
    head.contains(&tag(GENERATOR, PROGRAM)).then_some(())?;
    let (_, content) = head.split_once(&tag(PARTICIPANTS, ""))?;
    let (content, _) = content.split_once('"')?;
    Some(content.split_whitespace().collect())
}

/// Start of a metadata tag up to and including the first characters of its content.
fn tag(name: &str, begins: &str) -> String {
    format!("<meta name=\"{name}\" content=\"{begins}")
}
