//! Actions that a running session has to perform after an event, and its timers.

use tomcom_core::base::time::SessionTime;
use tomcom_core::kitchen::LocationId;

/// An action that the running session must perform after an event. A replay performs none.
#[derive(Clone, Debug, PartialEq)]
pub enum SessionEffect {
    /// Set a timer; [`SessionEffect::Postpone`] can delay it.
    At {
        /// Session time at which the timer is due.
        time: SessionTime,
        /// What happens when the timer is due.
        timer: Timer,
    },
    /// Cancel a timer that has been set.
    Cancel(Timer),
    /// Cancel all timers, at the end of the trial.
    CancelAll,
    /// Postpone all timers by the length of a pause.
    Postpone(SessionTime),
    /// Close the recording, at the end of the session.
    Close,
}

/// A timer of a session: what happens when it is due.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Timer {
    /// The order location stops showing `served` after a dish was served.
    ClearOrder(LocationId),
    /// A new order appears at this location; the running session draws the ordered dish.
    NewOrder(LocationId),
    /// The display time of the shown signal is over.
    EndSignal,
    /// The set duration of the trial is over.
    EndTrial,
    /// The set number of presses that ends the trial was reached.
    EndTrialByPresses,
    /// The set number of served orders that ends the trial was reached.
    EndTrialByOrders,
    /// The rules of offers have to be asked whether an offer to the wizard opens or closes.
    ReviewOffer,
    /// The human has still not pressed after an unusually long time.
    HumanWaits,
}
