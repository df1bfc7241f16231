//! The command `tomcom tutorial`.

use std::net::IpAddr;
use std::path::{Path, PathBuf};

use clap::Args;

use super::failure::{Failure, wrong_argument, wrong_setting};
use super::lab::tell_carried;
use super::operate::address_without_port;
use super::output::put;
use crate::run::files;
use crate::run::options::{SessionStart, SettingOverrides};
use crate::run::series;
use tomcom_session::files::file_error::FileError;
use tomcom_session::plan::Study;
use tomcom_session::settings::{ArmKind, GazeSource, ParticipantKind};
use tomcom_session::wall_display::DisplaySpec;

/// Runs the participant's tutorial alone, on the display.
///
/// The tutorial is recorded as a session without a trial, so that it can be replayed. The recording gets a folder that
/// no study reads.
#[derive(Debug, Args)]
#[command(after_help = "Example: tomcom tutorial sessions/study.toml --language de\nMore: docs/display.md")]
pub(super) struct TutorialArgs {
    /// The session file, whose [plan] names the tutorial.
    #[arg(default_value = "sessions/study.toml")]
    session: PathBuf,
    /// The display's language, instead of the session file's. The tutorial is read in that language, if it is
    /// there.
    #[arg(long, value_parser = DisplaySpec::LANGUAGES)]
    language: Option<String>,
    /// The participant's code, never a name.
    #[arg(long, default_value = "P00")]
    code: String,
    /// Serve the wall display at this address instead of localhost; the page then asks for the pairing code that the
    /// console shows. An address without a port: the port is that of the session file.
    #[arg(long, value_name = "ADDRESS", value_parser = address_without_port)]
    listen: Option<IpAddr>,
    /// Folder in which the recording's folder is created.
    #[arg(long, default_value = "tutorials")]
    out: PathBuf,
}

pub(super) fn tutorial(args: &TutorialArgs) -> Result<(), Failure> {
    let name: &Path = &args.session;
    let mut files = files::read_session_in(name, args.language.as_deref())?;
    tell_carried(name, Some(&args.out));
    let overrides = SettingOverrides {
        participant: Some(ParticipantKind::Display),
        arm: Some(ArmKind::Timed),
        gaze: Some(GazeSource::None),
        listen: args.listen,
        code: Some(args.code.clone()),
        ..SettingOverrides::default()
    };
    overrides.apply(&mut files).map_err(wrong_setting)?;
    files.spec.require_built_live().map_err(|missing| FileError::not_built(name, missing))?;
    let Some(spec) = files.study().and_then(|study| Study::tutorial_alone(&study, &args.code)) else {
        let found = "a session without a tutorial".to_string();
        return Err(wrong_argument(
            name,
            found,
            "a session file with `tutorial` under [plan], like sessions/study.toml",
        ));
    };
    files.spec = spec;
    let start = SessionStart::New { files: Box::new(files), trial: 0, out: args.out.clone() };
    Ok(put(&series::describe(&series::operate(start, None, None)?))?)
}
