//! The evidence of a press: beliefs under which it was likely gain weight.
//!
//! p(a | b) is a softmax over expected costs to go, and so has no closed form. Belief samples stand for it, each by the
//! states and recipes that are drawn from it (see [`super::urn`]). The posterior of an aspect is the mixture of
//! Dir(alpha + n_j) with the weights w_j, collapsed by its mean and second moment. What equal weights would give is
//! subtracted and the prior's exact moments are added (a control variate), so that a press without information changes
//! nothing.

use crate::base::bits::ones;
use crate::base::rng::Stream;
use crate::kitchen::cost_to_go::{CostToGo, MAX_BUTTONS};
use crate::kitchen::{Agent, AspectId, AspectKind, ButtonId, Kitchen, LocationId, OrderContent, World};
use crate::mind::choice::ChoiceModel;
use crate::mind::dirichlet::{Dirichlet, DirichletBelief};
use crate::mind::model::InferenceModel;

use super::distinct::DistinctWorlds;
use super::urn::Urn;

/// This share of the first draws of a recipe is spread evenly over its variants: false recipes show in presses alone, and
/// a few samples of them would leave it to chance whether they do.
const SPREAD: f64 = 0.4;
/// What is not drawn, since nothing depends on it.
const UNDRAWN: u8 = u8::MAX;

/// How well a press could be explained.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Evidence {
    /// ln p(a) under the estimate before the press, in nats.
    pub log_p: f64,
    /// Belief samples that were drawn.
    pub beliefs: usize,
    /// 1 / sum of the squared weights.
    pub effective: f64,
}

/// Room for the samples, kept from press to press.
#[derive(Clone, Debug, Default)]
pub struct Sampler {
    urns: Vec<Urn>,
    /// `[order][value]`: the recipes that count, one bit each by aspect.
    wants: Vec<Vec<u32>>,
    /// `[aspect * new samples + sample]`: the first draws of the samples that are drawn at once.
    proposed: Vec<u8>,
    /// `[sample * aspects + aspect]`: the values of the first draws.
    firsts: Vec<u8>,
    /// All draws of the aspects of which a sample has several values, one row of `states` after another.
    rows: Vec<u8>,
    samples: Vec<Sample>,
    /// By aspect and value, how much a first draw counts; nothing where they come from the mean.
    counts: Vec<Vec<f64>>,
    /// How much each belief sample counts, before its likelihood p(a | belief) and with it.
    priors: Vec<f64>,
    posteriors: Vec<f64>,
    worlds: DistinctWorlds,
    /// The different worlds among the draws of all belief samples, one sample after another.
    runs: Vec<Run>,
    /// The different draws of one belief sample.
    alike: Vec<Alike>,
    /// By draw, its values of the mixed aspects.
    keys: Vec<Key>,
    /// By world, the weight of its draws after the press.
    world_weights: Vec<f64>,
}

/// A belief sample.
#[derive(Clone, Copy, Debug)]
struct Sample {
    /// Aspects of which it has several values, one bit each.
    mixed: u32,
    /// Where their rows begin.
    rows: usize,
    /// Where its runs begin and end.
    runs: [usize; 2],
}

impl Sample {
    /// Where the row of a mixed aspect begins.
    #[inline]
    fn row(&self, aspect: usize, states: usize) -> usize {
        self.rows + (self.mixed & ((1 << aspect) - 1)).count_ones() as usize * states
    }
}

/// Draws of one belief sample that are the same world: the first of them, and how many there are.
#[derive(Clone, Copy, Debug)]
struct Run {
    world: u32,
    first: u32,
    draws: u32,
}

/// The values of up to 32 aspects, one byte each.
type Key = [u64; 4];
/// So many of them fit into one number.
const KEY_PART: usize = (u64::BITS / u8::BITS) as usize;

/// Draws of one belief sample that are alike: their values, the first of them, and how many there are.
#[derive(Clone, Copy, Debug)]
struct Alike {
    key: Key,
    first: usize,
    draws: u32,
}

/// The models by which a press is weighed.
pub struct EvidenceModel<'a> {
    pub kitchen: &'a Kitchen,
    pub choice: &'a ChoiceModel,
    pub inference: &'a InferenceModel,
}

impl Sampler {
    pub fn new(kitchen: &Kitchen) -> Sampler {
        Sampler { wants: kitchen.orders.iter().map(|&order| wants(kitchen, order)).collect(), ..Sampler::default() }
    }

    /// Updates the belief by the evidence of a press of the human.
    pub fn weigh(
        &mut self,
        model: &EvidenceModel,
        cost: &mut CostToGo,
        belief: &mut DirichletBelief,
        button: ButtonId,
        random: &mut Stream,
    ) -> Evidence {
        let states = model.inference.states;
        self.urns.resize(belief.aspects.len(), Urn::default());
        self.counts.clear();
        for ((urn, dirichlet), aspect) in self.urns.iter_mut().zip(&belief.aspects).zip(&model.kitchen.aspects) {
            urn.fill(dirichlet, states, random);
            let is_recipe = matches!(aspect.kind, AspectKind::Recipe(_));
            self.counts.push(if is_recipe { urn.spread(SPREAD) } else { Vec::new() });
        }
        let mut wanted = model.inference.beliefs;
        self.firsts.clear();
        self.rows.clear();
        self.samples.clear();
        self.runs.clear();
        self.priors.clear();
        self.posteriors.clear();
        self.worlds.clear(states * wanted.max(model.inference.max_beliefs));
        loop {
            self.draw(model, cost, button, wanted, random);
            let evidence = self.evidence();
            let can_double = wanted * 2 <= model.inference.max_beliefs;
            if evidence.effective >= model.inference.min_effective || !can_double {
                self.collapse(belief, states);
                return evidence;
            }
            wanted *= 2;
        }
    }

    /// Draws belief samples until there are so many.
    fn draw(
        &mut self,
        model: &EvidenceModel,
        cost: &mut CostToGo,
        button: ButtonId,
        wanted: usize,
        random: &mut Stream,
    ) {
        let (kitchen, states) = (model.kitchen, model.inference.states);
        let (aspects, old) = (self.urns.len(), self.samples.len());
        let new = wanted - old;
        self.proposed.resize(new * aspects, 0);
        for (urn, proposed) in self.urns.iter().zip(self.proposed.chunks_mut(new)) {
            urn.first_draws(random, proposed);
        }
        for sample in 0..new {
            let rows = self.rows.len();
            let mixed = self.draw_on(kitchen, new, sample, states, random);
            let begin = self.runs.len();
            self.count_worlds(kitchen, states, mixed, rows);
            self.samples.push(Sample { mixed, rows, runs: [begin, self.runs.len()] });
        }
        self.worlds.rate(cost, wanted * states);
        self.weigh_samples(model, button, old);
        while self.rate_again(cost, states) {
            self.weigh_samples(model, button, 0);
        }
    }

    /// Draws the values of one of `new` belief samples, and tells of which aspects it has several, one bit each.
    fn draw_on(&mut self, kitchen: &Kitchen, new: usize, sample: usize, states: usize, random: &mut Stream) -> u32 {
        let (mut mixed, mut counting) = (0, 0);
        let mut prior = 1.0;
        for (aspect, urn) in self.urns.iter().enumerate() {
            // Recipes count where an order wants the dish.
            if aspect >= kitchen.locations.len() && counting & 1 << aspect == 0 {
                self.firsts.push(UNDRAWN);
                continue;
            }
            let first = self.proposed[aspect * new + sample];
            self.firsts.push(first);
            if let Some(count) = self.counts[aspect].get(usize::from(first)) {
                prior *= count;
            }
            let start = self.rows.len();
            self.rows.resize(start + states, first);
            let is_pure = urn.draw_on(random, first, &mut self.rows[start..]);
            if is_pure {
                self.rows.truncate(start);
            } else {
                mixed |= 1 << aspect;
            }
            if let Some(wants) = self.wants.get(aspect) {
                let values = if is_pure { &[first] } else { &self.rows[start..] };
                counting = values.iter().fold(counting, |counting, &value| counting | wants[usize::from(value)]);
            }
        }
        self.priors.push(prior);
        mixed
    }

    /// Counts the worlds among the draws of the newest belief sample, whose rows begin here.
    fn count_worlds(&mut self, kitchen: &Kitchen, states: usize, mixed: u32, rows: usize) {
        self.tell_apart(states, mixed, rows);
        let mut world = World::empty(kitchen);
        let firsts = &self.firsts[self.firsts.len() - self.urns.len()..];
        for (aspect, &value) in firsts.iter().enumerate().filter(|(_, value)| **value != UNDRAWN) {
            world.set_value(kitchen, AspectId(aspect as u8), usize::from(value));
        }
        for &Alike { first, draws, .. } in &self.alike {
            for (aspect, row) in ones(mixed).zip(self.rows[rows..].chunks_exact(states)) {
                world.set_value(kitchen, AspectId(aspect as u8), usize::from(row[first]));
            }
            let index = self.worlds.count(world, draws);
            self.runs.push(Run { world: index, first: first as u32, draws });
        }
    }

    /// Finds the draws of a belief sample that differ.
    fn tell_apart(&mut self, states: usize, mixed: u32, rows: usize) {
        self.alike.clear();
        if mixed == 0 {
            return self.alike.push(Alike { key: Key::default(), first: 0, draws: states as u32 });
        }
        self.keys.clear();
        self.keys.resize(states, Key::default());
        for (index, row) in self.rows[rows..].chunks_exact(states).enumerate() {
            for (key, &value) in self.keys.iter_mut().zip(row) {
                let part = &mut key[index / KEY_PART];
                *part = *part << u8::BITS | u64::from(value);
            }
        }
        for (first, &key) in self.keys.iter().enumerate() {
            match self.alike.iter_mut().find(|alike| alike.key == key) {
                Some(alike) => alike.draws += 1,
                None => self.alike.push(Alike { key, first, draws: 1 }),
            }
        }
    }

    /// Weighs the belief samples from this one on by p(a | belief).
    fn weigh_samples(&mut self, model: &EvidenceModel, button: ButtonId, from: usize) {
        let buttons = model.kitchen.buttons[Agent::Human.index()].len();
        self.posteriors.truncate(from);
        for (sample, prior) in self.samples.iter().zip(&self.priors).skip(from) {
            let mut sums = [0u32; MAX_BUTTONS];
            for run in self.runs_of(sample) {
                let after = self.worlds.after(run.world);
                sums.iter_mut().zip(after).for_each(|(sum, &after)| *sum += run.draws * u32::from(after));
            }
            let likelihood = model.choice.press_likelihood(&sums[..buttons], button);
            self.posteriors.push(prior * likelihood);
        }
    }

    /// The runs of one belief sample.
    #[inline]
    fn runs_of(&self, sample: &Sample) -> &[Run] {
        &self.runs[sample.runs[0]..sample.runs[1]]
    }

    /// Plans for the worlds that hardly counted before the press, and do now; whether there were any.
    fn rate_again(&mut self, cost: &mut CostToGo, states: usize) -> bool {
        self.world_weights.clear();
        self.world_weights.resize(self.worlds.len(), 0.0);
        for (sample, weight) in self.samples.iter().zip(&self.posteriors) {
            for run in &self.runs[sample.runs[0]..sample.runs[1]] {
                self.world_weights[run.world as usize] += weight * f64::from(run.draws);
            }
        }
        let sum = self.posteriors.iter().sum::<f64>() * states as f64;
        self.worlds.rate_again(cost, &self.world_weights, sum)
    }

    fn evidence(&self) -> Evidence {
        let (before, total): (f64, f64) = (self.priors.iter().sum(), self.posteriors.iter().sum());
        let squares: f64 = self.posteriors.iter().map(|p| p * p).sum();
        Evidence { log_p: (total / before).ln(), beliefs: self.posteriors.len(), effective: total * total / squares }
    }

    /// Maps the weighted samples back to Dirichlets.
    fn collapse(&self, belief: &mut DirichletBelief, states: usize) {
        let (before, total): (f64, f64) = (self.priors.iter().sum(), self.posteriors.iter().sum());
        let mut all: Vec<Moments> = belief.aspects.iter().map(Moments::from_prior).collect();
        let samples = self.samples.iter().zip(self.firsts.chunks_exact(all.len()));
        for ((sample, firsts), (after, prior)) in samples.zip(self.posteriors.iter().zip(&self.priors)) {
            let weight = after / total - prior / before;
            for (aspect, (moments, &first)) in all.iter_mut().zip(firsts).enumerate() {
                if sample.mixed >> aspect & 1 == 0 {
                    moments.add_later(first, weight);
                    continue;
                }
                let row = &self.rows[sample.row(aspect, states)..];
                let runs = self.runs_of(sample).iter();
                moments.add(runs.map(|run| (row[run.first as usize], run.draws)), states, weight);
            }
        }
        let collapsed = all.into_iter().zip(&self.urns).map(|(moments, urn)| moments.collapsed(states, urn.stand_in()));
        belief.aspects = collapsed.collect();
    }
}

/// By value of an order, the recipes that count if it has it, one bit each by aspect.
fn wants(kitchen: &Kitchen, order: LocationId) -> Vec<u32> {
    let wanted = |&code: &u8| match OrderContent::from_code(code) {
        OrderContent::Dish(dish) => 1 << kitchen.aspect_of_dish(dish).index(),
        OrderContent::None | OrderContent::Served => 0,
    };
    kitchen.aspects[order.index()].values.iter().map(wanted).collect()
}

/// Mean and second moment of a mixture of Dirichlets, from those of the Dirichlet that all of them come from.
struct Moments<'a> {
    prior: &'a Dirichlet,
    mean: Vec<f64>,
    second: f64,
    square: f64,
    /// How much of the prior's mean is to be added in the end.
    share: f64,
    /// By value, the weights of belief samples that have it in all their draws; at last those that were not drawn.
    pure: Vec<f64>,
    /// The values of one belief sample, and how often each was drawn.
    counts: Vec<(u8, u32)>,
}

impl Moments<'_> {
    fn from_prior(prior: &Dirichlet) -> Moments<'_> {
        let mean = prior.mean().to_vec();
        let square = mean.iter().map(|m| m * m).sum();
        let pure = vec![0.0; mean.len() + 1];
        Moments { prior, mean, second: prior.second(), square, share: 0.0, pure, counts: Vec::new() }
    }

    /// Adds Dir(alpha + counts of these values, `draws` in all) with this weight; all weights sum to 0.
    fn add(&mut self, drawn: impl Iterator<Item = (u8, u32)>, draws: usize, weight: f64) {
        self.counts.clear();
        for (value, times) in drawn {
            match self.counts.iter_mut().find(|(other, _)| *other == value) {
                Some((_, count)) => *count += times,
                None => self.counts.push((value, times)),
            }
        }
        let (precision, prior) = (self.prior.precision(), self.prior.mean());
        let size = precision + draws as f64;
        let (mut cross, mut squares) = (0.0, 0.0);
        for &(value, count) in &self.counts {
            let (value, count) = (usize::from(value), f64::from(count));
            self.mean[value] += weight * count / size;
            cross += prior[value] * count;
            squares += count * count;
        }
        self.add_moments(weight, size, cross, squares);
    }

    /// The same for draws of one value, or none: they are added together in the end.
    #[inline]
    fn add_later(&mut self, value: u8, weight: f64) {
        let last = self.pure.len() - 1;
        self.pure[usize::from(value).min(last)] += weight;
    }

    fn add_pure(&mut self, value: usize, draws: usize, weight: f64) {
        if value == self.mean.len() {
            self.share += weight;
            self.second += weight * self.prior.second();
            return;
        }
        let draws = draws as f64;
        let size = self.prior.precision() + draws;
        self.mean[value] += weight * draws / size;
        self.add_moments(weight, size, self.prior.mean()[value] * draws, draws * draws);
    }

    fn add_moments(&mut self, weight: f64, size: f64, cross: f64, squares: f64) {
        let precision = self.prior.precision();
        // What the prior's alphas give alone; where all aspects have as many draws, it cancels out.
        self.share += weight * precision / size;
        let second = precision * precision * self.square + 2.0 * precision * cross + squares + size;
        self.second += weight * second / (size * (size + 1.0));
    }

    /// What the value that stands for the tail has gained is its own; what it has lost the whole tail loses, since it is
    /// so improbable only as a part of it.
    fn collapsed(mut self, draws: usize, stand_in: Option<usize>) -> Dirichlet {
        for value in 0..self.pure.len() {
            if self.pure[value] != 0.0 {
                self.add_pure(value, draws, self.pure[value]);
            }
        }
        let prior = self.prior.mean();
        self.mean.iter_mut().zip(prior).for_each(|(mean, p)| *mean += self.share * p);
        if let Some(value) = stand_in
            && self.mean[value] < prior[value]
        {
            let tail = || (0..prior.len()).filter(|&value| Urn::is_tail(prior, value));
            let of_tail: f64 = tail().map(|value| prior[value]).sum();
            let left = (1.0 + (self.mean[value] - prior[value]) / of_tail).max(0.0);
            tail().for_each(|value| self.mean[value] = left * prior[value]);
        }
        Dirichlet::of_moments(self.mean, self.second)
    }
}
