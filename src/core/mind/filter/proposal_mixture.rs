//! A press of the human as evidence of the human's belief, while the display may propose presses.

use crate::kitchen::ButtonId;

/// The likelihood of a press: p(a | belief) = `proposed` + `chosen` p(choice = a | belief). A press that the display
/// proposes may be made because of the proposal, which is equally likely under any belief.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ProposalMixture {
    /// The button that the human pressed.
    pub button: ButtonId,
    /// Probability that the human presses the button because the display proposes it.
    pub proposed: f64,
    /// Probability that the human follows a choice of its own rather than a proposal.
    pub chosen: f64,
}

impl ProposalMixture {
    /// A press of `button` while the display proposes `proposed`, by a human who makes proposed presses with the
    /// probability `follows`.
    pub fn new(button: ButtonId, proposed: Option<ButtonId>, follows: f64) -> ProposalMixture {
        match proposed {
            None => ProposalMixture { button, proposed: 0.0, chosen: 1.0 },
            Some(other) => {
                let proposed = if other == button { follows } else { 0.0 };
                ProposalMixture { button, proposed, chosen: 1.0 - follows }
            }
        }
    }

    /// p(a | belief), from the probability `choice` that a human with the belief chooses the button.
    #[inline]
    pub fn likelihood(&self, choice: f64) -> f64 {
        self.proposed + self.chosen * choice
    }
}
