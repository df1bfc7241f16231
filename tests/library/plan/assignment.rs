//! Who comes under which condition with which orders, and what comes next whatever was recorded.

use std::path::Path;

use tomcom::run::plan::{StudyProgress, describe};
use tomcom_session::orders::OrderList;
use tomcom_session::plan::{
    NextRecording, ParticipantProgress, Participants, PhaseStand, PlanRecording, RecordingOutcome, Study,
    orders as orders_of_conditions,
};
use tomcom_session::settings::{BellOccasion, ColourTheme};
use tomcom_session::wall_display::RobotDepiction;

use super::{folder, study};
use crate::support::*;

/// A change of a session's files, with its name.
type NamedChange = (&'static str, fn(&mut SessionSetup));

/// The same questionnaire in another language: only words differ, so that answers are analysed together.
#[test]
fn a_session_asks_in_its_own_language() {
    let folder = folder("language");
    let root = env!("CARGO_MANIFEST_DIR");
    let text = fs::read_to_string("sessions/study.toml").expect("the study of the project");
    let text = text.replace("\"questionnaires/", &format!("\"{root}/sessions/questionnaires/"));
    let text = text.replace("\"tutorials/", &format!("\"{root}/sessions/tutorials/"));
    let text = text.replace("\"../", &format!("\"{root}/"));
    fs::write(folder.join("dutch.toml"), "language = \"nl\"\n").expect("written");
    let in_language = |language: &str| {
        let session = folder.join("session.toml");
        let text = text.replace("[display]\n", &format!("[display]\nlanguage = \"{language}\"\n"));
        fs::write(&session, text).expect("written");
        match read_session(&session) {
            Ok(files) => files.questionnaires.into_iter().next().expect("a questionnaire"),
            Err(error) => panic!("{language}: {error}"),
        }
    };
    let [english, german, dutch] = ["en", "de", "dutch.toml"].map(in_language);
    assert_eq!((english.language.as_str(), german.language.as_str()), ("en", "de"));
    assert_eq!(dutch, english, "what is not there in a language is asked as it stands in the plan");
}

#[test]
fn the_groups_are_balanced_in_every_block_and_belong_to_plan_and_seed() {
    for (conditions, block, orders) in [(2, None, 2), (2, Some(2), 2), (2, Some(6), 2), (1, None, 1)] {
        let study = study(|files| {
            let plan = files.spec.plan.as_mut().expect("a plan");
            plan.participants = Participants::Count(60);
            plan.conditions.truncate(conditions);
            plan.block = block;
        });
        let names: Vec<String> = (0..60).map(|participant| study.group(participant).name).collect();
        for block in names.chunks(block.unwrap_or(2 * orders) as usize) {
            let mut sizes = BTreeMap::new();
            block.iter().for_each(|name| *sizes.entry(name).or_insert(0) += 1);
            assert_eq!(sizes.len(), orders as usize, "{block:?}");
            assert!(sizes.values().all(|&size| size == block.len() / orders as usize), "{block:?}");
        }
        for participant in 0..60 {
            let mut conditions = study.group(participant).conditions;
            conditions.sort_by_key(|condition| condition.name());
            conditions.dedup();
            assert_eq!(conditions.len(), study.plan.conditions.len(), "each condition once");
        }
    }
    let names = |seed: u64, count: u32| {
        let study = study(|files| {
            files.spec.seed = seed;
            files.spec.plan.as_mut().expect("a plan").participants = Participants::Count(count);
        });
        (0..12).map(|participant| study.group(participant).name).collect::<String>()
    };
    assert_eq!(names(1, 12), names(1, 99), "more participants change nobody's group");
    assert!((2..6).any(|seed| names(seed, 12) != names(1, 12)), "another seed, other groups");
}

/// Williams (1949): of any two conditions each follows the other directly in as many orders, and each stands in every place equally often.
#[test]
fn the_orders_of_conditions_are_balanced_for_what_a_trial_leaves_to_the_next() {
    for (count, number) in [(1, 1), (2, 2), (3, 6), (4, 4), (5, 10), (6, 6)] {
        let orders = orders_of_conditions(count);
        assert_eq!(orders.len(), number, "{count} conditions");
        let (mut places, mut pairs) = (BTreeMap::new(), BTreeMap::new());
        for order in &orders {
            for (place, &condition) in order.iter().enumerate() {
                *places.entry((place, condition)).or_insert(0) += 1;
            }
            order.windows(2).for_each(|pair| *pairs.entry((pair[0], pair[1])).or_insert(0) += 1);
        }
        assert_eq!(places.len(), count * count, "{orders:?}");
        assert!(places.values().all(|&times| times == number / count), "{orders:?}");
        assert_eq!(pairs.len(), count * (count - 1), "{orders:?}");
        assert!(pairs.values().all(|&times| times == number / count), "{orders:?}");
    }
}

/// The first `count` orders of a recording of the plan.
fn orders(study: &Study, wanted: WantedRecording, menu: usize, count: usize) -> Vec<DishId> {
    let (spec, trial) = study.settings(wanted);
    let mut list = OrderList::new(menu, &spec, trial);
    (0..count).map(|_| list.draw()).collect()
}

#[test]
fn the_trials_of_a_participant_ask_for_the_same_dishes_in_another_order() {
    let study = study(|_| ());
    let sorted = |dishes: &[DishId]| {
        let mut dishes = dishes.to_vec();
        dishes.sort_by_key(|dish| dish.index());
        dishes
    };
    for (menu, run) in [(6, 3), (4, 3), (9, 3)] {
        let mut differ = 0;
        for participant in 0..14 {
            let of = |slot, attempt| WantedRecording { participant, slot, attempt, instructed: true };
            let lists =
                [(1, 1), (2, 1), (1, 2)].map(|(slot, attempt)| orders(&study, of(slot, attempt), menu, 4 * menu));
            for list in &lists[1..] {
                differ += usize::from(list != &lists[0]);
                // At the end of every block, and of every run in it, the same dishes were asked for.
                for end in (menu..=4 * menu).step_by(menu) {
                    assert_eq!(sorted(&list[..end]), sorted(&lists[0][..end]));
                    let first = end - menu + run.min(menu);
                    assert_eq!(sorted(&list[..first]), sorted(&lists[0][..first]), "after {first} of {menu}");
                }
            }
            let block = sorted(&lists[0][..menu]);
            assert_eq!(block.iter().map(|dish| dish.index()).collect::<Vec<_>>(), (0..menu).collect::<Vec<_>>());
        }
        assert!(differ > 25, "of 28 pairs only {differ} differ");
    }
}

#[test]
fn the_digest_covers_all_that_can_change_a_trial_and_nothing_else() {
    let digest = |change: fn(&mut SessionSetup)| study(change).digest;
    let original = digest(|_| ());
    let others: [NamedChange; 19] = [
        ("presses", |files| files.spec.trial.presses += 1),
        ("arm", |files| files.spec.robot.arm = ArmKind::Timed),
        ("signals", |files| files.spec.signals.shown_s += 1.0),
        ("cost", |files| files.spec.assistant.cost_of_communication += 0.1),
        ("what the wizard sees", |files| files.spec.console.visibility = WizardVisibility::Belief),
        ("human model", |files| files.spec.human.decision.tau += 0.1),
        ("display", |files| files.spec.display.intention = true),
        ("reasons of presses without effect", |files| files.spec.display.reasons = false),
        ("sounds of the display", |files| files.spec.display.sound = true),
        ("the clock on the display", |files| files.spec.display.clock = true),
        ("the count on the display", |files| files.spec.display.served = true),
        ("the robot on the display", |files| files.spec.display.arm = RobotDepiction::Arm),
        ("spoken signals", |files| files.spec.display.voice = true),
        ("a page that may be lost", |files| files.spec.display.pause_when_lost = Some(false)),
        ("no tags, which are shown by default", |files| files.spec.display.tags = false),
        ("seed", |files| files.spec.seed += 1),
        ("aims", |files| files.spec.plan.as_mut().expect("a plan").aims.margin += 0.1),
        ("layout", |files| files.kitchen.layout.text.push('\n')),
        ("recipes", |files| files.kitchen.recipes.text.push('\n')),
    ];
    for (what, change) in others {
        assert_ne!(digest(change), original, "{what}");
    }
    let same: [NamedChange; 7] = [
        ("port", |files| files.spec.display.port += 1),
        ("viewer", |files| files.spec.rerun.live = !files.spec.rerun.live),
        ("address of the display", |files| files.spec.display.listen = [0, 0, 0, 0].into()),
        ("bell", |files| files.spec.console.bell.push(BellOccasion::Offer)),
        ("tracker", |files| files.spec.tracker.port += 1),
        ("theme", |files| files.spec.console.theme = ColourTheme::Light),
        ("who takes part", |files| files.spec.participant.kind = ParticipantKind::Keyboard),
    ];
    for (what, change) in same {
        assert_eq!(digest(change), original, "{what}");
    }
}

/// What a recording of P01 might say of itself.
pub fn made(study: &Study, slot: usize, attempt: u32, outcome: RecordingOutcome) -> PlanRecording {
    let (spec, _) = study.settings(WantedRecording { participant: 0, slot, attempt, instructed: slot > 0 });
    let recording = format!("2026-03-14-P01-{slot}{attempt}");
    let step = spec.step.expect("a step of the plan");
    PlanRecording {
        recording,
        code: spec.participant.code,
        recorded_as: None,
        kind: spec.participant.kind,
        step,
        consent: true,
        instructed: true,
        presses: 20,
        stand: PhaseStand::default(),
        waived: None,
        excluded: None,
        answered: BTreeSet::new(),
        outcome,
    }
}

/// Recordings as slot, attempt and outcome.
fn all_made(study: &Study, recorded: &[(usize, u32, RecordingOutcome)]) -> Vec<PlanRecording> {
    recorded.iter().map(|(slot, attempt, outcome)| made(study, *slot, *attempt, outcome.clone())).collect()
}

fn check_next(recorded: &[(usize, u32, RecordingOutcome)], next: NextRecording) {
    let study = study(|_| ());
    let mut all = all_made(&study, recorded);
    let progress =
        |all: &[PlanRecording]| ParticipantProgress::from_recordings(&study, 0, all).expect("recordings of the plan");
    assert_eq!(progress(&all).next, next, "{recorded:?}");
    all.reverse();
    assert_eq!(progress(&all).next, next, "in whatever order they are found");
    assert_eq!(
        ParticipantProgress::from_recordings(&study, 1, &all).expect("another one").next,
        NextRecording::Begin { slot: 0, attempt: 1 }
    );
}

#[test]
fn what_comes_next_follows_from_the_recordings_alone() {
    let done = RecordingOutcome::Complete;
    let void = || RecordingOutcome::Void { reason: "aborted".to_string() };
    let excluded = || RecordingOutcome::Excluded { reason: "tracker off".to_string() };
    let choose = |slot, attempt: u32| NextRecording::Choose {
        recording: format!("2026-03-14-P01-{slot}{}", attempt - 1),
        slot,
        attempt,
    };
    check_next(&[], NextRecording::Begin { slot: 0, attempt: 1 });
    check_next(&[(0, 1, void())], NextRecording::Begin { slot: 0, attempt: 2 });
    check_next(&[(0, 1, RecordingOutcome::Open)], choose(0, 2));
    check_next(&[(0, 1, void()), (0, 2, done.clone())], NextRecording::Begin { slot: 1, attempt: 1 });
    check_next(&[(0, 1, done.clone()), (1, 1, RecordingOutcome::Open)], choose(1, 2));
    check_next(
        &[(0, 1, done.clone()), (1, 1, RecordingOutcome::Open), (1, 2, void())],
        NextRecording::Begin { slot: 1, attempt: 3 },
    );
    check_next(
        &[(0, 1, done.clone()), (1, 1, RecordingOutcome::Open), (1, 2, done.clone())],
        NextRecording::Begin { slot: 2, attempt: 1 },
    );
    check_next(&[(0, 1, done.clone()), (1, 1, excluded())], NextRecording::Begin { slot: 2, attempt: 1 });
    check_next(&[(0, 1, done.clone()), (1, 1, excluded()), (1, 2, RecordingOutcome::Open)], choose(1, 3));
    check_next(&[(0, 1, done.clone()), (1, 1, done.clone()), (2, 1, done)], NextRecording::Finished);
}

#[test]
fn excluded_trials_are_done_and_told_until_they_are_repeated() {
    let study = study(|_| ());
    let excluded = || RecordingOutcome::Excluded { reason: "lights went out".to_string() };
    let progress = |recorded: &[(usize, u32, RecordingOutcome)]| {
        ParticipantProgress::from_recordings(&study, 0, &all_made(&study, recorded)).expect("recordings of the plan")
    };
    let done = RecordingOutcome::Complete;
    let all = [(0, 1, done.clone()), (1, 1, excluded()), (2, 1, done.clone())];
    let mut found = progress(&all);
    assert_eq!(found.next, NextRecording::Finished);
    let named: Vec<(usize, &str)> = found.excluded().map(|(slot, one)| (slot, one.recording.as_str())).collect();
    assert_eq!(named, [(1, "2026-03-14-P01-11")]);
    found.redo(Some(1));
    assert_eq!(found.next, NextRecording::Begin { slot: 1, attempt: 2 });
    let repeated = progress(&[&all[..], &[(1, 2, done)]].concat());
    assert_eq!((repeated.excluded().count(), &repeated.next), (0, &NextRecording::Finished));
}

#[test]
fn recordings_of_another_group_are_told_and_not_mixed_in() {
    let study = study(|_| ());
    let mut other = made(&study, 0, 1, RecordingOutcome::Complete);
    other.step.group = if other.step.group == "AB" { "BA" } else { "AB" }.to_string();
    let told = ParticipantProgress::from_recordings(&study, 0, &[other]).expect_err("another group");
    assert!(told.contains("2026-03-14-P01-01") && told.contains("AB") && told.contains("BA"), "{told}");
}

#[test]
fn practice_has_no_probes_and_may_be_shorter_than_they_need() {
    let study = study(|files| {
        files.spec.probes = Some(toml::from_str("per_trial = 1\napart_s = 60.0").expect("settings of probes"));
        files.spec.plan.as_mut().and_then(|plan| plan.familiarisation.as_mut()).expect("practice").seconds = 60.0;
    });
    let of = |slot| study.settings(WantedRecording { participant: 0, slot, attempt: 1, instructed: false }).0;
    assert_eq!(of(0).check(), Ok(()), "practice");
    let mut trial = of(1);
    trial.trial.seconds = 60.0;
    assert!(trial.check().is_err_and(|error| error.found.contains("takes 75 s")), "a trial of that length");
}

#[test]
fn the_command_that_goes_on_with_a_rehearsal_says_that_it_is_one() {
    let study = study(|files| files.spec.participant.kind = ParticipantKind::Display);
    let open = PlanRecording { kind: ParticipantKind::Simulated, ..made(&study, 0, 1, RecordingOutcome::Open) };
    let out = folder("rehearsal");
    let mut figures = StudyProgress::from_study(&study, Path::new("plan.toml"), &out, None).expect("an empty folder");
    // A trial that was recorded with the code, and so in the condition, of somebody else.
    let planned = study.slots(0)[1].condition;
    let other = if planned == StudyArm::None { StudyArm::Wizard } else { StudyArm::None };
    let mut corrected = made(&study, 1, 1, RecordingOutcome::Complete);
    (corrected.recorded_as, corrected.step.arm) = (Some("P02".to_string()), Some(other));
    let recordings = [corrected, open];
    figures.participants[0] = ParticipantProgress::from_recordings(&study, 0, &recordings).expect("of the plan");
    let told = describe(&figures, u16::MAX);
    assert!(told.contains("go on with tomcom operate plan.toml --code P01 --participant simulated --out "), "{told}");
    assert!(told.contains("practice in 2026-03-14-P01-01: open, with a simulated participant\n"), "{told}");
    let (other, planned) = (other.title(), planned.title());
    let words = format!("done, recorded as P02, in the condition {other} (planned: {planned})\n");
    assert!(told.contains(&words), "{told}");
}

/// A name that a terminal breaks cannot be found, nor typed again.
#[test]
fn a_plan_fits_a_narrow_terminal_with_letters_for_its_conditions() {
    let study = session_file("all-arms").study().expect("a plan");
    let figures =
        StudyProgress::from_study(&study, Path::new("plan.toml"), &folder("narrow"), None).expect("an empty folder");
    // The folder's path may be long.
    let figures = StudyProgress { remarks: Vec::new(), ..figures };
    let titles = study.plan.conditions.iter().map(|arm| arm.title());
    let letters: Vec<String> = ('A'..).zip(titles).map(|(letter, title)| format!("{letter}: {title}")).collect();
    let wide = describe(&figures, u16::MAX);
    assert!(!wide.contains(&letters.join(", ")), "{wide}");
    for columns in [60, 80] {
        let told = describe(&figures, columns);
        assert!(told.lines().all(|line| line.chars().count() <= usize::from(columns)), "{told}");
        assert!(told.replace('\n', " ").contains(&letters.join(", ")), "{told}");
        assert_eq!(told.lines().filter(|line| line.contains("done, next: ")).count(), figures.participants.len());
    }
}
