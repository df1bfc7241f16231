//! The real program in a terminal: presses keys and moves the mouse as a person does, and reads the screen and the recording.

use std::fs::{self, File};
use std::io::{Read, Write};
use std::os::unix::process::CommandExt;
use std::path::PathBuf;
use std::process::{Child, Command, Stdio};
use std::sync::{Arc, Mutex, MutexGuard};
use std::time::{Duration, Instant};

use rustix::event::{PollFd, PollFlags, Timespec, poll};
use rustix::process::{Pid, Signal, ioctl_tiocsctty, kill_process, setsid};
use rustix::pty::{OpenptFlags, grantpt, ioctl_tiocgptpeer, openpt, unlockpt};
use rustix::termios::{OptionalActions, Termios, Winsize, tcgetattr, tcsetattr, tcsetwinsize};
use vt100::{MouseProtocolMode, Parser, Screen};

use crate::program::{PATIENCE, TOMCOM, folder, json, verified};

pub const SIZE: (u16, u16) = (120, 40);
/// What became of a key, in the numbers of kitty's protocol.
const PRESSED: u8 = 1;
const REPEATED: u8 = 2;
const RELEASED: u8 = 3;

/// A terminal in a folder of its own. Like kitty, Ghostty or Windows Terminal it reports releases of keys.
pub struct Terminal {
    pub folder: PathBuf,
    /// The side of the keyboard and the screen.
    device: File,
    /// The side of programs.
    line: File,
    display: Arc<Mutex<Parser<Requests>>>,
    /// Held while the screen is read.
    reader: Arc<Mutex<()>>,
    /// The line discipline before the first program.
    before: Termios,
    program: Mutex<Option<Child>>,
}

/// What programs ask of a terminal besides what it shows.
struct Requests {
    device: File,
    /// How many programs asked for reports of keys, and whether changes of the focus are to be reported.
    keys: i32,
    focus: bool,
    /// What stays on the screen until a new frame is complete.
    shown: Option<String>,
    /// How often the bell rang.
    bells: u64,
}

impl vt100::Callbacks for Requests {
    fn audible_bell(&mut self, _: &mut Screen) {
        self.bells += 1;
    }

    fn unhandled_csi(&mut self, screen: &mut Screen, kind: Option<u8>, _: Option<u8>, numbers: &[&[u16]], last: char) {
        match (kind, last) {
            // The program asks for it, and waits.
            (None, 'c') => self.device.write_all(b"\x1b[?62;22c").expect("written"),
            (Some(b'>'), 'u') => self.keys += 1,
            (Some(b'<'), 'u') => self.keys -= 1,
            (Some(b'?'), 'h' | 'l') if numbers == [&[1004]] => self.focus = last == 'h',
            (Some(b'?'), 'h' | 'l') if numbers == [&[2026]] => self.shown = (last == 'h').then(|| screen.contents()),
            _ => {}
        }
    }
}

impl Terminal {
    pub fn open(name: &str) -> Terminal {
        let flags = OpenptFlags::RDWR | OpenptFlags::NOCTTY | OpenptFlags::CLOEXEC;
        let device = openpt(flags).expect("a pseudo terminal");
        grantpt(&device).and_then(|()| unlockpt(&device)).expect("it opens");
        let line = File::from(ioctl_tiocgptpeer(&device, flags).expect("it opens"));
        let device = File::from(device);
        let (display, reader) = (Arc::new(Mutex::new(display(&device))), Arc::new(Mutex::new(())));
        let (before, shown, turn) = (tcgetattr(&line).expect("modes"), Arc::downgrade(&display), reader.clone());
        let mut read_from = device.try_clone().expect("a file");
        std::thread::spawn(move || {
            let (mut bytes, pause) = (vec![0; 1 << 16], Timespec { tv_sec: 0, tv_nsec: 50_000_000 });
            while let Some(display) = shown.upgrade() {
                let _turn = turn.lock();
                if poll(&mut [PollFd::new(&read_from, PollFlags::IN)], Some(&pause)).is_ok_and(|ready| ready > 0) {
                    let Ok(count) = read_from.read(&mut bytes) else { return };
                    display.lock().unwrap_or_else(|poisoned| poisoned.into_inner()).process(&bytes[..count]);
                }
            }
        });
        let folder = folder(name);
        let terminal = Terminal { folder, device, line, display, reader, before, program: Mutex::new(None) };
        terminal.resize(SIZE);
        terminal
    }

    fn resize(&self, (columns, rows): (u16, u16)) {
        let size = Winsize { ws_row: rows, ws_col: columns, ws_xpixel: 0, ws_ypixel: 0 };
        tcsetwinsize(&self.device, size).expect("resized");
    }

    fn display(&self) -> MutexGuard<'_, Parser<Requests>> {
        self.display.lock().unwrap_or_else(|poisoned| poisoned.into_inner())
    }

    /// Another program writes in the terminal.
    pub fn writes_over(&self, words: &str) {
        self.display().process(words.as_bytes());
    }

    pub fn screen(&self) -> String {
        let display = self.display();
        display.callbacks().shown.clone().unwrap_or_else(|| display.screen().contents())
    }

    /// These bytes from the terminal, as from one that reports no releases.
    pub fn send(&self, bytes: &str) {
        (&self.device).write_all(bytes.as_bytes()).expect("written");
    }

    /// Presses and releases a key: "a", "Space", "C-c".
    pub fn key(&self, key: &str) {
        self.send(&(report(key, PRESSED) + &report(key, RELEASED)));
    }

    /// Holds a key down for a while.
    pub fn hold(&self, key: &str) {
        self.send(&(report(key, PRESSED) + &report(key, REPEATED).repeat(19) + &report(key, RELEASED)));
    }

    /// Moves the mouse pointer to a cell.
    pub fn point(&self, column: u16, row: u16) {
        self.send(&format!("\x1b[<35;{};{}M", column + 1, row + 1));
    }

    pub fn see(&self, text: &str) {
        self.wait(&format!("\"{text}\" on the screen"), || self.screen().contains(text));
    }

    pub fn bells(&self) -> u64 {
        self.display().callbacks().bells
    }

    /// Waits for these words, wherever lines break.
    pub fn see_words(&self, text: &str) {
        let words = |text: &str| text.split_whitespace().filter(|word| *word != "│").collect::<String>();
        self.wait(&format!("\"{text}\" on the screen"), || words(&self.screen()).contains(&words(text)));
    }

    /// Presses a key again and again, each time when something new is on the screen, until this is so.
    pub fn turn_until(&self, key: &str, what: &str, is_so: impl Fn() -> bool) {
        let mut shown = String::new();
        self.wait(what, || {
            let (is_so, now) = (is_so(), self.words());
            if !is_so && now != shown {
                self.key(key);
                shown = now;
            }
            is_so
        });
    }

    /// Presses a key until this is so, again each second: what it asks for may not be possible yet.
    pub fn insist(&self, key: &str, what: &str, is_so: impl Fn() -> bool) {
        let mut pressed = None;
        self.wait(what, || {
            if !is_so() && pressed.is_none_or(|at: Instant| at.elapsed() > Duration::from_secs(1)) {
                self.key(key);
                pressed = Some(Instant::now());
            }
            is_so()
        });
    }

    /// What is on the screen without its figures, which change by themselves.
    pub fn words(&self) -> String {
        self.screen().chars().filter(|letter| letter.is_alphabetic()).collect()
    }

    pub fn wait(&self, what: &str, mut is_so: impl FnMut() -> bool) {
        let began = Instant::now();
        while !is_so() {
            assert!(began.elapsed() < PATIENCE, "waited in vain for {what}; the screen is\n{}", self.screen());
            std::thread::sleep(Duration::from_millis(20));
        }
    }

    /// Starts tomcom with these arguments.
    pub fn run(&self, arguments: &[&str]) {
        self.start(Command::new(TOMCOM).args(arguments));
    }

    /// Starts a program on an empty screen.
    pub fn start(&self, command: &mut Command) {
        tcsetattr(&self.line, OptionalActions::Flush, &self.before).expect("modes");
        self.resize(SIZE);
        *self.display() = display(&self.device);
        command.stdin(self.line()).stdout(self.line()).stderr(self.line());
        command.env("TERM", "xterm-256color").env("LC_ALL", "C.UTF-8").env_remove("NO_COLOR");
        // What is rescued, or was not deleted, is found here.
        command.env("TMPDIR", &self.folder);
        own_session(command, true);
        *self.program.lock().expect("unlocked") = Some(command.spawn().expect("it starts"));
    }

    /// The side of programs, for one more of them.
    pub fn line(&self) -> Stdio {
        self.line.try_clone().expect("a file").into()
    }

    pub fn pid(&self) -> u32 {
        self.program.lock().expect("unlocked").as_ref().expect("a program").id()
    }

    pub fn signal(&self, signal: Signal) {
        let pid = Pid::from_raw(self.pid() as i32).expect("no 0");
        kill_process(pid, signal).expect("it is there");
    }

    pub fn has_ended(&self) -> bool {
        self.program.lock().expect("unlocked").as_mut().expect("a program").try_wait().expect("a child").is_some()
    }

    /// Waits for the program's end; its exit code, `None` if a signal killed it.
    pub fn end(&self) -> Option<i32> {
        self.wait("the end", || self.has_ended());
        self.program.lock().expect("unlocked").as_mut().expect("a program").wait().expect("a child").code()
    }

    pub fn kill(&self) {
        self.signal(Signal::KILL);
        self.end();
    }

    /// Starts a session of this file of the project with these arguments, and waits for the console.
    pub fn operate(&self, session: &str, arguments: &[&str]) {
        let (session, out) = (format!("sessions/{session}"), self.recordings());
        self.run(&[&["operate", &session, "--out", &out], arguments].concat());
        self.see("READY");
    }

    /// Where recordings go.
    pub fn recordings(&self) -> String {
        self.folder.join("recordings").display().to_string()
    }

    pub fn recording(&self) -> PathBuf {
        let entries = fs::read_dir(self.recordings()).expect("recordings");
        let mut paths = entries.map(|entry| entry.expect("readable").path());
        paths.find(|path| path.join("events.jsonl").exists()).expect("a recording")
    }

    pub fn log(&self) -> String {
        fs::read_to_string(self.recording().join("events.jsonl")).expect("a log")
    }

    pub fn count(&self, text: &str) -> usize {
        self.log().lines().skip(1).filter(|line| line.contains(text)).count()
    }

    /// Waits until the log has more gaze than some.
    pub fn gaze(&self, samples: usize) {
        self.wait("gaze", || self.count("\"kind\":\"gaze\"") > samples);
    }

    /// Presses a key and waits until the log has one more line with this text.
    pub fn key_logs(&self, key: &str, text: &str) {
        let before = self.count(text);
        self.key(key);
        self.wait(&format!("{text} after {key}"), || self.count(text) > before);
    }

    /// Starts the trial, also where not all is ok for it: no tracker sends yet, or the disk is small.
    pub fn begin(&self) {
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

    /// Waits for the program's end, and checks that the terminal is as it was before.
    pub fn is_whole(&self, exit: i32) {
        assert_eq!(self.end(), Some(exit), "{}", self.screen());
        self.is_given_back();
    }

    /// Checks that the terminal is as it was before the program.
    pub fn is_given_back(&self) {
        let modes = |modes: &Termios| format!("{modes:?}");
        assert_eq!(modes(&tcgetattr(&self.line).expect("modes")), modes(&self.before), "the line discipline");
        self.wait("a whole terminal", || {
            let display = self.display();
            let (screen, asked) = (display.screen(), display.callbacks());
            let mouse = screen.mouse_protocol_mode() != MouseProtocolMode::None;
            let modes = [screen.alternate_screen(), screen.hide_cursor(), screen.bracketed_paste(), mouse, asked.focus];
            modes == [false; 5] && asked.keys == 0
        });
    }

    /// What `tomcom list` says of the newest part of the only session.
    pub fn listed(&self, what: &str) -> serde_json::Value {
        json(&["list", &self.recordings()])["recordings"][0][what].clone()
    }

    pub fn quit(&self) {
        self.key("C-c");
        self.see("Quit tomcom?");
        self.key("y");
        self.is_whole(0);
        self.see("recorded in");
        // Each command stands on a line of its own, to be copied.
        let has_line = |start: &str| self.screen().lines().any(|line| line.starts_with(start));
        self.wait("how to go on", || ["  tomcom replay ", "  tomcom review "].into_iter().all(has_line));
    }

    pub fn verifies(&self) {
        verified(&self.recording());
    }

    /// Reads nothing until `then` is done, which is done when the program can write no more.
    pub fn unread<T>(&self, then: impl FnOnce() -> T) -> T {
        let _unread = self.reader.lock();
        let (began, mut wide) = (Instant::now(), false);
        let pause = Timespec { tv_sec: 0, tv_nsec: 500_000_000 };
        while poll(&mut [PollFd::new(&self.line, PollFlags::OUT)], Some(&pause)).expect("a terminal") > 0 {
            assert!(began.elapsed() < PATIENCE, "the terminal does not fill");
            // The program draws a whole screen.
            wide = !wide;
            self.resize(if wide { (200, 60) } else { SIZE });
        }
        then()
    }
}

impl Drop for Terminal {
    fn drop(&mut self) {
        if let Some(mut program) = self.program.lock().unwrap_or_else(|poisoned| poisoned.into_inner()).take() {
            let _ = program.kill();
            let _ = program.wait();
        }
    }
}

/// Has the program run in a session of its own, with its input as the terminal that controls it or without one.
pub fn own_session(command: &mut Command, is_controlled: bool) {
    let begin = move || {
        setsid()?;
        if is_controlled {
            ioctl_tiocsctty(rustix::stdio::stdin())?;
        }
        Ok(())
    };
    // SAFETY: these calls may stand between fork and exec; they allocate nothing.
    unsafe { command.pre_exec(begin) };
}

fn display(device: &File) -> Parser<Requests> {
    let requests =
        Requests { device: device.try_clone().expect("a file"), keys: 0, focus: false, shown: None, bells: 0 };
    let (columns, rows) = SIZE;
    Parser::new_with_callbacks(rows.try_into().expect("rows"), columns.try_into().expect("columns"), 0, requests)
}

/// The sequence that reports this of a key.
fn report(key: &str, kind: u8) -> String {
    let (mask, name) = key.strip_prefix("C-").map_or((1, key), |name| (5, name));
    let (number, last) = match name {
        "Tab" => (9, 'u'),
        "Enter" => (13, 'u'),
        "Escape" => (27, 'u'),
        "Space" => (32, 'u'),
        "Backspace" => (127, 'u'),
        "Delete" => (3, '~'),
        "Down" => (1, 'B'),
        "Right" => (1, 'C'),
        "End" => (1, 'F'),
        "Home" => (1, 'H'),
        letter => (u32::from(letter.chars().next().expect("a key")), 'u'),
    };
    format!("\x1b[{number};{mask}:{kind}{last}")
}
