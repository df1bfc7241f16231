//! Data about looks at times of unknown gaze: their probabilities, and what a belief sample learns from them (see
//! [`super::unseen_looks`]).

/// Expected looks at each location at times of unknown gaze since the last event, as a function of how much the next
/// press needs it, and what a look reads.
#[derive(Clone, Debug)]
pub struct UnseenLooks<'a> {
    /// By location: expected number of looks without need, and the additional number if the next press certainly needs
    /// the location.
    pub hazards: &'a [[f64; 2]],
    /// By location, the distribution of the value read; empty where nothing can be read.
    pub readings: Vec<&'a [f64]>,
    /// The signal on the display, if it may have been read.
    pub signal: Option<UnseenSignal>,
}

/// A signal that may have been read while nobody saw it.
#[derive(Clone, Debug)]
pub struct UnseenSignal {
    /// Probability that it was read.
    pub chance: f64,
    /// Index of each aspect that it tells, with the distribution of the value that it is taken for.
    pub readings: Vec<(usize, Vec<f64>)>,
}

/// What a belief sample has learned from looks at times of unknown gaze.
#[derive(Clone, Copy, Debug, Default)]
pub struct SampleLooks {
    /// Bit set of the aspects whose value differs from the sample's draws.
    pub changed: u32,
    /// Range of the sample's entries in `BeliefSampler::news`.
    pub news: [usize; 2],
    /// Whether it has read the signal on the display.
    pub read_signal: bool,
}

/// A value that a belief sample holds since a look at a time of unknown gaze.
#[derive(Clone, Copy, Debug)]
pub struct ValueFromLook {
    /// Index of the state aspect that the value belongs to.
    pub aspect: usize,
    /// Index of the value among the aspect's possible values.
    pub value: u8,
    /// Whether the value was read, and is certain; else it is a draw of a recipe on which the decision depends since an
    /// order was read.
    pub is_read: bool,
}
