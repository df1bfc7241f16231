//! The BIDS tables of one recording: events, gaze samples, arm samples and beliefs.

use super::belief_rows;
use super::event_cells::EventCells;
use super::event_columns::{EVENTS, WORDS};
use super::sample_rows::{LongTable, LongTableFacts, LongTableRow, SampleRows, ViewingFacts};
use super::spans::OpenSpans;
use super::tsv::{self, BidsFile, TaskFacts, or_nothing, seconds, yes};
use tomcom_core::base::time::SessionTime;
use tomcom_session::gaze_check::GazeCheckEvent;
use tomcom_session::event::{Event, TrialEndReason};
use tomcom_session::plan::AnswerFormat;
use tomcom_session::probes::ProbeEvent;
use tomcom_session::protocol::ProtocolEvent;
use tomcom_session::settings::GazeSource;
use tomcom_session::wall_display::DisplayEvent;
use tomcom_session::{Session, TimestampedEvent, TrialPhase};

/// Whether a press had an effect, and whether it was an error.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct PressOutcome {
    /// Whether the press changed the kitchen.
    pub effective: bool,
    /// Whether the press was an error; `None` for presses that are not judged: those of the robot, and those outside
    /// the trial.
    pub error: Option<bool>,
}

/// Number of rows in each BIDS table of a recording; all rows together are as many as the log has events.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize)]
pub struct BidsRowCounts {
    /// Number of rows in the table of events.
    pub events: u64,
    /// Number of rows in the BIDS table of gaze samples.
    pub gaze: u64,
    /// Number of rows of fixations and blinks, in the table beside the gaze samples.
    pub eye_events: u64,
    /// Number of rows in the table of the robot arm's motion.
    pub arm: u64,
    /// Number of rows in the table of beliefs; a logged event of beliefs has one row per state aspect.
    pub beliefs: u64,
    /// Number of events that were left out because they contain words that somebody typed.
    pub words_left_out: u64,
}

/// A row of the BIDS table of events.
#[derive(Debug)]
struct EventRow {
    onset: SessionTime,
    duration: Option<SessionTime>,
    /// Cells of the row in the columns that follow the column `duration`.
    rest: String,
    /// Whether the row belongs into the table of fixations and blinks instead, if the recording has gaze.
    is_of_eyes: bool,
}

/// The BIDS tables of one recording, to which rows are added event by event.
#[derive(Debug)]
pub struct RecordingTables {
    with_words: bool,
    rows: Vec<EventRow>,
    spans: OpenSpans,
    samples: SampleRows,
    /// Rows of long tables that were not taken yet.
    long: Vec<LongTableRow>,
    viewing: ViewingFacts,
    words_left_out: u64,
    ended: Option<TrialEndReason>,
}

impl RecordingTables {
    /// BIDS tables without rows, before the first event. `with_words`: whether text that somebody typed is exported,
    /// too.
    pub fn new(session: &Session, with_words: bool) -> RecordingTables {
        let is_pointer = session.spec.participant.gaze == GazeSource::Mouse;
        RecordingTables {
            with_words,
            rows: Vec::new(),
            spans: OpenSpans::default(),
            samples: SampleRows::default(),
            long: Vec::new(),
            viewing: ViewingFacts { is_pointer, resolution: None, gaze_checks: 0 },
            words_left_out: 0,
            ended: None,
        }
    }

    /// Why the trial ended; `None` if the trial did not end.
    pub fn ended(&self) -> Option<TrialEndReason> {
        self.ended
    }

    /// Adds an event that was applied to the session. `outcome`: effect and judgement of the event, if it is a press.
    pub fn note(&mut self, stamped: &TimestampedEvent, session: &Session, outcome: Option<PressOutcome>) {
        let mut is_of_eyes = false;
        match &stamped.event {
            Event::Gaze(sample) => return self.long.push(SampleRows::gaze(stamped, sample)),
            Event::RobotMoves(sample) => return self.long.push(SampleRows::arm(stamped, sample)),
            Event::Tracker(event) => is_of_eyes = self.samples.note_found(stamped, event),
            Event::TrialEnded { reason } => self.ended = Some(*reason),
            Event::TrialAborted { .. } => self.ended = Some(TrialEndReason::Aborted),
            Event::Calibration(GazeCheckEvent::Measured { found: Some(_) }) => self.viewing.gaze_checks += 1,
            Event::Display(DisplayEvent::Connected { width_px, height_px }) => {
                self.viewing.resolution = Some([*width_px, *height_px]);
            }
            _ => {}
        }
        self.long.extend(belief_rows::rows(stamped));
        let (duration, over) = self.spans.note(self.rows.len(), stamped.time, &stamped.event);
        for (row, lasted) in over {
            self.rows[row].duration = Some(lasted);
        }
        let rest = self.rest(stamped, session, outcome);
        self.rows.push(EventRow { onset: stamped.time, duration, rest, is_of_eyes });
    }

    fn rest(&mut self, stamped: &TimestampedEvent, session: &Session, outcome: Option<PressOutcome>) -> String {
        let mut cells = EventCells::from_event(&stamped.event, is_words(&stamped.event, session));
        if let Event::Probe(ProbeEvent::Asked { question, .. } | ProbeEvent::Answered { question, .. }) = &stamped.event
            && let Some(open) = &session.probes.open
            && let Some(asked) = (*question as usize).checked_sub(1).and_then(|index| open.questions.get(index))
        {
            cells.ask_about(&asked.about);
        }
        let is_on = matches!(session.phase, TrialPhase::Running | TrialPhase::Paused)
            || matches!(stamped.event, Event::TrialEnded { .. } | Event::TrialAborted { .. });
        let clock = is_on.then(|| seconds(session.trial_clock(stamped.time)));
        let mut all = vec![stamped.event.kind().to_string(), stamped.seq.to_string(), or_nothing(clock)];
        all.extend([cells.what.clone(), cells.agent.clone(), cells.button.clone()]);
        all.push(or_nothing(outcome.map(|outcome| yes(outcome.effective))));
        all.push(or_nothing(outcome.and_then(|outcome| outcome.error).map(yes)));
        all.extend(cells.rest());
        match self.with_words {
            true => all.push(cells.words),
            false => self.words_left_out += u64::from(!cells.words.is_empty()),
        }
        tsv::line(all)
    }

    /// The rows of long tables of the events since the last call. The caller writes them at once, since a recording of
    /// hours has millions of them.
    pub fn take_rows(&mut self) -> std::vec::Drain<'_, LongTableRow> {
        self.long.drain(..)
    }

    /// End of a long table's file name, and its first line, which is empty for tables that BIDS wants without one.
    pub fn long_table(&self, table: LongTable) -> (String, String) {
        let stem = self.viewing.stem(table);
        match table {
            LongTable::Gaze | LongTable::Arm => (format!("{stem}.tsv.gz"), String::new()),
            LongTable::Beliefs => (format!("{stem}.tsv"), belief_rows::heading()),
        }
    }

    /// The files of the recording's tables but the long ones, after the last event, with the numbers of rows of all of
    /// them. `long`: what was counted of the rows of the long tables, in the order of [`LongTable::ALL`].
    pub fn into_files(self, session: &Session, long: &[LongTableFacts; 3]) -> (Vec<BidsFile>, BidsRowCounts) {
        let task = TaskFacts { name: session.kitchen.name.clone(), title: session.kitchen.title.clone() };
        let [gaze, arm, beliefs] = long.map(|facts| facts.rows);
        let has_gaze = gaze > 0;
        let rows: Vec<&EventRow> = self.rows.iter().filter(|row| !(has_gaze && row.is_of_eyes)).collect();
        let counts = BidsRowCounts {
            events: rows.len() as u64,
            gaze,
            eye_events: if has_gaze { self.samples.found() } else { 0 },
            arm,
            beliefs,
            words_left_out: self.words_left_out,
        };
        let columns: Vec<_> = EVENTS.into_iter().chain(self.with_words.then_some(WORDS)).collect();
        let mut text = tsv::line(tsv::names(&columns));
        for row in rows {
            let duration = row.duration.map(|duration| match duration {
                SessionTime::ZERO => "0".to_string(),
                duration => seconds(duration),
            });
            text += &format!("{}\t{}\t{}", seconds(row.onset), or_nothing(duration), row.rest);
        }
        let mut about = tsv::described(&columns);
        task.tell(&mut about);
        about.insert("StimulusPresentation".to_string(), self.viewing.presentation(session));
        let mut files = vec![BidsFile::new("events.tsv", text), BidsFile::json("events.json", &about.into())];
        files.extend((beliefs > 0).then(|| belief_rows::sidecar(&task)));
        files.extend(self.samples.into_files(session, &self.viewing, &task, long));
        (files, counts)
    }
}

/// Whether an event is an answer in the participant's own words.
fn is_words(event: &Event, session: &Session) -> bool {
    let Event::Protocol(ProtocolEvent::ItemAnswered { item, .. }) = event else { return false };
    let form = session.questionnaire().and_then(|asked| asked.form(asked.position(item)?));
    matches!(form, Some(AnswerFormat::Text { .. }))
}
