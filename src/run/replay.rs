//! Replays a recording: feeds its events through the same [`apply`](crate::session::apply) as the live session.

use std::path::Path;

use super::follower::Follower;
use crate::edge::files::FileResult;
use crate::edge::log::{LogLine, LogReader, at_line};
use crate::kitchen::cost_to_go::CostToGo;
use crate::session::Session;

/// A recording and the session at the point up to which it was replayed.
#[derive(Debug)]
pub struct Replay {
    log: LogReader,
    pub follower: Follower,
}

impl Replay {
    /// Opens a recording, before its first event.
    ///
    /// # Errors
    /// Those of [`LogReader::open`].
    pub fn open(recording: &Path) -> FileResult<Replay> {
        let log = LogReader::open(recording)?;
        let cost = CostToGo::new(log.kitchen.clone());
        let follower = Follower::new(log.kitchen.clone(), log.header.session.clone(), cost);
        Ok(Replay { log, follower })
    }

    /// Applies the next event and hands it out; `None` where the log ends for now.
    ///
    /// # Errors
    /// A line that is no event, or an event that cannot be at this point.
    pub fn step(&mut self) -> FileResult<Option<LogLine>> {
        let Some(line) = self.log.next_line()? else { return Ok(None) };
        self.follower
            .apply(&line.stamped)
            .map_err(|error| at_line(self.log.path(), line.number, &line.text, 0, error.found, error.remedy))?;
        Ok(Some(line))
    }

    /// Applies everything that is there.
    ///
    /// # Errors
    /// Those of [`Replay::step`].
    pub fn run(&mut self) -> FileResult<()> {
        while self.step()?.is_some() {}
        Ok(())
    }

    pub fn session(&self) -> &Session {
        &self.follower.session
    }

    /// The log that is replayed.
    pub fn log(&self) -> &LogReader {
        &self.log
    }
}
