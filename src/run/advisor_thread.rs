//! The assistant of a live session, which runs on a thread of its own and always answers the latest request.

use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::mpsc::{Sender, channel};
use std::thread;

use tokio::sync::mpsc::{UnboundedReceiver, unbounded_channel};

use tomcom_core::communication::recommendation::Recommendation;
use tomcom_session::advisor::{AdviceRequest, Advisor};

/// A live session's connection to the assistant's thread.
#[derive(Debug)]
pub struct AdvisorThreadHandle {
    ask: Sender<AdviceRequest>,
    /// Number of requests that wait; working ahead ends when there is one.
    waiting: Arc<AtomicUsize>,
    /// Recommendations of the assistant, in the order of the requests.
    pub answers: UnboundedReceiver<Recommendation>,
}

impl AdvisorThreadHandle {
    /// Starts the assistant's thread, which ends when the returned connection is dropped. It computes an answer on
    /// several threads where the machine has them.
    pub fn start(mut advisor: Advisor) -> AdvisorThreadHandle {
        let (ask, questions) = channel::<AdviceRequest>();
        let (answer, answers) = unbounded_channel();
        let waiting = Arc::new(AtomicUsize::new(0));
        let asked = waiting.clone();
        thread::spawn(move || {
            advisor.use_threads(thread::available_parallelism().map_or(1, usize::from));
            while let Ok(question) = questions.recv() {
                // The newest request for advice replaces earlier ones that have not been answered.
                let mut newest = question;
                let mut taken = 1;
                for question in questions.try_iter() {
                    newest = question;
                    taken += 1;
                }
                asked.fetch_sub(taken, Ordering::Relaxed);
                if answer.send(advisor.answer(&newest)).is_err() {
                    return;
                }
                if advisor.works_ahead {
                    advisor.work_ahead(&newest, &|| asked.load(Ordering::Relaxed) == 0);
                }
            }
        });
        AdvisorThreadHandle { ask, waiting, answers }
    }

    /// Sends a request for advice to the assistant, which replaces an earlier request that has not been answered.
    pub fn ask(&self, question: AdviceRequest) {
        self.waiting.fetch_add(1, Ordering::Relaxed);
        // If the assistant's thread has ended, the session continues without recommendations.
        let _ = self.ask.send(question);
    }
}

impl Drop for AdvisorThreadHandle {
    fn drop(&mut self) {
        self.waiting.fetch_add(1, Ordering::Relaxed);
    }
}
