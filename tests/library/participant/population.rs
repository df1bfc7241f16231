//! Populations: they err at the rates of people.

use std::collections::BTreeMap;
use std::convert::Infallible;
use std::sync::Arc;

use tomcom_core::kitchen::cost_to_go::CostToGo;
use tomcom_core::kitchen::{Agent, Kitchen};
use tomcom_core::measures::attribution::ErrorCause;
use tomcom_core::measures::sequences::sequences;
use tomcom_session::engine::SessionEngine;
use tomcom_session::headless;
use tomcom_session::{Event, SessionSpec, TimestampedEvent};

use crate::kitchen;

fn settings(seed: u64) -> SessionSpec {
    let text = format!("layout = \"\"\nseed = {seed}\n[trial]\ncondition = \"none\"\n[assistant]\nshadow = \"off\"\n");
    toml::from_str(&text).expect("settings of a session")
}

/// What came of some trials.
#[derive(Debug, Default)]
struct Figures {
    seconds: f64,
    human: usize,
    robot: usize,
    errors: usize,
    related: usize,
    planning: usize,
    /// Lengths of the error sequences.
    sequences: Vec<usize>,
    /// Presses of both agents for each served order.
    per_order: Vec<u32>,
    /// The longest time without a press of anybody, in seconds.
    longest_standstill_s: f64,
    /// Errors by their cause.
    causes: BTreeMap<String, usize>,
    error_share: Vec<f64>,
    wall_s: f64,
}

/// Plays unassisted trials and measures them.
fn play(kitchen: &Arc<Kitchen>, seed: u64, trials: u64) -> Figures {
    let began = std::time::Instant::now();
    let mut figures = Figures::default();
    let cost = CostToGo::new(kitchen.clone());
    for trial in 0..trials {
        let mut engine = SessionEngine::new(kitchen.clone(), settings(seed), trial, cost.clone());
        let mut events: Vec<TimestampedEvent> = Vec::new();
        let keep = |stamped: &TimestampedEvent| {
            if !matches!(stamped.event, Event::Gaze(_)) {
                events.push(stamped.clone());
            }
            Ok::<(), Infallible>(())
        };
        headless::run(&mut engine, keep).unwrap_or_else(|never| match never {});
        measure(&engine, &events, &mut figures);
    }
    figures.wall_s = began.elapsed().as_secs_f64();
    figures
}

fn measure(engine: &SessionEngine, events: &[TimestampedEvent], figures: &mut Figures) {
    let session = engine.session();
    figures.seconds += session.trial_clock(session.time).as_secs_f64();
    figures.robot += session.presses[Agent::Robot.index()] as usize;
    let mut before = 0;
    for served in &session.served {
        figures.per_order.push(served.presses - before);
        before = served.presses;
    }
    let mut last_press = 0.0;
    for stamped in events.iter().filter(|stamped| matches!(stamped.event, Event::Press { .. })) {
        let now = stamped.time.as_secs_f64();
        figures.longest_standstill_s = figures.longest_standstill_s.max(now - last_press);
        last_press = now;
    }
    let judged = engine.judged();
    let errors = || judged.iter().filter(|press| press.verdict.error);
    for press in errors() {
        let name = match press.cause {
            Some(ErrorCause::Belief { target, .. }) => {
                figures.related += 1;
                format!("{target:?}")
            }
            Some(other) => format!("{other:?}"),
            None => "unknown".to_string(),
        };
        *figures.causes.entry(name).or_default() += 1;
    }
    figures.planning += errors().filter(|press| press.cause == Some(ErrorCause::Planning)).count();
    figures.sequences.extend(sequences(judged).iter().map(|one| one.length() as usize));
    figures.human += judged.len();
    figures.errors += errors().count();
    figures.error_share.push(errors().count() as f64 / judged.len().max(1) as f64);
}

impl Figures {
    fn print(&self, title: &str) {
        let mut per_order = self.per_order.clone();
        per_order.sort_unstable();
        let quantile = |q: f64| per_order[((per_order.len() - 1) as f64 * q) as usize];
        let mean_sequence = self.sequences.iter().sum::<usize>() as f64 / self.sequences.len().max(1) as f64;
        let mut shares = self.error_share.clone();
        shares.sort_by(f64::total_cmp);
        println!(
            "{title}: errors {:.1} % of {} human presses ({:.1} to {:.1} %), related {:.0} %, {} sequences of {:.2}; \
             {:.1} orders in 15 min, {} presses each (90 %: {}, most {}); robot {}; human every {:.2} s; \
             standstill {:.1} s; {:.0} s in {:.1} s",
            100.0 * self.errors as f64 / self.human as f64,
            self.human,
            100.0 * shares[0],
            100.0 * shares[shares.len() - 1],
            100.0 * self.related as f64 / self.errors.max(1) as f64,
            self.sequences.len(),
            mean_sequence,
            self.per_order.len() as f64 / self.seconds * 900.0,
            quantile(0.5),
            quantile(0.9),
            quantile(1.0),
            self.robot,
            self.seconds / self.human as f64,
            self.longest_standstill_s,
            self.seconds,
            self.wall_s,
        );
        let mut lengths: BTreeMap<usize, usize> = BTreeMap::new();
        for &length in &self.sequences {
            *lengths.entry(length).or_default() += 1;
        }
        println!("    sequences by length: {lengths:?}");
        for (cause, count) in &self.causes {
            println!("    {count:5} {cause}");
        }
    }
}

/// Bounds for a few trials; they hold with room to spare for many.
fn check(name: &str, seed: u64, trials: u64) {
    let kitchen = kitchen(name);
    let figures = play(&kitchen, seed, trials);
    figures.print(&format!("{name} {seed}"));
    let share = figures.errors as f64 / figures.human as f64;
    assert!((0.04..=0.16).contains(&share), "{share}");
    assert!(figures.per_order.len() as f64 / figures.seconds * 900.0 >= 25.0);
    assert!(figures.related as f64 / figures.errors as f64 > 0.6);
    assert!(figures.longest_standstill_s < 60.0);
    assert_eq!(figures.causes.get("unknown"), None, "every error has a cause");
    assert!(figures.planning > 0 && figures.planning * 5 < figures.errors, "{} of planning", figures.planning);
    let (least, most) = figures.error_share.iter().fold((1.0_f64, 0.0_f64), |(a, b), &x| (a.min(x), b.max(x)));
    assert!(most > 1.3 * least, "individuals differ");
}

#[test]
fn the_default_population_errs_as_people_do_in_sushi() {
    check("sushi", 5, 6);
}

#[test]
fn the_default_population_errs_as_people_do_in_burgers() {
    check("burger", 5, 6);
}
