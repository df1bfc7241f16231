//! Recordings as MCAP, refused in a build without MCAP.

use std::path::PathBuf;

use serde_json::Value;

use super::failure::Failure;
use crate::base::features::{Feature, NotBuilt};

/// Refused.
pub(super) fn export(_: &[PathBuf]) -> Result<(Value, String), Failure> {
    Err(NotBuilt(Feature::Mcap).into())
}
