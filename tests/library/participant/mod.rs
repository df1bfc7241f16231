//! Simulated participants: they err at the rates of people, for reasons that can be named.

mod accepted;
mod population;
