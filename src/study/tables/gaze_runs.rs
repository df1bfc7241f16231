//! Table of gaze runs: series of successive gaze samples on the same location.

use crate::column::{CsvColumn, CsvRow, CsvTable};
use tomcom_core::base::time::SessionTime;
use tomcom_core::kitchen::{Kitchen, LocationId};
use tomcom_core::mind::rounded;

/// A gaze run: successive gaze samples on one location, or on none.
#[derive(Clone, Copy, Debug)]
pub struct GazeRun {
    /// Location at which the gaze was; `None` if it was at no location, or not usable.
    pub location: Option<LocationId>,
    /// Session time at which the first sample of the run was taken.
    pub began: SessionTime,
    /// Session time at which the last sample of the run was taken.
    pub last: SessionTime,
    /// Sums of x, y and confidence over the samples of the gaze run.
    pub sums: [f64; 3],
    /// Number of gaze samples in the run.
    pub samples: u64,
}

impl GazeRun {
    /// Mean over the gaze run of x (`of` is 0), y (1) or confidence (2).
    fn mean(&self, of: usize) -> f64 {
        rounded(self.sums[of] / self.samples as f64)
    }
}

/// Row of the table of gaze: a gaze run with its recording.
#[derive(Clone, Copy, Debug)]
pub struct GazeRow<'a> {
    /// Name of the recording in tables.
    pub recording: &'a str,
    /// The kitchen of the recording.
    pub kitchen: &'a Kitchen,
    /// Time at which the gaze run begins, on the trial's clock in seconds.
    pub time_s: f64,
    /// The gaze run of the row.
    pub run: GazeRun,
}

impl CsvRow for GazeRow<'_> {
    const TABLE: CsvTable = CsvTable::Gaze;

    fn columns() -> Vec<CsvColumn<Self>> {
        let time = "time of the run's first sample on the trial's clock";
        vec![
            Self::column("recording", "", "as in trials", |row| row.recording.into()),
            Self::column("time_s", "s", time, |row| rounded(row.time_s).into()),
            Self::column("duration_s", "s", "time from the first to the last sample of the run", |row| {
                rounded(row.run.last.secs_since(row.run.began)).into()
            }),
            Self::column("location", "", "location at the gaze point; empty: none, or unusable samples", |row| {
                row.run.location.map(|location| &row.kitchen.location(location).name).into()
            }),
            Self::column("x", "width of the display", "mean horizontal gaze position, from the left", |row| {
                row.run.mean(0).into()
            }),
            Self::column("y", "height of the display", "mean vertical gaze position, from the top", |row| {
                row.run.mean(1).into()
            }),
            Self::column("confidence", "0 to 1", "mean confidence that the eye tracker reported", |row| {
                row.run.mean(2).into()
            }),
            Self::column("samples", "samples", "number of samples in the run; events.jsonl has every sample", |row| {
                row.run.samples.into()
            }),
        ]
    }
}
