//! Sessions with every number at the ends of its range: they run to their end, with a bounded number of samples, and their logs
//! can be read.

use tomcom_core::base::number_range::NumberRange;
use tomcom_core::kitchen::files::LAYOUT_RANGES;
use tomcom_people::wizard::WizardKind;
use tomcom_session::apply::apply;
use tomcom_session::ranges;

use super::{every_setting, folder, set};
use crate::support::*;

/// Each trial ends after so many presses and seconds.
const PRESSES: u32 = 16;
const SECONDS: f64 = 40.0;
/// At most so many samples of the simulated tracker come in a second.
const GAZE_HZ: f64 = 120.0;

/// What of a session these settings matter to, so that not every trial plans communication.
fn in_use(spec: &mut SessionSpec, path: &str) {
    (spec.trial.condition, spec.assistant.shadow) = (Condition::None, ShadowMode::Off);
    if path.starts_with("assistant.") || path.starts_with("human.") {
        spec.trial.condition = Condition::Assistant;
    }
    if path.starts_with("wizard.") || path.starts_with("signals.") {
        (spec.trial.condition, spec.wizard.kind) = (Condition::Wizard, WizardKind::Scripted);
    }
    if path.starts_with("human.") {
        (spec.assistant.rollout.rollouts, spec.assistant.rollout.least_rollouts) = (16, 8);
    }
}

/// Simulates a trial and reads its log.
fn check(name: &str, files: SessionSetup, out: &Path) {
    let spec = files.spec.clone();
    let request = SimulationRequest { files, trials: 1, shard: SimulationShard::WHOLE, out: out.to_path_buf() };
    let figures = simulate(&request, || ()).unwrap_or_else(|error| panic!("{name}: {error}"));
    let recording = Path::new(&figures.recordings[0]);
    let mut log = LogReader::open(recording).unwrap_or_else(|error| panic!("{name}: {error}"));
    let mut session = log.session();
    let (mut samples, mut presses) = (0, 0);
    while let Some(line) = log.next_line().unwrap_or_else(|error| panic!("{name}: {error}")) {
        apply(&mut session, &line.stamped).unwrap_or_else(|error| panic!("{name}: {error}"));
        match &line.stamped.event {
            Event::Gaze(_) => samples += 1,
            Event::Press { .. } => presses += 1,
            Event::Advised(advice) => {
                let most = spec.assistant.rollout.rollouts.max(spec.assistant.rollout.least_rollouts);
                assert!(advice.options.iter().all(|option| option.rollouts as usize <= most), "{name}: {advice:?}");
            }
            _ => {}
        }
    }
    assert!(!log.is_cut(), "{name}: the log has no end");
    assert!(presses <= PRESSES.min(spec.trial.presses), "{name}: {presses} presses");
    let most = (SECONDS.min(spec.trial.seconds) * GAZE_HZ) as u32 + 2;
    assert!(samples <= most, "{name}: {samples} samples");
    fs::remove_dir_all(out).expect("the recordings can be removed");
}

/// A session of some presses with this number of a session file.
fn check_end(range: &NumberRange, value: f64, folder: &Path) {
    if range.path.starts_with("assistant.concept.") {
        // External concepts have tests of their own.
        return;
    }
    let mut settings = every_setting();
    set(&mut settings, range.path, number(range, value));
    if !range.path.starts_with("plan.") {
        settings.remove("plan");
    }
    // Two settings of perception exclude each other at their ends, and every block needs as many participants; gaps last from 1 to 5 s.
    let is_refused = ["human.perception.look_alike", "human.perception.anything"].contains(&range.path) && value == 1.0
        || range.path == "plan.block"
        || range.path == "plan.questionnaire.after" && value > 2.0
        || ["participant.population.signal_after_s", "participant.population.reads_signal_s"].contains(&range.path)
            && value > 0.0
        || range.path == "tracker.gaps.shortest_s" && value > 5.0
        || range.path == "tracker.gaps.longest_s" && value < 1.0
        || ["probes.per_trial", "probes.least_inclusion"].contains(&range.path) && value >= 1.0
        || range.path == "tracker.corners";
    let ran = run(&format!("{} = {value}", range.path), range.path, &settings, folder);
    assert!(ran || is_refused, "{} = {value} is refused", range.path);
}

fn number(range: &NumberRange, value: f64) -> toml::Value {
    if range.is_whole { toml::Value::Integer(value as i64) } else { toml::Value::Float(value) }
}

/// Runs a session of some presses with these settings, unless another rule refuses them.
fn run(name: &str, path: &str, settings: &toml::Table, folder: &Path) -> bool {
    let file = folder.join("sessions/end.toml");
    fs::write(&file, toml::to_string(settings).expect("TOML")).expect("a file can be written");
    let Ok(mut files) = read_session(&file) else { return false };
    let spec = &mut files.spec;
    in_use(spec, path);
    spec.robot.arm = ArmKind::Timed;
    spec.trial.presses = spec.trial.presses.min(PRESSES);
    spec.trial.seconds = spec.trial.seconds.min(SECONDS);
    check(name, files, &folder.join("recordings"));
    true
}

#[test]
fn sessions_at_the_ends_of_every_range_run_and_can_be_read() {
    let folder = folder("ends");
    for range in ranges::of_sessions() {
        for value in [range.least, range.most] {
            check_end(&range, value, &folder);
        }
    }
    fs::remove_dir_all(folder).expect("the folder can be removed");
}

/// All numbers of a table at once. Where two numbers exclude each other, one of them stays as it was.
#[test]
fn sessions_with_all_numbers_of_a_table_at_their_ends_run_and_can_be_read() {
    let folder = folder("all-ends");
    let stays = [
        "human.perception.look_alike",
        "human.perception.anything",
        "participant.population.signal_after_s",
        "participant.population.reads_signal_s",
    ];
    let ends: [fn(&NumberRange) -> f64; 2] = [|range| range.least, |range| range.most];
    for table in ["participant.population.", "wizard.", "robot.", "human."] {
        for end in ends {
            let mut settings = every_setting();
            settings.remove("plan");
            for range in ranges::of_sessions().iter().filter(|range| range.path.starts_with(table)) {
                if !stays.contains(&range.path) {
                    set(&mut settings, range.path, number(range, end(range)));
                }
            }
            assert!(run(&format!("all of {table}"), table, &settings, &folder), "all of {table} are refused");
        }
    }
    fs::remove_dir_all(folder).expect("the folder can be removed");
}

#[test]
fn layouts_at_the_ends_of_every_range_run_and_can_be_read() {
    let folder = folder("layouts");
    let layout: toml::Table = fs::read_to_string("layouts/sushi.toml").expect("a layout").parse().expect("TOML");
    let mut ran = 0;
    for range in LAYOUT_RANGES {
        for value in [range.least, range.most] {
            let path = match range.path.strip_prefix("*.") {
                Some(rest) => format!("storage.{}", rest.replacen('*', "button", 1)),
                None => range.path.to_string(),
            };
            let mut changed = layout.clone();
            set(&mut changed, &path, number(&range, value));
            fs::write(folder.join("layouts/sushi.toml"), toml::to_string(&changed).expect("TOML")).expect("a file");
            let session = folder.join("sessions/end.toml");
            let settings = format!(
                "layout = \"../layouts/sushi.toml\"\n[trial]\npresses = {PRESSES}\nseconds = {SECONDS:?}\n[assistant]\nshadow = \"off\"\n"
            );
            fs::write(&session, settings).expect("a file can be written");
            // Places that the arm does not reach, or that are too near to each other, are refused.
            if let Ok(files) = read_session(&session) {
                ran += 1;
                check(&format!("{path} = {value}"), files, &folder.join("recordings"));
            }
        }
    }
    assert!(ran >= 8, "{ran} sessions ran");
    fs::remove_dir_all(folder).expect("the folder can be removed");
}
