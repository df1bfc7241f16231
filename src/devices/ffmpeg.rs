//! The program ffmpeg, which decodes films and records cameras: what it says of frames and faults.

use std::ffi::OsStr;
use std::io::{BufRead, BufReader, Read};
use std::process::{Command, Stdio};

use super::child_process::find_program;

/// How to get ffmpeg, for messages.
pub const REMEDY: &str = "install ffmpeg (Debian and Ubuntu: apt install ffmpeg)";
/// The filter that makes ffmpeg tell the time of each frame.
pub const TELLS_TIMES: &str = "showinfo=checksum=0";

/// What ffmpeg says.
#[derive(Clone, Debug, PartialEq)]
pub enum FfmpegMessage {
    /// Time of the next frame, in seconds; NaN if it has none.
    Frame(f64),
    Fault(String),
}

/// Whether ffmpeg is in `PATH`.
pub fn is_installed() -> bool {
    find_program("ffmpeg").is_some()
}

/// The command, with what all uses of it share. Its error output must be read for it to go on.
pub fn command() -> Command {
    let mut command = Command::new("ffmpeg");
    command.args(["-nostdin", "-hide_banner", "-nostats", "-loglevel", "level+info"]);
    command.stdin(Stdio::null()).stdout(Stdio::null()).stderr(Stdio::piped());
    command
}

/// Length of a film in seconds, as its head tells it; `None` if ffmpeg is missing, or the film does not tell it.
pub fn length_s(address: &OsStr) -> Option<f64> {
    let told = command().args(["-protocol_whitelist", "file,pipe", "-i"]).arg(address).output().ok()?;
    length_in(&String::from_utf8_lossy(&told.stderr))
}

fn length_in(said: &str) -> Option<f64> {
    let time = said.lines().find_map(|line| line.strip_prefix("[info]   Duration: "))?.split(',').next()?;
    let parts: Vec<f64> = time.split(':').map(|part| part.parse().ok()).collect::<Option<_>>()?;
    let [hours, minutes, seconds] = parts[..] else { return None };
    Some((hours * 60.0 + minutes) * 60.0 + seconds)
}

/// Reads ffmpeg's error output until it ends, or until `take` returns false.
pub fn read_messages(log: impl Read, mut take: impl FnMut(FfmpegMessage) -> bool) {
    let mut tick = None;
    for line in BufReader::new(log).split(b'\n').map_while(Result::ok) {
        let line = String::from_utf8_lossy(&line);
        if line.contains("showinfo")
            && let Some(base) = word_after(&line, "config in time_base:")
        {
            tick = fraction(base);
        }
        let fault = ["[error] ", "[fatal] "].iter().find_map(|mark| line.split(mark).nth(1));
        // The time in seconds stands there, too, with six digits: too few for a film of an hour.
        let ticks = line.contains("showinfo").then(|| word_after(&line, " pts:")).flatten();
        let message = match (ticks, fault) {
            (Some(ticks), _) => {
                let ticks: Option<i64> = ticks.parse().ok();
                let time_s = ticks.zip(tick).map(|(ticks, (over, under))| ticks as f64 * over / under);
                FfmpegMessage::Frame(time_s.unwrap_or(f64::NAN))
            }
            (None, Some(fault)) => FfmpegMessage::Fault(fault.trim().to_string()),
            (None, None) => continue,
        };
        if !take(message) {
            return;
        }
    }
}

fn word_after<'a>(line: &'a str, mark: &str) -> Option<&'a str> {
    line.split(mark).nth(1)?.split([' ', ',']).find(|word| !word.is_empty())
}

/// A unit of time in seconds, such as "1/90000".
fn fraction(base: &str) -> Option<(f64, f64)> {
    let (over, under) = base.split_once('/')?;
    Some((over.parse().ok()?, under.parse().ok()?))
}

#[cfg(test)]
mod tests {
    use super::{FfmpegMessage, length_in, read_messages};

    #[test]
    fn the_length_of_a_film_is_in_its_head() {
        let said = |length: &str| format!("[info] Input #0, mov:\n[info]   Duration: {length}, start: 0.000000\n");
        assert_eq!(length_in(&said("01:02:03.50")), Some(3723.5));
        assert_eq!((length_in(&said("N/A")), length_in("")), (None, None));
    }

    #[test]
    fn times_of_frames_are_exact_however_late_they_are() {
        let said = "[info] Input #0, lavfi, from 'testsrc':\n\
                    [Parsed_showinfo_0 @ 0x56] [info] config in time_base: 1/1000000, frame_rate: 30/1\n\
                    [Parsed_showinfo_0 @ 0x56] [info] n:   0 pts:1795897060618606 pts_time:1.7959e+09 pos:       -1\n\
                    [Parsed_showinfo_0 @ 0x56] [info] color_range:unknown\n\
                    [Parsed_showinfo_0 @ 0x56] [info] n:   1 pts:      0 pts_time:0       pos: 1\n\
                    [Parsed_showinfo_0 @ 0x56] [info] n:   2 pts:  NOPTS pts_time:NOPTS   pos: 1\n\
                    [video4linux2,v4l2 @ 0x5] [error] ioctl(VIDIOC_DQBUF): No such device\n";
        let mut told = Vec::new();
        read_messages(said.as_bytes(), |message| {
            told.push(message);
            true
        });
        assert_eq!(told[0], FfmpegMessage::Frame(1_795_897_060.618_606));
        assert_eq!(told[1], FfmpegMessage::Frame(0.0));
        assert!(matches!(told[2], FfmpegMessage::Frame(time_s) if time_s.is_nan()), "{told:?}");
        assert_eq!(told[3..], [FfmpegMessage::Fault("ioctl(VIDIOC_DQBUF): No such device".to_string())]);
    }
}
