//! Participants: populations that err at the rates of people, the vectors that the calibration accepted, and codes.

use serde::Deserialize;
use tomcom_core::measures::attribution::ErrorCause;
use tomcom_session::files::parse::parse;
use tomcom_session::headless;
use tomcom_session::person_code::{differing_in_case, fault, listed, without_seed};

use crate::support::*;

fn settings(seed: u64) -> SessionSpec {
    let text = format!("layout = \"\"\nseed = {seed}\n[trial]\ncondition = \"none\"\n[assistant]\nshadow = \"off\"\n");
    toml::from_str(&text).expect("settings of a session")
}

/// What came of some trials.
#[derive(Debug, Default)]
struct Figures {
    seconds: f64,
    human: usize,
    errors: usize,
    related: usize,
    planning: usize,
    unknown: usize,
    served: usize,
    /// The longest time without a press of anybody, in seconds.
    longest_standstill_s: f64,
    error_share: Vec<f64>,
}

/// Plays unassisted trials and measures them.
fn play(kitchen: &Arc<Kitchen>, seed: u64, trials: u64) -> Figures {
    let mut figures = Figures::default();
    let cost = CostToGo::new(kitchen.clone());
    for trial in 0..trials {
        let mut engine = SessionEngine::new(kitchen.clone(), settings(seed), trial, cost.clone());
        let mut events: Vec<TimestampedEvent> = Vec::new();
        headless::run(&mut engine, |stamped| {
            if !matches!(stamped.event, Event::Gaze(_)) {
                events.push(stamped.clone());
            }
        });
        measure(&engine, &events, &mut figures);
    }
    figures
}

fn measure(engine: &SessionEngine, events: &[TimestampedEvent], figures: &mut Figures) {
    let session = engine.session();
    figures.seconds += session.trial_clock(session.time).as_secs_f64();
    figures.served += session.served.len();
    let mut last_press = 0.0;
    for stamped in events.iter().filter(|stamped| matches!(stamped.event, Event::Press { .. })) {
        let now = stamped.time.as_secs_f64();
        figures.longest_standstill_s = figures.longest_standstill_s.max(now - last_press);
        last_press = now;
    }
    let judged = engine.judged();
    let errors = || judged.iter().filter(|press| press.verdict.error);
    let because =
        |is_it: fn(&ErrorCause) -> bool| errors().filter(|press| press.cause.as_ref().is_some_and(is_it)).count();
    figures.related += because(|cause| matches!(cause, ErrorCause::Belief { .. }));
    figures.planning += because(|cause| *cause == ErrorCause::Planning);
    figures.unknown += errors().filter(|press| press.cause.is_none()).count();
    figures.human += judged.len();
    figures.errors += errors().count();
    figures.error_share.push(errors().count() as f64 / judged.len().max(1) as f64);
}

/// Bounds for a few trials; they hold with room to spare for many.
fn check(name: &str, seed: u64, trials: u64) {
    let kitchen = kitchen(name);
    let figures = play(&kitchen, seed, trials);
    let share = figures.errors as f64 / figures.human as f64;
    assert!((0.04..=0.16).contains(&share), "{share}");
    assert!(figures.served as f64 / figures.seconds * 900.0 >= 25.0);
    assert!(figures.related as f64 / figures.errors as f64 > 0.6, "{figures:?}");
    assert!(figures.longest_standstill_s < 60.0);
    assert_eq!(figures.unknown, 0, "every error has a cause");
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

const PAPER: &str = "sessions/paper.toml";
const ACCEPTED: &str = "sessions/people/accepted.toml";

/// The file of accepted vectors, as the search prints it.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct AcceptedVectors {
    vector: Vec<AcceptedVector>,
}

/// One accepted vector: medians of traits, and a number of the population.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct AcceptedVector {
    learned: f64,
    half_forgotten: f64,
    insists: f64,
    patience_s: f64,
    takes_hints: f64,
}

impl AcceptedVector {
    fn parameters(&self) -> [(&'static str, f64); 5] {
        [
            ("learned", self.learned),
            ("half_forgotten", self.half_forgotten),
            ("insists", self.insists),
            ("patience_s", self.patience_s),
            ("takes_hints", self.takes_hints),
        ]
    }
}

fn accepted() -> Vec<AcceptedVector> {
    let text = std::fs::read_to_string(ACCEPTED).expect("the accepted vectors");
    toml::from_str::<AcceptedVectors>(&text).unwrap_or_else(|error| panic!("{ACCEPTED}: {error}")).vector
}

/// The population of sessions/paper.toml, as a table.
fn paper() -> toml::Table {
    let text = std::fs::read_to_string(PAPER).expect("the paper's session");
    text.parse().unwrap_or_else(|error| panic!("{PAPER}: {error}"))
}

/// The value of a parameter in a session file: a number, or the median of a trait.
fn parameter<'a>(session: &'a mut toml::Table, name: &str) -> &'a mut toml::Value {
    let value = &mut session["participant"]["population"][name];
    if value.is_table() { &mut value["median"] } else { value }
}

#[test]
fn every_accepted_vector_gives_a_population() {
    let vectors = accepted();
    assert_eq!(vectors.len(), 20);
    let own: SessionSpec = parse(Path::new(PAPER), &paper().to_string()).expect("the paper's session");
    let mut frozen = 0;
    for (number, vector) in vectors.iter().enumerate() {
        let mut session = paper();
        for (name, value) in vector.parameters() {
            *parameter(&mut session, name) = toml::Value::Float(value);
        }
        let spec: SessionSpec = parse(Path::new(PAPER), &session.to_string()).unwrap_or_else(|error| panic!("{error}"));
        spec.check().unwrap_or_else(|error| panic!("vector {number}: {error:?}"));
        frozen += usize::from(spec.participant.population == own.participant.population);
    }
    assert_eq!(frozen, 1, "the paper's session has one of the accepted vectors");
}

#[test]
fn the_papers_population_is_the_accepted_vector_nearest_to_the_mean() {
    let vectors = accepted();
    let mut values: BTreeMap<&str, Vec<f64>> = BTreeMap::new();
    vectors.iter().flat_map(AcceptedVector::parameters).for_each(|(name, value)| {
        values.entry(name).or_default().push(value);
    });
    // In standard deviations over the vectors, so that each parameter counts alike.
    let distance = |parameters: [(&str, f64); 5]| {
        let squared = parameters.map(|(name, value)| {
            let (all, count) = (&values[name], values[name].len() as f64);
            let mean = all.iter().sum::<f64>() / count;
            let variance = all.iter().map(|one| (one - mean).powi(2)).sum::<f64>() / (count - 1.0);
            (value - mean).powi(2) / variance
        });
        squared.iter().sum::<f64>()
    };
    let mut session = paper();
    let own = vectors[0].parameters().map(|(name, _)| {
        let value = parameter(&mut session, name).as_float().expect("a number");
        (name, value)
    });
    let least = vectors.iter().map(|vector| distance(vector.parameters())).fold(f64::INFINITY, f64::min);
    assert!((distance(own) - least).abs() < 1e-9, "{} from the mean, the nearest vector {least}", distance(own));
}

/// What pandas 2.3 and R 4 read as missing, as a truth value or as a number, of what has the signs of a code.
const CHANGED: [&str; 24] = [
    "NA", "NaN", "nan", "null", "NULL", "None", "none", "nil", "TRUE", "FALSE", "true", "false", "True", "T", "F",
    "inf", "Inf", "Infinity", "007", "01", "1", "1e5", "0x1F", "-7",
];

#[test]
fn a_code_is_read_as_it_is_by_every_program() {
    for code in CHANGED {
        assert!(fault(code).is_some(), "{code}");
    }
    for code in ["", "_a", "Jane Doe", "é", "P07+", "P.07", "a23456789012345678", "p\u{661}"] {
        assert!(fault(code).is_some(), "{code}");
    }
    for code in ["P07", "S001", "A-1", "b_7", "trial7", "nobody", "human", "NAN1", "a234567890123456", "P", "x"] {
        assert_eq!(fault(code), None, "{code}");
    }
}

#[test]
fn codes_that_differ_in_capital_letters_only_are_found() {
    let others = ["P01", "P07", "R1"];
    assert_eq!(differing_in_case("p07", others), Some("P07"));
    assert_eq!(differing_in_case("P07", others), None);
    assert_eq!(differing_in_case("P08", others), None);
}

#[test]
fn the_seed_before_a_code_is_told_apart() {
    assert_eq!(without_seed("seed7-S001"), Some("S001"));
    assert_eq!(without_seed("seed-S001"), None);
    assert_eq!(without_seed("seedling-7"), None);
}

#[test]
fn only_codes_that_are_numbered_are_listed_as_a_range() {
    let codes = |text: &str| listed(&text.split(' ').map(str::to_string).collect::<Vec<_>>());
    assert_eq!(codes("P01 P02 P03 P04 P05 P06 P07"), "P01 to P07 (7)");
    assert_eq!(codes("P01 P02 P03 P04 P05 P06 P08"), "P01, P02, P03, P04, P05, P06, … (7)");
    assert_eq!(codes("ada P02"), "ada, P02");
}
