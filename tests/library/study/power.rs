//! Studies drawn from pools: what is put in is found as often as it should be, and a pool is the same from shards and on any number of threads.

use rand_distr::{Distribution, Gamma, Normal, Poisson};
use tomcom_session::plan::{PrimaryOutcome, StudyAims, orders};
use tomcom_study::arm_comparison::compare_arms;
use tomcom_study::arm_table::StudyArmTable;
use tomcom_study::charts;
use tomcom_study::drawn_study::{DrawnEffect, SignificanceTestMethod, StudySampler, results, tests};
use tomcom_study::effect::{effect, pairs};
use tomcom_study::files::pool_file::{read_pool, write_pool};
use tomcom_study::pool::{POOL_FORMAT, PoolHeader, PoolTrial, PoolTrialCounts, SimulationPool};
use tomcom_study::power::{
    PowerRequest, PowerSummary, RejectionCount, RejectionShare, describe, least_ratio, measure, ratios,
};
use tomcom_study::tables::trials::HEADLINE;
use tomcom_study::trial_statistics::TrialStatistics;

use super::in_arm;
use crate::support::*;

const TWO: [StudyArm; 2] = [StudyArm::None, StudyArm::Wizard];
const THREE: [StudyArm; 3] = [StudyArm::None, StudyArm::Wizard, StudyArm::TomCom];

fn header(conditions: &[StudyArm], participants: u32, seed: u64) -> PoolHeader {
    PoolHeader {
        pool: POOL_FORMAT,
        program: "test".to_string(),
        plan: "made-up".to_string(),
        digest: "0".to_string(),
        seed,
        participants,
        shard: 1,
        shards: 1,
        conditions: conditions.to_vec(),
        aims: StudyAims::default(),
        arms: true,
        unassisted: true,
    }
}

/// Persons who differ, get better from trial to trial, and err in runs; arms other than the first have this ratio of errors.
fn made_up(conditions: &[StudyArm], participants: u32, ratio: f64, seed: u64) -> SimulationPool {
    let mut random = stream(seed, "made-up pool", 0);
    let (talent, runs) = (Normal::new(0.0, 0.3).expect("a spread"), Gamma::new(6.0, 1.0 / 6.0).expect("a shape"));
    let orders = orders(conditions.len());
    let mut trials = Vec::new();
    for participant in 0..participants {
        let own = f64::exp(talent.sample(&mut random));
        let order = &orders[participant as usize % orders.len()];
        for (index, &condition) in order.iter().enumerate() {
            let planned = conditions[condition];
            let human_presses = random.random_range(120..180);
            let rate = 0.12 * own * 0.9_f64.powi(index as i32) * human_presses as f64 * runs.sample(&mut random);
            let mut counts = |ratio: f64| {
                let errors = Poisson::new(rate * ratio).expect("a mean").sample(&mut random) as u64;
                PoolTrialCounts { human_presses, errors, seconds: 300.0, ..PoolTrialCounts::default() }
            };
            let (unassisted, assisted) = (counts(1.0), counts(ratio));
            let line = |arm: StudyArm, counts: PoolTrialCounts| PoolTrial {
                participant,
                group: order.iter().map(|&index| char::from(b'A' + index as u8)).collect(),
                period: index as u32 + 1,
                planned,
                arm,
                counts,
            };
            if planned != StudyArm::None {
                trials.push(line(planned, assisted));
            }
            trials.push(line(StudyArm::None, unassisted));
        }
    }
    SimulationPool::from_trials(header(conditions, participants, seed), trials).expect("a pool")
}

fn asked(pool: &SimulationPool, sizes: &[usize], studies: u64, effect: DrawnEffect) -> PowerSummary {
    let request = PowerRequest { sizes: sizes.to_vec(), studies, effect };
    measure(&request, pool, Path::new("pool"), || ()).expect("an answer")
}

#[test]
fn a_huge_effect_is_found_and_few_participants_are_needed() {
    let pool = made_up(&TWO, 120, 0.15, 1);
    let found = asked(&pool, &[8, 14], 100, DrawnEffect::AsSimulated);
    assert_eq!(found.needed.len(), 2, "the paper's test, and the contrast of the mixed model");
    assert_eq!(found.needed[0].test.method, SignificanceTestMethod::MixedAnova);
    for needed in &found.needed {
        assert_eq!((needed.participants, needed.surely), (Some(8), Some(8)), "{found:?}");
    }
    let one = found.sizes[1].tests[1];
    assert!(one.found.share > 0.98 && one.found.interval[0] > 0.9, "{one:?}");
    let [few, more] = [0, 1].map(|index| found.sizes[index].tests[1].least_ratio.expect("an effect is found"));
    assert!(few < more && more < 0.8, "more participants find less: {few} and {more}");
    let text = describe(&found);
    let at = |words: &str| text.find(words).unwrap_or_else(|| panic!("{words}: {text}"));
    assert!(
        at("wizard to unassisted, linear mixed model")
            < at("wizard to unassisted, mixed ANOVA (the paper's test, secondary)")
    );
    assert!(text.contains("Of the numbers tried, 8 is the least with a power of 0.8."), "{text}");
    let least = text.split_once("four of five studies find an effect that takes away").map(|(_, least)| least);
    assert!(least.is_some_and(|least| least.contains("or more (interpolated between the effects tried).")), "{text}");
}

/// The interval of 1,000 studies around 5 %, with four standard errors.
#[test]
fn without_an_effect_one_study_in_twenty_finds_one() {
    let pool = made_up(&TWO, 120, 0.4, 2);
    let found = asked(&pool, &[14], 1000, DrawnEffect::Ratio(1.0));
    for one in &found.sizes[0].tests {
        assert!((0.022..=0.078).contains(&one.found.share), "{one:?}");
        assert_eq!(one.least_ratio, None, "no effect is put in");
    }
    assert!(found.is_null() && describe(&found).contains("Without an effect the test finds one in"));
    let three = asked(&made_up(&THREE, 60, 0.4, 3), &[12], 600, DrawnEffect::Ratio(1.0));
    let any = three.sizes[0].any.expect("several contrasts");
    assert!((0.015..=0.085).contains(&any.share), "after Holm's correction: {any:?}");
    assert!(any.rejected_uncorrected > any.rejected, "without it there are more: {any:?}");
    // Every contrast says that it is corrected, and has a line of its own, with its name.
    let (text, picture) = (describe(&three), charts::power(&three));
    let mut lines = BTreeSet::new();
    for (arm, against) in [("wizard", "unassisted"), ("ToM-Com", "unassisted"), ("ToM-Com", "wizard")] {
        let name = format!("{arm} to {against}");
        assert!(
            text.contains(&format!(
                "{name}, linear mixed model (the plan's main comparison), corrected for the number of contrasts (Holm)"
            )),
            "{text}"
        );
        assert!(picture.contains(&format!(">{name}</text>")), "{picture}");
        let points = picture.lines().find(|line| line.contains("<circle") && line.contains(&format!("<title>{name}")));
        lines.extend(points.and_then(|line| line.split('"').nth(1)));
    }
    assert_eq!(lines.len(), 3, "colours: {lines:?}");
}

#[test]
fn tests_of_a_drawn_study_are_those_of_the_analysis() {
    let pool = made_up(&TWO, 40, 0.6, 4);
    let study = StudySampler::new(&pool).expect("persons").study(14, DrawnEffect::AsSimulated, 7);
    assert_eq!(study.len(), 28);
    let trials: Vec<TrialStatistics> = study
        .iter()
        .map(|one| TrialStatistics {
            human_presses: one.presses,
            ..in_arm(format!("P{:02}", one.participant), one.period, one.arm, one.events)
        })
        .collect();
    let found = results(&tests(&TWO), &study);
    let papers = effect(HEADLINE, pairs(&trials, HEADLINE), 1).assistance().expect("a test").p;
    let contrast = compare_arms(&trials).expect("a comparison").contrasts[0];
    assert_eq!(found[0].expect("a test").p, papers);
    assert_eq!(found[1].expect("a contrast").p, contrast.p_holm);
    let methods: Vec<SignificanceTestMethod> = tests(&THREE).iter().map(|test| test.method).collect();
    assert_eq!(methods, [SignificanceTestMethod::LinearMixedModel; 3], "the paper's test is one of two conditions");
    assert_eq!(tests(&[StudyArm::Wizard, StudyArm::TomCom]).len(), 1, "both are assisted");
}

#[test]
fn studies_have_whole_persons_in_balanced_orders_and_a_ratio_takes_events_away() {
    let pool = made_up(&THREE, 60, 0.5, 5);
    let source = StudySampler::new(&pool).expect("persons");
    let study = source.study(12, DrawnEffect::AsSimulated, 0);
    for trials in study.chunk_by(|a, b| a.participant == b.participant) {
        let is_whole = pool.persons.iter().any(|person| {
            person.trials.iter().zip(trials).all(|(trial, drawn)| {
                let own = trial.own.as_ref().expect("simulated");
                (trial.arm, own.errors, own.human_presses) == (drawn.arm, drawn.events, drawn.presses)
            })
        });
        assert!(is_whole && trials.len() == 3, "{trials:?}");
    }
    let firsts = study.iter().filter(|trial| trial.period == 1);
    for arm in THREE {
        assert_eq!(firsts.clone().filter(|trial| trial.arm == arm).count(), 4, "each arm is first equally often");
    }
    let [all, half] = [1.0, 0.5].map(|ratio| source.study(40, DrawnEffect::Ratio(ratio), 3));
    let (mut before, mut after) = (0, 0);
    for (one, less) in all.iter().zip(&half) {
        assert_eq!((one.participant, one.arm, one.presses), (less.participant, less.arm, less.presses));
        match one.arm {
            StudyArm::None => assert_eq!(one.events, less.events, "the reference stays as it is"),
            _ => {
                assert!(less.events <= one.events, "what is kept with a half is kept with one");
                (before, after) = (before + one.events, after + less.events);
            }
        }
    }
    let kept = after as f64 / before as f64;
    assert!((0.42..=0.58).contains(&kept), "{kept}");
    let few = made_up(&THREE, 8, 0.5, 5);
    assert!(StudySampler::new(&few).expect_err("six orders").contains("in the order"));
}

#[test]
fn the_answer_does_not_depend_on_threads_and_its_interval_has_the_pools_error() {
    let pool = made_up(&TWO, 24, 0.6, 6);
    let with_threads = |threads: usize| {
        let threads = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads");
        threads.install(|| asked(&pool, &[10], 100, DrawnEffect::AsSimulated))
    };
    let (one, several) = (with_threads(1), with_threads(3));
    assert_eq!(one, several);
    let counts = |rejected: &[u64]| -> Vec<RejectionCount> {
        let count = |&rejected: &u64| RejectionCount { studies: 25, rejected, uncorrected: rejected, unknown: 0 };
        rejected.iter().map(count).collect()
    };
    let whole = RejectionCount { studies: 1000, rejected: 600, uncorrected: 600, unknown: 0 };
    let [alike, apart] = [[15, 15, 15, 15], [5, 10, 20, 25]].map(|pools| RejectionShare::new(whole, &counts(&pools)));
    // Wilson's interval of 600 of 1,000.
    assert!((alike.interval[0] - 0.5693).abs() < 1e-3 && (alike.interval[1] - 0.6299).abs() < 1e-3, "{alike:?}");
    assert_eq!(alike.pool_sd, 0.0);
    // Variance of .2, .4, .8, 1 between pools, less the mean of their binomial variances.
    let by_hand: f64 = 0.4 / 3.0 - (0.16 + 0.24 + 0.16) / 24.0 / 4.0;
    assert!((apart.pool_sd - by_hand.sqrt()).abs() < 1e-9, "{apart:?}");
    assert!(apart.interval[0] < 0.2 && apart.interval[1] > 0.9, "{apart:?}");
}

#[test]
fn the_least_effect_lies_between_the_ratios_that_were_tried() {
    let share =
        |from: usize| -> Vec<f64> { (0..ratios().len()).map(|index| if index < from { 0.6 } else { 0.9 }).collect() };
    // 0.6 at 0.80, 0.9 at 0.75: 0.8 two thirds of the way.
    let found = least_ratio(&share(4)).expect("found");
    assert!((found - (0.80 - 0.05 * 2.0 / 3.0)).abs() < 1e-9, "{found}");
    assert_eq!(least_ratio(&share(ratios().len())), None);
    assert_eq!(least_ratio(&share(0)), Some(0.95), "the weakest that was tried");
}

fn folder(name: &str) -> PathBuf {
    empty_folder(format!("power/{name}"))
}

#[test]
fn a_pools_file_is_read_as_it_was_written_and_damage_is_told_with_its_line() {
    let (folder, pool) = (folder("file"), made_up(&THREE, 12, 0.5, 7));
    let file = folder.join("pool.jsonl");
    write_pool(&file, &pool).expect("written");
    assert_eq!(read_pool(std::slice::from_ref(&file)).expect("read"), pool);
    write_pool(&file, &pool).expect("a pool takes the place of a pool");
    let text = fs::read_to_string(&file).expect("text");
    let lines: Vec<&str> = text.lines().collect();
    assert_eq!(lines.len(), 1 + 12 * 5, "an unassisted trial is its own twin");
    for (what, edited, says) in [
        ("cut", lines[..20].join("\n"), "without all trials"),
        ("twice", [&lines[..], &lines[1..6]].concat().join("\n"), "participant 0 after 11"),
        (
            "no number",
            text.replacen("\"errors\":", "\"errors\":\"many\",\"x\":", 1),
            "a line that is not a line of a pool",
        ),
        ("future", text.replacen("{\"pool\":1", "{\"pool\":9", 1), "a pool of format 9"),
        ("empty", String::new(), "an empty file"),
    ] {
        fs::write(&file, edited).expect("written");
        let told = read_pool(std::slice::from_ref(&file)).expect_err(what).to_string();
        assert!(told.contains(says) && told.contains("pool.jsonl"), "{what}: {told}");
    }
    fs::write(&file, "notes of somebody").expect("written");
    assert!(write_pool(&file, &pool).is_err(), "a file of somebody else stays");
    assert_eq!(fs::read_to_string(&file).expect("text"), "notes of somebody");
}

#[test]
fn shards_are_joined_in_any_order_and_nothing_else_is() {
    let (folder, pool) = (folder("shards"), made_up(&TWO, 10, 0.5, 8));
    let part = |number: u64| {
        let persons = pool.persons.iter().filter(|person| u64::from(person.participant) % 3 == number - 1).cloned();
        let header = PoolHeader { shard: number, shards: 3, ..pool.header.clone() };
        let file = folder.join(format!("part-{number}.jsonl"));
        write_pool(&file, &SimulationPool { header, persons: persons.collect() }).expect("written");
        file
    };
    let [one, two, three] = [1, 2, 3].map(part);
    assert_eq!(read_pool(&[three.clone(), one.clone(), two.clone()]).expect("the whole"), pool);
    let refused = |files: &[PathBuf]| read_pool(files).expect_err("refused").to_string();
    assert!(refused(&[one.clone(), two.clone()]).contains("7 of 10 participants"));
    assert!(
        refused(&[one.clone(), two.clone(), two.clone(), three])
            .contains("part-2.jsonl: found participant 1, who is in another")
    );
    let other = folder.join("other.jsonl");
    write_pool(&other, &made_up(&TWO, 10, 0.5, 9)).expect("written");
    let dear = write_pool(&other, &pool).expect_err("another pool is there").to_string();
    assert!(dear.contains("not the same pool"), "{dear}");
    assert!(refused(&[one, other]).contains("other.jsonl: found a part of another pool"));
}

#[test]
fn the_table_of_arms_has_the_sums_of_its_trials() {
    let pool = made_up(&THREE, 30, 0.5, 11);
    let table = StudyArmTable::from_pool(&pool);
    assert!(table.arms.iter().map(|row| row.arm).eq(THREE));
    for row in &table.arms {
        let own = || {
            let trials = pool.persons.iter().flat_map(|person| &person.trials).filter(|trial| trial.arm == row.arm);
            trials.filter_map(|trial| trial.own.as_ref())
        };
        let wanted = 100.0 * own().map(|trial| trial.errors).sum::<u64>() as f64
            / own().map(|trial| trial.human_presses).sum::<u64>() as f64;
        let [low, high] = row.errors_per_100.interval.expect("an interval");
        assert_eq!((row.trials, row.errors_per_100.value), (30, Some(wanted)));
        assert!(low < wanted && wanted < high && high - low < wanted, "{row:?}");
        assert_eq!(row.sequence_length.value, None, "there is no sequence");
    }
    assert_eq!(table.comparisons[0].outcome, PrimaryOutcome::Errors);
    let ratio = table.comparisons[0].contrasts[0].ratio;
    assert!((0.4..=0.62).contains(&ratio), "{ratio}");
}
