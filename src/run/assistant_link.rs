//! Who advises in a live session: the assistant's thread, or an external concept.

use std::thread;
use std::time::Duration;

use tokio::sync::mpsc::{Receiver, Sender, channel};

use super::advisor_thread::AdvisorThreadHandle;
use tomcom_core::communication::recommendation::Recommendation;
use tomcom_core::communication::settings::ExternalMind;
use tomcom_session::Event;
use tomcom_session::advisor::AdviceRequest;
use tomcom_session::engine::SessionEngine;
use tomcom_session::external::concept::{ConceptDialogue, DialogueOutcome};
use tomcom_session::external::{ExternalMinds, MindConnection, MindFault, MindNews, MindReader, MindWriter};

/// Number of lines that wait for the event loop; a program that sends more has to wait.
pub(super) const QUEUE: usize = 64;
/// Period in which the reading thread looks whether the session still wants lines.
const LOOKS: Duration = Duration::from_millis(200);

/// What comes back from whoever advises, and from a program in the participant's place.
#[derive(Debug)]
pub(super) enum AssistantNews {
    Advice(Box<Recommendation>),
    External(MindNews),
    Participant(MindNews),
}

/// A live session's connection to whoever advises.
#[derive(Debug)]
pub(super) enum AssistantLink {
    Own(AdvisorThreadHandle),
    External(Box<ExternalConcept>),
}

impl AssistantLink {
    /// `None` if the session asks nobody. The events tell of a program that cannot be started.
    pub fn start(engine: &SessionEngine, minds: &dyn ExternalMinds) -> (Option<AssistantLink>, Vec<Event>) {
        let spec = &engine.session().spec;
        match spec.external_concept() {
            Some(mind) => {
                let (concept, events) = ExternalConcept::start(engine, mind, minds);
                (Some(AssistantLink::External(Box::new(concept))), events)
            }
            None => {
                let asked = spec.asks_assistant().then(|| AdvisorThreadHandle::start(engine.advisor()));
                (asked.map(AssistantLink::Own), Vec::new())
            }
        }
    }

    /// Sends a request for advice; the events are for the session.
    pub fn ask(&mut self, request: AdviceRequest) -> Vec<Event> {
        match self {
            AssistantLink::Own(thread) => {
                thread.ask(request);
                Vec::new()
            }
            AssistantLink::External(concept) => concept.ask(&request),
        }
    }

    /// The events of what came back, for the session.
    pub fn take(&mut self, news: AssistantNews) -> Vec<Event> {
        match (self, news) {
            (_, AssistantNews::Advice(advice)) => vec![Event::Advised(*advice)],
            (AssistantLink::External(concept), AssistantNews::External(news)) => concept.take(news),
            (AssistantLink::Own(_), AssistantNews::External(_)) | (_, AssistantNews::Participant(_)) => Vec::new(),
        }
    }
}

/// Waits for whoever advises; waits forever if the session asks nobody.
pub(super) async fn next_news(link: &mut Option<AssistantLink>) -> Option<AssistantNews> {
    match link {
        Some(AssistantLink::Own(thread)) => thread.answers.recv().await.map(Box::new).map(AssistantNews::Advice),
        Some(AssistantLink::External(concept)) => concept.news.recv().await.map(AssistantNews::External),
        None => std::future::pending().await,
    }
}

/// An external concept that answers while the session goes on.
#[derive(Debug)]
pub(super) struct ExternalConcept {
    dialogue: ConceptDialogue,
    /// `None` once the program has ended.
    to: Option<Box<dyn MindWriter>>,
    news: Receiver<MindNews>,
}

impl ExternalConcept {
    fn start(engine: &SessionEngine, mind: &ExternalMind, minds: &dyn ExternalMinds) -> (ExternalConcept, Vec<Event>) {
        let session = engine.session();
        let mut dialogue = ConceptDialogue::new(session, mind);
        let (sender, news) = channel(QUEUE);
        match open(minds, mind, sender) {
            Ok(to) => {
                let begin = dialogue.begin(session);
                let mut concept = ExternalConcept { dialogue, to: Some(to), news };
                let events = concept.send(begin);
                (concept, events)
            }
            Err(found) => {
                let events = dialogue.failed(MindFault::NotStarted, &found).events;
                (ExternalConcept { dialogue, to: None, news }, events)
            }
        }
    }

    fn ask(&mut self, request: &AdviceRequest) -> Vec<Event> {
        if self.to.is_none() {
            return Vec::new();
        }
        let (question, mut events) = self.dialogue.question(request);
        events.extend(self.send(question));
        events
    }

    fn send(&mut self, line: String) -> Vec<Event> {
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

    fn take(&mut self, news: MindNews) -> Vec<Event> {
        let outcome = match news {
            MindNews::Line(text) => self.dialogue.take(&text),
            MindNews::Nothing => DialogueOutcome::default(),
            MindNews::Over(found) => {
                let over = self.dialogue.failed(MindFault::Ended, &found);
                DialogueOutcome { ends: true, ..over }
            }
        };
        self.after(outcome)
    }

    fn after(&mut self, outcome: DialogueOutcome) -> Vec<Event> {
        if outcome.ends {
            end(self.to.take());
        }
        outcome.events
    }
}

/// Opens a connection whose lines go to `news`.
pub(super) fn open(
    minds: &dyn ExternalMinds,
    mind: &ExternalMind,
    news: Sender<MindNews>,
) -> Result<Box<dyn MindWriter>, String> {
    let MindConnection { to, mut from } = minds.open(mind)?;
    thread::spawn(move || forward(&mut *from, &news));
    Ok(to)
}

/// Ends a program, which can take a second, for which the console does not wait.
pub(super) fn end(program: Option<Box<dyn MindWriter>>) {
    if let Some(to) = program {
        thread::spawn(move || drop(to));
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
