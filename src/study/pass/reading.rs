//! Replays one recording of a study once, and reduces the recording to the statistics that the analysis keeps.

use std::path::Path;
use std::sync::Arc;

use super::coded_errors::CodedErrors;
use super::questionnaire_answers;
use super::replay_pass::ReplayPass;
use super::rows::{RowCollector, TrialPressAnalyses};
use super::twin::useful_signals;
use crate::acting_arm::SignalSenderWithParameter;
use crate::analysis::offer_summary::{OfferSummary, TimedOffer};
use crate::analysis::order_work::{RegretSum, order_times};
use crate::analysis::probe_collector::ProbeCollector;
use crate::analysis::probe_record::ProbedTrial;
use crate::belief_trace::BeliefEvidence;
use crate::facts::RecordingFacts;
use crate::kept_cost::KeptCost;
use crate::known_beliefs::{KnownFalseBeliefs, RaterFalseBeliefAgreement};
use crate::prevention::TrialGroundTruth;
use crate::robot_tally::{RobotEventSummary, RobotEventTally};
use crate::standing::exclusion_status;
use crate::trial_details::TrialDetails;
use crate::trial_statistics::{FalseBeliefErrors, TrialStatistics};
use tomcom_core::base::time::SessionTime;
use tomcom_core::kitchen::cost_to_go::CostToGo;
use tomcom_core::kitchen::{Agent, AspectId, Kitchen, KitchenChange};
use tomcom_core::measures::attribution::{ErrorAttributor, ErrorCause};
use tomcom_core::measures::raters::BeliefSource;
use tomcom_core::measures::sequences::BeliefErrorCounts;
use tomcom_core::measures::matching::{CommunicationEvent, WINDOW};
use tomcom_core::measures::sequences::{ErrorSequence, FalseBeliefEpisode, sequences, sequences_any_aspect};
use tomcom_core::measures::{JudgedPress, median};
use tomcom_core::mind::belief::Belief;
use tomcom_core::mind::dirichlet::DirichletBelief;
use tomcom_session::files::file_error::FileResult;
use tomcom_session::follower::SessionFollower;
use tomcom_session::history::comparison::CommunicationContent;
use tomcom_session::log::{LogEnding, LogReader, rater_codes};
use tomcom_session::protocol::ProtocolEvent;
use tomcom_session::settings::{Condition, ParticipantKind};
use tomcom_session::wizard_log::{WizardLog, clock_at};
use tomcom_session::{Event, LogHeader, Session, TimelineEntry, TimelineEvent, TimestampedEvent, TrialPhase};

/// Result of analysing one recording.
#[derive(Debug)]
pub struct RecordingAnalysis {
    /// Statistics of the recording's trial.
    pub trial: TrialStatistics,
    /// Details of the recording's trial.
    pub details: TrialDetails,
    /// Settings and circumstances of the recording, for the report.
    pub facts: RecordingFacts,
    /// Rows of the recording in the CSV tables of events, a text for each table.
    pub rows: [Vec<u8>; 5],
}

/// Which optional parts of the analysis are computed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct AnalysisScope {
    /// Whether hypothetical signals of communication concepts are computed.
    pub concepts: bool,
    /// Whether rows of the CSV tables of events are written.
    pub events: bool,
}

/// Attributes people's errors to causes by means of the estimated beliefs.
struct ByEstimate {
    attributor: ErrorAttributor,
    causes: Vec<(u64, ErrorCause)>,
}

impl ByEstimate {
    /// Attributes a press that was just applied to a cause, if the press was an error.
    fn note(
        &mut self,
        stamped: &TimestampedEvent,
        change: &KitchenChange,
        follower: &SessionFollower,
        cost: &mut CostToGo,
    ) {
        let Some(press) = change.human_press() else { return };
        let (kitchen, judged) = (&follower.session.kitchen, follower.judged.last());
        let estimated = follower.estimated.as_ref().filter(|estimated| estimated.press == stamped.seq);
        let is_error = judged.is_some_and(|press| press.seq == stamped.seq && press.verdict.error);
        if let (Some(estimated), true) = (estimated, is_error) {
            let belief = expected(kitchen, estimated.state, &estimated.belief);
            let number = follower.session.all_presses();
            let cause = self.attributor.cause(kitchen, cost, &belief, &press, number);
            self.causes.push((stamped.seq, cause));
        }
    }
}

/// A belief state whose probabilities are the expected probabilities of the estimate.
fn expected(kitchen: &Kitchen, state: tomcom_core::kitchen::State, estimate: &DirichletBelief) -> Belief {
    let mut belief = Belief::of_truth(kitchen, state);
    for index in 0..kitchen.aspects.len() {
        let aspect = AspectId(index as u8);
        belief.set(aspect, estimate.aspect(aspect).mean());
    }
    belief
}

/// Analyses the recording, which tables call by `name`; `None` for a practice recording. `raters`: the two raters whose
/// codes are used, if the user named them. `kept`: the cost to go that the next recording takes over.
///
/// # Errors
/// The recording cannot be read or replayed, or it is not clear which two raters' codes to use.
pub fn read(
    recording: &Path,
    name: &str,
    extent: AnalysisScope,
    raters: Option<&[String; 2]>,
    kept: &mut KeptCost,
) -> FileResult<Option<(Arc<Kitchen>, RecordingAnalysis)>> {
    let mut log = LogReader::open(recording)?;
    let header = log.header.clone();
    if header.session.step.as_ref().is_some_and(|step| step.period.is_none()) {
        return Ok(None);
    }
    let kitchen = log.kitchen.clone();
    let mut cost = kept.take(&kitchen);
    let mut rows = RowCollector::new(name);
    let mut hands = WizardLog::default();
    let mut robot = RobotEventTally::new(header.session.robot.arm);
    let mut regret = RegretSum::default();
    let mut answers = Vec::new();
    let mut probes = ProbeCollector::default();
    let is_simulated = header.session.participant.kind == ParticipantKind::Simulated;
    let is_coded = rater_codes::raters(log.folder())?.len() >= 2;
    let mut pass = ReplayPass::new(log.session(), extent.concepts, is_simulated || is_coded, cost.clone());
    let mut trace = BeliefEvidence::default();
    let mut by_estimate = (!is_simulated).then(|| ByEstimate {
        attributor: ErrorAttributor::new(header.session.human.decision.clone(), log.session().seed()),
        causes: Vec::new(),
    });
    while let Some(line) = log.next_line()? {
        let session = &pass.follower().session;
        let was_running = session.is_running();
        let was_on = was_running || session.phase == TrialPhase::Paused;
        let change = pass.apply(&line.stamped).map_err(|error| log.refused(&line, error))?;
        let follower = pass.follower();
        hands.note(&line.stamped, &follower.session);
        probes.note(&line.stamped, &change, follower);
        regret.note(&kitchen, &mut cost, &change);
        robot.note(&line.stamped.event, follower.session.trial_clock(line.stamped.time), was_on);
        if let Some(by_estimate) = &mut by_estimate {
            by_estimate.note(&line.stamped, &change, follower, &mut cost);
            trace.note(&line.stamped, &change, &follower.session);
        }
        if extent.events {
            rows.note(&line.stamped, &change, follower, was_running);
        }
        if matches!(line.stamped.event, Event::Protocol(ProtocolEvent::AnswersConfirmed)) {
            answers.extend(questionnaire_answers::confirmed(&follower.session));
        }
    }
    let standing = exclusion_status(&pass.follower().session, &log)?;
    let coded = CodedErrors::read(&log, pass.follower(), raters)?;
    let lanes = lanes(&mut pass);
    let follower = pass.follower();
    let by_estimate = by_estimate.map(|found| found.causes);
    let (judged, basis) = coded.judged(follower, by_estimate.as_deref());
    let left_out = standing.left_out(&follower.session, log.ending() == LogEnding::Running);
    let mut trial = trial(name, &header, follower, left_out);
    trial.ended = robot.ended;
    trial.robot = robot.into_figures();
    let known = basis.and_then(|basis| known_beliefs(follower, &judged, basis, &coded, &trace, &mut cost));
    trial.beliefs = basis.map(|basis| beliefs(follower, &judged, basis, known.as_ref()));
    trial.answers = answers;
    if extent.concepts && basis == Some(BeliefSource::Recorded) && trial.signals > 0 {
        trial.useful_signals = useful_signals(recording, cost)?;
    }
    trial.additional_presses_per_order = regret.per_order(trial.orders);
    trial.wizard = (header.session.trial.condition == Condition::Wizard).then(|| match &known {
        Some(known) if known.basis != BeliefSource::Recorded => hands.measures_by_raters(follower, &known.episodes),
        _ => hands.figures(follower).measures,
    });
    let details = details(&pass, &judged, known.as_ref(), &lanes, probes);
    trial.offers = OfferSummary::from_offers(&details.offers);
    trial.probes = details.probes.as_ref().map(ProbedTrial::statistics);
    let sequences = sequences(&judged);
    let presses = TrialPressAnalyses {
        judged: &judged,
        sequences: &sequences,
        by_estimate: by_estimate.as_deref(),
        coded: &coded,
        known: known.as_ref(),
    };
    let rows = rows.finish(&follower.session, &presses, &lanes, WINDOW);
    if matches!(basis, Some(BeliefSource::Consensus | BeliefSource::Raters)) {
        trial.shared_beliefs = coded.raters.as_ref().map(|pair| RaterFalseBeliefAgreement::count(&pair.codes));
        trial.raters = coded.raters;
    }
    trial.settled_by = coded.settled_by.filter(|_| basis == Some(BeliefSource::Consensus));
    trial.stale_consensus = coded.stale.filter(|_| !is_simulated);
    let facts = RecordingFacts::from_session(&header, &follower.session);
    kept.keep(&kitchen, pass.into_cost());
    Ok(Some((kitchen, RecordingAnalysis { trial, details, facts, rows })))
}

/// Details of the trial of a replayed recording. `lanes`: the communications of each sender.
fn details(
    pass: &ReplayPass,
    judged: &[JudgedPress],
    known: Option<&KnownFalseBeliefs>,
    lanes: &[(String, Vec<CommunicationEvent>)],
    probes: ProbeCollector,
) -> TrialDetails {
    let session = &pass.follower().session;
    TrialDetails {
        offers: TimedOffer::visible(session),
        lanes: match lanes {
            [(_, of), (_, with)] => Some([of.clone(), with.clone()]),
            _ => None,
        },
        swept: match (pass, known) {
            (ReplayPass::Swept(sweeper), Some(known)) => {
                sweeper.swept(&TrialGroundTruth::new(&session.kitchen, judged, known))
            }
            _ => Vec::new(),
        },
        probes: Some(probes.finish(session)).filter(ProbedTrial::is_any),
    }
}

/// Communications of each sender, with the sender's name: the communications that were sent and, in a wizard trial,
/// those that the assistant would have sent.
fn lanes(pass: &mut ReplayPass) -> Vec<(String, Vec<CommunicationEvent>)> {
    if let ReplayPass::Beside(watcher) = pass {
        watcher.finish();
        let lanes = watcher.comparison(true).lanes;
        return lanes.iter().map(|lane| (lane.name.clone(), lane.said())).collect();
    }
    let session = &pass.follower().session;
    let name = if session.spec.trial.condition == Condition::Wizard { "wizard" } else { "assistant" };
    vec![(name.to_string(), sent(session))]
}

/// Number of pieces of content of a signal on the timeline; 0 for other entries of the timeline.
fn contents(entry: &TimelineEntry) -> u64 {
    match &entry.what {
        TimelineEvent::Signal { signal, .. } => signal.contents() as u64,
        _ => 0,
    }
}

/// Signals that were shown to the participant, as communications.
fn sent(session: &Session) -> Vec<CommunicationEvent> {
    let mut press = 0;
    let mut sent = Vec::new();
    for entry in &session.timeline {
        match &entry.what {
            TimelineEvent::Press { agent: Agent::Human, .. } => press += 1,
            TimelineEvent::Signal { signal, .. } => {
                let content = CommunicationContent::from_signal(signal).content(&session.kitchen);
                sent.push(CommunicationEvent { press, clock: clock_at(session, entry.time), content });
            }
            _ => {}
        }
    }
    sent
}

/// The participant's false beliefs, from recorded beliefs or from codes that raters share; `None` if only the estimate
/// is known.
fn known_beliefs(
    follower: &SessionFollower,
    judged: &[JudgedPress],
    basis: BeliefSource,
    coded: &CodedErrors,
    trace: &BeliefEvidence,
    cost: &mut CostToGo,
) -> Option<KnownFalseBeliefs> {
    let kitchen = &follower.session.kitchen;
    match basis {
        BeliefSource::Recorded => Some(KnownFalseBeliefs::recorded(judged, follower.episodes.all().cloned().collect())),
        BeliefSource::Consensus | BeliefSource::Raters => {
            let codes = coded.shared(judged)?;
            Some(KnownFalseBeliefs::coded(basis, kitchen, cost, trace, judged, &codes))
        }
        BeliefSource::Estimate | BeliefSource::Probes => None,
    }
}

fn beliefs(
    follower: &SessionFollower,
    judged: &[JudgedPress],
    basis: BeliefSource,
    known: Option<&KnownFalseBeliefs>,
) -> FalseBeliefErrors {
    let episodes: &[FalseBeliefEpisode] = known.map_or(&[], |known| &known.episodes);
    let count =
        |is: fn(ErrorCause) -> bool| judged.iter().filter_map(|press| press.cause).filter(|&c| is(c)).count() as u64;
    let lengths = |sequences: &[ErrorSequence]| sequences.iter().map(ErrorSequence::length).collect();
    let all = sequences(judged);
    let recovery = |sequence: &ErrorSequence| Some(since(&follower.session, sequence.began, sequence.recovered?));
    FalseBeliefErrors {
        basis,
        errors: count(|cause| matches!(cause, ErrorCause::Belief { .. })),
        of_two: count(|cause| matches!(cause, ErrorCause::Belief { with: Some(_), .. })),
        lengths: lengths(&all),
        causes: BeliefErrorCounts::from_presses(&follower.session.kitchen, judged, episodes),
        lengths_any_aspect: lengths(&sequences_any_aspect(judged)),
        recovery_s: all.iter().filter_map(recovery).collect(),
        episodes: known.map(|known| known.episodes.iter().filter(|episode| episode.errors > 0).count() as u64),
    }
}

fn trial(name: &str, header: &LogHeader, follower: &SessionFollower, left_out: Option<String>) -> TrialStatistics {
    let (session, spec) = (&follower.session, &header.session);
    let step = spec.step.as_ref();
    let between = |times: Vec<SessionTime>| -> Vec<f64> {
        times.windows(2).map(|pair| since(session, pair[0], pair[1])).collect()
    };
    let presses = std::iter::once(0).chain(session.served.iter().map(|served| served.presses)).collect::<Vec<u32>>();
    TrialStatistics {
        recording: name.to_string(),
        participant: spec.participant.code.clone(),
        seed: spec.seed,
        kind: spec.participant.kind,
        started: header.started.clone(),
        group: step.map(|step| step.group.clone()),
        period: step.and_then(|step| step.period),
        is_planned: step.is_some(),
        condition: spec.trial.condition,
        study_arm: session.study_arm(),
        planned_arm: session.planned_arm(),
        aims: step.map(|step| step.aims),
        wizard_sees: spec.console.visibility,
        acting: SignalSenderWithParameter::from_settings(session.study_arm(), spec.assistant.parameter()),
        left_out,
        ended: None,
        arm: spec.robot.arm,
        robot: RobotEventSummary::default(),
        human_presses: u64::from(session.presses[Agent::Human.index()]),
        robot_presses: u64::from(session.presses[Agent::Robot.index()]),
        initiative_presses: u64::from(session.robot.initiative_presses),
        human_model: spec.human.named(),
        errors: follower.errors() as u64,
        races: follower.judged.iter().filter(|press| press.verdict.race).count() as u64,
        unproven: follower.unproven() as u64,
        beliefs: None,
        orders: session.served.len() as u64,
        order_s: median(order_times(session)),
        additional_presses_per_order: None,
        presses_per_order: median(presses.windows(2).map(|pair| f64::from(pair[1] - pair[0])).collect()),
        press_s: median(between(follower.judged.iter().map(|press| press.time).collect())),
        signals: sent(session).len() as u64,
        signal_contents: session.timeline.iter().map(contents).sum(),
        seconds: session.trial_clock(session.time).as_secs_f64(),
        answers: Vec::new(),
        wizard: None,
        useful_signals: None,
        display_arm: (spec.participant.kind == ParticipantKind::Display).then_some(spec.display.arm),
        offers: OfferSummary::default(),
        wizard_saw_advice: session.wizard_saw_advice(),
        raters: None,
        shared_beliefs: None,
        settled_by: None,
        stale_consensus: None,
        probes: None,
    }
}

/// Time between two session times, without pauses, in seconds.
fn since(session: &Session, from: SessionTime, to: SessionTime) -> f64 {
    clock_at(session, to).secs_since(clock_at(session, from))
}
