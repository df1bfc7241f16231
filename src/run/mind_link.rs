//! A program that answers while a live session goes on, and for which nobody waits: an external concept, or a program in
//! the participant's place.

use std::thread;
use std::time::Duration;

use tokio::sync::mpsc::{Receiver, Sender, channel};

use tomcom_session::Event;
use tomcom_session::external::{
    DialogueOutcome, ExternalMinds, MindConnection, MindDialogue, MindFault, MindNews, MindReader, MindWriter,
};

/// Number of lines that wait for the event loop; a program that sends more has to wait.
const QUEUE: usize = 64;
/// Period in which the reading thread looks whether the session still wants lines.
const LOOKS: Duration = Duration::from_millis(200);

/// The dialogue with a program, and its connection.
#[derive(Debug)]
pub(super) struct MindLink<D> {
    pub dialogue: D,
    /// `None` once the program has ended.
    to: Option<Box<dyn MindWriter>>,
    news: Receiver<MindNews>,
}

impl<D: MindDialogue> MindLink<D> {
    /// Starts the program and sends its first question, `begin`. The events tell of one that cannot be started.
    pub fn start(minds: &dyn ExternalMinds, mut dialogue: D, begin: String) -> (MindLink<D>, Vec<Event>) {
        let (sender, news) = channel(QUEUE);
        match minds.open(dialogue.mind()) {
            Ok(MindConnection { to, mut from }) => {
                thread::spawn(move || forward(&mut *from, &sender));
                let mut link = MindLink { dialogue, to: Some(to), news };
                let events = link.send(begin);
                (link, events)
            }
            Err(found) => {
                let events = dialogue.failed(MindFault::NotStarted, &found).events;
                (MindLink { dialogue, to: None, news }, events)
            }
        }
    }

    /// Whether the program has ended.
    pub fn is_over(&self) -> bool {
        self.to.is_none()
    }

    pub fn send(&mut self, line: String) -> Vec<Event> {
        let Some(to) = &mut self.to else { return Vec::new() };
        match to.send(line) {
            Ok(()) => Vec::new(),
            // A program that has ended says so on the way back; one that reads nothing is silent.
            Err(found) => {
                let outcome = self.dialogue.failed(MindFault::Silent, &found);
                self.after(outcome)
            }
        }
    }

    /// The events of what came back; `answer` takes a line.
    pub fn take(&mut self, news: MindNews, answer: impl FnOnce(&mut D, &str) -> DialogueOutcome) -> Vec<Event> {
        let outcome = match news {
            MindNews::Line(text) => answer(&mut self.dialogue, &text),
            MindNews::Nothing => DialogueOutcome::default(),
            MindNews::Over(found) => {
                let over = self.dialogue.failed(MindFault::Ended, &found);
                DialogueOutcome { ends: true, ..over }
            }
        };
        self.after(outcome)
    }

    pub fn after(&mut self, outcome: DialogueOutcome) -> Vec<Event> {
        // The end of a program can take a second.
        if let Some(to) = self.to.take_if(|_| outcome.ends) {
            thread::spawn(move || drop(to));
        }
        outcome.events
    }

    /// What the program sends next; `None` after its last line.
    pub async fn next(&mut self) -> Option<MindNews> {
        self.news.recv().await
    }
}

/// Passes lines on until nobody wants them or none can come.
fn forward(from: &mut dyn MindReader, to: &Sender<MindNews>) {
    while !to.is_closed() {
        let news = from.receive(LOOKS);
        let is_over = matches!(news, MindNews::Over(_));
        if news != MindNews::Nothing && to.blocking_send(news).is_err() || is_over {
            return;
        }
    }
}
