//! A folder for results that is left behind only with something in it.

use std::fs;
use std::io;
use std::path::{Path, PathBuf};

/// The folders that were made for results. Those in which nothing was written go when this value goes.
#[derive(Debug)]
pub struct NewFolder {
    /// The innermost first.
    made: Vec<PathBuf>,
}

impl NewFolder {
    /// Makes the folder, if it does not exist, with those above it.
    pub fn create(folder: &Path) -> io::Result<NewFolder> {
        let made = folder.ancestors().take_while(|one| !one.exists()).map(Path::to_path_buf).collect();
        let new = NewFolder { made };
        fs::create_dir_all(folder)?;
        Ok(new)
    }
}

impl Drop for NewFolder {
    fn drop(&mut self) {
        // A folder with something in it cannot be removed, and stays.
        self.made.iter().all(|folder| fs::remove_dir(folder).is_ok());
    }
}
