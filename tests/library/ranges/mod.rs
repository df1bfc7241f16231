//! Numbers in settings files: each has a range, extremes beyond it are refused where the file is read, and with those within
//! it a session runs and writes a log that its own reader accepts.

mod simulated;

use tomcom::run::files::read_kitchen;
use tomcom_core::base::number_range::{NumberRange, numbers, range_of};
use tomcom_core::kitchen::files::LAYOUT_RANGES;
use tomcom_core::mind::choice::{ChoiceModel, ChoiceParameters};
use tomcom_core::robot::ArmSample;
use tomcom_session::files::read_human_model;
use tomcom_session::log::SimulatedLogState;
use tomcom_session::ranges;

use crate::support::*;

/// A session file that has every setting with a range.
const SETTINGS: &str = r#"
        layout = "../layouts/sushi.toml"
        [trial]
        orders = 3
        pace_s = 2.0
        [robot]
        speed = 0.5
        [tracker]
        corners = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]]
        file_start_s = 1.5
        [tracker.gaps]
        every_s = 10.0
        shortest_s = 1.0
        longest_s = 5.0
        [lsl.gaze]
        name = "tracker"
        x = "x"
        y = "y"
        size = [1920.0, 1080.0]
        [assistant.rollout]
        looks_hz = 1.0
        other_looks_hz = 0.25
        capture = 0.35
        [participant.population]
        keeps_own_recipe = { median = 0.5, sigma = 0.4 }
        misremembers = { median = 0.5, sigma = 0.4 }
        guesses_robot = { median = 0.5, sigma = 0.4 }
        gets_stuck = { median = 0.5, sigma = 0.4 }
        answers_wrong = { median = 0.5, sigma = 0.4 }
        answers_from = 0.4
        answer_s = { median = 2.0, sigma = 0.4 }
        follows_proposal = { median = 0.5, sigma = 0.4 }
        [human.signal]
        follows = 0.5
        highlight_noticed = 0.5
        delay_s = 0.5
        reading_rate_hz = 2.0
        misread = 0.1
        [probes]
        per_trial = 0
        least_questions = 1
        most_questions = 8
        least_inclusion = 0.01
        [console]
        visibility = "state"
        [plan]
        name = "all"
        participants = 2
        conditions = ["none", "wizard"]
        block = 2
        [plan.aims]
        margin = 1.3
        [plan.familiarisation]
        presses = 10
        seconds = 60.0
        orders = 1
        error_rate = 0.3
        [[plan.questionnaire]]
        file = "questionnaires/acceptance.toml"
        after = [1]
    "#;

/// A session file with every setting that is a number.
fn every_setting() -> toml::Table {
    let given: tomcom_session::SessionSpec = toml::from_str(SETTINGS).expect("a session");
    let mut all = toml::Table::try_from(given).expect("settings are TOML");
    let offers = Some(tomcom_people::wizard::OfferReading::default());
    let wizard = tomcom_people::wizard::WizardSpec { offers, ..Default::default() };
    all.insert("wizard".to_string(), toml::Value::try_from(wizard).expect("settings are TOML"));
    let plan = all["plan"].as_table_mut().expect("a plan");
    // Those are written to recordings; a file may leave them out.
    plan.retain(|_, value| value.as_array().is_none_or(|texts| !texts.is_empty()));
    all
}

/// A questionnaire with an item of every kind.
fn questionnaire() -> toml::Table {
    let text = r#"
        name = "all"
        title = "Everything"
        language = "en"
        [scale]
        points = 7
        low = "no"
        high = "yes"
        [scales.frequency]
        points = 5
        low = "never"
        high = "always"
        [[item]]
        id = "difficult"
        text = "It was difficult."
        [[item]]
        id = "age"
        text = "How old are you?"
        kind = "number"
        min = 18
        max = 99
        [[item]]
        id = "remarks"
        text = "What else?"
        kind = "text"
        length = 200
        [[item]]
        id = "effort"
        text = "How much effort was it?"
        kind = "slider"
        low = "none"
        high = "very much"
        step = 5
    "#;
    text.parse().expect("a questionnaire is TOML")
}

/// A folder for the files of a test, empty.
fn folder(name: &str) -> PathBuf {
    let folder = empty_folder(format!("ranges/{name}"));
    for copied in ["layouts", "recipes", "sessions/questionnaires"] {
        fs::create_dir_all(folder.join(copied)).expect("a folder");
        for file in fs::read_dir(copied).expect("a folder of the program") {
            let file = file.expect("a file").path();
            fs::copy(&file, folder.join(&file)).expect("a file can be copied");
        }
    }
    folder
}

/// Whether there is a number of this path.
fn has(table: &toml::Table, path: &str) -> bool {
    numbers(table, "").expect("numbers").iter().any(|(known, _)| known == path)
}

/// Sets the number of this path: of a list of tables in the first that has it, of all numbers of a list the first. `*` is
/// the first table.
fn set(table: &mut toml::Table, path: &str, value: toml::Value) {
    let (name, rest) = path.split_once('.').map_or((path, None), |(name, rest)| (name, Some(rest)));
    let name = match name {
        "*" => table.iter().find(|(_, inner)| inner.is_table()).expect("a table").0.clone(),
        name => name.to_string(),
    };
    let place = table.get_mut(&name).unwrap_or_else(|| panic!("no {name} of {path}"));
    match (place, rest) {
        (toml::Value::Table(inner), Some(rest)) => set(inner, rest, value),
        (toml::Value::Array(tables), Some(rest)) => {
            let has_it = |inner: &&mut toml::Table| has(inner, rest) || inner.contains_key(rest);
            let mut tables = tables.iter_mut().filter_map(toml::Value::as_table_mut);
            set(tables.find(has_it).unwrap_or_else(|| panic!("no table with {rest}")), rest, value);
        }
        (toml::Value::Array(numbers), None) => set_first(numbers, value),
        (place, None) => *place = value,
        // A concept is named, or a program with settings of its own.
        (place @ toml::Value::String(_), Some("wait_s")) => {
            let concept = [("external".to_string(), "true".into()), ("wait_s".to_string(), value)];
            *place = toml::Value::Table(concept.into_iter().collect());
        }
        (place, Some(_)) => panic!("{path}: {place} is no table"),
    }
}

fn set_first(numbers: &mut [toml::Value], value: toml::Value) {
    match &mut numbers[0] {
        toml::Value::Array(inner) => set_first(inner, value),
        first => *first = value,
    }
}

/// Extremes of a number: 0, below 0, tiny, huge, no number, and just inside and outside of its range.
fn extremes(range: &NumberRange) -> Vec<toml::Value> {
    if range.is_whole {
        let (least, most) = (range.least as i64, range.most as i64);
        let all = [0, -1, i64::MIN, i64::MAX, least - 1, least, least + 1, most - 1, most, most + 1];
        return all.map(toml::Value::Integer).to_vec();
    }
    let (least, most) = (range.least, range.most);
    let beyond = |end: f64, step: f64| end + step * end.abs().max(1e-9) * 1e-6;
    let finite = [0.0, -0.0, -1.0, f64::MIN_POSITIVE, 5e-324, -5e-324, 1e-5, 1e308, -1e308];
    let at_least = [beyond(least, -1.0), least, beyond(least, 1.0).min(most)];
    let at_most = [beyond(most, -1.0).max(least), most, beyond(most, 1.0)];
    let all = finite.into_iter().chain([f64::INFINITY, f64::NEG_INFINITY, f64::NAN]).chain(at_least).chain(at_most);
    all.map(toml::Value::Float).collect()
}

fn as_number(value: &toml::Value) -> f64 {
    match value {
        toml::Value::Integer(number) => *number as f64,
        toml::Value::Float(number) => *number,
        other => panic!("{other} is no number"),
    }
}

/// Every number of a file has a range, and every range a number.
fn check_complete(name: &str, table: &toml::Table, ranges: &[NumberRange]) {
    let numbers = numbers(table, "").expect("numbers");
    assert!(!numbers.is_empty(), "{name} has no numbers");
    for (path, value) in &numbers {
        let range = range_of(ranges, path).unwrap_or_else(|| panic!("{name}: no range for {path} = {value}"));
        assert!(range.holds(*value), "{name}: {path} = {value}, out of {range}");
    }
    for range in ranges {
        let own = std::slice::from_ref(range);
        let is_met = numbers.iter().any(|(path, _)| range_of(own, path).is_some());
        assert!(is_met, "{name}: no number has the path {}", range.path);
    }
}

#[test]
fn every_number_of_every_settings_file_has_a_range() {
    let mut all = every_setting();
    set(&mut all, "assistant.concept.wait_s", 10.0.into());
    check_complete("a session file", &all, &ranges::of_sessions());
    check_complete("a questionnaire", &questionnaire(), ranges::OF_QUESTIONNAIRES);
    for layout in ["sushi", "burger"] {
        let text = fs::read_to_string(format!("layouts/{layout}.toml")).expect("a layout");
        check_complete(layout, &text.parse().expect("a layout is TOML"), &LAYOUT_RANGES);
        let recipes: toml::Table =
            fs::read_to_string(format!("recipes/{layout}.toml")).expect("recipes").parse().expect("recipes are TOML");
        assert!(numbers(&recipes, "").expect("numbers").is_empty(), "recipe files have no numbers");
    }
}

/// The table around a setting, and its name there: "participant.population" and "slip.median".
fn in_table(path: &str) -> (&str, &str) {
    let spread = path.strip_suffix(".median").or(path.strip_suffix(".sigma")).unwrap_or(path);
    let end = spread.rfind('.').unwrap_or(0);
    (&path[..end], path[end..].trim_start_matches('.'))
}

/// `docs/settings.md` has the table; where it does not, the test prints it.
#[test]
fn the_documentation_has_every_range() {
    let page = fs::read_to_string("docs/settings.md").expect("docs/settings.md");
    let mut missing = Vec::new();
    for (title, ranges) in [
        ("Session files", ranges::of_sessions()),
        ("Questionnaires", ranges::OF_QUESTIONNAIRES.to_vec()),
        ("Layouts", LAYOUT_RANGES.to_vec()),
    ] {
        let mut table = "| table | settings | range |\n|---|---|---|\n".to_string();
        let (around, own): (Vec<&str>, Vec<&str>) = ranges.iter().map(|range| in_table(range.path)).unzip();
        let told = |NumberRange { least, most, is_whole, unit, .. }: &NumberRange| {
            let whole = if *is_whole { ", whole" } else { "" };
            format!("{}{whole}", format!("{least} to {most} {unit}").trim_end())
        };
        let all: Vec<usize> = (0..ranges.len()).collect();
        // Settings that follow one another in one table and have one range share a row.
        for row in all.chunk_by(|&one, &next| around[one] == around[next] && told(&ranges[one]) == told(&ranges[next]))
        {
            let names: Vec<String> = row.iter().map(|&at| format!("`{}`", own[at])).collect();
            // The table's name stands in the first of its rows.
            let is_first = row[0] == 0 || around[row[0] - 1] != around[row[0]];
            let around = Some(around[row[0]]).filter(|around| is_first && !around.is_empty());
            let around = around.map_or(String::new(), |around| format!(" `{around}`"));
            table += &format!("|{around} | {} | {} |\n", names.join(" "), told(&ranges[row[0]]));
        }
        let section = page.split("\n## ").find(|section| section.starts_with(title)).unwrap_or_default();
        if !section.contains(&table) {
            missing.push(format!("## {title}\n\n{table}"));
        }
    }
    assert!(missing.is_empty(), "docs/settings.md should have\n\n{}", missing.join("\n"));
}

/// Settings that other rules bound beside their range: together with others, or as multiples of others.
const RULED: [&str; 16] = [
    "perception.look_alike",
    "perception.anything",
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
            Err(told) if is_inside => {
                let is_ruled = RULED.iter().any(|ruled| range.path.ends_with(ruled));
                assert!(is_ruled, "{} = {value} was refused: {told}", range.path);
            }
            Err(told) => {
                let key = range.path.rsplit('.').next().expect("a name");
                let is_type = told.contains("found a number") || told.contains("invalid") || told.contains("wanted");
                let names_it = told.contains(key) || is_type;
                assert!(names_it, "{} = {value} was refused without its name: {told}", range.path);
            }
        }
    }
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
        // This file has no table around its settings.
        let Some(path) = range.path.strip_prefix("human.") else { continue };
        check_extremes(&NumberRange { path, ..range }, &human, &file, || told(read_human_model(&file)));
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
        check_extremes(range, &questionnaire(), &file, || told(read_session(&session)));
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

/// A log with another text in its header.
fn with_header(folder: &Path, wanted: &str, text: &str) -> PathBuf {
    let log = fs::read_to_string("tests/golden/format-3-hand.jsonl").expect("a golden log");
    assert!(log.contains(wanted), "the header has {wanted}");
    let path = folder.join(LOG_NAME);
    fs::write(&path, log.replacen(wanted, text, 1)).expect("a file can be written");
    path
}

#[test]
fn a_header_has_the_numbers_that_files_may_have() {
    let folder = folder("headers");
    let read = |wanted: &str, text: &str| LogReader::open(&with_header(&folder, wanted, text));
    read("\"seconds\":", "\"seconds\":").expect("as it was");
    for (wanted, text, found) in [
        ("\"cost_of_communication\":1.5", "\"cost_of_communication\":1e308", "cost_of_communication = "),
        ("\"tau\":4.0", "\"tau\":0.00001", "tau = 0.00001"),
        ("\"tau\":4.0", "\"tau\":0.0", "tau = 0"),
        ("\"beliefs\":16", "\"beliefs\":0", "beliefs = 0"),
        ("\"shown_s\":4.0", "\"shown_s\":5000.0", "shown_s = 5000"),
        ("\"shown_s\":4.0", "\"shown_s\":-4.0", "shown_s = -4"),
        ("served_shown_s = 2.0", "served_shown_s = 9e9", "served_shown_s = 9000000000"),
        ("\"cost_of_communication\":1.5", "\"cost_of_communication\":1e999", "number out of range"),
        ("x = 0.26,", "x = inf,", "inf"),
    ] {
        let error = format!("{:?}", read(wanted, text).expect_err(text));
        assert!(error.contains(found), "{text}: {error}");
    }
    fs::remove_dir_all(folder).expect("the folder can be removed");
}

/// A caller of the library may have a tau that no file may have: what the planner tabulates is bounded all the same.
#[test]
fn the_weights_of_a_tau_near_0_take_no_more_memory_than_those_of_others() {
    let kitchen = kitchen("sushi");
    for tau in [1e-5, f64::MIN_POSITIVE] {
        let model = ChoiceModel::up_to_draws(&kitchen, &ChoiceParameters { tau, ..ChoiceParameters::default() }, 32);
        assert!(model.tabulated() <= 33 * 33 * 256, "{tau}: {} weights", model.tabulated());
    }
}

#[test]
fn a_number_that_is_not_finite_comes_into_no_log() {
    let folder = folder("finite");
    let header = LogReader::open(Path::new("tests/golden/format-3-hand.jsonl")).expect("a golden log").header;
    let recording = folder.join("recording");
    let begun = SimulatedLogState::open(&recording, &header).expect("a recording can be begun");
    let SimulatedLogState::Begun { mut log, .. } = begun else { panic!("there is no recording yet") };
    let stamped = |seq, event| TimestampedEvent { seq, time: SessionTime::ZERO, event };
    for force_n in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
        let moment = ArmSample { force_n, ..ArmSample::default() };
        let refused = log.append(&stamped(0, Event::RobotMoves(moment))).expect_err("no log can hold it");
        assert!(refused.to_string().contains("not finite"), "{refused}");
    }
    log.append(&stamped(0, Event::SessionEnded)).expect("the log goes on");
    log.flush().expect("the log can be written");
    let mut read = LogReader::open(&recording).expect("the log can be read");
    assert_eq!(read.next_line().expect("a line").expect("an event").stamped, stamped(0, Event::SessionEnded));
    assert!(read.next_line().expect("no more").is_none());
    fs::remove_dir_all(folder).expect("the folder can be removed");
}
