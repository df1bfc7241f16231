//! Replays a recording: feeds its events through the same [`apply`](crate::session::apply()) as the live session.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use crate::analysis::advisor::AdviceRequest;
use crate::analysis::follower::Follower;
use crate::edge::file_error::{FileError, FileResult};
use crate::edge::log::{LOG_NAME, LogReader, at_line};
use crate::kitchen::cost_to_go::CostToGo;
use crate::kitchen::{Change, Kitchen};
use crate::mind::observation::Observation;
use crate::session::{Event, Session, Stamped};

/// A recording and the session at the point up to which it was replayed.
#[derive(Debug)]
pub struct Replay {
    log: LogReader,
    pub follower: Follower,
}

/// An event of a recording that was just applied, and what it changed in the kitchen.
#[derive(Clone, Debug, PartialEq)]
pub struct ReplayedEvent {
    pub stamped: Stamped,
    pub change: Change,
}

impl Replay {
    /// Opens a recording, before its first event.
    ///
    /// # Errors
    /// Those of [`LogReader::open`].
    pub fn open(recording: &Path) -> FileResult<Replay> {
        let log = LogReader::open(recording)?;
        let cost = CostToGo::new(log.kitchen.clone());
        Ok(Replay::over(log, cost))
    }

    /// A replay of this log; `cost` is for its kitchen, and may have been used before.
    pub fn over(log: LogReader, cost: CostToGo) -> Replay {
        let follower = Follower::new(log.session(), cost);
        Replay { log, follower }
    }

    /// The same without looking for the causes of errors.
    pub fn without_causes(self) -> Replay {
        Replay { follower: self.follower.without_causes(), ..self }
    }

    /// Applies the next event and hands it out; `None` where the log ends for now.
    ///
    /// # Errors
    /// A line that is no event, or an event that cannot be at this point.
    pub fn step(&mut self) -> FileResult<Option<ReplayedEvent>> {
        let Some(line) = self.log.next_line()? else { return Ok(None) };
        let applied = self
            .follower
            .apply(&line.stamped)
            .map_err(|error| at_line(self.log.path(), line.number, &line.text, 0, error.found, error.remedy))?;
        Ok(Some(ReplayedEvent { stamped: line.stamped, change: applied.change }))
    }

    /// Applies everything that is there.
    ///
    /// # Errors
    /// Those of [`Replay::step`].
    pub fn run(&mut self) -> FileResult<()> {
        while self.step()?.is_some() {}
        Ok(())
    }

    /// Applies everything that is there, and hands out what it tells of the human's belief.
    ///
    /// # Errors
    /// Those of [`Replay::step`].
    pub fn observations(&mut self) -> FileResult<Vec<Observation>> {
        let mut observations = Vec::new();
        loop {
            let Some(event) = self.step()? else { return Ok(observations) };
            if let Some(what) = self.follower.observed(&event.stamped, &event.change) {
                observations.push(Observation { time: event.stamped.time, what });
            }
        }
    }

    /// Replays on to the next question that the assistant is asked after a press; `None` where the log ends for now.
    ///
    /// # Errors
    /// Those of [`Replay::step`].
    pub fn next_question(&mut self) -> FileResult<Option<AdviceRequest>> {
        let mut pressed = None;
        while let Some(ReplayedEvent { stamped, change }) = self.step()? {
            if change.press().is_some() {
                pressed = Some(stamped.seq);
            }
            // By the next gaze sample the robot has chosen its press.
            if let (Event::Gaze(_), Some(seq)) = (stamped.event, pressed) {
                return Ok(Some(AdviceRequest::from_follower(&self.follower, seq, stamped.time)));
            }
        }
        Ok(None)
    }

    pub fn session(&self) -> &Session {
        &self.follower.session
    }

    /// The log that is replayed.
    pub fn log(&self) -> &LogReader {
        &self.log
    }
}

/// Recordings that are summed up count once each.
///
/// # Errors
/// One is named twice, by whatever path.
pub fn each_once(recordings: &[PathBuf]) -> FileResult<()> {
    let mut known = BTreeSet::new();
    for recording in recordings {
        let log = if recording.is_dir() { recording.join(LOG_NAME) } else { recording.clone() };
        // What is not there is told when it is opened.
        if !known.insert(log.canonicalize().unwrap_or(log)) {
            let remedy = "each recording once".to_string();
            return Err(FileError::from_finding(recording, "the same recording twice".to_string(), remedy));
        }
    }
    Ok(())
}

/// Recordings that are looked at together must be of one kitchen.
#[derive(Debug, Default)]
pub struct SameKitchen {
    first: Option<(PathBuf, Arc<Kitchen>)>,
}

impl SameKitchen {
    /// Takes note of a recording's kitchen.
    ///
    /// # Errors
    /// It is another one than that of the first recording.
    pub fn admit(&mut self, recording: &Path, kitchen: &Arc<Kitchen>) -> FileResult<()> {
        let (path, first) = self.first.get_or_insert_with(|| (recording.to_path_buf(), kitchen.clone()));
        if first.aspects == kitchen.aspects && first.buttons == kitchen.buttons {
            return Ok(());
        }
        let found = format!("a recording of the kitchen {}, beside {}", kitchen.name, path.display());
        let remedy = format!("recordings of one kitchen, here of {}", first.name);
        Err(FileError::from_finding(recording, found, remedy))
    }

    /// The kitchen of all of them.
    ///
    /// # Errors
    /// There was no recording.
    pub fn kitchen(self) -> FileResult<Arc<Kitchen>> {
        let none = || {
            let remedy = "at least one recording".to_string();
            FileError::from_finding(Path::new("."), "no recording".to_string(), remedy)
        };
        self.first.map(|(_, kitchen)| kitchen).ok_or_else(none)
    }
}
