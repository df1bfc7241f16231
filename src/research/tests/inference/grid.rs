//! Exact assumed-density filtering where beliefs can be gone through on a grid.
//!
//! A Dirichlet is broken like a stick into independent Beta shares; each of those is put on the nodes of its own Gaussian
//! quadrature (Gauss-Jacobi, by the eigenvalues of its recurrence; Golub and Welsch 1969), which is exact for polynomials.
//! The product of the nodes is the grid, of improbable nodes at most a few at a time: explicit beliefs with weights. An event moves each of them on by the model's
//! equations and weighs it; means and second moments are then sums over the grid. Reading has a closed form.

use std::sync::Arc;

use tomcom_core::base::rng::stream;
use tomcom_core::kitchen::cost_to_go::CostToGo;
use tomcom_core::kitchen::{Agent, AspectId, Kitchen};
use tomcom_core::mind::dirichlet::{Dirichlet, DirichletBelief};
use tomcom_core::mind::filter::unseen::UnknownGazeTimer;
use tomcom_core::mind::model::HumanModel;
use tomcom_core::mind::observation::{Observation, ObservedEvidence};
use tomcom_research::reference::belief_set::ParticleSet;
use tomcom_research::reference::looks::LookTracker;
use tomcom_research::reference::person::Particle;

use super::looks_at_nothing;

/// Largest number of nodes of the grid, …
const MOST_NODES: usize = 40_000;
/// … between these numbers along each open share.
const ALONG: [usize; 2] = [4, 10];
/// A share is rare if the lesser of its two nodes weighs less.
const RARE: f64 = 0.1;

/// A look at a location since the last event: the belief from before it, who had not read it then, and the probability of
/// not having read it since.
struct Look {
    before: Dirichlet,
    unread: f64,
    survived: f64,
}

pub struct GridFilter {
    kitchen: Arc<Kitchen>,
    model: HumanModel,
    /// On the grid, everybody thinks every press of the robot through.
    people: ParticleSet,
    sight: LookTracker,
    presence: UnknownGazeTimer,
    looks: Vec<Look>,
    pub belief: DirichletBelief,
    /// The largest grid so far.
    pub nodes: usize,
}

impl GridFilter {
    pub fn new(kitchen: Arc<Kitchen>, model: HumanModel) -> GridFilter {
        let mut thoughtful = model.clone();
        thoughtful.transition.foresight = 1.0;
        // The grid reads gaze itself, and there is no time without gaze.
        thoughtful.looking = looks_at_nothing().looking;
        let people = ParticleSet::new(kitchen.clone(), thoughtful);
        let belief = people.prior.clone();
        let places = belief.aspects.iter().take(kitchen.locations.len());
        let looks = places.map(|of| Look { before: of.clone(), unread: 1.0, survived: 1.0 }).collect();
        let (sight, presence) = (LookTracker::default(), UnknownGazeTimer::new(&model));
        GridFilter { kitchen, people, model, sight, presence, looks, belief, nodes: 0 }
    }

    pub fn observe(&mut self, observation: &Observation, cost: &mut CostToGo) {
        // Nothing on the grid is left to chance.
        let mut random = stream(0, "unused", 0);
        let now = observation.time;
        match observation.what {
            ObservedEvidence::Gaze { sample, taken } => {
                let perception = &self.model.perception;
                let time = self.presence.sample(&sample, perception.known_share(sample.confidence), taken);
                let known_s = time.known * time.covers_s;
                let glances = self.sight.glances(&self.kitchen, perception, &sample, taken, known_s);
                for glance in glances {
                    let look = &mut self.looks[glance.location.index()];
                    let of = &mut self.belief.aspects[AspectId::of_location(glance.location).index()];
                    if glance.begins {
                        *look = Look { before: of.clone(), unread: 1.0, survived: 1.0 };
                    }
                    look.survived *= 1.0 - glance.chance;
                    let read = look.unread * (1.0 - look.survived);
                    let before = look.before.mean().iter().zip(&glance.reading);
                    let mean = before.map(|(m, c)| (1.0 - read) * m + read * c).collect();
                    *of = Dirichlet::of_moments(mean, (1.0 - read) * look.before.second() + read);
                }
                return;
            }
            ObservedEvidence::Started { state } => {
                self.people.start(now, state, 0, &mut random);
                self.belief = self.people.prior.clone();
                self.sight.show(now, state);
                return;
            }
            ObservedEvidence::Pressed(press) => self.sight.show(now, press.after),
            ObservedEvidence::Displayed { state } => self.sight.show(now, state),
            _ => {}
        }
        let (people, mut weights) = grid(&self.kitchen, &self.belief);
        self.nodes = self.nodes.max(people.len());
        self.people.of = people;
        self.people.doubt.clone_from(&self.belief);
        let likelihoods = self.people.experience(observation, cost, &mut random);
        weights.iter_mut().zip(&likelihoods).for_each(|(weight, p)| *weight *= p);
        let after = self.people.projected(&weights);
        let share = match observation.what {
            ObservedEvidence::Pressed(press) if press.agent == Agent::Robot => self.model.transition.foresight,
            _ => 1.0,
        };
        for (of, after) in self.belief.aspects.iter_mut().zip(&after.aspects) {
            let mean = of.mean().iter().zip(after.mean()).map(|(m, then)| (1.0 - share) * m + share * then).collect();
            *of = Dirichlet::of_moments(mean, (1.0 - share) * of.second() + share * after.second());
        }
        for (look, of) in self.looks.iter_mut().zip(&self.belief.aspects) {
            *look = Look { before: of.clone(), unread: look.unread * look.survived, survived: 1.0 };
        }
    }
}

/// Explicit beliefs on the grid of an estimate, and their weights.
fn grid(kitchen: &Kitchen, belief: &DirichletBelief) -> (Vec<Particle>, Vec<f64>) {
    let mut fixed_below = 1e-7;
    let (supports, axes, at_once) = loop {
        let supports: Vec<Vec<usize>> = belief.aspects.iter().map(|of| support(of, fixed_below)).collect();
        let sticks = sticks(belief, &supports);
        let tries = (ALONG[0]..=ALONG[1]).rev().map(|along| (axes(&sticks, along), 1));
        let tries = std::iter::once((axes(&sticks, ALONG[1]), 2)).chain(tries);
        match tries.into_iter().find(|(axes, at_once)| size(axes, *at_once) <= MOST_NODES) {
            Some((axes, at_once)) => break (supports, axes, at_once),
            None => fixed_below *= 3.0,
        }
    };
    let rare: Vec<usize> = (0..axes.len()).filter(|&axis| axes[axis].is_rare).collect();
    let mut patterns: Vec<Vec<usize>> = vec![Vec::new()];
    patterns.extend(rare.iter().map(|&axis| vec![axis]));
    if at_once == 2 {
        let pairs = rare.iter().enumerate();
        patterns.extend(pairs.flat_map(|(index, &one)| rare[index + 1..].iter().map(move |&other| vec![one, other])));
    }
    let mean: Vec<Vec<f64>> = belief.aspects.iter().map(|of| of.mean().to_vec()).collect();
    let (mut people, mut weights) = (Vec::new(), Vec::new());
    for node in 0..axes.iter().filter(|axis| !axis.is_rare).map(|axis| axis.nodes.len()).product() {
        for pattern in &patterns {
            let mut rest: usize = node;
            let mut weight = 1.0;
            let shares: Vec<f64> = axes
                .iter()
                .enumerate()
                .map(|(index, axis)| {
                    let at = if axis.is_rare {
                        usize::from(pattern.contains(&index))
                    } else {
                        let at = rest % axis.nodes.len();
                        rest /= axis.nodes.len();
                        at
                    };
                    weight *= axis.nodes[at].1;
                    axis.nodes[at].0
                })
                .collect();
            people.push(Particle {
                of: broken(&mean, &supports, &shares),
                read: vec![false; kitchen.locations.len()],
                read_signal: false,
            });
            weights.push(weight);
        }
    }
    (people, weights)
}

/// A share with its nodes; of a rare one the usual node first.
struct Axis {
    nodes: Vec<(f64, f64)>,
    is_rare: bool,
}

/// Distributions with these shares of their sticks; what is not varied is as expected.
fn broken(mean: &[Vec<f64>], supports: &[Vec<usize>], shares: &[f64]) -> Vec<Vec<f64>> {
    let mut of = mean.to_vec();
    let mut shares = shares.iter();
    for (values, support) in of.iter_mut().zip(supports) {
        let mut stick: f64 = support.iter().map(|&value| values[value]).sum();
        let [first @ .., last] = &support[..] else { continue };
        for &value in first {
            let share = shares.next().expect("a share for each value but the last");
            values[value] = share * stick;
            stick *= 1.0 - share;
        }
        values[*last] = stick;
    }
    of
}

/// The values that are varied, the likeliest last: what it leaves is shared by the others.
fn support(of: &Dirichlet, fixed_below: f64) -> Vec<usize> {
    let mut values: Vec<usize> = (0..of.mean().len()).filter(|&value| of.mean()[value] >= fixed_below).collect();
    values.sort_by(|&a, &b| of.mean()[a].total_cmp(&of.mean()[b]));
    values
}

/// The Beta shares that break the sticks: each value's of what the values before it left.
fn sticks(belief: &DirichletBelief, supports: &[Vec<usize>]) -> Vec<(f64, f64)> {
    let mut shares = Vec::new();
    for (of, values) in belief.aspects.iter().zip(supports) {
        let mut rest: f64 = values.iter().map(|&value| of.alpha(value)).sum();
        for &value in &values[..values.len() - 1] {
            rest -= of.alpha(value);
            shares.push((of.alpha(value), rest));
        }
    }
    shares
}

/// Nodes for each share, `along` for those that are open.
fn axes(shares: &[(f64, f64)], along: usize) -> Vec<Axis> {
    let axis = |&(a, b): &(f64, f64)| {
        let mut nodes = quadrature(a, b, 2);
        nodes.sort_by(|one, other| other.1.total_cmp(&one.1));
        let deviation = (a * b).sqrt() / ((a + b) * (a + b + 1.0).sqrt());
        match nodes[1].1 < RARE {
            true => Axis { nodes, is_rare: true },
            false if deviation < 0.02 => Axis { nodes: quadrature(a, b, 1), is_rare: false },
            false if deviation < 0.1 => Axis { nodes, is_rare: false },
            false => Axis { nodes: quadrature(a, b, along), is_rare: false },
        }
    };
    shares.iter().map(axis).collect()
}

fn size(axes: &[Axis], at_once: usize) -> usize {
    let open = axes.iter().filter(|axis| !axis.is_rare).map(|axis| axis.nodes.len());
    let rare = axes.iter().filter(|axis| axis.is_rare).count();
    let patterns = if at_once == 2 { 1 + rare + rare * rare.saturating_sub(1) / 2 } else { 1 + rare };
    open.fold(patterns, |size: usize, count| size.saturating_mul(count))
}

/// Nodes and weights of the Gaussian quadrature of Beta(a, b), n of them.
pub fn quadrature(a: f64, b: f64, n: usize) -> Vec<(f64, f64)> {
    // Jacobi polynomials for (1 - t)^p (1 + t)^q on [-1, 1].
    let (p, q) = (b - 1.0, a - 1.0);
    let mut matrix = vec![vec![0.0; n]; n];
    for k in 0..n {
        let s = 2.0 * k as f64 + p + q;
        matrix[k][k] = if k == 0 { (q - p) / (p + q + 2.0) } else { (q * q - p * p) / (s * (s + 2.0)) };
        if k > 0 {
            let kf = k as f64;
            let square = match k {
                1 => 4.0 * (1.0 + p) * (1.0 + q) / ((2.0 + p + q).powi(2) * (3.0 + p + q)),
                _ => 4.0 * kf * (kf + p) * (kf + q) * (kf + p + q) / (s * s * (s + 1.0) * (s - 1.0)),
            };
            matrix[k][k - 1] = square.sqrt();
            matrix[k - 1][k] = square.sqrt();
        }
    }
    let (values, first) = eigen(matrix);
    values.iter().zip(&first).map(|(t, v)| (((1.0 + t) / 2.0).clamp(0.0, 1.0), v * v)).collect()
}

/// Eigenvalues of a symmetric matrix, and the first components of its eigenvectors, by Jacobi's rotations.
fn eigen(mut a: Vec<Vec<f64>>) -> (Vec<f64>, Vec<f64>) {
    let n = a.len();
    let mut v: Vec<Vec<f64>> = (0..n).map(|i| (0..n).map(|j| f64::from(u8::from(i == j))).collect()).collect();
    for _ in 0..100 {
        let off: f64 = (0..n).flat_map(|i| (0..i).map(move |j| (i, j))).map(|(i, j)| a[i][j] * a[i][j]).sum();
        if off < 1e-30 {
            break;
        }
        for p in 0..n {
            for q in p + 1..n {
                if a[p][q].abs() < 1e-300 {
                    continue;
                }
                let theta = (a[q][q] - a[p][p]) / (2.0 * a[p][q]);
                let t = theta.signum() / (theta.abs() + (theta * theta + 1.0).sqrt());
                let t = if theta == 0.0 { 1.0 } else { t };
                let c = 1.0 / (t * t + 1.0).sqrt();
                let s = t * c;
                for row in a.iter_mut() {
                    let (x, y) = (row[p], row[q]);
                    (row[p], row[q]) = (c * x - s * y, s * x + c * y);
                }
                let (rows_p, rows_q) = (a[p].clone(), a[q].clone());
                for k in 0..n {
                    a[p][k] = c * rows_p[k] - s * rows_q[k];
                    a[q][k] = s * rows_p[k] + c * rows_q[k];
                }
                for row in v.iter_mut() {
                    let (x, y) = (row[p], row[q]);
                    (row[p], row[q]) = (c * x - s * y, s * x + c * y);
                }
            }
        }
    }
    ((0..n).map(|i| a[i][i]).collect(), v[0].clone())
}
