//! Cost to go: the least number of presses of both agents, one after another, until the orders are served.
//!
//! The cost to go is computed backwards from the goal. The tables of `journeys` give, for every part of the dishes to
//! be served (targets), the number of presses to the board from every place and for every combination of free hands and
//! places. An `assign::Assignment` chooses which item becomes which part, which gives a lower bound. A
//! `partial_plan::PressPlan` executes the assignment press by press and clears obstacles, which gives an upper bound. Where the
//! bounds differ, a bounded `search` over single presses decides, which misses the shortest way from a few states. Values
//! are cached by state classes (see `goal`: all useless contents are one class), whole decisions by state. A value depends
//! on the state and the recipes only, never on earlier requests. Presses are judged by values that are proven: by a lower
//! bound over all assignments (`floor`), or by a longer search (`proof`).
//!
//! Exact tables for each pair of targets, made once by backward search, were considered instead. The burger kitchen has
//! 3 to 5 million state classes for a pair of targets, so its tables would fit into memory. The sushi kitchen has 45
//! million to 3.2 billion; one trial asks for some 44 pairs, together 43 GB at one byte for each class. So this module
//! would stay beside the tables.
//!
//! The files from the ground up; each imports only from those before it:
//!
//! - `fidelity`, `classes`, `task`, `journeys` (way of one item), `cache`, `ground` (tables of a kitchen), `goal`
//!   (tables of a set of targets), `successors` (single presses).
//! - The lower bound: `demand`, `assign`.
//! - The upper bound: `partial_plan` (a plan under construction), `needs` and `moves` (how it frees hands and places),
//!   `clear` (the move that is mostly best), `alternatives` (all other moves), `carry_out` (execution).
//! - Both bounds: `rating`. Where they differ: `store` (cached results), `search`.
//! - Queries: `value` (of one state), `decide` (after each button).
//! - Proven values: `floor`, `proof`.

mod alternatives;
mod assign;
mod cache;
mod carry_out;
mod classes;
mod clear;
mod decide;
mod demand;
mod fidelity;
mod floor;
mod goal;
mod ground;
mod journeys;
mod moves;
mod needs;
mod partial_plan;
mod proof;
mod rating;
mod search;
mod store;
mod successors;
mod task;
mod value;

pub use self::cache::{DecisionCosts, MAX_BUTTONS};
pub use self::fidelity::Fidelity;
pub use self::proof::{ProofBudget, ProvenCost};
pub use self::store::{CostToGo, EvaluationCounts, MAX_STATES, UNREACHABLE};
