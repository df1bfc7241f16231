//! Films beside a replay: the player mpv shows each film of the recording in a window of its own, and follows the
//! replay over mpv's IPC socket. Nobody waits for the player: what its socket does not take is left out.

use std::ffi::OsString;
use std::io::{ErrorKind, Read, Write};
use std::os::unix::net::UnixStream;
use std::path::Path;
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

use serde_json::{Value, json};
use tempfile::TempDir;

use tomcom_core::base::time::SessionTime;
use tomcom_devices::child_process::ChildProcess;
use tomcom_session::log::video_file::AttachedFilm;

/// Time that mpv has to open its socket.
const OPENING: Duration = Duration::from_secs(20);
/// How far the film may be from the replay before the player jumps, in seconds of film; below that its speed is changed.
const JUMP_S: f64 = 0.4;
/// How far a film may stand from a replay that is paused, in seconds: a frame of a slow camera.
const STANDS_S: f64 = 0.07;
/// Period of asking the player where it is.
const ASK: Duration = Duration::from_millis(500);
/// Speeds of mpv.
const SPEEDS: (f64, f64) = (0.01, 100.0);

/// A film in a window of mpv.
pub struct FilmPlayer {
    pub film: AttachedFilm,
    process: ChildProcess,
    /// Its socket is in a folder that no other account can enter.
    folder: TempDir,
    opened: Instant,
    socket: Option<UnixStream>,
    heard: Vec<u8>,
    told: Option<Told>,
    asked: Instant,
}

/// What the player was told last.
#[derive(Clone, Copy)]
struct Told {
    at: Instant,
    film_s: f64,
    /// 0 while the replay is paused.
    speed: f64,
}

impl FilmPlayer {
    /// Opens a film of the recording in this folder.
    ///
    /// # Errors
    /// mpv is not installed, in words.
    pub fn open(film: &AttachedFilm, folder: &Path) -> Result<FilmPlayer, String> {
        let sockets = tempfile::tempdir().map_err(|error| error.to_string())?;
        let mut address = OsString::from("--input-ipc-server=");
        address.push(sockets.path().join("mpv"));
        let path = film.path(folder);
        let path = path.canonicalize().map_err(|error| format!("{}: {error}", path.display()))?;
        let mut command = Command::new("mpv");
        command.args(["--no-terminal", "--pause", "--keep-open=always", "--hr-seek=yes", "--force-window=yes"]);
        command.args(["--no-resume-playback", "--really-quiet"]).arg(address).arg("--").arg(path);
        command.stdin(Stdio::null()).stdout(Stdio::null()).stderr(Stdio::null());
        let process = ChildProcess::start(&mut command).map_err(|error| match error.kind() {
            ErrorKind::NotFound => "mpv is not installed".to_string(),
            _ => format!("mpv cannot be started: {error}"),
        })?;
        let (film, now) = (film.clone(), Instant::now());
        let (socket, heard, told) = (None, Vec::new(), None);
        Ok(FilmPlayer { film, process, folder: sockets, opened: now, socket, heard, told, asked: now })
    }

    /// Shows what the film has at this moment of the session, which plays with this speed (0: paused). Returns whether the
    /// player is there still.
    pub fn show(&mut self, time: SessionTime, speed: f64) -> bool {
        if self.process.child().try_wait().is_ok_and(|ended| ended.is_some()) {
            return false;
        }
        if self.socket.is_none() {
            let socket = UnixStream::connect(self.folder.path().join("mpv"));
            let socket = socket.and_then(|socket| socket.set_nonblocking(true).map(|()| socket));
            match socket {
                Ok(socket) => self.socket = Some(socket),
                Err(_) => return self.opened.elapsed() < OPENING,
            }
        }
        self.follow(self.film.film_s(time).max(0.0), speed) && self.correct()
    }

    /// Tells the player of jumps, pauses and changes of speed.
    fn follow(&mut self, film_s: f64, speed: f64) -> bool {
        let now = Instant::now();
        let is_jump = self.told.is_none_or(|told| {
            let expected_s = told.film_s + told.speed * now.duration_since(told.at).as_secs_f64();
            (film_s - expected_s).abs() > if speed > 0.0 { JUMP_S * speed.max(1.0) } else { 0.001 }
        });
        let before = self.told.map(|told| told.speed);
        self.told = Some(Told { at: now, film_s, speed });
        let mut is_there = true;
        if before != Some(speed) {
            is_there &= self.say(json!(["set_property", "pause", speed <= 0.0]));
            if speed > 0.0 {
                is_there &= self.say(json!(["set_property", "speed", speed.clamp(SPEEDS.0, SPEEDS.1)]));
            }
        }
        if is_jump || before != Some(speed) {
            is_there &= self.say(json!(["seek", film_s, "absolute+exact"]));
        }
        is_there
    }

    /// Asks where the player is, and makes up for what opening the film, a jump or the decoding took.
    fn correct(&mut self) -> bool {
        let Some(told) = self.told else { return true };
        if self.asked.elapsed() >= ASK {
            self.asked = Instant::now();
            if !self.say(json!(["get_property", "time-pos"])) {
                return false;
            }
        }
        let Some(film_s) = self.hear() else { return false };
        let Some(film_s) = film_s else { return true };
        let behind_s = told.film_s + told.speed * told.at.elapsed().as_secs_f64() - film_s;
        let most_s = if told.speed > 0.0 { JUMP_S * told.speed.max(1.0) } else { STANDS_S };
        if behind_s.abs() > most_s {
            // What the jump itself takes is made up for afterwards.
            self.say(json!(["seek", film_s + behind_s, "absolute+exact"]))
        } else if told.speed > 0.0 {
            let speed = told.speed * (1.0 + (behind_s / told.speed).clamp(-0.2, 0.2));
            self.say(json!(["set_property", "speed", speed.clamp(SPEEDS.0, SPEEDS.1)]))
        } else {
            true
        }
    }

    /// Sends a command; returns whether the player is there.
    fn say(&mut self, command: Value) -> bool {
        let line = json!({ "command": command }).to_string() + "\n";
        let Some(socket) = &mut self.socket else { return true };
        match socket.write_all(line.as_bytes()) {
            Ok(()) => true,
            // A player that is busy gets the next command.
            Err(error) => error.kind() == ErrorKind::WouldBlock,
        }
    }

    /// Reads what the player said; the time in the film, if it told that. `None` if the player is gone.
    fn hear(&mut self) -> Option<Option<f64>> {
        let socket = self.socket.as_mut()?;
        let mut bytes = [0; 4096];
        loop {
            match socket.read(&mut bytes) {
                Ok(0) => return None,
                Ok(read) => self.heard.extend_from_slice(&bytes[..read]),
                Err(error) if error.kind() == ErrorKind::WouldBlock => break,
                Err(error) if error.kind() == ErrorKind::Interrupted => {}
                Err(_) => return None,
            }
        }
        let mut told = None;
        while let Some(end) = self.heard.iter().position(|&byte| byte == b'\n') {
            let line: Vec<u8> = self.heard.drain(..=end).collect();
            let answer: Value = serde_json::from_slice(&line).unwrap_or_default();
            // Of the commands only one is answered with a number.
            told = answer["data"].as_f64().or(told);
        }
        if self.heard.len() > 1 << 16 {
            self.heard.clear();
        }
        Some(told)
    }
}

/// Players of the films of the recording in this folder, and why a film is not shown, in words.
pub fn open_all(films: &[AttachedFilm], folder: &Path) -> (Vec<FilmPlayer>, Option<String>) {
    let has_screen = ["DISPLAY", "WAYLAND_DISPLAY"].iter().any(|name| std::env::var_os(name).is_some());
    if films.is_empty() || (!has_screen && cfg!(not(target_os = "macos"))) {
        let why = "there is no screen for a window";
        return (Vec::new(), (!films.is_empty()).then(|| why.to_string()));
    }
    let (mut players, mut fault) = (Vec::new(), None);
    for film in films {
        match FilmPlayer::open(film, folder) {
            Ok(player) => players.push(player),
            Err(reason) => fault = Some(reason),
        }
    }
    (players, fault)
}
