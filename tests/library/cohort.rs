//! Cohorts of simulated participants: scripted wizards, what one trial teaches for the next, parts of a job array, and what
//! was made before.

use std::fs;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use miette::Diagnostic;
use tomcom::base::time::SessionTime;
use tomcom::communication::Sender;
use tomcom::edge::files::{SessionFiles, read_session};
use tomcom::edge::forget;
use tomcom::edge::log::codes::{read_all, write};
use tomcom::edge::log::{LOG_NAME, LogReader};
use tomcom::kitchen::cost_to_go::CostToGo;
use tomcom::kitchen::{Agent, AspectId, DishId, Kitchen, LocationId};
use tomcom::measures::coding::{AgreementTable, CauseKind, Code, Codes};
use tomcom::participant::SimulatedParticipant;
use tomcom::participant::population::{Experience, Population};
use tomcom::run::codes::{CodedRecording, CodesSummary, export, import};
use tomcom::run::simulate::{Shard, SimulationRequest, simulate};
use tomcom::run::study::reading::{self, AnalysisScope};
use tomcom::run::sweep::{SweepAxis, TABLE_NAME, sweep, trials};
use tomcom::run::verify::verify;
use tomcom::session::Event;
use tomcom::session::admit::hygiene;
use tomcom::session::settings::Condition;
use tomcom::session::{Session, Stamped};
use tomcom::wizard::ScriptedWizard;
use tomcom::wizard::settings::{WizardKind, WizardSpec};

fn folder(name: &str) -> PathBuf {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("cohort").join(name);
    let _ = fs::remove_dir_all(&folder);
    folder
}

/// The paper's plan with short trials.
fn paper(presses: u32) -> SessionFiles {
    let mut files = read_session(Path::new("sessions/paper.toml")).expect("the paper's session");
    files.spec.trial.presses = presses;
    files
}

fn run(
    files: &SessionFiles,
    trials: u64,
    shard: Shard,
    out: &Path,
) -> tomcom::analysis::trial_summary::SimulationSummary {
    let simulation = SimulationRequest { files: files.clone(), trials, shard, out: out.to_path_buf() };
    simulate(&simulation, || ()).expect("the folder can be written")
}

/// Every file below a folder, with what is in it, by its path there.
fn all_files(folder: &Path) -> Vec<(PathBuf, Vec<u8>)> {
    let mut found = Vec::new();
    for entry in fs::read_dir(folder).expect("a folder").map(|entry| entry.expect("an entry").path()) {
        match entry.is_dir() {
            true => found.extend(all_files(&entry)),
            false => found.push((entry.clone(), fs::read(&entry).expect("a file"))),
        }
    }
    found.sort();
    found
}

fn below(folder: &Path) -> Vec<(PathBuf, Vec<u8>)> {
    let relative = |path: PathBuf| path.strip_prefix(folder).expect("below it").to_path_buf();
    all_files(folder).into_iter().map(|(path, bytes)| (relative(path), bytes)).collect()
}

fn events(recording: &Path) -> (tomcom::session::Header, Vec<Stamped>) {
    let mut log = LogReader::open(recording).expect("a recording");
    let mut all = Vec::new();
    while let Some(line) = log.next_line().expect("an event") {
        all.push(line.stamped);
    }
    (log.header, all)
}

#[test]
fn the_parts_of_a_job_array_are_the_whole_and_have_nothing_in_common() {
    let files = paper(30);
    let (whole, parts) = (folder("whole"), folder("parts"));
    let figures = run(&files, 5, Shard::WHOLE, &whole);
    assert_eq!((figures.trials, figures.found), (5, 0));
    let mut made = Vec::new();
    for number in 1..=3 {
        let part = run(&files, 5, Shard { number, of: 3 }, &parts);
        assert_eq!(part.found, 0, "no part makes what another one made");
        made.extend(part.recordings);
    }
    assert_eq!(made.len(), 5);
    assert!(below(&whole) == below(&parts), "the parts together are the whole, byte for byte");
    let empty = run(&files, 2, Shard { number: 3, of: 3 }, &folder("none"));
    assert_eq!((empty.trials, empty.mean_length()), (0, None), "a part may have nothing to do");
    for text in ["0/3", "4/3", "1", "1/0", "a/b", "-1/2"] {
        assert!(text.parse::<Shard>().is_err(), "{text}");
    }
}

/// Short words for a figure that is asked for above.
trait Length {
    fn mean_length(&self) -> Option<f64>;
}

impl Length for tomcom::analysis::trial_summary::SimulationSummary {
    fn mean_length(&self) -> Option<f64> {
        self.beliefs.mean_sequence_length
    }
}

#[test]
fn a_folder_that_was_begun_is_gone_on_with() {
    let (files, out) = (paper(30), folder("begun"));
    let first = run(&files, 4, Shard::WHOLE, &out);
    let before = below(&out);
    // A kill: one log without its end, one recording that is not there yet.
    let cut = Path::new(&first.recordings[1]).join(LOG_NAME);
    let text = fs::read_to_string(&cut).expect("a log");
    fs::write(&cut, &text[..text.len() * 2 / 3]).expect("written");
    fs::remove_dir_all(&first.recordings[3]).expect("removed");
    let again = run(&files, 4, Shard::WHOLE, &out);
    assert_eq!(again.found, 2, "what is whole is read");
    assert!(below(&out) == before, "and the rest is made as it would have been");
    let bare = |figures: &tomcom::analysis::trial_summary::SimulationSummary| {
        tomcom::analysis::trial_summary::SimulationSummary { wall_s: 0.0, found: 0, ..figures.clone() }
    };
    assert_eq!(bare(&first), bare(&again), "what is read counts as what is made");
}

#[test]
fn a_scripted_wizard_signals_in_its_trials_and_comes_out_the_same_again() {
    let (files, out) = (paper(120), folder("wizard"));
    let figures = run(&files, 4, Shard::WHOLE, &out);
    let mut signals = 0;
    for recording in &figures.recordings {
        let (header, events) = events(Path::new(recording));
        let shown = events.iter().filter(|stamped| matches!(stamped.event, Event::SignalShown { .. }));
        let times: Vec<SessionTime> = shown.clone().map(|stamped| stamped.time).collect();
        let by_wizard = |stamped: &Stamped| matches!(stamped.event, Event::SignalShown { by: Sender::Wizard, .. });
        assert!(shown.clone().all(by_wizard), "{recording}");
        match header.session.trial.condition {
            Condition::Wizard => signals += times.len(),
            _ => assert!(times.is_empty(), "{recording} is unassisted"),
        }
        let rest_s = header.session.wizard.rest_s;
        assert!(times.windows(2).all(|pair| pair[1].secs_since(pair[0]) >= rest_s), "{recording}: {times:?}");
        let found = verify(Path::new(recording)).expect("readable");
        assert!(found.verified, "{recording}: {:?}", found.difference);
    }
    assert!(signals > 0 && signals == figures.signals as usize, "{signals} signals");
    let conditions: Vec<Condition> = figures.conditions.iter().map(|one| one.condition).collect();
    assert_eq!(conditions, [Condition::None, Condition::Wizard]);
}

#[test]
fn a_wizard_who_sees_nothing_says_nothing_and_no_hand_signals_in_its_place() {
    let mut files = paper(120);
    (files.spec.wizard.sees_errors, files.spec.wizard.sees_overlooked) = (0.0, 0.0);
    assert_eq!(run(&files, 2, Shard::WHOLE, &folder("blind")).signals, 0);
    // A wizard who is a person is not there in a simulation.
    files.spec.wizard = WizardSpec { kind: WizardKind::Person, sees_errors: 1.0, ..files.spec.wizard };
    let figures = run(&files, 2, Shard::WHOLE, &folder("person"));
    assert!(figures.conditions.iter().all(|one| one.condition == Condition::None));

    let mut spec = paper(120).spec;
    (spec.trial.condition, spec.plan) = (Condition::Wizard, None);
    let session = Session::new(Arc::new(files.kitchen.kitchen.clone()), spec, 0);
    let (_, signal) = tomcom::communication::signals(&session.kitchen, false).swap_remove(3);
    let event = Event::SignalShown { by: Sender::Wizard, signal, accepted: None };
    let refused = hygiene(&session, SessionTime::ZERO, &event).expect_err("nobody signals beside the script");
    assert!(refused.contains("scripted"), "{refused}");
}

/// What the wizard says about a change that is not looked at, and that is about to mislead.
#[test]
fn a_wizard_tells_what_was_not_looked_at_and_nothing_that_was() {
    let kitchen = Arc::new(paper(1).kitchen.kitchen);
    let spec = WizardSpec {
        kind: WizardKind::Scripted,
        sees_overlooked: 1.0,
        guesses_wrong: 0.0,
        reaction_spread: 0.0,
        ..WizardSpec::default()
    };
    let mut cost = CostToGo::new(kitchen.clone());
    let second = |s: f64| SessionTime::from_secs_f64(s);
    let empty = kitchen.empty_state();
    // The robot puts the rice of an order into the pot: who does not see that fetches rice, too.
    let place = |name: &str| kitchen.location_named(name).expect("a place of the kitchen");
    let (pot, order) = (place("cooking_pot"), kitchen.orders[0]);
    let mut wanted = empty;
    wanted.set_order(order, tomcom::kitchen::OrderContent::Dish(DishId(0)));
    let mut filled = wanted;
    filled.set_content(pot, kitchen.content_named("rice raw").expect("an item"));
    let mut said = |looks: bool| {
        let mut wizard = ScriptedWizard::new(kitchen.clone(), spec.clone(), false, 1, 0);
        wizard.on_trial_start(wanted);
        wizard.on_change(second(1.0), wanted, filled);
        if looks {
            wizard.on_gaze(second(2.0), Some(pot), filled);
            wizard.on_gaze(second(2.0 + spec.look_s), Some(pot), filled);
        } else {
            // A look that is too short, and one elsewhere.
            wizard.on_gaze(second(2.0), Some(pot), filled);
            wizard.on_gaze(second(2.05), Some(LocationId(0)), filled);
        }
        let mut signals = Vec::new();
        while let Some(due) = wizard.next_due() {
            signals.extend(wizard.act(due, filled, &mut cost).map(|signal| (due, signal)));
        }
        signals
    };
    assert_eq!(said(true), []);
    let signals = said(false);
    let [(at, signal)] = &signals[..] else { panic!("one signal: {signals:?}") };
    assert_eq!(signal.target(), "cooking_pot");
    let after_s = at.secs_since(second(1.0));
    assert!((after_s - spec.overlooked_after_s - spec.reaction_s).abs() < 1e-6, "after {after_s} s");
}

#[test]
fn trials_teach_recipes_and_presses_where_the_population_learns() {
    let kitchen: Arc<Kitchen> = Arc::new(paper(1).kitchen.kitchen);
    let known = |population: &Population, trials: u32| {
        let experience = Experience { trials, presses: 200.0 * f64::from(trials) };
        let one = SimulatedParticipant::new(kitchen.clone(), population, 7, 3, 11, experience);
        let empty = kitchen.empty_state();
        let dishes = (0..kitchen.dishes.len()).map(|index| kitchen.aspect_of_dish(DishId(index as u8)));
        let sum: f64 = dishes.map(|dish: AspectId| one.beliefs().p_truth(&kitchen, empty, dish)).sum();
        (sum, one.person().clone())
    };
    let afresh = Population::default();
    assert_eq!(known(&afresh, 0), known(&afresh, 1), "by default a trial teaches nothing for the next one");
    let learns = Population { recipes_gained: 2.0, ..afresh };
    let ((first, before), (second, after)) = (known(&learns, 0), known(&learns, 1));
    assert!(second > first, "{second} after {first}");
    let odds = |p: f64| p / (1.0 - p);
    assert!((odds(after.learned) / odds(before.learned) - 2.0).abs() < 1e-9);
    assert_eq!(after.slip, before.slip, "it is the same person");
    assert!(kitchen.buttons[Agent::Human.index()].len() > 1);
}

/// The errors of one recording, coded by two people: so many pairs of what the one and the other say.
fn coded(pairs: &[(&str, &str, u64)]) -> AgreementTable {
    let code = |text: &str| match text.split_once(' ') {
        Some(("belief", place)) => Code::Belief(place.to_string()),
        _ => Code::new(CauseKind::named(text).expect("a kind"), None).expect("a code"),
    };
    let (mut one, mut other) = (Codes::default(), Codes::default());
    for (a, b, number) in pairs {
        for _ in 0..*number {
            let press = one.0.len() as u64;
            one.0.insert(press, code(a));
            other.0.insert(press, code(b));
        }
    }
    // What only one of them has coded does not count.
    one.0.insert(10_000, Code::Slip);
    let mut table = AgreementTable::default();
    table.add(&one, &other);
    table
}

#[test]
fn kappa_is_that_of_known_tables() {
    // Fleiss, Levin and Paik, "Statistical Methods for Rates and Proportions", 2003, table 18.1: 200 subjects by two
    // raters, agreement .89, kappa .676.
    let rows = [
        ("slip", "slip", 106),
        ("slip", "race", 10),
        ("slip", "other", 4),
        ("race", "slip", 22),
        ("race", "race", 28),
        ("race", "other", 10),
        ("other", "slip", 2),
        ("other", "race", 12),
        ("other", "other", 6),
    ];
    let found = coded(&rows).agreement();
    // By hand: (140/200 - (120*130 + 60*50 + 20*20)/200^2) / (1 - the same).
    let expected = (0.7 - 0.475) / (1.0 - 0.475);
    assert_eq!((found.errors, found.same_cause), (200, 140));
    assert!((found.kappa_cause.expect("a kappa") - expected).abs() < 1e-12, "{found:?}");
    assert_eq!((found.beliefs, found.kappa_aspect), (0, None));

    // Cohen's textbook case of two categories: 20 and 15 agreed, 5 and 10 not: kappa 0.4.
    let two = coded(&[("slip", "slip", 20), ("slip", "other", 5), ("other", "slip", 10), ("other", "other", 15)]);
    assert!((two.agreement().kappa_cause.expect("a kappa") - 0.4).abs() < 1e-12);

    // The aspect is held against only where both see a belief, the cause whatever the aspect.
    let beliefs = coded(&[
        ("belief pot", "belief pot", 20),
        ("belief pot", "belief board", 5),
        ("belief board", "belief pot", 10),
        ("belief board", "belief board", 15),
        ("belief pot", "slip", 3),
    ]);
    let found = beliefs.agreement();
    assert_eq!((found.errors, found.same_cause, found.beliefs, found.same_aspect), (53, 50, 50, 35));
    assert!((found.kappa_aspect.expect("a kappa") - 0.4).abs() < 1e-12);
    assert_eq!(coded(&[("slip", "slip", 9)]).agreement().kappa_cause, None, "who always says the same proves nothing");
}

#[test]
fn codes_are_kept_beside_the_log_and_come_and_go_as_a_table() {
    let out = folder("codes");
    let made = run(&paper(120), 1, Shard::WHOLE, &out);
    let recording = PathBuf::from(&made.recordings[0]);
    let log = fs::read(recording.join(LOG_NAME)).expect("a log");
    let mut coded = vec![CodedRecording::open(&recording).expect("a recording")];
    assert_eq!(coded[0].codable.errors.len() as u64, made.errors);
    let truth = coded[0].known.clone().expect("a simulated participant tells");
    assert_eq!(truth.0.len(), coded[0].codable.errors.len());
    write(&recording, "R1", &truth).expect("written");
    // The second rater takes every belief for a slip.
    let slips = Codes(truth.0.keys().map(|press| (*press, Code::Slip)).collect());
    write(&recording, "R2", &slips).expect("written");
    assert_eq!(read_all(&recording, &coded[0].codable).expect("readable")["R1"], truth);

    coded = vec![CodedRecording::open(&recording).expect("a recording")];
    let figures = CodesSummary::from_recordings(&coded);
    assert_eq!(figures.agreements.len(), 1);
    let right: Vec<(&str, u64)> =
        figures.known.iter().map(|pair| (pair.of.as_str(), pair.agreement.same_cause)).collect();
    let slips_in_truth = truth.0.values().filter(|code| **code == Code::Slip).count() as u64;
    assert_eq!(right, [("R1", made.errors), ("R2", slips_in_truth)]);
    assert_eq!(truth.agreed(&slips).0.len() as u64, figures.agreements[0].agreement.same_cause);

    let table = out.join("codes.csv");
    assert_eq!(export(&coded, &table).expect("written"), 2 * truth.0.len() as u64);
    for rater in ["R1", "R2"] {
        fs::remove_file(recording.join(format!("codes-{rater}.csv"))).expect("removed");
    }
    coded = vec![CodedRecording::open(&recording).expect("a recording")];
    import(&mut coded, &table).expect("its own export");
    assert_eq!(
        read_all(&recording, &coded[0].codable).expect("readable"),
        [("R1".into(), truth), ("R2".into(), slips)].into()
    );
    assert!(fs::read(recording.join(LOG_NAME)).expect("a log") == log, "the log stays as it is");

    let name = recording.file_name().expect("a name").to_string_lossy().into_owned();
    let [first, second] = [0, 1].map(|index| coded[0].codable.errors[index]);
    let right = format!("{name},R3,{second},slip,");
    for (row, found, remedy) in [
        (format!("{name},R1,{first},belief,the_moon"), "the aspect \"the_moon\"", "cooking_pot"),
        (format!("{name},R1,{first},belief,"), "the cause \"belief\" with the aspect \"\"", "location"),
        (format!("{name},R1,{first},slip,plate"), "the cause \"slip\" with the aspect \"plate\"", "none"),
        (format!("{name},R1,{first},hunger,"), "the cause \"hunger\"", "belief, slip, race or other"),
        (format!("{name},R1,1,slip,"), "press 1, which was no error", &format!("the nearest: {first}")),
        (format!("{name},R1,first,slip,"), "the press \"first\"", "number"),
        (format!("{name},R3,{second},race,"), &format!("press {second} again, after line 2"), "one line"),
        (format!("{name},Jane Doe,{first},slip,"), "the rater \"Jane Doe\"", "never a name"),
        (format!("elsewhere,R1,{first},slip,"), "the recording \"elsewhere\"", name.as_str()),
        (format!("{name},R1,{first}"), "found record with 3 fields", "as many fields"),
    ] {
        fs::write(&table, format!("recording,rater,press,cause,aspect\n{right}\n{row}\n")).expect("written");
        let told = import(&mut coded, &table).expect_err(&row);
        let help = told.help().map(|help| help.to_string()).unwrap_or_default();
        let told = told.to_string();
        assert!(told.contains("codes.csv:3:") && told.contains(found) && help.contains(remedy), "{told}; {help}");
    }
    assert!(!recording.join("codes-R3.csv").exists(), "nothing of a table with a wrong row is taken over");

    // The same beside the log, which somebody may have written by hand.
    for (row, found) in [(format!("{first},belief,the_moon"), "the_moon"), ("1,slip,".to_string(), "no error")] {
        fs::write(recording.join("codes-R3.csv"), format!("press,cause,aspect\n{row}\n")).expect("written");
        let told = CodedRecording::open(&recording).expect_err(&row).to_string();
        assert!(told.contains("codes-R3.csv:2:") && told.contains(found), "{told}");
        let extent = AnalysisScope { concepts: false, events: false };
        let told = reading::read(&recording, "one", extent).err().map(|error| error.to_string());
        assert!(told.as_ref().is_some_and(|told| told.contains("codes-R3.csv:2:")), "{told:?}");
    }
}

#[test]
fn a_participant_is_forgotten_everywhere_and_nobody_else() {
    let out = folder("forget");
    run(&paper(10), 4, Shard::WHOLE, &out);
    let is_there = |name: &str| out.join(name).exists();
    let put = |name: &str, text: &str| {
        let path = out.join(name);
        fs::create_dir_all(path.parent().expect("a folder")).expect("made");
        fs::write(path, text).expect("written");
    };
    put("exports/trials.csv", "participant,note\nP01,\"two\nlines\"\nP02,\"of P011\"\nP01,x\n");
    put("exports/clean.csv", "participant\nP02\n");
    put("report.html", "<td>P01</td>");
    put("other.html", "<td>P011</td>");
    put("seed1-P01-2.rrd", "");
    put("study.toml", "participants = [\"P01\"]");
    put("seed1-P01-1/recording.rrd", "");
    put("seed1-P01-1-part2/session.toml", "[participant]\ncode = \"P01\"");
    let found = forget::find(&out, "P01").expect("readable");
    assert_eq!((found.recordings.len(), found.files.len(), found.tables.len()), (3, 2, 1), "{found:?}");
    // Nothing goes while one of the recordings is being written.
    let lock = tomcom::edge::log::RecordingLock::take(&out.join("seed1-P01-2")).expect("a lock");
    assert!(forget::delete(&found, "P01").expect_err("in use").to_string().contains("writes this recording"));
    assert!(is_there("report.html") && is_there("seed1-P01-1"));
    drop(lock);
    forget::delete(&found, "P01").expect("deleted");
    for gone in ["seed1-P01-1", "seed1-P01-2", "seed1-P01-1-part2", "report.html", "seed1-P01-2.rrd"] {
        assert!(!is_there(gone), "{gone}");
    }
    for stays in ["seed1-P02-1", "seed1-P02-2", "other.html", "study.toml", "exports/clean.csv"] {
        assert!(is_there(stays), "{stays}");
    }
    let table = fs::read_to_string(out.join("exports/trials.csv")).expect("a table");
    assert_eq!(table, "participant,note\nP02,\"of P011\"\n");
    assert!(forget::find(&out, "P01").expect("readable").is_empty());
}

#[test]
fn a_sweep_has_a_line_for_every_combination_and_pairs_the_same_trials() {
    let mut files = paper(24);
    (files.spec.plan, files.spec.trial.condition) = (None, Condition::Assistant);
    // Rollouts so few that a debug build is quick.
    (files.spec.assistant.rollout.rollouts, files.spec.assistant.rollout.least_rollouts) = (2, 2);
    let out = folder("sweep");
    let simulation = SimulationRequest { files, trials: 2, shard: Shard::WHOLE, out: out.clone() };
    let axes: Vec<SweepAxis> =
        ["cost=0.1,100", "gaze=on,off"].iter().map(|text| text.parse().expect("an axis")).collect();
    assert_eq!(trials(&simulation, &axes), 10);
    let figures = sweep(&simulation, &axes, || ()).expect("the folder can be written");
    let settings: Vec<String> =
        figures.rows.iter().map(|row| serde_json::to_string(&row.settings).expect("JSON")).collect();
    assert_eq!(settings.len(), 5);
    assert_eq!(settings[0], "{}");
    assert_eq!(settings[2], "{\"cost\":\"0.1\",\"gaze\":\"off\"}");
    for dear in &figures.rows[3..] {
        assert_eq!((dear.signals_per_100, dear.spared_per_100), (0.0, Some(0.0)), "who says nothing changes nothing");
    }
    assert_eq!(figures.rows[0].spared_per_100, None);
    let table = fs::read_to_string(out.join(TABLE_NAME)).expect("a table");
    assert_eq!(table.lines().count(), 6, "{table}");
    assert!(table.starts_with("condition,trials,cost,gaze,errors_per_100,"), "{table}");
    // Without gaze the recording has none, and still comes out the same again.
    let blind = out.join("cost-0.1_gaze-off/seed1-S001");
    let (_, log) = events(&blind);
    assert!(log.iter().all(|stamped| !matches!(stamped.event, Event::Gaze(_))));
    assert!(verify(&blind).expect("readable").verified);
    assert_eq!(sweep(&simulation, &axes, || ()).expect("it is there"), figures, "what is there is read");
    for wrong in ["cost", "cost=", "cost=a", "cost=nan", "horizon=1.5", "gaze=maybe", "colour=red"] {
        assert!(wrong.parse::<SweepAxis>().is_err(), "{wrong}");
    }
    let axis = |text: &str| text.parse::<SweepAxis>().expect("an axis");
    let refused = |axes: &[SweepAxis]| sweep(&simulation, axes, || ()).expect_err("wrong").to_string();
    assert!(refused(&[axis("cost=1"), axis("cost=2")]).contains("cost twice"));
    assert!(refused(&[axis("radius=-1")]).contains("radius_deg = -1"));
}
