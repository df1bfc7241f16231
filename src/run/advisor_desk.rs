//! The assistant of a live session, on a thread of its own, where the newest question goes first.

use std::sync::mpsc::{Sender, channel};
use std::thread;

use tokio::sync::mpsc::{UnboundedReceiver, unbounded_channel};

use crate::analysis::advisor::{AdviceRequest, Advisor};
use crate::communication::recommendation::Recommendation;

impl Advisor {
    /// Answers on a thread of its own, which ends with the desk that asks.
    pub fn on_thread(mut self) -> AdvisorDesk {
        let (ask, questions) = channel::<AdviceRequest>();
        let (answer, answers) = unbounded_channel();
        thread::spawn(move || {
            while let Ok(question) = questions.recv() {
                // What was asked meanwhile is newer.
                let newest = questions.try_iter().last().unwrap_or(question);
                if answer.send(self.answer(&newest)).is_err() {
                    return;
                }
            }
        });
        AdvisorDesk { ask, answers }
    }
}

/// Where a live session asks, and where the answers come.
#[derive(Debug)]
pub struct AdvisorDesk {
    ask: Sender<AdviceRequest>,
    pub answers: UnboundedReceiver<Recommendation>,
}

impl AdvisorDesk {
    /// Asks; the answer comes when it is there, or is overtaken by a newer question.
    pub fn ask(&self, question: AdviceRequest) {
        // A thread that is gone answers nothing more, and the session goes on without advice.
        let _ = self.ask.send(question);
    }
}

/// The assistant's next answer; never, if nobody asks it.
pub async fn next_advice(advisor: &mut Option<AdvisorDesk>) -> Option<Recommendation> {
    match advisor {
        Some(desk) => desk.answers.recv().await,
        None => std::future::pending().await,
    }
}
