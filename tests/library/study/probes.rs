//! Probes: weights against the choice of questions, answers against beliefs, accuracies, tables, and what is read from sessions.

use rand::seq::SliceRandom;
use tomcom_core::base::rng::Stream;
use tomcom_core::measures::raters::BeliefSource;
use tomcom_core::mind::RecordedBelief;
use tomcom_session::follower::SessionFollower;
use tomcom_session::headless;
use tomcom_session::probes::{ProbeOrigin, ProbeQuestion, ProbeSubject};
use tomcom_study::analysis::probe_detection::{ProbeDetection, WeightedProbeBelief};
use tomcom_study::analysis::probe_figures::{ProbeAccuracyGrouping, ProbeSummary};
use tomcom_study::analysis::probe_record::{
    AspectAtFreeze, ProbeCollector, ProbeQuestionKind, ProbeResponse, ProbedQuestion, ProbedTrial,
    RecordedBeliefAtFreeze,
};
use tomcom_study::facts::RecordingFacts;
use tomcom_study::report;
use tomcom_study::tables::probe_table::{ProbeRow, probes};
use tomcom_study::tables::trials::PROBES_WRONG;
use tomcom_study::trial_statistics::{DetailTotals, TrialDetails};

use super::{cell, near, summary, trial, with_details};
use crate::support::*;

/// An aspect of the synthetic kitchen at a probe.
#[derive(Clone, Copy, Debug)]
struct Synthetic {
    is_recipe: bool,
    /// The estimate's probability of the truth.
    estimate: f64,
    /// The participant's probability of the truth.
    belief: f64,
}

const PLACES: usize = 18;
const RECIPES: usize = 6;

impl Synthetic {
    /// Most aspects are surely right; the estimate errs, more so about recipes, so that choosing by it tells something of the belief.
    fn draw(is_recipe: bool, random: &mut Stream) -> Synthetic {
        let doubt = if random.random::<f64>() < 0.7 { 0.15 } else { 1.0 };
        let estimate = 1.0 - doubt * random.random::<f64>();
        let p_false = if is_recipe { 0.2 + 0.3 * (1.0 - estimate) } else { 0.05 + 0.7 * (1.0 - estimate) };
        let belief = if random.random::<f64>() < p_false { 0.1 } else { 0.9 };
        Synthetic { is_recipe, estimate, belief }
    }

    /// The question about it, answered as it is believed.
    fn question(self, inclusion: f64, uses_estimate: bool) -> ProbedQuestion {
        let kind = if self.is_recipe { ProbeQuestionKind::Recipe } else { ProbeQuestionKind::Place };
        let believes = if self.belief < 0.5 { "empty" } else { "rice" };
        ProbedQuestion {
            asked: asked(inclusion),
            uses_estimate,
            response: ProbeResponse::Value(believes.to_string()),
            frozen: Some(AspectAtFreeze {
                estimate_p_truth: self.estimate,
                estimate_p_false: 1.0 - self.estimate,
                believed: Some(RecordedBeliefAtFreeze { believes: believes.to_string(), p_truth: self.belief }),
                ..frozen(self.is_recipe)
            }),
            ..question(kind)
        }
    }
}

fn frozen(is_recipe: bool) -> AspectAtFreeze {
    AspectAtFreeze {
        values: 3,
        estimate: "rice".to_string(),
        estimate_p: BTreeMap::from(
            [("rice", 0.7), ("empty", 0.2), ("salmon", 0.1)].map(|(name, p)| (name.to_string(), p)),
        ),
        estimate_p_truth: 0.7,
        estimate_p_false: 0.3,
        believed: None,
        changed_s: (!is_recipe).then_some(7.0),
        changed_unseen: (!is_recipe).then_some(false),
        usual: "rice".to_string(),
        last_seen: "rice".to_string(),
    }
}

fn asked(inclusion: f64) -> ProbeQuestion {
    ProbeQuestion { about: ProbeSubject::NextOrder, choices: Vec::new(), inclusion }
}

fn question(kind: ProbeQuestionKind) -> ProbedQuestion {
    ProbedQuestion {
        probe: 1,
        question: 1,
        time_s: 60.0,
        origin: ProbeOrigin::Schedule,
        uses_estimate: false,
        kind,
        aspect: kind.name().to_string(),
        asked: asked(0.5),
        truth: Some("rice".to_string()),
        response: ProbeResponse::Value("rice".to_string()),
        confidence: None,
        took_s: Some(3.0),
        frozen: (!kind.is_level_2()).then(|| frozen(kind == ProbeQuestionKind::Recipe)),
    }
}

fn probed(condition: Condition, questions: Vec<ProbedQuestion>) -> ProbedTrial {
    let planned_arm = StudyArm::from_settings(condition, ConceptName::TomCom, false);
    ProbedTrial { planned_arm, begun: 1, dropped: 0, skipped: 0, questions }
}

/// A trial with one question, rightly answered.
pub(super) fn one_right_answer(condition: Condition) -> ProbedTrial {
    probed(condition, vec![question(ProbeQuestionKind::Place)])
}

/// Questions of a probe: without the estimate all aspects are as likely; with it, half of the questions are about what it believes
/// wrong. Drawn systematically in random order, so that the probabilities are exact.
fn draw(aspects: &[Synthetic], uses_estimate: bool, random: &mut Stream) -> Vec<ProbedQuestion> {
    const ASKED: f64 = 3.0;
    const LEAST: f64 = 0.05;
    let mut order: Vec<usize> = (0..aspects.len()).collect();
    order.shuffle(random);
    let all = aspects.len() as f64;
    let wrong = aspects.iter().filter(|one| one.estimate < 0.5).count() as f64;
    let chance = |one: &Synthetic| match uses_estimate && wrong > 0.0 {
        false => ASKED / all,
        true => {
            let share = if one.estimate < 0.5 { 0.5 / wrong } else { 0.5 / (all - wrong) };
            (LEAST + (ASKED - LEAST * all) * share).min(1.0)
        }
    };
    let (mut passed, mut drawn) = (random.random::<f64>(), Vec::new());
    for index in order {
        let inclusion = chance(&aspects[index]);
        let before = passed;
        passed += inclusion;
        if passed.floor() > before.floor() {
            drawn.push(aspects[index].question(inclusion, uses_estimate));
        }
    }
    drawn
}

fn detection(questions: &[ProbedQuestion], weighted: bool) -> ProbeDetection {
    let beliefs = questions.iter().filter_map(WeightedProbeBelief::by_answer);
    let beliefs: Vec<WeightedProbeBelief> = beliefs.map(|one| if weighted { one } else { one.unweighted() }).collect();
    ProbeDetection::from_beliefs(&beliefs)
}

/// Means over synthetic studies of (share of false beliefs, area of places, area of recipes) minus that over everything that could
/// have been asked: weighted, and unweighted.
fn biases(studies: u64, blind_share: f64) -> [[f64; 3]; 2] {
    let mut sums = [[0.0; 3]; 2];
    for study in 0..studies {
        let mut random = stream(20, "synthetic studies of probes", study);
        let (mut asked, mut everything) = (Vec::new(), Vec::new());
        for _ in 0..96 {
            let aspects: Vec<Synthetic> =
                (0..PLACES + RECIPES).map(|index| Synthetic::draw(index >= PLACES, &mut random)).collect();
            let uses_estimate = random.random::<f64>() >= blind_share;
            asked.extend(draw(&aspects, uses_estimate, &mut random));
            everything.extend(aspects.iter().map(|one| one.question(1.0, false)));
        }
        let figures =
            |found: &ProbeDetection| [found.wrong, found.auc_locations, found.auc_recipes].map(Option::unwrap);
        let truth = figures(&detection(&everything, true));
        for (sum, weighted) in sums.iter_mut().zip([true, false]) {
            let found = figures(&detection(&asked, weighted));
            sum.iter_mut().zip(found.iter().zip(&truth)).for_each(|(sum, (found, truth))| *sum += found - truth);
        }
    }
    sums.map(|sum| sum.map(|sum| sum / studies as f64))
}

#[test]
fn weights_take_out_the_choice_of_questions_by_the_estimate() {
    for blind_share in [0.5, 0.0] {
        let [weighted, unweighted] = biases(1000, blind_share);
        for (bias, what) in weighted.iter().zip(["share", "places", "recipes"]) {
            assert!(bias.abs() < 0.01, "{what} with {blind_share} blind: bias {bias}");
        }
        assert!(unweighted[0] > 0.02, "share of false beliefs, unweighted: bias {}", unweighted[0]);
        assert!(unweighted[1].abs() > 0.02, "area of places, unweighted: bias {}", unweighted[1]);
    }
    let [_, blind] = biases(1000, 1.0);
    assert!(blind.iter().all(|bias| bias.abs() < 0.01), "without the estimate nothing has to be taken out: {blind:?}");
}

/// A study in which answers are as believed, except for this share of wrong ones.
fn study_with_errors(rate: f64) -> ProbeSummary {
    let mut random = stream(21, "synthetic answers", 0);
    let mut slips = stream(21, "wrong answers", 0);
    let mut trials = Vec::new();
    for participant in 0..24 {
        let mut questions = Vec::new();
        for probe in 0..8 {
            let aspects: Vec<Synthetic> =
                (0..PLACES + RECIPES).map(|index| Synthetic::draw(index >= PLACES, &mut random)).collect();
            questions.extend(draw(&aspects, probe % 2 == 0, &mut random));
        }
        for one in &mut questions {
            if slips.random::<f64>() < rate {
                let is_right = one.is_wrong() == Some(false);
                one.response = ProbeResponse::Value(if is_right { "salmon" } else { "rice" }.to_string());
            }
        }
        trials.push((format!("P{participant}"), probed(Condition::None, questions)));
    }
    ProbeSummary::from_trials(trials.iter().map(|(code, trial)| (code.as_str(), trial))).expect("there are questions")
}

#[test]
fn answers_without_errors_give_the_figures_of_the_true_beliefs() {
    let found = study_with_errors(0.0);
    assert_eq!(found.beliefs_from, BeliefSource::Probes);
    let known = found.by_true_beliefs.as_ref().expect("simulated");
    near(known.agreement, 1.0);
    assert_eq!(known.n, found.counts.counted);
    let figures = |one: &ProbeDetection| {
        [one.wrong, one.auc, one.auc_locations, one.auc_recipes, one.auc_baseline, one.ece].map(Option::unwrap)
    };
    for (answered, believed) in figures(&found.detection).into_iter().zip(figures(&known.detection)) {
        near(answered, believed);
    }
    assert_eq!(found.detection.calibration.bins, known.detection.calibration.bins);
    let wrong = study_with_errors(0.2);
    let known = wrong.by_true_beliefs.expect("simulated");
    near(known.detection.auc.unwrap(), found.detection.auc.unwrap());
    assert!(wrong.detection.auc.unwrap() < found.detection.auc.unwrap() - 0.02, "wrong answers blur the area");
    assert!((0.7..0.9).contains(&known.agreement), "{}", known.agreement);
}

#[test]
fn only_scheduled_questions_about_what_is_that_were_answered_in_time_count() {
    let missing = ProbedQuestion { response: ProbeResponse::Missing, ..question(ProbeQuestionKind::Place) };
    let skipped = ProbedQuestion { response: ProbeResponse::Skipped, ..question(ProbeQuestionKind::Place) };
    let by_wizard = ProbedQuestion { origin: ProbeOrigin::Wizard, ..question(ProbeQuestionKind::Place) };
    let next = ProbedQuestion { truth: Some("serve_1".to_string()), ..question(ProbeQuestionKind::NextPress) };
    let unsure =
        ProbedQuestion { response: ProbeResponse::Unsure, asked: asked(0.25), ..question(ProbeQuestionKind::Order) };
    let trial =
        probed(Condition::None, vec![question(ProbeQuestionKind::Place), missing, skipped, by_wizard, next, unsure]);
    let found = ProbeSummary::from_trials([("P1", &trial)]).expect("there are questions");
    let counts = found.counts;
    let left_out = [counts.unanswered, counts.questions_skipped, counts.by_wizard, counts.level_2];
    assert_eq!((counts.questions, counts.counted, counts.unsure, left_out), (6, 2, 1, [1, 1, 1, 1]));
    // "I don't know" is wrong, and weighs twice the right answer.
    near(found.accuracy.accuracy.unwrap(), 1.0 / 3.0);
    near(found.detection.wrong.unwrap(), 2.0 / 3.0);
    near(counts.effective, 36.0 / 20.0);
    assert_eq!(found.accuracy.interval, None, "one participant has no interval");
    assert_eq!((found.level_2.len(), found.level_2[0].n, found.level_2[0].accuracy), (1, 1, Some(0.0)));
    assert_eq!(found.log_scores.n, 1, "\"I don't know\" names no value");
    near(found.log_scores.estimate.unwrap(), 0.7_f64.ln());
    // With nobody to learn from, a base rate is right half of the time.
    near(found.log_scores.truth.unwrap(), 0.5_f64.ln());
    assert_eq!(ProbeSummary::from_trials([("P1", &probed(Condition::None, Vec::new()))]), None);
}

#[test]
fn base_rates_learn_on_other_participants() {
    let stale = || ProbedQuestion {
        response: ProbeResponse::Value("empty".to_string()),
        frozen: Some(AspectAtFreeze { last_seen: "empty".to_string(), ..frozen(false) }),
        ..question(ProbeQuestionKind::Place)
    };
    let trials: Vec<(String, ProbedTrial)> =
        (0..10).map(|code| (format!("P{code}"), probed(Condition::None, vec![stale(), stale()]))).collect();
    let found = ProbeSummary::from_trials(trials.iter().map(|(code, trial)| (code.as_str(), trial))).unwrap();
    // 18 answers of others, all as last seen, none as true: Laplace's rule gives 19/20 and 1/20, the rest evenly to two other values.
    near(found.log_scores.last_seen.unwrap(), (19.0_f64 / 20.0).ln());
    near(found.log_scores.truth.unwrap(), (19.0_f64 / 20.0 / 2.0).ln());
    near(found.log_scores.estimate.unwrap(), 0.2_f64.ln());
    let mixed = (0.7_f64 * 0.2 + 0.3 / 3.0).ln();
    near(found.log_scores.estimate_with_slips.unwrap(), mixed);
}

#[test]
fn accuracy_is_told_by_age_looks_and_condition_and_the_effect_within_participants() {
    let with = |changed_s: Option<f64>, unseen: bool, is_right: bool| ProbedQuestion {
        response: if is_right { ProbeResponse::Value("rice".to_string()) } else { ProbeResponse::Unsure },
        frozen: Some(AspectAtFreeze { changed_s, changed_unseen: Some(unseen), ..frozen(false) }),
        ..question(ProbeQuestionKind::Place)
    };
    let of_people = |codes: &[&str]| {
        let mut trials = Vec::new();
        for &code in codes {
            let alone = vec![with(Some(2.0), true, false), with(Some(100.0), false, true)];
            let helped = vec![with(None, false, true), with(Some(20.0), true, !["P3", "P6"].contains(&code))];
            trials.push((code.to_string(), probed(Condition::None, alone)));
            trials.push((code.to_string(), probed(Condition::Wizard, helped)));
        }
        ProbeSummary::from_trials(trials.iter().map(|(code, trial)| (code.as_str(), trial))).unwrap()
    };
    let found = of_people(&["P1", "P2", "P3"]);
    let of = |by: ProbeAccuracyGrouping| -> Vec<(&str, u64, f64)> {
        let rows = found.accuracies.iter().filter(|one| one.by == by);
        rows.map(|one| (one.group.as_str(), one.n, (one.accuracy.unwrap() * 6.0).round() / 6.0)).collect()
    };
    let ages = [
        "changed less than 5 s ago",
        "changed 15 to 60 s ago",
        "changed more than 60 s ago",
        "not changed in the trial",
    ];
    assert_eq!(
        of(ProbeAccuracyGrouping::Age),
        [(ages[0], 3, 0.0), (ages[1], 3, 4.0 / 6.0), (ages[2], 3, 1.0), (ages[3], 3, 1.0)]
    );
    let seen = ["not changed by others since the last look", "changed by others since the last look"];
    assert_eq!(of(ProbeAccuracyGrouping::Seen), [(seen[0], 6, 1.0), (seen[1], 6, 2.0 / 6.0)]);
    assert_eq!(of(ProbeAccuracyGrouping::Condition), [("none", 6, 0.5), ("wizard", 6, 5.0 / 6.0)]);
    let effect = found.assistance.expect("all have both");
    assert_eq!(effect.participants, 3);
    near(effect.difference, 1.0 / 3.0);
    assert_eq!(effect.interval, None, "resamples of three participants are nearly all alike");
    let effect = of_people(&["P1", "P2", "P3", "P4", "P5", "P6"]).assistance.expect("all have both");
    near(effect.difference, 1.0 / 3.0);
    let [low, high] = effect.interval.expect("six participants");
    assert!(low < effect.difference && effect.difference < high && low >= 0.0 && high <= 0.5, "{low} to {high}");
}

#[test]
fn probes_stand_in_tables_and_report() {
    let mut trials = super::trials(&[[12, 6], [10, 5], [14, 8]], &[[8, 9], [6, 7], [9, 8]]);
    let none = report::page(&summary(&trials), &trials, &RecordingFacts::default(), &[]);
    assert!(!none.contains("What people knew"));
    let mut details = Vec::new();
    for (index, trial) in trials.iter_mut().enumerate() {
        let is_right = trial.is_assisted() || index % 3 == 0;
        let answer = if is_right { "rice" } else { "empty" };
        let asked = |kind| ProbedQuestion { response: ProbeResponse::Value(answer.to_string()), ..question(kind) };
        let questions = vec![
            asked(ProbeQuestionKind::Place),
            question(ProbeQuestionKind::Recipe),
            asked(ProbeQuestionKind::NextOrder),
        ];
        let probed = probed(trial.condition, questions);
        trial.probes = Some(probed.statistics());
        details.push(TrialDetails { probes: Some(probed), ..TrialDetails::default() });
    }
    let mut totals = DetailTotals::default();
    trials.iter().zip(&details).for_each(|(trial, details)| totals.add(trial, details.clone()));
    let figures = with_details(&trials, totals);
    let found = figures.probes.as_ref().expect("there are probes");
    assert_eq!((found.participants, found.counts.counted), (6, 24));
    let effect = figures.effects.iter().find(|effect| effect.measure == PROBES_WRONG).expect("it is compared");
    assert_eq!(effect.groups, [3, 3]);
    let page = report::page(&figures, &trials, &RecordingFacts::default(), &[]);
    for part in [
        "What people knew",
        "Calibration of the estimate by answers to probes",
        "12 about what comes next",
        "what was last seen there",
    ] {
        assert!(page.contains(part), "{part} is missing");
    }
    let rows: Vec<ProbeRow> = trials.iter().zip(&details).flat_map(|(trial, details)| probes(trial, details)).collect();
    assert_eq!(rows.len(), 36);
    let value = |name: &str| serde_json::to_string(&cell(&rows[0], name)).unwrap();
    assert_eq!(value("estimate_values"), "\"rice: 0.7000; empty: 0.2000; salmon: 0.1000\"");
    assert_eq!((value("weight").as_str(), value("in_main_results").as_str()), ("2.0", "true"));
    let answer = value("answer");
    let wanted = if answer == "\"rice\"" { "0.7" } else { "0.2" };
    assert_eq!(value("estimate_p_answer"), wanted);
    assert_eq!(trial("P9", 1, Condition::None, 3).probes, None);
}

/// A trial with probes, of a participant with this share of wrong answers.
fn settings(answers_wrong: f64) -> SessionSpec {
    let text = format!(
        "layout = \"\"\nseed = 5\n[trial]\ncondition = \"none\"\nseconds = 300.0\n[assistant]\nshadow = \"off\"\n\
         [participant.population]\nanswers_wrong = {{ median = {answers_wrong}, sigma = 0.4 }}\n[probes]\napart_s = 50.0\nper_trial = 5\n"
    );
    toml::from_str(&text).expect("settings of a session")
}

/// A question as it follows from the events alone.
struct Expected {
    truth: String,
    /// Seconds since the last change, and who made it.
    changed: Option<(f64, Option<Agent>)>,
    believed: String,
    estimate_p_truth: f64,
}

/// Runs a trial and reads its probes, beside what is expected of each drawn question.
fn recorded_probes(spec: &SessionSpec, trial: u64) -> (ProbedTrial, Vec<(u32, Vec<Expected>)>) {
    let kitchen = kitchen("sushi");
    let mut engine = SessionEngine::new(kitchen.clone(), spec.clone(), trial, CostToGo::new(kitchen.clone()));
    let session = Session::new(kitchen.clone(), spec.clone(), trial);
    let mut follower = SessionFollower::new(session, CostToGo::new(kitchen.clone()));
    let (mut collector, mut expected) = (ProbeCollector::default(), Vec::new());
    let mut changes: Vec<(LocationId, f64, Option<Agent>)> = Vec::new();
    let mut witness: Option<RecordedBelief> = None;
    let keep = |stamped: &TimestampedEvent| {
        let change = follower.apply(stamped).expect("what was recorded can be replayed").change;
        collector.note(stamped, &change, &follower);
        let session = &follower.session;
        let now = session.trial_clock(stamped.time).as_secs_f64();
        if let Some((before, after)) = change.states() {
            let changed = (0..kitchen.locations.len() as u8).map(LocationId);
            let changed = changed.filter(|&location| before.code(location) != after.code(location));
            changes.extend(changed.map(|location| (location, now, change.press().map(|press| press.agent))));
        }
        match &stamped.event {
            Event::ParticipantBelieves(told) => witness = Some(told.clone()),
            Event::Probe(ProbeEvent::Begun { probe, questions, .. }) => {
                let believed = witness.as_ref().expect("beliefs are recorded before the probe");
                let of = |about: &str| {
                    let aspect = kitchen.aspect_named(about).expect("an aspect of the kitchen");
                    let told = &kitchen.aspects[aspect.index()];
                    let location = match told.kind {
                        AspectKind::Location(location) => Some(location),
                        AspectKind::Recipe(_) => None,
                    };
                    let last = changes.iter().rfind(|(other, ..)| Some(*other) == location);
                    Expected {
                        truth: told.labels[kitchen.true_value(session.state, aspect)].clone(),
                        changed: last.map(|(_, at, who)| (now - at, *who)),
                        believed: believed.aspects[aspect.index()].believes.clone(),
                        estimate_p_truth: follower.probed.as_ref().unwrap().belief.p_truth(
                            &kitchen,
                            session.state,
                            aspect,
                        ),
                    }
                };
                let names = questions.iter().map(|question| match &question.about {
                    ProbeSubject::Recipe { dish } => format!("recipe of {dish}"),
                    ProbeSubject::Location { location } => location.clone(),
                    next => panic!("{next:?} was not asked for"),
                });
                expected.push((*probe, names.map(|name| of(&name)).collect()));
            }
            _ => {}
        }
    };
    headless::run(&mut engine, keep);
    (collector.finish(engine.session()), expected)
}

fn check(question: &ProbedQuestion, expected: &Expected) {
    let frozen = question.frozen.as_ref().expect("a question about what is");
    // Where the question does not show a value, another choice stands for it.
    let truth = question.asked.choice_for(&expected.truth);
    assert_eq!(question.truth.as_deref(), Some(truth));
    let believed = question.asked.choice_for(&expected.believed);
    assert_eq!(frozen.believed.as_ref().expect("a simulated participant").believes, believed);
    match truth == expected.truth {
        true => near(frozen.estimate_p_truth, expected.estimate_p_truth),
        false => assert!(frozen.estimate_p_truth >= expected.estimate_p_truth),
    }
    near(frozen.estimate_p[truth], frozen.estimate_p_truth);
    assert_eq!(frozen.values, question.asked.choices.len());
    near(frozen.estimate_p.values().sum(), 1.0);
    match (frozen.changed_unseen, expected.changed) {
        (None, _) => assert_eq!([&frozen.usual, &frozen.last_seen], [truth; 2], "a recipe"),
        (Some(_), None) => assert_eq!((frozen.changed_s, frozen.changed_unseen), (None, Some(false))),
        (Some(is_unseen), Some((age_s, who))) => {
            near(frozen.changed_s.expect("it changed"), age_s);
            assert!(!is_unseen || who != Some(Agent::Human), "own presses are seen");
            if !is_unseen {
                assert_eq!(frozen.last_seen, truth, "what was seen after the last change is there");
            }
        }
    }
}

#[test]
fn questions_have_what_was_true_known_and_estimated_at_the_freeze() {
    let spec = settings(0.0);
    let (mut unseen, mut changed, mut asked) = (0, 0, 0);
    for trial in 0..3 {
        let (found, expected) = recorded_probes(&spec, trial);
        assert_eq!(found.begun as usize, expected.len());
        assert!(found.begun > 0);
        for question in &found.questions {
            assert_eq!(question.origin, ProbeOrigin::Schedule);
            let of_probe = expected.iter().find(|(probe, _)| *probe == question.probe).expect("it began");
            check(question, &of_probe.1[question.question as usize - 1]);
            let frozen = question.frozen.as_ref().unwrap();
            unseen += u32::from(frozen.changed_unseen == Some(true));
            changed += u32::from(frozen.changed_s.is_some());
            asked += 1;
        }
    }
    assert!(asked > 20 && changed > 5 && unseen > 0, "{asked} questions, {changed} of changed places, {unseen} unseen");
}

#[test]
fn answers_of_simulated_participants_are_their_beliefs_unless_they_err() {
    let figures = |answers_wrong: f64| {
        let spec = settings(answers_wrong);
        let trials: Vec<(String, ProbedTrial)> =
            (0..5).map(|trial| (format!("S{trial}"), recorded_probes(&spec, trial).0)).collect();
        for question in trials.iter().flat_map(|(_, trial)| &trial.questions) {
            let took_s = question.took_s;
            assert_eq!(took_s.is_none(), question.response == ProbeResponse::Missing);
            assert!(took_s.is_none_or(|took_s| (0.2..12.0).contains(&took_s)), "{question:?}");
        }
        ProbeSummary::from_trials(trials.iter().map(|(code, trial)| (code.as_str(), trial))).expect("there are probes")
    };
    let exact = figures(0.0);
    let known = exact.by_true_beliefs.as_ref().expect("simulated");
    assert!(known.n > 30 && known.n == exact.counts.counted, "{:?}", exact.counts);
    near(known.agreement, 1.0);
    let both = [
        (exact.detection.wrong, known.detection.wrong),
        (exact.detection.auc, known.detection.auc),
        (exact.detection.ece, known.detection.ece),
    ];
    for (answered, believed) in both {
        near(answered.expect("some beliefs are false"), believed.expect("some beliefs are false"));
    }
    let wrong = figures(0.3);
    let known = wrong.by_true_beliefs.expect("simulated");
    assert!((0.5..0.9).contains(&known.agreement), "three of ten answers are wrong: {}", known.agreement);
    near(known.detection.auc.unwrap(), exact.detection.auc.unwrap());
}
