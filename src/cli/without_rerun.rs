//! Commands on recordings in Rerun, refused in a build without Rerun.

use std::path::PathBuf;

use super::failure::Failure;
use crate::base::features::{Feature, NotBuilt};
use crate::base::time::SessionTime;

/// Refused.
pub(super) fn save_all(_: &[String]) -> Result<(), Failure> {
    Err(NotBuilt(Feature::Rerun).into())
}

/// Refused.
pub(super) fn open(
    _: Vec<PathBuf>,
    _: Option<Option<PathBuf>>,
    _: bool,
    _: Option<SessionTime>,
) -> Result<(), Failure> {
    Err(NotBuilt(Feature::Rerun).into())
}
