//! Reads session and layout files with the keys of the console, and writes files of fitted parameters.

use std::path::Path;

use super::key_file::check_keys;
use tomcom_core::kitchen::files::LayoutSpec;
use tomcom_core::mind::model::HumanModel;
use tomcom_session::files::file_error::FileResult;
use tomcom_session::files::parse::parse;
use tomcom_session::files::{self, KitchenWithSources, SessionSetup, overwrite};
use tomcom_session::header::RecordedFile;
use tomcom_study::analysis::fitting::FITTED;

pub fn read_session(path: &Path) -> FileResult<SessionSetup> {
    read_session_in(path, None)
}

/// Reads a session file as [`read_session`] does, but with the texts of the participant's display in this language.
pub fn read_session_in(path: &Path, language: Option<&str>) -> FileResult<SessionSetup> {
    let setup = files::read_session(path, language)?;
    let layout = path.parent().unwrap_or(Path::new(".")).join(&setup.spec.layout);
    keys_fit(&layout, &setup.kitchen, setup.keys.as_ref())?;
    Ok(setup)
}

/// Reads a layout file and the recipe file that it names, and checks them with the console's default keys.
pub fn read_kitchen(layout: &Path) -> FileResult<KitchenWithSources> {
    let kitchen = files::read_kitchen(layout)?;
    keys_fit(layout, &kitchen, None)?;
    Ok(kitchen)
}

fn keys_fit(layout: &Path, kitchen: &KitchenWithSources, keys: Option<&RecordedFile>) -> FileResult<()> {
    let text = &kitchen.layout.text;
    let spec: LayoutSpec = parse(layout, text)?;
    check_keys((layout, text), &spec, &kitchen.kitchen, keys)
}

/// Checks that a file of fitted parameters can be written to this path.
///
/// # Errors
/// There is a file at the path that this program did not write.
pub fn check_fitted(path: &Path) -> std::io::Result<()> {
    let begins = format!("# {FITTED}");
    overwrite::check(path, "a file of fitted parameters", |head| head.starts_with(begins.as_bytes()))
}

/// Writes a file with all parameters of the human model, after a comment at its top.
///
/// # Errors
/// The file cannot be written, or there is a file at the path that this program did not write.
pub fn write_human_model(path: &Path, model: &HumanModel, comment: &str) -> std::io::Result<()> {
    check_fitted(path)?;
    let comment: String = comment.lines().map(|line| format!("# {line}\n")).collect();
    let text = toml::to_string(model).map_err(std::io::Error::other)?;
    overwrite::write(path, format!("{comment}\n{text}").as_bytes())
}
