//! Answer to a freeze probe's question while the wizard enters it at the console.

/// Answer to a freeze probe's question while the wizard enters it at the console.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct ProbeEntry {
    /// Numbers of the probe and of the question that the answer belongs to.
    of: (u32, usize),
    /// Number of the selected answer; 0 is "I don't know".
    pub choice: Option<usize>,
    /// Whether the last key was a digit, so that another digit continues the number.
    pub is_typed: bool,
    /// Whether the choice is confirmed, so that the participant's confidence is entered next.
    pub asks_sure: bool,
    /// How sure the participant is of the answer, from 1 (a guess) to 3 (certain).
    pub sure: Option<u8>,
}

impl ProbeEntry {
    /// The entry for this question: unchanged if it belongs to this question, else empty.
    pub fn for_question(self, probe: u32, question: usize) -> ProbeEntry {
        let of = (probe, question);
        if self.of == of { self } else { ProbeEntry { of, ..ProbeEntry::default() } }
    }
}
