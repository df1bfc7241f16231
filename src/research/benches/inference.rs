//! How long inference takes, event by event, on recorded sessions, and how much longer its plain reference takes for the
//! same events on the same machine.

use std::hint::black_box;
use std::path::Path;
use std::sync::Arc;
use std::time::{Duration, Instant};

use tomcom_core::kitchen::cost_to_go::CostToGo;
use tomcom_core::mind::filter::BeliefFilter;
use tomcom_core::mind::model::HumanModel;
use tomcom_core::mind::observation::{Observation, ObservedEvidence};
use tomcom_research::reference::ReferenceFilter;
use tomcom_session::files::read_kitchen;

#[path = "../tests/inference/observed.rs"]
mod observed;

/// Recorded trials a kitchen, and presses of both agents in each.
const TRIALS: u64 = 3;
const PRESSES: u32 = 304;
/// Number of events from the start of each trial in which the reference takes part.
const REFERENCE_EVENTS: usize = 10_000;

/// Times by kind of event.
#[derive(Default)]
struct Times {
    gaze: Vec<Duration>,
    press: Vec<Duration>,
}

impl Times {
    fn add(&mut self, observation: &Observation, took: Duration) {
        match observation.what {
            ObservedEvidence::Gaze { .. } => self.gaze.push(took),
            ObservedEvidence::Pressed(_) => self.press.push(took),
            _ => {}
        }
    }

    fn total(&self) -> f64 {
        self.gaze.iter().chain(&self.press).map(Duration::as_secs_f64).sum()
    }
}

/// Percentiles in microseconds.
fn told(name: &str, mut times: Vec<Duration>) -> String {
    times.sort_unstable();
    let at = |share: f64| times.get((times.len().saturating_sub(1) as f64 * share) as usize);
    let micros = |share| at(share).map_or(0.0, |time| time.as_secs_f64() * 1e6);
    format!(
        "{name} {} events, us: p50 {:.2}, p99 {:.2}, max {:.2}",
        times.len(),
        micros(0.5),
        micros(0.99),
        micros(1.0)
    )
}

/// How long an observation takes; after a press the estimate is read, too.
fn observe(filter: &mut BeliefFilter, observation: &Observation, cost: &mut CostToGo) -> Duration {
    let began = Instant::now();
    filter.observe(observation, cost);
    if let ObservedEvidence::Pressed(_) = observation.what {
        black_box(filter.belief());
    }
    began.elapsed()
}

fn main() {
    for layout in ["layouts/sushi.toml", "layouts/burger.toml"] {
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..").join(layout);
        let kitchen = Arc::new(read_kitchen(&path).expect("the layout loads").kitchen);
        let (mut fast, mut same, mut plain) = (Times::default(), Times::default(), Times::default());
        for seed in 0..TRIALS {
            let observations = observed::recorded(&kitchen, 31 + seed, PRESSES);
            let mut cost = CostToGo::new(kitchen.clone());
            let mut filter = BeliefFilter::new(kitchen.clone(), HumanModel::default(), seed);
            for (index, observation) in observations.iter().enumerate() {
                let took = observe(&mut filter, observation, &mut cost);
                fast.add(observation, took);
                if index < REFERENCE_EVENTS {
                    same.add(observation, took);
                }
            }
            let mut cost = CostToGo::new(kitchen.clone());
            let mut reference = ReferenceFilter::new(kitchen.clone(), HumanModel::default(), seed);
            for observation in observations.iter().take(REFERENCE_EVENTS) {
                let began = Instant::now();
                reference.observe(observation, &mut cost);
                plain.add(observation, began.elapsed());
            }
        }
        let ratio = |plain: &[Duration], fast: &[Duration]| {
            plain.iter().map(Duration::as_secs_f64).sum::<f64>() / fast.iter().map(Duration::as_secs_f64).sum::<f64>()
        };
        println!(
            "{layout}, the first {REFERENCE_EVENTS} events of {TRIALS} trials: reference {:.3} s, filter {:.3} s; ratio {:.1} \
             (gaze {:.1}, presses {:.1})",
            plain.total(),
            same.total(),
            plain.total() / same.total(),
            ratio(&plain.gaze, &same.gaze),
            ratio(&plain.press, &same.press),
        );
        println!("  {}", told("gaze", fast.gaze));
        println!("  {}", told("press", fast.press));
        println!("  {}", told("reference, press", plain.press));
    }
}
