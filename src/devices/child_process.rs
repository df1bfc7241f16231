//! Programs that this program starts and that must not outlive it: each in a process group of its own, also with what
//! it starts itself.
//!
//! A shell leads the group and waits on a pipe whose other end this program alone holds. However this program ends, also
//! if it is killed, the pipe closes, and the shell ends the group. Systems have signals for that which depend on the
//! thread that started the program, or none.

use std::io;
use std::path::PathBuf;
#[cfg(unix)]
use std::process::Stdio;
use std::process::{Child, Command};
use std::thread;
use std::time::{Duration, Instant};

/// Ends its own group once its input ends; programs have 2 s for closing their files. It is in the group itself, so that
/// nobody else gets the group's number meanwhile.
#[cfg(unix)]
const KEEPER: &str = "trap '' TERM; cd /; read -r end; kill -TERM 0; sleep 2; kill -KILL 0";
const STEP: Duration = Duration::from_millis(5);

/// The program of this name in the folders of `PATH`.
pub(crate) fn find_program(name: &str) -> Option<PathBuf> {
    let name = format!("{name}{}", std::env::consts::EXE_SUFFIX);
    let folders = std::env::var_os("PATH").unwrap_or_default();
    std::env::split_paths(&folders).map(|folder| folder.join(&name)).find(|path| path.is_file())
}

/// A program that ends with this value, or with this program.
#[derive(Debug)]
pub struct ChildProcess {
    child: Child,
    #[cfg(unix)]
    keeper: Child,
}

impl ChildProcess {
    /// Starts a program in a group of its own.
    ///
    /// # Errors
    /// The program is not there, or no further program can be started.
    pub fn start(command: &mut Command) -> io::Result<ChildProcess> {
        #[cfg(unix)]
        {
            use std::os::unix::process::CommandExt;
            let mut keeper = Command::new("sh");
            keeper.args(["-c", KEEPER]).stdin(Stdio::piped()).stdout(Stdio::null()).stderr(Stdio::null());
            let mut keeper = keeper.process_group(0).spawn()?;
            let child = command.process_group(keeper.id() as i32).spawn();
            match child {
                Ok(child) => Ok(ChildProcess { child, keeper }),
                Err(error) => {
                    end_group(&mut keeper);
                    Err(error)
                }
            }
        }
        #[cfg(not(unix))]
        Ok(ChildProcess { child: command.spawn()? })
    }

    /// The program, for its pipes and its exit code.
    pub fn child(&mut self) -> &mut Child {
        &mut self.child
    }

    /// Asks the program, and what it started, to end by itself.
    pub fn ask_to_end(&self) {
        #[cfg(unix)]
        {
            use rustix::process::{Pid, Signal, kill_process_group};
            let _ = kill_process_group(Pid::from_child(&self.keeper), Signal::TERM);
        }
    }

    /// Lets others have the processor first; the more, the larger `by` is, from 1 to 19.
    pub fn yield_to_others(&self, by: i32) {
        #[cfg(unix)]
        {
            use rustix::process::{Pid, setpriority_process};
            let _ = setpriority_process(Some(Pid::from_child(&self.child)), by);
        }
        #[cfg(not(unix))]
        let _ = by;
    }

    /// Waits until the program has ended, but no longer than this; returns whether it has.
    pub fn ends_within(&mut self, longest: Duration) -> bool {
        let began = Instant::now();
        loop {
            match self.child.try_wait() {
                Ok(None) if began.elapsed() < longest => thread::sleep(STEP),
                Ok(None) => return false,
                Ok(Some(_)) | Err(_) => return true,
            }
        }
    }
}

impl Drop for ChildProcess {
    fn drop(&mut self) {
        #[cfg(unix)]
        end_group(&mut self.keeper);
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

/// Kills all programs of the group, and then forgets its number.
#[cfg(unix)]
fn end_group(keeper: &mut Child) {
    use rustix::process::{Pid, Signal, kill_process_group};
    let _ = kill_process_group(Pid::from_child(keeper), Signal::KILL);
    let _ = keeper.wait();
}
