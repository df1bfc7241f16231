//! Recordings in Rerun, in a build without it: refused.

use std::path::PathBuf;

use super::Failure;
use super::review::ReviewArgs;
use crate::base::features::{Feature, NotBuilt};

/// Refused.
pub(super) fn save_all(_: &[String]) -> Result<(), Failure> {
    Err(NotBuilt(Feature::Rerun).into())
}

/// Refused.
pub(super) fn open(_: &ReviewArgs, _: Vec<PathBuf>, _: Option<Option<PathBuf>>) -> Result<(), Failure> {
    Err(NotBuilt(Feature::Rerun).into())
}
