//! What a report says of itself in the head of its page: which program made it, and whom it is about. By that it is found
//! again when a participant is to be forgotten.

use std::collections::BTreeSet;

/// What stands before the version of the program.
const GENERATOR: &str = "<meta name=\"generator\" content=\"tomcom ";
/// What stands before the codes of the participants.
const PARTICIPANTS: &str = "<meta name=\"participants\" content=\"";

/// The lines of the head that say it: participants by the names that tables give them, which are letters, digits, - and _.
pub(super) fn about<'a>(participants: impl Iterator<Item = &'a str>) -> String {
    let participants: Vec<&str> = participants.collect::<BTreeSet<&str>>().into_iter().collect();
    format!("{GENERATOR}{}\">\n{PARTICIPANTS}{}\">\n", env!("CARGO_PKG_VERSION"), participants.join(" "))
}

/// The participants that a report of this program is about; none of any other page.
pub fn participants(page: &str) -> Option<Vec<&str>> {
    let (head, _) = page.split_once("</head>")?;
    head.contains(GENERATOR).then_some(())?;
    let (_, content) = head.split_once(PARTICIPANTS)?;
    let (content, _) = content.split_once('"')?;
    Some(content.split_whitespace().collect())
}
