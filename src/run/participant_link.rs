//! A program in the participant's place in a live session: it is asked while the session goes on, and waited for by nobody.

use tokio::sync::mpsc::{Receiver, channel};

use super::assistant_link::{QUEUE, end, open};
use tomcom_core::base::time::SessionTime;
use tomcom_session::external::concept::DialogueOutcome;
use tomcom_session::external::participant::ParticipantDialogue;
use tomcom_session::external::{ExternalMinds, MindFault, MindNews, MindWriter};
use tomcom_session::{Event, Session};

#[derive(Debug)]
pub(super) struct ParticipantLink {
    dialogue: ParticipantDialogue,
    /// `None` once the program has ended.
    to: Option<Box<dyn MindWriter>>,
    news: Receiver<MindNews>,
}

impl ParticipantLink {
    /// `None` if a person or the engine is the participant. The events tell of a program that cannot be started.
    pub fn start(session: &Session, minds: &dyn ExternalMinds) -> (Option<ParticipantLink>, Vec<Event>) {
        let Some(command) = &session.spec.participant.external else { return (None, Vec::new()) };
        let mut dialogue = ParticipantDialogue::new(command);
        let (sender, news) = channel(QUEUE);
        match open(minds, dialogue.mind(), sender) {
            Ok(to) => {
                let [scene, _] = minds.sight(session);
                let begin = dialogue.begin(session, scene);
                let mut link = ParticipantLink { dialogue, to: Some(to), news };
                let events = link.send(begin);
                (Some(link), events)
            }
            Err(found) => {
                let events = dialogue.failed(MindFault::NotStarted, &found).events;
                (Some(ParticipantLink { dialogue, to: None, news }), events)
            }
        }
    }

    /// When it presses or wants to be asked again.
    pub fn due(&self, session: &Session) -> Option<SessionTime> {
        self.dialogue.due(session)
    }

    /// The events of the move that is due.
    pub fn act(&mut self, session: &Session) -> Vec<Event> {
        self.dialogue.act(session)
    }

    /// Asks it, if the display changed; tells it if it has not answered for long.
    pub fn look(&mut self, session: &Session, now: SessionTime, minds: &dyn ExternalMinds) -> Vec<Event> {
        let display = || {
            let [_, display] = minds.sight(session);
            display
        };
        match self.dialogue.question(session, now, display) {
            Some(question) => self.send(question),
            None => {
                let outcome = self.dialogue.silence(now);
                self.after(outcome)
            }
        }
    }

    /// The events of what came back.
    pub fn take(&mut self, session: &Session, news: MindNews) -> Vec<Event> {
        let outcome = match news {
            MindNews::Line(text) => self.dialogue.take(session, &text),
            MindNews::Nothing => DialogueOutcome::default(),
            MindNews::Over(found) => {
                let over = self.dialogue.failed(MindFault::Ended, &found);
                DialogueOutcome { ends: true, ..over }
            }
        };
        self.after(outcome)
    }

    fn send(&mut self, line: String) -> Vec<Event> {
        let Some(to) = &mut self.to else { return Vec::new() };
        match to.send(line) {
            Ok(()) => Vec::new(),
            Err(found) => {
                let outcome = self.dialogue.failed(MindFault::Silent, &found);
                self.after(outcome)
            }
        }
    }

    fn after(&mut self, outcome: DialogueOutcome) -> Vec<Event> {
        if outcome.ends {
            end(self.to.take());
        }
        outcome.events
    }
}

/// Waits for the program; waits forever without one.
pub(super) async fn next_line(link: &mut Option<ParticipantLink>) -> Option<MindNews> {
    match link {
        Some(ParticipantLink { to: Some(_), news, .. }) => news.recv().await,
        _ => std::future::pending().await,
    }
}
