//! A set of explicit beliefs that are updated with the same events: the samples of the reference filter, the particles
//! of an unprojected filter, or one human simulated from the model.

use std::sync::Arc;

use rand::RngExt;

use super::looks::{self, LookNeedProbabilities, LookTracker, ReferenceSignalHistory};
use super::person::Particle;
use tomcom_core::base::rng::Stream;
use tomcom_core::base::time::SessionTime;
use tomcom_core::gaze::GazeSample;
use tomcom_core::kitchen::cost_to_go::CostToGo;
use tomcom_core::kitchen::{Agent, AspectId, AspectKind, ButtonId, Kitchen, LocationId, OrderContent, Press, State};
use tomcom_core::mind::dirichlet::{Dirichlet, DirichletBelief};
use tomcom_core::mind::filter::unseen::UnknownGazeTimer;
use tomcom_core::mind::model::HumanModel;
use tomcom_core::mind::observation::{Observation, ObservedEvidence, ProposedPresses};

/// A set of explicit beliefs (particles), with the model and state that all of them share.
#[derive(Clone, Debug)]
pub struct ParticleSet {
    kitchen: Arc<Kitchen>,
    model: HumanModel,
    /// The prior: distribution of the belief at the start, to which beliefs about recipes decay.
    pub prior: DirichletBelief,
    /// Distribution that replaces a belief after an observation that was impossible under that belief.
    pub doubt: DirichletBelief,
    pub of: Vec<Particle>,
    sight: LookTracker,
    presence: UnknownGazeTimer,
    /// Where the human of each belief looks while the gaze is unknown, once it has been computed after the last event.
    unseen: Option<LookNeedProbabilities>,
    shown: State,
    /// Time up to which forgetting of recipes has been applied; `None` while the trial is paused.
    forgot: Option<SessionTime>,
    /// Time at which the task was frozen for a probe, as long as it stands still.
    frozen: Option<SessionTime>,
    /// The presses that the display proposes until the human presses something else.
    proposed: ProposedPresses,
    /// Signals of the trial, as far as they take time to be read.
    signals: ReferenceSignalHistory,
}

impl ParticleSet {
    /// An empty set of beliefs, before the trial's start.
    pub fn new(kitchen: Arc<Kitchen>, model: HumanModel) -> ParticleSet {
        let shown = kitchen.empty_state();
        let prior = DirichletBelief::prior(&kitchen, &model.prior, shown);
        let (doubt, sight, presence) = (prior.clone(), LookTracker::default(), UnknownGazeTimer::new(&model));
        let (of, unseen, forgot) = (Vec::new(), None, None);
        let (proposed, signals) = (ProposedPresses::default(), ReferenceSignalHistory::default());
        ParticleSet {
            kitchen,
            model,
            prior,
            doubt,
            of,
            sight,
            presence,
            unseen,
            shown,
            forgot,
            frozen: None,
            proposed,
            signals,
        }
    }

    /// Starts the trial in `state` with `count` beliefs drawn from the prior.
    pub fn start(&mut self, now: SessionTime, state: State, count: usize, random: &mut Stream) {
        self.prior = DirichletBelief::prior(&self.kitchen, &self.model.prior, state);
        self.doubt.clone_from(&self.prior);
        self.of = (0..count).map(|_| Particle::draw(&self.kitchen, &self.prior, random)).collect();
        self.forgot = Some(now);
        self.presence.rest(now);
        self.unseen = None;
        self.proposed = ProposedPresses::default();
        self.signals = ReferenceSignalHistory::default();
        self.show(now, state);
    }

    pub fn replace(&mut self, people: Vec<Particle>) {
        (self.of, self.unseen) = (people, None);
    }

    /// Lets the human of every belief look, as the human's next press needs, in the time of unknown gaze up to `now`.
    pub fn advance(&mut self, now: SessionTime, cost: &mut CostToGo, random: &mut Stream) {
        let now = self.frozen.unwrap_or(now);
        if self.forgot.is_some() {
            let seconds = self.presence.pass(now);
            self.look_unseen(seconds, now, cost, random);
        }
    }

    fn look_unseen(&mut self, seconds: f64, until: SessionTime, cost: &mut CostToGo, random: &mut Stream) {
        if seconds <= 0.0 {
            return;
        }
        let (kitchen, model) = (&self.kitchen, &self.model);
        let looking = &model.looking;
        let rates_hz = match self.presence.display_in_view {
            _ if !looking.marginalised => [0.0; 2],
            true => [looking.other_looks_hz, looking.looks_hz],
            false => [looking.display_lost_looks_hz; 2],
        };
        let unseen =
            self.unseen.get_or_insert_with(|| LookNeedProbabilities::before(kitchen, model, &self.of, cost, random));
        unseen.look(kitchen, model, &mut self.of, self.shown, rates_hz.map(|hz| hz * seconds), random);
        if self.presence.display_in_view {
            self.signals.look_unseen(kitchen, model, &mut self.of, (seconds, until), self.shown, random);
        }
    }

    fn gaze(&mut self, sample: &GazeSample, taken: SessionTime, cost: &mut CostToGo, random: &mut Stream) {
        let perception = &self.model.perception;
        let time = self.presence.sample(sample, perception.known_share(sample.confidence), taken);
        let begin = taken - SessionTime::from_secs_f64(time.covers_s);
        self.look_unseen(time.unknown_before_s, begin, cost, random);
        let known_s = time.known * time.covers_s;
        let glances = self.sight.glances(&self.kitchen, &self.model.perception, sample, taken, known_s);
        self.of.iter_mut().for_each(|person| person.look(&glances, random));
        if time.known > 0.0 {
            let (kitchen, model, looks) = (&self.kitchen, &self.model, (sample, taken, known_s));
            self.signals.look(kitchen, model, &mut self.of, looks, self.shown, random);
            self.look_unseen((1.0 - time.known) * time.covers_s, taken, cost, random);
        }
    }

    /// Accounts for a change by others that attracts the gaze while the gaze is unknown.
    fn see_changes(&mut self, now: SessionTime, after: State, random: &mut Stream) {
        let looks = self.model.looking.marginalised && self.presence.display_in_view;
        if self.forgot.is_some() && looks {
            let seen = self.model.looking.capture * self.presence.unknown_share(now);
            looks::see_changes(&self.kitchen, &self.model, &mut self.of, [self.shown, after], seen, random);
        }
    }

    /// Updates every belief with an event. Returns for each belief the likelihood of the human's press; 1 for other
    /// events.
    pub fn experience(&mut self, observation: &Observation, cost: &mut CostToGo, random: &mut Stream) -> Vec<f64> {
        let now = self.frozen.unwrap_or(observation.time);
        match observation.what {
            ObservedEvidence::Frozen => {
                self.frozen = Some(now);
                return vec![1.0; self.of.len()];
            }
            ObservedEvidence::Thawed { by, asked, teaches } => {
                self.thaw(by, (asked, teaches), random);
                return vec![1.0; self.of.len()];
            }
            _ => {}
        }
        if let ObservedEvidence::Gaze { sample, taken } = observation.what {
            if self.forgot.is_some() {
                self.gaze(&sample, taken, cost, random);
            }
            return vec![1.0; self.of.len()];
        }
        if let ObservedEvidence::Proposed(presses) = observation.what {
            self.advance(now, cost, random);
            self.end_signal();
            self.proposed = presses;
            return vec![1.0; self.of.len()];
        }
        self.advance(now, cost, random);
        if let ObservedEvidence::DisplayInView(is_in_view) = observation.what {
            self.presence.display_in_view = is_in_view;
            return vec![1.0; self.of.len()];
        }
        self.forget(now, random);
        self.unseen = None;
        match observation.what {
            ObservedEvidence::Started { state } => self.start(now, state, self.of.len(), random),
            ObservedEvidence::Gaze { .. } | ObservedEvidence::DisplayInView(_) | ObservedEvidence::Proposed(_) => {}
            ObservedEvidence::Frozen | ObservedEvidence::Thawed { .. } => {}
            ObservedEvidence::Pressed(press) => return self.pressed(now, &press, cost, random),
            ObservedEvidence::Displayed { state } => {
                self.expect_cleared(state);
                self.see_changes(now, state, random);
                self.show(now, state);
            }
            ObservedEvidence::Told { location } => self.told(now, location, random),
            ObservedEvidence::EndedSignal => self.end_signal(),
            ObservedEvidence::Paused => self.forgot = None,
            ObservedEvidence::Resumed => {
                self.forgot = Some(now);
                self.presence.rest(now);
            }
        }
        vec![1.0; self.of.len()]
    }

    /// Takes in a press of either agent; returns the press's likelihood under each belief, 1 for presses of the robot.
    fn pressed(&mut self, now: SessionTime, press: &Press, cost: &mut CostToGo, random: &mut Stream) -> Vec<f64> {
        let weights = match press.agent {
            Agent::Human => self.human_pressed(press.button, press.effective, cost, random),
            Agent::Robot => {
                self.robot_pressed(cost, random);
                self.see_changes(now, press.after, random);
                vec![1.0; self.of.len()]
            }
        };
        self.show(now, press.after);
        weights
    }

    /// The Dirichlets that match mean and pooled second moment of the weighted beliefs.
    pub fn projected(&self, weights: &[f64]) -> DirichletBelief {
        let total: f64 = weights.iter().sum();
        let of_aspect = |index: usize| {
            let mut mean = vec![0.0; self.kitchen.aspects[index].values.len()];
            let mut second = 0.0;
            for (person, weight) in self.of.iter().zip(weights) {
                for (sum, p) in mean.iter_mut().zip(&person.of[index]) {
                    *sum += weight / total * p;
                    second += weight / total * p * p;
                }
            }
            Dirichlet::of_moments(mean, second)
        };
        DirichletBelief { aspects: (0..self.kitchen.aspects.len()).map(of_aspect).collect() }
    }

    /// Continues after a freeze probe of this duration: every stored time moves on by it, and the humans look at the
    /// locations that the probe asked about, a bit set, with the probability `teaches`.
    fn thaw(&mut self, by: SessionTime, (asked, teaches): (u32, f64), random: &mut Stream) {
        self.frozen = None;
        self.forgot = self.forgot.map(|at| at + by);
        self.presence.postpone(by);
        self.sight.postpone(by);
        self.signals.postpone(by);
        if teaches > 0.0 {
            self.unseen = None;
            looks::asked(&self.kitchen, &self.model, &mut self.of, (asked, self.shown), teaches, random);
        }
    }

    fn show(&mut self, now: SessionTime, state: State) {
        self.shown = state;
        self.sight.show(now, state);
    }

    fn human_pressed(
        &mut self,
        button: ButtonId,
        effective: bool,
        cost: &mut CostToGo,
        random: &mut Stream,
    ) -> Vec<f64> {
        let doubt: Vec<Vec<f64>> = self.doubt.aspects.iter().map(|aspect| aspect.mean().to_vec()).collect();
        let (decision, inference) = (&self.model.decision, &self.model.inference);
        let follows = self.model.signal.follows;
        // The human makes a proposed press because of the proposal, or chooses the press like any other.
        let [proposed, chosen] = match self.proposed.next() {
            None => [0.0, 1.0],
            Some(other) => [if other == button { follows } else { 0.0 }, 1.0 - follows],
        };
        self.proposed.pressed(button);
        let mut weights = Vec::with_capacity(self.of.len());
        for person in &mut self.of {
            let chances = person.press_chances(&self.kitchen, cost, decision, inference.states, random);
            weights.push(proposed + chosen * chances[button.index()]);
            person.pressed(&self.kitchen, &doubt, button, effective);
        }
        weights
    }

    fn forget(&mut self, now: SessionTime, random: &mut Stream) {
        let Some(last) = self.forgot else { return };
        self.forgot = Some(now.max(last));
        let lost = 1.0 - 0.5_f64.powf(now.secs_since(last) / self.model.transition.recipe_half_life_s);
        for person in &mut self.of {
            for (index, aspect) in self.kitchen.aspects.iter().enumerate() {
                if let AspectKind::Recipe(_) = aspect.kind {
                    person.forget(AspectId(index as u8), &self.prior.aspects[index], lost, random);
                }
            }
        }
    }

    fn robot_pressed(&mut self, cost: &mut CostToGo, random: &mut Stream) {
        let (states, foresight) = (self.model.inference.states, self.model.transition.foresight);
        for person in &mut self.of {
            if random.random::<f64>() < foresight {
                person.robot_pressed(&self.kitchen, cost, states, random);
            }
        }
    }

    /// A human who believes that an order was served expects it to disappear.
    fn expect_cleared(&mut self, state: State) {
        for &order in &self.kitchen.orders {
            let was_served = self.shown.order(order) == OrderContent::Served;
            if was_served && state.order(order) != OrderContent::Served {
                self.of.iter_mut().for_each(|person| person.expect_cleared(&self.kitchen, order));
            }
        }
    }

    fn told(&mut self, now: SessionTime, location: LocationId, random: &mut Stream) {
        let kitchen = self.kitchen.clone();
        let aspects = kitchen.aspects_at(self.shown, location);
        self.of.iter_mut().for_each(|person| person.read_signal = false);
        self.signals.show(&kitchen, &self.model, now, (location, aspects));
        if !self.model.signal.takes_time() {
            self.signals.read_at_once(&kitchen, &self.model, &mut self.of, self.shown, random);
        }
    }

    fn end_signal(&mut self) {
        self.signals.end();
        self.of.iter_mut().for_each(|person| person.read_signal = false);
    }

    /// Share of the weighted beliefs that have read the signal on the display.
    pub fn share_with_signal(&self, weights: &[f64]) -> f64 {
        let read = self.of.iter().zip(weights).filter(|(person, _)| person.read_signal);
        read.map(|(_, weight)| weight).sum::<f64>() / weights.iter().sum::<f64>()
    }
}
