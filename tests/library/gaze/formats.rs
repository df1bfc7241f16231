//! Messages of Pupil, frames of ZeroMQ, and files of gaze: read in full, or counted as broken.

use std::path::{Path, PathBuf};

use rand::RngExt;
use rmpv::Value;
use tomcom::edge::files::read_session;
use tomcom::run::options::SettingOverrides;
use tomcom_core::base::rng::stream;
use tomcom_core::gaze::tags::SurfaceHomography;
use tomcom_devices::gaze_file;
use tomcom_devices::pupil::message::{self, CaptureNotification, PupilMessage};
use tomcom_devices::pupil::zmtp::ZmtpFrameAssembler;
use tomcom_session::files::file_error::FileError;
use tomcom_session::settings::GazeSource;
use tomcom_session::tracker::TrackerSpec;

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
    let item = |x: f64| {
        let text = Value::from;
        let place = Value::Array(vec![Value::from(x), Value::from(0.5)]);
        let time = (text("timestamp"), Value::from(7));
        Value::Map(vec![(text("norm_pos"), place), (text("confidence"), Value::from(1.0)), time])
    };
    let items = vec![item(0.1), item(f64::NAN), Value::Nil, item(f64::INFINITY), item(0.2)];
    let mut bytes = Vec::new();
    let datum = Value::Map(vec![(Value::from("gaze_on_surfaces"), Value::Array(items))]);
    rmpv::encode::write_value(&mut bytes, &datum).expect("written");
    let told = read(&bytes);
    assert_eq!((told.gaze.len(), told.malformed), (2, 3));
    assert_eq!(told.gaze[0].timestamp, 7.0);
    // Pupil time starts anywhere, and where a pupil was lost the confidence is NaN.
    let place = Value::Array(vec![Value::from(0.5), Value::from(0.5)]);
    let item = |confidence: Value| {
        let fields = [("norm_pos", place.clone()), ("confidence", confidence), ("timestamp", Value::from(-3.5))];
        Value::Map(fields.into_iter().map(|(name, value)| (Value::from(name), value)).collect())
    };
    let items = vec![item(Value::from(f64::NAN)), item(Value::from(0.9)), item(Value::Nil)];
    let told = read(&packed(&[("gaze_on_surfaces", Value::Array(items))]));
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

fn map() -> SurfaceHomography {
    SurfaceHomography::new([[0.1, 0.1], [0.9, 0.1], [0.9, 0.9], [0.1, 0.9]]).expect("a surface")
}

#[test]
fn exports_of_pupil_player_and_own_recordings_are_replayed() {
    let path = Path::new("tests/pupil/gaze_positions_on_surface_wall.csv");
    let found = gaze_file::read(path, &map(), &from(0.0)).expect("an export");
    assert_eq!((found.samples.len(), found.summary.malformed), (3, 2));
    let (at_s, sample) = found.samples[1];
    assert!((at_s - 0.004_124_045).abs() < 1e-8, "{at_s}");
    assert!((sample.x - 0.3).abs() < 1e-9 && (sample.y - 0.1).abs() < 1e-9, "{sample:?}");
    assert_eq!((sample.device_ns, sample.confidence), (Some(5_117_922_610), 0.91));
    let error = gaze_file::read(Path::new("layouts/sushi.toml"), &map(), &from(0.0)).expect_err("no export");
    assert!(error.to_string().contains("no column gaze_timestamp"), "{error}");
    let recording = std::fs::read_dir("tests/golden").expect("recordings").map(|entry| entry.expect("an entry").path());
    let recording = recording.filter(|path| path.extension().is_some_and(|extension| extension == "jsonl"));
    // A recording may have no gaze, which is said.
    let read = |path: PathBuf| gaze_file::read(&path, &map(), &from(0.0)).map_or(0, |found| found.samples.len());
    let counts: Vec<usize> = recording.map(read).collect();
    assert!(counts.iter().any(|count| *count > 1000), "{counts:?}");
}

#[test]
fn a_trial_starts_anywhere_in_a_gaze_file() {
    let path = Path::new("tests/pupil/gaze_positions_on_surface_wall.csv");
    let starting = |start_s: f64| gaze_file::read(path, &map(), &from(start_s)).expect("an export").samples;
    let whole = starting(0.0);
    let (later, earlier) = (starting(0.005), starting(-2.0));
    assert_eq!((later.len(), earlier.len()), (1, 3));
    assert!((later[0].0 - (whole[2].0 - 0.005)).abs() < 1e-12 && later[0].1 == whole[2].1);
    assert!((earlier[0].0 - 2.0).abs() < 1e-12);
    let error = gaze_file::read(path, &map(), &from(60.0)).expect_err("nothing is left").to_string();
    assert!(error.contains("its last sample at 0.0 s, before the start at 60.0 s"), "{error}");
}

#[test]
fn the_command_line_names_file_and_start() {
    let mut files = read_session(Path::new("sessions/default.toml")).expect("the default session");
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
    gaze_file::read(&path, &map(), &from(0.0)).map_err(|error| error.to_string())
}

/// Settings of a tracker whose file is read from this time on.
fn from(file_start_s: f64) -> TrackerSpec {
    TrackerSpec { file_start_s, ..TrackerSpec::default() }
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

    let several = cloud.replacen("s1,r1,1764057600005", "s1,r2,1764057600005", 1);
    let error = read_table(&several).expect_err("two participants");
    assert!(error.contains("gaze of several recordings (r2)"), "{error}");
    for head in
        ["section id,recording id,timestamp [ns],gaze x [px],gaze y [px],worn", "gaze_timestamp,norm_pos_x,norm_pos_y"]
    {
        let error = read_table(&format!("{head}\n")).expect_err("not on the display");
        assert!(error.contains("gaze in the scene camera's picture"), "{error}");
    }
    let error = read_table(&format!("timestamp,{surface}\n")).expect_err("no time");
    assert!(error.contains("no column timestamp [ns]"), "{error}");
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
        let error = gaze_file::read(&path, &map(), &from(0.0)).expect_err("no gaze on the display");
        let FileError::Unfit { remedy: told, .. } = &error else { panic!("{error}") };
        assert!(error.to_string().contains(found) && told.contains(remedy), "{error}; {told}");
    }
    // The table is taken, and gaze in the picture is not.
    let error = gaze_file::read(&mapper.join("gaze.csv"), &map(), &from(0.0)).expect_err("no gaze").to_string();
    assert!(error.contains("a table without a line below its header"), "{error}");
    let error =
        gaze_file::read(&series.join("gaze.csv"), &map(), &from(0.0)).expect_err("not on the display").to_string();
    assert!(error.contains("gaze in the scene camera's picture"), "{error}");
}
