//! Looks at times of unknown gaze, drawn for each belief sample: a person then looks at what the person's next press
//! needs. Therefore a press reveals where the person looked: an error is evidence of not having looked.
//!
//! For belief sample j the need of location i is n_ij = sum over buttons of p(a | b_j) [i is looked at before a]. The
//! sample has read the location with probability 1 - exp(-h_ij), where the hazard h_ij is linear in n_ij; the sample
//! then is certain of what was read.

use crate::base::bits::ones;
use crate::base::rng::Stream;
use crate::kitchen::cost_to_go::{CostToGo, MAX_BUTTONS};
use crate::kitchen::state::MAX_LOCATIONS;
use crate::kitchen::{AspectId, Kitchen};
use crate::mind::dirichlet::DirichletBelief;
use rand::RngExt;

use super::distinct_draws::Run;
use super::evidence::{BeliefSampler, EvidenceModel, Sample, UNDRAWN};
use super::look_news::{PossiblyReadSignal, SampleLookEffects, UnseenLooks, ValueSeenByLook};
use super::urn::value_at;

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
