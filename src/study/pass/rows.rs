//! Collects the rows of the CSV tables of events while a recording is replayed. The module [`crate::tables`]
//! declares the tables' columns.

use super::coded_errors::CodedErrors;
use crate::analysis::offer_summary::TimedOffer;
use crate::column::{CsvRow, CsvTable};
use crate::files::export::TableRows;
use crate::known_beliefs::KnownFalseBeliefs;
use crate::tables::actions::{ActionRow, PressAnalysis, RecordedPress};
use crate::tables::aspect_beliefs::BeliefRow;
use crate::tables::communications::CommunicationRow;
use crate::tables::gaze_runs::{GazeRow, GazeRun};
use crate::tables::offer_table::OfferRow;
use tomcom_core::base::time::SessionTime;
use tomcom_core::gaze::{MIN_CONFIDENCE, nearest_location};
use tomcom_core::kitchen::{Agent, AspectId, KitchenChange, LocationId, Press, State};
use tomcom_core::measures::JudgedPress;
use tomcom_core::measures::attribution::ErrorCause;
use tomcom_core::measures::matching::{CommunicationEvent, MatchCriterion, matched};
use tomcom_core::measures::sequences::ErrorSequence;
use tomcom_core::mind::RecordedBelief;
use tomcom_core::mind::RecordedEstimate;
use tomcom_session::follower::SessionFollower;
use tomcom_session::wizard_log::clock_at;
use tomcom_session::{Event, Session, TimestampedEvent};

/// Collects the rows of the tables of events of one recording.
#[derive(Debug)]
pub struct RowCollector {
    recording: String,
    rows: EventRows,
    /// Session time of each agent's last press.
    pressed_at: [Option<SessionTime>; 2],
    /// Presses of both agents so far; human presses are judged after the replay.
    presses: Vec<RecordedPress>,
    witness: Option<RecordedBelief>,
    look: Option<GazeRun>,
}

/// Rows of each table of events, in the order of [`CsvTable::OF_EVENTS`].
#[derive(Debug)]
struct EventRows([TableRows; 5]);

impl EventRows {
    fn add<Row: CsvRow>(&mut self, row: &Row) {
        if let Some(index) = CsvTable::OF_EVENTS.iter().position(|&table| table == Row::TABLE) {
            self.0[index].add(row);
        }
    }
}

/// Analyses of the human's presses, which are complete after the replay.
#[derive(Clone, Copy, Debug)]
pub struct TrialPressAnalyses<'a> {
    /// The human's presses with their judgements, in order.
    pub judged: &'a [JudgedPress],
    /// Error sequences (errors that follow from one false belief) of the trial.
    pub sequences: &'a [ErrorSequence],
    /// Causes of people's errors by the estimated beliefs, each with the sequence number of the press.
    pub by_estimate: Option<&'a [(u64, ErrorCause)]>,
    /// Raters' codes of the human's errors.
    pub coded: &'a CodedErrors,
    /// The participant's false beliefs, if they are known.
    pub known: Option<&'a KnownFalseBeliefs>,
}

impl<'a> TrialPressAnalyses<'a> {
    /// Analysis of the human's press with this sequence number; `None` for presses of the robot.
    fn analysis(&self, seq: u64, session: &Session) -> Option<PressAnalysis<'a>> {
        let index = self.judged.binary_search_by_key(&seq, |press| press.seq).ok()?;
        let episode = self.known.and_then(|known| known.episode(&session.kitchen, &self.judged[index]));
        let clock_s = |time: SessionTime| clock_at(session, time).as_secs_f64();
        let sequence = self.sequences.iter().position(|one| one.errors.contains(&index));
        let estimated = self.by_estimate.and_then(|causes| causes.iter().find(|(press, _)| *press == seq));
        Some(PressAnalysis {
            judged: &self.judged[index],
            sequence: sequence.map(|number| number + 1),
            by_estimate: estimated.map(|(_, cause)| *cause),
            codes: match &self.coded.raters {
                Some(pair) => pair.codes.each_ref().map(|codes| codes.0.get(&seq)),
                None => [None, None],
            },
            shared: self.coded.consensus.as_ref().and_then(|codes| codes.0.get(&seq)),
            false_since_s: episode.map(|episode| clock_s(episode.began)),
            false_until_s: episode.and_then(|episode| episode.corrected).map(clock_s),
        })
    }
}

impl RowCollector {
    /// A collector for the recording that tables call by this name, without rows yet.
    pub fn new(recording: &str) -> RowCollector {
        RowCollector {
            recording: recording.to_string(),
            rows: EventRows(CsvTable::OF_EVENTS.map(|_| TableRows::default())),
            pressed_at: [None; 2],
            presses: Vec::new(),
            witness: None,
            look: None,
        }
    }

    /// Adds the rows of an event that was just applied; `was_running`: whether the trial was running before the event.
    pub fn note(
        &mut self,
        stamped: &TimestampedEvent,
        change: &KitchenChange,
        follower: &SessionFollower,
        was_running: bool,
    ) {
        let session = &follower.session;
        if let KitchenChange::Press { press, presses } = change {
            self.pressed(stamped, press, presses[press.agent.index()], follower);
        }
        match &stamped.event {
            Event::ParticipantBelieves(witness) => self.witness = Some(witness.clone()),
            Event::Gaze(sample) if was_running && session.gaze.fault.is_none() => {
                let sample = session.corrected(*sample);
                let taken = sample.taken(stamped.time);
                let point = [sample.x, sample.y];
                let inside = sample.confidence >= MIN_CONFIDENCE;
                let nearest =
                    nearest_location(&session.kitchen, point).filter(|(_, distance)| inside && *distance == 0.0);
                self.looked(
                    nearest.map(|(location, _)| location),
                    taken,
                    [sample.x, sample.y, sample.confidence],
                    session,
                );
            }
            _ => {}
        }
    }

    /// Adds a press to the rows; `number` counts the presses of the pressing agent from 1.
    fn pressed(&mut self, stamped: &TimestampedEvent, press: &Press, number: u32, follower: &SessionFollower) {
        let session = &follower.session;
        let before = self.pressed_at[press.agent.index()].replace(stamped.time);
        let estimated = follower.estimated.as_ref().filter(|estimated| estimated.press == stamped.seq);
        self.presses.push(RecordedPress {
            seq: stamped.seq,
            time_s: clock_at(session, stamped.time).as_secs_f64(),
            press: *press,
            number,
            since_s: before.map(|before| session.age(before, stamped.time).as_secs_f64()),
            log_p: estimated.map(|estimated| estimated.evidence.log_p),
        });
        let witness = if press.agent == Agent::Human { self.witness.take() } else { None };
        if let Some(estimated) = estimated {
            self.believed(stamped.seq, &estimated.witness(&session.kitchen), estimated.state, witness, session);
        }
    }

    fn believed(
        &mut self,
        seq: u64,
        estimate: &RecordedEstimate,
        state: State,
        witness: Option<RecordedBelief>,
        session: &Session,
    ) {
        let kitchen = &session.kitchen;
        for (index, aspect) in estimate.aspects.iter().enumerate() {
            let truth = kitchen.true_value(state, AspectId(index as u8));
            self.rows.add(&BeliefRow {
                recording: &self.recording,
                seq,
                truth: &kitchen.aspects[index].labels[truth],
                estimate: aspect,
                believed: witness.as_ref().and_then(|witness| witness.aspects.get(index)),
            });
        }
    }

    fn looked(&mut self, location: Option<LocationId>, taken: SessionTime, values: [f64; 3], session: &Session) {
        match &mut self.look {
            Some(look) if look.location == location => {
                look.last = look.last.max(taken);
                look.samples += 1;
                look.sums.iter_mut().zip(values).for_each(|(sum, value)| *sum += value);
            }
            _ => {
                self.end_look(session);
                self.look = Some(GazeRun { location, began: taken, last: taken, sums: values, samples: 1 });
            }
        }
    }

    fn end_look(&mut self, session: &Session) {
        let Some(run) = self.look.take() else { return };
        let time_s = clock_at(session, run.began).as_secs_f64();
        self.rows.add(&GazeRow { recording: &self.recording, kitchen: &session.kitchen, time_s, run });
    }

    /// The CSV rows, in the order of [`CsvTable::OF_EVENTS`]. `lanes`: communications that were sent, and
    /// communications that the assistant would have sent.
    pub fn finish(
        mut self,
        session: &Session,
        known: &TrialPressAnalyses,
        lanes: &[(String, Vec<CommunicationEvent>)],
        window: u32,
    ) -> [Vec<u8>; 5] {
        self.end_look(session);
        let (recording, kitchen) = (&*self.recording, &*session.kitchen);
        for recorded in &self.presses {
            self.rows.add(&ActionRow { recording, kitchen, recorded, analysis: known.analysis(recorded.seq, session) });
        }
        let pairs = match lanes {
            [(_, of), (_, with)] => Some(matched(of, with, window, MatchCriterion::Signal)),
            _ => None,
        };
        let offers = TimedOffer::visible(session);
        for (side, (lane, all)) in lanes.iter().enumerate() {
            for (index, sent) in all.iter().enumerate() {
                let is_matched = |pairs: &Vec<(usize, usize)>| pairs.iter().any(|&(a, b)| [a, b][side] == index);
                let matched = pairs.as_ref().map(is_matched);
                // The first lane has the communications that were really sent, which can have used an offer.
                let took = |timed: &&TimedOffer| side == 0 && timed.sent == Some(sent.clock);
                let offer = offers.iter().find(took).map(|timed| timed.offer.seq);
                self.rows.add(&CommunicationRow { recording, kitchen, lane, sent, offer, matched });
            }
        }
        for timed in &offers {
            self.rows.add(&OfferRow { recording, timed });
        }
        self.rows.0.map(TableRows::into_bytes)
    }
}
