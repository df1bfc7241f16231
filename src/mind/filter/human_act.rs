//! What the human does, as evidence of its belief.

use crate::kitchen::ButtonId;

/// A press as evidence: p(a | belief) = `proposed` + `chosen` p(choice = a | belief). A proposed press may be made because it is proposed,
/// which any belief makes equally likely.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PressMixture {
    /// The pressed button.
    pub button: ButtonId,
    /// Probability that it is pressed because it is proposed.
    pub proposed: f64,
    /// Probability that the human presses what it chooses itself.
    pub chosen: f64,
}

impl PressMixture {
    /// A press while `proposed` is proposed, by a human who makes proposed presses with the probability `follows`.
    pub fn new(button: ButtonId, proposed: Option<ButtonId>, follows: f64) -> PressMixture {
        match proposed {
            None => PressMixture { button, proposed: 0.0, chosen: 1.0 },
            Some(other) => {
                let proposed = if other == button { follows } else { 0.0 };
                PressMixture { button, proposed, chosen: 1.0 - follows }
            }
        }
    }

    /// p(a | belief), from the probability that a human with the belief chooses the button.
    #[inline]
    pub fn likelihood(&self, choice: f64) -> f64 {
        self.proposed + self.chosen * choice
    }
}

/// What the human does, as evidence of its belief b.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum HumanAct {
    /// It presses a button. Likelihood: that of the mixture, times 1 - p(wait | b) where waiting is evidence.
    Presses(PressMixture),
    /// It has not pressed for longer than usual. Likelihood: l + (1 - l) p(wait | b), where l is the share of its intervals that are
    /// longer: it still thinks, or has decided to wait.
    Waits {
        /// Share of its own intervals that are longer.
        longer: f64,
    },
}
