//! The Rerun commands in a build without Rerun, which refuses them.

use std::path::PathBuf;

use super::failure::Failure;
use super::review::AskedLandmarks;
use tomcom_core::base::text::PathText;
use tomcom_core::base::time::SessionTime;
use tomcom_session::features::{Feature, MissingFeature};

/// Refuses to write Rerun streams, since this build lacks Rerun.
pub(super) fn save_all(_: &[PathText]) -> Result<(), Failure> {
    Err(MissingFeature(Feature::Rerun).into())
}

/// Refuses to list what a Rerun viewer shows, since this build lacks Rerun.
pub(super) fn list_landmarks(_: &[PathBuf], _: AskedLandmarks) -> Result<(), Failure> {
    Err(MissingFeature(Feature::Rerun).into())
}

/// Refuses to open a Rerun viewer, since this build lacks Rerun.
pub(super) fn open(
    _: Vec<PathBuf>,
    _: Option<Option<PathBuf>>,
    _: bool,
    _: Option<SessionTime>,
) -> Result<(), Failure> {
    Err(MissingFeature(Feature::Rerun).into())
}
