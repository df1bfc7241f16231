//! The program, started with arguments and without a terminal, and folders and session files for it.

use std::fs;
use std::net::{TcpListener, TcpStream};
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Output, Stdio};
use std::time::{Duration, Instant};

use serde_json::Value;

/// Nothing that is waited for takes longer, however busy the machine is; that it does not come is the failure.
pub const PATIENCE: Duration = Duration::from_secs(300);
pub const TOMCOM: &str = env!("CARGO_BIN_EXE_tomcom");

/// A folder of this name, which no other test uses, with nothing in it.
pub fn folder(name: &str) -> PathBuf {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("program").join(name);
    let _ = fs::remove_dir_all(&folder);
    fs::create_dir_all(&folder).expect("a folder");
    folder
}

/// All files below a folder.
pub fn files_below(folder: &Path) -> Vec<PathBuf> {
    let entries = fs::read_dir(folder).expect("a folder").map(|entry| entry.expect("an entry").path());
    let is_folder = |path: &Path| path.symlink_metadata().expect("it is there").is_dir();
    entries.flat_map(|path| if is_folder(&path) { files_below(&path) } else { vec![path] }).collect()
}

pub fn tomcom(arguments: &[&str]) -> Output {
    Command::new(TOMCOM).args(arguments).stdin(Stdio::null()).output().expect("tomcom runs")
}

pub fn start(arguments: &[&str]) -> Child {
    let mut command = Command::new(TOMCOM);
    command.args(arguments).stdin(Stdio::null()).stdout(Stdio::piped()).stderr(Stdio::piped());
    command.spawn().expect("tomcom runs")
}

/// What a program said that has to end by itself.
pub fn end(what: &str, mut child: Child) -> Output {
    let began = Instant::now();
    while child.try_wait().expect("a child").is_none() {
        if began.elapsed() > PATIENCE {
            child.kill().expect("killed");
            panic!("{what} does not end: {:?}", child.wait_with_output());
        }
        std::thread::sleep(Duration::from_millis(20));
    }
    child.wait_with_output().expect("its output")
}

/// What the program prints with these arguments, which it takes.
pub fn done(arguments: &[&str]) -> String {
    let output = tomcom(arguments);
    assert!(output.status.success(), "{arguments:?}: {output:?}");
    String::from_utf8(output.stdout).expect("UTF-8")
}

/// The one JSON object that it prints.
pub fn json(arguments: &[&str]) -> Value {
    serde_json::from_str(&done(&[arguments, &["--format", "json"]].concat())).expect("one JSON object")
}

/// Asserts that the program refuses these arguments and says so in these words, wherever its lines break.
pub fn refused(arguments: &[&str], says: &str) {
    let output = end(&arguments.join(" "), start(arguments));
    let told = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!(output.status.code(), Some(2), "{arguments:?}: {told}");
    assert!(told.replace("\n  │ ", " ").contains(says), "{says:?} is not in\n{told}");
}

/// What `tomcom replay RECORDING --verify` finds.
pub fn verified(recording: &Path) -> Value {
    let found = json(&["replay", &recording.display().to_string(), "--verify"]);
    assert_eq!(found["verified"], true, "{}: {found}", recording.display());
    found
}

/// A session file of the sushi kitchen with these settings.
pub fn session_file(folder: &Path, settings: &str) -> String {
    let session = folder.join("session.toml");
    let layout = concat!(env!("CARGO_MANIFEST_DIR"), "/layouts/sushi.toml");
    fs::write(&session, format!("layout = \"{layout}\"\n{settings}")).expect("written");
    session.display().to_string()
}

/// A plan of two participants with trials of a few presses.
pub fn tiny_plan(folder: &Path) -> String {
    let root = env!("CARGO_MANIFEST_DIR");
    let settings = format!(
        "seed = 3\n[trial]\npresses = 6\n[robot]\npress_s = 0.2\n\
         [console]\nvisibility = \"state\"\n[plan]\nname = \"tiny\"\nparticipants = [\"A1\", \"B2\"]\nconditions = [\"none\", \"wizard\"]\n\
         instruction = [\"Show the table.\", \"Show the buttons.\"]\ndebriefing = [\"What did you miss?\"]\n\
         [plan.familiarisation]\npresses = 4\nseconds = 60.0\norders = 1\n\
         [[plan.questionnaire]]\nfile = \"{root}/sessions/questionnaires/acceptance.toml\"\n"
    );
    session_file(folder, &settings)
}

/// A session file with gaze over TCP on a port of its own, and where to connect.
pub fn session_with_tracker(folder: &Path) -> (String, impl Fn() -> TcpStream) {
    let free = TcpListener::bind(("127.0.0.1", 0)).and_then(|listener| listener.local_addr()).expect("a free port");
    let text = fs::read_to_string("sessions/default.toml").expect("the default session");
    let layouts = format!("{}/layouts", env!("CARGO_MANIFEST_DIR"));
    let text = text.replace("../layouts", &layouts).replace("50021", &free.port().to_string());
    let session = folder.join("session.toml");
    fs::write(&session, text).expect("written");
    (session.display().to_string(), move || TcpStream::connect(free).expect("it listens"))
}
