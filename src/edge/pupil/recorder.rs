//! What is asked of Capture's recorder, and when its recording is annotated. It decides; the desk carries out.
//!
//! Capture answers `OK` to a request for a recording before it has begun: an annotation before `recording.started` is in no recording. A
//! request while Capture records already has no effect and no notification, so a recording that was not announced is not ours, and is
//! never ended by us. Capture handles requests before annotations in each of its frames, so a recording ends some frames after its last
//! annotation.

use std::collections::VecDeque;
use std::time::{Duration, Instant};

use tokio::sync::oneshot;

use super::message::RecorderNews;
use crate::session::tracker::TrackerRecording;

/// Longest time from a request to the beginning of the recording.
const BEGINS_WITHIN: Duration = Duration::from_secs(3);
/// Longest time until the annotation plugin listens.
const LISTENS_WITHIN: Duration = Duration::from_millis(1500);
/// Time from the last annotation to the end of the recording: some frames of Capture.
const LAST_FRAMES: Duration = Duration::from_millis(500);

/// A request to Capture.
#[derive(Debug)]
pub enum CaptureRequest {
    /// Start a recording with this name.
    Record(String),
    /// End the recording.
    StopRecording,
    /// Annotate its recording with an event.
    Annotate {
        /// The event.
        label: String,
        /// When it happened.
        at: Instant,
        /// What holds from now on, for a recording that begins later: the labels of the trial's state.
        state: Vec<String>,
    },
    /// Report when all earlier requests have been carried out.
    Report(oneshot::Sender<()>),
}

/// What is to be done now.
#[derive(Debug)]
pub enum CaptureAction {
    /// Request a recording with this name.
    Start(String),
    /// Request the end of the recording.
    Stop,
    /// Send an annotation.
    Annotate {
        /// The event.
        label: String,
        /// When it happened.
        at: Instant,
        /// The annotation stands at the beginning of the recording, if the event was before it.
        not_before: Option<Instant>,
    },
    /// Tell what became of the recording.
    Tell(TrackerRecording),
    /// Everything before is done.
    Report(oneshot::Sender<()>),
}

/// Whose recording runs in Capture while we want one.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum RecordingOwner {
    /// None is known.
    Nobody,
    /// It began at our request.
    Us,
    /// The lab began it, or none could begin.
    Lab,
}

/// What holds back further requests.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Hold {
    /// The recording is about to begin, at the latest then.
    Beginning(Instant),
    /// It ends then.
    Ending(Instant),
}

/// The state of Capture's recording as far as we know it.
#[derive(Debug)]
pub struct CaptureRecorder {
    /// Whether Capture is to record; annotated is it in any case.
    records: bool,
    /// The name of the recording that is wanted now.
    wanted: Option<String>,
    owner: RecordingOwner,
    /// When the present recording was announced.
    since: Option<Instant>,
    hold: Option<Hold>,
    /// Until when the annotation plugin is waited for.
    listens_by: Option<Instant>,
    /// Whether the next recording is told the state of the trial.
    resumes: bool,
    /// The labels of the trial's state.
    state: Vec<String>,
    waiting: VecDeque<CaptureRequest>,
}

impl CaptureRecorder {
    /// A recorder that knows nothing of Capture yet.
    pub fn new(records: bool) -> CaptureRecorder {
        CaptureRecorder {
            records,
            wanted: None,
            owner: RecordingOwner::Nobody,
            since: None,
            hold: None,
            listens_by: None,
            resumes: false,
            state: Vec::new(),
            waiting: VecDeque::new(),
        }
    }

    /// Takes a request that waits until Capture is connected.
    pub fn queue(&mut self, request: CaptureRequest) {
        self.waiting.push_back(request);
    }

    /// Capture is connected. `is_same_run`: it was not restarted since it was connected last; `listens`: its annotation plugin runs.
    pub fn connected(&mut self, now: Instant, is_same_run: bool, listens: bool) -> Vec<CaptureAction> {
        let mut actions = Vec::new();
        self.listens_by = (!listens).then_some(now + LISTENS_WITHIN);
        let is_ours = is_same_run && self.owner == RecordingOwner::Us;
        self.owner = if is_ours { RecordingOwner::Us } else { RecordingOwner::Nobody };
        // What ended while nobody answered is in no recording.
        if let Some(last) = self.waiting.iter().rposition(|request| matches!(request, CaptureRequest::StopRecording)) {
            self.waiting.drain(..=last);
            self.wanted = None;
            self.state.clear();
        }
        if is_ours && self.wanted.is_none() {
            self.stop(&mut actions);
        }
        self.resumes = !self.state.is_empty();
        match self.wanted.clone() {
            Some(name) => self.start(name, now, &mut actions),
            None => self.resume(now),
        }
        self.go_on(now, &mut actions);
        actions
    }

    /// The connection is lost.
    pub fn disconnected(&mut self) {
        (self.hold, self.listens_by) = (None, None);
    }

    /// Takes a request.
    pub fn order(&mut self, request: CaptureRequest, now: Instant) -> Vec<CaptureAction> {
        self.waiting.push_back(request);
        let mut actions = Vec::new();
        self.go_on(now, &mut actions);
        actions
    }

    /// The annotation plugin listens now.
    pub fn listens(&mut self, now: Instant) -> Vec<CaptureAction> {
        self.listens_by = None;
        let mut actions = Vec::new();
        self.go_on(now, &mut actions);
        actions
    }

    /// Takes what Capture's recorder told.
    pub fn heard(&mut self, news: RecorderNews, now: Instant) -> Vec<CaptureAction> {
        let mut actions = Vec::new();
        let is_beginning = matches!(self.hold, Some(Hold::Beginning(_)));
        match news {
            RecorderNews::Started(name)
                if self.wanted.as_ref() == Some(&name) && (is_beginning || self.is_overdue()) =>
            {
                // What was annotated before it began is not in it.
                self.resumes |= !is_beginning;
                (self.owner, self.since) = (RecordingOwner::Us, Some(now));
                actions.push(CaptureAction::Tell(TrackerRecording::Begun));
                self.begun(now);
            }
            RecorderNews::Started(_) if is_beginning => self.is_not_ours(now, &mut actions),
            RecorderNews::Started(_) => {}
            RecorderNews::Stopped if matches!(self.hold, Some(Hold::Ending(_))) => {
                (self.hold, self.owner) = (None, RecordingOwner::Nobody);
            }
            RecorderNews::Stopped if self.wanted.is_some() && self.owner != RecordingOwner::Nobody => {
                self.owner = RecordingOwner::Nobody;
                actions.push(CaptureAction::Tell(TrackerRecording::Ended));
            }
            RecorderNews::Stopped => {}
        }
        self.go_on(now, &mut actions);
        actions
    }

    /// Whether a recording of ours may still begin, later than it should have.
    fn is_overdue(&self) -> bool {
        self.owner == RecordingOwner::Lab && self.since.is_none()
    }

    /// When something is to be done without further news.
    pub fn due(&self) -> Option<Instant> {
        let hold = self.hold.map(|hold| match hold {
            Hold::Beginning(by) | Hold::Ending(by) => by,
        });
        hold.into_iter().chain(self.listens_by).min()
    }

    /// Does what is due.
    pub fn pass(&mut self, now: Instant) -> Vec<CaptureAction> {
        let mut actions = Vec::new();
        if self.listens_by.is_some_and(|by| by <= now) {
            self.listens_by = None;
            actions.push(CaptureAction::Tell(TrackerRecording::NotAnnotated));
        }
        match self.hold {
            Some(Hold::Beginning(by)) if by <= now => match self.owner {
                // After a loss of the connection our recording may run on, which is not announced again.
                RecordingOwner::Us => self.begun(now),
                RecordingOwner::Nobody | RecordingOwner::Lab => self.is_not_ours(now, &mut actions),
            },
            Some(Hold::Ending(by)) if by <= now => self.stop(&mut actions),
            _ => {}
        }
        self.go_on(now, &mut actions);
        actions
    }

    fn is_not_ours(&mut self, now: Instant, actions: &mut Vec<CaptureAction>) {
        (self.owner, self.since) = (RecordingOwner::Lab, None);
        actions.push(CaptureAction::Tell(TrackerRecording::NotBegun));
        self.begun(now);
    }

    fn begun(&mut self, now: Instant) {
        self.hold = None;
        self.resume(now);
    }

    /// Annotates the state of the trial before anything else, if the recording began in the middle of it.
    fn resume(&mut self, now: Instant) {
        if !std::mem::take(&mut self.resumes) {
            return;
        }
        for label in self.state.iter().rev() {
            let state = self.state.clone();
            self.waiting.push_front(CaptureRequest::Annotate { label: label.clone(), at: now, state });
        }
    }

    fn start(&mut self, name: String, now: Instant, actions: &mut Vec<CaptureAction>) {
        self.hold = Some(Hold::Beginning(now + BEGINS_WITHIN));
        actions.push(CaptureAction::Start(name));
    }

    fn stop(&mut self, actions: &mut Vec<CaptureAction>) {
        (self.hold, self.owner, self.since) = (None, RecordingOwner::Nobody, None);
        actions.push(CaptureAction::Stop);
    }

    /// Carries out what waits, as far as nothing holds it back.
    fn go_on(&mut self, now: Instant, actions: &mut Vec<CaptureAction>) {
        while self.hold.is_none() && self.listens_by.is_none() {
            match self.waiting.pop_front() {
                None => return,
                Some(CaptureRequest::Record(name)) if self.records => {
                    (self.owner, self.since) = (RecordingOwner::Nobody, None);
                    self.wanted = Some(name.clone());
                    self.start(name, now, actions);
                }
                Some(CaptureRequest::Record(_)) => {}
                Some(CaptureRequest::StopRecording) => {
                    self.wanted = None;
                    self.state.clear();
                    if self.owner == RecordingOwner::Us {
                        self.hold = Some(Hold::Ending(now + LAST_FRAMES));
                    }
                }
                Some(CaptureRequest::Annotate { label, at, state }) => {
                    self.state = state;
                    actions.push(CaptureAction::Annotate { label, at, not_before: self.since });
                }
                Some(CaptureRequest::Report(to)) => actions.push(CaptureAction::Report(to)),
            }
        }
    }
}
