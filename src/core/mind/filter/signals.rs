//! The signals of a trial as the estimate follows them: the signal on the display, and the last one before it.

use super::BeliefFilter;
use super::perception::NEGLIGIBLE;
use super::unseen::PossiblyReadSignal;
use crate::base::time::SessionTime;
use crate::gaze::GazeSample;
use crate::kitchen::cost_to_go::CostToGo;
use crate::kitchen::{AspectId, Kitchen, LocationId, LocationKind, State};
use crate::mind::dirichlet::DirichletBelief;
use crate::mind::model::{HumanModel, SignalModel, SignalReadingForecast};

/// A signal on the display.
#[derive(Clone, Debug)]
pub struct SignalOnDisplay {
    /// The location that the signal is about.
    pub location: LocationId,
    /// The state aspects of which the human becomes certain by reading the signal.
    pub aspects: Vec<AspectId>,
    /// Session time at which the signal was shown.
    pub since: SessionTime,
    /// Probability that the participant notices the signal.
    pub noticed: f64,
    /// Probability that the signal has not been read yet.
    pub unread: f64,
}

impl SignalOnDisplay {
    /// Makes the estimate certain of the signal's aspects with the probability `share`.
    pub fn teach(
        &self,
        kitchen: &Kitchen,
        shown: State,
        model: &SignalModel,
        share: f64,
        belief: &mut DirichletBelief,
    ) {
        for &aspect in &self.aspects {
            let of_aspect = &mut belief.aspects[aspect.index()];
            let values = of_aspect.mean().len();
            of_aspect.learn(share, model.understood(kitchen.true_value(shown, aspect), values));
        }
    }
}

/// A signal that has left the display.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EndedSignal {
    /// The location that the signal was about.
    pub location: LocationId,
    /// Probability that the signal was read before it left the display.
    pub read: f64,
}

/// The signals of a trial, as far as they take time to be read.
#[derive(Clone, Debug, Default)]
pub struct SignalReadingHistory {
    /// The signal that is on the display now.
    pub standing: Option<SignalOnDisplay>,
    /// The last signal that has left the display, until the belief filter's function `take_signal_over` takes it.
    pub over: Option<EndedSignal>,
}

impl SignalReadingHistory {
    /// Moves the signal's times on by a duration for which the task stood still.
    pub fn postpone(&mut self, by: SessionTime) {
        self.standing.iter_mut().for_each(|standing| standing.since = standing.since + by);
    }

    /// The signal on the display leaves the display.
    pub fn end(&mut self) {
        if let Some(SignalOnDisplay { location, unread, .. }) = self.standing.take() {
            self.over = Some(EndedSignal { location, read: 1.0 - unread });
        }
    }
}

// The signal on the display: whether the participant has read it is a part of the estimate. While the gaze is known, the
// signal is read as a location is: at a rate that falls with the distance of the gaze from the signal's place. While the
// gaze is unknown, the signal draws the eye with a hazard that over all time gives the probability that it is noticed. So a
// gaze that is known to be elsewhere for all of the signal's time is evidence that the signal was missed. Reading the signal
// makes its aspects certain; reading it once more changes nothing. A press of the human draws the readings in the unknown
// time since the last event anew (see `unseen`).

impl BeliefFilter {
    /// The signal that has left the display since the last call of this function; `None` if none has.
    pub fn take_signal_over(&mut self) -> Option<EndedSignal> {
        self.signals.over.take()
    }

    /// The forecast of how a signal that is shown now will be read.
    pub fn forecast(&self) -> SignalReadingForecast {
        let model = &self.model.signal;
        if !model.takes_time() {
            return SignalReadingForecast::default();
        }
        let understood = |kind| (1.0 - model.misread) * model.noticed_at(kind);
        let (recipe, highlight) = (understood(LocationKind::Order), understood(LocationKind::Place));
        SignalReadingForecast { recipe, highlight, delay_s: model.delay_s }
    }

    /// The estimate at `now` in which the signal on the display has been read as far as is to be expected: the same
    /// advice must not be given twice because the first signal has not been read yet. `is_current`: no time has passed
    /// since the last observation.
    pub fn foreseen(&self, now: SessionTime, is_current: bool, cost: &mut CostToGo) -> DirichletBelief {
        let mut belief = if is_current { self.belief.clone() } else { self.at(now, cost) };
        if let Some(standing) = &self.signals.standing {
            let passed_s = now.secs_since(standing.since);
            let hazard = self.model.signal.reading_hazard(standing.noticed, passed_s, f64::INFINITY);
            standing.teach(&self.kitchen, self.shown, &self.model.signal, -(-hazard).exp_m1(), &mut belief);
        }
        belief
    }

    /// A signal is shown. Where signals take no time to be read, the estimate becomes certain of the signal's aspects
    /// with the probability that the signal is noticed.
    pub(super) fn told(&mut self, now: SessionTime, location: LocationId) {
        let aspects = self.kitchen.aspects_at(self.shown, location);
        self.signals.end();
        let noticed = self.model.signal.noticed_at(self.kitchen.location(location).kind);
        let standing = SignalOnDisplay { location, aspects, since: now, noticed, unread: 1.0 };
        if self.model.signal.takes_time() {
            self.signals.standing = Some(standing);
            return;
        }
        standing.teach(&self.kitchen, self.shown, &self.model.signal, noticed, &mut self.belief);
    }

    /// Proposed presses replace the signal on the display.
    pub(super) fn replace_signal(&mut self, now: SessionTime, cost: &mut CostToGo) {
        if self.signals.standing.is_some() {
            self.advance(now, cost);
            self.stretch = None;
            self.signals.end();
        }
    }

    fn read_signal(&mut self, chance: f64) {
        if let Some(standing) = &mut self.signals.standing {
            standing.unread *= 1.0 - chance;
            standing.teach(&self.kitchen, self.shown, &self.model.signal, chance, &mut self.belief);
        }
    }

    /// Lets the signal on the display be read in a gaze sample whose gaze is known for `known_s` seconds.
    pub(super) fn read_signal_by_gaze(&mut self, sample: &GazeSample, taken: SessionTime, known_s: f64) {
        let Some(standing) = &self.signals.standing else { return };
        let HumanModel { perception, signal, .. } = &self.model;
        if !sample.is_on_display() || taken < standing.since {
            return;
        }
        let area = self.kitchen.location(standing.location).display;
        let distance_m = area.distance_m([sample.x, sample.y], self.kitchen.display_m);
        let rate_hz = perception.rate_of(signal.reading_rate_hz).at(distance_m, sample.confidence.min(1.0));
        let chance = -(-rate_hz * known_s).exp_m1();
        if chance >= NEGLIGIBLE {
            self.reader.settle();
            self.read_signal(chance);
        }
    }

    /// The signal on the display may draw the eye in `seconds` of unknown gaze that end at `until`. Returns the hazard
    /// of being read in that time.
    pub(super) fn read_signal_unseen(&mut self, seconds: f64, until: SessionTime) -> f64 {
        let Some(standing) = self.signals.standing.as_ref().filter(|_| self.presence.display_in_view) else {
            return 0.0;
        };
        let until_s = until.secs_since(standing.since);
        let hazard = self.model.signal.reading_hazard(standing.noticed, until_s - seconds, until_s);
        if hazard > 0.0 {
            self.read_signal(-(-hazard).exp_m1());
        }
        hazard
    }

    /// The signal on the display as a belief sample may have read it in unknown time with this hazard.
    pub(super) fn unseen_signal(&self, hazard: f64) -> Option<PossiblyReadSignal> {
        let standing = self.signals.standing.as_ref().filter(|_| hazard > 0.0)?;
        let reading = |aspect: &AspectId| {
            let values = self.kitchen.aspects[aspect.index()].values.len();
            let truth = self.kitchen.true_value(self.shown, *aspect);
            (aspect.index(), self.model.signal.understood(truth, values).collect())
        };
        let readings = standing.aspects.iter().map(reading).collect();
        Some(PossiblyReadSignal { chance: -(-hazard).exp_m1(), readings })
    }

    /// Corrects the probability that the signal on the display was read in unknown time with this hazard: `read` is the
    /// probability of reading after a press as evidence.
    pub(super) fn correct_reading(&mut self, hazard: f64, read: f64) {
        if let Some(standing) = &mut self.signals.standing {
            standing.unread *= hazard.exp() * (1.0 - read);
        }
    }
}
