//! Inference of the human's belief, event by event: a product of Dirichlets over the state aspects (paper, section
//! "Inference of the human belief").
//!
//! Closed forms are used for reading, unknown gaze, forgetting, signals, and the human's presses that involve one
//! location. Samples are used for the likelihood of a press, for the human's presses that involve several locations,
//! and for presses of the robot.

pub mod draws;
mod evidence;
mod own_press;
mod perception;
mod robot_press;
pub mod signals;
pub mod unseen;

use std::sync::Arc;

use self::evidence::{BeliefSampler, EvidenceModel, ProposalMixture};
use self::own_press::{ExchangeUpdate, ServingUpdate};
use self::perception::GazeBeliefUpdate;
use self::signals::SignalReadingHistory;
use self::unseen::{UnknownGazePeriod, UnknownGazeTimer, UnseenLooks};
use super::choice::ChoiceModel;
use super::dirichlet::DirichletBelief;
use super::model::{HumanModel, LookingModel};
use super::observation::{Observation, ObservedEvidence, ProposedPresses};
use crate::base::rng::{Stream, stream};
use crate::base::time::SessionTime;
use crate::gaze::GazeSample;
use crate::kitchen::cost_to_go::CostToGo;
use crate::kitchen::{Agent, AspectKind, ButtonAction, ButtonId, Kitchen, LocationId, OrderContent, State};
pub use evidence::PressEvidence;

/// How the human's press of a button changes the belief: the press involves one location, or several that jointly
/// determine its effect.
#[derive(Clone, Debug)]
enum Lesson {
    Alone,
    Exchange(ExchangeUpdate),
    Serving(ServingUpdate),
}

/// The recursive estimator of the human's belief.
#[derive(Clone, Debug)]
pub struct BeliefFilter {
    kitchen: Arc<Kitchen>,
    model: HumanModel,
    seed: u64,
    belief: DirichletBelief,
    /// The estimate at the start of the trial, to which beliefs about recipes decay.
    prior: DirichletBelief,
    reader: GazeBeliefUpdate,
    presence: UnknownGazeTimer,
    /// The probability that the next press needs each location, once it has been computed after the last event.
    needs: Option<Vec<f64>>,
    /// Time of unknown gaze since the last event or known gaze, if there was any.
    stretch: Option<UnknownGazePeriod>,
    /// For each button of the human, the bit set of locations at which the human looks before the press.
    watched: Vec<u32>,
    choice: ChoiceModel,
    /// How a press of each button of the human changes the belief, by [`ButtonId`].
    lessons: Vec<Lesson>,
    sampler: BeliefSampler,
    shown: State,
    /// Number of presses of both agents so far. The number seeds the random stream of an update, so that other events
    /// in a log do not change the estimate.
    presses: u64,
    /// Time up to which forgetting of recipes has been applied; `None` while the trial is paused.
    forgot: Option<SessionTime>,
    /// Time at which the task was frozen for a probe, as long as it stands still.
    frozen: Option<SessionTime>,
    /// The presses that the display proposes until the human presses something else.
    proposed: ProposedPresses,
    signals: SignalReadingHistory,
    evidence: Option<PressEvidence>,
}

impl BeliefFilter {
    /// A filter with the estimate before the trial's start.
    pub fn new(kitchen: Arc<Kitchen>, model: HumanModel, seed: u64) -> BeliefFilter {
        let shown = kitchen.empty_state();
        let prior = DirichletBelief::prior(&kitchen, &model.prior, shown);
        let lesson = |action: ButtonAction| match action {
            ButtonAction::Use(location) => Lesson::Exchange(ExchangeUpdate::new(&kitchen, location)),
            ButtonAction::Serve(order) => Lesson::Serving(ServingUpdate::new(&kitchen, order)),
            ButtonAction::Take(_) | ButtonAction::Process(_) | ButtonAction::Trash => Lesson::Alone,
        };
        let lessons = kitchen.buttons[Agent::Human.index()].iter().map(|button| lesson(button.action)).collect();
        BeliefFilter {
            reader: GazeBeliefUpdate::new(&kitchen, &model.perception),
            presence: UnknownGazeTimer::new(&model),
            needs: None,
            stretch: None,
            watched: unseen::watched(&kitchen),
            choice: ChoiceModel::for_draws(&kitchen, &model.decision, model.inference.states),
            belief: prior.clone(),
            prior,
            sampler: BeliefSampler::new(&kitchen),
            forgot: None,
            frozen: None,
            proposed: ProposedPresses::default(),
            signals: SignalReadingHistory::default(),
            evidence: None,
            kitchen,
            model,
            seed,
            lessons,
            shown,
            presses: 0,
        }
    }

    /// The present estimate of the human's belief.
    pub fn belief(&self) -> &DirichletBelief {
        &self.belief
    }

    /// Likelihood and effective sample size of the human's last press.
    pub fn evidence(&self) -> Option<PressEvidence> {
        self.evidence
    }

    /// Updates the estimate with one observation. The random stream depends on the seed and the number of presses only.
    pub fn observe(&mut self, observation: &Observation, cost: &mut CostToGo) {
        let now = self.frozen.unwrap_or(observation.time);
        match observation.what {
            ObservedEvidence::Frozen => return self.frozen = Some(now),
            ObservedEvidence::Thawed { by, asked, teaches } => return self.thaw(by, asked, teaches),
            ObservedEvidence::Proposed(presses) => {
                self.replace_signal(now, cost);
                return self.proposed = presses;
            }
            _ => {}
        }
        if let ObservedEvidence::Gaze { sample, taken } = observation.what {
            if self.forgot.is_some() {
                self.take_sample(&sample, taken, cost);
            }
            return;
        }
        self.advance(now, cost);
        if let ObservedEvidence::DisplayInView(is_in_view) = observation.what {
            self.presence.display_in_view = is_in_view;
            return;
        }
        self.forget(now);
        self.reader.settle();
        self.update(now, &observation.what, cost);
        (self.needs, self.stretch) = (None, None);
    }

    fn update(&mut self, now: SessionTime, what: &ObservedEvidence, cost: &mut CostToGo) {
        match *what {
            ObservedEvidence::Started { state } => {
                self.belief = DirichletBelief::prior(&self.kitchen, &self.model.prior, state);
                self.prior.clone_from(&self.belief);
                self.proposed = ProposedPresses::default();
                self.signals = SignalReadingHistory::default();
                self.forgot = Some(now);
                self.presence.rest(now);
                self.show(now, state);
            }
            ObservedEvidence::Gaze { .. } | ObservedEvidence::DisplayInView(_) => {}
            ObservedEvidence::Frozen | ObservedEvidence::Thawed { .. } | ObservedEvidence::Proposed(_) => {}
            ObservedEvidence::Pressed(press) => {
                self.presses += 1;
                let mut random = stream(self.seed, "belief", self.presses);
                match press.agent {
                    Agent::Human => self.human_pressed(press.button, press.effective, cost, &mut random),
                    Agent::Robot => {
                        let (draws, foresight) = (self.model.inference.predictions, self.model.transition.foresight);
                        robot_press::predict(&self.kitchen, cost, &mut self.belief, draws, foresight, &mut random);
                        self.see_changes(now, press.after);
                    }
                }
                self.show(now, press.after);
            }
            ObservedEvidence::Displayed { state } => {
                self.expect_cleared(state);
                self.see_changes(now, state);
                self.show(now, state);
            }
            ObservedEvidence::Told { location } => self.told(now, location),
            ObservedEvidence::EndedSignal => self.signals.end(),
            ObservedEvidence::Paused => self.forgot = None,
            ObservedEvidence::Resumed => {
                self.forgot = Some(now);
                self.presence.rest(now);
            }
        }
    }

    /// Accounts for unknown gaze up to `now`, which the estimate before a press includes; [`BeliefFilter::observe`]
    /// does the same first, so a call of this function changes no later estimate.
    pub fn advance(&mut self, now: SessionTime, cost: &mut CostToGo) {
        let now = self.frozen.unwrap_or(now);
        if self.forgot.is_some() {
            let unknown_s = self.presence.pass(now);
            self.pass_unknown(unknown_s, now, cost);
        }
    }

    /// The estimate at `now`, including unknown gaze and forgetting since the last event. The call changes no later
    /// estimate.
    pub fn at(&self, now: SessionTime, cost: &mut CostToGo) -> DirichletBelief {
        let mut filter = self.clone();
        let now = filter.frozen.unwrap_or(now);
        filter.advance(now, cost);
        filter.forget(now);
        filter.belief
    }

    /// Lets beliefs about recipes decay to the prior: the number of people decays who have not forgotten a recipe.
    fn forget(&mut self, now: SessionTime) {
        let Some(last) = self.forgot else { return };
        self.forgot = Some(now.max(last));
        let lost = 1.0 - 0.5_f64.powf(now.secs_since(last) / self.model.transition.recipe_half_life_s);
        for index in 0..self.kitchen.aspects.len() {
            let AspectKind::Recipe(_) = self.kitchen.aspects[index].kind else { continue };
            let before = self.stretch.as_mut().map(|stretch| &mut stretch.before[index]);
            for belief in std::iter::once(&mut self.belief.aspects[index]).chain(before) {
                belief.mix(lost, &self.prior.aspects[index]);
            }
        }
    }

    /// Continues after a freeze probe of this duration: all times are shifted, so that the estimate is as if the task
    /// had not stood still, except for looks at locations that the probe's questions were about.
    fn thaw(&mut self, by: SessionTime, asked: u32, teaches: f64) {
        self.frozen = None;
        self.forgot = self.forgot.map(|at| at + by);
        self.presence.postpone(by);
        self.reader.postpone(by);
        self.signals.postpone(by);
        if teaches <= 0.0 {
            return;
        }
        self.reader.settle();
        (self.needs, self.stretch) = (None, None);
        for index in (0..self.kitchen.locations.len()).filter(|index| asked & 1 << index != 0) {
            let reading = self.reader.reading(&self.kitchen, LocationId(index as u8), self.shown);
            if !reading.is_empty() {
                self.belief.aspects[index].learn(teaches, reading.iter().copied());
            }
        }
    }

    fn take_sample(&mut self, sample: &GazeSample, taken: SessionTime, cost: &mut CostToGo) {
        let known = self.model.perception.known_share(sample.confidence);
        let time = self.presence.sample(sample, known, taken);
        self.pass_unknown(time.unknown_before_s, taken - SessionTime::from_secs_f64(time.covers_s), cost);
        if time.known > 0.0 {
            self.stretch = None;
            let known_s = time.known * time.covers_s;
            self.reader.read(&self.kitchen, &self.model.perception, &mut self.belief, sample, taken, known_s);
            self.read_signal_by_gaze(sample, taken, known_s);
            self.pass_unknown((1.0 - time.known) * time.covers_s, taken, cost);
        }
    }

    /// Marginalises over looks in `seconds` of unknown gaze that end at `until`.
    fn pass_unknown(&mut self, seconds: f64, until: SessionTime, cost: &mut CostToGo) {
        let is_pertinent = self.model.looking.marginalised || self.model.signal.takes_time();
        if seconds <= 0.0 || !is_pertinent {
            return;
        }
        let LookingModel { marginalised, looks_hz, other_looks_hz, display_lost_looks_hz, .. } = self.model.looking;
        let [base, extra] = match self.presence.display_in_view {
            _ if !marginalised => [0.0; 2],
            true => [other_looks_hz, looks_hz - other_looks_hz].map(|hz| hz * seconds),
            false => [display_lost_looks_hz * seconds, 0.0],
        };
        let locations = self.kitchen.locations.len();
        if self.needs.is_none() {
            self.needs = Some(self.needs_now(cost));
        }
        let needs = self.needs.as_deref().unwrap_or_default();
        let stretch = self.stretch.get_or_insert_with(|| UnknownGazePeriod {
            before: self.belief.aspects.clone(),
            hazards: vec![[0.0; 2]; locations],
            signal_hazard: 0.0,
        });
        self.reader.settle();
        for (index, need) in needs.iter().enumerate() {
            stretch.hazards[index][0] += base;
            stretch.hazards[index][1] += extra;
            let reading = self.reader.reading(&self.kitchen, LocationId(index as u8), self.shown);
            let looked = -(-(base + extra * need)).exp_m1();
            if looked > 0.0 && !reading.is_empty() {
                self.belief.aspects[index].learn(looked, reading.iter().copied());
            }
        }
        let hazard = self.read_signal_unseen(seconds, until);
        if let Some(stretch) = &mut self.stretch {
            stretch.signal_hazard += hazard;
        }
    }

    /// The probability that the next press needs each location, under the present estimate.
    fn needs_now(&mut self, cost: &mut CostToGo) -> Vec<f64> {
        let mut random = stream(self.seed, "needs", self.presses);
        let (kitchen, choice, watched) = (&*self.kitchen, &self.choice, &self.watched[..]);
        let model = EvidenceModel { kitchen, choice, inference: &self.model.inference, watched };
        self.sampler.needs(&model, cost, &self.belief, &mut random)
    }

    /// Accounts for changes by others that attract the human's gaze while the gaze is unknown.
    fn see_changes(&mut self, now: SessionTime, after: State) {
        let unknown = if self.forgot.is_some() { self.presence.unknown_share(now) } else { 0.0 };
        let seen = self.model.looking.capture * unknown;
        if !self.model.looking.marginalised || seen <= 0.0 || !self.presence.display_in_view {
            return;
        }
        for location in self.kitchen.changed(self.shown, after) {
            let reading = self.reader.reading(&self.kitchen, location, after);
            if !reading.is_empty() {
                self.belief.aspects[location.index()].learn(seen, reading.iter().copied());
            }
        }
    }

    /// Updates the estimate by the likelihood of a press, with the possible looks at unknown gaze before the press.
    fn weigh_press(&mut self, press: ProposalMixture, cost: &mut CostToGo, random: &mut Stream) -> PressEvidence {
        let stretch = self.stretch.take();
        let signal = stretch.as_ref().and_then(|stretch| self.unseen_signal(stretch.signal_hazard));
        let has_signal = signal.is_some();
        let looks = stretch.as_ref().map(|stretch| {
            let reading = |index| self.reader.reading(&self.kitchen, LocationId(index as u8), self.shown);
            let readings = (0..stretch.hazards.len()).map(reading).collect();
            UnseenLooks { hazards: &stretch.hazards, readings, signal }
        });
        if let Some(stretch) = &stretch {
            self.belief.aspects.clone_from_slice(&stretch.before);
        }
        let (kitchen, choice, watched) = (&*self.kitchen, &self.choice, &self.watched[..]);
        let model = EvidenceModel { kitchen, choice, inference: &self.model.inference, watched };
        let evidence = self.sampler.weigh(&model, cost, &mut self.belief, press, looks.as_ref(), random);
        if let Some(UnknownGazePeriod { signal_hazard, .. }) = stretch.filter(|_| has_signal) {
            self.correct_reading(signal_hazard, self.sampler.signal_read());
        }
        evidence
    }

    fn show(&mut self, now: SessionTime, state: State) {
        self.shown = state;
        self.reader.show(now, state, self.model.perception.history_s);
    }

    fn human_pressed(&mut self, button: ButtonId, effective: bool, cost: &mut CostToGo, random: &mut Stream) {
        let press = ProposalMixture::new(button, self.proposed.next(), self.model.signal.follows);
        self.proposed.pressed(button);
        self.evidence = Some(self.weigh_press(press, cost, random));
        let draws = self.model.inference.beliefs;
        match &self.lessons[button.index()] {
            Lesson::Alone => {
                let action = self.kitchen.button(Agent::Human, button).action;
                own_press::learn_alone(&self.kitchen, &mut self.belief, action, effective);
            }
            Lesson::Exchange(exchange) => exchange.learn(&mut self.belief, effective, draws, random),
            Lesson::Serving(serving) => serving.learn(&mut self.belief, effective, draws, random),
        }
    }

    /// Handles orders whose display changes from "served" to "none": a human who believes "served" expects this change.
    fn expect_cleared(&mut self, state: State) {
        for &order in &self.kitchen.orders {
            if self.shown.order(order) != OrderContent::Served || state.order(order) == OrderContent::Served {
                continue;
            }
            let aspect = &self.kitchen.aspects[order.index()];
            let [served, none] = [OrderContent::Served, OrderContent::None].map(|what| aspect.index_of(what.code()));
            if let (Some(served), Some(none)) = (served, none) {
                self.belief.aspects[order.index()].shift(served, none);
            }
        }
    }
}
