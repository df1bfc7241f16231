//! The evidence of a press: beliefs under which it was likely gain weight.
//!
//! p(a | b) is a softmax over expected costs to go, and so has no closed form. Belief samples stand for it, each by the
//! states and recipes that are drawn from it (see [`super::urn`]). The posterior of an aspect is the mixture of
//! Dir(alpha + n_j) with the weights w_j, collapsed by its mean and second moment. What equal weights would give is
//! subtracted and the prior's exact moments are added (a control variate), so that a press without information changes
//! nothing.

use std::ops::Range;

use crate::base::bits::ones;
use crate::base::rng::Stream;
use crate::kitchen::cost_to_go::{CostToGo, MAX_BUTTONS};
use crate::kitchen::{Agent, AspectId, AspectKind, ButtonId, Kitchen, OrderContent, Recipes, State};
use crate::mind::decision::{DecisionModel, Slips};
use crate::mind::dirichlet::{Dirichlet, DirichletBelief};
use crate::mind::model::InferenceModel;

use super::cases::Cases;
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
    /// `[(belief * aspects + aspect) * states + draw]`: value indices.
    drawn: Vec<u8>,
    firsts: Vec<u8>,
    /// By aspect and value, how much a first draw counts; nothing where they come from the mean.
    counts: Vec<Vec<f64>>,
    /// How much each belief sample counts, before its likelihood p(a | belief) and with it.
    priors: Vec<f64>,
    posteriors: Vec<f64>,
    cases: Cases,
    /// The different cases among the draws of all belief samples, one sample after another.
    runs: Vec<Run>,
    /// By belief sample, where its runs end.
    run_ends: Vec<usize>,
    /// The different draws of one belief sample: the first that is like this, and how many are.
    alike: Vec<(usize, u32)>,
    /// By case, the weight of its draws after the press.
    case_weights: Vec<f64>,
    /// Aspects of which a belief sample has several values, one bit each, by belief sample.
    mixed: Vec<u32>,
}

/// Draws of one belief sample that are the same case: the first of them, and how many there are.
#[derive(Clone, Copy, Debug)]
struct Run {
    case: u32,
    first: u32,
    draws: u32,
}

/// What a press is judged by.
pub struct Judge<'a> {
    pub kitchen: &'a Kitchen,
    pub decision: &'a DecisionModel,
    pub slips: &'a Slips,
    pub inference: &'a InferenceModel,
}

impl Sampler {
    /// Updates the belief by the evidence of a press of the human.
    pub fn weigh(
        &mut self,
        judge: &Judge,
        cost: &mut CostToGo,
        belief: &mut DirichletBelief,
        button: ButtonId,
        random: &mut Stream,
    ) -> Evidence {
        let states = judge.inference.states;
        self.urns.resize(belief.aspects.len(), Urn::default());
        self.counts.clear();
        for ((urn, dirichlet), aspect) in self.urns.iter_mut().zip(&belief.aspects).zip(&judge.kitchen.aspects) {
            urn.fill(dirichlet, states, random);
            let is_recipe = matches!(aspect.kind, AspectKind::Recipe(_));
            self.counts.push(if is_recipe { urn.spread(SPREAD) } else { Vec::new() });
        }
        let mut wanted = judge.inference.beliefs;
        self.drawn.clear();
        self.runs.clear();
        self.run_ends.clear();
        self.mixed.clear();
        self.priors.clear();
        self.posteriors.clear();
        self.cases.clear(states * wanted.max(judge.inference.max_beliefs));
        loop {
            self.draw(judge, cost, button, wanted, random);
            let evidence = self.evidence();
            let can_double = wanted * 2 <= judge.inference.max_beliefs;
            if evidence.effective >= judge.inference.min_effective || !can_double {
                self.collapse(belief, states);
                return evidence;
            }
            wanted *= 2;
        }
    }

    /// Draws belief samples until there are so many.
    fn draw(&mut self, judge: &Judge, cost: &mut CostToGo, button: ButtonId, wanted: usize, random: &mut Stream) {
        let (kitchen, states) = (judge.kitchen, judge.inference.states);
        let aspects = self.urns.len();
        let row = aspects * states;
        let truth = kitchen.true_recipes();
        let old = self.posteriors.len();
        self.drawn.resize(wanted * row, UNDRAWN);
        let mut firsts = std::mem::take(&mut self.firsts);
        firsts.resize(wanted - old, 0);
        for aspect in 0..aspects {
            self.urns[aspect].first_draws(random, &mut firsts);
            for (sample, &first) in firsts.iter().enumerate() {
                self.drawn[(old + sample) * row + aspect * states] = first;
            }
        }
        self.firsts = firsts;
        for sample in old..wanted {
            let drawn = &mut self.drawn[sample * row..(sample + 1) * row];
            let mixed = draw_on(kitchen, &self.urns, states, drawn, random);
            let counts = self.counts.iter().enumerate().filter(|(_, counts)| !counts.is_empty());
            let count = counts.map(|(aspect, counts)| match drawn[aspect * states] {
                UNDRAWN => 1.0,
                value => counts[usize::from(value)],
            });
            self.priors.push(count.product());
            self.mixed.push(mixed);
            self.tell_apart(sample, mixed, states);
            let drawn = &self.drawn[sample * row..(sample + 1) * row];
            let (mut state, mut recipes) = (kitchen.empty_state(), truth);
            for aspect in 0..aspects {
                set(kitchen, &mut state, &mut recipes, aspect, drawn[aspect * states]);
            }
            for &(draw, draws) in &self.alike {
                for aspect in ones(mixed) {
                    set(kitchen, &mut state, &mut recipes, aspect, drawn[aspect * states + draw]);
                }
                let case = self.cases.count(state, recipes, draws);
                self.runs.push(Run { case, first: draw as u32, draws });
            }
            self.run_ends.push(self.runs.len());
        }
        self.cases.rate(cost, wanted * states);
        self.press_chances(judge, button, old);
        while self.rate_again(cost, states) {
            self.press_chances(judge, button, 0);
        }
    }

    /// Finds the draws of a belief sample that differ.
    fn tell_apart(&mut self, sample: usize, mixed: u32, states: usize) {
        self.alike.clear();
        if mixed == 0 {
            return self.alike.push((0, states as u32));
        }
        let row = self.urns.len() * states;
        let drawn = &self.drawn[sample * row..(sample + 1) * row];
        for draw in 0..states {
            let like = |other: usize| {
                ones(mixed).all(|aspect| drawn[aspect * states + other] == drawn[aspect * states + draw])
            };
            match self.alike.iter_mut().find(|(other, _)| like(*other)) {
                Some((_, draws)) => *draws += 1,
                None => self.alike.push((draw, 1)),
            }
        }
    }

    /// Weighs the belief samples from this one on by p(a | belief).
    fn press_chances(&mut self, judge: &Judge, button: ButtonId, from: usize) {
        let states = judge.inference.states;
        let buttons = judge.kitchen.buttons[Agent::Human.index()].len();
        self.posteriors.truncate(from);
        for (sample, prior) in self.priors.iter().enumerate().skip(from) {
            let mut sums = [0u32; MAX_BUTTONS];
            for run in &self.runs[self.runs_of(sample)] {
                let after = self.cases.after(run.case);
                sums.iter_mut().zip(after).for_each(|(sum, &after)| *sum += run.draws * u32::from(after));
            }
            let sums = &sums[..buttons];
            let likelihood = judge.decision.press_chance(judge.slips, sums, states as f64, button);
            self.posteriors.push(prior * likelihood);
        }
    }

    /// The runs of one belief sample.
    fn runs_of(&self, sample: usize) -> Range<usize> {
        let start = sample.checked_sub(1).map_or(0, |before| self.run_ends[before]);
        start..self.run_ends[sample]
    }

    /// Takes more care of the cases that hardly counted before the press, and do now; whether there were any.
    fn rate_again(&mut self, cost: &mut CostToGo, states: usize) -> bool {
        self.case_weights.clear();
        self.case_weights.resize(self.cases.len(), 0.0);
        for (sample, weight) in self.posteriors.iter().enumerate() {
            for run in &self.runs[self.runs_of(sample)] {
                self.case_weights[run.case as usize] += weight * f64::from(run.draws);
            }
        }
        let sum = self.posteriors.iter().sum::<f64>() * states as f64;
        self.cases.rate_again(cost, &self.case_weights, sum)
    }

    fn evidence(&self) -> Evidence {
        let (before, total): (f64, f64) = (self.priors.iter().sum(), self.posteriors.iter().sum());
        let squares: f64 = self.posteriors.iter().map(|p| p * p).sum();
        Evidence { log_p: (total / before).ln(), beliefs: self.posteriors.len(), effective: total * total / squares }
    }

    /// Maps the weighted samples back to Dirichlets.
    fn collapse(&self, belief: &mut DirichletBelief, states: usize) {
        let (before, total): (f64, f64) = (self.priors.iter().sum(), self.posteriors.iter().sum());
        let weights = || self.posteriors.iter().zip(&self.priors).map(|(after, prior)| after / total - prior / before);
        let row = belief.aspects.len() * states;
        for (aspect, dirichlet) in belief.aspects.iter_mut().enumerate() {
            let mut moments = Moments::of(dirichlet);
            // Belief samples with one and the same value in all their draws are added together.
            let mut of_value = [0.0; UNDRAWN as usize + 1];
            for (sample, weight) in weights().enumerate() {
                let start = sample * row + aspect * states;
                match self.mixed[sample] >> aspect & 1 {
                    0 => of_value[usize::from(self.drawn[start])] += weight,
                    _ => {
                        let runs = self.runs[self.runs_of(sample)].iter();
                        moments.add(
                            runs.map(|run| (self.drawn[start + run.first as usize], run.draws)),
                            states,
                            weight,
                        );
                    }
                }
            }
            for (value, &weight) in of_value.iter().enumerate().filter(|(_, weight)| **weight != 0.0) {
                moments.add_pure(value, states, weight);
            }
            *dirichlet = moments.collapsed(self.urns[aspect].stand_in());
        }
    }
}

/// Gives an aspect the value that was drawn for it, if one was.
#[inline]
fn set(kitchen: &Kitchen, state: &mut State, recipes: &mut Recipes, aspect: usize, value: u8) {
    if value != UNDRAWN {
        kitchen.set_value(state, recipes, AspectId(aspect as u8), usize::from(value));
    }
}

/// Draws the values of one belief sample that follow the first ones, and tells of which aspects there are several, one bit
/// each.
fn draw_on(kitchen: &Kitchen, urns: &[Urn], states: usize, drawn: &mut [u8], random: &mut Stream) -> u32 {
    let mut mixed = 0;
    let locations = kitchen.locations.len();
    for location in 0..locations {
        if !urns[location].draw_on(random, &mut drawn[location * states..(location + 1) * states]) {
            mixed |= 1 << location;
        }
    }
    // Recipes count where an order wants the dish; the other first draws are taken back.
    for aspect in locations..kitchen.aspects.len() {
        let AspectKind::Recipe(dish) = kitchen.aspects[aspect].kind else { continue };
        let code = OrderContent::Dish(dish).code();
        let is_wanted = kitchen.orders.iter().any(|&order| {
            let value = kitchen.aspects[order.index()].index_of(code).map_or(UNDRAWN, |value| value as u8);
            drawn[order.index() * states..(order.index() + 1) * states].contains(&value)
        });
        let of_aspect = &mut drawn[aspect * states..(aspect + 1) * states];
        if !is_wanted {
            of_aspect.fill(UNDRAWN);
        } else if !urns[aspect].draw_on(random, of_aspect) {
            mixed |= 1 << aspect;
        }
    }
    mixed
}

/// Mean and second moment of a mixture of Dirichlets, from those of the Dirichlet that all of them come from.
struct Moments<'a> {
    prior: &'a Dirichlet,
    mean: Vec<f64>,
    second: f64,
    square: f64,
    /// How much of the prior's mean is to be added in the end.
    share: f64,
    /// The values of one belief sample, and how often each was drawn.
    counts: Vec<(u8, u32)>,
}

impl Moments<'_> {
    fn of(prior: &Dirichlet) -> Moments<'_> {
        let mean = prior.mean().to_vec();
        let square = mean.iter().map(|m| m * m).sum();
        Moments { prior, mean, second: prior.second(), square, share: 0.0, counts: Vec::new() }
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

    /// The same for `draws` draws of one value.
    fn add_pure(&mut self, value: usize, draws: usize, weight: f64) {
        if value == usize::from(UNDRAWN) {
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
    fn collapsed(mut self, stand_in: Option<usize>) -> Dirichlet {
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
