//! Cohorts of simulated participants: scripted wizards, what one trial teaches for the next, parts of a job array, and what
//! was made before.

use std::fs;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use tomcom::base::time::SessionTime;
use tomcom::communication::Sender;
use tomcom::edge::files::{SessionFiles, read_session};
use tomcom::edge::log::{LOG_NAME, LogReader};
use tomcom::kitchen::cost_to_go::CostToGo;
use tomcom::kitchen::{Agent, AspectId, DishId, Kitchen, LocationId};
use tomcom::participant::SimulatedParticipant;
use tomcom::participant::population::{Experience, Population};
use tomcom::run::simulate::{Shard, Simulation, simulate};
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

fn run(files: &SessionFiles, trials: u64, shard: Shard, out: &Path) -> tomcom::run::figures::SimulationFigures {
    let simulation = Simulation { files: files.clone(), trials, shard, out: out.to_path_buf() };
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

impl Length for tomcom::run::figures::SimulationFigures {
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
    let bare = |figures: &tomcom::run::figures::SimulationFigures| tomcom::run::figures::SimulationFigures {
        wall_s: 0.0,
        found: 0,
        ..figures.clone()
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
    let session = Session::new(Arc::new(files.kitchen.kitchen.clone()), spec);
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
