//! A program in the participant's place in a live session.

use super::mind_link::MindLink;
use tomcom_core::base::time::SessionTime;
use tomcom_session::external::participant::ParticipantDialogue;
use tomcom_session::external::{ExternalMinds, MindNews};
use tomcom_session::{Event, Session};

#[derive(Debug)]
pub(super) struct ParticipantLink(MindLink<ParticipantDialogue>);

impl ParticipantLink {
    /// `None` if a person or the engine is the participant. The events tell of a program that cannot be started.
    pub fn start(session: &Session, minds: &dyn ExternalMinds) -> (Option<ParticipantLink>, Vec<Event>) {
        let Some(command) = &session.spec.participant.external else { return (None, Vec::new()) };
        let dialogue = ParticipantDialogue::new(command);
        let [scene, _] = minds.sight(session);
        let begin = dialogue.begin(session, scene);
        let (link, events) = MindLink::start(minds, dialogue, begin);
        (Some(ParticipantLink(link)), events)
    }

    /// When it presses or wants to be asked again.
    pub fn due(&self, session: &Session) -> Option<SessionTime> {
        self.0.dialogue.due(session)
    }

    /// The events of the move that is due.
    pub fn act(&mut self, session: &Session) -> Vec<Event> {
        self.0.dialogue.act(session)
    }

    /// Asks it, if the display changed; tells it if it has not answered for long.
    pub fn look(&mut self, session: &Session, now: SessionTime, minds: &dyn ExternalMinds) -> Vec<Event> {
        let display = || {
            let [_, display] = minds.sight(session);
            display
        };
        match self.0.dialogue.question(session, now, display) {
            Some(question) => self.0.send(question),
            None => {
                let outcome = self.0.dialogue.silence(now);
                self.0.after(outcome)
            }
        }
    }

    /// The events of what came back.
    pub fn take(&mut self, session: &Session, news: MindNews) -> Vec<Event> {
        self.0.take(news, |dialogue, text| dialogue.take(session, text))
    }
}

/// Waits for the program; waits forever without one.
pub(super) async fn next_line(link: &mut Option<ParticipantLink>) -> Option<MindNews> {
    match link {
        Some(ParticipantLink(link)) if !link.is_over() => link.next().await,
        _ => std::future::pending().await,
    }
}
