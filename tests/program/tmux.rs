//! The real program in a real terminal: runs the binary in tmux, presses keys and moves the mouse as a person does, and
//! reads the screen and the recording.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};
use std::time::{Duration, Instant};

pub const SIZE: (u16, u16) = (120, 40);
/// Nothing that is waited for takes longer, however busy the machine is; that it does not come is the failure.
pub const PATIENCE: Duration = Duration::from_secs(300);
pub const TOMCOM: &str = env!("CARGO_BIN_EXE_tomcom");

/// A terminal with a shell in it, in a folder of its own.
pub struct Terminal {
    socket: String,
    pub folder: PathBuf,
}

impl Terminal {
    /// `None`, and a word about it, where there is no tmux.
    pub fn open(name: &str) -> Option<Terminal> {
        if Command::new("tmux").arg("-V").output().is_err() {
            eprintln!("skipped: {name} needs tmux");
            return None;
        }
        let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("terminal").join(name);
        let _ = fs::remove_dir_all(&folder);
        fs::create_dir_all(&folder).expect("a folder");
        let terminal = Terminal { socket: format!("tomcom-{}-{name}", std::process::id()), folder };
        let (columns, rows) = (SIZE.0.to_string(), SIZE.1.to_string());
        let shell = "env -u NO_COLOR LC_ALL=C.UTF-8 PS1='$ ' sh";
        terminal.tmux(&["-f", "/dev/null", "new-session", "-d", "-x", &columns, "-y", &rows, shell]);
        terminal.tmux(&["set-option", "-g", "status", "off"]);
        terminal.tmux(&["set-option", "-sg", "escape-time", "0"]);
        Some(terminal)
    }

    pub fn tmux(&self, arguments: &[&str]) -> String {
        let output = Command::new("tmux").args(["-u", "-L", &self.socket]).args(arguments).output().expect("tmux runs");
        assert!(output.status.success(), "tmux {arguments:?}: {}", String::from_utf8_lossy(&output.stderr));
        String::from_utf8_lossy(&output.stdout).into_owned()
    }

    pub fn screen(&self) -> String {
        self.tmux(&["capture-pane", "-p"])
    }

    /// A key by its tmux name: "a", "Space", "C-c".
    pub fn key(&self, key: &str) {
        self.tmux(&["send-keys", key]);
    }

    /// Types a command line into the shell.
    pub fn shell(&self, line: &str) {
        self.tmux(&["send-keys", "-l", line]);
        self.key("Enter");
    }

    /// Moves the mouse pointer to a cell, as the terminal reports it (SGR).
    pub fn point(&self, column: u16, row: u16) {
        self.tmux(&["send-keys", "-l", &format!("\x1b[<35;{};{}M", column + 1, row + 1)]);
    }

    pub fn see(&self, text: &str) {
        self.wait(&format!("\"{text}\" on the screen"), || self.screen().contains(text));
    }

    pub fn wait(&self, what: &str, mut is_so: impl FnMut() -> bool) {
        let began = Instant::now();
        while !is_so() {
            assert!(began.elapsed() < PATIENCE, "waited in vain for {what}; the screen is\n{}", self.screen());
            std::thread::sleep(Duration::from_millis(30));
        }
    }

    /// Runs a program in the shell, which notes its process id and how the terminal was before and after.
    pub fn run(&self, program: &str) {
        let folder = self.folder.display();
        self.shell(&format!(
            "clear; stty -g > {folder}/before; sh -c 'echo $$ > {folder}/pid; exec {program}'; \
             echo exit $? > {folder}/exit; stty -g > {folder}/after"
        ));
    }

    /// Starts a session of this file with these arguments, and waits for the console.
    pub fn operate(&self, session: &str, arguments: &str) {
        let root = env!("CARGO_MANIFEST_DIR");
        let out = self.folder.display();
        self.run(&format!("{TOMCOM} operate {root}/sessions/{session} --out {out}/recordings {arguments}"));
        self.see("READY");
    }

    pub fn recording(&self) -> PathBuf {
        let entries = fs::read_dir(self.folder.join("recordings")).expect("recordings");
        entries.map(|entry| entry.expect("readable").path()).find(|path| path.is_dir()).expect("a recording")
    }

    pub fn log(&self) -> String {
        fs::read_to_string(self.recording().join("events.jsonl")).expect("a log")
    }

    pub fn count(&self, text: &str) -> usize {
        self.log().lines().skip(1).filter(|line| line.contains(text)).count()
    }

    /// Presses a key and waits until the log has one more line with this text.
    pub fn key_logs(&self, key: &str, text: &str) {
        let before = self.count(text);
        self.key(key);
        self.wait(&format!("{text} after {key}"), || self.count(text) > before);
    }

    /// Starts the trial, also where not all is ok for it: no tracker sends yet, or the disk is small.
    pub fn start(&self) {
        self.key(".");
        let mut overridden = false;
        self.wait("the trial", || {
            if !overridden && self.screen().contains("start the trial anyway") {
                self.key("o");
                overridden = true;
            }
            self.screen().contains("RUNNING")
        });
    }

    /// Waits for the program's end and checks that the terminal is as it was before.
    pub fn is_whole(&self, exit: &str) {
        self.wait("the end", || self.folder.join("after").exists());
        self.wait("stty", || !self.read("after").is_empty());
        assert_eq!(self.read("exit").trim(), format!("exit {exit}"), "{}", self.screen());
        assert_eq!(self.read("before"), self.read("after"), "the line discipline");
        let flags = "#{alternate_on} #{cursor_flag} #{mouse_any_flag} #{mouse_sgr_flag}";
        self.wait("a whole terminal", || self.tmux(&["display-message", "-p", flags]).trim() == "0 1 0 0");
        fs::remove_file(self.folder.join("after")).expect("read before");
    }

    pub fn read(&self, name: &str) -> String {
        fs::read_to_string(self.folder.join(name)).unwrap_or_default()
    }

    pub fn quit(&self) {
        self.key("C-c");
        self.see("Quit tomcom?");
        self.key("y");
        self.is_whole("0");
        self.see("recorded in");
        let screen = self.screen();
        let has_line = |start: &str| screen.lines().any(|line| line.starts_with(start));
        let both = ["  tomcom replay ", "  tomcom review "].iter().all(|start| has_line(start));
        assert!(both, "each command stands on a line of its own, to be copied:\n{screen}");
    }

    pub fn verifies(&self) {
        let recording = self.recording();
        let output = tomcom(&["replay", &recording.display().to_string(), "--verify"]);
        assert!(output.status.success(), "{output:?}");
    }
}

impl Drop for Terminal {
    fn drop(&mut self) {
        let _ = Command::new("tmux").args(["-L", &self.socket, "kill-server"]).output();
    }
}

pub fn tomcom(arguments: &[&str]) -> Output {
    Command::new(TOMCOM).args(arguments).output().expect("tomcom runs")
}

/// What the program prints with these arguments, which it takes.
pub fn done(arguments: &[&str]) -> String {
    let output = tomcom(arguments);
    assert!(output.status.success(), "{arguments:?}: {output:?}");
    String::from_utf8(output.stdout).expect("UTF-8")
}

/// Asserts that the program refuses these arguments and says so in these words, wherever its lines break.
pub fn refused(arguments: &[&str], says: &str) {
    let output = tomcom(arguments);
    let told = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!(output.status.code(), Some(2), "{arguments:?}: {told}");
    assert!(told.replace("\n  │ ", " ").contains(says), "{says:?} is not in\n{told}");
}

/// A plan of two participants with trials of a few presses.
pub fn tiny_plan(folder: &Path) -> PathBuf {
    let root = env!("CARGO_MANIFEST_DIR");
    let session = folder.join("tiny.toml");
    let text = format!(
        "layout = \"{root}/layouts/sushi.toml\"\nseed = 3\n[trial]\npresses = 6\n[robot]\npress_s = 0.2\n\
         [console]\nvisibility = \"state\"\n[plan]\nname = \"tiny\"\nparticipants = [\"A1\", \"B2\"]\nconditions = [\"none\", \"wizard\"]\n\
         instruction = [\"Show the table.\", \"Show the buttons.\"]\ndebriefing = [\"What did you miss?\"]\n\
         [plan.familiarisation]\npresses = 4\nseconds = 60.0\norders = 1\n\
         [[plan.questionnaire]]\nfile = \"{root}/sessions/questionnaires/acceptance.toml\"\n"
    );
    fs::write(&session, text).expect("written");
    session
}
