//! Compares assistants with the signals that were sent: asks each communication concept for advice whenever the
//! assistant of a session is asked, as in a running session, and collects the signals that the concept would have sent.
//!
//! A concept receives a counterfactual estimate that leaves out every signal sent within the window. Otherwise a wizard
//! who sends the right signal early would remove the concept's reason to send that signal, and the wizard's signal
//! would count as unmatched. A concept does not repeat a hypothetical signal within the window, as if the participant
//! had seen the signal. After the window the concept may repeat the signal, because the participant has not seen it and
//! still holds the false belief. Signals that were sent before the window are subject to a session's rule against
//! repeats.

use std::collections::VecDeque;
use std::sync::Arc;

use crate::advisor::{AdviceRequest, Advisor, leads_to_advice};
use crate::apply::ApplyError;
use crate::event::WizardScreenContent;
use crate::follower::SessionFollower;
use crate::history::belief_track::BeliefSnapshot;
use crate::history::comparison::{Communication, CommunicationContext, SenderCommunications, SenderComparison};
use crate::settings::Condition;
use crate::{AppliedEvent, Event, Session, SessionSpec, TimestampedEvent};
use tomcom_core::base::time::SessionTime;
use tomcom_core::communication::Signal;
use tomcom_core::communication::concept::ConceptName;
use tomcom_core::communication::recommendation::Recommendation;
use tomcom_core::communication::signal::SignalRepeatRule;
use tomcom_core::kitchen::cost_to_go::CostToGo;
use tomcom_core::kitchen::{Agent, KitchenChange, LocationId, State};
use tomcom_core::measures::matching::CommunicationEvent;
use tomcom_core::mind::dirichlet::DirichletBelief;
use tomcom_core::mind::filter::BeliefFilter;
use tomcom_core::mind::observation::{Observation, ObservedEvidence};

#[derive(Clone, Debug, PartialEq, Eq)]
pub struct SenderComparisonSettings {
    /// In addition to the session's own.
    pub with: Vec<ConceptName>,
    /// Number of the human's presses within which two communications match; the estimate leaves out signals sent within
    /// this window.
    pub window: u32,
}

impl SenderComparisonSettings {
    /// The session's own (ToM-Com if it has none) and those in `with`.
    pub fn concepts(&self, spec: &SessionSpec) -> Vec<ConceptName> {
        let own = match spec.assistant.concept.name() {
            ConceptName::None => ConceptName::TomCom,
            own => own,
        };
        let mut concepts = vec![own];
        for &name in &self.with {
            if !concepts.contains(&name) {
                concepts.push(name);
            }
        }
        concepts
    }
}

/// A concept, with the hypothetical signals that it has sent so far.
#[derive(Debug)]
struct Voice {
    name: ConceptName,
    /// `None` of an external concept, which cannot be asked again: what it answered is in the recording.
    advisor: Option<Advisor>,
    /// Hypothetical signals within the window: number of human presses before each, and its location.
    said: Vec<(u32, LocationId)>,
    repeats: SignalRepeatRule,
    /// The error after which the concept last proposed presses.
    proposed: Option<u64>,
    spoken: Vec<Communication>,
}

/// A belief filter that leaves out one sent signal and all later ones.
#[derive(Debug)]
struct CounterfactualFilter {
    /// Number of human presses before that signal.
    press: u32,
    signal: Signal,
    /// The kitchen when it was sent.
    state: State,
    filter: BeliefFilter,
}

/// Follows a session event by event, and asks each concept for its hypothetical signals.
#[derive(Debug)]
pub struct SenderComparisonFollower {
    pub follower: SessionFollower,
    window: u32,
    voices: Vec<Voice>,
    /// One for each signal within the window, the oldest first.
    counterfactuals: VecDeque<CounterfactualFilter>,
    /// Signals sent before the window, as the rule against repeats sees them.
    shown: SignalRepeatRule,
    sent: Vec<Communication>,
    /// The newest event after which concepts are asked, once all its immediate consequences are applied.
    to_ask: Option<(u64, SessionTime)>,
    known: Option<Arc<CommunicationContext>>,
    screen: Option<WizardScreenContent>,
    asked: u64,
}

impl SenderComparisonFollower {
    pub fn new(session: Session, cost: CostToGo, request: &SenderComparisonSettings) -> SenderComparisonFollower {
        let voice = |name: ConceptName| Voice {
            name,
            advisor: (name != ConceptName::External).then(|| Advisor::by(name, &session, cost.clone())),
            said: Vec::new(),
            repeats: SignalRepeatRule::default(),
            proposed: None,
            spoken: Vec::new(),
        };
        let voices = request.concepts(&session.spec).into_iter().map(voice).collect();
        SenderComparisonFollower {
            follower: SessionFollower::new(session, cost),
            window: request.window,
            voices,
            counterfactuals: VecDeque::new(),
            shown: SignalRepeatRule::default(),
            sent: Vec::new(),
            to_ask: None,
            known: None,
            screen: None,
            asked: 0,
        }
    }

    /// Without attribution of errors to causes, which takes too long in a running session.
    pub fn without_causes(self) -> SenderComparisonFollower {
        SenderComparisonFollower { follower: self.follower.without_causes(), ..self }
    }

    pub fn apply(&mut self, stamped: &TimestampedEvent) -> Result<KitchenChange, ApplyError> {
        if self.to_ask.is_some_and(|(_, time)| !follows_at_once(stamped, time)) {
            self.ask();
        }
        let is_sent = matches!(stamped.event, Event::SignalShown { .. });
        let filter = is_sent.then(|| self.follower.filter.clone());
        let AppliedEvent { change, .. } = self.follower.apply(stamped)?;
        self.update_counterfactuals(stamped, &change);
        if let (Some(filter), Event::SignalShown { signal, .. }) = (filter, &stamped.event) {
            let (press, state) = (self.presses(), self.follower.session.state);
            self.counterfactuals.push_back(CounterfactualFilter { press, signal: signal.clone(), state, filter });
            let spoken = self.spoken(signal.clone(), stamped.time);
            self.sent.push(spoken);
        }
        match &stamped.event {
            event if event.is_sample() => return Ok(change),
            Event::Screen(screen) => self.screen = Some(screen.clone()),
            Event::TrialStarted => {
                self.shown = SignalRepeatRule::default();
                self.voices.iter_mut().for_each(|voice| voice.repeats = SignalRepeatRule::default());
            }
            _ => {}
        }
        if let Event::Advised(advice) = &stamped.event {
            self.hear(advice);
        }
        self.forget_what_was_said();
        if leads_to_advice(&self.follower.session, &stamped.event) {
            self.to_ask = Some((stamped.seq, stamped.time));
        }
        Ok(change)
    }

    /// Asks about the last event, after the end of the session.
    pub fn finish(&mut self) {
        self.ask();
    }

    /// Of the last request for advice.
    pub fn known(&self) -> Option<&Arc<CommunicationContext>> {
        self.known.as_ref()
    }

    /// Numbers of requests for advice and of sent signals: the comparison of a running trial changes only when one of
    /// them grows.
    pub fn progress(&self) -> (u64, usize) {
        (self.asked, self.sent.len())
    }

    /// Of the human so far.
    pub fn presses(&self) -> u32 {
        self.follower.session.presses[Agent::Human.index()]
    }

    /// By any event but a signal.
    fn update_counterfactuals(&mut self, stamped: &TimestampedEvent, change: &KitchenChange) {
        let (press, window) = (self.presses(), self.window);
        while let Some(oldest) = self.counterfactuals.pop_front_if(|oldest| press > oldest.press + window) {
            self.shown.shown(&self.follower.session.kitchen, oldest.state, &oldest.signal);
        }
        if self.counterfactuals.is_empty() {
            return;
        }
        let Some(what) = self.follower.observed(stamped, change) else { return };
        if matches!(what, ObservedEvidence::Told { .. } | ObservedEvidence::Proposed(_)) {
            return;
        }
        let observation = Observation { time: stamped.time, what };
        for one in &mut self.counterfactuals {
            one.filter.observe(&observation, &mut self.follower.cost);
        }
    }

    fn forget_what_was_said(&mut self) {
        let session = &self.follower.session;
        let press = session.presses[Agent::Human.index()];
        let belief = estimate(&self.follower, &self.counterfactuals);
        self.shown.update(&session.kitchen, session.state, belief);
        for voice in &mut self.voices {
            // Whether a signal about this location was really sent within the window, too.
            let is_sent = |location: &LocationId| {
                let is_it = |one: &CounterfactualFilter| one.signal.location(&session.kitchen) == Some(*location);
                self.counterfactuals.iter().any(is_it)
            };
            voice.said.retain(|(said, location)| {
                let is_kept = press <= said + self.window || is_sent(location);
                if !is_kept {
                    voice.repeats.not_shown(*location);
                }
                is_kept
            });
            voice.repeats.update(&session.kitchen, session.state, belief);
        }
    }

    fn spoken(&self, what: Signal, time: SessionTime) -> Communication {
        let session = &self.follower.session;
        let (press, content) = (self.presses(), what.compared(&session.kitchen));
        let said = CommunicationEvent { press, clock: session.trial_clock(time), content };
        Communication { said, time, what, known: self.known.clone() }
    }

    fn ask(&mut self) {
        let Some((seq, time)) = self.to_ask.take().filter(|_| self.follower.session.is_running()) else { return };
        self.asked += 1;
        let question = AdviceRequest::from_follower(&mut self.follower, seq, time);
        let session = &self.follower.session;
        let (kitchen, highlights) = (session.kitchen.clone(), session.highlights());
        let belief = estimate(&self.follower, &self.counterfactuals);
        let shown = &self.shown;
        let answer = |voice: &mut Voice| {
            let mut signals = shown.allowed(&kitchen, highlights);
            let unsaid = voice.repeats.allowed(&kitchen, highlights);
            signals.retain(|signal| unsaid.contains(signal));
            match &mut voice.advisor {
                Some(advisor) => advisor.answer(&question.about(belief, signals)),
                None => Recommendation::silent(seq, time),
            }
        };
        let advice: Vec<Recommendation> = self.voices.iter_mut().map(answer).collect();
        let held = BeliefSnapshot::new(&kitchen, session.state, belief, time, false).held;
        let (state, screen) = (session.state, self.screen.clone());
        let known = Arc::new(CommunicationContext { seq, state, held, advice, screen });
        self.known = Some(known.clone());
        for (index, advice) in known.advice.iter().enumerate() {
            let what = self.says(index, advice);
            let spoken = what.map(|what| self.spoken(what, time));
            self.voices[index].spoken.extend(spoken);
        }
    }

    /// Takes what an external concept answered from the recording.
    fn hear(&mut self, advice: &Recommendation) {
        let Some(index) = self.voices.iter().position(|voice| voice.advisor.is_none()) else { return };
        if let Some(known) = &self.known {
            let mut known = CommunicationContext::clone(known);
            known.advice[index] = advice.clone();
            self.known = Some(Arc::new(known));
        }
        let what = self.says(index, advice);
        let spoken = what.map(|what| self.spoken(what, advice.for_ns));
        self.voices[index].spoken.extend(spoken);
    }

    /// The hypothetical signal to which a recommendation leads; the concept remembers it so as not to repeat it.
    fn says(&mut self, index: usize, advice: &Recommendation) -> Option<Signal> {
        let session = &self.follower.session;
        let voice = &mut self.voices[index];
        if let Some(signal) = &advice.best {
            voice.repeats.shown(&session.kitchen, session.state, signal);
            let location = signal.location(&session.kitchen);
            // An older hypothetical signal about the same location is removed, so that the location stays remembered
            // when the older signal leaves the window.
            voice.said.retain(|(_, earlier)| Some(*earlier) != location);
            voice.said.extend(location.map(|location| (session.presses[Agent::Human.index()], location)));
            return Some(signal.clone());
        }
        // The concept DEV proposes presses once per error, even while no later error follows.
        let proposal = advice.proposal.as_ref().filter(|proposal| voice.proposed != Some(proposal.error))?;
        voice.proposed = Some(proposal.error);
        Some(Signal::Propose(proposal.presses.clone()))
    }

    /// `over`: the session has ended.
    pub fn comparison(&self, over: bool) -> SenderComparison {
        let sender = match self.follower.session.spec.trial.condition {
            Condition::Assistant => "assistant",
            Condition::Wizard => "wizard",
            Condition::None => "nobody",
        };
        let mut lanes =
            vec![SenderCommunications { name: sender.to_string(), concept: None, spoken: self.sent.clone() }];
        lanes.extend(self.voices.iter().map(|voice| SenderCommunications {
            name: voice.name.name().to_string(),
            concept: Some(voice.name),
            spoken: voice.spoken.clone(),
        }));
        SenderComparison::new(lanes, self.window, self.presses(), over)
    }
}

/// Leaves out the signals sent within the window.
fn estimate<'a>(
    follower: &'a SessionFollower,
    counterfactuals: &'a VecDeque<CounterfactualFilter>,
) -> &'a DirichletBelief {
    counterfactuals.front().map_or(follower.filter.belief(), |oldest| oldest.filter.belief())
}

/// Whether an event is an immediate consequence of the event at `time`.
pub fn follows_at_once(stamped: &TimestampedEvent, time: SessionTime) -> bool {
    let is_new = matches!(
        stamped.event,
        Event::Gaze(_)
            | Event::RobotMoves(_)
            | Event::RobotSafety { .. }
            | Event::RobotTouched { .. }
            | Event::RobotStage { .. }
            | Event::ParticipantBelieves(_)
            | Event::Probe(_)
            | Event::Advised(_)
            | Event::External(_)
            | Event::SignalShown { .. }
            | Event::Screen(_)
    );
    stamped.time == time && !is_new
}
