//! Replays a recording: applies its events with the same [`apply`](crate::apply()) as the live session.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use crate::advisor::{AdviceRequest, leads_to_advice};
use crate::files::file_error::{FileError, FileResult};
use crate::follower::SessionFollower;
use crate::log::{LogLine, LogReader};
use crate::watcher::follows_at_once;
use crate::{Session, TimestampedEvent};
use tomcom_core::base::time::SessionTime;
use tomcom_core::kitchen::cost_to_go::CostToGo;
use tomcom_core::kitchen::{Kitchen, KitchenChange};

/// With the session at the replay's present position.
#[derive(Debug)]
pub struct RecordingReplay {
    log: LogReader,
    pub follower: SessionFollower,
    /// A line that was read and is not applied yet.
    held: Option<LogLine>,
    /// The newest event after which the assistant is asked, once all its immediate consequences are applied.
    to_ask: Option<(u64, SessionTime)>,
}

#[derive(Clone, Debug, PartialEq)]
pub struct ReplayedEvent {
    pub stamped: TimestampedEvent,
    pub change: KitchenChange,
}

impl RecordingReplay {
    /// Before its first event.
    pub fn open(recording: &Path) -> FileResult<RecordingReplay> {
        let log = LogReader::open(recording)?;
        let cost = CostToGo::new(log.kitchen.clone());
        Ok(RecordingReplay::over(log, cost))
    }

    /// `cost` must be of the log's kitchen, and can come from another replay.
    pub fn over(log: LogReader, cost: CostToGo) -> RecordingReplay {
        let follower = SessionFollower::new(log.session(), cost);
        RecordingReplay { log, follower, held: None, to_ask: None }
    }

    /// Without attribution of errors to causes, which takes long.
    pub fn without_causes(self) -> RecordingReplay {
        RecordingReplay { follower: self.follower.without_causes(), ..self }
    }

    /// Applies the next event; `None` at the present end of the log.
    pub fn step(&mut self) -> FileResult<Option<ReplayedEvent>> {
        let Some(line) = self.next_line()? else { return Ok(None) };
        self.apply(&line).map(Some)
    }

    fn next_line(&mut self) -> FileResult<Option<LogLine>> {
        match self.held.take() {
            Some(line) => Ok(Some(line)),
            None => self.log.next_line(),
        }
    }

    fn apply(&mut self, line: &LogLine) -> FileResult<ReplayedEvent> {
        let applied = self.follower.apply(&line.stamped).map_err(|error| self.log.refused(line, error))?;
        if leads_to_advice(self.session(), &line.stamped.event) {
            self.to_ask = Some((line.stamped.seq, line.stamped.time));
        }
        Ok(ReplayedEvent { stamped: line.stamped.clone(), change: applied.change })
    }

    /// Applies all remaining events.
    pub fn run(&mut self) -> FileResult<()> {
        while self.step()?.is_some() {}
        Ok(())
    }

    /// Replays up to the next request for advice, which is made after the same events, and with the same immediate
    /// consequences applied, as in the running session; `None` at the present end of the log.
    pub fn next_question(&mut self) -> FileResult<Option<AdviceRequest>> {
        loop {
            let line = self.next_line()?;
            let follows = |time: SessionTime| line.as_ref().is_some_and(|line| follows_at_once(&line.stamped, time));
            if let Some((seq, time)) = self.to_ask.take_if(|(_, time)| !follows(*time))
                && self.session().is_running()
            {
                self.held = line;
                return Ok(Some(AdviceRequest::from_follower(&mut self.follower, seq, time)));
            }
            let Some(line) = line else { return Ok(None) };
            self.apply(&line)?;
        }
    }

    pub fn session(&self) -> &Session {
        &self.follower.session
    }

    pub fn log(&self) -> &LogReader {
        &self.log
    }
}

/// All recordings must be of one kitchen.
#[derive(Debug, Default)]
pub struct SameKitchenCheck {
    first: Option<(PathBuf, Arc<Kitchen>)>,
}

impl SameKitchenCheck {
    pub fn admit(&mut self, recording: &Path, kitchen: &Arc<Kitchen>) -> FileResult<()> {
        let (path, first) = self.first.get_or_insert_with(|| (recording.to_path_buf(), kitchen.clone()));
        if first.aspects == kitchen.aspects && first.buttons == kitchen.buttons {
            return Ok(());
        }
        let found = format!("a recording of the kitchen {}, beside {}", kitchen.name, path.display());
        let remedy = format!("recordings of one kitchen, here of {}", first.name);
        Err(FileError::from_finding(recording, found, remedy))
    }

    /// It is an error if no recording was admitted.
    pub fn kitchen(self) -> FileResult<Arc<Kitchen>> {
        let none = || FileError::from_finding(Path::new("."), "no recording", "at least one recording");
        self.first.map(|(_, kitchen)| kitchen).ok_or_else(none)
    }
}

/// Kind of event to which a replay can jump.
#[derive(Clone, Copy, Debug, PartialEq, Eq, strum::IntoStaticStr)]
#[strum(serialize_all = "snake_case")]
pub enum ReplayLandmark {
    Error,
    Signal,
    #[strum(serialize = "note")]
    Marker,
    /// It begins in the belief estimate.
    #[strum(serialize = "estimated false belief")]
    FalseBelief,
}

named!(ReplayLandmark);
