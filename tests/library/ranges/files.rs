//! Extremes of every number, read from files.

use std::fs;
use std::path::Path;

use tomcom::edge::files::{read_kitchen, read_session};
use tomcom_core::base::number_range::NumberRange;
use tomcom_core::kitchen::files::LAYOUT_RANGES;
use tomcom_session::files::read_human_model;
use tomcom_session::ranges;

use super::{as_number, every_setting, extremes, folder, has, questionnaire, set};

/// Settings that other rules bound beside their range: together with others, or as multiples of others.
const RULED: [&str; 16] = [
    "human.perception.look_alike",
    "human.perception.anything",
    "participant.population.signal_after_s",
    "participant.population.reads_signal_s",
    "tracker.corners",
    "tracker.gaps.shortest_s",
    "tracker.gaps.longest_s",
    "probes.per_trial",
    "probes.least_inclusion",
    "plan.block",
    "plan.questionnaire.after",
    "plan.participants",
    "item.min",
    "item.max",
    "item.step",
    "*.display.w",
];

/// Reads a file with every extreme of this number, and says of which ones it was taken.
fn check_extremes(range: &NumberRange, table: &toml::Table, file: &Path, read: impl Fn() -> Result<(), String>) {
    for value in extremes(range) {
        let mut changed = table.clone();
        set(&mut changed, range.path, value.clone());
        fs::write(file, toml::to_string(&changed).expect("TOML")).expect("a file can be written");
        let (taken, is_inside) = (read(), range.holds(as_number(&value)));
        match &taken {
            Ok(()) => assert!(is_inside, "{} = {value} was taken, out of {range}", range.path),
            Err(told) if is_inside => assert!(is_ruled(range.path), "{} = {value} was refused: {told}", range.path),
            Err(told) => {
                let key = range.path.rsplit('.').next().expect("a name");
                let is_type = told.contains("found a number") || told.contains("invalid") || told.contains("wanted");
                let names_it = told.contains(key) || is_type;
                assert!(names_it, "{} = {value} was refused without its name: {told}", range.path);
            }
        }
    }
}

fn is_ruled(path: &str) -> bool {
    RULED.contains(&path)
}

fn told<T>(read: tomcom_session::files::file_error::FileResult<T>) -> Result<(), String> {
    read.map(drop).map_err(|error| format!("{:?}", miette::Report::new(error)))
}

#[test]
fn a_session_file_with_an_extreme_number_is_refused() {
    let folder = folder("session");
    let file = folder.join("sessions/extreme.toml");
    for range in ranges::of_sessions() {
        check_extremes(&range, &every_setting(), &file, || told(read_session(&file)));
    }
    fs::remove_dir_all(folder).expect("the folder can be removed");
}

#[test]
fn a_file_with_an_extreme_parameter_of_the_human_model_is_refused() {
    let folder = folder("human");
    let file = folder.join("sessions/human.toml");
    let human = every_setting()["human"].as_table().expect("a table").clone();
    for range in ranges::of_sessions() {
        let Some(path) = range.path.strip_prefix("human.") else { continue };
        // Below its path in this file, which has no table around it.
        let inside = NumberRange { path, ..range };
        for value in extremes(&inside) {
            let mut changed = human.clone();
            set(&mut changed, path, value.clone());
            fs::write(&file, toml::to_string(&changed).expect("TOML")).expect("a file can be written");
            let (taken, is_inside) = (told(read_human_model(&file)), range.holds(as_number(&value)));
            assert!(taken.is_ok() == is_inside || (is_inside && is_ruled(range.path)), "{path} = {value}: {taken:?}");
        }
    }
    fs::remove_dir_all(folder).expect("the folder can be removed");
}

#[test]
fn a_questionnaire_with_an_extreme_number_is_refused() {
    let folder = folder("questionnaire");
    let file = folder.join("sessions/questionnaires/extreme.toml");
    let session = folder.join("sessions/asks.toml");
    let mut asks = every_setting();
    let asked = "questionnaires/extreme.toml";
    set(&mut asks, "plan.questionnaire.file", toml::Value::String(asked.to_string()));
    fs::write(&session, toml::to_string(&asks).expect("TOML")).expect("a file can be written");
    for range in ranges::OF_QUESTIONNAIRES {
        check_extremes(&range, &questionnaire(), &file, || told(read_session(&session)));
    }
    fs::remove_dir_all(folder).expect("the folder can be removed");
}

/// Whatever a layout's numbers are, reading it ends in a kitchen or in a message; and beyond a range never in a kitchen.
#[test]
fn a_layout_with_an_extreme_number_is_refused() {
    let folder = folder("layout");
    let file = folder.join("layouts/extreme.toml");
    let layout: toml::Table = fs::read_to_string("layouts/sushi.toml").expect("a layout").parse().expect("TOML");
    for range in LAYOUT_RANGES {
        // In each kind of table that has such a number.
        let kinds = ["order.serve", "hand.trash", "place.button", "process.button", "storage.button", "order", "hand"];
        let kinds = kinds.into_iter().chain(["place", "storage"]);
        let names: Vec<String> = match range.path.strip_prefix("*.") {
            None => vec![range.path.to_string()],
            Some(rest) => kinds
                .filter(|kind| kind.contains('.') == rest.starts_with("*."))
                .map(|kind| format!("{kind}.{}", rest.trim_start_matches("*.")))
                .collect(),
        };
        let mut tried = 0;
        for path in names.iter().filter(|path| has(&layout, path)) {
            tried += 1;
            for value in extremes(&range) {
                let mut changed = layout.clone();
                set(&mut changed, path, value.clone());
                fs::write(&file, toml::to_string(&changed).expect("TOML")).expect("a file can be written");
                let taken = told(read_kitchen(&file));
                let is_inside = range.holds(as_number(&value));
                assert!(is_inside || taken.is_err(), "{path} = {value} was taken, out of {range}");
            }
        }
        assert!(tried > 0, "no number with the path {}", range.path);
    }
    fs::remove_dir_all(folder).expect("the folder can be removed");
}
