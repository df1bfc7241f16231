//! The ideal observer: how well anybody could tell what a simulated participant believes, from gaze, presses and the
//! display of a recording. It knows how simulated participants work, and the population, but not the participant's
//! traits and beliefs. docs/human-model.md has the figures and what limits them.
//!
//! ```sh
//! cargo run --release --example ideal_observer -- 256,512 1 recordings/*
//! ```
//!
//! prints for these numbers of particles, with this seed, how well baseline, estimate and ideal observer tell false
//! beliefs before each press of the human.

use std::error::Error;
use std::path::PathBuf;

use tomcom::kitchen::{AspectKind, Kitchen, LocationId, LocationKind};
use tomcom::run::parallel;

use self::evidence::Evidence;
use self::particles::{Conclusion, ObserverSettings, Passed, observe};
use self::scores::{Case, GroupScores, class};

pub mod evidence;
pub mod particles;
pub mod scores;

/// Probability with which a lasting property of a particle is drawn again at each press.
const VARIES: f64 = 0.01;

/// A group of aspects with its name.
type Group = (&'static str, fn(&Kitchen, usize) -> bool);

/// Groups of aspects: locations are what is at places and in hands, and orders.
const GROUPS: [Group; 4] = [
    ("locations", |kitchen, aspect| !is_recipe(kitchen, aspect)),
    ("  of these, orders", |kitchen, aspect| is_order(kitchen, aspect)),
    ("  of these, places and hands", |kitchen, aspect| !is_recipe(kitchen, aspect) && !is_order(kitchen, aspect)),
    ("recipes", is_recipe),
];

fn is_recipe(kitchen: &Kitchen, aspect: usize) -> bool {
    matches!(kitchen.aspects[aspect].kind, AspectKind::Recipe(_))
}

fn is_order(kitchen: &Kitchen, aspect: usize) -> bool {
    let kind = |location: LocationId| kitchen.location(location).kind;
    matches!(kitchen.aspects[aspect].kind, AspectKind::Location(location) if kind(location) == LocationKind::Order)
}

/// The cases of one aspect, of all presses of a trial.
fn cases(trial: usize, evidence: &Evidence, concluded: &[Conclusion], aspect: usize, particles: usize) -> Vec<Case> {
    let pairs = evidence.intervals.iter().zip(concluded);
    let case = |(interval, conclusion): (&evidence::Interval, &Conclusion)| {
        let since_s = interval.since_change_s.get(aspect).copied().flatten();
        let (p_false, p_wrong) = (conclusion.p_false[aspect], conclusion.p_wrong[aspect]);
        // As many particles say little of what is rarer than one in them.
        let smoothed = (p_false * particles as f64 + 0.5 * p_wrong) / (particles as f64 + 0.5);
        let estimate = &interval.estimate;
        Case {
            trial,
            is_false: interval.held[aspect] < tomcom::measures::sequences::FALSE_BELOW,
            class: class(since_s),
            predicted: [estimate.p_false[aspect], smoothed],
        }
    };
    pairs.map(case).collect()
}

/// What the observer found in some trials.
#[derive(Clone, Debug)]
pub struct Observation {
    /// Number of presses, and of these: with particles that pressed as recorded, with particles that pressed the
    /// recorded button at another time, and with none that did.
    pub presses: [usize; 4],
    /// Scores of each group of aspects, with the group's name.
    pub groups: Vec<(&'static str, GroupScores)>,
}

/// Lets the observer follow these trials.
pub fn follow(trials: &[Evidence], settings: &ObserverSettings) -> Observation {
    let numbered: Vec<(u64, &Evidence)> = (0..).zip(trials).collect();
    let concluded = parallel::each(&numbered, |(trial, evidence)| observe(evidence, *trial, settings), || ());
    let kitchen = &trials[0].kitchen;
    let passed = |rule: Passed| concluded.iter().flatten().filter(|one| one.passed == rule).count();
    let group = |(name, is_in): (&'static str, fn(&Kitchen, usize) -> bool)| {
        let aspects: Vec<usize> = (0..kitchen.aspects.len()).filter(|&aspect| is_in(kitchen, aspect)).collect();
        let of_trial = |(trial, (evidence, concluded)): (usize, (&Evidence, &Vec<Conclusion>))| {
            let one = |&aspect: &usize| cases(trial, evidence, concluded, aspect, settings.particles);
            aspects.iter().flat_map(one).collect::<Vec<Case>>()
        };
        let cases: Vec<Case> = trials.iter().zip(&concluded).enumerate().flat_map(of_trial).collect();
        (name, GroupScores::new(&cases, trials.len(), settings.seed))
    };
    let presses = concluded.iter().map(Vec::len).sum();
    Observation {
        presses: [presses, passed(Passed::Agreed), passed(Passed::OtherTime), passed(Passed::Forced)],
        groups: GROUPS.map(group).into(),
    }
}

/// Reads recordings.
///
/// # Errors
/// The first error of [`evidence::read`].
pub fn read(recordings: &[PathBuf]) -> Result<Vec<Evidence>, Box<dyn Error>> {
    let read = parallel::each(recordings, |path| evidence::read(path), || ());
    Ok(read.into_iter().collect::<Result<Vec<Evidence>, _>>().map_err(|error| error.to_string())?)
}

/// Runs the observer over the recordings of the arguments.
pub fn main() -> Result<(), Box<dyn Error>> {
    let args: Vec<String> = std::env::args().skip(1).collect();
    let [particles, seed, recordings @ ..] = &args[..] else {
        return Err("numbers of particles such as 256,512; a seed; recordings".into());
    };
    if recordings.is_empty() {
        return Err("no recordings".into());
    }
    let counts = particles.split(',').map(str::parse).collect::<Result<Vec<usize>, _>>()?;
    let trials = read(&recordings.iter().map(PathBuf::from).collect::<Vec<PathBuf>>())?;
    for particles in counts {
        let settings = ObserverSettings { particles, seed: seed.parse()?, varies: VARIES };
        let Observation { presses: [presses, agreed, other_time, forced], groups } = follow(&trials, &settings);
        println!(
            "{particles} particles, {presses} presses: {agreed} with particles that agree, {other_time} with the \
             button at another time, {forced} forced"
        );
        groups.iter().for_each(|(name, scores)| scores.print(name));
    }
    Ok(())
}
