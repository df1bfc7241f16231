//! The export of recordings as MCAP files in a build without MCAP, which refuses the export.

use std::path::PathBuf;

use serde_json::Value;

use super::failure::Failure;
use crate::base::features::{Feature, MissingFeature};

/// Refuses the export, since this build lacks MCAP.
pub(super) fn export(_: &[PathBuf]) -> Result<(Value, String), Failure> {
    Err(MissingFeature(Feature::Mcap).into())
}
