//! The command `tomcom fit`.

use std::path::Path;

use super::args::FitArgs;
use super::failure::Failure;
use super::list::gathered_for_analysis;
use super::output::{print, progress};
use crate::run::files;
use tomcom_study::analysis::fitting;
use tomcom_study::fit;

pub(super) fn fit(args: &FitArgs) -> Result<(), Failure> {
    let start = args.start.as_deref().map(tomcom_session::files::read_human_model).transpose()?;
    let unwritable = |path: &Path, error: std::io::Error| {
        let help = "a place where a file can be written";
        Failure::Failed(miette::miette!(help = help, "{}: cannot be written: {error}", path.display()))
    };
    if let Some(path) = &args.out {
        // The output file is checked before the long search.
        files::check_fitted(path).map_err(|error| unwritable(path, error))?;
    }
    let recordings = gathered_for_analysis(&args.recordings)?;
    let trials = fit::FitTrials::read(&recordings, args.probes)?;
    let named: Vec<_> = args.parameters.iter().map(|one| one.parameter()).collect();
    let parameters = fitting::choose(&named, start.as_ref().unwrap_or(&trials.model)).map_err(|(found, instead)| {
        let help = format!("--parameters without it; or --start FILE, {instead}");
        Failure::Wrong(miette::miette!(help = help, "found a parameter that cannot be fitted: {found}"))
    })?;
    let plan = fitting::FitSettings { parameters, start, most_tries: args.tries as usize };
    let searches = if args.probes { 2 } else { 1 };
    let bar = progress(searches * plan.most_tries as u64, "tries of parameters at most");
    let found = fit::fit(&trials, &plan, || bar.inc(1));
    bar.finish_and_clear();
    if let Some(path) = &args.out {
        let written = files::write_human_model(path, &found.model, &fitting::comment(&found));
        written.map_err(|error| unwritable(path, error))?;
    }
    print(args.format, &found, || fitting::describe(&found))
}
