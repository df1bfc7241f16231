//! Metadata in the HTML head of a report: program version and participants' codes, by which `tomcom forget` finds the
//! reports about a participant.

use std::collections::BTreeSet;

/// Name of the metadata field that contains program and version.
const GENERATOR: &str = "generator";
/// Name of the metadata field that contains the participants' codes.
const PARTICIPANTS: &str = "participants";
/// Name of the program in the metadata, before its version.
const PROGRAM: &str = "tomcom ";

/// Metadata fields of a report about these participants, as pairs (name, content). Codes of participants consist of
/// letters, digits, - and _, as in tables.
pub(super) fn about<'a>(participants: impl Iterator<Item = &'a str>) -> [(&'static str, String); 2] {
    let participants: Vec<&str> = participants.collect::<BTreeSet<&str>>().into_iter().collect();
    [(GENERATOR, format!("{PROGRAM}{}", env!("CARGO_PKG_VERSION"))), (PARTICIPANTS, participants.join(" "))]
}

/// Participants of a report that this program wrote; `None` for any other HTML page.
pub fn participants(page: &str) -> Option<Vec<&str>> {
    let (head, _) = page.split_once("</head>")?;
    head.contains(&tag(GENERATOR, PROGRAM)).then_some(())?;
    let (_, content) = head.split_once(&tag(PARTICIPANTS, ""))?;
    let (content, _) = content.split_once('"')?;
    Some(content.split_whitespace().collect())
}

/// Start of an HTML metadata tag up to and including the first characters of the tag's content.
fn tag(name: &str, begins: &str) -> String {
    format!("<meta name=\"{name}\" content=\"{begins}")
}
