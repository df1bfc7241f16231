//! Sets assistants beside what was sent: asks them after every press and order change of a session, as the engine does, and
//! keeps what they would have said.
//!
//! An assistant is asked about an estimate that leaves out every signal that was sent within the window; else a wizard who is
//! quick and right would silence it, and count as unmatched. What a concept has said it does not say again within the window, as
//! if it had been shown; later it may, for it was not, and the participant goes on in the same false belief. What was sent
//! before the window is not said again before it may have been forgotten, as in a session.

use std::collections::VecDeque;
use std::sync::Arc;

use super::advisor::changes_task;
use super::advisor::{AdviceRequest, Advisor};
use super::follower::Follower;
use crate::base::time::SessionTime;
use crate::communication::Signal;
use crate::communication::concept::ConceptName;
use crate::communication::recommendation::Recommendation;
use crate::communication::repeats::Repeats;
use crate::history::belief_track::BeliefSnapshot;
use crate::history::comparison::{
    Communication, CommunicationContent, CommunicationContext, CommunicationLane, LaneComparison,
};
use crate::kitchen::cost_to_go::CostToGo;
use crate::kitchen::{Agent, Change, LocationId, State};
use crate::measures::matching::CommunicationEvent;
use crate::mind::dirichlet::DirichletBelief;
use crate::mind::filter::BeliefFilter;
use crate::mind::observation::{Observation, Observed};
use crate::session::apply::ApplyError;
use crate::session::screen::VisibleScreen;
use crate::session::settings::Condition;
use crate::session::{Applied, Event, Session, SessionSpec, Stamped};

/// What is compared.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct CompareRequest {
    /// Beside the session's own concept.
    pub with: Vec<ConceptName>,
    pub window: u32,
}

impl CompareRequest {
    /// The concepts that are asked: the session's own, or ToM-Com where it has none, and those that were asked for.
    pub fn concepts(&self, spec: &SessionSpec) -> Vec<ConceptName> {
        let own = match spec.assistant.concept {
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

/// A concept and its lane.
#[derive(Debug)]
struct Voice {
    name: ConceptName,
    advisor: Advisor,
    /// What it has said within the window: the presses of the human before it, and where.
    said: Vec<(u32, LocationId)>,
    repeats: Repeats,
    /// The error that it has proposed presses for.
    proposed: Option<u64>,
    spoken: Vec<Communication>,
}

/// The estimate that leaves out one signal and all later ones.
#[derive(Debug)]
struct CounterfactualFilter {
    /// Presses of the human before the signal.
    press: u32,
    signal: Signal,
    /// What lay where.
    state: State,
    filter: BeliefFilter,
}

/// Follows a session, event by event, and asks.
#[derive(Debug)]
pub struct ComparisonFollower {
    pub follower: Follower,
    window: u32,
    voices: Vec<Voice>,
    /// One for each signal that was sent within the window, the oldest first.
    counterfactuals: VecDeque<CounterfactualFilter>,
    /// Those before.
    shown: Repeats,
    sent: Vec<Communication>,
    /// The newest event after which is asked, when all that follows at once has happened.
    to_ask: Option<(u64, SessionTime)>,
    known: Option<Arc<CommunicationContext>>,
    screen: Option<VisibleScreen>,
    /// How often was asked.
    asked: u64,
}

impl ComparisonFollower {
    /// A watcher of a session from before its first event on.
    pub fn new(session: Session, request: &CompareRequest) -> ComparisonFollower {
        let cost = CostToGo::new(session.kitchen.clone());
        let voice = |name: ConceptName| Voice {
            name,
            advisor: Advisor::by(name, &session, cost.clone()),
            said: Vec::new(),
            repeats: Repeats::default(),
            proposed: None,
            spoken: Vec::new(),
        };
        let voices = request.concepts(&session.spec).into_iter().map(voice).collect();
        ComparisonFollower {
            follower: Follower::new(session, cost),
            window: request.window,
            voices,
            counterfactuals: VecDeque::new(),
            shown: Repeats::default(),
            sent: Vec::new(),
            to_ask: None,
            known: None,
            screen: None,
            asked: 0,
        }
    }

    /// The same without looking for the causes of errors, which takes longer than a running session can wait.
    pub fn without_causes(self) -> ComparisonFollower {
        ComparisonFollower { follower: self.follower.without_causes(), ..self }
    }

    /// Moves on by one event.
    ///
    /// # Errors
    /// Those of [`Follower::apply`].
    pub fn apply(&mut self, stamped: &Stamped) -> Result<Change, ApplyError> {
        if self.to_ask.is_some_and(|(_, time)| !follows_at_once(stamped, time)) {
            self.ask();
        }
        let is_sent = matches!(stamped.event, Event::SignalShown { .. });
        let filter = is_sent.then(|| self.follower.filter.clone());
        let Applied { change, .. } = self.follower.apply(stamped)?;
        self.update_counterfactuals(stamped, &change);
        if let (Some(filter), Event::SignalShown { signal, .. }) = (filter, &stamped.event) {
            let (press, state) = (self.presses(), self.follower.session.state);
            self.counterfactuals.push_back(CounterfactualFilter { press, signal: signal.clone(), state, filter });
            let spoken = self.spoken(CommunicationContent::Signal(signal.clone()), stamped.time);
            self.sent.push(spoken);
        }
        match &stamped.event {
            event if event.is_sample() => return Ok(change),
            Event::Screen(screen) => self.screen = Some(screen.clone()),
            Event::TrialStarted => {
                self.shown = Repeats::default();
                self.voices.iter_mut().for_each(|voice| voice.repeats = Repeats::default());
            }
            _ => {}
        }
        self.forget_what_was_said();
        if self.follower.session.is_running() && changes_task(&stamped.event) {
            self.to_ask = Some((stamped.seq, stamped.time));
        }
        Ok(change)
    }

    /// Asks what is still to be asked: there will be no more events.
    pub fn finish(&mut self) {
        self.ask();
    }

    /// What was known when the concepts were asked last.
    pub fn known(&self) -> Option<&Arc<CommunicationContext>> {
        self.known.as_ref()
    }

    /// How often the concepts were asked, and how many signals were sent: one of them grows whenever the comparison
    /// changes in a running trial.
    pub fn progress(&self) -> (u64, usize) {
        (self.asked, self.sent.len())
    }

    /// Presses of the human so far.
    pub fn presses(&self) -> u32 {
        self.follower.session.presses[Agent::Human.index()]
    }

    /// Updates the counterfactual filters by an event, unless it is a signal.
    fn update_counterfactuals(&mut self, stamped: &Stamped, change: &Change) {
        let (press, window) = (self.presses(), self.window);
        while let Some(oldest) = self.counterfactuals.pop_front_if(|oldest| press > oldest.press + window) {
            self.shown.shown(&self.follower.session.kitchen, oldest.state, &oldest.signal);
        }
        if self.counterfactuals.is_empty() {
            return;
        }
        let Some(what) = self.follower.observed(stamped, change) else { return };
        if matches!(what, Observed::Told { .. }) {
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
            // What was sent as well is not asked for once more.
            let is_sent = |location: &LocationId| {
                let is_it =
                    |one: &CounterfactualFilter| session.kitchen.location_named(one.signal.target()) == Some(*location);
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

    fn spoken(&self, what: CommunicationContent, time: SessionTime) -> Communication {
        let session = &self.follower.session;
        let (press, content) = (self.presses(), what.content(&session.kitchen));
        let said = CommunicationEvent { press, clock: session.trial_clock(time), content };
        Communication { said, time, what, known: self.known.clone() }
    }

    /// Asks every concept what it would say now.
    fn ask(&mut self) {
        let Some((seq, time)) = self.to_ask.take().filter(|_| self.follower.session.is_running()) else { return };
        self.asked += 1;
        let session = &self.follower.session;
        let (kitchen, own_hand) = (session.kitchen.clone(), session.spec.signals.own_hand);
        let question = AdviceRequest::from_follower(&self.follower, seq, time);
        let belief = estimate(&self.follower, &self.counterfactuals);
        let shown = &self.shown;
        let answer = |voice: &mut Voice| {
            let mut signals = shown.allowed(&kitchen, own_hand);
            let unsaid = voice.repeats.allowed(&kitchen, own_hand);
            signals.retain(|signal| unsaid.contains(signal));
            voice.advisor.answer(&question.about(belief, signals))
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

    /// What a concept says by its advice; it is remembered that it was said.
    fn says(&mut self, index: usize, advice: &Recommendation) -> Option<CommunicationContent> {
        let session = &self.follower.session;
        let voice = &mut self.voices[index];
        if let Some(signal) = &advice.best {
            voice.repeats.shown(&session.kitchen, session.state, signal);
            let location = session.kitchen.location_named(signal.target());
            voice.said.extend(location.map(|location| (session.presses[Agent::Human.index()], location)));
            return Some(CommunicationContent::Signal(signal.clone()));
        }
        // One proposal for an error, however long it stands.
        let proposal = advice.proposal.as_ref().filter(|proposal| voice.proposed != Some(proposal.error))?;
        voice.proposed = Some(proposal.error);
        Some(CommunicationContent::Proposal(proposal.presses.clone()))
    }

    /// What was said so far, and how alike it is; `over`: nothing more will come.
    pub fn comparison(&self, over: bool) -> LaneComparison {
        let sender = match self.follower.session.spec.trial.condition {
            Condition::Assistant => "assistant",
            Condition::Wizard => "wizard",
            Condition::None => "nobody",
        };
        let mut lanes = vec![CommunicationLane { name: sender.to_string(), concept: None, spoken: self.sent.clone() }];
        lanes.extend(self.voices.iter().map(|voice| CommunicationLane {
            name: voice.name.name().to_string(),
            concept: Some(voice.name),
            spoken: voice.spoken.clone(),
        }));
        LaneComparison::new(lanes, self.window, self.presses(), over)
    }
}

/// The estimate that leaves out what was sent within the window.
fn estimate<'a>(follower: &'a Follower, counterfactuals: &'a VecDeque<CounterfactualFilter>) -> &'a DirichletBelief {
    counterfactuals.front().map_or(follower.filter.belief(), |oldest| oldest.filter.belief())
}

/// Whether an event belongs to what the event at `time` led to at once.
pub fn follows_at_once(stamped: &Stamped, time: SessionTime) -> bool {
    let is_new = matches!(
        stamped.event,
        Event::Gaze(_)
            | Event::RobotMoves(_)
            | Event::RobotSafety { .. }
            | Event::RobotTouched { .. }
            | Event::ParticipantBelieves(_)
            | Event::Advised(_)
            | Event::SignalShown { .. }
            | Event::Screen(_)
    );
    stamped.time == time && !is_new
}
