//! Paths in JSON output and in TOML files.

use std::ffi::OsStr;
use std::fmt;
use std::ops::Deref;
use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize, Serializer};

/// A path that is written as text. On many systems a path is any bytes, and serde refuses to write a path that is not
/// UTF-8; here, bytes that are no text become replacement characters.
#[derive(Clone, Debug, PartialEq, Eq, Deserialize)]
#[serde(transparent)]
pub struct PathText(pub PathBuf);

impl Deref for PathText {
    type Target = Path;

    fn deref(&self) -> &Path {
        &self.0
    }
}

impl AsRef<Path> for PathText {
    fn as_ref(&self) -> &Path {
        self
    }
}

impl AsRef<OsStr> for PathText {
    fn as_ref(&self) -> &OsStr {
        self.as_os_str()
    }
}

impl From<PathBuf> for PathText {
    fn from(path: PathBuf) -> PathText {
        PathText(path)
    }
}

impl fmt::Display for PathText {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.0.display().fmt(out)
    }
}

impl Serialize for PathText {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_str(self)
    }
}
