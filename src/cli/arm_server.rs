//! The command `tomcom arm`: a simulated controller of a UR5, for the clients of real ones.

use std::io::BufRead;
use std::net::IpAddr;
use std::path::PathBuf;
use std::thread;

use clap::Args;
use clap::builder::TypedValueParser;
use tokio::sync::mpsc;

use super::choices::named;
use super::failure::Failure;
use super::lab::tell_carried;
use super::output::{put, put_aside};
use crate::run::files;
use crate::run::terminal::asked_to_end;
use tomcom_devices::ur::controller::{INPUTS, Series, SimulatedController};
use tomcom_devices::ur::faults::{Fault, HELP};
use tomcom_devices::ur::script::{MOST_BYTES, Script};
use tomcom_devices::ur::server::{ControllerServer, PORTS};
use tomcom_session::files::file_error::FileError;

/// Serves a simulated UR5, for the clients of real ones.
///
/// The arm in the physics simulation stands behind the ports of the manufacturer's controllers: dashboard server (29999),
/// interfaces for scripts (30001 to 30003) and real-time data exchange (30004). Lines on standard input make things go
/// wrong; "help" lists them.
#[derive(Debug, Args)]
#[command(
    after_help = "It was never compared with a real controller.\nExample: tomcom arm --serve --program examples/ur_press.script\nMore: docs/real-arm.md"
)]
pub(super) struct ArmArgs {
    /// The layout with the robot's buttons.
    #[arg(default_value = "layouts/sushi.toml")]
    layout: PathBuf,
    /// Serve a simulated controller until the program is interrupted.
    #[arg(long, required = true)]
    serve: bool,
    /// Address at which it can be reached: of this machine alone by default, 0.0.0.0 for the network.
    #[arg(long, value_name = "ADDRESS", default_value = "127.0.0.1", value_parser = address)]
    listen: IpAddr,
    /// Generation of controllers that it passes for.
    #[arg(long, default_value = "e", value_parser = series_parser())]
    series: Series,
    /// File with a script that clients can load by its name; more than once for more.
    #[arg(long, value_name = "FILE")]
    program: Vec<PathBuf>,
}

fn series_parser() -> impl TypedValueParser<Value = Series> {
    named([
        ("e", Series::E, "PolyScope 5, outputs at up to 500 Hz"),
        ("cb3", Series::Cb3, "PolyScope 3, outputs at up to 125 Hz"),
    ])
}

/// The ports are those of the manufacturer's controllers, so that clients find them.
fn address(text: &str) -> Result<IpAddr, String> {
    let right = "right would be an IP address of this computer without a port, such as 127.0.0.1";
    text.parse().map_err(|_| right.to_string())
}

/// Number of typed lines that wait for the controller.
const LINES: usize = 64;

pub(super) fn serve(args: &ArmArgs) -> Result<(), Failure> {
    let kitchen = files::read_kitchen(&args.layout)?.kitchen;
    tell_carried(&args.layout, None);
    let mut controller = SimulatedController::new(&kitchen, args.series);
    for path in &args.program {
        let name = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
        controller.add_program(&name, &read_script(path)?);
    }
    let buttons = controller.buttons();
    let runtime = tokio::runtime::Builder::new_current_thread().enable_all().build()?;
    runtime.block_on(async {
        let bound = ControllerServer::bind(args.listen, PORTS, controller).await;
        let server = bound.map_err(|(address, error)| {
            let help = "a free port: no other controller runs here, and the address is one of this machine";
            Failure::Failed(miette::miette!(help = help, "{address}: cannot be listened at: {error}"))
        })?;
        let mut told = format!(
            "A simulated UR5 listens at {}: dashboard 29999, scripts 30001 to 30003, RTDE 30004\n\
             Its power is off; power on and brake release are commands of the dashboard.\n\
             Buttons in the base frame of the controller, in metres; each closes the digital input with its number:\n",
            args.listen
        );
        for (number, [x, y, z]) in buttons.iter().enumerate() {
            let input = if number < INPUTS { String::new() } else { " (no input)".to_string() };
            told += &format!("{number:>3}  {x:7.3} {y:7.3} {z:7.3}{input}\n");
        }
        put(&told)?;
        let (sender, faults) = mpsc::channel(LINES);
        let typed = sender.clone();
        // Standard input has no end that can be waited for together with other things.
        thread::spawn(move || read_faults(&typed));
        tokio::select! {
            asked = asked_to_end() => asked?,
            () = server.run(faults, |line| put_aside(&format!("{line}\n"))) => {}
        }
        drop(sender);
        Ok(())
    })
}

/// Reads a script, and checks that it can be run.
fn read_script(path: &PathBuf) -> Result<String, Failure> {
    let text =
        std::fs::read_to_string(path).map_err(|error| FileError::unreadable(path, error, "a file with a script"))?;
    if text.len() > MOST_BYTES {
        let help = format!("a script of at most {MOST_BYTES} bytes");
        return Err(Failure::Wrong(miette::miette!(help = help, "{}: {} bytes", path.display(), text.len())));
    }
    let help = "the part of URScript that docs/real-arm.md lists";
    let wrong = |error| Failure::Wrong(miette::miette!(help = help, "{}: {error}", path.display()));
    Script::read(&text).map_err(wrong)?;
    Ok(text)
}

fn read_faults(to: &mpsc::Sender<Fault>) {
    for line in std::io::stdin().lock().lines() {
        let Ok(line) = line else { return };
        if line.trim().is_empty() {
            continue;
        }
        match Fault::read(&line) {
            Ok(Some(fault)) => {
                if to.blocking_send(fault).is_err() {
                    return;
                }
            }
            Ok(None) => put_aside(&format!("{HELP}\n")),
            Err(wrong) => put_aside(&format!("{wrong}\n")),
        }
    }
}
