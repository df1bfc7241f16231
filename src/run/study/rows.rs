//! The rows of the tables that grow with what happens in a trial, gathered event by event.

use serde::Serialize;

use crate::analysis::follower::Follower;
use crate::analysis::wizard_log::clock_at;
use crate::base::time::SessionTime;
use crate::edge::export::TableRows;
use crate::gaze::{MIN_CONFIDENCE, nearest_location};
use crate::kitchen::{Agent, AspectId, Change, LocationId, Press};
use crate::measures::JudgedPress;
use crate::measures::attribution::Cause;
use crate::measures::coding::{Code, Codes};
use crate::measures::matching::{CommunicationEvent, CommunicationKind, MatchCriterion, matched};
use crate::mind::BeliefWitness;
use crate::mind::witness::{EstimateWitness, rounded};
use crate::session::{Event, Session, Stamped};
use crate::study::tables::{ActionRow, BeliefRow, CommunicationRow, GazeRow, Table};

/// A run of gaze samples on one location.
#[derive(Clone, Debug)]
struct Look {
    location: Option<LocationId>,
    began: SessionTime,
    last: SessionTime,
    /// Of x, y and confidence.
    sums: [f64; 3],
    samples: u64,
}

/// Gathers rows.
#[derive(Debug)]
pub struct RowCollector {
    recording: String,
    rows: [TableRows; 4],
    /// When each agent pressed last.
    pressed_at: [Option<SessionTime>; 2],
    /// Presses, of which those of the human are judged later.
    actions: Vec<ActionRow>,
    witness: Option<BeliefWitness>,
    look: Option<Look>,
}

/// What is known of the presses of the human when all is over.
#[derive(Clone, Copy, Debug)]
pub struct PressFacts<'a> {
    pub judged: &'a [JudgedPress],
    /// Sequences of belief related errors, as indices of presses.
    pub sequences: &'a [Vec<usize>],
    /// Of people, by the numbers of presses.
    pub by_estimate: Option<&'a [(u64, Cause)]>,
    pub raters: Option<&'a [Codes; 2]>,
}

impl PressFacts<'_> {
    /// Fills in the row of a press.
    fn judge(&self, session: &Session, index: usize, press: &JudgedPress, row: &mut ActionRow) {
        let verdict = &press.verdict;
        (row.regret, row.excess) = (Some(verdict.regret), Some(verdict.excess));
        (row.race, row.error) = (Some(verdict.race), Some(verdict.error));
        let sequence = self.sequences.iter().position(|errors| errors.contains(&index));
        row.sequence = sequence.map(|number| number as u64 + 1);
        row.cause = press.cause.map(name_of);
        if let Some(Cause::Belief { gain_nats, target, with }) = press.cause {
            row.aspect = Some(target.label(&session.kitchen));
            row.second_aspect = with.map(|target| target.label(&session.kitchen));
            // Raters give none.
            row.gain_nats = Some(rounded(gain_nats)).filter(|gain| gain.is_finite());
        }
        let estimated = self.by_estimate.and_then(|causes| causes.iter().find(|(seq, _)| *seq == press.seq));
        row.cause_estimated = estimated.map(|(_, cause)| name_of(*cause));
        if let Some(raters) = self.raters {
            let [one, other] = raters.each_ref().map(|codes| codes.0.get(&press.seq).map(in_words));
            (row.rater_1, row.rater_2) = (one, other);
        }
    }
}

fn name_of(cause: Cause) -> &'static str {
    match cause {
        Cause::Slip => "slip",
        Cause::Belief { .. } => "belief",
    }
}

fn in_words(code: &Code) -> String {
    let kind = code.kind().name();
    code.aspect().map_or(kind.to_string(), |aspect| format!("{kind} {aspect}"))
}

impl RowCollector {
    pub fn new(recording: &str) -> RowCollector {
        RowCollector {
            recording: recording.to_string(),
            rows: Table::OF_EVENTS.map(|_| TableRows::default()),
            pressed_at: [None; 2],
            actions: Vec::new(),
            witness: None,
            look: None,
        }
    }

    fn write(&mut self, table: Table, row: &impl Serialize) {
        if let Some(index) = Table::OF_EVENTS.iter().position(|&other| other == table) {
            self.rows[index].add(row);
        }
    }

    /// Takes note of an event that was just applied; `was_running`: the trial ran when it came.
    pub fn note(&mut self, stamped: &Stamped, change: &Change, follower: &Follower, was_running: bool) {
        let session = &follower.session;
        if let Change::Press { press, presses } = change {
            self.pressed(stamped, press, presses[press.agent.index()], follower);
        }
        match &stamped.event {
            Event::ParticipantBelieves(witness) => self.witness = Some(witness.clone()),
            Event::Gaze(sample) if was_running && session.gaze.fault.is_none() => {
                let sample = session.corrected(*sample);
                let taken = sample.taken_ns.map_or(stamped.time, |taken| taken.min(stamped.time));
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

    /// Adds a press to the actions; `number`: its number among those of its agent.
    fn pressed(&mut self, stamped: &Stamped, press: &Press, number: u32, follower: &Follower) {
        let session = &follower.session;
        let before = self.pressed_at[press.agent.index()].replace(stamped.time);
        let since = before.map(|before| session.age(before, stamped.time).as_secs_f64());
        let estimated = follower.estimated.as_ref().filter(|estimated| estimated.press == stamped.seq);
        self.actions.push(ActionRow {
            recording: self.recording.clone(),
            seq: stamped.seq,
            time_s: seconds(session, stamped.time),
            agent: match press.agent {
                Agent::Human => "human",
                Agent::Robot => "robot",
            },
            press: u64::from(number),
            button: session.kitchen.button(press.agent, press.button).name.clone(),
            effective: press.effective,
            since_s: since.map(rounded),
            log_p: estimated.map(|estimated| rounded(estimated.evidence.log_p)),
            ..ActionRow::default()
        });
        let witness = if press.agent == Agent::Human { self.witness.take() } else { None };
        if let Some(estimated) = estimated {
            self.believed(stamped.seq, &estimated.witness(&session.kitchen), estimated.state, witness, session);
        }
    }

    fn believed(
        &mut self,
        seq: u64,
        estimate: &EstimateWitness,
        state: crate::kitchen::State,
        witness: Option<BeliefWitness>,
        session: &Session,
    ) {
        let kitchen = &session.kitchen;
        for (index, aspect) in estimate.aspects.iter().enumerate() {
            let truth = kitchen.true_value(state, AspectId(index as u8));
            let own = witness.as_ref().and_then(|witness| witness.aspects.get(index));
            let row = BeliefRow {
                recording: self.recording.clone(),
                seq,
                aspect: aspect.aspect.clone(),
                truth: kitchen.aspects[index].labels[truth].clone(),
                estimate: aspect.believes.clone(),
                estimate_p_truth: aspect.p_truth,
                estimate_precision: aspect.precision,
                believed: own.map(|own| own.believes.clone()),
                believed_p_truth: own.map(|own| own.p_truth),
            };
            self.write(Table::Beliefs, &row);
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
                self.look = Some(Look { location, began: taken, last: taken, sums: values, samples: 1 });
            }
        }
    }

    fn end_look(&mut self, session: &Session) {
        let Some(look) = self.look.take() else { return };
        let [x, y, confidence] = look.sums.map(|sum| rounded(sum / look.samples as f64));
        let row = GazeRow {
            recording: self.recording.clone(),
            time_s: seconds(session, look.began),
            duration_s: rounded(look.last.secs_since(look.began)),
            location: look.location.map(|location| session.kitchen.location(location).name.clone()),
            x,
            y,
            confidence,
            samples: look.samples,
        };
        self.write(Table::Gaze, &row);
    }

    /// The rows, in the order of [`Table::OF_EVENTS`]. `lanes`: what was sent, and what the assistant would have said.
    pub fn finish(
        mut self,
        session: &Session,
        known: &PressFacts,
        lanes: &[(String, Vec<CommunicationEvent>)],
        window: u32,
    ) -> [Vec<u8>; 4] {
        self.end_look(session);
        for (index, press) in known.judged.iter().enumerate() {
            let Ok(at) = self.actions.binary_search_by_key(&press.seq, |row| row.seq) else { continue };
            known.judge(session, index, press, &mut self.actions[at]);
        }
        for row in std::mem::take(&mut self.actions) {
            self.write(Table::Actions, &row);
        }
        self.communications(session, lanes, window);
        self.rows.map(TableRows::into_bytes)
    }

    fn communications(&mut self, session: &Session, lanes: &[(String, Vec<CommunicationEvent>)], window: u32) {
        let pairs = match lanes {
            [(_, of), (_, with)] => Some(matched(of, with, window, MatchCriterion::Strict)),
            _ => None,
        };
        for (lane, (name, said)) in lanes.iter().enumerate() {
            for (index, said) in said.iter().enumerate() {
                let is_matched = |pairs: &Vec<(usize, usize)>| pairs.iter().any(|&(a, b)| [a, b][lane] == index);
                let row = CommunicationRow {
                    recording: self.recording.clone(),
                    lane: name.clone(),
                    time_s: rounded(said.clock.as_secs_f64()),
                    press: said.press,
                    kind: match said.content.kind {
                        CommunicationKind::Recipe => "recipe",
                        CommunicationKind::Highlight => "highlight",
                        CommunicationKind::Proposal => "proposal",
                    },
                    target: said.content.target.map(|location| session.kitchen.location(location).name.clone()),
                    matched: pairs.as_ref().map(is_matched),
                };
                self.write(Table::Communications, &row);
            }
        }
    }
}

/// The trial's clock at a time of a session, in seconds.
fn seconds(session: &Session, time: SessionTime) -> f64 {
    rounded(clock_at(session, time).as_secs_f64())
}
