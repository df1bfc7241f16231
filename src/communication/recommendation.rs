//! The answer of a communication concept: what could be said, what that is worth, and why.

use serde::{Deserialize, Serialize};

use super::signal::Signal;
use crate::base::time::SessionTime;
use crate::kitchen::{AspectId, Kitchen, LocationKind, OrderContent, State};
use crate::mind::dirichlet::DirichletBelief;
use crate::mind::witness::rounded;

/// What a concept advises after an event.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Recommendation {
    /// The number of the event that it was computed for.
    pub for_seq: u64,
    /// When that was.
    pub for_ns: SessionTime,
    /// What could be said, the best first.
    pub options: Vec<SignalOption>,
    /// What to say; nothing: better be silent.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub best: Option<Signal>,
    /// Why the first option would help.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub reason: Option<Reason>,
    /// Presses that are proposed, by a concept that proposes presses.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub proposal: Option<Proposal>,
}

/// Good presses, proposed after an error.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Proposal {
    /// The number of the press that was the error.
    pub error: u64,
    /// The human's next presses, by the names of their buttons.
    pub presses: Vec<String>,
}

/// One thing that could be said.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct SignalOption {
    pub signal: Signal,
    /// Expected presses of both agents that it saves; of ToM, the expected deviation of the belief.
    pub benefit: f64,
    pub standard_error: f64,
    /// The benefit without the cost of communication; of ToM, the deviation above the threshold.
    pub net: f64,
    /// How many pairs of rollouts that is the mean of; of ToM none.
    pub rollouts: u32,
}

/// Why something should be said.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Reason {
    /// The aspect that is believed wrong, by its name.
    pub aspect: String,
    /// What is believed of it if not the truth.
    pub believes: String,
    pub truth: String,
    /// The expected probability of that.
    pub p_believes: f64,
    /// The press that this would lead to and the signal would prevent, by its name.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub prevents: Option<String>,
    /// What would be pressed instead; nothing: a moment's waiting.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub instead: Option<String>,
}

impl Recommendation {
    /// The advice to say nothing, after the event of this number and time.
    pub fn silent(seq: u64, time: SessionTime) -> Recommendation {
        Recommendation { for_seq: seq, for_ns: time, options: Vec::new(), best: None, reason: None, proposal: None }
    }

    /// Takes out a signal that was sent. What is best after it only the next advice knows.
    pub fn remove(&mut self, sent: &Signal) {
        self.options.retain(|option| option.signal != *sent);
        if self.best.as_ref() == Some(sent) {
            (self.best, self.reason) = (None, None);
        }
    }

    /// The option that is worth most.
    pub fn top(&self) -> Option<&SignalOption> {
        self.options.first()
    }
}

/// The aspects that a signal about a location makes certain: its content, and for an order the recipe of its dish.
pub fn aspects_told(kitchen: &Kitchen, state: State, signal: &Signal) -> Vec<AspectId> {
    let Some(location) = kitchen.location_named(signal.target()) else { return Vec::new() };
    let mut aspects = vec![AspectId::of_location(location)];
    if let (LocationKind::Order, OrderContent::Dish(dish)) = (kitchen.location(location).kind, state.order(location)) {
        aspects.push(kitchen.aspect_of_dish(dish));
    }
    aspects
}

/// A content as part of a sentence: what is made of several items stands in quotes.
pub fn phrase(label: &str) -> String {
    if label.contains(" + ") { format!("\"{label}\"") } else { label.to_string() }
}

impl Reason {
    /// Of what a signal is about, that which is known least.
    pub fn for_signal(kitchen: &Kitchen, state: State, belief: &DirichletBelief, signal: &Signal) -> Option<Reason> {
        let p_truth = |aspect: &AspectId| belief.p_truth(kitchen, state, *aspect);
        let aspects = aspects_told(kitchen, state, signal);
        let aspect = aspects.into_iter().min_by(|a, b| p_truth(a).total_cmp(&p_truth(b)))?;
        let truth = kitchen.true_value(state, aspect);
        let mean = belief.aspect(aspect).mean();
        let others = (0..mean.len()).filter(|&value| value != truth);
        let believed = others.reduce(|best, value| if mean[value] > mean[best] { value } else { best })?;
        let told = &kitchen.aspects[aspect.index()];
        Some(Reason {
            aspect: told.name.clone(),
            believes: told.labels[believed].clone(),
            truth: told.labels[truth].clone(),
            p_believes: rounded(mean[believed]),
            prevents: None,
            instead: None,
        })
    }

    /// What is taken for what, in words: "takes order 1 for tuna nigiri (0.83)", and where it is less likely than not "may
    /// take".
    pub fn taken(&self) -> String {
        let Reason { aspect, believes, p_believes, .. } = self;
        let takes = if *p_believes < 0.5 { "may take" } else { "takes" };
        format!("{takes} {} for {} ({p_believes:.2})", aspect.replace('_', " "), phrase(believes))
    }

    /// In words: "takes order 1 for tuna nigiri (0.83): would press "take tuna" instead of "take salmon"".
    pub fn words(&self) -> String {
        let said = |name: &str| name.replace('_', " ");
        let taken = self.taken();
        let instead = self.instead.as_deref().map_or("waiting".to_string(), |button| format!("\"{}\"", said(button)));
        match &self.prevents {
            Some(button) => format!("{taken}: would press \"{}\" instead of {instead}", said(button)),
            None => taken,
        }
    }
}
