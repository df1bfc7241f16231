//! Table of the questions of freeze probes.

use crate::analysis::probe_record::{AspectAtFreeze, ProbeResponse, ProbedQuestion};
use crate::column::{CsvRow, CsvTable, TableCell, TableColumn, columns};
use crate::trial_statistics::{TrialDetails, TrialStatistics};
use tomcom_core::mind::{WORTH_TELLING, rounded};

#[derive(Clone, Copy, Debug)]
pub struct ProbeRow<'a> {
    trial: &'a TrialStatistics,
    question: &'a ProbedQuestion,
}

pub fn probes<'a>(trial: &'a TrialStatistics, details: &'a TrialDetails) -> impl Iterator<Item = ProbeRow<'a>> {
    details.probes.iter().flat_map(|probes| &probes.questions).map(move |question| ProbeRow { trial, question })
}

impl ProbeRow<'_> {
    fn frozen<'a, T: Into<TableCell<'a>>>(&'a self, value: impl Fn(&'a AspectAtFreeze) -> T) -> TableCell<'a> {
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

/// Values of at least [`WORTH_TELLING`], the most probable first.
fn told(frozen: &AspectAtFreeze) -> String {
    let mut told: Vec<(&String, f64)> = frozen.estimate_p.iter().map(|(name, p)| (name, *p)).collect();
    told.retain(|(_, p)| *p >= WORTH_TELLING);
    told.sort_by(|a, b| b.1.total_cmp(&a.1).then(a.0.cmp(b.0)));
    let told: Vec<String> = told.into_iter().map(|(name, p)| format!("{name}: {p:.4}")).collect();
    told.join("; ")
}

impl CsvRow for ProbeRow<'_> {
    const TABLE: CsvTable = CsvTable::Probes;

    fn columns() -> Vec<TableColumn<Self>> {
        columns! { |row: Self|
            "recording", "", "as in trials" => &row.trial.recording;
            "participant", "", "as in participants" => &row.trial.participant;
            "condition", "", "as in trials" => row.trial.condition.name();
            "probe", "", "number of the probe in the trial, from 1" => row.question.probe;
            "question", "", "number of the question in the probe, from 1" => row.question.question;
            "time_s", "s", "time of the freeze on the trial's clock" => rounded(row.question.time_s);
            "origin", "", "who asked for the probe: schedule or wizard" => row.question.origin.name();
            "uses_estimate", "", "whether the estimate had a part in the choice of questions"
                => row.question.uses_estimate;
            "kind", "", "what is asked: order, recipe or place (what is); next_order, next_press (level 2: what comes \
                next)" => row.question.kind.name();
            "aspect", "", "as in beliefs; of level 2 the kind" => &row.question.aspect;
            "inclusion", "probability", "probability with which the question was drawn" => row.question.asked.inclusion;
            "weight", "", "1 / inclusion" => row.question.weight();
            "in_main_results", "", "whether the question is part of the main results: scheduled, about what is, \
                answered in time; see trials.counts, too" => row.question.is_counted();
            "truth", "", "the right answer: the true value, or \"something else\" where that was not shown (so in all \
                columns); of level 2 what came next, empty: nothing did" => row.question.truth.as_ref();
            "answer", "", "the answered value; \"something else\": none that was shown; empty: \"I don't know\", or none in \
                time" => row.question.answer();
            "response", "", "answered (a value), unsure (\"I don't know\"), skipped (the wizard skipped the rest of \
                the probe) or missing (nothing in time)" => row.response();
            "wrong", "", "whether the answer differs from the truth; \"I don't know\" does; empty: no answer, or no \
                truth" => row.question.is_wrong();
            "confidence", "", "1 (low) to 3 (high); empty: not asked" => row.question.confidence;
            "took_s", "s", "time from the question's appearance to the answer; empty: no answer" => row.question.took_s.map(rounded);
            "estimate", "", "most probable value in the estimated belief at the freeze; empty: level 2"
                => row.frozen(|one| &one.estimate);
            "estimate_p_truth", "probability", "probability of the true value in it; empty: level 2"
                => row.frozen(|one| one.estimate_p_truth);
            "estimate_p_false", "probability", "probability by the estimate that the belief in the truth is below one \
                half: the prediction that calibration judges; empty: level 2" => row.frozen(|one| one.estimate_p_false);
            "estimate_p_answer", "probability", "probability of the answered value in it; empty: none, or level 2"
                => row.frozen(|one| one.estimate_p.get(row.question.answer()?).copied());
            "estimate_values", "", "its values of at least 0.01, each with its probability; empty: level 2" => row.frozen(told);
            "believed", "", "most probable value in a simulated participant's belief; empty: a person's, or level 2"
                => row.frozen(|one| one.believed.as_ref().map(|own| &own.believes));
            "believed_p_truth", "probability", "probability of the true value in that belief; empty as believed"
                => row.frozen(|one| one.believed.as_ref().map(|own| own.p_truth));
            "changed_s", "s", "time since the location's last change, without pauses; empty: a recipe, level 2, or not changed \
                in the trial" => row.frozen(|one| one.changed_s.map(rounded));
            "changed_unseen", "", "whether somebody else changed the location since the last look of 0.1 s or own \
                press there; empty: a recipe, or level 2" => row.frozen(|one| one.changed_unseen);
            "usual", "", "value that lay there longest until then; of a recipe the true one; empty: level 2"
                => row.frozen(|one| &one.usual);
            "last_seen", "", "value that the participant last saw there, or made; of a recipe the true one; empty: level 2"
                => row.frozen(|one| &one.last_seen);
            "values", "", "number of values that could be answered; empty: level 2" => row.frozen(|one| one.values as u64);

        }
    }
}
