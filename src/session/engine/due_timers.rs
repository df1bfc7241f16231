//! The timers of a running session: sets, postpones and cancels them as applied events ask for, and turns a due timer
//! into an event.

use super::SessionEngine;
use crate::event::{SignalEndReason, TrialEndReason};
use crate::silence;
use crate::{Event, SessionEffect, Timer};
use tomcom_core::base::time::SessionTime;

impl SessionEngine {
    /// Performs what an applied event asks of the running session.
    pub(super) fn perform(&mut self, effect: SessionEffect) {
        match effect {
            SessionEffect::At { time, timer } => self.timers.set(time, timer),
            SessionEffect::Cancel(timer) => self.timers.cancel(timer),
            SessionEffect::CancelAll => {
                self.timers.cancel_all();
                self.robot.rest();
            }
            SessionEffect::Postpone(by) => {
                self.timers.postpone(by);
                self.robot.postpone(by);
                if let Some(participant) = &mut self.participant {
                    participant.postpone(by);
                }
                if let Some(wizard) = &mut self.wizard {
                    wizard.postpone(by);
                }
            }
            SessionEffect::Close => {}
        }
    }

    /// Records the event of the first timer, which is due.
    pub(super) fn fire_timer(&mut self, now: SessionTime) {
        let Some(timer) = self.timers.take_first() else { return };
        let kitchen = self.session().kitchen.clone();
        let event = match timer {
            Timer::ClearOrder(order) => Event::OrderCleared { order: kitchen.location(order).name.clone() },
            Timer::NewOrder(order) => {
                let dish = kitchen.dish(self.orders.draw()).name.clone();
                Event::OrderShown { order: kitchen.location(order).name.clone(), dish }
            }
            Timer::EndSignal => Event::SignalEnded { reason: SignalEndReason::Elapsed },
            Timer::EndTrial => Event::TrialEnded { reason: TrialEndReason::Time },
            Timer::EndTrialByOrders => Event::TrialEnded { reason: TrialEndReason::Orders },
            Timer::EndTrialByPresses => Event::TrialEnded { reason: TrialEndReason::Presses },
            Timer::HumanWaits => Event::HumanWaits { silent_ns: silence::lasted(self.session(), now) },
            Timer::ReviewOffer => return self.review_offer(now),
        };
        self.record_own(now, event);
    }
}
