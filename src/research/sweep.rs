//! Command `tomcom-research sweep`: sensitivity of results to settings (parameter sweep). The same trials are
//! simulated for every value of a setting and without signals, with the same participants, orders and random streams,
//! so that differences are paired by trial.

use std::path::Path;
use std::str::FromStr;
use std::sync::Arc;

use serde::Serialize;

use tomcom_core::base::text::PathText;
use tomcom_core::base::text::decimal;
use tomcom_core::communication::concept::ConceptName;
use tomcom_core::communication::settings::ShadowMode;
use tomcom_core::kitchen::cost_to_go::CostToGo;
use tomcom_core::mind::fitting::HumanModelParameter;
use tomcom_session::SessionSpec;
use tomcom_session::files::file_error::FileError;
use tomcom_session::files::overwrite;
use tomcom_session::headless::{Outside, SimulationShard};
use tomcom_session::log::RecordingError;
use tomcom_session::log::RecordingWriteError;
use tomcom_session::settings::{Condition, GazeSource};
use tomcom_study::analysis::kitchen_summary::plan_lengths;
use tomcom_study::analysis::trial_summary::{SimulationSummary, SimulationSums, TrialSummary};
use tomcom_study::files::simulated_trials::{SimulationRequest, describe_moved, each_trial};

/// Name of the results table's file in the folder of the recordings; shards have file names of their own.
pub const TABLE_NAME: &str = "sweep.csv";
const PART_NAME: &str = "sweep-part";
const MAX_CELLS: usize = 1000;

/// A setting whose values can be swept (varied between simulations).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Knob {
    /// Of communication, in presses.
    Cost,
    /// Of the concept ToM.
    Threshold,
    Horizon,
    Rollouts,
    Tau,
    Radius,
    /// Whether the assistant uses gaze to estimate beliefs.
    Gaze,
}

const KNOBS: [(&str, Knob); 7] = [
    ("cost", Knob::Cost),
    ("threshold", Knob::Threshold),
    ("horizon", Knob::Horizon),
    ("rollouts", Knob::Rollouts),
    ("tau", Knob::Tau),
    ("radius", Knob::Radius),
    ("gaze", Knob::Gaze),
];

/// A swept setting with its values, as in `cost=0.5,1,1.5`.
#[derive(Clone, Debug, PartialEq)]
pub struct ParameterSweepAxis {
    name: &'static str,
    knob: Knob,
    /// Values of the swept setting as the user typed them; each is valid for the setting.
    values: Vec<String>,
}

impl FromStr for ParameterSweepAxis {
    type Err = String;

    fn from_str(text: &str) -> Result<ParameterSweepAxis, String> {
        let names: Vec<&str> = KNOBS.iter().map(|(name, _)| *name).collect();
        let right = || format!("SETTING=VALUE,VALUE,…, with one of {}", names.join(", "));
        let (name, values) = text.split_once('=').ok_or_else(right)?;
        let (name, knob) = *KNOBS.iter().find(|(known, _)| *known == name).ok_or_else(right)?;
        let values: Vec<String> = values.split(',').map(str::to_string).collect();
        let is_right = |value: &String| match knob {
            Knob::Gaze => value == "on" || value == "off",
            Knob::Horizon | Knob::Rollouts => value.parse::<usize>().is_ok(),
            _ => value.parse::<f64>().is_ok_and(f64::is_finite),
        };
        let is_twice = |index: &usize| values[..*index].contains(&values[*index]);
        if let Some(index) = (0..values.len()).find(is_twice) {
            return Err(format!("{name}={} twice: right would be each value once", values[index]));
        }
        match values.iter().find(|value| !is_right(value)) {
            None => Ok(ParameterSweepAxis { name, knob, values }),
            Some(wrong) => {
                let right = match knob {
                    Knob::Gaze => "on and off",
                    Knob::Horizon | Knob::Rollouts => "whole numbers",
                    _ => "numbers",
                };
                Err(format!("\"{wrong}\": {name} takes {right}"))
            }
        }
    }
}

impl ParameterSweepAxis {
    /// Applies a value of the swept setting to the settings; the value was validated when it was parsed.
    fn set(&self, spec: &mut SessionSpec, value: &str) {
        let number = value.parse().unwrap_or_default();
        let whole = value.parse().unwrap_or_default();
        match self.knob {
            Knob::Cost => spec.assistant.cost_of_communication = number,
            Knob::Threshold => spec.assistant.belief_threshold = number,
            Knob::Horizon => spec.assistant.rollout.horizon = whole,
            Knob::Rollouts => {
                spec.assistant.rollout.rollouts = whole;
                spec.assistant.rollout.least_rollouts = spec.assistant.rollout.least_rollouts.min(whole);
            }
            Knob::Tau => HumanModelParameter::Tau.set(&mut spec.human, number),
            Knob::Radius => HumanModelParameter::RadiusDeg.set(&mut spec.human, number),
            Knob::Gaze if value == "off" => spec.participant.gaze = GazeSource::None,
            Knob::Gaze => {}
        }
    }
}

/// Numbers of errors and of presses of the human in a trial.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PressErrorCounts {
    pub errors: u64,
    /// Number of errors that follow from false beliefs; `None` where the participant's beliefs are not known.
    pub related: Option<u64>,
    pub human_actions: u64,
}

/// Row of a parameter sweep: results of the trials with one combination of setting values.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ParameterSweepRow {
    /// Values of the varied settings, by the setting's name; empty in the row without signals.
    pub settings: serde_json::Map<String, serde_json::Value>,
    pub trials: u64,
    pub errors_per_100: f64,
    pub signals_per_100: f64,
    /// Reduction of the errors per 100 presses of the human compared with no signals: mean over the same trials.
    pub spared_per_100: Option<f64>,
    pub spared_error: Option<f64>,
    /// Mean number of errors in an error sequence; null without sequences.
    pub mean_sequence_length: Option<f64>,
    /// Median over served orders of the number of presses of both agents since the previously served order; null if no order was served.
    pub presses_per_order: Option<f64>,
    /// Errors that follow from false beliefs, per 100 presses of the human; null if the participants' beliefs are not
    /// known.
    pub related_per_100: Option<f64>,
    /// Reduction of the errors per 100 presses of the human compared with the first row with signals: mean over the
    /// same trials.
    pub fewer_than_first: Option<f64>,
    pub fewer_error: Option<f64>,
    /// Reduction of the errors from false beliefs per 100 presses of the human compared with the first row with
    /// signals: mean over the same trials.
    pub related_fewer_than_first: Option<f64>,
    pub related_fewer_error: Option<f64>,
}

/// The same trials simulated under two combinations of setting values, in the same order.
type PairedTrials<'a> = [&'a [PressErrorCounts]; 2];

impl ParameterSweepRow {
    /// The row for these setting values. `paired`: the same trials without and with signals. `with_first`: the same
    /// trials in the first row with signals, and in this row.
    pub fn new(
        settings: &[(&str, String)],
        figures: &SimulationSummary,
        paired: Option<PairedTrials>,
        with_first: Option<PairedTrials>,
    ) -> ParameterSweepRow {
        let errors = |trial: &PressErrorCounts| Some(trial.errors);
        let related = |trial: &PressErrorCounts| trial.related;
        let (spared_per_100, spared_error) = fewer(paired, errors);
        let (fewer_than_first, fewer_error) = fewer(with_first, errors);
        let (related_fewer_than_first, related_fewer_error) = fewer(with_first, related);
        ParameterSweepRow {
            settings: settings.iter().map(|(name, value)| (name.to_string(), value.as_str().into())).collect(),
            trials: figures.trials,
            errors_per_100: per_100(figures.errors, figures.human_actions),
            signals_per_100: per_100(figures.signals, figures.human_actions),
            spared_per_100,
            spared_error,
            mean_sequence_length: figures.beliefs.mean_sequence_length,
            presses_per_order: figures.presses_per_order,
            related_per_100: figures.beliefs.belief_related_errors.map(|errors| per_100(errors, figures.human_actions)),
            fewer_than_first,
            fewer_error,
            related_fewer_than_first,
            related_fewer_error,
        }
    }
}

fn per_100(number: u64, presses: u64) -> f64 {
    100.0 * number as f64 / presses.max(1) as f64
}

/// Mean reduction of a number per 100 presses of the human between paired trials (first minus second), and its standard
/// error.
fn fewer(
    paired: Option<PairedTrials>,
    number: impl Fn(&PressErrorCounts) -> Option<u64>,
) -> (Option<f64>, Option<f64>) {
    let rate = |trial: &PressErrorCounts| number(trial).map(|number| per_100(number, trial.human_actions));
    let Some([before, after]) = paired else { return (None, None) };
    let each = before.iter().zip(after).map(|(before, after)| Some(rate(before)? - rate(after)?));
    let Some(each) = each.collect::<Option<Vec<f64>>>().filter(|each| !each.is_empty()) else { return (None, None) };
    let count = each.len() as f64;
    let mean = each.iter().sum::<f64>() / count;
    let squares = each.iter().map(|one| (one - mean) * (one - mean)).sum::<f64>();
    (Some(mean), (count > 1.0).then(|| (squares / (count - 1.0) / count).sqrt()))
}

/// One combination of values: the swept settings by name, with values as typed.
type Cell = Vec<(&'static str, String)>;

/// Table of results for every combination of values of the swept settings.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ParameterSweepSummary {
    pub rows: Vec<ParameterSweepRow>,
    pub table: PathText,
    /// New paths of logs that ended before the end of their header; the trials of these logs were simulated again.
    pub moved: Vec<String>,
}

pub fn trials(simulation: &SimulationRequest, axes: &[ParameterSweepAxis]) -> u64 {
    let cells: usize = axes.iter().map(|axis| axis.values.len()).product();
    (cells as u64 + 1) * simulation.own_trials().count() as u64
}

/// Simulates the trials for every combination of the values, each combination in a folder of its own, and writes the
/// results table beside the folders. `done` is called after each trial.
///
/// # Errors
/// The errors of simulations, too many combinations, or an invalid value.
pub fn sweep(
    simulation: &SimulationRequest,
    axes: &[ParameterSweepAxis],
    done: impl Fn() + Sync,
) -> Result<ParameterSweepSummary, RecordingError> {
    let cells = grid(axes)?;
    let table = simulation.out.join(table_name(simulation.shard));
    let unwritable = |reason| RecordingWriteError::Unwritable { path: table.clone(), reason, saved: None };
    overwrite::check(&table, "a table of a sweep", |head| head.starts_with(b"condition,trials,"))
        .map_err(unwritable)?;
    check_axes(&simulation.files.spec, axes)?;
    let specs = cells.iter().map(|cell| spec_of(&simulation.files.spec, axes, cell)).collect::<Result<Vec<_>, _>>()?;
    let mut unassisted = simulation.clone();
    unassisted.files.spec.trial.condition = Condition::None;
    unassisted.out = simulation.out.join("unassisted");
    let (before, figures) = of_cell(&unassisted, &done)?;
    let mut moved = figures.moved.clone();
    let mut rows = vec![ParameterSweepRow::new(&Cell::new(), &figures, None, None)];
    let mut first = None;
    for (cell, spec) in cells.iter().zip(specs) {
        let mut one = simulation.clone();
        one.files.spec = spec;
        one.out = simulation.out.join(folder_of(cell));
        let (trials, figures) = of_cell(&one, &done)?;
        let with_first = first.as_ref().map(|first: &Vec<PressErrorCounts>| [&first[..], &trials]);
        rows.push(ParameterSweepRow::new(cell, &figures, Some([&before, &trials]), with_first));
        first.get_or_insert(trials);
        moved.extend(figures.moved);
    }
    write_table(&table, axes, &rows).map_err(unwritable)?;
    Ok(ParameterSweepSummary { rows, table: table.into(), moved })
}

/// File name of the results table. Each shard has its own table; the whole table is made from all recordings.
fn table_name(shard: SimulationShard) -> String {
    match shard {
        SimulationShard::WHOLE => TABLE_NAME.to_string(),
        SimulationShard { number, of } => format!("{PART_NAME}-{number}-of-{of}.csv"),
    }
}

/// All combinations of the swept settings' values; the values of the last setting vary fastest.
fn grid(axes: &[ParameterSweepAxis]) -> Result<Vec<Cell>, RecordingError> {
    let wrong =
        |found: String, remedy: String| Err(FileError::from_finding(Path::new("--sweep"), found, remedy).into());
    let twice = axes.iter().enumerate().find(|(index, axis)| axes[..*index].iter().any(|one| one.name == axis.name));
    if let Some((_, axis)) = twice {
        return wrong(format!("{} twice", axis.name), "each setting once, with all of its values".to_string());
    }
    let count: usize = axes.iter().map(|axis| axis.values.len()).product();
    if count > MAX_CELLS {
        return wrong(format!("{count} combinations"), format!("at most {MAX_CELLS}"));
    }
    let mut cells = vec![Cell::new()];
    for axis in axes {
        let longer = |cell: &Cell, value: &String| {
            let mut cell = cell.clone();
            cell.push((axis.name, value.clone()));
            cell
        };
        cells = cells.iter().flat_map(|cell| axis.values.iter().map(move |value| longer(cell, value))).collect();
    }
    Ok(cells)
}

/// Refuses swept settings of a concept that the session does not use.
fn check_axes(spec: &SessionSpec, axes: &[ParameterSweepAxis]) -> Result<(), RecordingError> {
    let decides = match spec.trial.condition {
        Condition::Assistant => Some(spec.assistant.concept.name()),
        Condition::Wizard | Condition::None => None,
    };
    let of = |knob: Knob| match knob {
        Knob::Cost | Knob::Horizon | Knob::Rollouts => Some(ConceptName::TomCom),
        Knob::Threshold => Some(ConceptName::Tom),
        Knob::Tau | Knob::Radius | Knob::Gaze => None,
    };
    for axis in axes {
        let Some(concept) = of(axis.knob).filter(|concept| decides != Some(*concept)) else { continue };
        let by = decides.map_or("the wizard", ConceptName::name);
        let found = format!("{}, a setting that only {} uses, where {by} decides", axis.name, concept.name());
        let remedy = format!("--condition assistant --concept {}, or another setting", concept.name());
        return Err(FileError::from_finding(Path::new("--sweep"), found, remedy).into());
    }
    Ok(())
}

fn spec_of(spec: &SessionSpec, axes: &[ParameterSweepAxis], cell: &Cell) -> Result<SessionSpec, RecordingError> {
    let mut spec = spec.clone();
    for (axis, (_, value)) in axes.iter().zip(cell) {
        axis.set(&mut spec, value);
    }
    match spec.check() {
        Ok(()) => Ok(spec),
        Err(error) => {
            let path = Path::new("--sweep");
            Err(FileError::from_finding(path, error.found, error.remedy.to_string()).into())
        }
    }
}

/// Folder name of a combination of values: "cost-1.5_gaze-off".
fn folder_of(cell: &Cell) -> String {
    cell.iter().map(|(name, value)| format!("{name}-{value}")).collect::<Vec<_>>().join("_")
}

/// Simulates and summarises the trials with one combination of setting values.
fn of_cell(
    simulation: &SimulationRequest,
    done: &(impl Fn() + Sync),
) -> Result<(Vec<PressErrorCounts>, SimulationSummary), RecordingError> {
    let mut simulation = simulation.clone();
    // Recommendations for trials without signals are not computed, since they would only take time.
    simulation.files.spec.assistant.shadow = ShadowMode::Off;
    let kitchen = Arc::new(simulation.files.kitchen.kitchen.clone());
    let plan_lengths = plan_lengths(&kitchen, &mut CostToGo::new(kitchen.clone()));
    let (mut trials, mut sums, mut moved) = (Vec::new(), SimulationSums::default(), Vec::new());
    each_trial(&simulation, Outside::NOTHING, done, |trial| {
        moved.extend(trial.moved.map(|log| log.display().to_string()));
        let TrialSummary { errors, human_actions, .. } = trial.figures;
        let related = trial.figures.beliefs.as_ref().map(|beliefs| beliefs.related);
        trials.push(PressErrorCounts { errors, related, human_actions });
        sums.add(trial.arm, &trial.figures, &plan_lengths);
        Ok(())
    })?;
    Ok((trials, SimulationSummary { moved, ..sums.figures() }))
}

/// A numeric column of the results table: its name, and how its value follows from a row.
type SweepColumn = (&'static str, fn(&ParameterSweepRow) -> Option<f64>);

/// The numeric columns of the results table; unknown values become empty cells.
const NUMBERS: [SweepColumn; 11] = [
    ("errors_per_100", |row| Some(row.errors_per_100)),
    ("signals_per_100", |row| Some(row.signals_per_100)),
    ("spared_per_100", |row| row.spared_per_100),
    ("spared_error", |row| row.spared_error),
    ("mean_sequence_length", |row| row.mean_sequence_length),
    ("presses_per_order", |row| row.presses_per_order),
    ("related_per_100", |row| row.related_per_100),
    ("fewer_than_first", |row| row.fewer_than_first),
    ("fewer_error", |row| row.fewer_error),
    ("related_fewer_than_first", |row| row.related_fewer_than_first),
    ("related_fewer_error", |row| row.related_fewer_error),
];

fn setting(row: &ParameterSweepRow, axis: &ParameterSweepAxis) -> String {
    row.settings.get(axis.name).and_then(|value| value.as_str()).unwrap_or_default().to_string()
}

fn write_table(path: &Path, axes: &[ParameterSweepAxis], rows: &[ParameterSweepRow]) -> std::io::Result<()> {
    let mut table = csv::Writer::from_writer(Vec::new());
    let names = ["condition", "trials"].into_iter().chain(axes.iter().map(|axis| axis.name));
    table.write_record(names.chain(NUMBERS.map(|(name, _)| name)))?;
    for (index, row) in rows.iter().enumerate() {
        let condition = if index == 0 { "unassisted" } else { "signals" };
        let settings = axes.iter().map(|axis| setting(row, axis));
        let first = [condition.to_string(), row.trials.to_string()].into_iter().chain(settings);
        let numbers = NUMBERS.iter().map(|(_, value)| value(row).map_or(String::new(), |value| format!("{value:.4}")));
        table.write_record(first.chain(numbers))?;
    }
    let bytes = table.into_inner().map_err(|error| std::io::Error::other(error.to_string()))?;
    overwrite::write(path, &bytes)
}

pub fn describe(figures: &ParameterSweepSummary, axes: &[ParameterSweepAxis]) -> String {
    let settings: String = axes.iter().map(|axis| format!("{:>13}", axis.name)).collect();
    let mut text = describe_moved(&figures.moved);
    text += &format!(
        "{settings}{:>12}{:>12}{:>18}{:>10}{:>15}{:>13}{:>18}\n",
        "errors/100", "signals/100", "errors spared", "sequence", "presses/order", "related/100", "related fewer"
    );
    for (index, row) in figures.rows.iter().enumerate() {
        let settings: String = match index {
            0 => format!("{:>width$}", "no signals", width = 13 * axes.len()),
            _ => axes.iter().map(|axis| format!("{:>13}", setting(row, axis))).collect(),
        };
        let with_error = |mean: Option<f64>, error: Option<f64>| {
            mean.map_or("-".to_string(), |mean| format!("{mean:.2} ± {}", decimal(error, 2)))
        };
        let spared = with_error(row.spared_per_100, row.spared_error);
        let fewer = with_error(row.related_fewer_than_first, row.related_fewer_error);
        text += &format!(
            "{settings}{:>12}{:>12}{spared:>18}{:>10}{:>15}{:>13}{fewer:>18}\n",
            decimal(Some(row.errors_per_100), 1),
            decimal(Some(row.signals_per_100), 1),
            decimal(row.mean_sequence_length, 2),
            decimal(row.presses_per_order, 1),
            decimal(row.related_per_100, 2),
        );
    }
    text + &format!(
        "numbers per 100 presses of the human; spared, fewer: mean and standard error over trials; related: belief \
         related errors, and how many fewer there are than in the first line with signals\n{}\n",
        figures.table.display()
    )
}
