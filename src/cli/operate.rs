//! The command `tomcom operate`.

use std::net::{IpAddr, SocketAddr};
use std::path::{Path, PathBuf};

use clap::Args;

use super::choices::{arm_parser, concept, condition_parser, gaze_parser, participant_parser};
use super::failure::{Failure, wrong_setting};
use super::lab::tell_carried;
use super::list::chosen;
use super::output::{put, put_aside};
use crate::run::options::{self, DEFAULT_OUT, DEFAULT_SESSION, SeriesRequest, SessionStart, SettingOverrides};
use crate::run::series::{self, SeriesOutcome};
use crate::run::{files, plan};
use tomcom_core::communication::settings::ConceptSpec;
use tomcom_session::features::Feature;
use tomcom_session::files::carried;
use tomcom_session::files::file_error::FileError;
use tomcom_session::settings::{ArmKind, Condition, GazeSource, ParticipantKind};
use tomcom_session::watcher::SenderComparisonSettings;

/// Runs a session at the wizard's console, and records it.
#[derive(Debug, Args)]
#[command(
    after_help = "Examples: tomcom operate sessions/default.toml --participant keyboard \\\n            --gaze mouse\n          \
                  tomcom operate sessions/study.toml --code P07\nMore: docs/running-a-session.md"
)]
pub(super) struct OperateArgs {
    /// The session file; by default sessions/default.toml.
    pub(super) session: Option<PathBuf>,
    /// Continue a recording that was cut off or ended early, in a new part beside it; a running trial is paused.
    #[arg(long = "continue", value_name = "RECORDING", conflicts_with_all = ["session", "code", "participant", "gaze", "gaze_file", "gaze_start", "arm", "listen", "condition", "concept", "seed", "rerun_listen", "out", "frozen"])]
    pub(super) recording: Option<PathBuf>,
    #[command(flatten)]
    pub(super) flags: OperateFlags,
}

#[derive(Debug, Args)]
pub(super) struct OperateFlags {
    /// The participant's code, never a name; with a plan, the participant's next recording is made.
    #[arg(long)]
    pub(super) code: Option<String>,
    /// Who plays the human, instead of the session file's setting.
    #[arg(long, value_parser = participant_parser())]
    pub(super) participant: Option<ParticipantKind>,
    /// Gaze source, instead of the session file's.
    #[arg(long, value_parser = gaze_parser())]
    pub(super) gaze: Option<GazeSource>,
    /// Replay gaze from this file: gaze_positions_on_surface_NAME.csv of Pupil Player or Neon Player, gaze.csv of Pupil
    /// Cloud's Marker Mapper, or the folder of a recording.
    #[arg(long, value_name = "PATH")]
    pub(super) gaze_file: Option<PathBuf>,
    /// Time in the gaze file at which the trial starts, in seconds after the file's first sample; negative if the trial
    /// starts before that sample.
    #[arg(long, value_name = "SECONDS", allow_negative_numbers = true)]
    pub(super) gaze_start: Option<f64>,
    /// Kind of the robot's arm, instead of the session file's.
    #[arg(long, value_parser = arm_parser())]
    pub(super) arm: Option<ArmKind>,
    /// Who sends signals, instead of the session file's condition.
    #[arg(long, value_parser = condition_parser())]
    pub(super) condition: Option<Condition>,
    /// Communication concept of the assistant, instead of the session file's: tom-com, tom, dev, none, or the command
    /// line of a program of yours.
    #[arg(long, value_parser = concept)]
    pub(super) concept: Option<ConceptSpec>,
    /// Serve the wall display at this address instead of localhost; the page then asks for the pairing code that the
    /// console shows. An address without a port: the port is that of the session file.
    #[arg(long, value_name = "ADDRESS", value_parser = address_without_port)]
    pub(super) listen: Option<IpAddr>,
    /// Seed of all random numbers; by default that of the session file.
    #[arg(long)]
    pub(super) seed: Option<u64>,
    /// Address at which Rerun viewers connect, instead of the session file's. Whoever reaches it can watch without a
    /// password, and change nothing. An address with a port, such as 127.0.0.1:9876.
    #[arg(long, value_name = "ADDRESS:PORT")]
    pub(super) rerun_listen: Option<String>,
    /// Let observers watch the wizard's screen, live and read-only, in a browser; their remarks become notes in the
    /// recording. At another address than localhost the page asks for a pairing code of its own, which the console shows.
    #[arg(long, value_name = "ADDRESS:PORT", num_args = 0..=1, require_equals = true, default_missing_value = "127.0.0.1:50023")]
    pub(super) observe: Option<SocketAddr>,
    /// Refuse to record unless the plan is the one that was frozen in this file by tomcom plan PLAN --freeze FILE.
    #[arg(long, value_name = "FILE")]
    pub(super) frozen: Option<PathBuf>,
    /// Folder in which the recording's folder is created. Not with --continue: a further part is created beside the
    /// recording.
    #[arg(long, default_value = DEFAULT_OUT)]
    pub(super) out: PathBuf,
}

pub(super) fn operate(args: &OperateArgs) -> Result<(), Failure> {
    let done = match &args.recording {
        Some(recording) => {
            require_observers(args.flags.observe)?;
            let recording = chosen(recording, "continue it")?;
            series::operate(SessionStart::Continued(recording), None, args.flags.observe)?
        }
        None => new_session(args.session.as_deref(), &args.flags, None)?,
    };
    Ok(put(&series::describe(&done))?)
}

/// Runs the session of a session file at the console, optionally with a comparison of wizard and assistants.
pub(super) fn new_session(
    session: Option<&Path>,
    flags: &OperateFlags,
    compare: Option<SenderComparisonSettings>,
) -> Result<SeriesOutcome, Failure> {
    if flags.rerun_listen.is_some() {
        Feature::Rerun.require()?;
    }
    require_observers(flags.observe)?;
    session.map_or(Ok(()), carried::refuse)?;
    let name = session.unwrap_or(Path::new(DEFAULT_SESSION));
    let mut files = files::read_session(name)?;
    tell_carried(name, Some(&flags.out));
    let overrides = SettingOverrides {
        participant: flags.participant,
        arm: flags.arm,
        gaze: flags.gaze,
        gaze_file: flags.gaze_file.clone(),
        gaze_start_s: flags.gaze_start,
        condition: flags.condition,
        concept: flags.concept.clone(),
        seed: flags.seed,
        listen: flags.listen,
        code: flags.code.clone(),
        rerun_listen: flags.rerun_listen.clone(),
    };
    overrides.apply(&mut files).map_err(wrong_setting)?;
    if let Some(frozen) = &flags.frozen {
        plan::check_frozen(name, &files, frozen)?;
    }
    files.spec.require_built_live().map_err(|missing| FileError::not_built(name, missing))?;
    let out = flags.out.clone();
    if flags.code.is_none() && files.spec.plan.is_none() {
        let code = &files.spec.participant.code;
        put_aside(&format!("The participant's code is {code}, from {}; --code CODE sets another.\n", name.display()));
    }
    match &files.spec.plan {
        None => {
            Ok(series::operate(SessionStart::New { files: Box::new(files), trial: 0, out }, compare, flags.observe)?)
        }
        Some(plan) => {
            let participant = options::participant_of_plan(plan, flags.code.as_deref());
            let participant = participant.map_err(wrong_setting)?;
            Ok(series::operate_series(SeriesRequest {
                files,
                participant,
                out,
                kind: flags.participant,
                compare,
                observe: flags.observe,
                frozen: flags.frozen.clone(),
            })?)
        }
    }
}

/// Refuses observers in a build without pages.
fn require_observers(observe: Option<SocketAddr>) -> Result<(), Failure> {
    if observe.is_some() {
        Feature::Display.require()?;
    }
    Ok(())
}

/// Parses the address of a network interface of this computer; an address with a port is refused, since no port is
/// needed here.
pub(super) fn address_without_port(text: &str) -> Result<IpAddr, String> {
    text.parse().map_err(|_| match text.parse::<SocketAddr>() {
        Ok(with_port) => format!(
            "right would be an address without a port, such as {}; the port is `port` under [display] in the session \
             file (only --rerun-listen takes both)",
            with_port.ip()
        ),
        Err(_) => "right would be an IP address of this computer, such as 192.168.1.5, or 0.0.0.0 for all of its \
                   addresses"
            .to_string(),
    })
}
