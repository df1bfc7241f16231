//! Cost to go: the least number of presses of both agents, one after another, until the orders are served.
//!
//! The cost to go is computed backwards from the goal. The tables of a kitchen (`ground`) give, for every part of the
//! dishes to be served (targets, `goal`), the number of presses to the board from every place and for every combination
//! of free hands and places. An `assign::Assignment` chooses which item becomes which part, which gives a lower bound. A
//! `plan::PressPlan` executes the assignment press by press and clears obstacles (`clearing`), which gives an upper bound.
//! Where the bounds differ, a bounded `search` over single presses decides, which misses the shortest way from a few
//! states. Values are cached (`store`) by state classes (all useless contents are one class), whole decisions by state;
//! `query` answers. A value depends on the state and the recipes only, never on earlier requests. Presses are judged by
//! values that are proven: by a lower bound over all assignments, or by a longer search (`proof`).
//!
//! Exact tables for each pair of targets, made once by backward search, were considered instead. The burger kitchen has
//! 3 to 5 million state classes for a pair of targets, so its tables would fit into memory. The sushi kitchen has 45
//! million to 3.2 billion; one trial asks for some 44 pairs, together 43 GB at one byte for each class. So this module
//! would stay beside the tables.

mod assign;
mod clearing;
mod goal;
mod ground;
mod plan;
mod proof;
mod query;
mod search;
mod store;

pub use proof::{ProofBudget, ProvenCost};
pub(crate) use store::MAX_STATES;
pub use store::{CostToGo, DecisionCosts, MAX_BUTTONS};

/// How exactly a cost to go is computed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Fidelity {
    /// The cost to go is the shortest way that bounds, plans and, where they differ, a search of at most 48 and then 24
    /// states find. It is never too low. Of 1,000 states met in sessions, it is a press too high in 2 in the sushi kitchen
    /// and in 1 in the burger kitchen (all orders; src/research/tests/oracle). Proven values, by which presses are judged:
    /// `CostToGo::proven_all_orders`.
    Searched,
    /// The cost to go comes from bounds and plans without a search, for human decisions. A single value is the length
    /// of the best plan, an upper bound (a search decides if no plan reaches the goal). In a decision, a few values are
    /// wrong by a press or two, mostly those of presses that lead away from the goal.
    PlanBound,
    /// The cost to go is its lower bound from one assignment of items: mostly exact, else mostly a press or two too low,
    /// and in a few states a press too high. Used for worlds with little weight.
    LowerBound,
}
