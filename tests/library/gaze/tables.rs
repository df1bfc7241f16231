//! Tables of gaze as trackers' programs write them, and as they are after spreadsheets, pandas and R: read, or refused with
//! the line and the cause.

use std::fmt::Write;
use std::path::{Path, PathBuf};

use tomcom_core::gaze::tags::SurfaceHomography;
use tomcom_devices::gaze_file::{self, GazeFile};
use tomcom_session::preflight_checks::{PreflightCheck, PreflightVerdict, recorded_gaze};
use tomcom_session::tracker::{MissingConfidence, TrackerSpec};

const PLAYER: &str = "world_timestamp,world_index,gaze_timestamp,x_norm,y_norm,x_scaled,y_scaled,on_surf,confidence";
const NEON: &str = "section id,recording id,timestamp [ns],gaze detected on surface,\
                    gaze position on surface x [normalized],gaze position on surface y [normalized],fixation id,blink id";

/// Reads a file with these bytes, whose surface is the whole display.
fn read_bytes(name: &str, bytes: &[u8], missing_confidence: MissingConfidence) -> Result<GazeFile, String> {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("gaze-tables");
    std::fs::create_dir_all(&folder).expect("a folder");
    let path = folder.join(format!("{name}.csv"));
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
    let each_row = |change: &dyn Fn(&str) -> String| -> String {
        plain
            .lines()
            .enumerate()
            .map(|(nth, line)| format!("{}\n", if nth == 0 { line.to_string() } else { change(line) }))
            .collect()
    };
    let semicolons = plain.replace(',', ";").replace('.', ",");
    let quoted = |line: &str| line.split(',').map(|cell| format!("\"{cell}\"")).collect::<Vec<_>>().join(",");
    let all_quoted: String = plain.lines().map(|line| quoted(line) + "\r\n").collect();
    let of_r: String = plain
        .lines()
        .enumerate()
        .map(|(nth, line)| {
            let name = if nth == 0 { String::new() } else { nth.to_string() };
            let line = if nth == 0 { quoted(line) } else { line.replace("True", "TRUE") };
            format!("\"{name}\",{line}\n")
        })
        .collect();
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
    let commas: String = plain
        .lines()
        .enumerate()
        .map(|(nth, line)| match nth {
            0 => format!("{line}\n"),
            _ => line.replace('.', ",") + "\n",
        })
        .collect();
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
    let none: String = plain.lines().map(|line| format!("{}\n", line.rsplit_once(',').expect("columns").0)).collect();
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
