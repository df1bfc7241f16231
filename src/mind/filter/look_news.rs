//! Looks that nobody saw, as data: their chances, and what a belief sample learns from them (see [`super::unseen_looks`]).

/// Chance of looks at each location since the last event, given how much a press needs it, and what a look reads.
#[derive(Clone, Debug)]
pub struct UnseenLooks<'a> {
    /// By location: expected looks without need, and the further ones where the next press needs it for certain.
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

/// What a belief sample has learned from looks that nobody saw.
#[derive(Clone, Copy, Debug, Default)]
pub struct SampleLooks {
    /// Bit set of the aspects that differ from the sample's draws.
    pub changed: u32,
    /// Range of its entries in `Sampler::news`.
    pub news: [usize; 2],
    /// Whether it has read the signal on the display.
    pub read_signal: bool,
}

/// A value that a belief sample holds since a look.
#[derive(Clone, Copy, Debug)]
pub struct LookNews {
    /// Index of the aspect.
    pub aspect: usize,
    /// Index of the value.
    pub value: u8,
    /// It was read, and is certain; else it is a draw of a recipe on which the decision depends since an order was read.
    pub is_read: bool,
}
