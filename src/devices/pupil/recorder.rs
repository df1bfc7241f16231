//! Decides what is requested of Pupil Capture's recorder, and when Capture's recording is annotated; the module
//! `capture_client` carries the decisions out.
//!
//! Capture answers `OK` to a request for a recording before the recording has begun: an annotation before
//! `recording.started` is in no recording. A request while Capture is already recording has no effect and no
//! notification, so a recording that was not announced is not this program's, and is never ended by it; except where the
//! log of a trial that goes on after a cut says that this program began a recording and did not end it. Capture handles
//! requests before annotations in each of its frames, so a recording is ended some frames after its last annotation.

use std::collections::VecDeque;
use std::time::{Duration, Instant};

use tokio::sync::oneshot;

use super::message::CaptureNotification;
use tomcom_session::tracker::TrackerRecording;

/// Longest time from a request for a Capture recording to the recording's beginning.
const BEGINS_WITHIN: Duration = Duration::from_secs(3);
/// Longest time for which Capture's annotation plugin is waited for.
const LISTENS_WITHIN: Duration = Duration::from_millis(1500);
/// Time from the last annotation to the end of Capture's recording, in which Capture handles the annotation.
const LAST_FRAMES: Duration = Duration::from_millis(500);

/// A request of the session to Capture.
#[derive(Debug)]
pub enum CaptureRequest {
    Record {
        name: String,
        /// Whether a recording that this program began for the trial may still run: the program was cut off, and goes
        /// on with the trial.
        goes_on: bool,
    },
    StopRecording,
    Annotate {
        /// Name of the event that is annotated.
        label: String,
        at: Instant,
        /// Labels of the trial's state from now on; a recording that begins later is first annotated with these labels.
        state: Vec<String>,
    },
    Report(oneshot::Sender<()>),
}

/// A decision of the recorder logic, to be carried out now.
#[derive(Debug)]
pub enum CaptureAction {
    /// Request a recording with this name from Capture.
    Start(String),
    Stop,
    Annotate {
        /// Name of the event that is annotated.
        label: String,
        at: Instant,
        /// Beginning of Capture's recording; an event from before it is annotated at this instant instead.
        not_before: Option<Instant>,
    },
    Tell(TrackerRecording),
    Report(oneshot::Sender<()>),
}

/// Who started the recording that runs in Capture while the session wants one.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum RecordingOwner {
    /// No recording of Capture is known.
    Nobody,
    Us,
    /// The lab started Capture's recording, or none could be started.
    Lab,
}

/// Why further requests to Capture have to wait.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Hold {
    /// Capture's recording is about to begin, at this instant at the latest.
    Beginning(Instant),
    Ending(Instant),
    /// Capture was asked to end its recording, and has not answered yet.
    Stopping,
}

/// State of Capture's recording, as far as this program knows it, and the requests that wait.
#[derive(Debug)]
pub struct CaptureRecordingControl {
    /// Whether Capture is to make a recording; its recordings are annotated in any case.
    records: bool,
    /// Name of the Capture recording that the session wants now.
    wanted: Option<String>,
    owner: RecordingOwner,
    /// Instant at which Capture announced the present recording.
    since: Option<Instant>,
    hold: Option<Hold>,
    /// Whether a recording that runs in Capture now was begun by this program before it was cut off.
    may_go_on: bool,
    /// Time limit until which the annotation plugin is waited for; `None` if it listens or is no longer waited for.
    listens_by: Option<Instant>,
    /// Whether the next Capture recording is first annotated with the trial's state.
    resumes: bool,
    /// Labels of the trial's present state, used for annotations.
    state: Vec<String>,
    waiting: VecDeque<CaptureRequest>,
}

impl CaptureRecordingControl {
    /// State of the control before anything is known about Capture.
    pub fn new(records: bool) -> CaptureRecordingControl {
        CaptureRecordingControl {
            records,
            wanted: None,
            owner: RecordingOwner::Nobody,
            since: None,
            hold: None,
            may_go_on: false,
            listens_by: None,
            resumes: false,
            state: Vec::new(),
            waiting: VecDeque::new(),
        }
    }

    /// Stores a request of the session until Capture is connected.
    pub fn queue(&mut self, request: CaptureRequest) {
        self.waiting.push_back(request);
        self.drop_missed();
    }

    /// Drops what waits up to the last stop request: events before a stop request that could not be sent are in no
    /// recording of Capture.
    fn drop_missed(&mut self) {
        if let Some(last) = self.waiting.iter().rposition(|request| matches!(request, CaptureRequest::StopRecording)) {
            self.waiting.drain(..=last);
            self.wanted = None;
            self.state.clear();
        }
    }

    /// Handles a new connection to Capture. `is_same_run` says that Capture was not restarted since the last
    /// connection; `listens` says that Capture's annotation plugin runs.
    pub fn connected(&mut self, now: Instant, is_same_run: bool, listens: bool) -> Vec<CaptureAction> {
        let mut actions = Vec::new();
        self.listens_by = (!listens).then_some(now + LISTENS_WITHIN);
        let is_ours = is_same_run && self.owner == RecordingOwner::Us;
        self.owner = if is_ours { RecordingOwner::Us } else { RecordingOwner::Nobody };
        self.may_go_on &= is_same_run;
        self.drop_missed();
        if is_ours && self.wanted.is_none() {
            self.stop(&mut actions);
        }
        self.resumes = !self.state.is_empty();
        match self.wanted.clone() {
            Some(name) => self.start(name, now, &mut actions),
            None => self.resume(now),
        }
        self.go_on(now, actions)
    }

    /// Handles the loss of the connection to Capture.
    pub fn disconnected(&mut self) {
        (self.hold, self.listens_by) = (None, None);
    }

    pub fn order(&mut self, request: CaptureRequest, now: Instant) -> Vec<CaptureAction> {
        self.waiting.push_back(request);
        self.go_on(now, Vec::new())
    }

    /// Handles that Capture's annotation plugin listens from now on.
    pub fn listens(&mut self, now: Instant) -> Vec<CaptureAction> {
        self.listens_by = None;
        self.go_on(now, Vec::new())
    }

    pub fn heard(&mut self, news: CaptureNotification, now: Instant) -> Vec<CaptureAction> {
        let mut actions = Vec::new();
        let is_beginning = matches!(self.hold, Some(Hold::Beginning(_)));
        match news {
            CaptureNotification::Started(name)
                if self.wanted.as_ref() == Some(&name) && (is_beginning || self.is_overdue()) =>
            {
                // Annotations sent before the Capture recording began are not in it, so the trial's state is annotated
                // again.
                self.resumes |= !is_beginning;
                (self.owner, self.since, self.may_go_on) = (RecordingOwner::Us, Some(now), false);
                actions.push(CaptureAction::Tell(TrackerRecording::Begun));
                self.begun(now);
            }
            CaptureNotification::Started(_) if is_beginning => {
                // Somebody began a recording, so that none ran.
                self.may_go_on = false;
                self.is_not_ours(now, &mut actions);
            }
            CaptureNotification::Started(_) => {}
            CaptureNotification::Stopped if matches!(self.hold, Some(Hold::Ending(_))) => {
                (self.hold, self.owner) = (None, RecordingOwner::Nobody);
            }
            CaptureNotification::Stopped if self.wanted.is_some() && self.owner != RecordingOwner::Nobody => {
                self.owner = RecordingOwner::Nobody;
                actions.push(CaptureAction::Tell(TrackerRecording::Ended));
            }
            CaptureNotification::Stopped => self.may_go_on = false,
        }
        self.go_on(now, actions)
    }

    /// Whether a Capture recording that this program requested may still begin, later than it should have.
    fn is_overdue(&self) -> bool {
        self.owner == RecordingOwner::Lab && self.since.is_none()
    }

    /// Next instant at which the control has to act even without further messages.
    pub fn due(&self) -> Option<Instant> {
        let hold = self.hold.and_then(|hold| match hold {
            Hold::Beginning(by) | Hold::Ending(by) => Some(by),
            Hold::Stopping => None,
        });
        hold.into_iter().chain(self.listens_by).min()
    }

    pub fn pass(&mut self, now: Instant) -> Vec<CaptureAction> {
        let mut actions = Vec::new();
        if self.listens_by.is_some_and(|by| by <= now) {
            self.listens_by = None;
            actions.push(CaptureAction::Tell(TrackerRecording::NotAnnotated));
        }
        match self.hold {
            Some(Hold::Beginning(by)) if by <= now => match self.owner {
                // After a lost connection the Capture recording of this program may still run, which Capture does not
                // announce again.
                RecordingOwner::Us => self.begun(now),
                RecordingOwner::Nobody | RecordingOwner::Lab if std::mem::take(&mut self.may_go_on) => {
                    self.owner = RecordingOwner::Us;
                    actions.push(CaptureAction::Tell(TrackerRecording::GoesOn));
                    self.begun(now);
                }
                RecordingOwner::Nobody | RecordingOwner::Lab => self.is_not_ours(now, &mut actions),
            },
            Some(Hold::Ending(by)) if by <= now => self.stop(&mut actions),
            _ => {}
        }
        self.go_on(now, actions)
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

    /// If the Capture recording began in the middle of the trial, annotates the trial's state before anything else.
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

    /// Requests the end of Capture's recording, which stays this program's until Capture answers: if the connection is
    /// lost before, the recording is ended after the next connection.
    fn stop(&mut self, actions: &mut Vec<CaptureAction>) {
        self.hold = Some(Hold::Stopping);
        actions.push(CaptureAction::Stop);
    }

    pub fn stop_answered(&mut self, now: Instant) -> Vec<CaptureAction> {
        (self.hold, self.owner, self.since) = (None, RecordingOwner::Nobody, None);
        self.go_on(now, Vec::new())
    }

    /// Carries out waiting requests to Capture until one has to wait, after these actions.
    fn go_on(&mut self, now: Instant, mut actions: Vec<CaptureAction>) -> Vec<CaptureAction> {
        while self.hold.is_none() && self.listens_by.is_none() {
            match self.waiting.pop_front() {
                None => break,
                Some(CaptureRequest::Record { name, goes_on }) if self.records => {
                    (self.owner, self.since, self.may_go_on) = (RecordingOwner::Nobody, None, goes_on);
                    self.wanted = Some(name.clone());
                    self.start(name, now, &mut actions);
                }
                Some(CaptureRequest::Record { .. }) => {}
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
        actions
    }
}
