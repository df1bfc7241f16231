//! The command line of the program. A command is listed only when it works.

mod args;
#[cfg(feature = "ur")]
mod arm_server;
mod choices;
mod command_hint;
mod data;
mod estimates;
mod exports;
mod failure;
mod lab;
mod list;
mod operate;
mod output;
mod pools;
#[cfg(feature = "rerun")]
mod rerun_messages;
#[cfg(not(feature = "rerun"))]
#[path = "cli/without_rerun.rs"]
mod rerun_messages;
mod review;
mod simulation;
mod study;
mod tournaments;
mod tutorial_alone;
mod video;
mod wizard;

use std::io::{IsTerminal, Write};
use std::path::Path;
use std::process::ExitCode;
use std::sync::Arc;
use std::time::Duration;

use clap::{CommandFactory, Parser};
use miette::MietteHandlerOpts;
use serde::Serialize;

use self::args::*;
use self::failure::{Failure, wrong_argument};
use self::lab::tell_carried;
use self::output::{OutputFormat, print, put, put_aside, put_error};
use crate::console;
use crate::run::doctor::{self, fault_report};
use crate::run::files;
use crate::run::key_file;
use crate::run::options::{self, DEFAULT_SESSION};
use crate::run::plan::{self, StudyProgress};
use crate::run::review_console as console_over;
use tomcom_core::base::text::{PathText, did_you_mean, printable};
use tomcom_session::files::file_error::FileError;
use tomcom_session::history::event_words;
use tomcom_session::log::{self, ExclusionRecord, LogEnding, LogReader};
use tomcom_session::replay::RecordingReplay;
use tomcom_session::verify;
use tomcom_study::analysis::kitchen_summary::{self, KitchenSummary};
use tomcom_study::analysis::recording_summary::RecordingSummary;
use tomcom_study::files::corrected;
use tomcom_study::standing;

/// Exit code of a command that failed.
const FAILED: u8 = 1;
/// Exit code of a command with wrong arguments or files.
const WRONG: u8 = 2;

/// A recording that was excluded or included again with others: the output of `tomcom exclude --code`.
#[derive(Debug, Serialize)]
struct RuledRecording {
    recording: PathText,
    /// False if it is included again.
    excluded: bool,
    reason: String,
    /// UTC, RFC 3339.
    at: String,
}

/// Period of polling a running session for new events.
const FOLLOW_INTERVAL: Duration = Duration::from_millis(50);

/// Runs the command that the program's arguments name. Exit codes: 0 done, 1 failed, 2 wrong arguments or files.
pub fn main() -> ExitCode {
    // Lines of messages are not wrapped, so that file and line can be searched for; an existing hook is kept.
    let _ = miette::set_hook(Box::new(|_| Box::new(MietteHandlerOpts::new().wrap_lines(false).build())));
    let cli = Cli::try_parse().unwrap_or_else(|error| command_hint::add(printable_error(error)).exit());
    let command = cli.command.unwrap_or(CliCommand::Operate(operate::OperateArgs {
        session: None,
        recording: None,
        flags: cli.operate,
    }));
    let done = match command {
        CliCommand::New(args) => lab::new(&args),
        CliCommand::Operate(args) => operate::operate(&args),
        CliCommand::Compare(args) => wizard::compare(&args),
        CliCommand::Tutorial(args) => tutorial_alone::tutorial(&args),
        CliCommand::Train(args) => wizard::train(&args),
        CliCommand::Replay(args) => replay(&args),
        CliCommand::Review(args) => review::review(&args),
        CliCommand::List(args) => list::list(&args),
        CliCommand::Power(args) => pools::power(&args),
        CliCommand::Arms(args) => pools::arms(&args),
        #[cfg(feature = "ur")]
        CliCommand::Arm(args) => arm_server::serve(&args),
        CliCommand::Tournament(args) => tournaments::tournament(&args),
        CliCommand::Protocol(_) => tournaments::protocol(),
        CliCommand::Simulate(args) => simulation::simulate(&args),
        CliCommand::Study(args) => study::study(&args),
        CliCommand::Plan(args) => show_plan(&args),
        CliCommand::Fit(args) => estimates::fit(&args),
        CliCommand::Kitchen(args) => kitchen(&args),
        CliCommand::Keys(args) => keys(&args),
        CliCommand::Exclude(args) => exclude(&args),
        CliCommand::Correct(args) => correct(&args),
        CliCommand::Codes(args) => data::codes(&args),
        CliCommand::Video(args) => video::video(&args),
        CliCommand::Export(args) => exports::export(&args),
        CliCommand::Forget(args) => data::forget(&args),
        CliCommand::Doctor(args) => examine(&args),
        CliCommand::Completions(args) => completions(&args),
        CliCommand::Man(args) => man(&args),
    };
    let (code, report) = match done {
        Ok(()) | Err(Failure::Unread) => return ExitCode::SUCCESS,
        Err(Failure::No) => return ExitCode::from(FAILED),
        Err(Failure::Failed(report)) => (FAILED, report),
        Err(Failure::Wrong(report)) => (WRONG, report),
    };
    put_error(report);
    ExitCode::from(code)
}

/// The message about wrong arguments, in which their control characters are escaped. The message quotes arguments in many
/// places, so it is made again, from escaped arguments.
fn printable_error(error: clap::Error) -> clap::Error {
    let escaped = std::env::args_os().map(|argument| printable(&argument.to_string_lossy()).into_owned());
    // Arguments that are wrong only because they are not UTF-8 are not quoted.
    Cli::try_parse_from(escaped).err().unwrap_or(error)
}

fn show_plan(args: &PlanArgs) -> Result<(), Failure> {
    let files = files::read_session(&args.session)?;
    tell_carried(&args.session, Some(&args.out));
    let Some(study) = files.study() else {
        let found = "a session without a plan".to_string();
        return Err(wrong_argument(&args.session, found, "a session file with a [plan], like sessions/study.toml"));
    };
    if let Some(frozen) = &args.frozen {
        plan::check_frozen(&args.session, &files, frozen)?;
        put_aside(&format!("The plan is the one that was frozen in {}.\n", frozen.display()));
    }
    let figures = StudyProgress::from_study(&study, &args.session, &args.out, args.frozen.as_deref())?;
    let Some(file) = &args.freeze else {
        return print(args.format, &figures, || plan::describe(&figures, doctor::columns()));
    };
    let frozen = plan::freeze(&study, &files.kitchen, &figures, file)?;
    print(args.format, &frozen, || frozen.describe())
}

fn replay(args: &ReplayArgs) -> Result<(), Failure> {
    let recording = &list::chosen(&args.recording, "replay")?;
    if args.verify {
        let found = verify::verify(recording)?;
        print(args.format, &found, || verify::describe(&found))?;
        return if found.verified { Ok(()) } else { Err(Failure::No) };
    }
    if let Some(rater) = &args.rater {
        return data::rate(recording, rater);
    }
    if let Some(raters) = &args.settle {
        return data::settle(recording, raters);
    }
    if args.format == OutputFormat::Text && std::io::stdin().is_terminal() && std::io::stdout().is_terminal() {
        return Ok(console_over::review(recording, args.follow, None)?);
    }
    let mut replay = RecordingReplay::open(recording)?;
    let mut events = 0;
    if args.format == OutputFormat::Text {
        put(&format!("{}\n", event_words::HEADING))?;
    }
    loop {
        while let Some(event) = replay.step()? {
            events += 1;
            if let (OutputFormat::Text, Some(line)) = (args.format, event_words::line(&event.stamped, &replay.follower))
            {
                put(&format!("{line}\n"))?;
            }
        }
        if !args.follow || !replay.log().is_cut() {
            break;
        }
        replay.log().check_there()?;
        std::thread::sleep(FOLLOW_INTERVAL);
    }
    let standing = standing::exclusion_status(replay.session(), replay.log())?;
    let mut figures = RecordingSummary::from_follower(&replay.follower, events, standing);
    let ending = replay.log().ending();
    (figures.cut, figures.running) = (ending == LogEnding::Cut, ending == LogEnding::Running);
    print(args.format, &figures, || figures.describe())
}

fn kitchen(args: &KitchenArgs) -> Result<(), Failure> {
    let kitchen = Arc::new(files::read_kitchen(&args.layout)?.kitchen);
    tell_carried(&args.layout, None);
    let figures = KitchenSummary::from_kitchen(&kitchen);
    print(args.format, &figures, || kitchen_summary::describe(&kitchen, &figures))
}

/// What an exclusion does not change.
const MADE_BEFORE: &str = "tables, reports and exports that were made before do not know of this: make them again\n";

fn exclude(args: &ExcludeArgs) -> Result<(), Failure> {
    let reason = args.reason.as_deref().unwrap_or_default();
    if let Some(code) = &args.code {
        return exclude_participant(args, code, reason);
    }
    let recording = list::chosen(&args.recording, if args.back { "include again" } else { "exclude" })?;
    let ruling = log::rule(&recording, !args.back, reason)?;
    // A recording that is included again can still be left out because its trial was aborted; the message says so.
    let aborted = if ruling.excluded { None } else { standing::aborted(&recording)? };
    let words = match (ruling.excluded, aborted) {
        (true, _) => "is left out of the analysis".to_string(),
        (false, None) => "is counted in the analysis again".to_string(),
        (false, Some(reason)) => format!(
            "is not excluded any more, but is still left out of the analysis, since its trial was aborted: {reason}"
        ),
    };
    put_aside(MADE_BEFORE);
    print(args.format, &ruling, || format!("{} {words}\n", recording.display()))
}

/// Excludes all recordings of a participant in a folder, or includes them again; those that are so already stay as they
/// are.
fn exclude_participant(args: &ExcludeArgs, code: &str, reason: &str) -> Result<(), Failure> {
    let (mut ruled, mut left) = (Vec::new(), Vec::new());
    for recording in list::of_participant(&args.recording, code)? {
        let log = &mut LogReader::open(&recording)?;
        // The log of a damaged recording does not say that it is excluded.
        if log::is_excluded(log).unwrap_or(false) != args.back {
            continue;
        }
        // What was excluded by itself, at the console or by name, is excluded for another reason, which still holds.
        if args.back && !log::ruling(log.folder())?.is_some_and(|ruling| ruling.of_participant) {
            left.push(recording);
            continue;
        }
        let ExclusionRecord { excluded, reason, at, .. } = log::rule_participant(&recording, !args.back, reason)?;
        ruled.push(RuledRecording { recording: recording.into(), excluded, reason, at });
    }
    for recording in &left {
        let recording = recording.display();
        put_aside(&format!(
            "{recording} stays excluded, since it was excluded by itself; tomcom exclude {recording} --back includes it\n"
        ));
    }
    if !ruled.is_empty() {
        put_aside(MADE_BEFORE);
    }
    let words = match (args.back, ruled.len()) {
        (false, 0) => format!("all recordings of {code} are excluded already"),
        (true, 0) => format!("no recording of {code} was excluded with --code"),
        (false, _) => format!("recordings of {code} that are left out of the analysis from now on:"),
        (true, _) => format!("recordings of {code} that are counted in the analysis again:"),
    };
    print(args.format, &ruled, || {
        let named: String = ruled.iter().map(|one| format!("  {}\n", one.recording)).collect();
        format!("{words}\n{named}")
    })
}

fn correct(args: &CorrectArgs) -> Result<(), Failure> {
    let recording = list::chosen(&args.recording, "correct")?;
    let correction = log::correct(&recording, args.code.as_deref(), args.reason.as_deref().unwrap_or_default())?;
    if args.code.is_some() {
        corrected::remarks(&recording, &correction)?.iter().for_each(|remark| put_aside(&format!("{remark}\n")));
    }
    print(args.format, &correction, || {
        let (before, after) = (&correction.before, &correction.after);
        format!("{} is a recording of {after}, no longer of {before}\n", recording.display())
    })
}

fn examine(args: &DoctorArgs) -> Result<(), Failure> {
    let files = options::session_or_default(args.session.as_deref())?;
    tell_carried(args.session.as_deref().unwrap_or(Path::new(DEFAULT_SESSION)), Some(&args.out));
    let found = doctor::examine(&files, &args.out);
    if let Some(report) = &args.report {
        let written = fault_report::write(report, &files.spec, &found, &args.out);
        written.map_err(|reason| FileError::unwritable(report, reason))?;
        put_aside(&format!("{} is written; read it before you send it\n", report.display()));
    }
    print(args.format, &found, || doctor::describe(&found, doctor::columns()))?;
    if found.healthy { Ok(()) } else { Err(Failure::No) }
}

fn keys(args: &KeysArgs) -> Result<(), Failure> {
    let files = options::session_or_default(args.session.as_deref())?;
    tell_carried(args.session.as_deref().unwrap_or(Path::new(DEFAULT_SESSION)), None);
    let map = key_file::key_map(files.keys.as_ref())?;
    let lines = console::keys::lines(&files.kitchen.kitchen, &map)
        .map_err(|error| Failure::Wrong(miette::miette!(help = error.remedy, "{}", error.found)))?;
    Ok(put(&console::keys::write(&lines))?)
}

fn completions(args: &CompletionsArgs) -> Result<(), Failure> {
    let mut text = Vec::new();
    clap_complete::generate(args.shell, &mut Cli::command(), "tomcom", &mut text);
    Ok(std::io::stdout().write_all(&text)?)
}

fn man(args: &ManArgs) -> Result<(), Failure> {
    let mut root = Cli::command();
    root.build();
    let page = match &args.command {
        None => root,
        Some(name) => match root.find_subcommand(name) {
            Some(command) => command.clone(),
            None => {
                let help = "a command that tomcom --help lists";
                let near = did_you_mean(name, root.get_subcommands().map(clap::Command::get_name));
                return Err(Failure::Wrong(miette::miette!(
                    help = help,
                    "found {name}, which is not a command of tomcom{near}"
                )));
            }
        },
    };
    let mut text = Vec::new();
    clap_mangen::Man::new(page).render(&mut text)?;
    Ok(std::io::stdout().write_all(&text)?)
}
