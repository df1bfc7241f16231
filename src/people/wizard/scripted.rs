//! The scripted wizard in one trial: its memory, and the times of its signals.

use std::collections::VecDeque;
use std::sync::Arc;

use rand::RngExt;
use rand_distr::{Distribution, StandardNormal};
use tomcom_core::base::rng::{Stream, stream};
use tomcom_core::base::time::SessionTime;
use tomcom_core::communication;
use tomcom_core::communication::offer::UNREAD;
use tomcom_core::communication::{HighlightSet, Signal};
use tomcom_core::kitchen::cost_to_go::CostToGo;
use tomcom_core::kitchen::{Kitchen, LocationId, OrderContent, Press, State};

use super::seen::{ObservedPress, ParticipantSeenKitchen, SuspectedFalseBelief, explain, misleads};
use super::{OfferReading, WizardSpec};

const REMEMBERED_PRESSES: usize = 6;

/// An action of the scripted wizard: a signal, or taking an offer.
#[derive(Clone, Debug, PartialEq)]
pub enum WizardAction {
    Send(Signal),
    TakeOffer(u64),
}

#[derive(Clone, Debug)]
pub struct ScriptedWizard {
    kitchen: Arc<Kitchen>,
    spec: WizardSpec,
    highlights: HighlightSet,
    random: Stream,
    seen: ParticipantSeenKitchen,
    presses: VecDeque<ObservedPress>,
    /// The planned signal: the time to send it, and the suspected false belief that the signal is about.
    about_to: Option<(SessionTime, SuspectedFalseBelief)>,
    /// Locations changed by others, with the times at which the wizard checks whether the participant has seen the
    /// change.
    watched: Vec<(SessionTime, LocationId)>,
    signalled_at: Option<SessionTime>,
    /// Random stream for reading the assistant's offers; `None` if the wizard ignores offers. The stream is separate so that
    /// the wizard's own judgement is the same with and without offers.
    reading: Option<Stream>,
    /// The offer that the wizard will take: the time of the taking, and the offer's sequence number.
    takes: Option<(SessionTime, u64)>,
}

impl ScriptedWizard {
    /// Creates the scripted wizard of a trial, who reads no offers; its random stream is seeded by (seed, trial).
    pub fn new(
        kitchen: Arc<Kitchen>,
        spec: WizardSpec,
        highlights: HighlightSet,
        seed: u64,
        trial: u64,
    ) -> ScriptedWizard {
        let seen = ParticipantSeenKitchen::new(kitchen.empty_state());
        let random = stream(seed, "wizard", trial);
        ScriptedWizard {
            kitchen,
            spec,
            highlights,
            random,
            seen,
            presses: VecDeque::with_capacity(REMEMBERED_PRESSES),
            about_to: None,
            watched: Vec::new(),
            signalled_at: None,
            reading: None,
            takes: None,
        }
    }

    /// Lets the wizard read offers as the settings say, with a random stream of its own for that.
    pub fn reading_offers(self, seed: u64, trial: u64) -> ScriptedWizard {
        let reading = self.spec.offers.map(|_| stream(seed, "wizard's reading of offers", trial));
        ScriptedWizard { reading, ..self }
    }

    /// Time of the wizard's next signal or check; `None` if nothing is planned.
    pub fn next_due(&self) -> Option<SessionTime> {
        let watched = self.watched.iter().map(|(time, _)| *time);
        let (signal, offer) = (self.about_to.map(|(time, _)| time), self.takes.map(|(time, _)| time));
        watched.chain(signal).chain(offer).min()
    }

    pub fn on_trial_start(&mut self, state: State) {
        self.seen = ParticipantSeenKitchen::new(state);
        (self.about_to, self.signalled_at) = (None, None);
        self.watched.clear();
        self.presses.clear();
    }

    /// Reacts to the participant's gaze on a location, or on none, at the time `taken`. `state` is the state of the kitchen,
    /// if the location has not changed since.
    pub fn on_gaze(&mut self, taken: SessionTime, location: Option<LocationId>, state: Option<State>) {
        self.seen.gaze(taken, location, state, self.spec.look_s);
    }

    /// Reacts to a press of the participant; `is_error` says whether the press had more regret than the best press.
    pub fn on_human_press(&mut self, now: SessionTime, press: &Press, is_error: bool, cost: &mut CostToGo) {
        let &Press { button, before, after, .. } = press;
        if self.presses.len() == REMEMBERED_PRESSES {
            self.presses.pop_front();
        }
        self.presses.push_back(ObservedPress { truth: before, seen: self.seen.state, button });
        if is_error && self.about_to.is_none() && self.chance(self.spec.sees_errors) {
            let causes = explain(&self.kitchen, cost, self.presses.make_contiguous());
            if !causes.is_empty() {
                let cause = causes[self.random.random_range(0..causes.len())];
                self.think_of(now, cause, after);
            }
        }
        // The participant knows the effects of their own press.
        for location in self.kitchen.changed(before, after) {
            self.seen.told(location, after);
        }
    }

    pub fn on_change(&mut self, now: SessionTime, before: State, after: State) {
        let due = now + SessionTime::from_secs_f64(self.spec.overlooked_after_s);
        for location in self.kitchen.changed(before, after) {
            self.watched.retain(|(_, other)| *other != location);
            self.watched.push((due, location));
        }
    }

    pub fn on_signal(&mut self, now: SessionTime, location: LocationId, state: State) {
        self.seen.told(location, state);
        self.signalled_at = Some(now);
        // A planned signal is dropped if an offer has already led to the same signal.
        self.about_to.take_if(|(_, thought)| thought.location() == location);
    }

    /// Reacts to an offer that opens: decides whether the wizard will take the offer, and when. The new offer replaces
    /// the previous offer.
    pub fn on_offer(&mut self, now: SessionTime, offer: u64) {
        let (Some(OfferReading { takes, reads_s }), Some(random)) = (self.spec.offers, &mut self.reading) else {
            return;
        };
        let normal: f64 = StandardNormal.sample(random);
        let is_taken = random.random::<f64>() < takes;
        let reading = SessionTime::from_secs_f64(reads_s * (self.spec.reaction_spread * normal).exp());
        self.takes = is_taken.then(|| (now + reading.max(UNREAD), offer));
    }

    pub fn postpone(&mut self, by: SessionTime) {
        self.seen.postpone(by);
        self.about_to = self.about_to.map(|(time, thought)| (time + by, thought));
        self.watched.iter_mut().for_each(|(time, _)| *time = *time + by);
        self.signalled_at = self.signalled_at.map(|time| time + by);
        self.takes = self.takes.map(|(time, offer)| (time + by, offer));
    }

    /// Performs the wizard's action that is due: sends a signal, takes an offer, or checks whether the participant saw
    /// a change.
    pub fn act(&mut self, now: SessionTime, state: State, cost: &mut CostToGo) -> Option<WizardAction> {
        if let Some((_, thought)) = self.about_to.take_if(|(time, _)| *time <= now) {
            return self.say(now, thought, state, cost).map(WizardAction::Send);
        }
        if let Some((_, offer)) = self.takes.take_if(|(time, _)| *time <= now) {
            // The wizard waits with an offer until some time has passed since the last signal.
            self.takes = self.rested().filter(|&rested| rested > now).map(|rested| (rested, offer));
            return self.takes.is_none().then_some(WizardAction::TakeOffer(offer));
        }
        let index = self.watched.iter().position(|(time, _)| *time <= now)?;
        let (_, location) = self.watched.swap_remove(index);
        let is_overlooked = !self.seen.knows(location, state);
        if is_overlooked
            && self.about_to.is_none()
            && misleads(&self.kitchen, cost, &self.seen, state, SuspectedFalseBelief::Place(location))
            && self.chance(self.spec.sees_overlooked)
        {
            self.think_of(now, SuspectedFalseBelief::Place(location), state);
        }
        None
    }

    /// The earliest time of the wizard's next signal after the last one; `None` before the first signal.
    fn rested(&self) -> Option<SessionTime> {
        self.signalled_at.map(|last| last + SessionTime::from_secs_f64(self.spec.rest_s))
    }

    /// Plans a signal about a suspected false belief, or, with a set probability, about another aspect.
    fn think_of(&mut self, now: SessionTime, cause: SuspectedFalseBelief, state: State) {
        let thought = match self.chance(self.spec.guesses_wrong) {
            true => self.another(cause, state).unwrap_or(cause),
            false => cause,
        };
        let normal: f64 = StandardNormal.sample(&mut self.random);
        let reaction_s = self.spec.reaction_s * (self.spec.reaction_spread * normal).exp();
        self.about_to = Some((now + SessionTime::from_secs_f64(reaction_s), thought));
    }

    /// Another aspect that the participant may be wrong about: a different requested recipe, or a location that the
    /// participant has not seen since its last change.
    fn another(&mut self, cause: SuspectedFalseBelief, state: State) -> Option<SuspectedFalseBelief> {
        let suspected = cause.location();
        let could_be = |at: LocationId| match state.order(at) {
            OrderContent::Dish(_) if self.kitchen.orders.contains(&at) => true,
            _ => !self.seen.knows(at, state),
        };
        let others: Vec<LocationId> = communication::signals(&self.kitchen, self.highlights)
            .into_iter()
            .filter(|(at, signal)| {
                *at != suspected && communication::unavailable(&self.kitchen, state, signal).is_none()
            })
            .map(|(location, _)| location)
            .filter(|&location| could_be(location))
            .collect();
        match others.is_empty() {
            true => None,
            false => Some(SuspectedFalseBelief::Guess(others[self.random.random_range(0..others.len())])),
        }
    }

    /// Sends the planned signal, unless the false belief has ended, its order is gone, or the false belief would no
    /// longer mislead anybody.
    fn say(
        &mut self,
        now: SessionTime,
        thought: SuspectedFalseBelief,
        state: State,
        cost: &mut CostToGo,
    ) -> Option<Signal> {
        let holds = match thought {
            SuspectedFalseBelief::Place(location) => !self.seen.knows(location, state),
            SuspectedFalseBelief::Recipe(order, dish, _) => state.order(order) == OrderContent::Dish(dish),
            SuspectedFalseBelief::Guess(_) => true,
        };
        let matters = |cost: &mut CostToGo| match thought {
            SuspectedFalseBelief::Place(_) | SuspectedFalseBelief::Recipe(..) => {
                misleads(&self.kitchen, cost, &self.seen, state, thought)
            }
            SuspectedFalseBelief::Guess(_) => true,
        };
        if !holds || !matters(cost) {
            return None;
        }
        if let Some(rested) = self.rested().filter(|&rested| rested > now) {
            self.about_to = Some((rested, thought));
            return None;
        }
        let mut signals = communication::signals(&self.kitchen, self.highlights).into_iter();
        let (_, signal) = signals.find(|(location, _)| *location == thought.location())?;
        communication::unavailable(&self.kitchen, state, &signal).is_none().then_some(signal)
    }

    fn chance(&mut self, p: f64) -> bool {
        self.random.random::<f64>() < p
    }
}
