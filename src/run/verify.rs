//! Verifies a recording in the strongest form: the session is run again from the header, with nothing but the events
//! from outside, and every line that comes out must equal the recorded line byte for byte. Applying the recorded events
//! one by one must lead to the same state, too.

use std::collections::VecDeque;
use std::path::{Path, PathBuf};

use serde::Serialize;

use super::engine::Engine;
use crate::analysis::advisor::{AdviceRequest, Advisor};
use crate::analysis::follower::Follower;
use crate::base::words::count;
use crate::communication::recommendation::Recommendation;
use crate::edge::file_error::{FileError, FileResult};
use crate::edge::log::{LogEnding, LogLine, LogReader, at_line, event_line};
use crate::kitchen::cost_to_go::CostToGo;
use crate::session::admit::is_external;
use crate::session::{Event, Stamped};

/// What `tomcom replay RECORDING --verify` found.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Verification {
    pub verified: bool,
    /// Recorded events.
    pub events: u64,
    /// The recording ends without its end event; it was verified up to there.
    pub cut: bool,
    /// It does because its session still runs.
    pub running: bool,
    /// Where recording and re-run differ first.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub difference: Option<VerificationDifference>,
}

/// The first difference between a recording and its re-run.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct VerificationDifference {
    /// Of the recorded event.
    pub seq: u64,
    /// The log, of several parts that which it is in.
    pub log: PathBuf,
    /// The line of the log, counted from 1.
    pub line: usize,
    pub recorded: String,
    /// What the re-run gave there; `null`: nothing.
    pub again: Option<String>,
}

/// Runs a recording again and compares.
///
/// # Errors
/// A recording that cannot be read, or whose events cannot be applied.
pub fn verify(recording: &Path) -> FileResult<Verification> {
    let RerunRecording { log, again, replayed, difference } = RerunRecording::from_log(LogReader::open(recording)?)?;
    let same_end = difference.is_some() || log.is_cut() || again.ends_like(&replayed);
    let verified = difference.is_none() && same_end;
    let (cut, running) = (log.is_cut(), log.ending() == LogEnding::Running);
    Ok(Verification { verified, events: log.events(), cut, running, difference })
}

/// A recording that was run again to where it ends.
pub(super) struct RerunRecording {
    pub log: LogReader,
    pub again: RerunSession,
    /// What applying the recorded events leads to.
    replayed: Follower,
    /// Where they differ first.
    pub difference: Option<VerificationDifference>,
}

impl RerunRecording {
    /// Runs a recording again, from its first event to its last.
    ///
    /// # Errors
    /// It cannot be read, or its events cannot be applied.
    pub fn from_log(mut log: LogReader) -> FileResult<RerunRecording> {
        let (kitchen, header) = (log.kitchen.clone(), log.header.clone());
        header.session.require_built().map_err(|missing| FileError::not_built(log.path(), missing))?;
        let cost = CostToGo::new(kitchen.clone());
        let mut replayed = Follower::new(log.session(), cost.clone());
        let engine = Engine::new(kitchen, header.session, header.trial, cost);
        let advisor = engine.session().spec.asks_assistant().then(|| engine.advisor());
        let mut again = RerunSession { engine, produced: VecDeque::new(), advisor, questions: VecDeque::new() };
        let mut difference = None;
        while let Some(line) = log.next_line()? {
            replayed
                .apply(&line.stamped)
                .map_err(|error| at_line(log.path(), line.number, &line.text, 0, error.found, error.remedy))?;
            if difference.is_none() {
                difference = again.difference_at(&line, log.path());
            }
        }
        Ok(RerunRecording { log, again, replayed, difference })
    }
}

/// The session that is run again.
pub(super) struct RerunSession {
    pub engine: Engine,
    /// What came out of it and was not compared yet; at the end of a cut recording, what it lacks.
    pub produced: VecDeque<Stamped>,
    /// The assistant, and what it was asked and has not answered.
    advisor: Option<Advisor>,
    questions: VecDeque<AdviceRequest>,
}

impl RerunSession {
    /// Runs on to the recorded line and compares it with what comes out there.
    fn difference_at(&mut self, line: &LogLine, log: &Path) -> Option<VerificationDifference> {
        let recorded = &line.stamped;
        if self.produced.is_empty() {
            if is_external(self.engine.session(), &recorded.event) {
                let event = self.computed_again(&recorded.event);
                let outcome = self.engine.input(recorded.time, event);
                self.produced.extend(outcome.events);
            } else {
                // A participant may also act without anything to record.
                while self.produced.is_empty() && self.engine.next_due().is_some_and(|due| due <= recorded.time) {
                    self.produced.extend(self.engine.fire());
                }
            }
        }
        self.questions.extend(self.engine.take_questions());
        let again = self.produced.pop_front().map(|stamped| event_line(&stamped));
        let same = again.as_deref() == Some(line.text.as_str());
        let log = log.to_path_buf();
        (!same).then(|| VerificationDifference {
            seq: recorded.seq,
            log,
            line: line.number,
            recorded: line.text.clone(),
            again,
        })
    }

    /// An event from outside; advice is computed again, for the event that it was computed for.
    fn computed_again(&mut self, event: &Event) -> Event {
        let (Event::Advised(advice), Some(advisor)) = (event, &mut self.advisor) else { return event.clone() };
        self.questions.retain(|question| question.seq >= advice.for_seq);
        match self.questions.front().filter(|question| question.seq == advice.for_seq) {
            Some(question) => Event::Advised(advisor.answer(question)),
            // Nobody asked: it stays, and is compared with nothing that could have come out.
            None => Event::Advised(Recommendation::silent(advice.for_seq, advice.for_ns)),
        }
    }

    /// Whether the re-run stands where applying the recorded events leads, in everything that a session holds and in the
    /// estimated belief, with nothing left over.
    fn ends_like(&self, replayed: &Follower) -> bool {
        self.produced.is_empty()
            && *self.engine.session() == replayed.session
            && self.engine.belief() == replayed.filter.belief()
    }
}

/// Says it in words.
pub fn describe(found: &Verification) -> String {
    let until = match (found.running, found.cut) {
        (true, _) => "; the session is still running, and this is what was written so far",
        (false, true) => ", up to where it was cut",
        (false, false) => "",
    };
    match &found.difference {
        None if found.verified => {
            let events = count(found.events, "event", "events");
            let come = if found.events == 1 { "comes" } else { "come" };
            format!("verified: {events} {come} out the same again{until}\n")
        }
        None => "not verified: the re-run ends in another state than the recording\n".to_string(),
        Some(difference) => format!(
            "not verified: event {} ({}:{}) differs\n  recorded: {}\n  again:    {}\n",
            difference.seq,
            difference.log.display(),
            difference.line,
            difference.recorded,
            difference.again.as_deref().unwrap_or("nothing"),
        ),
    }
}
