//! A program that is waited for, as in a session without a console: the dialogue with it, and its connection.

use std::time::Duration;

use super::{
    DialogueOutcome, ExternalEvent, ExternalMinds, MindConnection, MindDialogue, MindFault, MindNews, STARTS_WITHIN_S,
};
use crate::Event;

/// The dialogue with a program that is waited for.
#[derive(Debug)]
pub struct WaitedMind<D> {
    pub dialogue: D,
    /// `None` once the program has ended.
    connection: Option<MindConnection>,
}

/// What an exchange brought.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Exchange {
    pub events: Vec<Event>,
    /// Why the trial cannot go on.
    pub failed: Option<String>,
}

impl<D: MindDialogue> WaitedMind<D> {
    /// Starts the program, sends its first question and waits for the answer, which `take` takes.
    pub fn open(
        minds: &dyn ExternalMinds,
        mut dialogue: D,
        begin: String,
        take: impl FnMut(&mut D, &str) -> DialogueOutcome,
    ) -> (WaitedMind<D>, Exchange) {
        match minds.open(dialogue.mind()) {
            Ok(connection) => {
                let mut waited = WaitedMind { dialogue, connection: Some(connection) };
                let exchange = waited.exchange(begin, STARTS_WITHIN_S, take);
                (waited, exchange)
            }
            Err(found) => {
                let DialogueOutcome { events, .. } = dialogue.failed(MindFault::NotStarted, &found);
                let failed = Some(last_words(&events));
                (WaitedMind { dialogue, connection: None }, Exchange { events, failed })
            }
        }
    }

    /// Sends a question and waits for its answer, at most `wait_s` seconds. An answer that cannot be used counts as silence;
    /// what nobody asked for is passed over.
    pub fn exchange(
        &mut self,
        question: String,
        wait_s: f64,
        mut take: impl FnMut(&mut D, &str) -> DialogueOutcome,
    ) -> Exchange {
        let Some(connection) = &mut self.connection else { return Exchange::default() };
        let wait = Duration::from_secs_f64(wait_s);
        let mut news = connection.ask(question, wait);
        let mut events = Vec::new();
        let ends = loop {
            let DialogueOutcome { events: mut told, ends } = match news {
                MindNews::Line(text) => take(&mut self.dialogue, &text),
                MindNews::Nothing => {
                    let silent = self.dialogue.failed(MindFault::Silent, &format!("no answer within {wait_s} s"));
                    DialogueOutcome { ends: true, ..silent }
                }
                MindNews::Over(found) => self.dialogue.failed(MindFault::Ended, &found),
            };
            let is_passed_over = !told.is_empty() && told.iter().all(is_of_no_question);
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
            last_words(&events)
        });
        Exchange { events, failed }
    }
}

/// What the last event of a program says, in words.
fn last_words(events: &[Event]) -> String {
    let words = events.iter().rev().find_map(|event| match event {
        Event::External(event) => event.words(),
        _ => None,
    });
    words.unwrap_or_default()
}

/// An answer to an earlier question, or to none: the present one still waits for its own.
fn is_of_no_question(event: &Event) -> bool {
    matches!(
        event,
        Event::External(ExternalEvent::Late { .. } | ExternalEvent::Fault { fault: MindFault::Unasked, .. })
    )
}
