//! Command `tomcom compare RECORDING...`: reads recordings for [`crate::analysis::comparison_summary`].

use std::path::Path;

use crate::analysis::comparison_summary::RecordingSenderComparison;
use crate::gathered::GatheredRecordings;
use crate::parallel;
use crate::standing::exclusion_status;
use tomcom_core::base::text::count;
use tomcom_core::kitchen::cost_to_go::CostToGo;
use tomcom_session::files::file_error::{FileError, FileResult};
use tomcom_session::log::LogReader;
use tomcom_session::watcher::{SenderComparisonFollower, SenderComparisonSettings};

/// Matching windows that the option `--sweep` tries, in presses of the human.
pub const SWEEP: std::ops::RangeInclusive<u32> = 0..=10;

pub fn watch(
    recordings: &GatheredRecordings,
    request: &SenderComparisonSettings,
    done: impl Fn() + Sync,
) -> FileResult<Vec<RecordingSenderComparison>> {
    parallel::each(&recordings.paths, |recording| follow(recording, request), done).into_iter().collect()
}

fn follow(recording: &Path, request: &SenderComparisonSettings) -> FileResult<RecordingSenderComparison> {
    let mut log = LogReader::open(recording)?;
    let cost = CostToGo::new(log.kitchen.clone());
    let mut follower = SenderComparisonFollower::new(log.session(), cost, request);
    while let Some(line) = log.next_line()? {
        follower.apply(&line.stamped).map_err(|error| log.refused(&line, error))?;
    }
    let standing = exclusion_status(&follower.follower.session, &log)?;
    Ok(RecordingSenderComparison::new(recording.display().to_string(), follower, standing))
}

/// Errors: there is no unmatched communication with this number, or there are several recordings.
pub fn open(watched: &[RecordingSenderComparison], number: usize) -> FileResult<String> {
    let [one] = watched else {
        let found = format!("--open {number} with {} recordings", watched.len());
        let remedy = "one recording at a time".to_string();
        return Err(FileError::from_finding(Path::new("tomcom compare"), found, remedy));
    };
    let differences = &one.comparison.differences;
    let Some(difference) = number.checked_sub(1).and_then(|index| differences.get(index)) else {
        let found = format!("--open {number}, of {}", count(differences.len() as u64, "difference", "differences"));
        return Err(FileError::from_finding(
            Path::new(&one.recording),
            found,
            format!("the number of a difference in the list, from 1 to {}", differences.len()),
        ));
    };
    Ok(one.comparison.opened(one.kitchen(), difference).join("\n") + "\n")
}
