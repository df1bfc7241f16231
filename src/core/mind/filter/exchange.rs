//! The update of the estimate by the human's press of a location's button, whose effect depends on the contents of hand
//! and location jointly.

use crate::base::rng::Stream;
use crate::kitchen::{Agent, AspectId, ButtonAction, Kitchen, LocationId};
use crate::mind::dirichlet::{Dirichlet, DirichletBelief};

use super::gamma::DirichletSampler;
use super::own_press::DOUBT;

/// Effect of a press of a location's button, given the contents of hand and location.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Outcome {
    Nothing,
    PickUp,
    PutDown,
    /// The items are stacked: the location holds the stack with this value afterwards.
    Stack(usize),
}

/// A location's button: the classes ("kinds") of contents that the button treats alike in hand and location, and the
/// effect of a press for each pair of kinds.
#[derive(Clone, Debug)]
pub struct ExchangeUpdate {
    hand: Side,
    location: Side,
    /// Effect of a press by values: `[hand value * number of location values + location value]`.
    outcomes: Vec<Outcome>,
    /// Effect of a press by kinds of contents, in the same layout; kinds do not say which stack results.
    by_kind: Vec<Outcome>,
}

/// One of the two state aspects that the press involves: the content of the hand, or of the location.
#[derive(Clone, Debug)]
struct Side {
    aspect: AspectId,
    empty: usize,
    /// Kind of each value of the aspect, and number of kinds.
    kind_of: Vec<usize>,
    kinds: usize,
    /// For each value, the same content's value on the other side (hand or location); `None` if that side cannot hold
    /// it.
    across: Vec<Option<usize>>,
}

impl ExchangeUpdate {
    /// The update for the human's button of this location.
    pub fn new(kitchen: &Kitchen, location: LocationId) -> ExchangeUpdate {
        let hand_at = kitchen.hands[Agent::Human.index()];
        let aspects = [AspectId::of_location(hand_at), AspectId::of_location(location)];
        let [held, there] = aspects.map(|aspect| &kitchen.aspects[aspect.index()]);
        let mut outcomes = Vec::with_capacity(held.values.len() * there.values.len());
        for &in_hand in &held.values {
            for &at_location in &there.values {
                let mut state = kitchen.empty_state();
                state.set_code(hand_at, in_hand);
                state.set_code(location, at_location);
                let next = kitchen.act(state, &kitchen.true_recipes(), Agent::Human, ButtonAction::Use(location));
                let result = next.and_then(|next| there.index_of(next.code(location)));
                outcomes.push(match (result, in_hand, at_location) {
                    (None, _, _) => Outcome::Nothing,
                    (Some(_), 0, _) => Outcome::PickUp,
                    (Some(_), _, 0) => Outcome::PutDown,
                    (Some(value), _, _) => Outcome::Stack(value),
                });
            }
        }
        let (rows, width) = (held.values.len(), there.values.len());
        let kind_at = |x: usize, y: usize| match outcomes[x * width + y] {
            Outcome::Stack(_) => Outcome::Stack(0),
            other => other,
        };
        let row = |x: usize| (0..width).map(|y| kind_at(x, y)).collect::<Vec<_>>();
        let column = |y: usize| (0..rows).map(|x| kind_at(x, y)).collect::<Vec<_>>();
        let (hand_kinds, hand_firsts) = kinds(rows, row);
        let (location_kinds, location_firsts) = kinds(width, column);
        let pairs = hand_firsts.iter().flat_map(|&x| location_firsts.iter().map(move |&y| (x, y)));
        let by_kind = pairs.map(|(x, y)| kind_at(x, y)).collect();
        let side = |index: usize, kind_of: Vec<usize>, kinds: usize| {
            let [own, other] = [aspects[index], aspects[1 - index]].map(|aspect| &kitchen.aspects[aspect.index()]);
            let across = own.values.iter().map(|&code| other.index_of(code)).collect();
            Side { aspect: aspects[index], empty: own.index_of(0).unwrap_or(0), kind_of, kinds, across }
        };
        let hand = side(0, hand_kinds, hand_firsts.len());
        let location = side(1, location_kinds, location_firsts.len());
        ExchangeUpdate { hand, location, outcomes, by_kind }
    }

    /// Updates the estimate by the human's press of the location's button.
    pub fn learn(&self, belief: &mut DirichletBelief, effective: bool, draws: usize, random: &mut Stream) {
        let sides = [&self.hand, &self.location].map(|side| Parts::from_prior(belief.aspect(side.aspect), side));
        let shares = self.shares(&sides, effective, draws, random);
        let [of_hand, of_location] = match effective {
            true => self.exchanged(&sides, &shares),
            false => [0, 1].map(|side| sides[side].kept(&shares.change[side])),
        };
        belief.aspects[self.hand.aspect.index()] = of_hand;
        belief.aspects[self.location.aspect.index()] = of_location;
    }

    /// Moments of the joint probabilities of all pairs of kinds, given that the press was effective or ineffective.
    fn shares(&self, sides: &[Parts; 2], effective: bool, draws: usize, random: &mut Stream) -> Shares {
        let [rows, columns] = [self.hand.kinds, self.location.kinds];
        let mut shares = Shares::new(rows, columns);
        let mut drawn = [vec![0.0; rows], vec![0.0; columns]];
        let mut joint = vec![0.0; rows * columns];
        let gammas = [0, 1].map(|side: usize| DirichletSampler::new(&sides[side].alphas));
        let fits: Vec<bool> = self.by_kind.iter().map(|kind| (*kind != Outcome::Nothing) == effective).collect();
        for _ in 0..draws {
            for ((parts, gammas), drawn) in sides.iter().zip(&gammas).zip(&mut drawn) {
                gammas.draw(random, drawn);
                for (p, mean) in drawn.iter_mut().zip(&parts.means) {
                    *p = (1.0 - DOUBT) * *p + DOUBT * mean;
                }
            }
            let mut total = 0.0;
            for ((shares, fits), of_row) in joint.chunks_mut(columns).zip(fits.chunks(columns)).zip(&drawn[0]) {
                for ((share, fits), of_column) in shares.iter_mut().zip(fits).zip(&drawn[1]) {
                    *share = if *fits { of_row * of_column } else { 0.0 };
                    total += *share;
                }
            }
            if total > 0.0 {
                joint.iter_mut().for_each(|share| *share /= total);
                shares.add(&joint, &drawn, &self.by_kind);
            }
        }
        shares.divide();
        shares
    }

    /// Estimates of hand and location after an effective press: an item was picked up, put down or stacked.
    fn exchanged(&self, sides: &[Parts; 2], shares: &Shares) -> [Dirichlet; 2] {
        let [held, there] = sides;
        let [width, columns] = [self.location.kind_of.len(), self.location.kinds];
        let mut of_hand = Mixture::new(self.hand.kind_of.len());
        let mut of_location = Mixture::new(width);
        of_hand.add_point(self.hand.empty, shares.emptied[0]);
        of_location.add_point(self.location.empty, shares.emptied[1]);
        for (index, &share) in shares.of_pairs.iter().enumerate() {
            let (x, y) = (index / columns, index % columns);
            match self.by_kind[index] {
                Outcome::Nothing => {}
                Outcome::PickUp => of_hand.add_part(share, there, y),
                Outcome::PutDown => of_location.add_part(share, held, x),
                Outcome::Stack(_) => {
                    of_location.second += share[1] * held.seconds[x] * there.seconds[y];
                    for above in held.of_kind(x) {
                        for below in there.of_kind(y) {
                            if let Outcome::Stack(stack) = self.outcomes[above * width + below] {
                                of_location.mean[stack] += share[0] * held.inner(above) * there.inner(below);
                            }
                        }
                    }
                }
            }
        }
        [of_hand, of_location].map(|mixture| Dirichlet::of_moments(mixture.mean, mixture.second))
    }
}

/// Classifies `count` values by the function `trait_of`: the kind of each value, and the first value of each kind.
fn kinds<T: PartialEq>(count: usize, trait_of: impl Fn(usize) -> T) -> (Vec<usize>, Vec<usize>) {
    let mut known: Vec<T> = Vec::new();
    let (mut kind_of, mut firsts) = (Vec::with_capacity(count), Vec::new());
    for value in 0..count {
        let of_value = trait_of(value);
        let kind = known.iter().position(|other| *other == of_value).unwrap_or_else(|| {
            known.push(of_value);
            firsts.push(value);
            firsts.len() - 1
        });
        kind_of.push(kind);
    }
    (kind_of, firsts)
}

/// The estimate of hand or location, decomposed into the probability of each kind of content and the distribution
/// within each kind.
struct Parts<'a> {
    side: &'a Side,
    belief: &'a Dirichlet,
    /// Expected probability and alpha of each kind of content.
    means: Vec<f64>,
    alphas: Vec<f64>,
    /// Pooled second moment of the distribution within each kind.
    seconds: Vec<f64>,
}

impl<'a> Parts<'a> {
    fn from_prior(belief: &'a Dirichlet, side: &'a Side) -> Parts<'a> {
        let (mut means, mut squares) = (vec![0.0; side.kinds], vec![0.0; side.kinds]);
        for (&mean, &kind) in belief.mean().iter().zip(&side.kind_of) {
            means[kind] += mean;
            squares[kind] += mean * mean;
        }
        let alphas: Vec<f64> = means.iter().map(|mean| belief.precision() * mean).collect();
        let second = |kind: usize| {
            let square = squares[kind] / (means[kind] * means[kind]);
            (alphas[kind] * square + 1.0) / (alphas[kind] + 1.0)
        };
        let seconds = (0..side.kinds).map(second).collect();
        Parts { side, belief, means, alphas, seconds }
    }

    fn of_kind(&self, kind: usize) -> impl Iterator<Item = usize> {
        let kinds = self.side.kind_of.iter().enumerate();
        kinds.filter(move |(_, other)| **other == kind).map(|(value, _)| value)
    }

    /// Expected probability of a value, given that its kind is the case.
    fn inner(&self, value: usize) -> f64 {
        self.belief.mean()[value] / self.means[self.side.kind_of[value]]
    }

    /// The estimate after an ineffective press; `change` is the change of the moments of the kinds' probabilities.
    fn kept(&self, change: &[[f64; 2]]) -> Dirichlet {
        let mut mixture = Mixture::new(self.side.kind_of.len());
        let precision = self.belief.precision();
        let square = |kind: usize| self.means[kind] * (self.alphas[kind] + 1.0) / (precision + 1.0);
        for (kind, change) in change.iter().enumerate() {
            let share = [(self.means[kind] + change[0]).max(0.0), (square(kind) + change[1]).max(0.0)];
            mixture.second += share[1] * self.seconds[kind];
            for value in self.of_kind(kind) {
                mixture.mean[value] += share[0] * self.inner(value);
            }
        }
        Dirichlet::of_moments(mixture.mean, mixture.second)
    }
}

/// First and second moments of the probabilities of kinds of contents, averaged over draws.
struct Shares {
    draws: f64,
    of_pairs: Vec<[f64; 2]>,
    /// Probability that the hand, and that the location, is empty after the press.
    emptied: [[f64; 2]; 2],
    /// Change of the prior moments of probabilities, by side (hand, location) and kind.
    change: [Vec<[f64; 2]>; 2],
    /// Probability in one draw, by side (hand, location) and kind.
    sums: [Vec<f64>; 2],
}

impl Shares {
    fn new(rows: usize, columns: usize) -> Shares {
        let change = [vec![[0.0; 2]; rows], vec![[0.0; 2]; columns]];
        let sums = [vec![0.0; rows], vec![0.0; columns]];
        Shares { draws: 0.0, of_pairs: vec![[0.0; 2]; rows * columns], emptied: [[0.0; 2]; 2], change, sums }
    }

    fn add(&mut self, joint: &[f64], drawn: &[Vec<f64>; 2], by_kind: &[Outcome]) {
        self.draws += 1.0;
        let columns = drawn[1].len();
        self.sums.iter_mut().for_each(|sums| sums.fill(0.0));
        let [of_rows, of_columns] = &mut self.sums;
        let mut emptied = [0.0; 2];
        let rows = joint.chunks(columns).zip(by_kind.chunks(columns)).zip(self.of_pairs.chunks_mut(columns));
        for (((joint, by_kind), of_pairs), of_row) in rows.zip(of_rows) {
            let cells = joint.iter().zip(by_kind).zip(of_pairs).zip(&mut *of_columns);
            for (((&share, kind), of_pair), of_column) in cells {
                add(of_pair, share);
                *of_row += share;
                *of_column += share;
                match kind {
                    Outcome::Nothing => {}
                    Outcome::PickUp => emptied[1] += share,
                    Outcome::PutDown | Outcome::Stack(_) => emptied[0] += share,
                }
            }
        }
        for side in 0..2 {
            add(&mut self.emptied[side], emptied[side]);
            for ((change, sum), before) in self.change[side].iter_mut().zip(&self.sums[side]).zip(&drawn[side]) {
                change[0] += sum - before;
                change[1] += sum * sum - before * before;
            }
        }
    }

    fn divide(&mut self) {
        let draws = self.draws.max(1.0);
        let all = self.of_pairs.iter_mut().chain(&mut self.emptied).chain(self.change.iter_mut().flatten());
        all.flatten().for_each(|moment| *moment /= draws);
    }
}

fn add(moments: &mut [f64; 2], share: f64) {
    moments[0] += share;
    moments[1] += share * share;
}

/// Mean and second moment of a mixture of distributions, accumulated part by part.
struct Mixture {
    mean: Vec<f64>,
    second: f64,
}

impl Mixture {
    fn new(values: usize) -> Mixture {
        Mixture { mean: vec![0.0; values], second: 0.0 }
    }

    fn add_point(&mut self, value: usize, share: [f64; 2]) {
        self.mean[value] += share[0];
        self.second += share[1];
    }

    /// Adds to the mixture the distribution within one kind of the other side.
    fn add_part(&mut self, share: [f64; 2], other: &Parts, kind: usize) {
        self.second += share[1] * other.seconds[kind];
        for value in other.of_kind(kind) {
            if let Some(here) = other.side.across[value] {
                self.mean[here] += share[0] * other.inner(value);
            }
        }
    }
}
