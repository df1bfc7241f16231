//! Command `tomcom-research calibrate`: calibrates simulated participants to the rates of the paper. Measures populations
//! over whole studies, and searches for some that agree with it; docs/simulated-participants.md has the steps, the seeds
//! and what came of them. What is printed, and in which order, does not depend on the number of processors.

use std::path::Path;
use std::sync::Arc;

use rand::RngExt;
use serde::Deserialize;
use tomcom_core::base::rng::stream;
use tomcom_core::communication::settings::ShadowMode;
use tomcom_core::kitchen::{Agent, Kitchen};
use tomcom_core::measures::JudgedPress;
use tomcom_core::measures::attribution::ErrorCause;
use tomcom_core::measures::sequences::{sequences, sequences_any_aspect};
use tomcom_people::participant::population::Population;
use tomcom_session::engine::SessionEngine;
use tomcom_session::files::file_error::{FileError, read_text};
use tomcom_session::files::{SessionSetup, read_session};
use tomcom_session::headless;
use tomcom_study::kept_cost::KeptCost;
use tomcom_study::parallel::WorkerPool;

use crate::cli::{Failure, put};

/// The belief parameters that a search varies, with the least and the largest value that it tries.
const PARAMETERS: [(&str, f64, f64); 5] = [
    ("learned", 0.93, 0.965),
    ("half_forgotten", 0.68, 0.78),
    ("insists", 0.93, 0.975),
    ("patience_s", 8.0, 14.0),
    ("takes_hints", 0.012, 0.03),
];
/// Rates of the paper with their standard errors: errors per press of both agents, and the share of belief related ones.
/// The standard errors allow for errors that come in sequences of three.
const ERRORS: (f64, f64) = (587.0 / 8515.0, 0.005);
const RELATED: (f64, f64) = (481.0 / 587.0, 0.028);
/// Errors in a sequence: 481 in 153, of which every one is in a sequence.
const LENGTH: f64 = 481.0 / 153.0;
/// Least mean length of sequences of related errors.
const LEAST_RELATED_LENGTH: f64 = 2.6;
/// Chance of a slip of people who do not slip: a probability may not be 0.
const NEVER: f64 = 0.000_001;

/// Sums over trials.
#[derive(Clone, Debug, Default)]
struct Rates {
    human: f64,
    both: f64,
    errors: f64,
    beliefs: f64,
    planning: f64,
    slips: f64,
    /// Number of sequences of related errors, and of errors in them; the same whatever the aspect.
    related: [f64; 2],
    any: [f64; 2],
    orders: f64,
    seconds: f64,
    regret: f64,
}

impl Rates {
    fn add(&mut self, engine: &SessionEngine) {
        let (session, judged) = (engine.session(), engine.judged());
        let errors = || judged.iter().filter(|press| press.verdict.error);
        let count = |is: fn(&&JudgedPress) -> bool| errors().filter(is).count() as f64;
        self.human += judged.len() as f64;
        self.both += f64::from(session.presses[Agent::Human.index()] + session.presses[Agent::Robot.index()]);
        self.errors += count(|_| true);
        self.beliefs += count(|press| matches!(press.cause, Some(ErrorCause::Belief { .. })));
        self.planning += count(|press| press.cause == Some(ErrorCause::Planning));
        self.slips += count(|press| press.cause == Some(ErrorCause::Slip));
        for (sums, all) in [(&mut self.related, sequences(judged)), (&mut self.any, sequences_any_aspect(judged))] {
            sums[0] += all.len() as f64;
            sums[1] += all.iter().map(|one| f64::from(one.length())).sum::<f64>();
        }
        self.orders += session.served.len() as f64;
        self.seconds += session.trial_clock(session.time).as_secs_f64();
        self.regret += judged.iter().map(|press| f64::from(press.verdict.regret)).sum::<f64>();
    }

    fn merge(&mut self, other: &Rates) {
        let pairs = [
            (&mut self.human, other.human),
            (&mut self.both, other.both),
            (&mut self.errors, other.errors),
            (&mut self.beliefs, other.beliefs),
            (&mut self.planning, other.planning),
            (&mut self.slips, other.slips),
            (&mut self.orders, other.orders),
            (&mut self.seconds, other.seconds),
            (&mut self.regret, other.regret),
        ];
        pairs.into_iter().for_each(|(sum, more)| *sum += more);
        for index in 0..2 {
            self.related[index] += other.related[index];
            self.any[index] += other.any[index];
        }
    }

    fn error_rate(&self) -> f64 {
        self.errors / self.both
    }

    fn related_share(&self) -> f64 {
        self.beliefs / self.errors.max(1.0)
    }

    fn lengths(&self) -> [f64; 2] {
        [self.related, self.any].map(|[count, errors]| errors / count.max(1.0))
    }

    /// Whether the rates agree with the paper's within one standard error, and the paper's length lies where it should.
    fn agrees(&self) -> bool {
        let near = |found: f64, (paper, error): (f64, f64)| (found - paper).abs() <= error;
        let [related, any] = self.lengths();
        let is_between = (LEAST_RELATED_LENGTH..=LENGTH).contains(&related) && LENGTH <= any;
        near(self.error_rate(), ERRORS) && near(self.related_share(), RELATED) && is_between
    }

    fn line(&self) -> String {
        let [related, any] = self.lengths();
        let per_100 = |errors: f64| 100.0 * errors / self.human;
        format!(
            "{:.2} % of all presses, {:.1} % belief related, {related:.2} a sequence (any aspect {any:.2}); per 100 human presses: \
             beliefs {:.2}, planning {:.2}, slips {:.2}; human share {:.2}, {:.1} s and {:.1} presses an order",
            100.0 * self.error_rate(),
            100.0 * self.related_share(),
            per_100(self.beliefs),
            per_100(self.planning),
            per_100(self.slips),
            self.human / self.both,
            self.seconds / self.orders,
            self.both / self.orders,
        )
    }
}

/// A session file with a plan, and its kitchen.
pub(crate) struct Setting {
    files: SessionSetup,
    kitchen: Arc<Kitchen>,
}

impl Setting {
    pub(crate) fn read(path: &Path) -> Result<Setting, Failure> {
        let mut files = read_session(path, None)?;
        if files.spec.plan.is_none() {
            let remedy = "a session file with a [plan], like sessions/paper.toml".to_string();
            return Err(FileError::from_finding(path, "a session without a plan".to_string(), remedy).into());
        }
        // Nobody asks for the estimate, or for advice.
        let inference = &mut files.spec.human.inference;
        (inference.beliefs, inference.states, inference.max_beliefs, inference.predictions) = (1, 1, 1, 1);
        inference.min_effective = 1.0;
        files.spec.assistant.shadow = ShadowMode::Off;
        let kitchen = Arc::new(files.kitchen.kitchen.clone());
        Ok(Setting { files, kitchen })
    }

    fn population(&self) -> Population {
        self.files.spec.participant.population.clone().unwrap_or_default()
    }

    /// A whole study of this population: every participant with every condition. The caches of `kept` serve one trial
    /// after the other.
    fn study(&self, kept: &mut KeptCost, population: &Population, seed: u64) -> Rates {
        let mut files = self.files.clone();
        (files.spec.seed, files.spec.participant.population) = (seed, Some(population.clone()));
        let mut rates = Rates::default();
        let Some(study) = files.study() else { return rates };
        for participant in 0..study.plan.codes().len() {
            for period in 1..=study.plan.conditions.len() as u32 {
                let (spec, trial) = study.simulated(participant, period);
                let cost = kept.take(&self.kitchen);
                let mut engine = SessionEngine::new(self.kitchen.clone(), spec, trial, cost).without_unused_estimate();
                headless::run(&mut engine, |_| ());
                rates.add(&engine);
                kept.keep(&self.kitchen, engine.into_follower().cost);
            }
        }
        rates
    }

    /// Studies with several seeds of each population, on all processors. `tell` gets each population's number and its
    /// studies, in the order of the seeds; the populations come in their order, each as soon as it and those before are done.
    fn studies(
        &self,
        populations: &[Population],
        seeds: &[u64],
        mut tell: impl FnMut(usize, &[Rates]) -> Result<(), Failure>,
    ) -> Result<(), Failure> {
        let workers = WorkerPool::new(KeptCost::default);
        // As many populations are simulated together as are needed to give every processor a study.
        let at_once = rayon::current_num_threads().div_ceil(seeds.len());
        for first in (0..populations.len()).step_by(at_once) {
            let block = first..populations.len().min(first + at_once);
            let items: Vec<(usize, u64)> =
                block.clone().flat_map(|number| seeds.iter().map(move |&seed| (number, seed))).collect();
            let one =
                |kept: &mut KeptCost, &(number, seed): &(usize, u64)| self.study(kept, &populations[number], seed);
            let found = workers.each(&items, one, || ());
            for (number, studies) in block.zip(found.chunks(seeds.len())) {
                tell(number, studies)?;
            }
        }
        Ok(())
    }

    /// Prints the rates of the population with some parameters changed, of each study and of all. `knowing`: of the same
    /// people, who know everything and do not slip.
    pub(crate) fn figures(&self, changes: &[String], knowing: bool, seeds: &[u64]) -> Result<(), Failure> {
        let text = changes.join("\n");
        let vector: toml::Table = text.parse().map_err(|error| wrong_parameters("the changes", &error))?;
        let mut population = with_parameters(&self.population(), &vector)?;
        if knowing {
            let never =
                ["slip", "look_alike_slip", "thoughtless"].map(|name| (name.to_string(), toml::Value::Float(NEVER)));
            population =
                with_parameters(&Population { all_knowing: true, ..population }, &never.into_iter().collect())?;
        }
        self.studies(&[population], seeds, |_, studies| {
            for (seed, rates) in seeds.iter().zip(studies) {
                print(&format!("seed {seed}: {}", rates.line()))?;
            }
            print(&format!("all: {}", together(studies).line()))
        })
    }

    /// Draws vectors of parameters and prints them with their rates; those that do not agree with the paper as comments.
    pub(crate) fn search(&self, count: u64, seeds: &[u64]) -> Result<(), Failure> {
        let vectors: Vec<toml::Table> = (0..count).map(drawn).collect();
        let own = self.population();
        let populations = vectors.iter().map(|vector| with_parameters(&own, vector)).collect::<Result<Vec<_>, _>>()?;
        self.studies(&populations, seeds, |number, studies| {
            let (rates, words) = (together(studies), words(&vectors[number]));
            let found = if rates.agrees() { "[[vector]]\n" } else { "" };
            let told = if found.is_empty() { format!("# {}\n", words.replace('\n', ", ")) } else { words };
            print(&format!("{found}# {number}: {}\n{told}", rates.line()))
        })
    }

    /// Prints the rates of each vector of a file.
    pub(crate) fn each(&self, file: &Path, seeds: &[u64]) -> Result<(), Failure> {
        let accepted: Accepted =
            toml::from_str(&read_text(file)?).map_err(|error| wrong_parameters(&file.display().to_string(), &error))?;
        let own = self.population();
        let applied = accepted.vector.iter().map(|vector| with_parameters(&own, vector));
        let populations = applied.collect::<Result<Vec<_>, _>>()?;
        self.studies(&populations, seeds, |_, studies| print(&together(studies).line()))
    }
}

/// A file of vectors of parameters.
#[derive(Deserialize)]
struct Accepted {
    vector: Vec<toml::Table>,
}

fn wrong_parameters(place: &str, error: &toml::de::Error) -> Failure {
    let help = "parameters of a population, such as slip = 0.01; a file of vectors like sessions/people/accepted.toml";
    Failure::Wrong(miette::miette!(help = help, "{place}: found {}", error.message()))
}

/// The rates over several studies.
fn together(studies: &[Rates]) -> Rates {
    let mut all = Rates::default();
    studies.iter().for_each(|rates| all.merge(rates));
    all
}

/// A population with some parameters replaced: numbers, or medians of traits.
fn with_parameters(population: &Population, vector: &toml::Table) -> Result<Population, Failure> {
    let wrong = |error: &toml::de::Error| wrong_parameters("a population", error);
    let mut table = toml::Table::try_from(population).map_err(|error| Failure::Failed(miette::miette!("{error}")))?;
    for (name, value) in vector {
        match table.get_mut(name) {
            None => {
                let help = "a parameter of a population, such as slip";
                return Err(Failure::Wrong(miette::miette!(help = help, "found {name}, which is no parameter")));
            }
            Some(toml::Value::Table(spread)) => drop(spread.insert("median".to_string(), value.clone())),
            Some(number) => *number = value.clone(),
        }
    }
    table.try_into().map_err(|error| wrong(&error))
}

/// Draws a vector of belief parameters.
fn drawn(number: u64) -> toml::Table {
    let mut random = stream(0, "calibration", number);
    let value = |least: f64, most: f64, share: f64| (least * (most / least).powf(share) * 1000.0).round() / 1000.0;
    let draw = |(name, least, most): (&str, f64, f64)| {
        (name.to_string(), toml::Value::Float(value(least, most, random.random::<f64>())))
    };
    PARAMETERS.map(draw).into_iter().collect()
}

fn words(vector: &toml::Table) -> String {
    vector.iter().map(|(name, value)| format!("{name} = {value}\n")).collect()
}

/// Prints at once, also into a file, so that an interrupted search keeps what it found.
fn print(text: &str) -> Result<(), Failure> {
    Ok(put(&format!("{text}\n"))?)
}
