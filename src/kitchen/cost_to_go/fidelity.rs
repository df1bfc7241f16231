//! How exactly costs to go are computed.

/// How exactly a cost to go is computed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Fidelity {
    /// The cost to go is exact: a search decides where the lower bound and the best plan differ.
    Exact,
    /// The cost to go comes from bounds and plans without a search, for human decisions. A single value is the length
    /// of the best plan, an upper bound (a search decides if no plan reaches the goal). In a decision, a few values are
    /// wrong by a press or two, mostly those of presses that lead away from the goal.
    PlanBound,
    /// The cost to go is its lower bound: mostly exact, else a press or two too low. Used for worlds with little
    /// weight.
    LowerBound,
}
