//! An external concept that is waited for, as in a session without a console: a connection with its dialogue.

use std::time::Duration;

use super::concept::{ConceptDialogue, DialogueOutcome};
use super::{ExternalEvent, ExternalMinds, MindConnection, MindFault, MindNews, STARTS_WITHIN_S};
use crate::advisor::AdviceRequest;
use crate::{Event, Session};
use tomcom_core::communication::settings::ExternalMind;

/// An external concept, and the connection to it.
#[derive(Debug)]
pub struct WaitedConcept {
    dialogue: ConceptDialogue,
    connection: Option<MindConnection>,
}

/// What an exchange brought.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Exchange {
    pub events: Vec<Event>,
    /// Why the trial cannot go on.
    pub failed: Option<String>,
}

impl WaitedConcept {
    /// Starts the program and waits for its first answer.
    pub fn open(session: &Session, mind: &ExternalMind, minds: &dyn ExternalMinds) -> (WaitedConcept, Exchange) {
        let mut dialogue = ConceptDialogue::new(session, mind);
        match minds.open(mind) {
            Ok(connection) => {
                let begin = dialogue.begin(session);
                let mut waited = WaitedConcept { dialogue, connection: Some(connection) };
                let exchange = waited.exchange(begin, STARTS_WITHIN_S, Vec::new());
                (waited, exchange)
            }
            Err(found) => {
                let outcome = dialogue.failed(MindFault::NotStarted, &found);
                let failed = Some(format!("the external concept {}: {found}", MindFault::NotStarted.words()));
                (WaitedConcept { dialogue, connection: None }, Exchange { events: outcome.events, failed })
            }
        }
    }

    pub fn ask(&mut self, request: &AdviceRequest) -> Exchange {
        let (question, events) = self.dialogue.question(request);
        let wait_s = self.dialogue.mind().wait_s;
        self.exchange(question, wait_s, events)
    }

    /// Sends a question and waits for its answer. An answer that cannot be used counts as silence; what nobody asked for is
    /// passed over.
    fn exchange(&mut self, question: String, wait_s: f64, mut events: Vec<Event>) -> Exchange {
        let Some(connection) = &mut self.connection else { return Exchange::default() };
        let wait = Duration::from_secs_f64(wait_s);
        let mut news = connection.ask(question, wait);
        let ends = loop {
            let DialogueOutcome { events: mut told, ends } = match news {
                MindNews::Line(text) => self.dialogue.take(&text),
                MindNews::Nothing => {
                    let silent = self.dialogue.failed(MindFault::Silent, &format!("no answer within {wait_s} s"));
                    DialogueOutcome { ends: true, ..silent }
                }
                MindNews::Over(found) => self.dialogue.failed(MindFault::Ended, &found),
            };
            let is_passed_over = told.iter().all(is_of_no_question);
            events.append(&mut told);
            if ends || !self.dialogue.has_begun() {
                break true;
            }
            if !is_passed_over {
                break false;
            }
            news = connection.from.receive(wait);
        };
        let failed = ends.then(|| {
            self.connection = None;
            let words = events.iter().rev().find_map(|event| match event {
                Event::External(event) => event.words(),
                _ => None,
            });
            words.unwrap_or_default()
        });
        Exchange { events, failed }
    }
}

/// An answer to an earlier question, or to none: the present one still waits for its own.
pub(super) fn is_of_no_question(event: &Event) -> bool {
    matches!(
        event,
        Event::External(ExternalEvent::Late { .. } | ExternalEvent::Fault { fault: MindFault::Unasked, .. })
    )
}
