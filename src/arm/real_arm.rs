//! A real arm, as far as the session knows it: what was reported last, and the order for its driver. It has no time of its
//! own, and nothing about it is predicted.

use tomcom_core::kitchen::{ButtonId, State};
use tomcom_core::robot::{ArmPhase, SafetyMode};

/// What the driver of a real arm is to do now.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct ArmOrder {
    /// Number of the press: a second press of the same button has another one.
    pub number: u32,
    /// The button above which the arm is to be; `None`: it goes up where it is.
    pub button: Option<ButtonId>,
    /// Whether it is to press the button.
    pub may_press: bool,
    /// Whether it is to stand still where it is.
    pub stands: bool,
}

#[derive(Clone, Debug, Default)]
pub struct RealArm {
    order: ArmOrder,
    phase: ArmPhase,
    mode: SafetyMode,
    is_ready: bool,
    /// The state of the kitchen in which the present press was last found useful.
    found_useful: Option<State>,
}

impl RealArm {
    pub(crate) fn order(&self, stands: bool) -> ArmOrder {
        ArmOrder { may_press: self.found_useful.is_some(), stands, ..self.order }
    }

    /// Whether the arm takes orders.
    pub(crate) fn is_able(&self) -> bool {
        self.is_ready && !self.mode.is_stopped()
    }

    pub(crate) fn set_out(&mut self, button: ButtonId) {
        let number = self.order.number + 1;
        self.order = ArmOrder { number, button: Some(button), ..ArmOrder::default() };
        // Where the arm was said to be was above another button.
        (self.found_useful, self.phase) = (None, ArmPhase::Travels);
    }

    pub(crate) fn give_up(&mut self) {
        (self.order.button, self.found_useful) = (None, None);
    }

    /// Whether the caller now has to decide if the press is still useful: above the button, and whenever the state changes
    /// before the button clicks.
    pub(crate) fn asks(&self, may_press: bool, state: State) -> bool {
        match self.found_useful {
            None => self.phase == ArmPhase::Hovers && may_press && self.is_able(),
            Some(found) => found != state,
        }
    }

    pub(crate) fn go_for_it(&mut self, state: State) {
        self.found_useful = Some(state);
    }

    pub(crate) fn moves(&mut self, phase: ArmPhase) {
        self.phase = phase;
    }

    pub(crate) fn changes(&mut self, is_ready: bool, mode: SafetyMode) {
        (self.is_ready, self.mode) = (is_ready, mode);
    }
}
