//! Results of freeze probes: what participants knew (by state aspect, by what happened at the aspect's location, by
//! condition), the effect of assistance, and how well the estimate predicted beliefs.

use std::collections::BTreeSet;

use serde::Serialize;

use crate::analysis::probe_detection::{ProbeDetection, ProbeLogScores, WeightedProbeBelief};
use crate::analysis::probe_record::{ProbeQuestionKind, ProbeResponse, ProbedQuestion, ProbedTrial, weighted_share};
use crate::grouping::grouped;
use crate::headline::directed;
use crate::statistics::{interval_where_known, mean};
use crate::why::{self, decimal, percent};
use tomcom_core::base::text::count;
use tomcom_core::measures::raters::BeliefSource;
use tomcom_session::probes::ProbeOrigin;
use tomcom_session::study_arm::StudyArm;

/// Main results are over scheduled questions about the present state that were answered in time.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ProbeSummary {
    pub beliefs_from: BeliefSource,
    pub participants: u64,
    pub counts: ProbeCounts,
    #[serde(flatten)]
    pub detection: ProbeDetection,
    /// 95 % interval of `detection.auc` by bootstrap over participants; null with fewer than five participants.
    pub auc_interval: Option<[f64; 2]>,
    /// 95 % interval of `detection.ece` by bootstrap over participants; null with fewer than five participants.
    pub ece_interval: Option<[f64; 2]>,
    /// Without weights, and so biased: the estimate took part in the choice of questions.
    pub auc_unweighted: Option<f64>,
    pub log_scores: ProbeLogScores,
    pub accuracy: ProbeAnswerAccuracy,
    pub accuracies: Vec<ProbeAnswerAccuracy>,
    /// Effect of assistance on situation awareness; null if no participant has answers with and without assistance.
    pub assistance: Option<SituationAwarenessEffect>,
    /// What comes next (level 2 of situation awareness); not in the main results.
    pub level_2: Vec<ProbeAnswerAccuracy>,
    /// Measured by what simulated participants believed at the same questions; null for people.
    pub by_true_beliefs: Option<RecordedBeliefComparison>,
}

#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct ProbeCounts {
    pub probes: u64,
    pub dropped: u64,
    /// Number of freeze probes of which the wizard skipped remaining questions.
    pub skipped: u64,
    pub questions: u64,
    pub counted: u64,
    /// Number of questions in the main results that were answered with "I don't know".
    pub unsure: u64,
    pub unanswered: u64,
    /// Number of questions left out because the wizard skipped the rest of the probe while they were shown.
    pub questions_skipped: u64,
    /// Number of answered questions left out because the wizard, not the schedule, started the probe.
    pub by_wizard: u64,
    pub level_2: u64,
    /// Number of questions of equal weight that would tell as much (Kish 1965).
    pub effective: f64,
}

/// Comparison of probe answers with what simulated participants believed, at the questions of the main results.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct RecordedBeliefComparison {
    pub n: u64,
    /// Share of the questions with a recorded belief where answer and belief are both right or both wrong.
    pub agreement: f64,
    #[serde(flatten)]
    pub detection: ProbeDetection,
    pub by_answers: ProbeDetection,
}

impl ProbeSummary {
    /// Trials with their participant's code; `None` if no question was shown.
    pub fn from_trials<'a>(trials: impl IntoIterator<Item = (&'a str, &'a ProbedTrial)>) -> Option<ProbeSummary> {
        let participants: Vec<Vec<&ProbedTrial>> = grouped(trials).into_iter().map(|(_, of_one)| of_one).collect();
        let counts = ProbeCounts::from_trials(participants.iter().flatten().copied());
        (counts.questions > 0).then_some(())?;
        let of_one = |trials: &Vec<&'a ProbedTrial>| -> Vec<WeightedProbeBelief<'a>> {
            trials.iter().flat_map(|trial| trial.counted()).filter_map(WeightedProbeBelief::by_answer).collect()
        };
        let beliefs: Vec<Vec<WeightedProbeBelief>> = participants.iter().map(of_one).collect();
        let known: Vec<&Vec<WeightedProbeBelief>> = beliefs.iter().filter(|of_one| !of_one.is_empty()).collect();
        let pooled = |of: &[&Vec<WeightedProbeBelief>]| -> ProbeDetection {
            ProbeDetection::from_beliefs(&of.iter().flat_map(|one| one.iter().copied()).collect::<Vec<_>>())
        };
        let all: Vec<WeightedProbeBelief> = beliefs.iter().flatten().copied().collect();
        let unweighted: Vec<WeightedProbeBelief> = all.iter().map(|one| one.unweighted()).collect();
        let numbered: Vec<(usize, &ProbedQuestion)> = beliefs
            .iter()
            .enumerate()
            .flat_map(|(participant, of_one)| of_one.iter().map(move |one| (participant, one.question)))
            .collect();
        let level_2 = [ProbeQuestionKind::NextOrder, ProbeQuestionKind::NextPress].into_iter().map(|kind| {
            let is_it = |_: &ProbedTrial, one: &ProbedQuestion| one.kind == kind && one.origin == ProbeOrigin::Schedule;
            accuracy(&participants, (ProbeAccuracyGrouping::Kind, kind.words()), is_it)
        });
        let is_counted = |_: &ProbedTrial, one: &ProbedQuestion| one.is_counted();
        Some(ProbeSummary {
            beliefs_from: BeliefSource::Probes,
            participants: known.len() as u64,
            counts,
            detection: ProbeDetection::from_beliefs(&all),
            auc_interval: interval_where_known(&known, |of| pooled(of).auc),
            ece_interval: interval_where_known(&known, |of| pooled(of).ece),
            auc_unweighted: ProbeDetection::from_beliefs(&unweighted).auc,
            log_scores: ProbeLogScores::from_questions(&numbered),
            accuracy: accuracy(&participants, (ProbeAccuracyGrouping::Kind, "all"), is_counted),
            accuracies: accuracies(&participants),
            assistance: awareness_effect(&participants),
            level_2: level_2.filter(|one| one.n > 0).collect(),
            by_true_beliefs: RecordedBeliefComparison::from_beliefs(&all),
        })
    }
}

impl ProbeCounts {
    fn from_trials<'a>(trials: impl Iterator<Item = &'a ProbedTrial>) -> ProbeCounts {
        let mut counts = ProbeCounts::default();
        let (mut weights, mut squares) = (0.0, 0.0);
        for trial in trials {
            counts.probes += trial.begun;
            counts.dropped += trial.dropped;
            counts.skipped += trial.skipped;
            for question in &trial.questions {
                counts.questions += 1;
                match question {
                    one if one.response == ProbeResponse::Skipped => counts.questions_skipped += 1,
                    one if one.response == ProbeResponse::Missing => counts.unanswered += 1,
                    one if one.origin == ProbeOrigin::Wizard => counts.by_wizard += 1,
                    one if one.kind.is_level_2() => counts.level_2 += 1,
                    one => {
                        counts.counted += 1;
                        counts.unsure += u64::from(one.response == ProbeResponse::Unsure);
                        weights += one.weight();
                        squares += one.weight() * one.weight();
                    }
                }
            }
        }
        counts.effective = if squares > 0.0 { weights * weights / squares } else { 0.0 };
        counts
    }
}

impl RecordedBeliefComparison {
    fn from_beliefs(answered: &[WeightedProbeBelief]) -> Option<RecordedBeliefComparison> {
        let known: Vec<[WeightedProbeBelief; 2]> =
            answered.iter().filter_map(|one| Some([*one, one.by_true_belief()?])).collect();
        (!known.is_empty()).then_some(())?;
        let same = known.iter().filter(|[answered, believed]| answered.is_wrong == believed.is_wrong).count();
        let [by_answers, detection] = [0, 1].map(|which| {
            let of: Vec<WeightedProbeBelief> = known.iter().map(|both| both[which]).collect();
            ProbeDetection::from_beliefs(&of)
        });
        Some(RecordedBeliefComparison {
            n: known.len() as u64,
            agreement: same as f64 / known.len() as f64,
            detection,
            by_answers,
        })
    }
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum ProbeAccuracyGrouping {
    Kind,
    Aspect,
    Age,
    Seen,
    Condition,
    Choice,
    Confidence,
}

#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ProbeAnswerAccuracy {
    pub by: ProbeAccuracyGrouping,
    pub group: String,
    pub n: u64,
    pub unsure: u64,
    /// Share of right answers, weighted by the inverse of the questions' inclusion probability.
    pub accuracy: Option<f64>,
    /// 95 % interval of the accuracy, by bootstrap over participants; null with fewer than five participants.
    pub interval: Option<[f64; 2]>,
}

#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct SituationAwarenessEffect {
    pub participants: u64,
    /// Mean over the compared participants of accuracy with assistance minus accuracy without.
    pub difference: f64,
    pub interval: Option<[f64; 2]>,
}

/// Groups of questions by time since the location's last change: upper end in seconds, and name.
const AGES: [(f64, &str); 4] = [
    (5.0, "changed less than 5 s ago"),
    (15.0, "changed 5 to 15 s ago"),
    (60.0, "changed 15 to 60 s ago"),
    (f64::INFINITY, "changed more than 60 s ago"),
];

/// The groups to which a probe question belongs, in the order of the table.
fn groups(trial: &ProbedTrial, question: &ProbedQuestion) -> Vec<(ProbeAccuracyGrouping, usize, String)> {
    let kind = match question.kind {
        ProbeQuestionKind::Order => 0,
        ProbeQuestionKind::Recipe => 1,
        _ => 2,
    };
    let choice = ["drawn without the estimate", "drawn with the estimate"][usize::from(question.uses_estimate)];
    let mut groups = vec![
        (ProbeAccuracyGrouping::Kind, kind, question.kind.words().to_string()),
        (ProbeAccuracyGrouping::Aspect, 0, question.aspect.clone()),
        (ProbeAccuracyGrouping::Condition, trial.planned_arm as usize, trial.planned_arm.name().to_string()),
        (ProbeAccuracyGrouping::Choice, usize::from(question.uses_estimate), choice.to_string()),
    ];
    if let Some((frozen, changed_unseen)) =
        question.frozen.as_ref().and_then(|frozen| Some((frozen, frozen.changed_unseen?)))
    {
        groups.push(match frozen.changed_s {
            None => (ProbeAccuracyGrouping::Age, AGES.len(), "not changed in the trial".to_string()),
            Some(s) => {
                let age = AGES.iter().position(|(to, _)| s < *to).unwrap_or(AGES.len() - 1);
                (ProbeAccuracyGrouping::Age, age, AGES[age].1.to_string())
            }
        });
        let seen = ["not changed by others since the last look", "changed by others since the last look"];
        let index = usize::from(changed_unseen);
        groups.push((ProbeAccuracyGrouping::Seen, index, seen[index].to_string()));
    }
    if let Some(confidence) = question.confidence.filter(|_| question.response != ProbeResponse::Unsure) {
        let group = format!("confidence {confidence} of 3");
        groups.push((ProbeAccuracyGrouping::Confidence, usize::from(confidence), group));
    }
    groups
}

/// Over the questions of the main results; `participants`: the trials of each.
fn accuracies(participants: &[Vec<&ProbedTrial>]) -> Vec<ProbeAnswerAccuracy> {
    let all: BTreeSet<(ProbeAccuracyGrouping, usize, String)> = participants
        .iter()
        .flatten()
        .flat_map(|trial| trial.counted().flat_map(|question| groups(trial, question)))
        .collect();
    all.into_iter()
        .map(|key| {
            let is_in = |trial: &ProbedTrial, question: &ProbedQuestion| {
                question.is_counted() && groups(trial, question).contains(&key)
            };
            accuracy(participants, (key.0, &key.2), is_in)
        })
        .collect()
}

fn accuracy(
    participants: &[Vec<&ProbedTrial>],
    (by, group): (ProbeAccuracyGrouping, &str),
    is_in: impl Fn(&ProbedTrial, &ProbedQuestion) -> bool,
) -> ProbeAnswerAccuracy {
    let of_one = |trials: &Vec<&ProbedTrial>| -> Vec<(f64, bool)> {
        let all = trials.iter().flat_map(|trial| trial.questions.iter().filter(|one| is_in(trial, one)));
        all.filter_map(|one| Some((one.weight(), !one.is_wrong()?))).collect()
    };
    let answers: Vec<Vec<(f64, bool)>> = participants.iter().map(of_one).collect();
    // The bootstrap needs only two sums of weights for each participant: of all answers, and of right ones.
    let sums: Vec<[f64; 2]> = answers
        .iter()
        .filter(|of_one| !of_one.is_empty())
        .map(|of_one| {
            let right = of_one.iter().filter(|(_, is_right)| *is_right).map(|(weight, _)| weight).sum();
            [of_one.iter().map(|(weight, _)| weight).sum(), right]
        })
        .collect();
    let share = |sums: &[[f64; 2]]| {
        let [all, right] = sums.iter().fold([0.0, 0.0], |[all, right], one| [all + one[0], right + one[1]]);
        (all > 0.0).then(|| right / all)
    };
    let questions =
        || participants.iter().flatten().flat_map(|trial| trial.questions.iter().filter(|one| is_in(trial, one)));
    ProbeAnswerAccuracy {
        by,
        group: group.to_string(),
        n: questions().filter(|one| one.is_wrong().is_some()).count() as u64,
        unsure: questions().filter(|one| one.response == ProbeResponse::Unsure).count() as u64,
        accuracy: weighted_share(answers.into_iter().flatten()),
        interval: interval_where_known(&sums, share),
    }
}

/// Within participants; `None` if none has answers in both assisted and unassisted trials.
fn awareness_effect(participants: &[Vec<&ProbedTrial>]) -> Option<SituationAwarenessEffect> {
    let share = |trials: &[&ProbedTrial], assisted: bool| {
        let of = trials.iter().filter(|trial| (trial.planned_arm != StudyArm::None) == assisted);
        let answers = of.flat_map(|trial| trial.counted());
        weighted_share(answers.filter_map(|one| Some((one.weight(), !one.is_wrong()?))))
    };
    let differences: Vec<f64> =
        participants.iter().filter_map(|of| Some(share(of, true)? - share(of, false)?)).collect();
    let mean = |of: &[f64]| mean(of.iter().copied());
    Some(SituationAwarenessEffect {
        participants: differences.len() as u64,
        difference: mean(&differences)?,
        interval: interval_where_known(&differences, mean),
    })
}

pub fn describe(found: &ProbeSummary) -> String {
    let (counts, detection, scores) = (&found.counts, &found.detection, &found.log_scores);
    let text = format!(
        "probes: {} of {} in {}; {} count, {} of them \"I don't know\"; left out: {} without an answer in time, {} in probes of the \
         wizard, {} about what comes next\n\
         right answers: {}{}\n\
         estimate against answers, weighted by the chance of each question: area under the ROC {}{} (locations {}, where knowing \
         only what changed unseen gives {}, recipes {}; unweighted {}), calibration error {}{}\n\
         log score of answers: estimate {} (with wrong answers at random {}), what usually lies there {}, what was seen last {}, what \
         is true {} nats\n",
        count(counts.questions, "question", "questions"),
        count(found.participants, "participant", "participants"),
        count(counts.probes, "probe", "probes"),
        counts.counted,
        counts.unsure,
        counts.unanswered,
        counts.by_wizard,
        counts.level_2,
        percent(found.accuracy.accuracy, why::NO_ANSWER),
        interval_text(found.accuracy.interval, 100.0, 1),
        decimal(detection.auc, 3, why::ONE_KIND),
        interval_text(found.auc_interval, 1.0, 3),
        decimal(detection.auc_locations, 3, why::ONE_KIND),
        decimal(detection.auc_baseline, 3, why::ONE_KIND),
        decimal(detection.auc_recipes, 3, why::ONE_KIND),
        decimal(found.auc_unweighted, 3, why::ONE_KIND),
        decimal(detection.ece, 3, why::UNCALIBRATED),
        interval_text(found.ece_interval, 1.0, 3),
        decimal(scores.estimate, 3, why::NO_VALUE),
        decimal(scores.estimate_with_slips, 3, why::NO_VALUE),
        decimal(scores.usual, 3, why::NO_VALUE),
        decimal(scores.last_seen, 3, why::NO_VALUE),
        decimal(scores.truth, 3, why::NO_VALUE),
    );
    text + &describe_accuracies(found)
}

fn describe_accuracies(found: &ProbeSummary) -> String {
    let mut text = String::new();
    // Groups by single state aspect and by the way of drawing questions are in the JSON output only.
    let told = [
        ProbeAccuracyGrouping::Kind,
        ProbeAccuracyGrouping::Age,
        ProbeAccuracyGrouping::Seen,
        ProbeAccuracyGrouping::Condition,
    ];
    for one in found.accuracies.iter().filter(|one| told.contains(&one.by)) {
        let share = percent(one.accuracy, why::NO_ANSWER);
        text += &format!("  {:<44}{share:>8}{} of {}\n", one.group, interval_text(one.interval, 100.0, 1), one.n);
    }
    if let Some(effect) = &found.assistance {
        let ends = effect.interval.unwrap_or([f64::NAN; 2]);
        let (difference, ends, more) = directed(effect.difference, ends, ["more", "fewer"]);
        text += &format!(
            "assistance: {:.1} % {more} right answers{} within {}\n",
            100.0 * difference,
            interval_text(effect.interval.map(|_| ends), 100.0, 1),
            count(effect.participants, "participant", "participants"),
        );
    }
    for one in &found.level_2 {
        text +=
            &format!("what comes next: {}: {} right of {}\n", one.group, percent(one.accuracy, why::NO_ANSWER), one.n);
    }
    if let Some(known) = &found.by_true_beliefs {
        text += &format!(
            "by the recorded beliefs at {} of these questions: area {}, calibration error {}; by their answers {} and {}; {} of the \
             answers agree\n",
            known.n,
            decimal(known.detection.auc, 3, why::ONE_KIND),
            decimal(known.detection.ece, 3, why::UNCALIBRATED),
            decimal(known.by_answers.auc, 3, why::ONE_KIND),
            decimal(known.by_answers.ece, 3, why::UNCALIBRATED),
            percent(Some(known.agreement), ""),
        );
    }
    text
}

fn interval_text(interval: Option<[f64; 2]>, scale: f64, digits: usize) -> String {
    interval.map_or(String::new(), |[from, to]| format!(" ({:.digits$} to {:.digits$})", scale * from, scale * to))
}
