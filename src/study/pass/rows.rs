//! Collects the rows of the CSV tables of events while a recording is replayed ([`crate::tables`] declares their
//! columns), with the causes of a person's errors from raters' codes.

use crate::analysis::offer_summary::TimedOffer;
use crate::column::{CsvRow, CsvTable};
use crate::files::export::TableRows;
use crate::rater_episodes::KnownFalseBeliefs;
use crate::tables::actions::{ActionRow, PressAnalysis, RecordedPress};
use crate::tables::communications::{BeliefRow, CommunicationRow, GazeRow, GazeRun, OfferRow};
use tomcom_core::base::time::SessionTime;
use tomcom_core::gaze::{MIN_CONFIDENCE, nearest_location};
use tomcom_core::kitchen::{Agent, AspectId, Kitchen, KitchenChange, LocationId, Press, State};
use tomcom_core::measures::JudgedPress;
use tomcom_core::measures::attribution::{ErrorCause, FalseBeliefTarget};
use tomcom_core::measures::matching::{CommunicationEvent, MatchCriterion, WINDOW, matched};
use tomcom_core::measures::raters::{
    BeliefSource, CodableErrors, ErrorCauseCode, ErrorCauseKind, RaterChoice, RaterCodes, RaterPair,
};
use tomcom_core::measures::sequences::ErrorSequence;
use tomcom_core::mind::{RecordedBelief, RecordedEstimate};
use tomcom_session::files::file_error::{FileError, FileResult};
use tomcom_session::follower::SessionFollower;
use tomcom_session::log::{LogReader, consensus_file, rater_codes};
use tomcom_session::settings::ParticipantKind;
use tomcom_session::{Event, Session, TimestampedEvent};

#[derive(Debug, Default)]
pub struct RowCollector {
    recording: String,
    /// Of each table of events, in the order of [`CsvTable::OF_EVENTS`].
    rows: [TableRows; 5],
    pressed_at: [Option<SessionTime>; 2],
    /// Presses of both agents so far; human presses are judged after the replay.
    presses: Vec<RecordedPress>,
    witness: Option<RecordedBelief>,
    look: Option<GazeRun>,
}

fn add<Row: CsvRow>(rows: &mut [TableRows; 5], row: &Row) {
    if let Some(index) = CsvTable::OF_EVENTS.iter().position(|&table| table == Row::TABLE) {
        rows[index].add(row);
    }
}

#[derive(Clone, Copy, Debug)]
pub struct TrialPressAnalyses<'a> {
    pub judged: &'a [JudgedPress],
    pub sequences: &'a [ErrorSequence],
    /// Causes of people's errors by the estimated beliefs, each with the sequence number of the press.
    pub by_estimate: Option<&'a [(u64, ErrorCause)]>,
    pub coded: &'a CodedErrors,
    pub known: Option<&'a KnownFalseBeliefs>,
}

impl<'a> TrialPressAnalyses<'a> {
    /// Analysis of the human's press with this sequence number; `None` for presses of the robot.
    fn analysis(&self, seq: u64, session: &Session) -> Option<PressAnalysis<'a>> {
        let index = self.judged.binary_search_by_key(&seq, |press| press.seq).ok()?;
        let episode = self.known.and_then(|known| known.episode(&session.kitchen, &self.judged[index]));
        let clock_s = |time: SessionTime| session.trial_clock_at(time).as_secs_f64();
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
    pub fn new(recording: &str) -> RowCollector {
        RowCollector { recording: recording.to_string(), ..RowCollector::default() }
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
                let is_sure = sample.confidence >= MIN_CONFIDENCE;
                let nearest = nearest_location(&session.kitchen, [sample.x, sample.y]);
                let inside = nearest.filter(|(_, distance)| is_sure && *distance == 0.0);
                let location = inside.map(|(location, _)| location);
                self.looked(location, taken, [sample.x, sample.y, sample.confidence], session);
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
            time_s: session.trial_clock_at(stamped.time).as_secs_f64(),
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
            let (recording, truth) = (&*self.recording, &*kitchen.aspects[index].labels[truth]);
            let believed = witness.as_ref().and_then(|witness| witness.aspects.get(index));
            add(&mut self.rows, &BeliefRow { recording, seq, truth, estimate: aspect, believed });
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
        let time_s = session.trial_clock_at(run.began).as_secs_f64();
        add(&mut self.rows, &GazeRow { recording: &self.recording, kitchen: &session.kitchen, time_s, run });
    }

    /// In the order of [`CsvTable::OF_EVENTS`]. `lanes`: by sender, sent and hypothetical communications.
    pub fn finish(
        mut self,
        session: &Session,
        known: &TrialPressAnalyses,
        lanes: &[(String, Vec<CommunicationEvent>)],
    ) -> [Vec<u8>; 5] {
        self.end_look(session);
        let (recording, kitchen) = (&*self.recording, &*session.kitchen);
        for recorded in &self.presses {
            let analysis = known.analysis(recorded.seq, session);
            add(&mut self.rows, &ActionRow { recording, kitchen, recorded, analysis });
        }
        let pairs = match lanes {
            [(_, of), (_, with)] => Some(matched(of, with, WINDOW, MatchCriterion::Signal)),
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
                add(&mut self.rows, &CommunicationRow { recording, kitchen, lane, sent, offer, matched });
            }
        }
        for timed in &offers {
            add(&mut self.rows, &OfferRow { recording, timed });
        }
        self.rows.map(TableRows::into_bytes)
    }
}

#[derive(Clone, Debug, Default, PartialEq)]
pub struct CodedErrors {
    /// Codes of two raters: of those whom the user named or who settled a consensus, else of the two who coded most
    /// errors. `None` with fewer than two raters, or if it is ambiguous which two.
    pub raters: Option<RaterPair>,
    pub consensus: Option<RaterCodes>,
    pub settled_by: Option<[String; 2]>,
    /// Why the raters' consensus does not hold; `None` if it holds, or if there is no consensus.
    pub stale: Option<String>,
}

impl CodedErrors {
    /// Reads the codes beside a log. `named`: the two raters whose codes shall be used, if the user names them. Errors:
    /// a file with codes is damaged; or more than two raters have coded every error of a person, and the user did not
    /// name two of these raters.
    pub fn read(log: &LogReader, follower: &SessionFollower, named: Option<&[String; 2]>) -> FileResult<CodedErrors> {
        let codable = CodableErrors::from_presses(&follower.session.kitchen, &follower.judged);
        let all = rater_codes::read_all(log.folder(), &codable)?;
        // Without a consensus; `stale`: why one does not hold.
        let own_codes = |stale: Option<String>| {
            let choice = named.map_or_else(
                || RaterChoice::most_complete(&all),
                |raters| RaterChoice::Pair(RaterPair::named(&all, raters)),
            );
            let raters = match choice {
                RaterChoice::Pair(pair) => Some(pair),
                RaterChoice::Tied { raters, coded } if is_needed(follower, &codable, coded) => {
                    return Err(tied(log, &raters));
                }
                RaterChoice::TooFew | RaterChoice::Tied { .. } => None,
            };
            Ok(CodedErrors { raters, stale, ..CodedErrors::default() })
        };
        let consensus = consensus_file::read(log.folder(), &codable)?;
        let is_asked = |raters: &[String; 2]| named.is_none_or(|named| named.iter().all(|one| raters.contains(one)));
        let Some(consensus) = consensus.filter(|consensus| is_asked(&consensus.raters)) else {
            return own_codes(None);
        };
        let pair = RaterPair::named(&all, &consensus.raters);
        let own = &pair.codes;
        if let Some(rater) = consensus.without_codes(own.each_ref()) {
            return own_codes(Some(format!("there are no codes of {rater}")));
        }
        if let Some(changed) = consensus.changed(own.each_ref()).first() {
            let error = codable.errors.partition_point(|&press| press < changed.press) + 1;
            let [one, other] = &consensus.raters;
            let stale = format!(
                "{} changed the code of error {error} (press {}) after {one} and {other} had settled it",
                changed.rater, changed.press
            );
            return own_codes(Some(stale));
        }
        let shared = consensus.current(own.each_ref());
        if !codable.errors.iter().all(|press| shared.0.contains_key(press)) {
            return own_codes(None);
        }
        let settled_by = Some(consensus.raters);
        Ok(CodedErrors { raters: Some(pair), consensus: Some(shared), settled_by, stale: None })
    }

    /// Human presses with the causes of errors, and the source of the causes: recorded beliefs for simulated
    /// participants; for people the raters' consensus, the codes of two raters who both coded every error, or else the
    /// belief estimate. The source is `None` for a simulated participant without recorded beliefs.
    pub fn judged(
        &self,
        follower: &SessionFollower,
        by_estimate: Option<&[(u64, ErrorCause)]>,
    ) -> (Vec<JudgedPress>, Option<BeliefSource>) {
        let mut judged = follower.judged.clone();
        let Some(estimated) = by_estimate else {
            let is_known = judged.iter().all(|press| press.belief_known);
            return (judged, is_known.then_some(BeliefSource::Recorded));
        };
        let raters = self.complete_raters(&judged);
        let kitchen = &follower.session.kitchen;
        for press in judged.iter_mut().filter(|press| press.verdict.error) {
            press.cause = match (&self.consensus, raters) {
                (Some(shared), _) => shared.0.get(&press.seq).and_then(|code| cause(kitchen, press, code)),
                (None, Some(raters)) => agreed(kitchen, press, raters),
                (None, None) => estimated.iter().find(|(seq, _)| *seq == press.seq).map(|(_, cause)| *cause),
            };
        }
        let basis = match (&self.consensus, raters) {
            (Some(_), _) => BeliefSource::Consensus,
            (None, Some(_)) => BeliefSource::Raters,
            (None, None) => BeliefSource::Estimate,
        };
        (judged, Some(basis))
    }

    /// Codes that two raters share: their consensus, or else errors that both coded alike, if both coded every error.
    pub fn shared(&self, judged: &[JudgedPress]) -> Option<RaterCodes> {
        let alike = || self.complete_raters(judged).map(|[one, other]| one.agreed(other));
        self.consensus.clone().or_else(alike)
    }

    /// The codes of the two raters; `None` unless both coded every error.
    fn complete_raters(&self, judged: &[JudgedPress]) -> Option<&[RaterCodes; 2]> {
        let coded =
            |codes: &RaterCodes| judged.iter().all(|press| !press.verdict.error || codes.0.contains_key(&press.seq));
        self.raters.as_ref().map(|pair| &pair.codes).filter(|codes| codes.iter().all(coded))
    }
}

fn is_needed(follower: &SessionFollower, codable: &CodableErrors, coded: usize) -> bool {
    let is_person = follower.session.spec.participant.kind != ParticipantKind::Simulated;
    is_person && !codable.errors.is_empty() && coded == codable.errors.len()
}

fn tied(log: &LogReader, raters: &[String]) -> FileError {
    let found = format!("complete codes of {} raters: {}", raters.len(), raters.join(", "));
    let remedy = format!(
        "--raters with two of them, such as --raters {} {}; or a consensus of two of them (tomcom replay RECORDING \
         --settle)",
        raters[0], raters[1]
    );
    FileError::from_finding(log.folder(), found, remedy)
}

fn cause(kitchen: &Kitchen, press: &JudgedPress, code: &ErrorCauseCode) -> Option<ErrorCause> {
    if code.kind() != ErrorCauseKind::Belief {
        return Some(ErrorCause::Slip);
    }
    Some(ErrorCause::Belief { gain_nats: f64::NAN, target: code.target(kitchen, press.before)?, with: None })
}

/// The cause of an error by two raters, whatever the raters' order. If both raters coded a false belief, the error
/// follows from a false belief; if they name two different ones, the first in the layout's order comes first. Otherwise
/// the error does not count as following from a false belief.
fn agreed(kitchen: &Kitchen, press: &JudgedPress, [one, other]: &[RaterCodes; 2]) -> Option<ErrorCause> {
    let codes = [one.0.get(&press.seq)?, other.0.get(&press.seq)?];
    if codes.iter().any(|code| code.kind() != ErrorCauseKind::Belief) {
        return Some(ErrorCause::Slip);
    }
    let mut targets: Vec<FalseBeliefTarget> =
        codes.iter().filter_map(|code| code.target(kitchen, press.before)).collect();
    targets.sort_by_key(|target| target.aspects(kitchen).next());
    targets.dedup();
    Some(ErrorCause::Belief { gain_nats: f64::NAN, target: *targets.first()?, with: targets.get(1).copied() })
}
