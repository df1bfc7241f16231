//! Who advises in a live session: the assistant's thread, or an external concept.

use super::advisor_thread::AdvisorThreadHandle;
use super::mind_link::MindLink;
use tomcom_core::communication::recommendation::Recommendation;
use tomcom_session::Event;
use tomcom_session::advisor::AdviceRequest;
use tomcom_session::engine::SessionEngine;
use tomcom_session::external::concept::ConceptDialogue;
use tomcom_session::external::{ExternalMinds, MindNews};

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
    External(Box<MindLink<ConceptDialogue>>),
}

impl AssistantLink {
    /// `None` if the session asks nobody. The events tell of a program that cannot be started.
    pub fn start(engine: &SessionEngine, minds: &dyn ExternalMinds) -> (Option<AssistantLink>, Vec<Event>) {
        let spec = &engine.session().spec;
        match spec.external_concept() {
            Some(mind) => {
                let session = engine.session();
                let dialogue = ConceptDialogue::new(session, mind);
                let begin = dialogue.begin(session);
                let (concept, events) = MindLink::start(minds, dialogue, begin);
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
            AssistantLink::External(concept) if concept.is_over() => Vec::new(),
            AssistantLink::External(concept) => {
                let (question, mut events) = concept.dialogue.question(&request);
                events.extend(concept.send(question));
                events
            }
        }
    }

    /// The events of what came back, for the session.
    pub fn take(&mut self, news: AssistantNews) -> Vec<Event> {
        match (self, news) {
            (_, AssistantNews::Advice(advice)) => vec![Event::Advised(*advice)],
            (AssistantLink::External(concept), AssistantNews::External(news)) => {
                concept.take(news, |dialogue, text| dialogue.take(text))
            }
            (AssistantLink::Own(_), AssistantNews::External(_)) | (_, AssistantNews::Participant(_)) => Vec::new(),
        }
    }
}

/// Waits for whoever advises; waits forever if the session asks nobody.
pub(super) async fn next_news(link: &mut Option<AssistantLink>) -> Option<AssistantNews> {
    match link {
        Some(AssistantLink::Own(thread)) => thread.answers.recv().await.map(Box::new).map(AssistantNews::Advice),
        Some(AssistantLink::External(concept)) => concept.next().await.map(AssistantNews::External),
        None => std::future::pending().await,
    }
}
