//! Replays one recording of a study once, and reduces the recording to the statistics that the analysis keeps. Reads
//! also the consent and the answers to tutorials, which can stand in practice recordings.

use std::collections::VecDeque;
use std::path::Path;
use std::sync::Arc;

use serde::{Deserialize, Serialize};

use crate::analysis::offer_summary::{OfferSummary, TimedOffer};
use crate::analysis::probe_record::{ProbeCollector, ProbedTrial};
use crate::analysis::trial_summary::{RegretSum, TrialSummary, belief_related, order_times, seconds_between};
use crate::facts::RecordingFacts;
use crate::kept_cost::KeptCost;
use crate::pass::rows::{CodedErrors, RowCollector, TrialPressAnalyses};
use crate::pass::sweep::{ConceptSweep, useful_signals};
use crate::prevention::TrialGroundTruth;
use crate::rater_episodes::{BeliefEvidence, KnownFalseBeliefs, RaterFalseBeliefAgreement};
use crate::robot_tally::RobotEventTally;
use crate::standing::exclusion_status;
use crate::tables::participants::{TutorialAnswerCollector, TutorialQuestionRow};
use crate::trial_statistics::{
    AskedItem, DisplayLosses, FalseBeliefErrors, QuestionnaireAnswer, SignalSenderWithParameter, TrialDetails,
    TrialStatistics,
};
use tomcom_core::base::time::SessionTime;
use tomcom_core::communication::concept::ConceptName;
use tomcom_core::kitchen::cost_to_go::CostToGo;
use tomcom_core::kitchen::{Agent, AspectId, Kitchen, KitchenChange};
use tomcom_core::measures::attribution::{ErrorAttributor, ErrorCause};
use tomcom_core::measures::matching::{CommunicationEvent, WINDOW};
use tomcom_core::measures::raters::BeliefSource;
use tomcom_core::measures::sequences::{
    BeliefErrorCounts, ErrorSequence, FalseBeliefEpisode, sequences, sequences_any_aspect,
};
use tomcom_core::measures::{JudgedPress, median};
use tomcom_core::mind::RecordedEstimate;
use tomcom_core::mind::belief::Belief;
use tomcom_core::mind::dirichlet::DirichletBelief;
use tomcom_session::apply::ApplyError;
use tomcom_session::files::file_error::{FileError, FileResult};
use tomcom_session::follower::{PressBeliefEstimate, SessionFollower};
use tomcom_session::log::{LogReader, at_line, rater_codes};
use tomcom_session::plan::{AnswerFormat, Questionnaire, QuestionnaireItem, QuestionnaireItemKind, ScoreRule};
use tomcom_session::protocol::{ProtocolEvent, StudyProtocolState};
use tomcom_session::settings::{Condition, ParticipantKind};
use tomcom_session::wall_display::{AnswerDevice, DisplayEvent};
use tomcom_session::watcher::{SenderComparisonFollower, SenderComparisonSettings};
use tomcom_session::wizard_log::WizardSummary;
use tomcom_session::{Event, Session, TimelineEvent, TimestampedEvent, TrialPhase};

#[derive(Debug)]
pub struct RecordingAnalysis {
    pub trial: TrialStatistics,
    pub details: TrialDetails,
    pub facts: RecordingFacts,
    pub rows: [Vec<u8>; 5],
}

#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct AnalysisScope {
    pub concepts: bool,
    pub events: bool,
    /// The two raters whose codes are used; `None`: the only two, or for each recording the two with the most complete codes.
    pub raters: Option<[String; 2]>,
}

/// Sums up the times at which the participant's display was lost, on the trial's clock.
#[derive(Debug, Default)]
struct DisplayLossTally {
    /// Trial's clock at the beginning of the open loss.
    lost: Option<SessionTime>,
    losses: DisplayLosses,
}

impl DisplayLossTally {
    fn note(&mut self, stamped: &TimestampedEvent, session: &Session) {
        let clock = session.trial_clock(stamped.time);
        match stamped.event {
            Event::Display(DisplayEvent::Lost) => self.lost = self.lost.or(Some(clock)),
            Event::Display(DisplayEvent::Connected { .. }) => self.close(clock),
            _ => {}
        }
    }

    /// Ends a loss that is still open; losses while the trial's clock stood do not count.
    fn close(&mut self, clock: SessionTime) {
        let seconds = self.lost.take().map_or(0.0, |lost| clock.secs_since(lost));
        if seconds > 0.0 {
            self.losses.times += 1;
            self.losses.seconds += seconds;
        }
    }

    fn finish(mut self, session: &Session) -> DisplayLosses {
        self.close(session.trial_clock(session.time));
        self.losses
    }
}

struct ByEstimate {
    attributor: ErrorAttributor,
    causes: Vec<(u64, ErrorCause)>,
}

impl ByEstimate {
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

fn expected(kitchen: &Kitchen, state: tomcom_core::kitchen::State, estimate: &DirichletBelief) -> Belief {
    let mut belief = Belief::of_truth(kitchen, state);
    for index in 0..kitchen.aspects.len() {
        let aspect = AspectId(index as u8);
        belief.set(aspect, estimate.aspect(aspect).mean());
    }
    belief
}

/// Analyses the recording, which tables call by `name`; `None` for a practice recording. `kept`: the cost to go that the
/// next recording takes over. Errors: the recording cannot be read or replayed, or it is not clear which two raters' codes
/// to use.
pub fn read(
    recording: &Path,
    name: &str,
    scope: &AnalysisScope,
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
    let mut robot = RobotEventTally::new(header.session.robot.arm);
    let mut regret = RegretSum::default();
    let (mut answers, mut estimates) = (Vec::new(), VecDeque::new());
    let mut probes = ProbeCollector::default();
    let mut display = DisplayLossTally::default();
    let is_simulated = header.session.participant.kind == ParticipantKind::Simulated;
    let coders = rater_codes::raters(log.folder())?.len();
    let is_coded = coders >= 2;
    // Another version of the program may estimate otherwise.
    let repeats = log.headers().all(|part| part.program == env!("CARGO_PKG_VERSION"));
    let mut pass = ReplayPass::new(log.session(), scope.concepts, is_simulated || is_coded, cost.clone());
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
        probes.note(&line.stamped, &change, follower);
        regret.note(&kitchen, &mut cost, &change);
        display.note(&line.stamped, &follower.session);
        robot.note(&line.stamped.event, follower.session.trial_clock(line.stamped.time), was_on);
        if let Some(by_estimate) = &mut by_estimate {
            by_estimate.note(&line.stamped, &change, follower, &mut cost);
            trace.note(&line.stamped, &change, &follower.session);
        }
        if scope.events {
            rows.note(&line.stamped, &change, follower, was_running);
        }
        match line.stamped.event {
            Event::Protocol(ProtocolEvent::AnswersConfirmed) => answers.extend(confirmed_answers(&follower.session)),
            Event::BeliefEstimated(estimate) => {
                let again = follower.estimated.as_ref();
                if repeats && again.is_none_or(|again| !is_alike(again, &estimate)) {
                    return Err(unlike_recorded(log.path(), (line.number, &line.text), &estimate, again));
                }
                estimates.push_back(estimate);
            }
            _ => {}
        }
    }
    let standing = exclusion_status(&pass.follower().session, &log)?;
    let coded = CodedErrors::read(&log, pass.follower(), scope.raters.as_ref())?;
    let lanes = lanes(&mut pass);
    let follower = pass.follower();
    let (session, spec) = (&follower.session, &header.session);
    let by_estimate = by_estimate.map(|found| found.causes);
    let (judged, basis) = coded.judged(follower, by_estimate.as_deref());
    let known = basis.and_then(|basis| known_beliefs(follower, &judged, basis, &coded, &trace, &mut cost));
    let details = details(&pass, &judged, known.as_ref(), &lanes, probes);
    let sequences = sequences(&judged);
    let presses = TrialPressAnalyses {
        judged: &judged,
        sequences: &sequences,
        by_estimate: by_estimate.as_deref(),
        coded: &coded,
        known: known.as_ref(),
    };
    let rows = rows.finish(session, &presses, &lanes);
    let summary = TrialSummary::from_follower(follower);
    let (step, orders) = (spec.step.as_ref(), summary.served.len() as u64);
    let is_rated = matches!(basis, Some(BeliefSource::Consensus | BeliefSource::Raters));
    let raters = coded.raters.filter(|_| is_rated);
    let are_judged = scope.concepts && basis == Some(BeliefSource::Recorded) && summary.signals > 0;
    let display_arm = (spec.participant.kind == ParticipantKind::Display).then_some(spec.display.arm);
    let contents = session.timeline.iter().filter_map(|entry| match &entry.what {
        TimelineEvent::Noted(Event::SignalShown { signal, .. }) => Some(signal.names().len() as u64),
        _ => None,
    });
    let between_presses = follower.judged.windows(2).map(|pair| seconds_between(session, pair[0].time, pair[1].time));
    let trial = TrialStatistics {
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
        left_out: standing.left_out(session, log.ending()),
        ended: robot.ended,
        arm: spec.robot.arm,
        robot: robot.figures,
        human_presses: summary.human_actions,
        robot_presses: summary.robot_actions,
        initiative_presses: u64::from(session.robot.initiative_presses),
        human_model: spec.human.named(),
        errors: summary.errors,
        races: summary.races,
        unproven: follower.unproven() as u64,
        beliefs: basis.map(|basis| beliefs(follower, &judged, basis, known.as_ref())),
        orders,
        order_s: median(order_times(session)),
        presses_per_order: median(summary.served.iter().map(|(_, presses)| f64::from(*presses)).collect()),
        additional_presses_per_order: regret.per_order(orders),
        press_s: median(between_presses.collect()),
        signals: summary.signals,
        signal_contents: contents.sum(),
        useful_signals: if are_judged { useful_signals(recording, estimates, cost)? } else { None },
        display_arm,
        display_losses: display_arm.map(|_| display.finish(session)),
        offers: OfferSummary::from_offers(&details.offers),
        seconds: summary.seconds,
        answers,
        wizard: (spec.trial.condition == Condition::Wizard).then(|| match &known {
            Some(known) if known.basis != BeliefSource::Recorded => {
                WizardSummary::measures_by_raters(follower, &known.episodes)
            }
            _ => WizardSummary::from_follower(follower).measures,
        }),
        wizard_saw_advice: session.wizard_saw_advice(),
        shared_beliefs: raters.as_ref().map(|pair| RaterFalseBeliefAgreement::count(&pair.codes)),
        raters,
        settled_by: coded.settled_by.filter(|_| basis == Some(BeliefSource::Consensus)),
        stale_consensus: coded.stale.filter(|_| !is_simulated),
        probes: details.probes.as_ref().map(ProbedTrial::statistics),
    };
    let mut facts = RecordingFacts::from_session(&header, session);
    if is_simulated && coders > 0 {
        facts.note(RecordingFacts::UNUSED_CODES, name.to_string());
    }
    kept.keep(&kitchen, pass.into_cost());
    Ok(Some((kitchen, RecordingAnalysis { trial, details, facts, rows })))
}

/// Largest difference of ln p (recorded with four digits) between two computations of one estimate, in nats.
const ALIKE: f64 = 1e-3;

/// Whether two estimates are of one press and differ by no more than the arithmetic of two machines.
fn is_alike(again: &PressBeliefEstimate, recorded: &RecordedEstimate) -> bool {
    again.press == recorded.press && (again.evidence.log_p - recorded.log_p).abs() <= ALIKE
}

/// The estimate that a log has at a press does not follow from what the log has before it.
fn unlike_recorded(
    log: &Path,
    (number, text): (usize, &str),
    recorded: &RecordedEstimate,
    again: Option<&PressBeliefEstimate>,
) -> FileError {
    let again = again
        .map_or("none".to_string(), |again| format!("ln p = {:.4} of press {}", again.evidence.log_p, again.press));
    let found = format!(
        "an estimate (ln p = {} of press {}) that does not follow from the events before it, which lead to {again}: the log was \
         changed",
        recorded.log_p, recorded.press
    );
    let remedy = "the log as tomcom wrote it: tomcom replay RECORDING --verify names the first line that differs; or leave the \
                  recording out: tomcom exclude RECORDING --reason …";
    at_line(log, number, text, 0, found, remedy)
}

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

/// By sender: those that were sent and, in a wizard trial, those that the assistant would have sent.
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

fn sent(session: &Session) -> Vec<CommunicationEvent> {
    let mut press = 0;
    let mut sent = Vec::new();
    for entry in &session.timeline {
        match &entry.what {
            TimelineEvent::Press { agent: Agent::Human, .. } => press += 1,
            TimelineEvent::Noted(Event::SignalShown { signal, .. }) => {
                let content = signal.compared(&session.kitchen);
                sent.push(CommunicationEvent { press, clock: session.trial_clock_at(entry.time), content });
            }
            _ => {}
        }
    }
    sent
}

/// From recorded beliefs, or codes that raters share; `None` if only the estimate is known.
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
    let [errors, of_two] = belief_related(judged);
    let lengths = |sequences: &[ErrorSequence]| sequences.iter().map(ErrorSequence::length).collect();
    let all = sequences(judged);
    let recovery =
        |sequence: &ErrorSequence| Some(seconds_between(&follower.session, sequence.began, sequence.recovered?));
    FalseBeliefErrors {
        basis,
        errors,
        of_two,
        lengths: lengths(&all),
        causes: BeliefErrorCounts::from_presses(&follower.session.kitchen, judged, episodes),
        lengths_any_aspect: lengths(&sequences_any_aspect(judged)),
        recovery_s: all.iter().filter_map(recovery).collect(),
        episodes: known.map(|known| known.episodes.iter().filter(|episode| episode.errors > 0).count() as u64),
    }
}

fn confirmed_answers(session: &Session) -> Vec<QuestionnaireAnswer> {
    let (Some(questionnaire), Some(protocol)) = (session.questionnaire(), &session.protocol) else { return Vec::new() };
    let before = session.phase == TrialPhase::Ready;
    let score = score(questionnaire, protocol);
    let answered = |(index, item): (usize, &QuestionnaireItem)| {
        let form = questionnaire.form(index);
        QuestionnaireAnswer {
            asked: AskedItem {
                questionnaire: questionnaire.name.clone(),
                item: item.id.clone(),
                text: item.text.clone(),
                about: item.about.clone(),
                reversed: item.reversed,
                kind: item.kind.unwrap_or(QuestionnaireItemKind::Scale),
            },
            answer: protocol.given(index).cloned(),
            points: match form {
                Some(AnswerFormat::Scale(scale)) => Some(scale.points),
                _ => None,
            },
            options: item.options.clone(),
            share: share(questionnaire, protocol, index),
            before,
            score,
        }
    };
    questionnaire.items.iter().enumerate().map(answered).collect()
}

/// Answer to an item as a number from 0 to 1 on the item's scale, reversed if the item is reverse coded.
fn share(questionnaire: &Questionnaire, protocol: &StudyProtocolState, index: usize) -> Option<f64> {
    let [least, most] = questionnaire.form(index)?.ends()?;
    let share = (protocol.given(index)?.number()? - least) as f64 / (most - least).max(1) as f64;
    Some(if questionnaire.items.get(index)?.reversed { 1.0 - share } else { share })
}

/// Score of the questionnaire; `None` if the questionnaire has no scoring rule, or if an item was left out.
fn score(questionnaire: &Questionnaire, protocol: &StudyProtocolState) -> Option<f64> {
    let count = questionnaire.items.len();
    let shares: Option<Vec<f64>> = (0..count).map(|index| share(questionnaire, protocol, index)).collect();
    let shares = shares.filter(|shares| !shares.is_empty())?;
    match questionnaire.score? {
        ScoreRule::Mean => {
            let on_scale = |(index, share): (usize, &f64)| {
                let [least, most] = questionnaire.form(index)?.ends()?;
                Some(least as f64 + share * (most - least) as f64)
            };
            let sum: Option<f64> = shares.iter().enumerate().map(on_scale).sum();
            Some(sum? / count as f64)
        }
        // System Usability Scale: each item adds 0 to 4 points, and the sum of points is multiplied by 2.5 (Brooke
        // 1996).
        ScoreRule::Sus => Some(2.5 * shares.iter().map(|share| (4.0 * share).round()).sum::<f64>()),
    }
}

/// `log`: nothing was read of it yet; `name`: as in tables. Empty without a tutorial.
pub(super) fn tutorial_answers(mut log: LogReader, name: &str) -> FileResult<Vec<TutorialQuestionRow>> {
    let spec = log.header.session.clone();
    let Some(mut answers) = TutorialAnswerCollector::new(name, &spec) else { return Ok(Vec::new()) };
    while let Some(line) = log.next_line()? {
        answers.note(&line.stamped);
    }
    Ok(answers.finish())
}

#[derive(Debug)]
enum ReplayPass {
    Plain(Box<SessionFollower>),
    Beside(Box<SenderComparisonFollower>),
    Swept(Box<ConceptSweep>),
}

impl ReplayPass {
    /// The replay for this session. `concepts`: whether hypothetical signals are wanted. `is_known`: whether the
    /// participant's beliefs are recorded, or may follow from raters' codes.
    fn new(session: Session, concepts: bool, is_known: bool, cost: CostToGo) -> ReplayPass {
        let (spec, mut session) = (&session.spec.clone(), session);
        match spec.trial.condition {
            Condition::Wizard if concepts => {
                let request = SenderComparisonSettings { with: Vec::new(), window: WINDOW };
                session.spec.assistant.concept = ConceptName::TomCom.into();
                ReplayPass::Beside(Box::new(SenderComparisonFollower::new(session, cost, &request)))
            }
            // Prevented errors can be counted only where false beliefs are known.
            Condition::None if concepts && is_known => ReplayPass::Swept(Box::new(ConceptSweep::new(session, cost))),
            _ => ReplayPass::Plain(Box::new(SessionFollower::new(session, cost))),
        }
    }

    /// Applies the next event of the recording. Errors: the event does not fit the session.
    fn apply(&mut self, stamped: &TimestampedEvent) -> Result<KitchenChange, ApplyError> {
        match self {
            ReplayPass::Plain(follower) => follower.apply(stamped).map(|applied| applied.change),
            ReplayPass::Beside(watcher) => watcher.apply(stamped),
            ReplayPass::Swept(sweeper) => sweeper.apply(stamped),
        }
    }

    fn into_cost(self) -> CostToGo {
        match self {
            ReplayPass::Plain(follower) => follower.cost,
            ReplayPass::Beside(watcher) => watcher.follower.cost,
            ReplayPass::Swept(sweeper) => sweeper.cost,
        }
    }

    fn follower(&self) -> &SessionFollower {
        match self {
            ReplayPass::Plain(follower) => follower,
            ReplayPass::Beside(watcher) => &watcher.follower,
            ReplayPass::Swept(sweeper) => &sweeper.follower,
        }
    }
}

/// That the practice ended without its criterion being met and the wizard went on; `None` for trials.
pub(crate) fn waived_practice(recording: &Path) -> FileResult<Option<WaivedPractice>> {
    let mut log = LogReader::open(recording)?;
    let spec = &log.header.session;
    if spec.step.as_ref().is_none_or(|step| step.criterion.is_none()) {
        return Ok(None);
    }
    let participant = spec.participant.code.clone();
    let mut result = None;
    while let Some(line) = log.next_line()? {
        match line.stamped.event {
            Event::Protocol(ProtocolEvent::CriterionChecked { orders, presses, errors, .. }) => {
                result = Some((orders, presses, errors));
            }
            Event::Protocol(ProtocolEvent::CriterionWaived { reason }) => {
                let practice =
                    |(orders, presses, errors)| WaivedPractice { participant, reason, orders, presses, errors };
                return Ok(result.map(practice));
            }
            _ => {}
        }
    }
    Ok(None)
}

/// Practice whose criterion was not met, and was waived.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct WaivedPractice {
    pub participant: String,
    pub reason: String,
    pub orders: u32,
    /// Of the participant.
    pub presses: u32,
    pub errors: u32,
}

impl WaivedPractice {
    /// Those of a study in one sentence; `None` if there are none.
    pub fn in_words(all: &[WaivedPractice]) -> Option<String> {
        let one = |one: &WaivedPractice| {
            let WaivedPractice { participant, reason, orders, presses, errors } = one;
            format!("{participant} ({reason}; orders {orders}, errors {errors} in presses {presses})")
        };
        let named: Vec<String> = all.iter().map(one).collect();
        (!all.is_empty()).then(|| format!("practice criterion not met, and waived: {}", named.join(", ")))
    }
}

/// That with which the recording begins (in its first part).
pub(crate) fn consent(recording: &Path) -> FileResult<Option<RecordedConsent>> {
    let mut log = LogReader::open(recording)?;
    let participant = log.header.session.participant.code.clone();
    if let [first, _, ..] = &log.logs()[..] {
        log = LogReader::open(first)?;
    }
    while let Some(line) = log.next_line()? {
        match line.stamped.event {
            Event::Protocol(ProtocolEvent::ConsentGiven { on, digest, .. }) => {
                return Ok(Some(RecordedConsent { participant, on, started: log.header.started.clone(), digest }));
            }
            // Consent is given before the first phase of the recording, or not at all.
            Event::Protocol(ProtocolEvent::PhaseStarted { .. }) | Event::TrialStarted => return Ok(None),
            _ => {}
        }
    }
    Ok(None)
}

#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RecordedConsent {
    pub participant: String,
    pub on: AnswerDevice,
    /// Wall clock time at which the recording that begins with the consent began (UTC, RFC 3339).
    pub started: Option<String>,
    pub digest: String,
}

impl RecordedConsent {
    pub fn place(&self) -> &'static str {
        match self.on {
            AnswerDevice::Console => "console",
            AnswerDevice::Display => "display",
        }
    }
}
