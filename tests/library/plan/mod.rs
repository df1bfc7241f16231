//! Plans: who comes when under which condition with which orders, what comes next whatever was recorded, cut or left, and
//! what happens around a trial.

mod assignment;
mod protocol;
mod questionnaires;
mod tutorial;

use tomcom_session::plan::Study;

use crate::support::*;

/// The study of the project as it is rehearsed: with simulated participants.
fn files() -> SessionSetup {
    let mut files = session_file("study");
    (files.spec.participant.kind, files.spec.participant.gaze) = (ParticipantKind::Simulated, GazeSource::Simulated);
    files
}

fn study(change: impl Fn(&mut SessionSetup)) -> Study {
    let mut files = files();
    change(&mut files);
    files.study().expect("a plan")
}

fn folder(name: &str) -> PathBuf {
    empty_folder(format!("plan/{name}"))
}

/// A live recording without a console: each input comes half a second after the one before it.
struct Run {
    engine: SessionEngine,
    log: LogWriter,
    now_s: f64,
}

impl Run {
    fn begin(files: SessionSetup, trial: u64, out: &Path) -> Run {
        let (log, engine) = live_recording(files, trial, out);
        Run { engine, log, now_s: 0.0 }
    }

    fn session(&self) -> &Session {
        self.engine.session()
    }

    /// The reason why an input is refused, if it is.
    fn input(&mut self, event: Event) -> Option<String> {
        self.now_s += 0.5;
        let outcome = self.engine.input(at(self.now_s), event);
        outcome.events.iter().for_each(|stamped| self.log.append(stamped).expect("the log can be written"));
        outcome.refused
    }
}
