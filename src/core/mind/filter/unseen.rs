//! The update of the estimate by time in which the gaze is unknown: the effect of perception is averaged (marginalised)
//! over plausible looking, in closed form.
//!
//! In a time dt location i is looked at with hazard h_i = dt (l0 + (ln - l0) n_i): l0 and ln are the rates of looks at
//! a place that the next press does not need, and at one that it needs (those of the looking model); n_i is the
//! probability that the next press needs the place, computed once after each event, and only where gaze is unknown. The
//! aspect learns the displayed content, with the confusions of any reading, with probability 1 - exp(-h_i). Hazards add
//! up, so it makes no difference how a gap is divided. A press of the human draws the looks since the last event anew.

use rand::RngExt;

use super::draws::{Run, value_at};
use super::evidence::{BeliefSampler, EvidenceModel, Sample, UNDRAWN};
use crate::base::maths::ones;
use crate::base::rng::Stream;
use crate::base::time::SessionTime;
use crate::gaze::GazeSample;
use crate::kitchen::cost_to_go::{CostToGo, MAX_BUTTONS};
use crate::kitchen::state::MAX_LOCATIONS;
use crate::kitchen::{Agent, AspectId, Kitchen};
use crate::mind::dirichlet::{Dirichlet, DirichletBelief};
use crate::mind::model::HumanModel;

/// A time of unknown gaze since the last event or known gaze.
#[derive(Clone, Debug)]
pub struct UnknownGazePeriod {
    /// Beliefs about all aspects at the beginning of the unknown gaze, apart from what has been forgotten since.
    pub before: Vec<Dirichlet>,
    /// By location: expected number of looks if the next press does not need the location, and the additional number if
    /// it certainly does.
    pub hazards: Vec<[f64; 2]>,
    /// Hazard that the signal on the display was read: the expected number of its readings in the unknown gaze.
    pub signal_hazard: f64,
}

/// For each button of the human, the bit set of locations at which the human looks before the press, without the
/// human's own hand.
pub fn watched(kitchen: &Kitchen) -> Vec<u32> {
    let own_hand = kitchen.hands[Agent::Human.index()];
    let bits = |button| {
        let places = kitchen.watched(button).into_iter().filter(|&place| place != own_hand);
        places.fold(0, |bits, place| bits | 1 << place.index())
    };
    kitchen.button_ids(Agent::Human).map(bits).collect()
}

// Accounts for the time in which the gaze is known or unknown. A sample stands for the time since the previous sample, at
// most `max_sample_s`, and its confidence decides which share of that time counts as known. Time without known gaze is a
// blink up to `blink_s`: certainly without reading. After that the gaze is unknown. A blink uses up an allowance that known
// time restores, so that a stream with a few good samples among many bad ones is not mistaken for a stream with many
// blinks. At the start of a trial the allowance is zero: without a tracker all time is unknown.

/// The time that a gaze sample covers, and the gap before that time.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct GazeSampleSpan {
    /// Time of unknown gaze before the gaze sample, in seconds.
    pub unknown_before_s: f64,
    /// Time that the gaze sample covers, in seconds.
    pub covers_s: f64,
    /// Share of the covered time in which the gaze is known.
    pub known: f64,
}

/// Accounts for the time in which the gaze is known or unknown.
#[derive(Clone, Debug)]
pub struct UnknownGazeTimer {
    blink_s: f64,
    max_sample_s: f64,
    /// Session time at which the last gaze sample was taken, whether it was usable or not.
    last: Option<SessionTime>,
    /// Time of the last sample with known gaze, or start of the trial.
    dark_since: SessionTime,
    /// Remaining allowance of missing gaze that counts as a blink, in seconds.
    allowance_s: f64,
    /// Session time up to which unknown time has been accounted for.
    accounted: SessionTime,
    /// Share of the time of the last sample with known gaze that counts as unknown, 0 to 1.
    unknown: f64,
    /// Whether the tracker finds the display in its view; true until the tracker reports that it does not.
    pub display_in_view: bool,
}

impl UnknownGazeTimer {
    /// The state of the account before the start of a trial.
    pub fn new(model: &HumanModel) -> UnknownGazeTimer {
        UnknownGazeTimer {
            blink_s: model.looking.blink_s,
            max_sample_s: model.perception.max_sample_s,
            last: None,
            dark_since: SessionTime::ZERO,
            allowance_s: 0.0,
            accounted: SessionTime::ZERO,
            unknown: 1.0,
            display_in_view: true,
        }
    }

    /// Records the start of the trial or the end of a pause: time before `now` is ignored, and the next gaze sample
    /// does not cover it.
    pub fn rest(&mut self, now: SessionTime) {
        (self.last, self.dark_since) = (None, now);
    }

    /// Shifts all stored times by a duration for which the task stood still.
    pub fn postpone(&mut self, by: SessionTime) {
        self.last = self.last.map(|last| last + by);
        self.dark_since = self.dark_since + by;
        self.accounted = self.accounted + by;
    }

    fn unknown_from(&self) -> SessionTime {
        self.dark_since + SessionTime::from_secs_f64(self.allowance_s)
    }

    /// Time of unknown gaze up to `now` that has not been accounted for yet, in seconds. Afterwards that time counts as
    /// accounted for.
    pub fn pass(&mut self, now: SessionTime) -> f64 {
        let from = self.unknown_from().max(self.accounted);
        if now <= from {
            return 0.0;
        }
        self.accounted = now;
        now.secs_since(from)
    }

    /// The share of the gaze at `now` that is unknown.
    pub fn unknown_share(&self, now: SessionTime) -> f64 {
        if now > self.unknown_from() { 1.0 } else { self.unknown }
    }

    /// Accounts for a gaze sample taken at session time `taken`; the share `known` of its time counts as known gaze.
    pub fn sample(&mut self, sample: &GazeSample, known: f64, taken: SessionTime) -> GazeSampleSpan {
        let covers_s = self.last.map_or(self.max_sample_s, |last| taken.secs_since(last)).min(self.max_sample_s);
        self.last = Some(self.last.map_or(taken, |last| last.max(taken)));
        if known <= 0.0 || !(sample.x.is_finite() && sample.y.is_finite()) {
            return GazeSampleSpan { unknown_before_s: self.pass(taken), covers_s, known: 0.0 };
        }
        let begin = taken - SessionTime::from_secs_f64(covers_s);
        let unknown_before_s = self.pass(begin);
        // Unknown time that was accounted for before this sample arrived stays unknown.
        let covers_s = match self.accounted > begin {
            true => covers_s.min(taken.secs_since(self.accounted)),
            false => covers_s,
        };
        let left_s = (self.allowance_s - begin.secs_since(self.dark_since)).max(0.0);
        self.allowance_s = (left_s + known * covers_s).min(self.blink_s);
        self.dark_since = self.dark_since.max(taken);
        self.unknown = 1.0 - known;
        GazeSampleSpan { unknown_before_s, covers_s, known }
    }
}

// Looks at times of unknown gaze, drawn for each belief sample: a person then looks at what the person's next press
// needs. Therefore a press reveals where the person looked: an error is evidence of not having looked.
//
// For belief sample j the need of location i is n_ij = sum over buttons of p(a | b_j) [i is looked at before a]. The
// sample has read the location with probability 1 - exp(-h_ij), where the hazard h_ij is linear in n_ij; the sample
// then is certain of what was read.

impl BeliefSampler {
    /// The probability that the human looks at each location before the next press, averaged over belief samples.
    pub fn needs(
        &mut self,
        model: &EvidenceModel,
        cost: &mut CostToGo,
        belief: &DirichletBelief,
        random: &mut Stream,
    ) -> Vec<f64> {
        self.begin(model, belief, None, random);
        self.draw(model, cost, model.inference.beliefs, random);
        let mut sums = [0.0; MAX_LOCATIONS];
        for index in 0..self.samples.len() {
            let needs = self.needs_of(model, index);
            sums.iter_mut().zip(needs).for_each(|(sum, need)| *sum += self.priors[index] * need);
        }
        let total: f64 = self.priors.iter().sum();
        sums[..model.kitchen.locations.len()].iter().map(|sum| sum / total).collect()
    }

    /// The probability that a human with one sample's belief looks at each location before the next press.
    fn needs_of(&self, model: &EvidenceModel, sample: usize) -> [f64; MAX_LOCATIONS] {
        let mut sums = [0u32; MAX_BUTTONS];
        let mut needs = [0.0; MAX_LOCATIONS];
        let pressed = model.choice.press_probabilities(self.sum_costs(&self.samples[sample], &mut sums, model));
        for (p, &watched) in pressed.iter().zip(model.watched) {
            ones(watched).for_each(|location| needs[location] += p);
        }
        needs
    }

    /// Draws looks for the belief samples from index `from` on, and moves the samples to the worlds in which they
    /// believe after these looks.
    pub fn look(&mut self, model: &EvidenceModel, looks: &UnseenLooks, from: usize, random: &mut Stream) {
        let aspects = self.urns.len();
        for index in from..self.samples.len() {
            let begin = self.news.len();
            let needs = self.needs_of(model, index);
            let read_signal = looks.signal.as_ref().is_some_and(|signal| self.hear(signal, random));
            for (location, (&[base, extra], reading)) in looks.hazards.iter().zip(&looks.readings).enumerate() {
                let chance = -(-(base + extra * needs[location])).exp_m1();
                if self.is_read(location, chance) && !reading.is_empty() {
                    let value = value_at(reading, random.random::<f64>());
                    // What the sample has learned from the signal is certain already, so a look teaches nothing more.
                    if self.news[begin..].iter().all(|news| news.aspect != location) {
                        self.news.push(ValueSeenByLook { aspect: location, value, is_read: true });
                    }
                }
            }
            let wanted = self.news[begin..]
                .iter()
                .filter_map(|news| self.wants.get(news.aspect).map(|wants| wants[usize::from(news.value)]));
            let told = self.news[begin..].iter().fold(0, |told, news| told | 1 << news.aspect);
            let wanted = wanted.fold(0, |all, wants| all | wants) & !told;
            for aspect in ones(wanted).filter(|aspect| self.firsts[index * aspects + aspect] == UNDRAWN) {
                let value = self.urns[aspect].draw(random);
                self.news.push(ValueSeenByLook { aspect, value, is_read: false });
            }
            let news = [begin, self.news.len()];
            let changed = self.news[begin..].iter().fold(0, |changed, news| changed | 1 << news.aspect);
            self.looks.push(SampleLookEffects { changed, news, read_signal });
            if changed != 0 {
                self.believe_news(model.kitchen, index, news, model.inference.states);
            }
        }
    }

    /// Whether the next belief sample has read a location, or the signal, that is read with this probability.
    /// Systematic sampling: over all samples the number of readings differs from its expectation by less than 1.
    fn is_read(&mut self, what: usize, chance: f64) -> bool {
        let before = self.read_sums[what];
        self.read_sums[what] += chance;
        self.read_sums[what].floor() > before.floor()
    }

    /// Lets the next belief sample read the signal on the display, or miss it; returns whether the sample has read it.
    fn hear(&mut self, signal: &PossiblyReadSignal, random: &mut Stream) -> bool {
        let is_read = self.is_read(self.read_sums.len() - 1, signal.chance);
        for (aspect, reading) in signal.readings.iter().filter(|_| is_read) {
            self.news.push(ValueSeenByLook {
                aspect: *aspect,
                value: value_at(reading, random.random::<f64>()),
                is_read,
            });
        }
        is_read
    }

    /// Posterior probability that the signal on the display was read in the unknown time.
    pub fn signal_read(&self) -> f64 {
        let read = self.posteriors.iter().zip(&self.looks).filter(|(_, looks)| looks.read_signal);
        read.map(|(weight, _)| weight).sum::<f64>() / self.posteriors.iter().sum::<f64>()
    }

    /// Replaces the worlds of a belief sample by worlds with the values that the sample has learned from looks.
    fn believe_news(&mut self, kitchen: &Kitchen, index: usize, news: [usize; 2], states: usize) {
        let Sample { runs: [first, last], .. } = self.samples[index];
        for run in first..last {
            let Run { first, draws, .. } = self.runs[run];
            let mut world = self.world_of(kitchen, index, first as usize, states);
            for &ValueSeenByLook { aspect, value, .. } in &self.news[news[0]..news[1]] {
                world.set_value(kitchen, AspectId(aspect as u8), usize::from(value));
            }
            self.runs[run].world = self.worlds.count(world, draws);
        }
    }

    /// What a belief sample has learned from looks; nothing if no looks were drawn.
    pub fn news_of(&self, sample: usize) -> (u32, &[ValueSeenByLook]) {
        let looks = self.looks.get(sample).copied().unwrap_or_default();
        (looks.changed, &self.news[looks.news[0]..looks.news[1]])
    }
}

/// Expected looks at each location at times of unknown gaze since the last event, depending on how much the next press
/// needs the location, and what a look reads there.
#[derive(Clone, Debug)]
pub struct UnseenLooks<'a> {
    /// By location: expected number of looks if the next press does not need the location, and the additional number if
    /// it certainly does.
    pub hazards: &'a [[f64; 2]],
    /// By location, the distribution of the value that a look reads; empty where nothing can be read.
    pub readings: Vec<&'a [f64]>,
    /// The signal on the display, if it may have been read unseen by the tracker.
    pub signal: Option<PossiblyReadSignal>,
}

/// A signal that the participant may have read while the gaze was unknown.
#[derive(Clone, Debug)]
pub struct PossiblyReadSignal {
    /// Probability that the signal was read.
    pub chance: f64,
    /// Index of each state aspect that the signal tells, with the distribution of the value that it is taken for.
    pub readings: Vec<(usize, Vec<f64>)>,
}

/// What a belief sample has learned from looks at times of unknown gaze.
#[derive(Clone, Copy, Debug, Default)]
pub struct SampleLookEffects {
    /// Bit set of the state aspects whose value differs from the sample's draws.
    pub changed: u32,
    /// Range of the sample's entries in `BeliefSampler::news`.
    pub news: [usize; 2],
    /// Whether the belief sample has read the signal on the display.
    pub read_signal: bool,
}

/// A value that a belief sample believes since a look at a time of unknown gaze.
#[derive(Clone, Copy, Debug)]
pub struct ValueSeenByLook {
    /// Index of the state aspect to which the value belongs.
    pub aspect: usize,
    /// Index of the value among the aspect's possible values.
    pub value: u8,
    /// Whether the value was read, and is certain; else the value is a draw of a recipe on which the decision depends
    /// since an order was read.
    pub is_read: bool,
}
