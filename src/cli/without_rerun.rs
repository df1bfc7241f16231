//! Rerun commands in a build without Rerun: refused.

use std::path::PathBuf;

use super::failure::Failure;
use crate::base::features::{Feature, MissingFeature};
use crate::base::time::SessionTime;

/// Refuses to write streams, since this build lacks Rerun.
pub(super) fn save_all(_: &[String]) -> Result<(), Failure> {
    Err(MissingFeature(Feature::Rerun).into())
}

/// Refuses to open a viewer, since this build lacks Rerun.
pub(super) fn open(
    _: Vec<PathBuf>,
    _: Option<Option<PathBuf>>,
    _: bool,
    _: Option<SessionTime>,
) -> Result<(), Failure> {
    Err(MissingFeature(Feature::Rerun).into())
}
