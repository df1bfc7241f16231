//! The assistant of a live session, which runs on a thread of its own and always answers the latest request.

use std::sync::mpsc::{Receiver, Sender, TryRecvError, channel};
use std::thread;

use tokio::sync::mpsc::{UnboundedReceiver, unbounded_channel};

use tomcom_core::communication::recommendation::Recommendation;
use tomcom_session::advisor::{AdviceRequest, Advisor};

/// A live session's connection to the assistant's thread.
#[derive(Debug)]
pub struct AdvisorThreadHandle {
    ask: Sender<AdviceRequest>,
    /// Recommendations of the assistant, in the order of the requests.
    pub answers: UnboundedReceiver<Recommendation>,
}

impl AdvisorThreadHandle {
    /// Starts the assistant's thread, which ends when the returned connection is dropped.
    pub fn start(mut advisor: Advisor) -> AdvisorThreadHandle {
        let (ask, questions) = channel::<AdviceRequest>();
        let (answer, answers) = unbounded_channel();
        thread::spawn(move || {
            let mut next = questions.recv().ok();
            while let Some(question) = next {
                // The newest request for advice replaces earlier ones that have not been answered.
                let newest = questions.try_iter().last().unwrap_or(question);
                if answer.send(advisor.answer(&newest)).is_err() {
                    return;
                }
                next = until_asked(&mut advisor, &newest, &questions);
            }
        });
        AdvisorThreadHandle { ask, answers }
    }

    /// Sends a request for advice to the assistant, which replaces an earlier request that has not been answered.
    pub fn ask(&self, question: AdviceRequest) {
        // If the assistant's thread has ended, the session continues without recommendations.
        let _ = self.ask.send(question);
    }
}

/// Waits for the next request for advice, and works ahead meanwhile if the session's settings say so; `None` once
/// nobody can send requests any more.
fn until_asked(
    advisor: &mut Advisor,
    last: &AdviceRequest,
    questions: &Receiver<AdviceRequest>,
) -> Option<AdviceRequest> {
    let mut next = Err(TryRecvError::Empty);
    if advisor.works_ahead {
        advisor.work_ahead(last, &mut || {
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
