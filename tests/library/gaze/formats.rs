//! Messages of Pupil, frames of ZeroMQ, and files of gaze as trackers and spreadsheets write them: read in full, or refused with line and cause.

use std::fmt::Write;

use rmpv::Value;
use tomcom::run::options::SettingOverrides;
use tomcom_core::gaze::tags::SurfaceHomography;
use tomcom_devices::gaze_file::{self, GazeFile};
use tomcom_devices::pupil::message::{self, CaptureNotification, PupilMessage};
use tomcom_devices::pupil::zmtp::ZmtpFrameAssembler;
use tomcom_session::files::file_error::FileResult;
use tomcom_session::preflight_checks::{PreflightCheck, PreflightVerdict, recorded_gaze};
use tomcom_session::tracker::{MissingConfidence, TrackerSpec};

use crate::support::*;

const DATUM: &[u8] = include_bytes!("../../pupil/surfaces_wall.msgpack");

#[test]
fn a_real_datum_of_pupil_is_read_in_full() {
    let told = message::read(b"surfaces.wall", DATUM, "wall");
    assert!(told.sees_surface && told.malformed == 0 && told.fixations.is_empty() && told.blink.is_none());
    assert_eq!(told.gaze.len(), 8);
    let first = told.gaze[0];
    assert_eq!(first.norm_pos, [0.515_122_294_425_964_4, 0.587_292_253_971_099_9]);
    assert_eq!((first.confidence, first.timestamp), (0.97, 5.113_798_565_000_025));
    assert!(told.gaze.windows(2).all(|pair| pair[0].timestamp <= pair[1].timestamp));
    // Other topics and surfaces are not ours, also where their names begin alike.
    for topic in [b"gaze.3d.01.".as_slice(), b"", b"notify.x", b"surfaces.", b"surfaces.\xff", b"surface"] {
        assert_eq!(message::read(topic, DATUM, "wall"), PupilMessage::default());
    }
    for name in ["wall2", "wal", "Surface 1"] {
        let told = message::read(format!("surfaces.{name}").as_bytes(), DATUM, "wall");
        let other_surface = Some(name.to_string());
        assert_eq!(told, PupilMessage { other_surface, ..PupilMessage::default() }, "its name and nothing else");
    }
    assert_eq!(message::read(b"surfaces.Surface 1", DATUM, "Surface 1").gaze.len(), 8);
    assert_eq!(
        message::read(&[b"surfaces.".as_slice(), &[b'x'; 200]].concat(), DATUM, "wall"),
        PupilMessage::default()
    );
}

fn packed(fields: &[(&str, Value)]) -> Vec<u8> {
    let mut bytes = Vec::new();
    let fields = fields.iter().map(|(name, value)| (Value::from(*name), value.clone()));
    rmpv::encode::write_value(&mut bytes, &Value::Map(fields.collect())).expect("written");
    bytes
}

#[test]
fn an_undecided_blink_detector_is_no_fault_and_the_recorder_is_heard() {
    let blink =
        |confidence: Value| packed(&[("type", "offset".into()), ("confidence", confidence), ("timestamp", 5.into())]);
    assert_eq!(message::read(b"blinks", &blink(f64::NAN.into()), "wall"), PupilMessage::default());
    assert!(message::read(b"blinks", &blink(0.7.into()), "wall").blink.is_some());
    for wrong in [f64::INFINITY.into(), 1.5.into(), Value::Nil, "high".into()] {
        let told = message::read(b"blinks", &blink(wrong.clone()), "wall");
        assert_eq!((told.malformed, told.blink), (1, None), "{wrong}");
    }
    let started = packed(&[("subject", "recording.started".into()), ("session_name", "2025-P07".into())]);
    let told = message::read(b"notify.recording.started", &started, "wall");
    assert_eq!(told.recorder, Some(CaptureNotification::Started("2025-P07".to_string())));
    let stopped = packed(&[("subject", "recording.stopped".into())]);
    assert_eq!(
        message::read(b"notify.recording.stopped", &stopped, "wall").recorder,
        Some(CaptureNotification::Stopped)
    );
    assert_eq!(message::read(b"notify.recording.started", &stopped, "wall").malformed, 1);
    assert_eq!(message::read(b"notify.recording.started2", &started, "wall"), PupilMessage::default());
}

#[test]
fn broken_messages_of_pupil_are_counted_and_nothing_more() {
    let read = |bytes: &[u8]| message::read(b"surfaces.wall", bytes, "wall");
    for length in 0..DATUM.len() {
        assert_eq!(read(&DATUM[..length]).malformed, 1, "cut after {length} bytes");
    }
    let mut random = stream(1, "broken messages", 0);
    let mut bytes = DATUM.to_vec();
    for _ in 0..20_000 {
        let at = random.random_range(0..bytes.len());
        let before = std::mem::replace(&mut bytes[at], random.random());
        let told = read(&bytes);
        assert!(told.gaze.len() <= 8);
        let is_number = |gaze: &message::SurfaceGaze| {
            gaze.norm_pos.iter().all(|v| v.is_finite())
                && (gaze.confidence.is_nan() || (0.0..=1.0).contains(&gaze.confidence))
                && gaze.timestamp.abs() < 9.2e9
        };
        assert!(told.gaze.iter().all(is_number), "{told:?}");
        if random.random::<bool>() {
            bytes[at] = before;
        }
        if random.random_range(0..50) == 0 {
            bytes = DATUM.to_vec();
        }
    }
    // What claims to be longer than it is: a list, a map, a text of four thousand million.
    for head in [[0xdd, 0xff, 0xff, 0xff, 0xff], [0xdf, 0xff, 0xff, 0xff, 0xff], [0xdb, 0xff, 0xff, 0xff, 0xff]] {
        assert_eq!(read(&head).malformed, 1);
    }
    assert_eq!(read(&[0x91; 100_000]).malformed, 1, "lists in lists in lists");
    // One item that is none does not cost the others.
    let item = |x: f64, confidence: Value, timestamp: Value| {
        let place = Value::Array(vec![x.into(), 0.5.into()]);
        let fields = [("norm_pos", place), ("confidence", confidence), ("timestamp", timestamp)];
        Value::Map(fields.into_iter().map(|(name, value)| (Value::from(name), value)).collect())
    };
    let read_items = |items: Vec<Value>| read(&packed(&[("gaze_on_surfaces", Value::Array(items))]));
    let at = |x: f64| item(x, 1.0.into(), 7.into());
    let told = read_items(vec![at(0.1), at(f64::NAN), Value::Nil, at(f64::INFINITY), at(0.2)]);
    assert_eq!((told.gaze.len(), told.malformed), (2, 3));
    assert_eq!(told.gaze[0].timestamp, 7.0);
    // Pupil time starts anywhere, and where a pupil was lost the confidence is NaN.
    let confident = |confidence: Value| item(0.5, confidence, (-3.5).into());
    let told = read_items(vec![confident(f64::NAN.into()), confident(0.9.into()), confident(Value::Nil)]);
    assert_eq!((told.gaze.len(), told.malformed), (2, 1));
    assert!(told.gaze[0].confidence.is_nan() && told.gaze.iter().all(|gaze| gaze.timestamp == -3.5));
}

#[test]
fn frames_are_put_together_from_any_pieces_and_claims_are_not_believed() {
    let long = vec![7u8; 300];
    let mut bytes = vec![1, 8];
    bytes.extend(b"surfaces");
    bytes.push(2);
    bytes.extend(300u64.to_be_bytes());
    bytes.extend(&long);
    // A command in between, then a message of one empty frame.
    bytes.extend([4, 2, b'o', b'k', 0, 0]);
    for piece in [1, 2, 3, 7, 64, 1000] {
        let mut inbox = ZmtpFrameAssembler::default();
        let mut found = Vec::new();
        for part in bytes.chunks(piece) {
            inbox.push(part);
            while let Some(message) = inbox.next_message().expect("messages") {
                found.push(message);
            }
        }
        assert_eq!(found, [vec![b"surfaces".to_vec(), long.clone()], vec![Vec::new()]], "pieces of {piece}");
    }
    let refused = |bytes: &[u8]| {
        let mut inbox = ZmtpFrameAssembler::default();
        inbox.push(bytes);
        inbox.next_message().is_err()
    };
    assert!(refused(&[2, 0x7f, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff]), "a frame of 8 EB");
    assert!(refused(&[0x10, 1, 1]), "flags that there are not");
    assert!(refused(&[1, 0].repeat(17)), "a message of very many frames");
}

/// Reads a file, whose surface is the middle of the display, from this time on.
fn read_from(path: &Path, file_start_s: f64) -> FileResult<GazeFile> {
    let map = SurfaceHomography::new([[0.1, 0.1], [0.9, 0.1], [0.9, 0.9], [0.1, 0.9]]).expect("a surface");
    gaze_file::read(path, &map, &TrackerSpec { file_start_s, ..TrackerSpec::default() })
}

#[test]
fn exports_of_pupil_player_and_own_recordings_are_replayed() {
    let path = Path::new("tests/pupil/gaze_positions_on_surface_wall.csv");
    let found = read_from(path, 0.0).expect("an export");
    assert_eq!((found.samples.len(), found.summary.malformed), (3, 2));
    let (at_s, sample) = found.samples[1];
    assert!((at_s - 0.004_124_045).abs() < 1e-8, "{at_s}");
    assert!((sample.x - 0.3).abs() < 1e-9 && (sample.y - 0.1).abs() < 1e-9, "{sample:?}");
    assert_eq!((sample.device_ns, sample.confidence), (Some(5_117_922_610), 0.91));
    let error = read_from(Path::new("layouts/sushi.toml"), 0.0).expect_err("no export");
    assert!(error.to_string().contains("no column gaze_timestamp"), "{error}");
    let recording = std::fs::read_dir("tests/golden").expect("recordings").map(|entry| entry.expect("an entry").path());
    let recording = recording.filter(|path| path.extension().is_some_and(|extension| extension == "jsonl"));
    // A recording may have no gaze, which is said.
    let read = |path: PathBuf| read_from(&path, 0.0).map_or(0, |found| found.samples.len());
    let counts: Vec<usize> = recording.map(read).collect();
    assert!(counts.iter().any(|count| *count > 1000), "{counts:?}");
}

#[test]
fn a_trial_starts_anywhere_in_a_gaze_file() {
    let path = Path::new("tests/pupil/gaze_positions_on_surface_wall.csv");
    let starting = |start_s: f64| read_from(path, start_s).expect("an export").samples;
    let whole = starting(0.0);
    let (later, earlier) = (starting(0.005), starting(-2.0));
    assert_eq!((later.len(), earlier.len()), (1, 3));
    assert!((later[0].0 - (whole[2].0 - 0.005)).abs() < 1e-12 && later[0].1 == whole[2].1);
    assert!((earlier[0].0 - 2.0).abs() < 1e-12);
    let error = read_from(path, 60.0).expect_err("nothing is left").to_string();
    assert!(error.contains("its last sample at 0.0 s, before the start at 60.0 s"), "{error}");
}

#[test]
fn the_command_line_names_file_and_start() {
    let mut files = session_file("default");
    let path = PathBuf::from("gaze.csv");
    let overrides = SettingOverrides { gaze_file: Some(path), gaze_start_s: Some(12.5), ..SettingOverrides::default() };
    overrides.apply(&mut files).expect("settings");
    let tracker = &files.spec.tracker;
    assert_eq!((tracker.file.as_deref(), tracker.file_start_s), (Some("gaze.csv"), 12.5));
    assert_eq!(files.spec.participant.gaze, GazeSource::File);
    let beyond = SettingOverrides { gaze_start_s: Some(1e6), ..SettingOverrides::default() };
    assert!(beyond.apply(&mut files).is_err(), "no trial is longer than a day");
}

/// Reads a table with this text.
fn read_table(text: &str) -> Result<gaze_file::GazeFile, String> {
    let path = folder("table").join("table.csv");
    std::fs::write(&path, text).expect("written");
    read_from(&path, 0.0).map_err(|error| error.to_string())
}

/// A folder of this test.
fn folder(name: &str) -> PathBuf {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join(format!("gaze-files-{name}"));
    std::fs::create_dir_all(&folder).expect("a folder");
    folder
}

#[test]
fn tables_of_marker_mapper_and_neon_player_are_replayed() {
    let surface =
        "gaze detected on surface,gaze position on surface x [normalized],gaze position on surface y [normalized]";
    // With the mark that some programs put before a text, and the line ends of another system.
    let cloud = format!(
        "\u{feff}section id,recording id,timestamp [ns],{surface},fixation id,blink id\r\n\
         s1,r1,1764057600000000001,True,0.25,0.0,1,\r\n\
         s1,r1,1764057600005000001,False,1.25,0.5,,\r\n\
         s1,r1,1764057600010000001,False,,,,\r\n\
         s1,r1,1764057600015000001,True,0.5,0.5,,3\r\n\
         s1,r1,soon,True,0.5,0.5,,\r\n"
    );
    let found = read_table(&cloud).expect("a table");
    assert_eq!(
        (found.samples.len(), found.summary.malformed),
        (3, 1),
        "where the surface is not found there is no sample"
    );
    let (at_s, sample) = found.samples[0];
    assert_eq!((at_s, sample.confidence, sample.device_ns), (0.0, 1.0, Some(1_764_057_600_000_000_001)));
    // The origin is the top left corner of the surface.
    assert!((sample.x - 0.3).abs() < 1e-9 && (sample.y - 0.1).abs() < 1e-9, "{sample:?}");
    assert!((found.samples[1].0 - 0.005).abs() < 1e-12);
    assert_eq!(found.samples[2].1.confidence, 0.0, "a blink");
    let player = format!("timestamp [ns],{surface}\n1764057600000000001,True,0.25,0.0\n");
    assert_eq!(read_table(&player).expect("a table").samples, found.samples[..1]);

    for head in
        ["section id,recording id,timestamp [ns],gaze x [px],gaze y [px],worn", "gaze_timestamp,norm_pos_x,norm_pos_y"]
    {
        let error = read_table(&format!("{head}\n")).expect_err("not on the display");
        assert!(error.contains("gaze in the scene camera's picture"), "{error}");
    }
}

/// Writes files below a folder of this test, with this first line.
fn files(name: &str, files: &[(&str, &str)]) -> PathBuf {
    let folder = folder(name);
    for (file, head) in files {
        let path = folder.join(file);
        std::fs::create_dir_all(path.parent().expect("a folder")).expect("a folder");
        std::fs::write(path, format!("{head}\n")).expect("written");
    }
    folder
}

#[test]
fn recordings_and_downloads_of_the_trackers_are_told_from_gaze_on_the_display() {
    let mapped =
        "recording id,timestamp [ns],gaze position on surface x [normalized],gaze position on surface y [normalized]";
    let scene = "section id,recording id,timestamp [ns],gaze x [px],gaze y [px],worn";
    // Files that the programs write, as PyNeon's and Pupil Labs' pages list them.
    let native = files(
        "native",
        &[
            ("gaze ps1.raw", ""),
            ("gaze ps1.time", ""),
            ("gaze_200hz.raw", ""),
            ("info.json", "{}"),
            ("wearer.json", "{}"),
        ],
    );
    let download = files("download", &[("one-56fcec49/gaze ps1.raw", ""), ("one-56fcec49/info.json", "{}")]);
    let series = [("gaze.csv", scene), ("world_timestamps.csv", ""), ("scene_camera.json", "{}"), ("info.json", "{}")];
    let series = files("series", &series);
    let core = files("core", &[("gaze.pldata", ""), ("info.player.json", "{}"), ("world.mp4", "")]);
    let export = files("export", &[("gaze_positions.csv", ""), ("surfaces/gaze_positions_on_surface_wall.csv", "")]);
    let mapper = files("mapper", &[("gaze.csv", mapped), ("surface_positions.csv", ""), ("sections.csv", "")]);
    let archive = files("archive", &[("Timeseries Data.zip", "PK")]).join("Timeseries Data.zip");
    let table = format!("the table itself: {}", mapper.join("gaze.csv").display());
    let exported =
        format!("the table itself: {}", export.join("surfaces/gaze_positions_on_surface_wall.csv").display());
    let [neon, player, cloud] = [
        "open the recording in Neon Player with the plugin Surface Tracking and export",
        "open the recording in Pupil Player with the plugin Surface Tracker and export",
        "Pupil Cloud's Marker Mapper: gaze.csv of its download",
    ];
    for (path, found, remedy) in [
        (native.clone(), "gaze ps1.raw: a recording of Neon or Invisible", neon),
        (native.join("gaze ps1.raw"), "gaze ps1.raw: a recording of Neon or Invisible", neon),
        (native.join("info.json"), "gaze ps1.raw: a recording of Neon or Invisible", neon),
        (download, "gaze ps1.raw: a recording of Neon or Invisible", neon),
        (series.clone(), "gaze.csv: time series of Pupil Cloud", cloud),
        (core.join("world.mp4"), "gaze.pldata: a recording of Pupil Capture", player),
        (core, "gaze.pldata: a recording of Pupil Capture", player),
        (export, "a folder with a table of gaze on the display", &exported),
        (mapper.clone(), "a folder with a table of gaze on the display", &table),
        (archive, "an archive", "unpack the archive"),
    ] {
        let error = read_from(&path, 0.0).expect_err("no gaze on the display");
        let told = error.remedy();
        assert!(error.to_string().contains(found) && told.contains(remedy), "{error}; {told}");
    }
    // The table is taken, and gaze in the picture is not.
    let error = read_from(&mapper.join("gaze.csv"), 0.0).expect_err("no gaze").to_string();
    assert!(error.contains("a table without a line below its header"), "{error}");
    let error = read_from(&series.join("gaze.csv"), 0.0).expect_err("not on the display").to_string();
    assert!(error.contains("gaze in the scene camera's picture"), "{error}");
}

const PLAYER: &str = "world_timestamp,world_index,gaze_timestamp,x_norm,y_norm,x_scaled,y_scaled,on_surf,confidence";
const NEON: &str = "section id,recording id,timestamp [ns],gaze detected on surface,\
                    gaze position on surface x [normalized],gaze position on surface y [normalized],fixation id,blink id";

/// Reads a file with these bytes, whose surface is the whole display.
fn read_bytes(name: &str, bytes: &[u8], missing_confidence: MissingConfidence) -> Result<GazeFile, String> {
    let path = folder("tables").join(format!("{name}.csv"));
    std::fs::write(&path, bytes).expect("written");
    read_path(&path, missing_confidence)
}

fn read_path(path: &Path, missing_confidence: MissingConfidence) -> Result<GazeFile, String> {
    let map = SurfaceHomography::new([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]]).expect("a surface");
    let settings = TrackerSpec { missing_confidence, ..TrackerSpec::default() };
    gaze_file::read(path, &map, &settings).map_err(|error| error.to_string())
}

fn read(name: &str, text: &str) -> Result<GazeFile, String> {
    read_bytes(name, text.as_bytes(), MissingConfidence::Bad)
}

fn refused(name: &str, text: &str) -> String {
    read(name, text).expect_err(name)
}

/// A table of Pupil Player with samples at these times, in the middle of the display.
fn player(times: &[String]) -> String {
    let row = |time: &String| format!("{time},1,{time},0.5,0.25,0.5,0.25,True,0.97\n");
    format!("{PLAYER}\n{}", times.iter().map(row).collect::<String>())
}

/// A table whose lines, counted from 0, are changed so.
fn rewritten(table: &str, change: impl Fn(usize, &str) -> String) -> String {
    table.lines().enumerate().map(|(nth, line)| change(nth, line) + "\n").collect()
}

/// Times from this one on, this far apart.
fn every(from: f64, apart: f64, count: usize) -> Vec<String> {
    (0..count).map(|nth| format!("{:.6}", from + apart * nth as f64)).collect()
}

/// A table of Neon Player with these times in its column `timestamp [ns]`.
fn neon(times: &[String]) -> String {
    let row = |time: &String| format!("s1,r1,{time},TRUE,0.5,0.75,,\n");
    format!("{NEON}\n{}", times.iter().map(row).collect::<String>())
}

/// Seconds of all samples since the first one.
fn seconds(found: &GazeFile) -> Vec<f64> {
    found.samples.iter().map(|(at_s, _)| (at_s * 1e6).round() / 1e6).collect()
}

#[test]
fn any_finite_time_is_a_time() {
    let found = read("negative", &player(&every(-3.0, 0.1, 61))).expect("a table");
    assert_eq!((found.samples.len(), found.summary.malformed), (61, 0));
    assert_eq!((found.samples[0].0, found.samples[60].0), (0.0, 6.0));
    let device_ns = |index: usize| found.samples[index].1.device_ns;
    assert_eq!((device_ns(0), device_ns(30), device_ns(60)), (Some(-3_000_000_000), Some(0), Some(3_000_000_000)));
    assert!(found.summary.remarks.is_empty(), "{:?}", found.summary.remarks);
    let neon = read("negative-neon", &neon(&[-5_000_000i64, 0, 5_000_000].map(|ns| ns.to_string()))).expect("a table");
    assert_eq!(seconds(&neon), [0.0, 0.005, 0.01]);
    let beyond = player(&[&every(0.0, 0.005, 20)[..], &["1e300".to_string()], &["1e12".to_string()]].concat());
    let found = read("beyond", &beyond).expect("a table");
    assert_eq!((found.samples.len(), found.summary.malformed), (20, 2), "{:?}", found.summary);
    assert!(refused("all-beyond", &player(&["1e12".to_string()])).contains("gaze_timestamp beyond 292 years"));
}

#[test]
fn a_clock_that_was_set_is_joined_and_named_with_its_line() {
    let times = [every(74_703.8, 0.005, 40), every(34.0, 0.005, 40)].concat();
    let found = read("set-back", &player(&times)).expect("a table");
    let wanted: Vec<f64> = (0..80).map(|nth| f64::from(nth) / 200.0).collect();
    assert_eq!(seconds(&found), wanted);
    let remark = "line 42: the clock was set from 74703.995 s to 34 s; joined in the order of lines";
    assert_eq!(found.summary.remarks, [remark]);
    let checks = recorded_gaze("gaze.csv", &found.summary);
    assert_eq!(checks[0], PreflightCheck::ok("gaze", "gaze.csv: 80 samples in 0.4 s; no gap of more than 1 s"));
    assert_eq!((checks.len(), checks[1].verdict, checks[1].found.as_str()), (2, PreflightVerdict::Warning, remark));

    let often: Vec<String> = (0..12).flat_map(|nth| every(f64::from(100 - nth), 0.005, 10)).collect();
    let error = refused("set-often", &player(&often));
    assert!(error.contains("set-often.csv:12: found 11 steps of gaze_timestamp"), "{error}");
    let mut back = every(10.0, 0.005, 40);
    back.reverse();
    let error = refused("backwards", &player(&back));
    assert!(error.contains("backwards.csv:3: found gaze_timestamp before that of the line before"), "{error}");
}

#[test]
fn a_time_that_fits_no_other_is_left_out_and_named() {
    let mut times = every(1_725_030_000.0, 0.005, 60);
    times[0] = "0".to_string();
    times[30] = "0".to_string();
    let found = read("first-0", &player(&times)).expect("a table");
    assert_eq!((found.samples.len(), found.summary.malformed), (58, 2));
    assert!((found.samples[57].0 - 0.29).abs() < 1e-6, "{}", found.samples[57].0);
    let remark = "2 lines left out, with a time that fits no other (line 2: 0 s)";
    assert_eq!(found.summary.remarks, [remark]);
}

#[test]
fn gaps_are_told() {
    let times = [every(0.0, 0.005, 20), every(3.0, 0.005, 20), every(7.5, 0.005, 20)].concat();
    let found = read("gaps", &player(&times)).expect("a table").summary;
    assert_eq!((found.gaps, (found.longest_gap_s * 1e3).round()), (2, 4405.0));
    assert_eq!(found.words(), "60 samples in 7.6 s; 2 gaps of more than 1 s, the longest of 4.4 s");
}

#[test]
fn times_that_a_spreadsheet_rounded_are_refused_with_the_cause() {
    let rounded: Vec<String> = (0..60).map(|_| "1.72503E+18".to_string()).collect();
    let error = refused("rounded", &format!("\u{feff}{}", neon(&rounded)));
    assert!(error.contains("rounded.csv:3: found timestamp [ns] as in the line before"), "{error}");
    assert!(error.contains("the times were rounded"), "{error}");
    // What pandas and R write of numbers with enough digits is no loss.
    let exact: Vec<String> = (0..60).map(|nth| format!("1.72503{:08}e+18", 50 * nth)).collect();
    let found = read("exponents", &neon(&exact)).expect("a table");
    assert_eq!(seconds(&found)[59], 0.295);
}

#[test]
fn tables_are_read_as_spreadsheets_pandas_and_r_write_them() {
    let plain = player(&every(3_811.123_456, 0.005, 20));
    let wanted = read("plain", &plain).expect("a table").samples;
    let each_row = |change: &dyn Fn(&str) -> String| {
        rewritten(&plain, |nth, line| if nth == 0 { line.to_string() } else { change(line) })
    };
    let semicolons = plain.replace(',', ";").replace('.', ",");
    let quoted = |line: &str| line.split(',').map(|cell| format!("\"{cell}\"")).collect::<Vec<_>>().join(",");
    let all_quoted: String = plain.lines().map(|line| quoted(line) + "\r\n").collect();
    let of_r = rewritten(&plain, |nth, line| match nth {
        0 => format!("\"\",{}", quoted(line)),
        _ => format!("\"{nth}\",{}", line.replace("True", "TRUE")),
    });
    let decimal_commas = each_row(&|line: &str| quoted(line).replace('.', ","));
    for (name, text) in [
        ("semicolons", semicolons.clone()),
        ("semicolons-and-mark", format!("\u{feff}{semicolons}")),
        ("semicolons-and-points", plain.replace(',', ";")),
        ("row-names", each_row(&|line: &str| format!("\"1\",{line}"))),
        ("tabs", plain.replace(',', "\t")),
        ("quoted", all_quoted),
        ("r", of_r),
        ("decimal-commas", decimal_commas),
        ("spaces", plain.replace(',', ", ")),
        ("empty-lines", plain.replace('\n', "\n\n")),
        ("empty-cells", plain.replace('\n', ",,\n")),
    ] {
        let found = read(name, &text).unwrap_or_else(|error| panic!("{name}: {error}"));
        assert!(found.samples == wanted && found.summary.malformed == 0, "{name}: {:?}", found.summary);
    }
    let utf_16 = |text: &str| text.encode_utf16().collect::<Vec<u16>>();
    let tabs = plain.replace(',', "\t");
    for (name, mark) in [("utf-16", ""), ("utf-16-and-mark", "\u{feff}")] {
        let text = format!("{mark}{tabs}");
        let little: Vec<u8> = utf_16(&text).into_iter().flat_map(u16::to_le_bytes).collect();
        let big: Vec<u8> = utf_16(&text).into_iter().flat_map(u16::to_be_bytes).collect();
        for bytes in [little, big] {
            let found =
                read_bytes(name, &bytes, MissingConfidence::Bad).unwrap_or_else(|error| panic!("{name}: {error}"));
            assert_eq!(found.samples, wanted, "{name}");
        }
    }
    // R's read.csv replaces what is no letter in names.
    let times: Vec<String> = (0..20).map(|nth| (1_764_057_600_000_000_001i64 + 5_000_000 * nth).to_string()).collect();
    let table = neon(&times);
    let names = NEON.replace([' ', '[', ']'], ".");
    let wanted = read("neon", &table).expect("a table").samples;
    let found = read("neon-r", &table.replace(NEON, &names).replace(",,\n", ",NA,NA\n")).expect("a table");
    assert_eq!(found.samples, wanted);
    assert!(found.samples.iter().all(|(_, sample)| sample.confidence == 1.0), "NA is no blink");
}

#[test]
fn what_cannot_be_read_is_named_with_its_line_and_cause() {
    let plain = player(&every(3_811.123_456, 0.005, 20));
    let commas = rewritten(&plain, |nth, line| if nth == 0 { line.to_string() } else { line.replace('.', ",") });
    for (name, text, found) in [
        ("commas", commas, "commas.csv:2: found no line with gaze: 16 cells instead of 9: decimal commas?"),
        ("words", player(&["soon".to_string()]), "words.csv:2: found no line with gaze: gaze_timestamp = \"soon\""),
        ("head", format!("{PLAYER}\n"), "found a table without a line below its header"),
        ("empty", String::new(), "empty.csv:1: found no column gaze_timestamp"),
        ("thousands", player(&["\"3.811,123456\"".to_string()]), "gaze_timestamp = \"3.811,123456\""),
        ("unseen", format!("{NEON}\ns1,r1,17,FALSE,,,,\n"), "found 1 line, none of them with gaze on the surface"),
        (
            "unseen-r",
            format!("{NEON}\ns1,r1,17,FALSE,NA,NA,NA,NA\n"),
            "found 1 line, none of them with gaze on the surface",
        ),
        ("long", format!("{plain}{}\n", "9".repeat(100_000)), "line 22 has more than 65536 bytes"),
        ("unit", format!("{}\n", NEON.replace("[ns]", "[h]")), "no column timestamp [ns]"),
    ] {
        let error = refused(name, &text);
        assert!(error.contains(found), "{name}: {error}");
    }
    let some = plain.replacen("3811.133456,0.5", "3811.133456,half", 1).replacen("True,0.97\n", "True,2.5\n", 1);
    let found = read("some", &some).expect("a table").summary;
    let first = "line 2: confidence = \"2.5\", not 0 to 1";
    assert_eq!((found.samples, found.malformed, found.first_malformed.as_deref()), (18, 2, Some(first)));
    // One quotation mark costs its line, not all that follow.
    let quote = plain.replacen("3811.133456,1", "\"3811.133456,1", 1);
    assert_eq!(read("quote", &quote).expect("a table").summary.malformed, 1);
    let rows = |count: usize| {
        (0..count).fold(String::new(), |mut rows, nth| {
            let _ = writeln!(rows, "s1,r{nth},17,TRUE,0.5,0.5,,");
            rows
        })
    };
    let error = refused("several", &format!("{NEON}\n{}", rows(2)));
    assert!(error.contains("several.csv:3: found gaze of several recordings (r1)"), "{error}");
}

#[test]
fn a_sample_without_confidence_is_one_of_the_kind_that_the_settings_say() {
    let plain = player(&every(0.0, 0.005, 20));
    for missing in ["", "nan", "NaN", "NA"] {
        let text = plain.replacen(",0.97\n", &format!(",{missing}\n"), 5);
        for (setting, confidence) in [(MissingConfidence::Good, 1.0), (MissingConfidence::Bad, 0.0)] {
            let found = read_bytes("missing", text.as_bytes(), setting).expect("a table");
            let summary = &found.summary;
            assert_eq!((summary.samples, summary.malformed, summary.without_confidence), (20, 0, 5), "{missing}");
            assert!(found.samples[..5].iter().all(|(_, sample)| sample.confidence == confidence));
            assert_eq!(summary.usable, if confidence > 0.0 { 20 } else { 15 });
            assert_eq!(recorded_gaze("", summary)[0].verdict, PreflightVerdict::Ok);
        }
    }
    let none = rewritten(&plain, |_, line| line.rsplit_once(',').expect("columns").0.to_string());
    let error = refused("no-confidence", &none);
    assert!(error.contains("no-confidence.csv:1: found no column confidence"), "{error}");
    let found = read_bytes("no-confidence", none.as_bytes(), MissingConfidence::Good).expect("a table").summary;
    assert_eq!((found.usable, found.without_confidence), (20, 20));
    let all = read("all-missing", &plain.replace(",0.97\n", ",nan\n")).expect("a table").summary;
    assert_eq!(recorded_gaze("", &all)[0].verdict, PreflightVerdict::Failed, "no sample is read");
}

#[test]
fn times_in_other_units_are_recognised_or_refused() {
    let wanted: Vec<f64> = (0..40).map(|nth| f64::from(nth) / 125.0).collect();
    for (unit, apart, words) in [("ms", 8.0, "milliseconds"), ("us", 8e3, "microseconds"), ("ns", 8e6, "nanoseconds")] {
        let found = read(unit, &player(&every(17.0, apart, 40))).expect("a table");
        assert_eq!(seconds(&found), wanted, "{unit}");
        let remark = format!("gaze_timestamp read as {words}, since it rises by {apart} from line to line");
        assert_eq!(found.summary.remarks, [remark]);
        let named = player(&every(17.0, apart, 40)).replacen("gaze_timestamp", &format!("gaze_timestamp [{unit}]"), 1);
        let found = read("named", &named).expect("a table");
        assert!(seconds(&found) == wanted && found.summary.remarks.is_empty(), "{unit}: {:?}", found.summary);
    }
    let error = refused("frames", &player(&every(0.0, 1.0, 40)));
    assert!(error.contains("frames.csv:3: found gaze_timestamp that rises by 1 from line to line"), "{error}");
    let ms: Vec<String> = (0..40).map(|nth| (5 * nth).to_string()).collect();
    let error = refused("no-ns", &neon(&ms));
    assert!(error.contains("rises by 5 from line to line: no nanoseconds of gaze"), "{error}");
}

#[cfg(unix)]
#[test]
fn a_pipe_and_a_device_are_no_gaze_files() {
    let pipe = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join("gaze-pipe.csv");
    let _ = std::fs::remove_file(&pipe);
    let made = std::process::Command::new("mkfifo").arg(&pipe).status().expect("mkfifo runs");
    assert!(made.success(), "no pipe is made at {}", pipe.display());
    for path in [pipe, PathBuf::from("/dev/zero")] {
        let error = read_path(&path, MissingConfidence::Bad).expect_err("no regular file");
        assert!(error.contains("it is no regular file"), "{error}");
    }
}
