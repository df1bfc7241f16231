//! Reads layout and recipe files. Every error names the file, the line, what was found and what would be right.

use std::ops::Range;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use miette::{Diagnostic, NamedSource, SourceSpan};
use serde::de::DeserializeOwned;

use crate::kitchen::Kitchen;
use crate::kitchen::compile::{SpecError, SpecFile};
use crate::kitchen::layout::LayoutSpec;
use crate::kitchen::recipe::RecipesSpec;

/// Something is wrong with a file.
#[derive(Debug, thiserror::Error, Diagnostic)]
pub enum FileError {
    #[error("{}: cannot be read: {reason}", path.display())]
    Unreadable {
        path: PathBuf,
        reason: std::io::Error,
        #[help]
        remedy: String,
    },
    #[error("{name}:{line}: found {found}")]
    Wrong {
        name: String,
        line: usize,
        found: String,
        #[source_code]
        text: Arc<NamedSource<String>>,
        #[label("here")]
        span: Option<SourceSpan>,
        #[help]
        remedy: String,
    },
}

impl FileError {
    /// An error at a place of a file's text.
    pub fn at(path: &Path, text: &str, span: Option<Range<usize>>, found: String, remedy: String) -> FileError {
        let name = path.display().to_string();
        let start = span.as_ref().map_or(0, |span| span.start.min(text.len()));
        let line = text.as_bytes()[..start].iter().filter(|&&byte| byte == b'\n').count() + 1;
        let source = NamedSource::new(&name, text.to_string());
        FileError::Wrong { name, line, found, text: Arc::new(source), span: span.map(SourceSpan::from), remedy }
    }
}

/// A kitchen with the texts it was made from, which go into the header of every recording.
#[derive(Clone, Debug)]
pub struct KitchenFiles {
    pub kitchen: Kitchen,
    pub layout_text: String,
    pub recipes_text: String,
}

/// Reads a layout and the recipe file that it names.
pub fn read_kitchen(layout_path: &Path) -> Result<KitchenFiles, FileError> {
    let layout_text = read_text(layout_path)?;
    let layout: LayoutSpec = parse(layout_path, &layout_text)?;
    let folder = layout_path.parent().unwrap_or(Path::new("."));
    let recipes_path = folder.join(layout.recipes.get_ref());
    let recipes_text = std::fs::read_to_string(&recipes_path).map_err(|reason| {
        let found = format!("recipes = \"{}\", which cannot be read: {reason}", layout.recipes.get_ref());
        let remedy = "the path of a recipe file, relative to the layout file".to_string();
        FileError::at(layout_path, &layout_text, Some(layout.recipes.span()), found, remedy)
    })?;
    compile_kitchen((layout_path, layout_text), (&recipes_path, recipes_text))
}

/// Compiles a kitchen from texts; the paths only serve error messages.
pub fn compile_kitchen(layout: (&Path, String), recipes: (&Path, String)) -> Result<KitchenFiles, FileError> {
    let layout_spec: LayoutSpec = parse(layout.0, &layout.1)?;
    let recipes_spec: RecipesSpec = parse(recipes.0, &recipes.1)?;
    match Kitchen::compile(&layout_spec, &recipes_spec) {
        Ok(kitchen) => Ok(KitchenFiles { kitchen, layout_text: layout.1, recipes_text: recipes.1 }),
        Err(SpecError { file, span, found, remedy }) => {
            let (path, text) = match file {
                SpecFile::Layout => (layout.0, &layout.1),
                SpecFile::Recipes => (recipes.0, &recipes.1),
            };
            Err(FileError::at(path, text, span, found, remedy))
        }
    }
}

/// The text of a file.
pub fn read_text(path: &Path) -> Result<String, FileError> {
    std::fs::read_to_string(path).map_err(|reason| {
        let remedy = "the path of a readable text file (UTF-8)".to_string();
        FileError::Unreadable { path: path.to_path_buf(), reason, remedy }
    })
}

/// Parses TOML into `T`.
pub fn parse<T: DeserializeOwned>(path: &Path, text: &str) -> Result<T, FileError> {
    toml::from_str(text).map_err(|error| {
        let remedy = "a file like those in layouts/, recipes/ and sessions/".to_string();
        FileError::at(path, text, error.span(), error.message().to_string(), remedy)
    })
}
