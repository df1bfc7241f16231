//! The update of the estimate by the human's press of a serve button, whose effect depends on plate, order and recipe
//! jointly.
//!
//! An order is served if the plate holds the stack of the ordered dish. With the believed probabilities o(d) that the
//! order is dish d, p(x) that the plate holds x, and r_d(x) that the recipe of d is x, the press is effective with
//! probability sum_d o(d) sum_x p(x) r_d(x). Contents that can be a dish are sampled one by one, all others as one
//! class.

use crate::base::rng::Stream;
use crate::kitchen::{AspectId, DishId, Kitchen, LocationId, OrderContent};
use crate::mind::dirichlet::{Dirichlet, DirichletBelief};

use super::gamma::DirichletSampler;
use super::own_press::DOUBT;

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
    /// Value of the order's aspect when the order wants this dish.
    ordered: usize,
    recipe: AspectId,
    /// Value of the plate's aspect for each variant of this dish's recipe; `None` if the plate cannot hold the variant.
    on_plate: Vec<Option<usize>>,
}

/// Sum of the squares of a distribution's probabilities.
fn square(values: &[f64]) -> f64 {
    values.iter().map(|value| value * value).sum()
}

/// Change of the moments of one state aspect by conditioning, accumulated over draws.
struct Tally {
    mean: Vec<f64>,
    second: f64,
}

impl ServingUpdate {
    /// The update for the human's button that serves this order.
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
        for draw in &mut draw_of[1..2] {
            // Contents of the plate that cannot be a dish form one class.
            draw.lump(|value| !self.dishes.iter().any(|dish| dish.on_plate.contains(&Some(value))));
        }
        let mut tallies: Vec<Tally> = draw_of.iter().map(Draw::tally).collect();
        for _ in 0..draws {
            draw_of.iter_mut().for_each(|draw| draw.again(random));
            let Some(after) = condition(&dishes, &draw_of, effective) else { continue };
            for ((tally, draw), after) in tallies.iter_mut().zip(&draw_of).zip(&after) {
                tally.add(draw, after, 1.0 / draws as f64);
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

    fn tally(&self) -> Tally {
        Tally { mean: vec![0.0; self.means.len()], second: 0.0 }
    }

    /// The Dirichlet after adding the accumulated change of its moments.
    fn changed(&self, before: &Dirichlet, tally: &Tally) -> Dirichlet {
        let old = before.mean();
        let share = |value: usize| {
            let part = self.part_of[value];
            let inner = if self.means[part] > 0.0 { old[value] / self.means[part] } else { 0.0 };
            old[value] + tally.mean[part] * inner
        };
        Dirichlet::of_moments((0..old.len()).map(share).collect(), before.second() + tally.second)
    }
}

impl Tally {
    /// Adds a draw whose conditioned belief is `after`.
    fn add(&mut self, before: &Draw, after: &[f64], weight: f64) {
        for ((mean, now), then) in self.mean.iter_mut().zip(after).zip(&before.now) {
            *mean += weight * (now - then);
        }
        self.second += weight * (square(after) - square(&before.now));
    }
}
