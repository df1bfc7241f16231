//! The answer of a communication concept: ranked signals with their net benefit, and the reason.

use serde::{Deserialize, Serialize};

use super::signal::Signal;
use crate::base::time::SessionTime;
use crate::kitchen::{AspectId, Kitchen, State};
use crate::measures::sequences::THINKS;
use crate::mind::dirichlet::DirichletBelief;
use crate::mind::rounded;

/// Recommendation of a communication concept after an event.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Recommendation {
    /// Sequence number of the event for which the recommendation was computed.
    pub for_seq: u64,
    /// Session time of the event for which the recommendation was computed.
    pub for_ns: SessionTime,
    /// All signals that could be sent, the signal with the highest net benefit first; none of an external concept that
    /// names a signal without its value.
    pub options: Vec<SignalOption>,
    /// The recommended signal; `None` if the saving of no signal exceeds its cost.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub best: Option<Signal>,
    /// Reason for the first option if its signal saves presses, even if they do not exceed its cost and `best` is
    /// `None`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub reason: Option<SignalReason>,
    /// Proposed presses of the human; only the concept DEV proposes any.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub proposal: Option<HumanPressProposal>,
    /// The reason in the concept's own words; only external concepts give one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub words: Option<String>,
}

/// Good presses that the DEV concept proposes after an error.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct HumanPressProposal {
    /// Sequence number of the erroneous press after which DEV proposes.
    pub error: u64,
    /// Proposed next presses of the human, by the names of their buttons.
    pub presses: Vec<String>,
}

/// A signal with its estimated benefit.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct SignalOption {
    /// The signal that could be sent to the participant.
    pub signal: Signal,
    /// Expected saving of the signal in presses of both agents; for the concept ToM, the expected belief deviation.
    pub benefit: f64,
    /// Standard error of the benefit, in the benefit's unit; 0 for a concept that computes it exactly.
    pub standard_error: f64,
    /// Net benefit: benefit minus the cost of communication; for the concept ToM, deviation minus threshold.
    pub net: f64,
    /// Number of paired rollouts behind the estimated benefit; 0 for the concept ToM, which needs none.
    pub rollouts: u32,
}

/// The false belief that a signal would correct, and the press that it would prevent.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct SignalReason {
    /// Name of the state aspect with the false belief.
    pub aspect: String,
    /// The value of the aspect that is falsely believed, as text.
    pub believes: String,
    /// The true value of the aspect, as text.
    pub truth: String,
    /// Expected probability that the human gives to the falsely believed value.
    pub p_believes: f64,
    /// Name of the press to which the false belief would lead; `None` for waiting, if there is a press instead.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub prevents: Option<String>,
    /// Name of the press that the human makes after the signal instead; `None` for waiting.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub instead: Option<String>,
}

impl Recommendation {
    /// The recommendation to send no signal, after the event with this sequence number and time.
    pub fn silent(seq: u64, time: SessionTime) -> Recommendation {
        let (options, best, reason, proposal, words) = (Vec::new(), None, None, None, None);
        Recommendation { for_seq: seq, for_ns: time, options, best, reason, proposal, words }
    }

    /// Removes a signal that has been sent; which signal is best then is not computed before the next recommendation.
    pub fn remove(&mut self, sent: &Signal) {
        self.options.retain(|option| option.signal != *sent);
        if self.best.as_ref() == Some(sent) {
            (self.best, self.reason, self.words) = (None, None, None);
        }
    }

    /// The signal with the highest net benefit.
    pub fn top(&self) -> Option<&SignalOption> {
        self.options.first()
    }
}

/// The state aspects that a signal reveals: a location's content, or an order and the recipe of the ordered dish; none
/// for proposed presses.
pub fn aspects_told(kitchen: &Kitchen, state: State, signal: &Signal) -> Vec<AspectId> {
    signal.location(kitchen).map_or_else(Vec::new, |location| kitchen.aspects_at(state, location))
}

/// A content's name worded as part of a sentence; a stack is put in quotes.
pub fn phrase(label: &str) -> String {
    if label.contains(" + ") { format!("\"{label}\"") } else { label.to_string() }
}

impl SignalReason {
    /// The reason for a signal: of the signal's aspects, the one to whose true value the estimated belief gives the
    /// lowest probability.
    pub fn for_signal(
        kitchen: &Kitchen,
        state: State,
        belief: &DirichletBelief,
        signal: &Signal,
    ) -> Option<SignalReason> {
        let p_truth = |aspect: &AspectId| belief.p_truth(kitchen, state, *aspect);
        let aspects = aspects_told(kitchen, state, signal);
        let aspect = aspects.into_iter().min_by(|a, b| p_truth(a).total_cmp(&p_truth(b)))?;
        let truth = kitchen.true_value(state, aspect);
        let mean = belief.aspect(aspect).mean();
        let others = (0..mean.len()).filter(|&value| value != truth);
        let believed = others.reduce(|best, value| if mean[value] > mean[best] { value } else { best })?;
        let told = &kitchen.aspects[aspect.index()];
        Some(SignalReason {
            aspect: told.name.clone(),
            believes: told.labels[believed].clone(),
            truth: told.labels[truth].clone(),
            p_believes: rounded(mean[believed]),
            prevents: None,
            instead: None,
        })
    }

    /// The false belief in words: "takes order 1 for tuna nigiri (0.83)"; "may take" if its probability is below [`THINKS`].
    pub fn taken(&self) -> String {
        self.taken_with("")
    }

    /// `named`: what stands before the probability.
    fn taken_with(&self, named: &str) -> String {
        let SignalReason { aspect, believes, p_believes, .. } = self;
        let takes = if *p_believes < THINKS { "may take" } else { "takes" };
        format!("{takes} {} for {} ({named}{p_believes:.2})", aspect.replace('_', " "), phrase(believes))
    }

    /// The signal's reason in words: "takes order 1 for tuna nigiri (0.83): would press "take tuna" instead of "take
    /// salmon"".
    pub fn words(&self) -> String {
        self.leads_from(self.taken())
    }

    /// The same where there is room to name the probability.
    pub fn words_with_unit(&self) -> String {
        self.leads_from(self.taken_with("probability "))
    }

    fn leads_from(&self, taken: String) -> String {
        let said = |name: &str| name.replace('_', " ");
        match (&self.prevents, &self.instead) {
            (Some(button), Some(instead)) => {
                format!("{taken}: would press \"{}\" instead of \"{}\"", said(button), said(instead))
            }
            (Some(button), None) => format!("{taken}: would press \"{}\" instead of waiting", said(button)),
            (None, Some(instead)) => format!("{taken}: would wait instead of pressing \"{}\"", said(instead)),
            (None, None) => taken,
        }
    }
}
