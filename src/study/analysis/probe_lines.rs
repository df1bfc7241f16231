//! Results of freeze probes as lines of text.

use super::probe_accuracy::ProbeAccuracyGrouping;
use super::probe_figures::ProbeSummary;
use tomcom_core::base::text::{count, decimal, percent};

/// The results of freeze probes as text for the terminal.
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
        percent(found.accuracy.accuracy),
        within(found.accuracy.interval, 100.0, 1),
        decimal(detection.auc, 3),
        within(found.auc_interval, 1.0, 3),
        decimal(detection.auc_locations, 3),
        decimal(detection.auc_baseline, 3),
        decimal(detection.auc_recipes, 3),
        decimal(found.auc_unweighted, 3),
        decimal(detection.ece, 3),
        within(found.ece_interval, 1.0, 3),
        decimal(scores.estimate, 3),
        decimal(scores.estimate_with_slips, 3),
        decimal(scores.usual, 3),
        decimal(scores.last_seen, 3),
        decimal(scores.truth, 3),
    );
    text + &accuracies(found)
}

/// Text about right answers to probes by group, the effect of assistance, questions about what comes next, and accuracy
/// measured by recorded beliefs.
fn accuracies(found: &ProbeSummary) -> String {
    let mut text = String::new();
    // Groups by single state aspect and by the way of drawing questions are in the JSON output only.
    let told = [
        ProbeAccuracyGrouping::Kind,
        ProbeAccuracyGrouping::Age,
        ProbeAccuracyGrouping::Seen,
        ProbeAccuracyGrouping::Condition,
    ];
    for one in found.accuracies.iter().filter(|one| told.contains(&one.by)) {
        let share = percent(one.accuracy);
        text += &format!("  {:<44}{share:>8}{} of {}\n", one.group, within(one.interval, 100.0, 1), one.n);
    }
    if let Some(effect) = &found.assistance {
        text += &format!(
            "assistance: {:+.1} % right answers{} within {}\n",
            100.0 * effect.difference,
            within(effect.interval, 100.0, 1),
            count(effect.participants, "participant", "participants"),
        );
    }
    for one in &found.level_2 {
        text += &format!("what comes next: {}: {} right of {}\n", one.group, percent(one.accuracy), one.n);
    }
    if let Some(known) = &found.by_true_beliefs {
        text += &format!(
            "by the recorded beliefs at {} of these questions: area {}, calibration error {}; by their answers {} and {}; {} of the \
             answers agree\n",
            known.n,
            decimal(known.detection.auc, 3),
            decimal(known.detection.ece, 3),
            decimal(known.by_answers.auc, 3),
            decimal(known.by_answers.ece, 3),
            percent(Some(known.agreement)),
        );
    }
    text
}

/// A confidence interval in brackets; empty if the interval is not known.
fn within(interval: Option<[f64; 2]>, scale: f64, digits: usize) -> String {
    interval.map_or(String::new(), |[from, to]| format!(" ({:.digits$} to {:.digits$})", scale * from, scale * to))
}
