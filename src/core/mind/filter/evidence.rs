//! The update of the estimate by the likelihood of the human's press.
//!
//! p(a | b) is a softmax over expected costs to go, so the posterior has no closed form. Belief samples represent the
//! prior, each by the worlds drawn from it (see [`super::draws`]). The posterior of an aspect is the mixture of
//! Dir(alpha + n_j) with the weights w_j, collapsed by its mean and second moment. As a control variate, the moments
//! under equal weights are subtracted and the prior's exact moments are added, so that an uninformative press leaves
//! the estimate unchanged.

use rand::RngExt;

use super::draws::{Alike, DistinctDraws, DistinctWorlds, PolyaUrn, Run};
use super::unseen::{SampleLookEffects, UnseenLooks, ValueSeenByLook};
use crate::base::maths::ones;
use crate::base::rng::Stream;
use crate::kitchen::cost_to_go::{CostToGo, MAX_BUTTONS};
use crate::kitchen::{Agent, AspectId, AspectKind, ButtonId, Kitchen, LocationId, OrderContent, World};
use crate::mind::choice::ChoiceModel;
use crate::mind::dirichlet::{Dirichlet, DirichletBelief};
use crate::mind::model::InferenceSettings;

/// Share of the first draws of a recipe that is spread evenly over the recipe's variants (importance sampling), so that
/// improbable variants get samples.
const SPREAD: f64 = 0.4;
/// Marks an aspect that is not drawn because the decision does not depend on it.
pub const UNDRAWN: u8 = u8::MAX;

/// Likelihood of the human's press, and quality of the belief samples behind it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PressEvidence {
    /// ln p(a) of the pressed button, given that one is pressed, under the estimate before the press, in nats.
    pub log_p: f64,
    /// Number of belief samples that were drawn for the press.
    pub beliefs: usize,
    /// Effective sample size of the belief samples: 1 / sum of squared normalised weights.
    pub effective: f64,
}

/// The models that define the likelihood of a press of the human.
pub struct EvidenceModel<'a> {
    pub kitchen: &'a Kitchen,
    pub choice: &'a ChoiceModel,
    pub inference: &'a InferenceSettings,
    /// For each button of the human, the bit set of locations at which the human looks before the press.
    pub watched: &'a [u32],
}

/// Draws belief samples and weights them by the likelihood of the human's press; the sampler's buffers are reused from
/// press to press.
#[derive(Clone, Debug, Default)]
pub struct BeliefSampler {
    pub(super) urns: Vec<PolyaUrn>,
    /// `[order][value]`: bit set of the recipe aspects on which the decision depends if the order has this value.
    pub(super) wants: Vec<Vec<u32>>,
    /// `[aspect * batch size + sample]`: the first draws of the present batch of samples.
    proposed: Vec<u8>,
    /// `[sample * aspects + aspect]`: value of the belief sample's first draw.
    pub(super) firsts: Vec<u8>,
    /// All draws of those aspects of which a belief sample has several values, in consecutive rows of length `states`.
    rows: Vec<u8>,
    pub(super) samples: Vec<Sample>,
    /// Importance weight of a first draw, by aspect and value; empty where first draws come from the mean.
    counts: Vec<Vec<f64>>,
    /// Weight of each belief sample before and after multiplication with its likelihood p(a | belief).
    pub(super) priors: Vec<f64>,
    pub(super) posteriors: Vec<f64>,
    pub(super) worlds: DistinctWorlds,
    /// The distinct worlds of all belief samples, in consecutive ranges, one range per sample.
    pub(super) runs: Vec<Run>,
    alike: DistinctDraws,
    world_weights: Vec<f64>,
    /// What each belief sample has learned from looks at times of unknown gaze; empty without such times.
    pub(super) looks: Vec<SampleLookEffects>,
    pub(super) news: Vec<ValueSeenByLook>,
    /// Sums of probabilities for systematic sampling of readings: by location, and last for the signal.
    pub(super) read_sums: Vec<f64>,
}

/// A belief sample: a belief drawn from the estimate, represented by worlds.
#[derive(Clone, Copy, Debug)]
pub(super) struct Sample {
    /// Bit set of the aspects of which the belief sample has several values (mixed aspects).
    mixed: u32,
    rows: usize,
    /// Range of the sample's distinct worlds in [`BeliefSampler::runs`].
    pub(super) runs: [usize; 2],
}

impl Sample {
    /// Start of the row of a mixed aspect in [`BeliefSampler::rows`].
    #[inline]
    fn row(&self, aspect: usize, states: usize) -> usize {
        self.rows + (self.mixed & ((1 << aspect) - 1)).count_ones() as usize * states
    }
}

impl BeliefSampler {
    pub fn new(kitchen: &Kitchen) -> BeliefSampler {
        BeliefSampler {
            wants: kitchen.orders.iter().map(|&order| wants(kitchen, order)).collect(),
            ..BeliefSampler::default()
        }
    }

    /// Updates the estimate by the likelihood of a press of the human, and by the possible looks at times of unknown
    /// gaze before the press.
    pub fn weigh(
        &mut self,
        model: &EvidenceModel,
        cost: &mut CostToGo,
        belief: &mut DirichletBelief,
        press: ProposalMixture,
        looks: Option<&UnseenLooks>,
        random: &mut Stream,
    ) -> PressEvidence {
        let states = model.inference.states;
        self.begin(model, belief, looks, random);
        let mut wanted = model.inference.beliefs;
        loop {
            let old = self.samples.len();
            self.draw(model, cost, wanted, random);
            if let Some(looks) = looks {
                self.look(model, looks, old, random);
                self.worlds.rate(cost, wanted * states);
            }
            self.weigh_samples(model, press, old);
            while self.rate_again(cost, states) {
                self.weigh_samples(model, press, 0);
            }
            let evidence = self.evidence();
            let can_double = wanted * 2 <= model.inference.max_beliefs;
            if evidence.effective >= model.inference.min_effective || !can_double {
                self.collapse(belief, states);
                return evidence;
            }
            wanted *= 2;
        }
    }

    /// Prepares urns (samplers of values) and buffers for samples of this belief.
    pub(super) fn begin(
        &mut self,
        model: &EvidenceModel,
        belief: &DirichletBelief,
        looks: Option<&UnseenLooks>,
        random: &mut Stream,
    ) {
        let InferenceSettings { states, beliefs, max_beliefs, .. } = *model.inference;
        self.urns.resize(belief.aspects.len(), PolyaUrn::default());
        self.counts.clear();
        for ((urn, dirichlet), aspect) in self.urns.iter_mut().zip(&belief.aspects).zip(&model.kitchen.aspects) {
            urn.fill(dirichlet, states, random);
            let is_recipe = matches!(aspect.kind, AspectKind::Recipe(_));
            self.counts.push(if is_recipe { urn.spread(SPREAD) } else { Vec::new() });
        }
        self.firsts.clear();
        self.rows.clear();
        self.samples.clear();
        self.runs.clear();
        self.priors.clear();
        self.posteriors.clear();
        self.looks.clear();
        self.news.clear();
        self.read_sums.clear();
        if let Some(looks) = looks {
            let read = model.kitchen.locations.len() + usize::from(looks.signal.is_some());
            self.read_sums.extend((0..read).map(|_| random.random::<f64>()));
        }
        // A look can give each belief sample additional worlds.
        self.worlds.clear(states * beliefs.max(max_beliefs) * (1 + usize::from(looks.is_some())));
    }

    pub(super) fn draw(&mut self, model: &EvidenceModel, cost: &mut CostToGo, wanted: usize, random: &mut Stream) {
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
            self.samples.push(Sample { mixed, rows, runs: [begin; 2] });
            self.count_worlds(kitchen, states);
        }
        self.worlds.rate(cost, wanted * states);
    }

    /// Draws the values of sample number `sample` in a batch of `new`; returns the bit set of its mixed aspects.
    fn draw_on(&mut self, kitchen: &Kitchen, new: usize, sample: usize, states: usize, random: &mut Stream) -> u32 {
        let (mut mixed, mut counting) = (0, 0);
        let mut prior = 1.0;
        for (aspect, urn) in self.urns.iter().enumerate() {
            // A decision depends only on the recipes of dishes that are ordered.
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

    fn count_worlds(&mut self, kitchen: &Kitchen, states: usize) {
        let index = self.samples.len() - 1;
        let Sample { rows, .. } = self.samples[index];
        self.alike.tell_apart(states, &self.rows[rows..]);
        for group in 0..self.alike.groups.len() {
            let Alike { first, draws, .. } = self.alike.groups[group];
            let world = self.worlds.count(self.world_of(kitchen, index, first, states), draws);
            self.runs.push(Run { world, first: first as u32, draws });
        }
        self.samples[index].runs[1] = self.runs.len();
    }

    pub(super) fn world_of(&self, kitchen: &Kitchen, index: usize, draw: usize, states: usize) -> World {
        let aspects = self.urns.len();
        let Sample { mixed, rows, .. } = self.samples[index];
        let mut world = World::empty(kitchen);
        let firsts = &self.firsts[index * aspects..][..aspects];
        for (aspect, &value) in firsts.iter().enumerate().filter(|(_, value)| **value != UNDRAWN) {
            world.set_value(kitchen, AspectId(aspect as u8), usize::from(value));
        }
        for (aspect, row) in ones(mixed).zip(self.rows[rows..].chunks_exact(states)) {
            world.set_value(kitchen, AspectId(aspect as u8), usize::from(row[draw]));
        }
        world
    }

    /// Multiplies the weights of the belief samples from index `from` on by the likelihood of the human's press.
    fn weigh_samples(&mut self, model: &EvidenceModel, press: ProposalMixture, from: usize) {
        self.posteriors.truncate(from);
        for (sample, prior) in self.samples.iter().zip(&self.priors).skip(from) {
            let mut sums = [0u32; MAX_BUTTONS];
            let choice = model.choice.press_likelihood(self.sum_costs(sample, &mut sums, model), press.button);
            self.posteriors.push(prior * press.likelihood(choice));
        }
    }

    /// Cost to go after each button of the human, summed over the draws of one belief sample.
    #[inline]
    pub(super) fn sum_costs<'a>(
        &self,
        sample: &Sample,
        sums: &'a mut [u32; MAX_BUTTONS],
        model: &EvidenceModel,
    ) -> &'a [u32] {
        for run in self.runs_of(sample) {
            let after = self.worlds.after(run.world);
            sums.iter_mut().zip(after).for_each(|(sum, &after)| *sum += run.draws * u32::from(after));
        }
        &sums[..model.kitchen.buttons[Agent::Human.index()].len()]
    }

    #[inline]
    fn runs_of(&self, sample: &Sample) -> &[Run] {
        &self.runs[sample.runs[0]..sample.runs[1]]
    }

    /// Computes more exact costs to go for worlds whose posterior weight has become relevant; returns whether there
    /// were such worlds.
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

    fn evidence(&self) -> PressEvidence {
        let (before, total): (f64, f64) = (self.priors.iter().sum(), self.posteriors.iter().sum());
        let squares: f64 = self.posteriors.iter().map(|p| p * p).sum();
        PressEvidence {
            log_p: (total / before).ln(),
            beliefs: self.posteriors.len(),
            effective: total * total / squares,
        }
    }

    /// Projects the weighted belief samples onto a product of Dirichlets.
    fn collapse(&self, belief: &mut DirichletBelief, states: usize) {
        let (before, total): (f64, f64) = (self.priors.iter().sum(), self.posteriors.iter().sum());
        let mut all: Vec<MixtureMoments> = belief.aspects.iter().map(MixtureMoments::from_prior).collect();
        let samples = self.samples.iter().zip(self.firsts.chunks_exact(all.len()));
        let weights = self.posteriors.iter().zip(&self.priors);
        for (index, ((sample, firsts), (after, prior))) in samples.zip(weights).enumerate() {
            let (after, prior) = (after / total, prior / before);
            let (changed, news) = self.news_of(index);
            for (aspect, (moments, &first)) in all.iter_mut().zip(firsts).enumerate() {
                let weight = if changed >> aspect & 1 == 0 { after - prior } else { -prior };
                if sample.mixed >> aspect & 1 == 0 {
                    moments.add_later(first, weight);
                    continue;
                }
                let row = &self.rows[sample.row(aspect, states)..];
                let runs = self.runs_of(sample).iter();
                moments.add(runs.map(|run| (row[run.first as usize], run.draws)), states, weight);
            }
            for news in news {
                match news.is_read {
                    true => all[news.aspect].add_certain(news.value, after),
                    false => all[news.aspect].add_later(news.value, after),
                }
            }
        }
        let collapsed = all.into_iter().zip(&self.urns).map(|(moments, urn)| moments.collapsed(states, urn.stand_in()));
        belief.aspects = collapsed.collect();
    }
}

/// For each value of an order, the bit set of recipe aspects on which the human's decision depends.
fn wants(kitchen: &Kitchen, order: LocationId) -> Vec<u32> {
    let wanted = |&code: &u8| match OrderContent::from_code(code) {
        OrderContent::Dish(dish) => 1 << kitchen.aspect_of_dish(dish).index(),
        OrderContent::None | OrderContent::Served => 0,
    };
    kitchen.aspects[order.index()].values.iter().map(wanted).collect()
}

/// The likelihood of a press: p(a | belief) = `proposed` + `chosen` p(choice = a | belief). A press that the display
/// proposes may be made because of the proposal, which is equally likely under any belief.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ProposalMixture {
    pub button: ButtonId,
    /// Probability that the human presses the button because the display proposes it.
    pub proposed: f64,
    /// Probability that the human follows a choice of its own rather than a proposal.
    pub chosen: f64,
}

impl ProposalMixture {
    /// A press of `button` while the display proposes `proposed`, by a human who makes proposed presses with the
    /// probability `follows`.
    pub fn new(button: ButtonId, proposed: Option<ButtonId>, follows: f64) -> ProposalMixture {
        match proposed {
            None => ProposalMixture { button, proposed: 0.0, chosen: 1.0 },
            Some(other) => {
                let proposed = if other == button { follows } else { 0.0 };
                ProposalMixture { button, proposed, chosen: 1.0 - follows }
            }
        }
    }

    /// p(a | belief), from the probability `choice` that a human with the belief chooses the button.
    #[inline]
    pub fn likelihood(&self, choice: f64) -> f64 {
        self.proposed + self.chosen * choice
    }
}

/// Mean and second moment of a mixture of Dirichlets that share one prior, accumulated as changes to the prior's
/// moments.
pub struct MixtureMoments<'a> {
    prior: &'a Dirichlet,
    mean: Vec<f64>,
    second: f64,
    square: f64,
    /// Weight of the prior's mean, which is added at the end.
    share: f64,
    /// Total weight of the belief samples whose draws all have the same value, by value; the last entry is for samples
    /// in which the aspect was not drawn.
    pure: Vec<f64>,
    /// Distinct values of one belief sample, each with its number of draws.
    counts: Vec<(u8, u32)>,
}

impl MixtureMoments<'_> {
    pub fn from_prior(prior: &Dirichlet) -> MixtureMoments<'_> {
        let mean = prior.mean().to_vec();
        let square = mean.iter().map(|m| m * m).sum();
        let pure = vec![0.0; mean.len() + 1];
        MixtureMoments { prior, mean, second: prior.second(), square, share: 0.0, pure, counts: Vec::new() }
    }

    /// Adds Dir(alpha + counts of the drawn values) with this weight; `draws` is the number of draws. The weights of
    /// all added distributions sum to 0.
    pub fn add(&mut self, drawn: impl Iterator<Item = (u8, u32)>, draws: usize, weight: f64) {
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

    /// Adds a belief sample whose draws all have one value (or were not drawn): such samples are summed first and added
    /// to the moments at the end.
    #[inline]
    pub fn add_later(&mut self, value: u8, weight: f64) {
        let last = self.pure.len() - 1;
        self.pure[usize::from(value).min(last)] += weight;
    }

    /// Adds a belief that is certain of one value, with this weight.
    pub fn add_certain(&mut self, value: u8, weight: f64) {
        self.mean[usize::from(value)] += weight;
        self.second += weight;
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
        // The contribution of the prior's alphas, which cancels where all samples have the same number of draws.
        self.share += weight * precision / size;
        let second = precision * precision * self.square + 2.0 * precision * cross + squares + size;
        self.second += weight * second / (size * (size + 1.0));
    }

    /// The Dirichlet with the accumulated moments. A gain of the value that represents the improbable values (tail)
    /// belongs to that value alone; a loss is shared by the whole tail in proportion to the probabilities.
    pub fn collapsed(mut self, draws: usize, stand_in: Option<usize>) -> Dirichlet {
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
            let tail = || (0..prior.len()).filter(|&value| PolyaUrn::is_tail(prior, value));
            let of_tail: f64 = tail().map(|value| prior[value]).sum();
            let left = (1.0 + (self.mean[value] - prior[value]) / of_tail).max(0.0);
            tail().for_each(|value| self.mean[value] = left * prior[value]);
        }
        Dirichlet::of_moments(self.mean, self.second)
    }
}
