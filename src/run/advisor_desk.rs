//! The assistant of a live session, which runs on a thread of its own and always answers the latest request.

use std::sync::mpsc::{Sender, channel};
use std::thread;

use tokio::sync::mpsc::{UnboundedReceiver, unbounded_channel};

use crate::analysis::advisor::{AdviceRequest, Advisor};
use crate::communication::recommendation::Recommendation;

impl Advisor {
    /// Starts the assistant's thread, which ends when the returned desk is dropped.
    pub fn on_thread(mut self) -> LiveAdvisor {
        let (ask, questions) = channel::<AdviceRequest>();
        let (answer, answers) = unbounded_channel();
        thread::spawn(move || {
            while let Ok(question) = questions.recv() {
                // The newest request replaces earlier ones that have not been answered.
                let newest = questions.try_iter().last().unwrap_or(question);
                if answer.send(self.answer(&newest)).is_err() {
                    return;
                }
            }
        });
        LiveAdvisor { ask, answers }
    }
}

/// A live session's connection to the assistant's thread.
#[derive(Debug)]
pub struct LiveAdvisor {
    ask: Sender<AdviceRequest>,
    /// Recommendations of the assistant, in the order of the requests.
    pub answers: UnboundedReceiver<Recommendation>,
}

impl LiveAdvisor {
    /// Sends a request for advice, which replaces an earlier one that has not been answered.
    pub fn ask(&self, question: AdviceRequest) {
        // If the assistant's thread has ended, the session continues without recommendations.
        let _ = self.ask.send(question);
    }
}

/// Waits for the assistant's next recommendation; forever if the session has no assistant.
pub async fn next_advice(advisor: &mut Option<LiveAdvisor>) -> Option<Recommendation> {
    match advisor {
        Some(desk) => desk.answers.recv().await,
        None => std::future::pending().await,
    }
}
