//! How exactly costs to go are computed.

/// How exactly a cost to go is computed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Fidelity {
    /// The cost to go is the shortest way that bounds, plans and, where they differ, a search of at most 48 and then 24
    /// states find. It is never too low. Of 1,000 states met in sessions, it is a press too high in 2 in the sushi kitchen
    /// and in 1 in the burger kitchen (all orders; src/research/tests/oracle). Proven values, by which presses are judged:
    /// [`super::CostToGo::proven_all_orders`].
    Searched,
    /// The cost to go comes from bounds and plans without a search, for human decisions. A single value is the length
    /// of the best plan, an upper bound (a search decides if no plan reaches the goal). In a decision, a few values are
    /// wrong by a press or two, mostly those of presses that lead away from the goal.
    PlanBound,
    /// The cost to go is its lower bound from one assignment of items: mostly exact, else mostly a press or two too low,
    /// and in a few states a press too high. Used for worlds with little weight.
    LowerBound,
}
