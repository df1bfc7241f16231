//! How exactly costs to go are computed.

/// How exactly a cost to go is computed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Fidelity {
    /// A search decides where the lower bound and the best plan differ.
    Exact,
    /// Bounds and plans without a search, for human decisions. A single value is the length of the best plan, an upper bound (a
    /// search decides if no plan ends). In a decision, a few values are a press or two off, mostly of presses that lead away from
    /// the goal.
    PlanBound,
    /// The lower bound: mostly exact, else a press or two too low. For worlds with little weight.
    LowerBound,
}
