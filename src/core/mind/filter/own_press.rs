//! The update of the estimate by the human's own press: the human knows which button was pressed and whether the press
//! was effective.
//!
//! The belief is conditioned on effective or ineffective, then transformed by the kitchen's rules. Where one location
//! determines the effect, the update is exact: a Dirichlet restricted to some of its values is a Dirichlet with their
//! alphas. Where hand and location ([`ExchangeUpdate`]) or plate, order and recipe ([`ServingUpdate`]) determine the effect
//! jointly, only the probabilities of classes of contents that the rules treat alike are sampled; the distribution within a
//! class is independent of these probabilities and stays exact.

use super::draws::DirichletSampler;
use crate::base::rng::Stream;
use crate::kitchen::{Agent, AspectId, ButtonAction, ContentId, DishId, Kitchen, LocationId, OrderContent};
use crate::mind::dirichlet::{Dirichlet, DirichletBelief};

/// Share of the expected distribution that is mixed into every draw, so that conditioning on an observation that is
/// impossible in a draw still gives a proper distribution.
pub const DOUBT: f64 = 1e-6;

/// Restricts a Dirichlet to the values for which `keep` holds, then maps each value by `becomes` (exact).
fn restrict(dirichlet: &Dirichlet, keep: impl Fn(usize) -> bool, becomes: impl Fn(usize) -> usize) -> Dirichlet {
    let mut mean = vec![0.0; dirichlet.mean().len()];
    let mut kept = 0.0;
    for (value, &m) in dirichlet.mean().iter().enumerate().filter(|(value, _)| keep(*value)) {
        kept += m;
        mean[becomes(value)] += m;
    }
    match kept > 0.0 {
        true => Dirichlet::new(mean, dirichlet.precision() * kept),
        false => dirichlet.clone(),
    }
}

/// Updates the estimate by a press whose effect depends on one location; other presses change nothing here.
pub fn learn_alone(kitchen: &Kitchen, belief: &mut DirichletBelief, action: ButtonAction, effective: bool) {
    let hand = AspectId::of_location(kitchen.hands[Agent::Human.index()]);
    let empty = value_of(kitchen, hand, ContentId::EMPTY);
    match action {
        ButtonAction::Take(item) => {
            let taken = value_of(kitchen, hand, item);
            let of_hand = &mut belief.aspects[hand.index()];
            *of_hand = match effective {
                true => restrict(of_hand, |_| true, |_| taken),
                false => restrict(of_hand, |value| value != empty, |value| value),
            };
        }
        ButtonAction::Trash => {
            // The hand is empty afterwards: an effective press emptied the hand, and before an ineffective press it was
            // empty already.
            let of_hand = &mut belief.aspects[hand.index()];
            *of_hand = restrict(of_hand, |_| true, |_| empty);
        }
        ButtonAction::Process(process) => {
            let place = kitchen.processes[usize::from(process)].place;
            let aspect = place.map_or(hand, AspectId::of_location);
            let values = &kitchen.aspects[aspect.index()];
            let result = |value: usize| {
                let made = kitchen.processed(process, ContentId(values.values[value]))?;
                values.index_of(made.0)
            };
            let of_place = &mut belief.aspects[aspect.index()];
            *of_place = restrict(
                of_place,
                |value| result(value).is_some() == effective,
                |value| result(value).unwrap_or(value),
            );
        }
        ButtonAction::Use(_) | ButtonAction::Serve(_) => {}
    }
}

fn value_of(kitchen: &Kitchen, aspect: AspectId, content: ContentId) -> usize {
    kitchen.aspects[aspect.index()].index_of(content.0).unwrap_or(0)
}

// Presses of a location's button, whose effect depends on the contents of hand and location jointly.

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
    kind_of: Vec<usize>,
    kinds: usize,
    /// For each value, the same content's value on the other side (hand or location); `None` if that side cannot hold
    /// it.
    across: Vec<Option<usize>>,
}

impl ExchangeUpdate {
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

/// Mean and second moment of a mixture of distributions, or their change, accumulated part by part.
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

    /// Adds the change from one distribution to another.
    fn add_change(&mut self, before: &[f64], after: &[f64], weight: f64) {
        for ((mean, now), then) in self.mean.iter_mut().zip(after).zip(before) {
            *mean += weight * (now - then);
        }
        self.second += weight * (square(after) - square(before));
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

// The update of the estimate by the human's press of a serve button, whose effect depends on plate, order and recipe
// jointly.
//
// An order is served if the plate holds the stack of the ordered dish. With the believed probabilities o(d) that the
// order is dish d, p(x) that the plate holds x, and r_d(x) that the recipe of d is x, the press is effective with
// probability sum_d o(d) sum_x p(x) r_d(x). Contents that can be a dish are sampled one by one, all others as one
// class.

/// Expected probability of being ordered below which a dish is ignored.
const NEGLIGIBLE: f64 = 1e-4;

/// The button that serves an order, with the state aspects on which the button's effect depends.
#[derive(Clone, Debug)]
pub struct ServingUpdate {
    order: AspectId,
    plate: AspectId,
    served: usize,
    empty: usize,
    dishes: Vec<Served>,
}

/// The values of the order's and of the plate's aspect that belong to one dish.
#[derive(Clone, Debug)]
struct Served {
    ordered: usize,
    recipe: AspectId,
    /// Value of the plate's aspect for each variant of this dish's recipe; `None` if the plate cannot hold the variant.
    on_plate: Vec<Option<usize>>,
}

fn square(values: &[f64]) -> f64 {
    values.iter().map(|value| value * value).sum()
}

impl ServingUpdate {
    pub fn new(kitchen: &Kitchen, order: LocationId) -> ServingUpdate {
        let (order, plate) = (AspectId::of_location(order), AspectId::of_location(kitchen.plate));
        let [ordered, on_plate] = [order, plate].map(|aspect| &kitchen.aspects[aspect.index()]);
        let dishes = (0..kitchen.dishes.len()).filter_map(|index| {
            let dish = DishId(index as u8);
            let recipe = kitchen.aspect_of_dish(dish);
            let variants = &kitchen.aspects[recipe.index()].values;
            let on_plate = variants.iter().map(|&code| on_plate.index_of(code)).collect();
            let ordered = ordered.index_of(OrderContent::Dish(dish).code())?;
            Some(Served { ordered, recipe, on_plate })
        });
        let served = ordered.index_of(OrderContent::Served.code()).unwrap_or(0);
        ServingUpdate { order, plate, served, empty: on_plate.index_of(0).unwrap_or(0), dishes: dishes.collect() }
    }

    /// Updates the estimate by a press of the order's serve button.
    pub fn learn(&self, belief: &mut DirichletBelief, effective: bool, draws: usize, random: &mut Stream) {
        let expected = belief.aspect(self.order).mean();
        let dishes: Vec<&Served> = self.dishes.iter().filter(|dish| expected[dish.ordered] >= NEGLIGIBLE).collect();
        let aspects = [self.order, self.plate].into_iter().chain(dishes.iter().map(|dish| dish.recipe));
        let mut draw_of: Vec<Draw> =
            aspects.map(|aspect| Draw::from_dirichlet(belief.aspect(aspect), aspect)).collect();
        // Contents of the plate that cannot be a dish form one class.
        draw_of[1].lump(|value| !self.dishes.iter().any(|dish| dish.on_plate.contains(&Some(value))));
        let mut tallies: Vec<Mixture> = draw_of.iter().map(|draw| Mixture::new(draw.means.len())).collect();
        for _ in 0..draws {
            draw_of.iter_mut().for_each(|draw| draw.again(random));
            let Some(after) = condition(&dishes, &draw_of, effective) else { continue };
            for ((tally, draw), after) in tallies.iter_mut().zip(&draw_of).zip(&after) {
                tally.add_change(&draw.now, after, 1.0 / draws as f64);
            }
        }
        for (tally, draw) in tallies.iter().zip(&draw_of) {
            let changed = draw.changed(belief.aspect(draw.aspect), tally);
            belief.aspects[draw.aspect.index()] = changed;
        }
        if effective {
            for (aspect, value) in [(self.order, self.served), (self.plate, self.empty)] {
                let mut mean = vec![0.0; belief.aspect(aspect).mean().len()];
                mean[value] = 1.0;
                belief.aspects[aspect.index()] = Dirichlet::of_moments(mean, 1.0);
            }
        }
    }
}

/// The draws of order, plate and recipes conditioned on an effective or ineffective press; `None` if that has
/// probability 0.
fn condition(dishes: &[&Served], draws: &[Draw], effective: bool) -> Option<Vec<Vec<f64>>> {
    let (order, plate) = (&draws[0].now, &draws[1].now);
    let place = |value: Option<usize>| value.map(|value| draws[1].part_of[value]);
    // For each dish: probability that it is ordered and on the plate, and that it is ordered and not on the plate.
    let fits = |index: usize, variant: usize| match place(dishes[index].on_plate[variant]) {
        Some(part) => (plate[part], 1.0 - plate[part]),
        None => (0.0, 1.0),
    };
    let of_dish = |index: usize| {
        let recipe = &draws[index + 2].now;
        recipe.iter().enumerate().fold((0.0, 0.0), |(on, off), (variant, r)| {
            let (is, is_not) = fits(index, variant);
            (on + r * is, off + r * is_not)
        })
    };
    let each: Vec<(f64, f64)> = (0..dishes.len()).map(of_dish).collect();
    let wanted: f64 = dishes.iter().map(|dish| order[dish.ordered]).sum();
    let others = order.iter().sum::<f64>() - wanted;
    let of = |(on, off): (f64, f64)| if effective { on } else { off };
    let rest = if effective { 0.0 } else { others };
    let total: f64 = rest + dishes.iter().zip(&each).map(|(dish, each)| order[dish.ordered] * of(*each)).sum::<f64>();
    if total.is_nan() || total <= f64::MIN_POSITIVE {
        return None;
    }
    let mut after: Vec<Vec<f64>> = draws.iter().map(|draw| draw.now.clone()).collect();
    let kept = rest / total / others.max(f64::MIN_POSITIVE);
    after[0].iter_mut().for_each(|p| *p *= kept);
    let mut on_plate: Vec<f64> = plate.iter().map(|p| p * rest / total).collect();
    for (index, dish) in dishes.iter().enumerate() {
        let is_wanted = order[dish.ordered];
        after[0][dish.ordered] = is_wanted * of(each[index]) / total;
        let recipe = &draws[index + 2].now;
        // Where another dish is ordered, the press carries no information about this dish's recipe.
        let elsewhere = 1.0 - is_wanted * of(each[index]) / total;
        for (variant, r) in recipe.iter().enumerate() {
            after[index + 2][variant] = elsewhere * r + is_wanted * r * of(fits(index, variant)) / total;
        }
        for (part, p) in plate.iter().enumerate() {
            let is_it = |variant: usize| place(dish.on_plate[variant]) == Some(part);
            let made: f64 = recipe.iter().enumerate().filter(|(v, _)| is_it(*v)).map(|(_, r)| r).sum();
            on_plate[part] += is_wanted * p * of((made, 1.0 - made)) / total;
        }
    }
    after[1] = on_plate;
    Some(after)
}

/// Repeated draws of a categorical distribution from a Dirichlet, with some values merged into classes.
struct Draw {
    aspect: AspectId,
    /// Class to which each value of the aspect belongs.
    part_of: Vec<usize>,
    means: Vec<f64>,
    precision: f64,
    gammas: DirichletSampler,
    now: Vec<f64>,
}

/// The sampler of a Dirichlet with these means of classes; a class may be empty.
fn gammas(means: &[f64], precision: f64) -> DirichletSampler {
    let alphas: Vec<f64> = means.iter().map(|mean| (precision * mean).max(f64::MIN_POSITIVE)).collect();
    DirichletSampler::new(&alphas)
}

impl Draw {
    fn from_dirichlet(dirichlet: &Dirichlet, aspect: AspectId) -> Draw {
        let means = dirichlet.mean().to_vec();
        let precision = dirichlet.precision();
        let part_of = (0..means.len()).collect();
        Draw { aspect, part_of, now: means.clone(), gammas: gammas(&means, precision), means, precision }
    }

    /// Merges all values for which `is_dull` holds into one class.
    fn lump(&mut self, is_dull: impl Fn(usize) -> bool) {
        let mut means = vec![0.0];
        for value in 0..self.part_of.len() {
            self.part_of[value] = if is_dull(value) { 0 } else { means.len() };
            match is_dull(value) {
                true => means[0] += self.means[value],
                false => means.push(self.means[value]),
            }
        }
        self.now.clone_from(&means);
        self.gammas = gammas(&means, self.precision);
        self.means = means;
    }

    fn again(&mut self, random: &mut Stream) {
        self.gammas.draw(random, &mut self.now);
        for (p, mean) in self.now.iter_mut().zip(&self.means) {
            *p = (1.0 - DOUBT) * *p + DOUBT * mean;
        }
    }

    /// The Dirichlet after adding the accumulated change of its moments.
    fn changed(&self, before: &Dirichlet, tally: &Mixture) -> Dirichlet {
        let old = before.mean();
        let share = |value: usize| {
            let part = self.part_of[value];
            let inner = if self.means[part] > 0.0 { old[value] / self.means[part] } else { 0.0 };
            old[value] + tally.mean[part] * inner
        };
        Dirichlet::of_moments((0..old.len()).map(share).collect(), before.second() + tally.second)
    }
}
