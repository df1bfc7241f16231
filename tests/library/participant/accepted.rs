//! The vectors of belief parameters that the calibration accepted, and the population that was frozen after it.

use std::collections::BTreeMap;
use std::path::Path;

use serde::Deserialize;
use tomcom_session::SessionSpec;
use tomcom_session::files::parse::parse;

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
