//! How exactly costs to go are computed.

/// How exactly a cost to go is computed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Fidelity {
    /// By a search where the lower bound and the best plan do not agree.
    Exact,
    /// By bounds and plans, without a search: for human decisions. A single value is the length of the best plan, an upper
    /// bound (searched for where no plan comes to an end). In a decision a few values are a press or two off, mostly those
    /// of presses that lead away from the goal.
    PlanBound,
    /// By the lower bound: mostly exact, else a press or two too low. For worlds of little weight.
    LowerBound,
}
