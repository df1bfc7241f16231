//! Command `tomcom fit RECORDING...`: reads recordings, and computes their likelihood on all processors for
//! [`crate::analysis::fitting`].

use std::path::{Path, PathBuf};

pub use crate::analysis::fitting::FitTrials;
use crate::analysis::fitting::{self, FitSettings, FitSummary, IntervalNarrowing, OtherModel, in_words};
use crate::gathered::GatheredRecordings;
use crate::grouping::grouped;
use crate::parallel::WorkerPool;
use crate::standing::exclusion_status;
use tomcom_core::kitchen::cost_to_go::CostToGo;
use tomcom_core::mind::fitting::{FitObservations, ProbeAnswerObservation, TrialLikelihood, likelihood};
use tomcom_core::mind::model::HumanModel;
use tomcom_core::mind::observation::Observation;
use tomcom_session::files::file_error::{FileError, FileResult};
use tomcom_session::probes::{ProbeEvent, ProbeQuestion};
use tomcom_session::replay::{RecordingReplay, SameKitchenCheck};
use tomcom_session::{Event, probe_sampling};

impl FitTrials {
    /// Reads recordings for a fit, without practice and excluded ones; answers to freeze probes are read only with
    /// `probes`. Errors: a recording cannot be read or replayed; the recordings are of different kitchens; there are no
    /// answers although `probes` asks for them.
    pub fn read(recordings: &GatheredRecordings, probes: bool) -> FileResult<FitTrials> {
        let recordings = &recordings.paths;
        let (mut one_kitchen, mut observations, mut left_out) = (SameKitchenCheck::default(), Vec::new(), Vec::new());
        let mut models = Vec::new();
        for recording in recordings {
            let mut replay = RecordingReplay::open(recording)?;
            one_kitchen.admit(recording, &replay.session().kitchen)?;
            let (own, name) = (read_trial(&mut replay)?, recording.display().to_string());
            if let Some(reason) = not_counted(&replay)? {
                left_out.push(format!("{name}: {reason}"));
                continue;
            }
            models.push((replay.session().spec.human.clone(), name));
            observations.push(if probes { own } else { FitObservations { answers: Vec::new(), ..own } });
        }
        if probes && observations.iter().all(|one| one.answers.is_empty()) {
            let first = recordings.first().map_or(Path::new("."), PathBuf::as_path);
            let found = "no answer to a freeze probe in any of the recordings".to_string();
            return Err(FileError::from_finding(
                first,
                found,
                "recordings with freeze probes, or the command without --probes".to_string(),
            ));
        }
        let kitchen = one_kitchen.kitchen()?;
        let mut models = grouped(models).into_iter();
        let model = models.next().map(|(model, _)| model).unwrap_or_default();
        let others = models.map(|(model, recordings)| OtherModel { model: in_words(&model), recordings }).collect();
        Ok(FitTrials { kitchen, model, others, left_out, observations })
    }

    fn without_answers(&self) -> FitTrials {
        let mut trials = self.clone();
        trials.observations.iter_mut().for_each(|one| one.answers.clear());
        trials
    }
}

/// Why a recording that was read to its end is left out, in words; `None` for one that counts.
fn not_counted(replay: &RecordingReplay) -> FileResult<Option<String>> {
    if replay.session().spec.step.as_ref().is_some_and(|step| step.period.is_none()) {
        return Ok(Some("practice".to_string()));
    }
    let standing = exclusion_status(replay.session(), replay.log())?;
    Ok((!standing.counts()).then(|| standing.describe()))
}

/// Observations and probe answers of a recorded trial, without answers about what comes next.
fn read_trial(replay: &mut RecordingReplay) -> FileResult<FitObservations> {
    let mut trial = FitObservations { seed: replay.session().seed(), ..FitObservations::default() };
    let mut questions: Vec<ProbeQuestion> = Vec::new();
    let mut frozen = 0;
    while let Some(event) = replay.step()? {
        if let Some(what) = replay.follower.observed(&event.stamped, &event.change) {
            trial.observations.push(Observation { time: event.stamped.time, what });
        }
        match event.stamped.event {
            Event::Probe(ProbeEvent::Begun { questions: drawn, .. }) => {
                (questions, frozen) = (drawn, trial.observations.len());
            }
            Event::Probe(ProbeEvent::Answered { question, answer, .. }) => {
                let asked = (question as usize).checked_sub(1).and_then(|index| questions.get(index));
                let kitchen = &replay.session().kitchen;
                let aspect = asked.and_then(|asked| probe_sampling::aspect(kitchen, &asked.about));
                trial.answers.extend(aspect.map(|aspect| {
                    let value = answer.and_then(|answer| kitchen.aspects[aspect.index()].value_named(&answer));
                    ProbeAnswerObservation { after: frozen, aspect, value }
                }));
            }
            _ => {}
        }
    }
    Ok(trial)
}

/// Fits the parameters that `plan` names to trials. `tried` is called after each evaluation. If there are answers to
/// freeze probes, the fit is repeated without answers, to tell what the answers add.
pub fn fit(trials: &FitTrials, plan: &FitSettings, tried: impl Fn()) -> FitSummary {
    let mut found = fit_once(trials, plan, &tried);
    if let Some(answers) = &mut found.answers {
        let alone = fit_once(&trials.without_answers(), plan, &tried);
        let both = plan.parameters.iter().zip(alone.parameters.iter().zip(&found.parameters));
        let shrinkage = both.map(|(parameter, (alone, with))| {
            IntervalNarrowing::between(*parameter, alone.value, alone.interval, with.interval)
        });
        answers.shrinkage = shrinkage.collect();
    }
    found
}

fn fit_once(trials: &FitTrials, plan: &FitSettings, tried: impl Fn()) -> FitSummary {
    let kitchen = &trials.kitchen;
    // Each thread keeps its cache of costs to go between evaluations of the likelihood.
    let pool = WorkerPool::new(|| CostToGo::new(kitchen.clone()));
    let of_all = |model: &HumanModel| {
        let of_trial = |cost: &mut CostToGo, trial: &FitObservations| likelihood(kitchen, model, trial, cost);
        // Trials' likelihoods are added in the order of the trials, so that the sum does not depend on the number of
        // threads.
        let found = pool.each(&trials.observations, of_trial, || {});
        found.into_iter().fold(TrialLikelihood::default(), TrialLikelihood::plus)
    };
    fitting::fit(trials, plan, of_all, tried)
}
