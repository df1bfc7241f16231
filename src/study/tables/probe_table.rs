//! Table of the questions of freeze probes.

use crate::analysis::probe_record::{AspectAtFreeze, ProbeResponse, ProbedQuestion};
use crate::column::{CsvCell, CsvColumn, CsvRow, CsvTable};
use crate::effect::StudyMeasure;
use crate::trial_statistics::{TrialDetails, TrialStatistics};
use tomcom_core::mind::WORTH_TELLING;
use tomcom_core::mind::rounded;

/// Measure of situation awareness: share of wrong answers to freeze probes.
pub const PROBES_WRONG: StudyMeasure = StudyMeasure {
    name: "probes_wrong",
    unit: "share of the questions",
    meaning: "weighted share of wrong answers to probes, over the questions of the main results; empty: no such question",
    meaning_in: "weighted share of wrong answers to probes in the {} trial",
    title: "share of wrong answers to probes",
    digits: 3,
    value: |trial| trial.probes.and_then(|probes| probes.share_wrong),
};

/// Row of the table of probes: a question of a freeze probe in a recording.
#[derive(Clone, Copy, Debug)]
pub struct ProbeRow<'a> {
    trial: &'a TrialStatistics,
    question: &'a ProbedQuestion,
}

pub fn probes<'a>(trial: &'a TrialStatistics, details: &'a TrialDetails) -> impl Iterator<Item = ProbeRow<'a>> {
    details.probes.iter().flat_map(|probes| &probes.questions).map(move |question| ProbeRow { trial, question })
}

impl ProbeRow<'_> {
    fn frozen<'a, T: Into<CsvCell<'a>>>(&'a self, value: impl Fn(&'a AspectAtFreeze) -> T) -> CsvCell<'a> {
        self.question.frozen.as_ref().map(value).into()
    }

    fn response(&self) -> &'static str {
        match self.question.response {
            ProbeResponse::Value(_) => "answered",
            ProbeResponse::Unsure => "unsure",
            ProbeResponse::Skipped => "skipped",
            ProbeResponse::Missing => "missing",
        }
    }
}

/// Text with the values to which the estimate gives at least the probability [`WORTH_TELLING`], the most probable
/// first.
fn told(frozen: &AspectAtFreeze) -> String {
    let mut told: Vec<(&String, f64)> = frozen.estimate_p.iter().map(|(name, p)| (name, *p)).collect();
    told.retain(|(_, p)| *p >= WORTH_TELLING);
    told.sort_by(|a, b| b.1.total_cmp(&a.1).then(a.0.cmp(b.0)));
    let told: Vec<String> = told.into_iter().map(|(name, p)| format!("{name}: {p:.4}")).collect();
    told.join("; ")
}

impl CsvRow for ProbeRow<'_> {
    const TABLE: CsvTable = CsvTable::Probes;

    fn columns() -> Vec<CsvColumn<Self>> {
        let mut columns = question();
        columns.extend(answer());
        columns.extend(frozen());
        columns
    }
}

type ProbeColumn<'a> = CsvColumn<ProbeRow<'a>>;

fn question<'a>() -> Vec<ProbeColumn<'a>> {
    let kind = "what is asked: order, recipe or place (what is); next_order, next_press (level 2: what comes next)";
    let main = "whether the question is part of the main results: scheduled, about what is, answered in time; see trials.counts, too";
    vec![
        ProbeRow::column("recording", "", "as in trials", |row| (&row.trial.recording).into()),
        ProbeRow::column("participant", "", "as in participants", |row| (&row.trial.participant).into()),
        ProbeRow::column("condition", "", "as in trials", |row| row.trial.condition.name().into()),
        ProbeRow::column("probe", "", "number of the probe in the trial, from 1", |row| row.question.probe.into()),
        ProbeRow::column("question", "", "number of the question in the probe, from 1", |row| {
            row.question.question.into()
        }),
        ProbeRow::column("time_s", "s", "time of the freeze on the trial's clock", |row| {
            rounded(row.question.time_s).into()
        }),
        ProbeRow::column("origin", "", "who asked for the probe: schedule or wizard", |row| {
            row.question.origin.name().into()
        }),
        ProbeRow::column("uses_estimate", "", "whether the estimate had a part in the choice of questions", |row| {
            row.question.uses_estimate.into()
        }),
        ProbeRow::column("kind", "", kind, |row| row.question.kind.name().into()),
        ProbeRow::column("aspect", "", "as in beliefs; of level 2 the kind", |row| (&row.question.aspect).into()),
        ProbeRow::column("inclusion", "probability", "probability with which the question was drawn", |row| {
            row.question.asked.inclusion.into()
        }),
        ProbeRow::column("weight", "", "1 / inclusion", |row| row.question.weight().into()),
        ProbeRow::column("in_main_results", "", main, |row| row.question.is_counted().into()),
    ]
}

fn answer<'a>() -> Vec<ProbeColumn<'a>> {
    let answer =
        "the answered value; \"something else\": none that was shown; empty: \"I don't know\", or none in time";
    let response = "answered (a value), unsure (\"I don't know\"), skipped (the wizard skipped the rest of the probe) or missing (nothing in time)";
    let wrong = "whether the answer differs from the truth; \"I don't know\" does; empty: no answer, or no truth";
    vec![
        ProbeRow::column(
            "truth",
            "",
            "the right answer: the true value, or \"something else\" where that was not shown (so in all columns); of level 2 what came next, empty: nothing did",
            |row| row.question.truth.as_ref().into(),
        ),
        ProbeRow::column("answer", "", answer, |row| row.question.answer().into()),
        ProbeRow::column("response", "", response, |row| row.response().into()),
        ProbeRow::column("wrong", "", wrong, |row| row.question.is_wrong().into()),
        ProbeRow::column("confidence", "", "1 (low) to 3 (high); empty: not asked", |row| {
            row.question.confidence.into()
        }),
        ProbeRow::column("took_s", "s", "time from the question's appearance to the answer", |row| {
            row.question.took_s.map(rounded).into()
        }),
    ]
}

/// Columns with truth, estimate and belief at the freeze; empty for questions about what comes next (level 2).
fn frozen<'a>() -> Vec<ProbeColumn<'a>> {
    let p_false = "probability by the estimate that the belief in the truth is below one half: the prediction that calibration judges";
    let believed = "probability of the true value in a simulated participant's belief";
    let unseen =
        "whether somebody else changed the location since the last look of 0.1 s or own press there; empty: a recipe";
    vec![
        ProbeRow::column("estimate", "", "most probable value in the estimated belief at the freeze", |row| {
            row.frozen(|one| &one.estimate)
        }),
        ProbeRow::column("estimate_p_truth", "probability", "probability of the true value in it", |row| {
            row.frozen(|one| one.estimate_p_truth)
        }),
        ProbeRow::column("estimate_p_false", "probability", p_false, |row| row.frozen(|one| one.estimate_p_false)),
        ProbeRow::column("estimate_p_answer", "probability", "probability of the answered value in it", |row| {
            let answer = row.question.answer();
            row.frozen(|one| answer.and_then(|answer| one.estimate_p.get(answer).copied()))
        }),
        ProbeRow::column("estimate_values", "", "its values of at least 0.01, each with its probability", |row| {
            row.frozen(told)
        }),
        ProbeRow::column("believed", "", "most probable value in a simulated participant's belief", |row| {
            row.frozen(|one| one.believed.as_ref().map(|own| &own.believes))
        }),
        ProbeRow::column("believed_p_truth", "probability", believed, |row| {
            row.frozen(|one| one.believed.as_ref().map(|own| own.p_truth))
        }),
        ProbeRow::column(
            "changed_s",
            "s",
            "time since the location's last change, without pauses; empty: a recipe, or not changed in the trial",
            |row| row.frozen(|one| one.changed_s.map(rounded)),
        ),
        ProbeRow::column("changed_unseen", "", unseen, |row| row.frozen(|one| one.changed_unseen)),
        ProbeRow::column("usual", "", "value that lay there longest until then; of a recipe the true one", |row| {
            row.frozen(|one| &one.usual)
        }),
        ProbeRow::column(
            "last_seen",
            "",
            "value that the participant last saw there, or made; of a recipe the true one",
            |row| row.frozen(|one| &one.last_seen),
        ),
        ProbeRow::column("values", "", "number of values that could be answered", |row| {
            row.frozen(|one| one.values as u64)
        }),
    ]
}
