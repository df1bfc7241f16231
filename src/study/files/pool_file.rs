//! Files of pools (simulated participants for power analyses) in the format JSON Lines, of the table of power, and of
//! frozen plans.

use std::fs::File;
use std::io::{self, ErrorKind, Read};
use std::ops::Range;
use std::path::{Path, PathBuf};

use serde::Serialize;
use serde::de::DeserializeOwned;
use sha2::{Digest, Sha256};

use crate::files::export::{check_csv, write_csv};
use crate::frozen_plan::{FROZEN_FORMAT, FrozenPlan};
use crate::pool::{POOL_FORMAT, PoolHeader, SimulationPool};
use crate::power::{PowerSummary, SampleSizePower, TestPower};
use tomcom_session::files::file_error::{FileError, FileResult, read_bytes, read_text};
use tomcom_session::files::{overwrite, replace_file};

/// Largest size of a pool's file, in bytes.
const MAX_POOL: u64 = 1 << 30;
const REMEDY: &str = "a pool that tomcom power or tomcom arms wrote with --out";

/// Reads the parts of a pool of simulated participants and joins them. Errors: a file cannot be read, is no pool of
/// this format, or the parts do not belong to one pool.
pub fn read_pool(paths: &[PathBuf]) -> FileResult<SimulationPool> {
    let parts = paths.iter().map(|path| read_part(path)).collect::<FileResult<Vec<_>>>()?;
    SimulationPool::joined(parts).map_err(|wrong| {
        let path = paths.get(wrong.index).map_or(Path::new("--from"), PathBuf::as_path);
        FileError::from_finding(path, wrong.found, wrong.remedy)
    })
}

fn read_part(path: &Path) -> FileResult<SimulationPool> {
    let unreadable = |reason| FileError::unreadable(path, reason, REMEDY);
    let text = String::from_utf8(read_bytes(path, MAX_POOL).map_err(unreadable)?)
        .map_err(|error| unreadable(io::Error::new(io::ErrorKind::InvalidData, error.utf8_error())))?;
    let mut lines = Vec::new();
    let mut start = 0;
    for line in text.split_inclusive('\n') {
        lines.push((start..start + line.trim_end().len(), line));
        start += line.len();
    }
    let Some(((place, first), trials)) = lines.split_first() else {
        return Err(FileError::from_finding(path, "an empty file".to_string(), REMEDY.to_string()));
    };
    let at = |place: &Range<usize>, found: String, remedy: &str| {
        FileError::at(path, &text, Some(place.clone()), found, remedy.to_string())
    };
    let header: PoolHeader = parsed(first).map_err(|found| at(place, found, REMEDY))?;
    if header.pool != POOL_FORMAT {
        let remedy = format!("a pool of format {POOL_FORMAT}, or the version of the program that wrote it");
        return Err(at(place, format!("a pool of format {}", header.pool), &remedy));
    }
    let read = trials.iter().map(|(place, line)| parsed(line).map_err(|found| at(place, found, REMEDY)));
    let read = read.collect::<FileResult<Vec<_>>>()?;
    SimulationPool::from_trials(header, read).map_err(|wrong| {
        let place = trials.get(wrong.index).map_or(place, |(place, _)| place);
        at(place, wrong.found, &wrong.remedy)
    })
}

fn parsed<T: DeserializeOwned>(line: &str) -> Result<T, String> {
    serde_json::from_str(line).map_err(|error| format!("a line that is not a line of a pool: {error}"))
}

/// Checks that a pool with this header can be written to this path. A pool takes long to simulate, so a file with
/// another pool is not overwritten. Errors: there is a file at the path that is not this pool.
pub fn check_pool(path: &Path, header: &PoolHeader) -> FileResult<()> {
    let own = line(header);
    let is_own = |head: &[u8]| overwrite::first_line(head) == own.trim_end().as_bytes();
    overwrite::check(path, "the same pool", is_own).map_err(|reason| FileError::unwritable(path, reason))
}

/// Writes the file of a pool of simulated participants, completely or not at all. Errors: there is a file at the path
/// that is not this pool, or the folder cannot be written to.
pub fn write_pool(path: &Path, pool: &SimulationPool) -> FileResult<()> {
    check_pool(path, &pool.header)?;
    let mut text = line(&pool.header);
    for trial in pool.trials() {
        text += &line(&trial);
    }
    overwrite::write(path, text.as_bytes()).map_err(|reason| FileError::unwritable(path, reason))
}

fn line(value: &impl Serialize) -> String {
    // Writing JSON cannot fail here, since headers and trials contain only string keys and finite numbers.
    serde_json::to_string(value).unwrap_or_default() + "\n"
}

type PowerColumn = (&'static str, fn(&SampleSizePower, &TestPower) -> String);

const COLUMNS: [PowerColumn; 12] = [
    ("participants", |size, _| size.participants.to_string()),
    ("method", |_, one| <&str>::from(one.test.method).to_string()),
    ("arm", |_, one| one.test.arm.name().to_string()),
    ("against", |_, one| one.test.against.name().to_string()),
    ("studies", |_, one| one.found.studies.to_string()),
    ("rejected", |_, one| one.found.rejected.to_string()),
    ("rejected_uncorrected", |_, one| one.found.rejected_uncorrected.to_string()),
    ("unknown", |_, one| one.found.unknown.to_string()),
    ("share", |_, one| format!("{:.4}", one.found.share)),
    ("low", |_, one| format!("{:.4}", one.found.interval[0])),
    ("high", |_, one| format!("{:.4}", one.found.interval[1])),
    ("least_ratio", |_, one| one.least_ratio.map_or(String::new(), |ratio| format!("{ratio:.4}"))),
];

/// Errors: there is a file at the path that this program did not write.
pub fn check_table(path: &Path) -> FileResult<()> {
    check_csv(path, "a table of power", &COLUMNS.map(|(name, _)| name).join(","))
}

pub fn write_table(path: &Path, found: &PowerSummary) -> FileResult<()> {
    let tests = found.sizes.iter().flat_map(|size| size.tests.iter().map(move |one| (size, one)));
    let rows = tests.map(|(size, one)| COLUMNS.map(|(_, value)| value(size, one)));
    write_csv(path, std::iter::once(COLUMNS.map(|(name, _)| name.to_string())).chain(rows))
}

/// Text in the first line of a frozen plan's file, before the digest: SHA-256 of every byte after that line, so that it
/// can be checked without this program (`tail -n +2 FILE | sha256sum`).
const HEAD: &str = "tomcom frozen plan, SHA-256 of all that follows this line: ";
const FROZEN_REMEDY: &str = "a file that tomcom plan PLAN --freeze FILE wrote, unchanged";

/// Returns its digest. Errors: the file exists already, or the folder cannot be written to.
pub fn freeze(path: &Path, frozen: &FrozenPlan) -> FileResult<String> {
    // Writing JSON cannot fail here, since a plan contains only string keys and finite numbers.
    let body = serde_json::to_string_pretty(frozen).unwrap_or_default() + "\n";
    let digest = sha256(body.as_bytes());
    let written = replace_file::create(path, format!("{HEAD}{digest}\n{body}").as_bytes());
    written.map_err(|reason| match reason.kind() {
        ErrorKind::AlreadyExists => {
            let remedy = "another name for the file: a frozen plan is never overwritten".to_string();
            FileError::from_finding(path, "a file that is there already".to_string(), remedy)
        }
        _ => FileError::not_written(path, reason, "a new file in a folder that can be written to"),
    })?;
    Ok(digest)
}

/// Whether a file begins as a frozen plan does. Errors: it cannot be opened.
pub fn is_frozen(path: &Path) -> io::Result<bool> {
    let mut head = [0; HEAD.len()];
    Ok(File::open(path)?.read_exact(&mut head).is_ok() && head == *HEAD.as_bytes())
}

/// With its digest. Errors: it cannot be read, is no frozen plan, or was changed after it was frozen.
pub fn read_frozen(path: &Path) -> FileResult<(String, FrozenPlan)> {
    let text = read_text(path)?;
    let wrong = |place, found: String, remedy: &str| FileError::at(path, &text, Some(place), found, remedy.to_string());
    let first = text.lines().next().unwrap_or_default();
    let (Some(digest), Some((_, body))) = (first.strip_prefix(HEAD), text.split_once('\n')) else {
        return Err(wrong(0..first.len(), "no frozen plan".to_string(), FROZEN_REMEDY));
    };
    let found = sha256(body.as_bytes());
    if found != digest.trim_end() {
        return Err(wrong(
            HEAD.len()..first.len(),
            format!("a file with the SHA-256 {found}: it was changed after the plan was frozen"),
            FROZEN_REMEDY,
        ));
    }
    let frozen: FrozenPlan = serde_json::from_str(body).map_err(|error| {
        let start = text.len() - body.len();
        let before: usize = body.split_inclusive('\n').take(error.line().saturating_sub(1)).map(str::len).sum();
        wrong(start + before..start + before, error.to_string(), "the version of the program that froze the plan")
    })?;
    if frozen.frozen_plan != FROZEN_FORMAT {
        let found = format!("a frozen plan of format {}", frozen.frozen_plan);
        return Err(wrong(0..first.len(), found, "the version of the program that froze the plan"));
    }
    Ok((digest.trim_end().to_string(), frozen))
}

fn sha256(bytes: &[u8]) -> String {
    Sha256::digest(bytes).iter().map(|byte| format!("{byte:02x}")).collect()
}
