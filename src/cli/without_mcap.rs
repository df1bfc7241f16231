//! The export of recordings as MCAP files in a build without MCAP, which refuses the export.

use std::path::PathBuf;

use super::failure::Failure;
use tomcom_session::features::{Feature, MissingFeature};

/// No recording is exported.
pub(super) type ExportedMcap = ();

/// Refuses the export, since this build lacks MCAP.
pub(super) fn export(_: &[PathBuf]) -> Result<(Vec<ExportedMcap>, String), Failure> {
    Err(MissingFeature(Feature::Mcap).into())
}
