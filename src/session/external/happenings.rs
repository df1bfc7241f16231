//! What happened since the last question: what the participant looked at and pressed, what the robot did, orders and
//! signals.

use serde::Serialize;

use crate::{Event, Session, TimestampedEvent};
use tomcom_core::communication::Signal;
use tomcom_core::kitchen::{Agent, KitchenChange, LocationId};
use tomcom_core::measures::JudgedPress;

/// Number of happenings that a question tells; of more, the latest are told.
const MOST: usize = 200;

/// One happening, by the trial's clock.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Happening {
    pub at_s: f64,
    #[serde(flatten)]
    pub what: HappeningKind,
}

#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(tag = "what", rename_all = "snake_case")]
pub enum HappeningKind {
    /// A run of gaze samples in one location's area.
    Look { location: String, for_s: f64 },
    /// By either agent.
    Press {
        by: &'static str,
        button: String,
        effective: bool,
        /// Whether a press of the human was an error: it took the kitchen further from serving all orders.
        #[serde(skip_serializing_if = "Option::is_none")]
        error: Option<bool>,
    },
    /// It appeared.
    Order { order: String, dish: String },
    /// Once it was served.
    OrderCleared { order: String },
    /// It was shown to the participant.
    Signal { signal: Signal },
    /// It disappeared.
    SignalEnded,
    /// The human has not pressed for unusually long.
    HumanWaits { silent_s: f64 },
}

/// Collects happenings between questions.
#[derive(Clone, Debug, Default)]
pub struct Happenings {
    since: Vec<Happening>,
    /// The present look: its location, its number in `since`, and when it began.
    look: Option<(LocationId, usize, f64)>,
}

fn rounded_s(seconds: f64) -> f64 {
    (seconds * 1e3).round() / 1e3
}

impl Happenings {
    /// Takes note of an event that was just applied; `judged`: the judgement of the press, if it is one of the human.
    pub fn note(
        &mut self,
        session: &Session,
        stamped: &TimestampedEvent,
        change: &KitchenChange,
        judged: Option<&JudgedPress>,
    ) {
        let at_s = rounded_s(session.trial_clock_at(stamped.time).as_secs_f64());
        let kitchen = &session.kitchen;
        if let KitchenChange::Press { press, .. } = change {
            let button = kitchen.button(press.agent, press.button).name.clone();
            let error = judged.filter(|_| press.agent == Agent::Human).map(|judged| judged.verdict.error);
            self.add(at_s, HappeningKind::Press { by: press.agent.name(), button, effective: press.effective, error });
        }
        match &stamped.event {
            Event::TrialStarted => *self = Happenings::default(),
            Event::Gaze(_) => self.looked(session, at_s),
            Event::OrderShown { order, dish } => {
                self.add(at_s, HappeningKind::Order { order: order.clone(), dish: dish.clone() });
            }
            Event::OrderCleared { order } => self.add(at_s, HappeningKind::OrderCleared { order: order.clone() }),
            Event::SignalShown { signal, .. } => self.add(at_s, HappeningKind::Signal { signal: signal.clone() }),
            Event::SignalEnded { .. } => self.add(at_s, HappeningKind::SignalEnded),
            Event::HumanWaits { silent_ns } => {
                self.add(at_s, HappeningKind::HumanWaits { silent_s: rounded_s(silent_ns.as_secs_f64()) });
            }
            _ => {}
        }
    }

    fn looked(&mut self, session: &Session, at_s: f64) {
        let Some(location) = session.looked_at() else {
            self.look = None;
            return;
        };
        if let Some((_, index, began_s)) = self.look.filter(|(known, ..)| *known == location)
            && let Some(HappeningKind::Look { for_s, .. }) = self.since.get_mut(index).map(|one| &mut one.what)
        {
            *for_s = rounded_s(at_s - began_s);
            return;
        }
        self.add(at_s, HappeningKind::Look { location: session.kitchen.location(location).name.clone(), for_s: 0.0 });
        self.look = Some((location, self.since.len() - 1, at_s));
    }

    fn add(&mut self, at_s: f64, what: HappeningKind) {
        if self.since.len() == 2 * MOST {
            self.since.drain(..MOST);
            self.look = None;
        }
        self.since.push(Happening { at_s, what });
    }

    /// Those since the last call. A look that goes on is told again with the next ones.
    pub fn take(&mut self) -> Vec<Happening> {
        self.look = None;
        let mut since = std::mem::take(&mut self.since);
        since.drain(..since.len().saturating_sub(MOST));
        since
    }
}
