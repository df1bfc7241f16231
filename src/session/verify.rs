//! Verification of a recording: the session is run again from the recording's header and external events only, and
//! every line of the new log must equal the recorded line byte for byte. Applying the recorded events one by one must
//! lead to the same state.

use std::collections::VecDeque;
use std::path::Path;

use serde::Serialize;

use crate::admit::is_external;
use crate::advisor::{AdviceRequest, Advisor};
use crate::engine::SessionEngine;
use crate::files::file_error::{FileError, FileResult};
use crate::follower::SessionFollower;
use crate::log::{LogEnding, LogLine, LogReader, event_line};
use crate::{Event, TimestampedEvent};
use tomcom_core::base::text::{PathText, count};
use tomcom_core::communication::recommendation::Recommendation;
use tomcom_core::kitchen::cost_to_go::CostToGo;

/// The result of `tomcom replay RECORDING --verify`.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Verification {
    /// Whether running the session again gave the same events and states.
    pub verified: bool,
    pub events: u64,
    /// A cut recording is verified up to the cut.
    pub cut: bool,
    /// Whether the recorded session still runs.
    pub running: bool,
    /// The first one; null without a difference.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub difference: Option<VerificationDifference>,
}

#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct VerificationDifference {
    /// Of the recorded event.
    pub seq: u64,
    /// The log with the event; of several parts, that of the part.
    pub log: PathText,
    /// From 1.
    pub line: usize,
    /// As a line of the log.
    pub recorded: String,
    /// Null if the repeated run gives no such event.
    pub again: Option<String>,
}

/// Runs the session of a recording again and compares the new events with the recorded ones.
pub fn verify(recording: &Path) -> FileResult<Verification> {
    let RepeatedRecording { log, again, replayed, difference } =
        RepeatedRecording::from_log(LogReader::open(recording)?)?;
    let same_end = difference.is_some() || log.is_cut() || again.ends_like(&replayed);
    let verified = difference.is_none() && same_end;
    let (cut, running) = (log.is_cut(), log.ending() == LogEnding::Running);
    Ok(Verification { verified, events: log.events(), cut, running, difference })
}

/// A recording whose session was run again to the end.
pub struct RepeatedRecording {
    /// Read to its end.
    pub log: LogReader,
    pub again: RepeatedSession,
    /// The session after applying the recorded events.
    pub replayed: SessionFollower,
    pub difference: Option<VerificationDifference>,
}

impl RepeatedRecording {
    pub fn from_log(mut log: LogReader) -> FileResult<RepeatedRecording> {
        let (kitchen, header) = (log.kitchen.clone(), log.header.clone());
        header.session.require_built().map_err(|missing| FileError::not_built(log.path(), missing))?;
        let cost = CostToGo::new(kitchen.clone());
        let mut replayed = SessionFollower::new(log.session(), cost.clone());
        let engine = SessionEngine::for_header(kitchen, &header, cost);
        let spec = &engine.session().spec;
        let computes = spec.asks_assistant() && spec.external_concept().is_none();
        let advisor = computes.then(|| engine.advisor());
        let mut again = RepeatedSession { engine, produced: VecDeque::new(), advisor, questions: VecDeque::new() };
        let mut difference = None;
        while let Some(line) = log.next_line()? {
            replayed.apply(&line.stamped).map_err(|error| log.refused(&line, error))?;
            if difference.is_none() {
                difference = again.difference_at(&line, log.path());
            }
        }
        Ok(RepeatedRecording { log, again, replayed, difference })
    }
}

pub struct RepeatedSession {
    pub engine: SessionEngine,
    /// Events that have not been compared yet; at the end of a cut recording, those that it lacks because of the cut.
    pub produced: VecDeque<TimestampedEvent>,
    /// `None` if the session asks no assistant.
    advisor: Option<Advisor>,
    questions: VecDeque<AdviceRequest>,
}

impl RepeatedSession {
    /// Runs the session up to the recorded line and compares that line with the new one.
    fn difference_at(&mut self, line: &LogLine, log: &Path) -> Option<VerificationDifference> {
        let recorded = &line.stamped;
        if self.produced.is_empty() {
            if is_external(self.engine.session(), &recorded.event) {
                let event = self.computed_again(&recorded.event);
                let outcome = self.engine.input(recorded.time, event);
                self.produced.extend(outcome.events);
            } else {
                // The participant can act without an event, so the next due action is tried until an event occurs.
                while self.produced.is_empty() && self.engine.next_due().is_some_and(|due| due <= recorded.time) {
                    self.produced.extend(self.engine.fire());
                }
            }
        }
        self.questions.extend(self.engine.take_questions());
        let again = self.produced.pop_front().map(|stamped| event_line(&stamped));
        let same = again.as_deref() == Some(line.text.as_str());
        (!same).then(|| VerificationDifference {
            seq: recorded.seq,
            log: log.to_path_buf().into(),
            line: line.number,
            recorded: line.text.clone(),
            again,
        })
    }

    /// A recommendation is computed anew, for the request after the same event.
    fn computed_again(&mut self, event: &Event) -> Event {
        // What an external concept said comes from outside.
        let (Event::Advised(advice), Some(advisor)) = (event, &mut self.advisor) else { return event.clone() };
        self.questions.retain(|question| question.seq >= advice.for_seq);
        match self.questions.front().filter(|question| question.seq == advice.for_seq) {
            Some(question) => Event::Advised(advisor.answer(question)),
            // Without a matching request for advice, a recommendation of no signal is expected.
            None => Event::Advised(Recommendation::silent(advice.for_seq, advice.for_ns)),
        }
    }

    /// Whether both end with the same session state and belief estimate, without events left over.
    fn ends_like(&self, replayed: &SessionFollower) -> bool {
        self.produced.is_empty()
            && *self.engine.session() == replayed.session
            && self.engine.belief() == replayed.filter.belief()
    }
}

pub fn describe(found: &Verification) -> String {
    let until = match (found.running, found.cut) {
        (true, _) => "; the session is still running, and only the events written so far are verified",
        (false, true) => ", up to where the recording was cut",
        (false, false) => "",
    };
    match &found.difference {
        None if found.verified => {
            let events = count(found.events, "event", "events");
            let come = if found.events == 1 { "comes" } else { "come" };
            format!("verified: {events} {come} out the same again{until}\n")
        }
        None => "not verified: when the recording is run again, the session ends in another state\n".to_string(),
        Some(difference) => format!(
            "not verified: event {} ({}:{}) differs when the recording is run again\n  recorded: {}\n  again:    {}\n",
            difference.seq,
            difference.log.display(),
            difference.line,
            difference.recorded,
            difference.again.as_deref().unwrap_or("nothing"),
        ),
    }
}
