//! The BIDS tables of one recording: events, gaze samples, arm samples and beliefs.

use std::collections::BTreeMap;

use crate::analysis::bids::events::{EVENT_COLUMNS, EventCells, EventRow, WORDS};
use crate::analysis::bids::sample_rows::{LongTable, LongTableFacts, LongTableRow, SampleRows, ViewingFacts};
use crate::analysis::bids::tsv::{self, BidsColumn, BidsFile, TaskFacts, or_nothing};
use tomcom_core::base::time::SessionTime;
use tomcom_core::kitchen::Agent;
use tomcom_core::mind::AspectBelief;
use tomcom_core::mind::AspectEstimate;
use tomcom_session::event::{Event, TrialEndReason};
use tomcom_session::gaze_check::GazeCheckEvent;
use tomcom_session::plan::AnswerFormat;
use tomcom_session::probes::ProbeEvent;
use tomcom_session::protocol::ProtocolEvent;
use tomcom_session::settings::GazeSource;
use tomcom_session::tracker::TrackerEvent;
use tomcom_session::wall_display::DisplayEvent;
use tomcom_session::{Session, TimestampedEvent, TrialPhase};

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct PressOutcome {
    pub effective: bool,
    /// Whether the press was an error; `None` for presses that are not judged: those of the robot, and those outside
    /// the trial.
    pub error: Option<bool>,
}

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize)]
pub struct BidsRowCounts {
    pub events: u64,
    pub gaze: u64,
    /// Number of rows of fixations and blinks, in the table beside the gaze samples.
    pub eye_events: u64,
    pub arm: u64,
    pub beliefs: u64,
    /// Number of events that were left out because they contain words that somebody typed.
    pub words_left_out: u64,
}

#[derive(Debug)]
pub struct RecordingTables {
    with_words: bool,
    rows: Vec<EventRow>,
    spans: OpenSpans,
    samples: SampleRows,
    long: Vec<LongTableRow>,
    viewing: ViewingFacts,
    words_left_out: u64,
    /// Why the trial ended; `None` if it did not.
    pub(crate) ended: Option<TrialEndReason>,
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
        self.long.extend(belief_rows(stamped));
        let (duration, over) = self.spans.note(self.rows.len(), stamped.time, &stamped.event);
        for (row, lasted) in over {
            self.rows[row].duration = Some(lasted);
        }
        let mut cells = EventCells::from_event(&stamped.event, is_words(&stamped.event, session));
        if let Event::Probe(ProbeEvent::Asked { question, .. } | ProbeEvent::Answered { question, .. }) = &stamped.event
            && let Some(open) = &session.probes.open
            && let Some(asked) = (*question as usize).checked_sub(1).and_then(|index| open.questions.get(index))
        {
            cells.ask_about(&asked.about);
        }
        self.words_left_out += u64::from(!self.with_words && !cells.words.is_empty());
        let is_on = matches!(session.phase, TrialPhase::Running | TrialPhase::Paused)
            || matches!(stamped.event, Event::TrialEnded { .. } | Event::TrialAborted { .. });
        self.rows.push(EventRow {
            onset: stamped.time,
            duration,
            kind: stamped.event.kind(),
            seq: stamped.seq,
            trial_time: is_on.then(|| session.trial_clock(stamped.time)),
            outcome,
            cells,
            is_of_eyes,
        });
    }

    /// The rows of long tables of the events since the last call. The caller writes them at once, since a recording of
    /// hours has millions of them.
    pub fn take_rows(&mut self) -> std::vec::Drain<'_, LongTableRow> {
        self.long.drain(..)
    }

    /// End of a long table's file name, and its first line, which is empty for tables that BIDS wants without one.
    pub(crate) fn long_table(&self, table: LongTable) -> (String, String) {
        let stem = self.viewing.stem(table);
        match table {
            LongTable::Gaze | LongTable::Arm => (format!("{stem}.tsv.gz"), String::new()),
            LongTable::Beliefs => (format!("{stem}.tsv"), beliefs_heading()),
        }
    }

    /// The files of the recording's tables but the long ones, after the last event, with the numbers of rows of all of
    /// them. `long`: what was counted of the rows of the long tables, in the order of [`LongTable::ALL`].
    pub(crate) fn into_files(self, session: &Session, long: &[LongTableFacts; 3]) -> (Vec<BidsFile>, BidsRowCounts) {
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
        let columns: Vec<_> = EVENT_COLUMNS.into_iter().chain(self.with_words.then_some(WORDS)).collect();
        let mut text = tsv::line(tsv::names(&columns));
        rows.into_iter().for_each(|row| text += &tsv::row(&columns, row));
        let mut about = tsv::described(&columns);
        task.tell(&mut about);
        about.insert("StimulusPresentation".to_string(), self.viewing.presentation(session));
        let mut files = vec![BidsFile::new("events.tsv", text), BidsFile::json("events.json", &about.into())];
        files.extend((beliefs > 0).then(|| beliefs_sidecar(&task)));
        files.extend(self.samples.into_files(session, &self.viewing, &task, long));
        (files, counts)
    }
}

fn is_words(event: &Event, session: &Session) -> bool {
    let Event::Protocol(ProtocolEvent::ItemAnswered { item, .. }) = event else { return false };
    let form = session.questionnaire().and_then(|asked| asked.form(asked.position(item)?));
    matches!(form, Some(AnswerFormat::Text { .. }))
}

#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum Span {
    Trial,
    Pause,
    Phase,
    Order(String),
    RobotPress,
    RobotIdle,
    RobotStop,
    RobotHold,
    Safety,
    Signal,
    Offer,
    Probe,
    Target,
    TrackerLoss,
    DisplayUnseen,
    DisplayLoss,
    Unfocused,
    EyesClosed,
}

#[derive(Debug, Default)]
struct OpenSpans(BTreeMap<Span, (usize, SessionTime)>);

impl OpenSpans {
    /// Notes an event that stands in row `row` of the table: returns the event's duration so far (`None` for a span
    /// that goes on), and the spans that the event ends, each as the row of the event that began the span and its
    /// duration.
    pub(super) fn note(
        &mut self,
        row: usize,
        time: SessionTime,
        event: &Event,
    ) -> (Option<SessionTime>, Vec<(usize, SessionTime)>) {
        let (begins, ends) = (begun_span(event), ended_spans(event));
        let is_over = |span: &Span| match event {
            Event::SessionEnded => true,
            Event::TrialEnded { .. } | Event::TrialAborted { .. } => is_of_trial(span),
            _ => ends.contains(span) || begins.as_ref() == Some(span),
        };
        let over: Vec<(usize, SessionTime)> =
            self.0.iter().filter(|(span, _)| is_over(span)).map(|(_, (row, since))| (*row, time - *since)).collect();
        self.0.retain(|span, _| !is_over(span));
        match begins {
            Some(span) => {
                self.0.insert(span, (row, time));
                (None, over)
            }
            None => (Some(SessionTime::ZERO), over),
        }
    }
}

fn is_of_trial(span: &Span) -> bool {
    matches!(
        span,
        Span::Trial
            | Span::Pause
            | Span::Order(_)
            | Span::RobotPress
            | Span::RobotIdle
            | Span::RobotStop
            | Span::RobotHold
            | Span::Signal
            | Span::Offer
            | Span::Probe
    )
}

/// The span of time that an event begins; `None` for an event without duration.
fn begun_span(event: &Event) -> Option<Span> {
    Some(match event {
        Event::TrialStarted => Span::Trial,
        Event::TrialPaused => Span::Pause,
        Event::Protocol(ProtocolEvent::PhaseStarted { .. }) => Span::Phase,
        Event::OrderShown { order, .. } => Span::Order(order.clone()),
        Event::RobotIntends { .. } => Span::RobotPress,
        Event::RobotIdles { .. } => Span::RobotIdle,
        Event::RobotStopped => Span::RobotStop,
        Event::RobotHeld { .. } => Span::RobotHold,
        Event::RobotSafety { .. } => Span::Safety,
        Event::SignalShown { .. } => Span::Signal,
        Event::OfferOpened(_) => Span::Offer,
        Event::Probe(ProbeEvent::Begun { .. }) => Span::Probe,
        Event::Calibration(GazeCheckEvent::TargetShown { .. }) => Span::Target,
        Event::Tracker(TrackerEvent::Lost { .. }) => Span::TrackerLoss,
        Event::Tracker(TrackerEvent::DisplayLost | TrackerEvent::OtherSurfaces { .. }) => Span::DisplayUnseen,
        Event::Tracker(TrackerEvent::Blink { closed: true, .. }) => Span::EyesClosed,
        Event::Display(DisplayEvent::Lost) => Span::DisplayLoss,
        Event::FocusLost => Span::Unfocused,
        _ => return None,
    })
}

/// The spans of time that an event ends. (An event that begins a span also ends an earlier span of the same kind; such
/// an earlier span is not listed here.)
fn ended_spans(event: &Event) -> Vec<Span> {
    match event {
        Event::TrialResumed => vec![Span::Pause],
        Event::OrderCleared { order } => vec![Span::Order(order.clone())],
        Event::Press { agent: Agent::Robot, .. } | Event::RobotAborts { .. } => vec![Span::RobotPress],
        Event::RobotIntends { .. } => vec![Span::RobotIdle],
        Event::RobotIdles { .. } => vec![Span::RobotPress],
        Event::RobotResumed => vec![Span::RobotStop],
        Event::RobotReleased { .. } => vec![Span::RobotHold],
        Event::SignalEnded { .. } => vec![Span::Signal],
        Event::OfferClosed { .. } => vec![Span::Offer],
        Event::Probe(ProbeEvent::Ended { .. }) => vec![Span::Probe],
        Event::Calibration(
            GazeCheckEvent::TargetsHidden | GazeCheckEvent::Dismissed | GazeCheckEvent::Begun { .. },
        ) => vec![Span::Target],
        Event::Tracker(TrackerEvent::Connected { .. }) => vec![Span::TrackerLoss],
        Event::Tracker(TrackerEvent::DisplayFound) => vec![Span::DisplayUnseen],
        Event::Tracker(TrackerEvent::Blink { closed: false, .. }) => vec![Span::EyesClosed],
        Event::Display(DisplayEvent::Connected { .. }) => vec![Span::DisplayLoss],
        Event::FocusRegained => vec![Span::Unfocused],
        _ => Vec::new(),
    }
}

const BELIEF_SOURCES: &[(&str, &str)] = &[
    ("participant", "The belief of a simulated participant before its press"),
    ("estimate", "The belief estimate before the press, made from what could be known then"),
];

/// An aspect of a recorded belief, or of an estimate.
struct BeliefRow<'a> {
    seq: u64,
    source: &'static str,
    /// The press that an estimate belongs to.
    press: Option<u64>,
    aspect: &'a str,
    believes: &'a str,
    p_truth: f64,
    precision: Option<f64>,
}

fn belief_columns<'a>() -> [BidsColumn<BeliefRow<'a>>; 7] {
    [
        BidsColumn::new("seq", "Number of the event in the log, as in the events", |row| row.seq.to_string()),
        BidsColumn::of_levels("source", BELIEF_SOURCES, "Whose probabilities they are", |row| row.source.to_string()),
        BidsColumn::new("press", "Number (seq) of the press that an estimate belongs to", |row| or_nothing(row.press)),
        BidsColumn::new("aspect", "What is believed something of: a place, or the recipe of a dish", |row| {
            row.aspect.to_string()
        }),
        BidsColumn::new("believes", "The likeliest value", |row| row.believes.to_string()),
        BidsColumn::of_unit("p_truth", "1", "Probability of the true value", |row| row.p_truth.to_string()),
        BidsColumn::of_unit(
            "precision",
            "1",
            "Precision of the estimate: the sum of the parameters of its Dirichlet distribution",
            |row| or_nothing(row.precision),
        ),
    ]
}

fn belief_rows<'a>(stamped: &'a TimestampedEvent) -> Vec<LongTableRow> {
    let seq = stamped.seq;
    let rows: Vec<BeliefRow> = match &stamped.event {
        Event::ParticipantBelieves(belief) => {
            let of_aspect = |about: &'a AspectBelief| BeliefRow {
                seq,
                source: "participant",
                press: None,
                aspect: &about.aspect,
                believes: &about.believes,
                p_truth: about.p_truth,
                precision: None,
            };
            belief.aspects.iter().map(of_aspect).collect()
        }
        Event::BeliefEstimated(estimate) => {
            let of_aspect = |about: &'a AspectEstimate| BeliefRow {
                seq,
                source: "estimate",
                press: Some(estimate.press),
                aspect: &about.aspect,
                believes: &about.believes,
                p_truth: about.p_truth,
                precision: Some(about.precision),
            };
            estimate.aspects.iter().map(of_aspect).collect()
        }
        _ => Vec::new(),
    };
    let columns = belief_columns();
    let long = |row: &BeliefRow<'a>| LongTableRow {
        table: LongTable::Beliefs,
        time: stamped.time,
        line: tsv::row(&columns, row),
    };
    rows.iter().map(long).collect()
}

fn beliefs_heading() -> String {
    tsv::line(tsv::names(&belief_columns()))
}

fn beliefs_sidecar(task: &TaskFacts) -> BidsFile {
    let mut about = tsv::described(&belief_columns());
    task.tell(&mut about);
    about.insert("Description".to_string(), "Beliefs about the kitchen, an aspect a row".into());
    BidsFile::json("beh.json", &about.into())
}
