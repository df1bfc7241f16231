//! The assistant of a live session on its own thread, which always answers the latest request.

use std::sync::mpsc::{Receiver, Sender, TryRecvError, channel};
use std::thread;

use tokio::sync::mpsc::{UnboundedReceiver, unbounded_channel};

use crate::analysis::advisor::{AdviceRequest, Advisor};
use crate::communication::recommendation::Recommendation;

impl Advisor {
    /// Starts the advisor's thread, which ends when the desk is dropped.
    pub fn on_thread(mut self) -> AdvisorDesk {
        let (ask, questions) = channel::<AdviceRequest>();
        let (answer, answers) = unbounded_channel();
        thread::spawn(move || {
            let mut next = questions.recv().ok();
            while let Some(question) = next {
                // A newer request replaces this one.
                let newest = questions.try_iter().last().unwrap_or(question);
                if answer.send(self.answer(&newest)).is_err() {
                    return;
                }
                next = self.until_asked(&newest, &questions);
            }
        });
        AdvisorDesk { ask, answers }
    }

    /// Waits for the next request, and works ahead meanwhile if the session's settings say so; `None` once nobody asks any more.
    fn until_asked(&mut self, last: &AdviceRequest, questions: &Receiver<AdviceRequest>) -> Option<AdviceRequest> {
        let mut next = Err(TryRecvError::Empty);
        if self.works_ahead {
            self.work_ahead(last, &mut || {
                if matches!(next, Err(TryRecvError::Empty)) {
                    next = questions.try_recv();
                }
                matches!(next, Err(TryRecvError::Empty))
            });
        }
        match next {
            Ok(question) => Some(question),
            Err(TryRecvError::Empty) => questions.recv().ok(),
            Err(TryRecvError::Disconnected) => None,
        }
    }
}

/// The session's connection to the advisor's thread.
#[derive(Debug)]
pub struct AdvisorDesk {
    ask: Sender<AdviceRequest>,
    /// The recommendations, in the order of the requests.
    pub answers: UnboundedReceiver<Recommendation>,
}

impl AdvisorDesk {
    /// Sends a request; a newer request replaces one that has not been answered.
    pub fn ask(&self, question: AdviceRequest) {
        // If the thread has ended, the session continues without recommendations.
        let _ = self.ask.send(question);
    }
}

/// Waits for the next recommendation; forever if there is no advisor.
pub async fn next_advice(advisor: &mut Option<AdvisorDesk>) -> Option<Recommendation> {
    match advisor {
        Some(desk) => desk.answers.recv().await,
        None => std::future::pending().await,
    }
}
