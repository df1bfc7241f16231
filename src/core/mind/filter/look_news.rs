//! Data about looks at times of unknown gaze: the looks' probabilities, and what a belief sample learns from them (see
//! [`super::unseen_looks`]).

/// Expected looks at each location at times of unknown gaze since the last event, depending on how much the next press
/// needs the location, and what a look reads there.
#[derive(Clone, Debug)]
pub struct UnseenLooks<'a> {
    /// By location: expected number of looks if the next press does not need the location, and the additional number if
    /// it certainly does.
    pub hazards: &'a [[f64; 2]],
    /// By location, the distribution of the value that a look reads; empty where nothing can be read.
    pub readings: Vec<&'a [f64]>,
    /// The signal on the display, if it may have been read unseen by the tracker.
    pub signal: Option<PossiblyReadSignal>,
}

/// A signal that the participant may have read while the gaze was unknown.
#[derive(Clone, Debug)]
pub struct PossiblyReadSignal {
    /// Probability that the signal was read.
    pub chance: f64,
    /// Index of each state aspect that the signal tells, with the distribution of the value that it is taken for.
    pub readings: Vec<(usize, Vec<f64>)>,
}

/// What a belief sample has learned from looks at times of unknown gaze.
#[derive(Clone, Copy, Debug, Default)]
pub struct SampleLookEffects {
    /// Bit set of the state aspects whose value differs from the sample's draws.
    pub changed: u32,
    /// Range of the sample's entries in `BeliefSampler::news`.
    pub news: [usize; 2],
    /// Whether the belief sample has read the signal on the display.
    pub read_signal: bool,
}

/// A value that a belief sample believes since a look at a time of unknown gaze.
#[derive(Clone, Copy, Debug)]
pub struct ValueSeenByLook {
    /// Index of the state aspect to which the value belongs.
    pub aspect: usize,
    /// Index of the value among the aspect's possible values.
    pub value: u8,
    /// Whether the value was read, and is certain; else the value is a draw of a recipe on which the decision depends
    /// since an order was read.
    pub is_read: bool,
}
