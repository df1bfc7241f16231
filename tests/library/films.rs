//! Films beside recordings: the alignment by the page's flashes, on curves of brightness, and by a tracker's clock; the file
//! `video.json`; cameras in settings.

use tomcom_core::base::text::PathText;
use tomcom_session::film::{ffmpeg_input, film_name, is_recorded_film};
use tomcom_session::log::RecordingError;
use tomcom_session::log::video_file::{self, AttachedFilm, FilmAlignmentSource, RecordingFilms};
use tomcom_study::analysis::film_clock::{self, ClockPair, ClockRefusal};
use tomcom_study::analysis::film_flashes::{AlignmentRefusal, FLASH_S, FilmAlignment, FlashSearch, align};
use tomcom_study::annotation_export::{self, AnnotationFormat};
use tomcom_study::codes::{self, CodedRecording};
use tomcom_study::files::pupil_timestamps;

use crate::support::*;

/// Times at which a page drew its flashes, in seconds of session time.
const DRAWN_S: [f64; 6] = [21.3, 74.55, 130.02, 171.9, 290.4, 321.35];

/// A camera before the page: how its film's time follows from session time, and what it sees.
struct Camera {
    offset_s: f64,
    drift: f64,
    rate_hz: f64,
    length_s: f64,
    dark: u8,
    bright: u8,
    /// Flashes that are hidden, by their number.
    hidden: &'static [usize],
    /// Every how many frames one is left out.
    lost: usize,
}

const CAMERA: Camera = Camera {
    offset_s: -12.0,
    drift: 0.0,
    rate_hz: 30.0,
    length_s: 340.0,
    dark: 25,
    bright: 190,
    hidden: &[],
    lost: usize::MAX,
};

impl Camera {
    /// Four pixels: the page's square, one with half of the square, a lamp, somebody who walks by.
    fn film(&self, drawn_s: &[f64]) -> FlashSearch {
        let mut search = FlashSearch::default();
        for number in 0..(self.length_s * self.rate_hz) as usize {
            if number % self.lost == self.lost - 1 {
                continue;
            }
            let film_s = number as f64 / self.rate_hz;
            let session_s = (film_s - self.offset_s) / (1.0 + self.drift);
            let is_lit = |(index, drawn): (usize, &f64)| {
                (*drawn..*drawn + FLASH_S).contains(&session_s) && !self.hidden.contains(&index)
            };
            let is_lit = drawn_s.iter().enumerate().any(is_lit);
            let noise = (number * 7919 % 5) as u8;
            let square = if is_lit { self.bright } else { self.dark } + noise;
            let half = if is_lit { self.dark / 2 + self.bright / 2 } else { self.dark } + noise;
            let lamp = if number / 11 % 2 == 0 { 80 } else { 160 };
            let walk = (128.0 + 90.0 * (film_s * 1.7).sin() + 30.0 * (film_s * 13.0).sin()) as u8;
            search.take(film_s, &[square, half, lamp, walk]);
        }
        search
    }

    fn aligned(&self) -> FilmAlignment {
        align(&self.film(&DRAWN_S), &DRAWN_S).unwrap_or_else(|refusal| panic!("{refusal:?}"))
    }

    /// Largest distance of a flash's place in the film from the true one, in seconds.
    fn error_s(&self) -> f64 {
        let found = self.aligned();
        let off = DRAWN_S.map(|drawn| {
            let (told, is) = (found.offset_s + drawn * (1.0 + found.drift), self.offset_s + drawn * (1.0 + self.drift));
            (told - is).abs()
        });
        off.into_iter().fold(0.0, f64::max)
    }
}

#[test]
fn a_film_is_aligned_to_one_frame_by_the_flashes_in_it() {
    let cameras = [
        ("30 frames a second", Camera { ..CAMERA }),
        ("29.97", Camera { rate_hz: 30_000.0 / 1001.0, ..CAMERA }),
        ("15", Camera { rate_hz: 15.0, ..CAMERA }),
        ("60", Camera { rate_hz: 60.0, ..CAMERA }),
        ("a drift of 100 ppm", Camera { drift: 100e-6, ..CAMERA }),
        ("a drift back", Camera { drift: -300e-6, ..CAMERA }),
        ("a dark corner", Camera { dark: 8, bright: 22, ..CAMERA }),
        ("a hand before two flashes", Camera { hidden: &[1, 4], ..CAMERA }),
        ("lost frames", Camera { lost: 7, ..CAMERA }),
        ("a film that begins in the trial", Camera { offset_s: -90.0, ..CAMERA }),
        ("a film that ends in the trial", Camera { length_s: 200.0, ..CAMERA }),
        ("a film that ends after the second flash", Camera { length_s: 70.0, ..CAMERA }),
    ];
    for (name, camera) in cameras {
        let error_s = camera.error_s();
        assert!(error_s <= 1.0 / camera.rate_hz, "{name}: {error_s} s off");
    }
    let two = Camera { length_s: 70.0, ..CAMERA }.aligned();
    assert_eq!(two.flashes, 2);
    let drifting = Camera { drift: 100e-6, ..CAMERA }.aligned();
    assert!((drifting.drift - 100e-6).abs() < 60e-6, "{drifting:?}");
    assert_eq!(Camera { hidden: &[1, 4], ..CAMERA }.aligned().flashes, 4);
}

#[test]
fn a_film_that_does_not_fit_is_refused_with_what_is_in_it() {
    let refusal = |search: &FlashSearch| align(search, &DRAWN_S).expect_err("a film that does not fit");
    let dark = Camera { hidden: &[0, 1, 2, 3, 4, 5], ..CAMERA };
    let mut nothing = FlashSearch::default();
    (0..900).for_each(|frame| nothing.take(f64::from(frame) / 30.0, &[20, 30, (frame % 7) as u8]));
    assert_eq!(refusal(&nothing), AlignmentRefusal::NoFlash);
    assert_eq!(refusal(&FlashSearch::default()), AlignmentRefusal::NoFlash);
    // What else changes in the picture is no flash of the page.
    assert!(!matches!(refusal(&dark.film(&DRAWN_S)), AlignmentRefusal::Residual { .. }));
    let other_s = [21.3, 40.0, 99.7, 200.1, 210.8, 321.35];
    let AlignmentRefusal::FewFit { seen_s, fit } = refusal(&CAMERA.film(&other_s)) else {
        panic!("another trial, which lasts as long");
    };
    assert_eq!((seen_s.len(), fit), (6, 2), "its start and its end are as far apart: {seen_s:?}");
    // Two of six flashes fit by chance, where the film has others.
    let by_chance = [30.0, 83.25, 100.0, 140.0];
    assert!(matches!(refusal(&CAMERA.film(&by_chance)), AlignmentRefusal::FewFit { fit: 2, .. }));
    let cut = Camera { length_s: 20.0, ..CAMERA };
    let AlignmentRefusal::FewFit { seen_s, fit } = refusal(&cut.film(&DRAWN_S)) else { panic!("a cut film") };
    assert_eq!((seen_s.len(), fit), (1, 1), "{seen_s:?}");
    assert!(matches!(align(&CAMERA.film(&DRAWN_S), &[]), Err(AlignmentRefusal::FewFit { fit: 0, .. })));
}

fn film(file: &str, offset_s: f64) -> AttachedFilm {
    AttachedFilm {
        file: PathText(file.into()),
        sha256: "00".repeat(32),
        by: FilmAlignmentSource::Flashes,
        offset_s,
        drift_ppm: 100.0,
        residual_ms: Some(9.5),
        flashes: Some(5),
        frame_ms: Some(33.33),
        length_s: Some(340.0),
        copies_of: Vec::new(),
    }
}

#[test]
fn films_of_a_recording_are_kept_by_file_and_read_back() {
    let folder = tempfile::tempdir().expect("a folder");
    assert_eq!(video_file::read(folder.path()).expect("no file"), RecordingFilms::default());
    let mut films = RecordingFilms::default();
    films.attach(film("/films/room.mp4", 1.0));
    films.attach(film("hands.mp4", 2.0));
    films.attach(film("/films/room.mp4", 3.5));
    assert_eq!(films.films.iter().map(|film| film.offset_s).collect::<Vec<_>>(), [3.5, 2.0], "a film is there once");
    video_file::write(folder.path(), &films).expect("written");
    assert_eq!(video_file::read(folder.path()).expect("read"), films);
    let outside = |time_s| film("a.mp4", -3.0).outside(SessionTime::from_secs_f64(time_s));
    assert_eq!([1.0, 4.0, 350.0].map(outside), [Some("before the film"), None, Some("after the film")]);
    assert!((film("a.mp4", 3.0).film_s(SessionTime::from_secs_f64(1000.0)) - 1003.1).abs() < 1e-9);
    assert_eq!(films.films[0].path(folder.path()), Path::new("/films/room.mp4"));
    let mut copy = film("hands-h264.mp4", 2.0);
    copy.copies_of.push(PathText("/films/hands.webm".into()));
    assert_eq!(copy.files().map(|file| video_file::is_name(file)).collect::<Vec<_>>(), [true, false]);
    let path = folder.path().join(video_file::VIDEO_NAME);
    for (text, said) in [
        ("{\"films\": [{}]}", "video.json:1: found missing field"),
        ("{\"films\": [\n", "video.json:2: found EOF"),
        (
            &serde_json::to_string(&RecordingFilms { films: vec![film("../x/room.mp4", 1.0)] }).expect("JSON"),
            "../x/room.mp4",
        ),
        (
            &serde_json::to_string(&RecordingFilms {
                films: vec![AttachedFilm { copies_of: vec![PathText("../x/hands.webm".into())], ..film("a.mp4", 1.0) }],
            })
            .expect("JSON"),
            "a.mp4",
        ),
    ] {
        std::fs::write(&path, text).expect("written");
        let error = video_file::read(folder.path()).expect_err(text).to_string();
        assert!(error.contains(said), "{error}");
    }
}

/// A simulated trial with a film, which begins 3 s after the session, and a rater's codes of its first errors.
fn filmed(name: &str) -> (PathBuf, CodedRecording) {
    let out = empty_folder(Path::new("films").join(name));
    let mut files = session_file("default");
    files.spec.trial.presses = 120;
    files.spec.robot.arm = ArmKind::Timed;
    files.spec.participant.kind = ParticipantKind::Simulated;
    let recording = simulate_into(files, 1, &out).remove(0);
    let films = vec![AttachedFilm { drift_ppm: 50.0, ..film("room 1.mp4", -3.0) }];
    video_file::write(&recording, &RecordingFilms { films }).expect("written");
    let coded = CodedRecording::open(&recording).expect("a recording");
    assert!(coded.errors.len() >= 3, "{} errors", coded.errors.len());
    (recording, coded)
}

#[test]
fn codes_of_raters_come_back_from_elan_and_boris() {
    const FORMATS: [AnnotationFormat; 3] = [AnnotationFormat::Elan, AnnotationFormat::Boris, AnnotationFormat::Vtt];
    let (recording, coded) = filmed("codes");
    let place = coded.codable.places[0].clone();
    let causes = [("slip", ""), ("belief", place.as_str()), ("race", "")];
    let name = coded.name();
    let row = |(error, (cause, aspect)): (&u64, (&str, &str))| format!("{name},R1,{error},{cause},{aspect}\n");
    let table: String = coded.codable.errors.iter().zip(causes).map(row).collect();
    let csv = recording.join("given.csv");
    fs::write(&csv, format!("recording,rater,press,cause,aspect\n{table}")).expect("written");
    let import = |file: &Path| {
        let mut all = vec![CodedRecording::open(&recording).expect("a recording")];
        codes::read(&all, file).and_then(|read| {
            read.import(&mut all).map_err(|error| match error {
                RecordingError::File(error) => error,
                error => panic!("{error}"),
            })
        })
    };
    assert_eq!(import(&csv).expect("imported"), 3);
    fs::remove_file(csv).expect("removed");
    let exported = annotation_export::export(&recording, &FORMATS, false).expect("exported");
    assert!(exported.iter().all(|one| one.films == 1 && one.annotations > 60), "{exported:?}");
    let given = CodedRecording::open(&recording).expect("a recording").codes["R1"].clone();
    let elan = fs::read_to_string(recording.join("recording.eaf")).expect("a file");
    assert!(elan.contains("room%201.mp4\""), "the film is linked");
    // What another rater adds is on a tier, or of a subject, of their own.
    for (file, from, to) in
        [("recording.eaf", "TIER_ID=\"codes R1\"", "TIER_ID=\"codes R2\""), ("recording.boris", "\"R1\"", "\"R3\"")]
    {
        let path = recording.join(file);
        let text = fs::read_to_string(&path).expect("a file");
        assert!(text.contains(from), "{file}");
        fs::write(&path, text.replace(from, to)).expect("written");
        assert_eq!(import(&path).expect(file), 3);
        let rater = to.split(['"', ' ']).rfind(|word| word.starts_with('R')).expect("a rater");
        assert_eq!(CodedRecording::open(&recording).expect("a recording").codes[rater], given, "{file}");
    }
    // A file that was saved elsewhere is kept.
    let touched = elan.replace("<!-- written by tomcom export -->", "");
    assert_ne!(touched, elan);
    fs::write(recording.join("recording.eaf"), &touched).expect("written");
    let error = annotation_export::export(&recording, &FORMATS[..1], false).expect_err("kept").to_string();
    assert!(error.contains("recording.eaf"), "{error}");
    assert_eq!(fs::read_to_string(recording.join("recording.eaf")).expect("a file"), touched);
    // What cannot be a code is refused, with its line.
    let line =
        1 + touched.lines().position(|line| line.contains(">slip<") && !line.contains("CVE_VALUE")).expect("a code");
    for (from, to, said) in [
        (">slip</ANNOTATION_VALUE>", ">tired</ANNOTATION_VALUE>", "the code \"tired\" of R1 at"),
        (">slip</ANNOTATION_VALUE>", ">belief</ANNOTATION_VALUE>", "the code \"belief\" of R1 at"),
        (">error 1:", ">first:", "among the errors"),
        (&format!("belief: {place}</ANNOTATION"), "belief: nowhere</ANNOTATION", "the aspect \"nowhere\""),
        ("TIER_ID=\"codes R1\"", "TIER_ID=\"codes Ann Miller\"", "the rater \"Ann Miller\""),
        ("TIER_ID=\"codes R1\"", "TIER_ID=\"R1\"", "no codes"),
        ("</TIER>", "", "ill-formed"),
    ] {
        let path = recording.join("wrong.eaf");
        fs::write(&path, touched.replacen(from, to, 1)).expect("written");
        let error = import(&path).expect_err(said).to_string();
        assert!(error.contains(said), "{said}: {error}");
        assert!(!said.contains("\"tired\"") || error.contains(&format!("wrong.eaf:{line}:")), "{line}: {error}");
    }
    let path = recording.join("wrong.boris");
    for (text, said) in [("{", "EOF"), ("{}", "no observations"), ("{\"observations\": {}}", "no codes")] {
        fs::write(&path, text).expect("written");
        assert!(import(&path).expect_err(said).to_string().contains(said), "{said}");
    }
}

#[test]
fn annotations_are_in_step_with_the_film() {
    let (recording, coded) = filmed("times");
    annotation_export::export(&recording, &[AnnotationFormat::Vtt], true).expect("exported");
    let text = fs::read_to_string(recording.join("recording.vtt")).expect("a file");
    let lines: Vec<&str> = text.lines().collect();
    let at = lines.iter().position(|line| line.starts_with("errors: error 1: ")).expect("the first error");
    let log = fs::read_to_string(recording.join("events.jsonl")).expect("a log");
    let press: Value =
        serde_json::from_str(log.lines().nth(1 + coded.codable.errors[0] as usize).expect("a press")).expect("JSON");
    let film_s = -3.0 + press["t_ns"].as_f64().expect("a number") / 1e9 * (1.0 + 50e-6);
    let (minutes, seconds) = ((film_s / 60.0).floor(), film_s % 60.0);
    assert!(lines[at - 1].starts_with(&format!("00:{minutes:02}:{seconds:06.3} --> ")), "{film_s}: {}", lines[at - 1]);
    let kinds: BTreeSet<&str> = lines.iter().filter_map(|line| line.split_once(": ")).map(|(kind, _)| kind).collect();
    assert_eq!(kinds, BTreeSet::from(["errors", "presses human", "presses robot"]), "raters see nothing else");
}

#[test]
fn a_camera_is_a_device_or_what_ffmpeg_reads_with_times_of_the_wall_clock() {
    let words = |device: &str| ffmpeg_input(device).map(|words| words.join(" ")).unwrap_or_default();
    assert_eq!(words("/dev/video0"), "-f v4l2 -ts abs -i /dev/video0");
    assert_eq!(ffmpeg_input("/dev/v4l/by-id/a camera").expect("a path").last().expect("it"), "/dev/v4l/by-id/a camera");
    assert_eq!(
        words("-f v4l2 -video_size 1280x720 -i /dev/video2"),
        "-f v4l2 -video_size 1280x720 -ts abs -i /dev/video2"
    );
    assert_eq!(words("-i rtsp://10.0.0.7/a"), "-use_wallclock_as_timestamps 1 -i rtsp://10.0.0.7/a");
    // No input, no output, no second input.
    for device in ["", "video0", "-i", "-f v4l2 /dev/video0", "-i a.mp4 b.mp4", "-i a -i b", "-i a\n", "-i -i"] {
        assert_eq!(ffmpeg_input(device), None, "{device:?}");
    }
    assert!(is_recorded_film(&film_name(3)) && is_recorded_film("film-12.mp4"));
    for name in ["film-.mp4", "film-01.mp4", "film-1.mp4.tmp", "film-+1.mp4", "film-1-h264.mp4", "room.mp4"] {
        assert!(!is_recorded_film(name), "{name}");
    }
}

/// Pictures of a film by players and by Capture's clock, and gaze by Capture's clock and the session's.
fn filmed_by_pupil(length_s: f64) -> (Vec<f64>, Vec<f64>, Vec<ClockPair>) {
    // The film begins 7 s before the session, and Capture's clock goes 80 ppm faster.
    let device_s = |session_s: f64| 351_000.0 + session_s * (1.0 + 80e-6);
    let frames = (length_s * 30.0) as usize;
    // A camera that waits for light.
    let times_s: Vec<f64> = (0..frames).map(|number| (number + number / 40 * 2) as f64 / 30.0).collect();
    let stamps_s = times_s.iter().map(|time_s| device_s(-7.0) + time_s).collect();
    let gaze = (0..(length_s * 120.0) as usize).map(|number| {
        let session_s = number as f64 / 120.0;
        let noise_s = (number * 7919 % 9) as f64 * 1e-3 - 4e-3;
        ClockPair { device_s: device_s(session_s), session_s: session_s + noise_s }
    });
    (times_s, stamps_s, gaze.collect())
}

#[test]
fn a_film_of_pupil_capture_is_aligned_by_its_clock() {
    for length_s in [300.0, 20.0] {
        let (times_s, stamps_s, gaze) = filmed_by_pupil(length_s);
        let found = film_clock::align(&times_s, &stamps_s, &gaze).expect("it fits");
        for session_s in [0.0, length_s / 2.0] {
            let truth = 7.0 * (1.0 + 80e-6) + session_s * (1.0 + 80e-6);
            let told = found.offset_s + session_s * (1.0 + found.drift);
            assert!((told - truth).abs() < 2e-3, "{length_s} s, at {session_s} s: {told}, not {truth}");
        }
        assert!(found.residual_s < 6e-3 && (found.frame_s - 1.0 / 30.0).abs() < 1e-9, "{found:?}");
    }
    let (times_s, stamps_s, mut gaze) = filmed_by_pupil(100.0);
    let refusal = |times: &[f64], stamps: &[f64], gaze: &[ClockPair]| {
        film_clock::align(times, stamps, gaze).expect_err("it does not fit")
    };
    assert_eq!(
        refusal(&times_s[1..], &stamps_s, &gaze),
        ClockRefusal::Number { frames: times_s.len() - 1, stamps: times_s.len() }
    );
    let back: Vec<f64> = stamps_s.iter().rev().copied().collect();
    assert_eq!(refusal(&times_s, &back, &gaze), ClockRefusal::Order);
    assert_eq!(refusal(&times_s, &stamps_s, &[]), ClockRefusal::NoGaze);
    let elsewhere: Vec<f64> = stamps_s.iter().map(|stamp| stamp + 5000.0).collect();
    assert_eq!(refusal(&times_s, &elsewhere, &gaze), ClockRefusal::Elsewhere);
    // Capture's clock is set in the middle of the trial.
    let half = gaze.len() / 2;
    gaze[half..].iter_mut().for_each(|pair| pair.session_s += 0.5);
    assert!(matches!(refusal(&times_s, &stamps_s, &gaze), ClockRefusal::Residual { .. }));
}

#[test]
fn time_stamps_of_pupil_capture_are_read_as_numpy_writes_them() {
    let array = |version: u8, head: &str, numbers: &[f64]| {
        let mut bytes = b"\x93NUMPY".to_vec();
        bytes.extend([version, 0]);
        match version {
            1 => bytes.extend((head.len() as u16).to_le_bytes()),
            _ => bytes.extend((head.len() as u32).to_le_bytes()),
        }
        bytes.extend(head.as_bytes());
        bytes.extend(numbers.iter().flat_map(|number| number.to_le_bytes()));
        bytes
    };
    let head = "{'descr': '<f8', 'fortran_order': False, 'shape': (2,), }          \n";
    for version in [1, 2] {
        assert_eq!(pupil_timestamps::parse(&array(version, head, &[3.5, 4.0])), Ok(vec![3.5, 4.0]));
    }
    for (bytes, said) in [
        (Vec::new(), "no array of numpy"),
        (array(1, head, &[3.5, 4.0])[..40].to_vec(), "no array of numpy"),
        (array(1, head, &[3.5]), "2 time stamps in 8 bytes"),
        (array(1, head, &[3.5, f64::NAN]), "a time stamp that is no number"),
        (array(1, &head.replace("<f8", "<i4"), &[3.5, 4.0]), "an array of the kind \"<i4\""),
        (array(1, &head.replace("(2,)", "(1, 2)"), &[3.5, 4.0]), "another shape"),
    ] {
        let error = pupil_timestamps::parse(&bytes).expect_err(said);
        assert!(error.contains(said), "{said}: {error}");
    }
    let folder = tempfile::tempdir().expect("a folder");
    assert_eq!(pupil_timestamps::beside(&folder.path().join("world.mp4")), None);
    let stamps = folder.path().join("world_timestamps.npy");
    fs::write(&stamps, "text").expect("written");
    assert_eq!(pupil_timestamps::beside(&folder.path().join("world.mp4")), Some(stamps.clone()));
    let error = pupil_timestamps::read(&stamps).expect_err("no array").to_string();
    assert!(error.contains("world_timestamps.npy") && error.contains("no array of numpy"), "{error}");
}
