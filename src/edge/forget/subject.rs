//! Which person a name in a table, report or training record means: the participant whose data are to be deleted, or
//! another one.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Component, Path, PathBuf};

use crate::session::person_code::{self, without_seed};

/// Which person a name or a row of a table is about (when a participant's data are to be deleted).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum NamedPerson {
    /// The participant whose data are to be deleted.
    Subject,
    Other,
    /// Either the participant or somebody else: both have the name.
    Ambiguous,
}

/// A recording of the participant whose data are to be deleted.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct OwnRecording {
    pub folder: PathBuf,
    /// Time at which the recording began, as the identity of a Rerun stream states it; `None` without a readable
    /// header.
    pub began: Option<String>,
}

/// Recordings whose folders have the same name.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
struct Namesakes {
    own: Vec<OwnRecording>,
    others: Vec<PathBuf>,
}

/// The participant whose data are to be deleted, with the code and the recordings found so far.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(super) struct ForgetSubject {
    pub code: String,
    recordings: BTreeMap<String, Namesakes>,
    /// Codes of all other people who have recordings.
    others: BTreeSet<String>,
}

impl ForgetSubject {
    /// The participant with this code, before any recording has been found.
    pub fn new(code: &str) -> ForgetSubject {
        ForgetSubject { code: code.to_string(), ..ForgetSubject::default() }
    }

    /// Adds a recording of the participant.
    pub fn add_own(&mut self, folder: &Path, began: Option<String>) {
        let own = OwnRecording { folder: folder.to_path_buf(), began };
        self.recordings.entry(name(folder)).or_default().own.push(own);
    }

    /// Adds a recording of somebody else.
    pub fn add_other(&mut self, folder: &Path, code: String) {
        self.recordings.entry(name(folder)).or_default().others.push(folder.to_path_buf());
        self.others.insert(code);
    }

    /// Which person a name in a column of participants means: the name is a participant's code, with a random seed
    /// before it if several seeds were analysed together.
    pub fn participant(&self, cell: &str) -> NamedPerson {
        let is_code = cell == self.code;
        let is_simulated = without_seed(cell) == Some(&self.code);
        match is_code || is_simulated {
            // The name `seed7-S001` can mean S001 with seed 7, but also somebody with exactly this code.
            true if is_simulated && self.others.contains(cell) => NamedPerson::Ambiguous,
            true if is_code && without_seed(cell).is_some() => NamedPerson::Ambiguous,
            true => NamedPerson::Subject,
            false => NamedPerson::Other,
        }
    }

    /// To which person the recording with this name belongs. The name is that of the recording's folder, with parent
    /// folders before it if several folders share the name.
    pub fn recording(&self, cell: &str) -> NamedPerson {
        let path = Path::new(cell);
        let named = path.file_name().and_then(|name| self.recordings.get(name.to_string_lossy().as_ref()));
        let Some(Namesakes { own, others }) = named.filter(|named| !named.own.is_empty()) else {
            return NamedPerson::Other;
        };
        let is_relative = path.components().any(|part| matches!(part, Component::CurDir | Component::ParentDir));
        match (own.iter().any(|one| one.folder.ends_with(path)), others.iter().any(|one| one.ends_with(path))) {
            (true, false) => NamedPerson::Subject,
            (true, true) => NamedPerson::Ambiguous,
            // A relative path depends on the folder in which the analysis ran, which is not known.
            (false, false) if is_relative => NamedPerson::Ambiguous,
            (false, _) => NamedPerson::Other,
        }
    }

    /// Whether a stream with this identity shows a recording of the participant.
    pub fn is_streamed(&self, identity: &str) -> bool {
        let identity = format!(" {identity} ");
        let has = |words: &str| identity.contains(&format!(" {words} "));
        let own = |(name, named): (&String, &Namesakes)| {
            has(name) && named.own.iter().any(|one| one.began.as_ref().is_some_and(|began| has(began)))
        };
        self.recordings.iter().any(own)
    }

    /// Whether a text of unknown origin names the participant. Codes that nobody can have, such as numbers, do not count,
    /// since in such a text they mean something else.
    pub fn is_named_in(&self, text: &[u8]) -> bool {
        let is_distinct = person_code::fault(&self.code).is_none();
        words(text).any(|word| self.is_own_folder(&word) || (is_distinct && self.is_own_code(&word)))
    }

    /// Whether a damaged piece of one of this program's files may name the participant.
    pub fn may_be_in(&self, text: &[u8]) -> bool {
        words(text).any(|word| self.is_own_folder(&word) || self.is_own_code(&word))
    }

    /// Whether the name of a file contains the name of one of the participant's recordings.
    pub fn is_named_by_recording(&self, file: &str) -> bool {
        words(file.as_bytes()).any(|word| self.is_own_folder(&word))
    }

    fn is_own_code(&self, word: &str) -> bool {
        self.participant(word) != NamedPerson::Other
    }

    fn is_own_folder(&self, word: &str) -> bool {
        self.recordings.get(word).is_some_and(|named| !named.own.is_empty())
    }
}

fn name(folder: &Path) -> String {
    folder.file_name().unwrap_or_default().to_string_lossy().into_owned()
}

/// Words of a text that consist of the characters of codes and recording names. Zero bytes are skipped, so that the
/// function also finds words of a file in UTF-16.
fn words(text: &[u8]) -> impl Iterator<Item = String> + '_ {
    let mut bytes = text.iter().copied().filter(|&byte| byte != 0);
    let is_sign = |byte: u8| byte.is_ascii_alphanumeric() || byte == b'-' || byte == b'_';
    std::iter::from_fn(move || {
        let first = bytes.by_ref().find(|&byte| is_sign(byte))?;
        let rest = bytes.by_ref().take_while(|&byte| is_sign(byte));
        Some(std::iter::once(first).chain(rest).map(char::from).collect())
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn subject(code: &str) -> ForgetSubject {
        let mut subject = ForgetSubject::new(code);
        subject.add_own(Path::new("/a/2026-03-14-P07-1"), Some("2026-03-14T10:00:00Z".to_string()));
        subject.add_own(Path::new("/a/2026-03-14-P07-2"), None);
        subject.add_other(Path::new("/b/2026-03-14-P07-1"), "P08".to_string());
        subject.add_other(Path::new("/b/2026-03-14-P08-1"), "seed1-P09".to_string());
        subject
    }

    #[test]
    fn a_recording_is_named_by_its_folder_and_by_those_before_it() {
        let subject = subject("P07");
        for (cell, whose) in [
            ("2026-03-14-P07-1", NamedPerson::Ambiguous),
            ("a/2026-03-14-P07-1", NamedPerson::Subject),
            ("b/2026-03-14-P07-1", NamedPerson::Other),
            ("../2026-03-14-P07-2", NamedPerson::Ambiguous),
            ("/elsewhere/2026-03-14-P07-2", NamedPerson::Other),
            ("2026-03-14-P07-2", NamedPerson::Subject),
            ("2026-03-14-P08-1", NamedPerson::Other),
            ("", NamedPerson::Other),
        ] {
            assert_eq!(subject.recording(cell), whose, "{cell}");
        }
    }

    #[test]
    fn a_participant_is_named_by_the_code_with_or_without_a_seed() {
        let whose = |code: &str, cell: &str| subject(code).participant(cell);
        assert_eq!(whose("P07", "P07"), NamedPerson::Subject);
        assert_eq!(whose("P07", "seed12-P07"), NamedPerson::Subject);
        assert_eq!(whose("P07", "p07"), NamedPerson::Other);
        assert_eq!(whose("P07", "P071"), NamedPerson::Other);
        assert_eq!(whose("P09", "seed1-P09"), NamedPerson::Ambiguous, "somebody is called that");
        assert_eq!(whose("seed1-P09", "seed1-P09"), NamedPerson::Ambiguous, "it is also the name of P09 with seed 1");
    }

    #[test]
    fn a_number_or_a_word_of_the_programs_files_names_nobody_elsewhere() {
        for (code, text, is_named, may_be) in [
            ("P07", "x;P07;3", true, true),
            ("P07", "P\x007\x00;", false, false),
            ("P07", "P\x000\x007\x00;\x00", true, true),
            ("P07", "P077,P07-2", false, false),
            ("1", "1,2", false, true),
            ("none", "none", false, true),
            ("1", "2026-03-14-P07-2", true, true),
            ("1", "2026-03-14-P08-1", false, false),
        ] {
            let subject = subject(code);
            assert_eq!(subject.is_named_in(text.as_bytes()), is_named, "{code} in {text:?}");
            assert_eq!(subject.may_be_in(text.as_bytes()), may_be, "{code} in {text:?}");
        }
    }

    #[test]
    fn a_stream_is_known_by_name_and_beginning() {
        let subject = subject("P07");
        assert!(subject.is_streamed(
            "2026-03-14-P08-1 2026-03-14-P07-1 2026-03-13T10:00:00Z 2026-03-14T10:00:00Z tomcom-scene-3-whole"
        ));
        assert!(
            !subject.is_streamed("2026-03-14-P07-1 2026-03-14T11:00:00Z tomcom-scene-3-whole"),
            "another of that name"
        );
        assert!(!subject.is_streamed("2026-03-14-P07-1-part2 2026-03-14T10:00:00Z tomcom-scene-3-whole"));
    }
}
