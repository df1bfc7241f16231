//! Simulated participants: pools of them, twins of trials without the signals, and what one trial teaches for the next.

use tomcom_people::participant::SimulatedParticipant;
use tomcom_people::participant::population::{Experience, Population};
use tomcom_study::kept_cost::KeptCost;
use tomcom_study::pass::reading::{self, AnalysisScope};
use tomcom_study::pool::{PoolRequest, simulate};
use tomcom_study::pool::{PoolTrialPair, SimulationPool};
use tomcom_study::trial_statistics::TrialStatistics;

use super::{folder, paper, run};
use crate::support::*;

/// Participants of the pools in these tests, and presses of a trial.
const PERSONS: u32 = 4;
const PRESSES: u32 = 80;

fn pool(files: &SessionSetup, shard: SimulationShard, [arms, unassisted]: [bool; 2]) -> SimulationPool {
    let request = PoolRequest { files: files.clone(), participants: PERSONS, shard, arms, unassisted };
    simulate(&request, Path::new("paper.toml"), || ()).expect("a pool")
}

fn trials(pool: &SimulationPool) -> impl Iterator<Item = &PoolTrialPair> {
    pool.persons.iter().flat_map(|person| &person.trials)
}

#[test]
fn a_pool_has_the_trials_of_the_plan_and_their_unassisted_twins() {
    let files = paper(PRESSES);
    let both = pool(&files, SimulationShard::WHOLE, [true, true]);
    let recorded = run(&files, 2 * u64::from(PERSONS), SimulationShard::WHOLE, &folder("pool"));
    let own = || trials(&both).filter_map(|trial| trial.own.as_ref());
    assert_eq!(own().map(|one| one.errors).sum::<u64>(), recorded.errors);
    assert_eq!(own().map(|one| one.signals).sum::<u64>(), recorded.signals);
    assert_eq!(own().map(|one| one.human_presses).sum::<u64>(), recorded.human_actions);
    assert_eq!(Some(own().map(|one| one.lengths.len() as u64).sum::<u64>()), recorded.beliefs.sequences);
    let study = files.study().expect("a plan");
    for (index, person) in both.persons.iter().enumerate() {
        assert!(person.trials.iter().map(|trial| trial.arm).eq(study.group(index).conditions));
        for trial in &person.trials {
            let (own, twin) = (trial.own.as_ref().expect("simulated"), trial.unassisted.as_ref().expect("simulated"));
            assert_eq!((twin.signals, twin.signal_s), (0, 0.0));
            assert_eq!(own == twin, own.signals == 0, "without a signal it is the same trial");
            assert!(own.signal_s <= own.seconds && (own.signal_s > 0.0) == (own.signals > 0), "{own:?}");
        }
    }
    assert!(own().any(|one| one.signals > 0), "nobody signals");
    let null = pool(&files, SimulationShard::WHOLE, [false, true]);
    assert!(trials(&null).zip(trials(&both)).all(|(one, other)| one.unassisted == other.unassisted));
    assert!(trials(&null).all(|trial| trial.own.is_some() == (trial.arm == StudyArm::None)));
}

#[test]
fn what_cannot_be_simulated_is_told_beforehand() {
    let refused = |files: SessionSetup| {
        let request =
            PoolRequest { files, participants: 2, shard: SimulationShard::WHOLE, arms: true, unassisted: true };
        simulate(&request, Path::new("plan.toml"), || ()).expect_err("refused").to_string()
    };
    let mut person = paper(30);
    person.spec.wizard.kind = tomcom_people::wizard::WizardKind::Person;
    assert!(refused(person).contains("the condition wizard, which would be simulated as none"));
    let mut alone = paper(30);
    alone.spec.plan.as_mut().expect("a plan").conditions = vec![StudyArm::None];
    assert!(refused(alone).contains("a plan with one condition"));
    let mut without = paper(30);
    without.spec.plan = None;
    assert!(refused(without).contains("a session without a plan"));
}

fn analysed(recording: &Path) -> TrialStatistics {
    let scope = AnalysisScope { concepts: true, events: false, raters: None };
    let (_, analysis) =
        reading::read(recording, "one", &scope, &mut KeptCost::default()).expect("readable").expect("no practice");
    analysis.trial
}

/// A proposal of DEV is useful if the twin errs in its next presses, by a slip, too.
#[test]
fn proposals_of_simulated_trials_are_judged_by_the_next_presses() {
    let mut files = session_file("default");
    files.spec.trial.condition = Condition::Assistant;
    (files.spec.trial.presses, files.spec.seed) = (200, 9702);
    (files.spec.assistant.concept, files.spec.assistant.proposed_presses) = (ConceptName::Dev.into(), 2);
    files.spec.robot.arm = ArmKind::Timed;
    let figures = run(&files, 3, SimulationShard::WHOLE, &folder("twins-dev"));
    let trials: Vec<TrialStatistics> =
        figures.recordings.iter().map(|recording| analysed(Path::new(recording))).collect();
    let sum = |of: fn(&TrialStatistics) -> u64| trials.iter().map(of).sum::<u64>();
    let (signals, contents) = (sum(|trial| trial.signals), sum(|trial| trial.signal_contents));
    let useful = sum(|trial| trial.useful_signals.expect("it comes out the same again"));
    assert!(0 < useful && useful < signals, "{useful} of {signals} useful");
    assert!(signals < contents && contents <= 2 * signals, "{signals} proposals of {contents} presses");
    assert!(trials.iter().all(|trial| (trial.acting.concept, trial.acting.parameter) == ("dev", Some(2.0))));
}

/// ToM sends many signals: some of them prevent errors, others are about beliefs that do no harm.
#[test]
fn signals_of_simulated_trials_are_useful_or_useless_and_those_of_trials_that_come_out_otherwise_unknown() {
    let mut files = session_file("default");
    files.spec.trial.condition = Condition::Assistant;
    files.spec.trial.presses = 200;
    files.spec.assistant.concept = ConceptName::Tom.into();
    files.spec.robot.arm = ArmKind::Timed;
    files.spec.seed = 21;
    let figures = run(&files, 3, SimulationShard::WHOLE, &folder("twins"));
    let trials: Vec<TrialStatistics> =
        figures.recordings.iter().map(|recording| analysed(Path::new(recording))).collect();
    let useful: u64 = trials.iter().map(|trial| trial.useful_signals.expect("it comes out the same again")).sum();
    let signals: u64 = trials.iter().map(|trial| trial.signals).sum();
    assert_eq!(signals, figures.signals);
    assert!(0 < useful && useful < signals, "{useful} of {signals} useful");

    // Another participant presses otherwise, as after a change of the program.
    let recording = Path::new(&figures.recordings[0]);
    let log = recording.join(LOG_NAME);
    let text = fs::read_to_string(&log).expect("a log");
    let other = text.replacen("\"seed\":21", "\"seed\":22", 1);
    fs::write(&log, other.replacen(env!("CARGO_PKG_VERSION"), "0.2.9", 1)).expect("written");
    assert_eq!(analysed(recording).useful_signals, None);
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
