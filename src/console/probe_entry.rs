//! An answer to the question of a probe while it is entered at the console.

/// An answer that is being entered at the console.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct ProbeEntry {
    /// Numbers of the probe and of the question that it is for.
    of: (u32, usize),
    /// Number of the choice; 0: "I don't know".
    pub choice: Option<usize>,
    /// The last key was a digit: the next one continues the number.
    pub is_typed: bool,
    /// The choice is confirmed, and how sure the participant is comes next.
    pub asks_sure: bool,
    /// How sure the participant is, from 1 to 3.
    pub sure: Option<u8>,
}

impl ProbeEntry {
    /// What is entered for this question: what was, or nothing yet where that was for another one.
    pub fn for_question(self, probe: u32, question: usize) -> ProbeEntry {
        let of = (probe, question);
        if self.of == of { self } else { ProbeEntry { of, ..ProbeEntry::default() } }
    }
}
