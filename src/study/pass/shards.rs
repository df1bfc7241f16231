//! A study in parts: a shard of its recordings is analysed into one file, and the files are joined
//! ([`crate::study_part`]).
//!
//! The shard to which a recording belongs follows from the recording's header alone, by the rule of `tomcom simulate
//! --shard`. So a job that simulated shard 3 of 8 also analyses shard 3 of 8, whether the job has a folder of its own
//! or shares one with other jobs.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};
use std::sync::Arc;

use crate::figures::StudySummary;
use crate::files::export::AnalysisFolder;
use crate::files::study_part_file::{PartReader, PartWriter};
use crate::frozen_plan::{PlanVersions, RecordedPlan};
use crate::kept_cost::KeptCost;
use crate::parallel::{self, WorkerPool};
use crate::pass::reading::AnalysisScope;
use crate::pass::{AnalysisRequest, NamedRecordings, StudyError, analyse, conclude, frozen, keep};
use crate::planned_trial::{ForeignRecording, PlannedTrialKey, RecordingCopy, differing_copy, mixed_kinds};
use crate::study_part::{AnalysedRecording, PART_FORMAT, PartHeader, PartShared, check_parts, trial_index};
use tomcom_session::files::compile_kitchen;
use tomcom_session::files::file_error::{FileError, FileResult};
use tomcom_session::headless::SimulationShard;
use tomcom_session::log::{LogReader, rater_codes};
use tomcom_session::replay::SameKitchenCheck;
use tomcom_session::settings::ParticipantKind;

/// Number of recordings that are analysed before their results are written, which bounds memory.
const BLOCK: usize = 32;

/// Analyses a shard of these recordings and writes the result to the file `analysis.out`. `begun` is called with the
/// number of the shard's recordings, which is also returned, and `done` after each recording. Errors: a recording
/// cannot be read or replayed, or belongs to another kitchen than the first; or the file cannot be written.
pub fn analyse_shard(
    analysis: &AnalysisRequest,
    recordings: NamedRecordings,
    shard: SimulationShard,
    begun: impl FnOnce(usize),
    done: impl Fn() + Sync,
) -> Result<u64, StudyError> {
    let header = |(path, _): &(PathBuf, String)| LogReader::open(path).map(|log| log.header);
    let headers = parallel::each(&recordings.found, header, || ());
    // Named raters are checked when the parts are joined: a part alone may be without codes of one.
    let raters = match &analysis.scope.raters {
        Some(named) => Some(named.clone()),
        None => recordings.raters(analysis)?,
    };
    let scope = AnalysisScope { raters, ..analysis.scope.clone() };
    let (mut own, mut plans, mut left_out) = (Vec::new(), BTreeSet::new(), BTreeSet::new());
    let mut versions = PlanVersions::default();
    for (recording, header) in recordings.found.into_iter().zip(headers) {
        let header = header?;
        if trial_index(header.session.step.as_ref(), header.trial) % shard.of == shard.number - 1 {
            plans.extend(RecordedPlan::from_header(&header).plan);
            versions.add(&recording.1, &header);
            own.push(recording);
        } else {
            left_out.insert(recording.1);
        }
    }
    begun(own.len());
    let header = PartHeader {
        study_part: PART_FORMAT,
        program: env!("CARGO_PKG_VERSION").to_string(),
        shard: shard.number,
        shards: shard.of,
        recordings: own.len() as u64,
        left_out,
        copies: recordings.copies.into_iter().collect(),
        foreign: recordings.foreign.into_iter().collect(),
        analysis: analysis.scope.clone(),
        plans,
    };
    let Some((first, _)) = own.first() else {
        PartWriter::create(&analysis.out, &header, &PartShared::default())?.finish()?;
        return Ok(0);
    };
    let log = LogReader::open(first)?;
    let kitchen = Some([log.header.layout.clone(), log.header.recipes.clone()]);
    let mut part = PartWriter::create(&analysis.out, &header, &PartShared { kitchen, versions })?;
    let workers = WorkerPool::new(KeptCost::default);
    let work =
        |kept: &mut KeptCost, recording: &(PathBuf, String)| analyse(recording, &scope, (first, &log.kitchen), kept);
    for block in own.chunks(BLOCK) {
        for analysed in workers.each(block, work, &done) {
            let (recording, rows) = analysed?;
            part.add(&recording, &rows)?;
        }
    }
    part.finish()?;
    Ok(header.recordings)
}

/// Joins the parts of a study, the files `analysis.paths`: the results are those of one analysis of all recordings, to
/// the last byte. Returns the summary and the path of the report. Errors: a file is no part of a study; the parts do
/// not make one study; a recording is in two parts, or in none although a part saw it; no trial counts; or
/// the results cannot be written.
pub fn join(analysis: &AnalysisRequest) -> Result<(StudySummary, PathBuf), StudyError> {
    let frozen = frozen(analysis)?;
    let mut parts = analysis.paths.iter().map(|path| PartReader::open(path)).collect::<FileResult<Vec<_>>>()?;
    let headers: Vec<PartHeader> = parts.iter().map(|part| part.header.clone()).collect();
    check_parts(&headers)
        .map_err(|wrong| FileError::from_finding(parts[wrong.index].path(), wrong.found, wrong.remedy))?;
    let mut kitchen = SameKitchenCheck::default();
    for part in &parts {
        if let Some([layout, recipes]) = &part.shared.kitchen {
            let own = compile_kitchen(
                (layout.path.as_ref(), layout.text.clone()),
                (recipes.path.as_ref(), recipes.text.clone()),
            )?;
            kitchen.admit(part.path(), &Arc::new(own.kitchen))?;
        }
    }
    let analysis = &AnalysisRequest { scope: headers[0].analysis.clone(), ..analysis.clone() };
    let export = AnalysisFolder::create(&analysis.out)?;
    let (mut joined, mut versions) = (JoinedRecordings::default(), PlanVersions::default());
    for part in &mut parts {
        versions.join(&part.shared.versions);
        joined.copies.extend(part.header.copies.iter().cloned());
        joined.foreign.extend(part.header.foreign.iter().cloned());
        while let Some((recording, rows)) = part.next_recording()? {
            if let Some(index) = joined.admit(part.path(), &recording, &export)? {
                keep(&export, &analysis.scope, index, &recording, &rows)?;
            }
        }
    }
    let JoinedRecordings { number, names, copies, foreign, raters, .. } = joined;
    let lost =
        parts.iter().find_map(|part| Some((part, part.header.left_out.iter().find(|name| !names.contains(*name))?)));
    if let Some((part, name)) = lost {
        let found = format!("a part that left out the recording {name}, which no other part has");
        let remedy = "the number of its own recordings for each part, such as --shard 3/8 for shards/3; parts that were \
                      made before a recording was deleted are made anew";
        return Err(FileError::from_finding(part.path(), found, remedy.to_string()).into());
    }
    // A shard alone may be without codes of a rater.
    if let Some(named) = &analysis.scope.raters {
        rater_codes::check_named(Path::new("--raters"), named, &raters)?;
    }
    let left = (copies.into_iter().collect(), foreign.into_iter().collect());
    conclude(number, analysis, &export, frozen.map(|frozen| (frozen, versions)), left)
}

/// The recordings of a study's parts. Parts of different folders can have copies, or the same trial.
#[derive(Debug, Default)]
struct JoinedRecordings {
    number: usize,
    names: BTreeSet<String>,
    /// By the digest of a log: the number under which the first recording with this log is kept, and its place.
    logs: BTreeMap<String, (usize, String)>,
    /// By trial: the place of the recording that counts for it.
    trials: BTreeMap<PlannedTrialKey, String>,
    copies: BTreeSet<RecordingCopy>,
    foreign: BTreeSet<ForeignRecording>,
    /// Whether the trials are of simulated participants, and the place of the first.
    kind: Option<(bool, String)>,
    raters: BTreeSet<String>,
}

impl JoinedRecordings {
    /// The number under which a recording of the part at this path is kept; `None` if it is a copy of an earlier one. A
    /// copy that counts takes the place of one that is left out.
    fn admit(
        &mut self,
        part: &Path,
        recording: &AnalysedRecording,
        export: &AnalysisFolder,
    ) -> Result<Option<usize>, StudyError> {
        let wrong = |(found, remedy): (String, String)| Err(FileError::from_finding(part, found, remedy).into());
        let place = format!("{} in {}", recording.recording, part.display());
        if let Some(pair) = recording.trial.as_ref().and_then(|(trial, ..)| trial.raters.as_ref()) {
            let coded = pair.raters.iter().zip(&pair.codes).filter(|(_, codes)| !codes.0.is_empty());
            self.raters.extend(coded.map(|(rater, _)| rater.clone()));
        }
        if let Some((trial, ..)) = &recording.trial {
            let is_simulated = trial.kind == ParticipantKind::Simulated;
            match &self.kind {
                Some((kind, first)) if *kind != is_simulated => return wrong(mixed_kinds(is_simulated, first)),
                Some(_) => {}
                None => self.kind = Some((is_simulated, place.clone())),
            }
        }
        let mut index = self.number;
        if let Some((first, first_place)) = self.logs.get(&recording.digest) {
            let kept = export.kept_analysed(*first)?;
            let copy = |recording: String, copy_of: String, own: &AnalysedRecording| RecordingCopy {
                recording,
                copy_of,
                left_out: own.left_out().cloned(),
            };
            if !recording.counts() || kept.counts() {
                if recording.counts() && !recording.is_copy_of(&kept) {
                    return wrong(differing_copy(first_place));
                }
                self.names.insert(recording.recording.clone());
                self.copies.insert(copy(place, first_place.clone(), recording));
                return Ok(None);
            }
            self.copies.insert(copy(first_place.clone(), place.clone(), &kept));
            index = *first;
        }
        if let Some(trial) = recording.counted_trial() {
            if let Some(first) = self.trials.get(&trial) {
                return wrong(trial.counted_twice(first));
            }
            self.trials.insert(trial, place.clone());
        }
        let is_new = self.names.insert(recording.recording.clone());
        if index == self.number {
            if !is_new {
                let found = format!("the recording {}, which is in another part, too", recording.recording);
                return wrong((found, "each recording once".to_string()));
            }
            self.number += 1;
        }
        self.logs.insert(recording.digest.clone(), (index, place));
        Ok(Some(index))
    }
}
