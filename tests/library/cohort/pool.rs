//! Pools of simulated participants: their trials are those of the plan, twins are unassisted, and shards make the whole.

use std::path::Path;

use tomcom_session::files::SessionSetup;
use tomcom_session::headless::SimulationShard;
use tomcom_session::study_arm::StudyArm;
use tomcom_study::pool::{PoolRequest, simulate};
use tomcom_study::pool::{PoolTrialPair, SimulationPool};

use super::{folder, paper, run};

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
fn the_shards_of_a_pool_are_the_whole() {
    let files = paper(30);
    let whole = pool(&files, SimulationShard::WHOLE, [true, true]);
    let parts = (1..=3).map(|number| pool(&files, SimulationShard { number, of: 3 }, [true, true])).collect();
    assert_eq!(SimulationPool::joined(parts).expect("the whole"), whole);
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
