//! Raters' codes: agreement, the file beside the log, export and import.

use miette::Diagnostic;
use tomcom_core::measures::raters::RaterChoice;
use tomcom_core::measures::raters::RaterConsensus;
use tomcom_core::measures::raters::{AgreementTable, ErrorCauseCode, ErrorCauseKind, RaterCodes};
use tomcom_session::log::rater_codes::{read_all, write};
use tomcom_session::log::{RecordingError, RecordingLock, consensus_file};
use tomcom_study::codes::{self, CodedRecording, InterRaterSummary, describe, export};
use tomcom_study::kept_cost::KeptCost;
use tomcom_study::pass::reading::{self, AnalysisScope};

use super::{folder, paper, run};
use crate::support::*;

/// The errors of one recording, coded by two people: so many pairs of what the one and the other say.
fn coded(pairs: &[(&str, &str, u64)]) -> AgreementTable {
    let code = |text: &str| match text.split_once(' ') {
        Some(("belief", place)) => ErrorCauseCode::Belief(place.to_string()),
        _ => ErrorCauseCode::new(ErrorCauseKind::named(text).expect("a kind"), None).expect("a code"),
    };
    let (mut one, mut other) = (RaterCodes::default(), RaterCodes::default());
    for (a, b, number) in pairs {
        for _ in 0..*number {
            let press = one.0.len() as u64;
            one.0.insert(press, code(a));
            other.0.insert(press, code(b));
        }
    }
    // What only one of them has coded does not count.
    one.0.insert(10_000, ErrorCauseCode::Slip);
    let mut table = AgreementTable::default();
    table.add(&one, &other);
    table
}

#[test]
fn kappa_is_that_of_known_tables() {
    // Fleiss, Levin and Paik, "Statistical Methods for Rates and Proportions", 2003, table 18.1: 200 subjects by two
    // raters, agreement .89, kappa .676.
    let rows = [
        ("slip", "slip", 106),
        ("slip", "race", 10),
        ("slip", "other", 4),
        ("race", "slip", 22),
        ("race", "race", 28),
        ("race", "other", 10),
        ("other", "slip", 2),
        ("other", "race", 12),
        ("other", "other", 6),
    ];
    let found = coded(&rows).agreement();
    // By hand: (140/200 - (120*130 + 60*50 + 20*20)/200^2) / (1 - the same).
    let expected = (0.7 - 0.475) / (1.0 - 0.475);
    assert_eq!((found.errors, found.same_cause), (200, 140));
    assert!((found.kappa_cause.expect("a kappa") - expected).abs() < 1e-12, "{found:?}");
    assert_eq!((found.beliefs, found.kappa_aspect), (0, None));

    // Cohen's textbook case of two categories: 20 and 15 agreed, 5 and 10 not: kappa 0.4.
    let two = coded(&[("slip", "slip", 20), ("slip", "other", 5), ("other", "slip", 10), ("other", "other", 15)]);
    assert!((two.agreement().kappa_cause.expect("a kappa") - 0.4).abs() < 1e-12);

    // The aspect is held against only where both see a belief, the cause whatever the aspect.
    let beliefs = coded(&[
        ("belief pot", "belief pot", 20),
        ("belief pot", "belief board", 5),
        ("belief board", "belief pot", 10),
        ("belief board", "belief board", 15),
        ("belief pot", "slip", 3),
    ]);
    let found = beliefs.agreement();
    assert_eq!((found.errors, found.same_cause, found.beliefs, found.same_aspect), (53, 50, 50, 35));
    assert!((found.kappa_aspect.expect("a kappa") - 0.4).abs() < 1e-12);
    assert_eq!(coded(&[("slip", "slip", 9)]).agreement().kappa_cause, None, "who always says the same proves nothing");
}

#[test]
fn the_two_raters_who_coded_most_errors_are_taken_and_none_by_name() {
    let rater = |errors: u64| RaterCodes((0..errors).map(|press| (press, ErrorCauseCode::Slip)).collect());
    let choice = |raters: &[u64]| {
        let named = raters.iter().enumerate().map(|(index, errors)| (format!("R{}", index + 1), rater(*errors)));
        match RaterChoice::most_complete(&named.collect()) {
            RaterChoice::Pair(pair) => pair.raters.join(" "),
            RaterChoice::TooFew => "too few".to_string(),
            RaterChoice::Tied { raters, coded } => format!("{} with {coded}", raters.join(" or ")),
        }
    };
    assert_eq!(choice(&[2, 9, 9]), "R2 R3", "the first by name is not complete");
    assert_eq!(choice(&[9, 2, 8]), "R1 R3");
    assert_eq!(choice(&[9]), "too few");
    assert_eq!(choice(&[9, 9, 9]), "R1 or R2 or R3 with 9", "nobody is left out by name");
    assert_eq!(choice(&[9, 5, 5]), "R1 or R2 or R3 with 5");
}

/// Imports a table whose new raters are meant.
fn import(coded: &mut [CodedRecording], table: &Path) -> Result<u64, RecordingError> {
    codes::read(coded, table)?.import(coded)
}

/// A row of a table that is wrong is named with what would be right, and nothing of the table is taken over.
fn check_wrong_rows(coded: &mut [CodedRecording], recording: &Path, table: &Path) {
    let name = recording.file_name().expect("a name").to_string_lossy().into_owned();
    let [first, second] = [0, 1].map(|index| coded[0].codable.errors[index]);
    let right = format!("{name},R3,{second},slip,");
    for (row, found, remedy) in [
        (format!("{name},R1,{first},belief,the_moon"), "the aspect \"the_moon\"", "cooking_pot"),
        (format!("{name},R1,{first},belief,"), "the cause \"belief\" with the aspect \"\"", "location"),
        (format!("{name},R1,{first},slip,plate"), "the cause \"slip\" with the aspect \"plate\"", "none"),
        (format!("{name},R1,{first},hunger,"), "the cause \"hunger\"", "belief, slip, race, other or buttons"),
        (format!("{name},R1,1,slip,"), "press 1, which was no error", &format!("the nearest: {first}")),
        (format!("{name},R1,first,slip,"), "the press \"first\"", "number"),
        (format!("{name},R3,{second},race,"), &format!("press {second} again, after line 2"), "one line"),
        (format!("{name},Jane Doe,{first},slip,"), "the rater \"Jane Doe\"", "never a name"),
        (format!("elsewhere,R1,{first},slip,"), "the recording \"elsewhere\"", name.as_str()),
        (format!("{name},R1,{first}"), "found record with 3 fields", "as many fields"),
    ] {
        fs::write(table, format!("recording,rater,press,cause,aspect\n{right}\n{row}\n")).expect("written");
        let told = import(coded, table).expect_err(&row);
        let help = told.help().map(|help| help.to_string()).unwrap_or_default();
        let told = told.to_string();
        assert!(told.contains("codes.csv:3:") && told.contains(found) && help.contains(remedy), "{told}; {help}");
    }
    assert!(!recording.join("codes-R3.csv").exists(), "nothing of a table with a wrong row is taken over");
}

/// A rater who codes at the console and an import do not overwrite each other's codes.
fn check_import_beside_a_console(coded: &mut [CodedRecording], recording: &Path, table: &Path) {
    let (name, first) = (coded[0].name(), coded[0].codable.errors[0]);
    fs::write(table, format!("recording,rater,press,cause,aspect\n{name},R1,{first},race,\n")).expect("written");
    let before = fs::read(recording.join("codes-R1.csv")).expect("codes");
    let console = RecordingLock::take_for_codes(recording, &["R1"]).expect("the console's lock");
    let told = import(coded, table).expect_err("R1 is coding").to_string();
    assert!(told.contains("codes its errors as R1"), "{told}");
    assert!(fs::read(recording.join("codes-R1.csv")).expect("codes") == before);
    // At the console the rater coded every error after this program had read the codes.
    let slips = RaterCodes(coded[0].codable.errors.iter().map(|press| (*press, ErrorCauseCode::Slip)).collect());
    write(recording, "R1", &slips).expect("written");
    drop(console);
    import(coded, table).expect("R1 is not coding any more");
    let mut expected = slips;
    expected.0.insert(first, ErrorCauseCode::Race);
    assert_eq!(read_all(recording, &coded[0].codable).expect("readable")["R1"], expected);
    assert!(!recording.join("lock-codes-R1").exists(), "the lock is given back");
}

/// Two raters of one recording: the second takes every other belief for a slip, and leaves the last error out.
fn two_raters(recording: &Path) -> (CodedRecording, [RaterCodes; 2]) {
    let coded = CodedRecording::open(recording).expect("a recording");
    let one = coded.known.clone().expect("a simulated participant tells");
    let mut other = RaterCodes::default();
    for (index, (press, code)) in one.0.iter().enumerate().take(one.0.len() - 1) {
        other.0.insert(*press, if index % 2 == 0 { code.clone() } else { ErrorCauseCode::Race });
    }
    write(recording, "R1", &one).expect("written");
    write(recording, "R2", &other).expect("written");
    (CodedRecording::open(recording).expect("a recording"), [one, other])
}

#[test]
fn what_two_raters_settle_is_no_rater_and_goes_stale_when_one_changes_a_code() {
    let out = folder("consensus");
    let made = run(&paper(304), 1, SimulationShard::WHOLE, &out);
    let recording = PathBuf::from(&made.recordings[0]);
    let (coded, [one, other]) = two_raters(&recording);
    let open = one.disagreements(&other);
    assert!(open.len() > 2, "{open:?}");
    let before = InterRaterSummary::from_recordings(std::slice::from_ref(&coded));
    // The last error, which the second rater left out, is no disagreement.
    assert_eq!(before.disagreements.iter().map(|one| one.error.press).collect::<Vec<u64>>(), open);
    assert!(!open.contains(coded.codable.errors.last().expect("an error")) && open == other.disagreements(&one));
    let first = &before.disagreements[0];
    assert_eq!((first.error.press, first.with_cause.as_str(), &first.with_aspect), (open[0], "race", &None));
    assert_eq!(coded.codable.errors[first.error.error as usize - 1], open[0]);

    let decided = RaterCodes(open.iter().map(|press| (*press, ErrorCauseCode::Buttons)).collect());
    let settled = RaterConsensus::new("R2", "R1").with_agreed([&one, &other]).with_decided(&decided, [&one, &other]);
    consensus_file::write(&recording, &settled).expect("written");
    let read = consensus_file::read(&recording, &coded.codable).expect("readable");
    assert_eq!(read.as_ref(), Some(&settled), "it is read as it was written");

    let after = CodedRecording::open(&recording).expect("a recording");
    let figures = InterRaterSummary::from_recordings(std::slice::from_ref(&after));
    assert_eq!(figures.agreements, before.agreements, "kappa is that of the raters' own codes");
    assert_eq!(after.codes.len(), 2, "a consensus is no rater");
    let found = figures.recordings[0].consensus.clone().expect("a consensus");
    assert_eq!((found.settled, found.open, found.stale.len()), (open.len() as u64, 1, 0));
    assert_eq!(found.agreed, made.errors - 1 - open.len() as u64, "what is agreed is not settled, too");

    // It comes and goes with the export.
    let table = out.join("codes.csv");
    export(std::slice::from_ref(&after), &table).expect("written");
    for name in ["codes-R1.csv", "codes-R2.csv", "consensus.csv"] {
        fs::remove_file(recording.join(name)).expect("removed");
    }
    let mut bare = vec![CodedRecording::open(&recording).expect("a recording")];
    import(&mut bare, &table).expect("its own export");
    assert_eq!(consensus_file::read(&recording, &coded.codable).expect("readable"), Some(settled.clone()));
    let name = after.name();
    let agreed = settled.settled.iter().find(|(_, settled)| settled.is_agreed()).map(|(press, _)| *press);
    for (row, found) in [
        (
            format!("{name},R1+R2,{},other,", agreed.expect("one")),
            "with another cause than the one that both raters gave",
        ),
        (format!("{name},R1+R3,{},other,", open[0]), "a consensus of R1 and R3, while R3 has coded nothing"),
        (format!("{name},R1+R1,{},other,", open[0]), "the rater \"R1+R1\""),
    ] {
        fs::write(&table, format!("recording,rater,press,cause,aspect\n{row}\n")).expect("written");
        let mut coded = vec![CodedRecording::open(&recording).expect("a recording")];
        let told = import(&mut coded, &table).expect_err(&row).to_string();
        assert!(told.contains("codes.csv:2:") && told.contains(found), "{told}");
    }

    // A rater thinks again.
    let mut later = other.clone();
    later.0.insert(open[0], ErrorCauseCode::Other);
    write(&recording, "R2", &later).expect("written");
    let stale = InterRaterSummary::from_recordings(&[CodedRecording::open(&recording).expect("a recording")]);
    let found = stale.recordings[0].consensus.clone().expect("a consensus");
    assert_eq!((found.open, found.stale.len()), (2, 1));
    assert_eq!((found.stale[0].press, found.stale[0].rater.as_str()), (open[0], "R2"));
    assert!(describe(&stale).contains("stale code: R2 changed the code of error"), "{}", describe(&stale));
}

#[test]
fn codes_are_kept_beside_the_log_and_come_and_go_as_a_table() {
    let out = folder("codes");
    let made = run(&paper(304), 1, SimulationShard::WHOLE, &out);
    let recording = PathBuf::from(&made.recordings[0]);
    let log = fs::read(recording.join(LOG_NAME)).expect("a log");
    let mut coded = vec![CodedRecording::open(&recording).expect("a recording")];
    assert_eq!(coded[0].codable.errors.len() as u64, made.errors);
    let truth = coded[0].known.clone().expect("a simulated participant tells");
    assert_eq!(truth.0.len(), coded[0].codable.errors.len());
    write(&recording, "R1", &truth).expect("written");
    // The second rater takes every belief for a slip.
    let slips = RaterCodes(truth.0.keys().map(|press| (*press, ErrorCauseCode::Slip)).collect());
    write(&recording, "R2", &slips).expect("written");
    assert_eq!(read_all(&recording, &coded[0].codable).expect("readable")["R1"], truth);

    coded = vec![CodedRecording::open(&recording).expect("a recording")];
    let figures = InterRaterSummary::from_recordings(&coded);
    assert_eq!(figures.agreements.len(), 1);
    let right: Vec<(&str, u64)> =
        figures.known.iter().map(|pair| (pair.of.as_str(), pair.agreement.same_cause)).collect();
    let slips_in_truth = truth.0.values().filter(|code| **code == ErrorCauseCode::Slip).count() as u64;
    assert_eq!(right, [("R1", made.errors), ("R2", slips_in_truth)]);
    assert_eq!(truth.agreed(&slips).0.len() as u64, figures.agreements[0].agreement.same_cause);

    let table = out.join("codes.csv");
    assert_eq!(export(&coded, &table).expect("written"), 2 * truth.0.len() as u64);
    for rater in ["R1", "R2"] {
        fs::remove_file(recording.join(format!("codes-{rater}.csv"))).expect("removed");
    }
    coded = vec![CodedRecording::open(&recording).expect("a recording")];
    import(&mut coded, &table).expect("its own export");
    assert_eq!(
        read_all(&recording, &coded[0].codable).expect("readable"),
        [("R1".into(), truth), ("R2".into(), slips)].into()
    );
    assert!(fs::read(recording.join(LOG_NAME)).expect("a log") == log, "the log stays as it is");

    check_import_beside_a_console(&mut coded, &recording, &table);
    check_wrong_rows(&mut coded, &recording, &table);

    // The same beside the log, which somebody may have written by hand.
    let first = coded[0].codable.errors[0];
    for (row, found) in [
        (format!("R3,{first},belief,the_moon"), "the_moon"),
        ("R3,1,slip,".to_string(), "no error"),
        (format!("007,{first},slip,"), "the rater \"007\": a code begins with a letter"),
    ] {
        fs::write(recording.join("codes-R3.csv"), format!("rater,press,cause,aspect\n{row}\n")).expect("written");
        let told = CodedRecording::open(&recording).expect_err(&row).to_string();
        assert!(told.contains("codes-R3.csv:2:") && told.contains(found), "{told}");
        let scope = AnalysisScope { concepts: false, events: false, raters: None };
        let told =
            reading::read(&recording, "one", &scope, &mut KeptCost::default()).err().map(|error| error.to_string());
        assert!(told.as_ref().is_some_and(|told| told.contains("codes-R3.csv:2:")), "{told:?}");
    }
}

/// A file says inside whose codes it has. What sync programs and spreadsheets make of it is told, and is no rater.
#[test]
fn one_rater_does_not_become_two_by_copies_of_a_file() {
    let out = folder("copied-codes");
    let made = run(&paper(304), 1, SimulationShard::WHOLE, &out);
    let recording = PathBuf::from(&made.recordings[0]);
    let coded = || CodedRecording::open(&recording).expect("a recording");
    let slips = RaterCodes(coded().codable.errors.iter().map(|press| (*press, ErrorCauseCode::Slip)).collect());
    assert!(slips.0.len() > 1, "{slips:?}");
    write(&recording, "R1", &slips).expect("written");
    let own = recording.join("codes-R1.csv");
    assert!(fs::read_to_string(&own).expect("codes").starts_with("rater,press,cause,aspect\nR1,"));
    let told = || {
        let error = CodedRecording::open(&recording).expect_err("refused");
        (error.to_string(), error.help().map(|help| help.to_string()).unwrap_or_default())
    };
    for copy in ["codes-R1-LAB-PC2.csv", "codes-R1 (1).csv", "Copy of codes-R1.csv", "codes-02.csv", "CODES-R1.CSV"] {
        let copy = recording.join(copy);
        fs::copy(&own, &copy).expect("copied");
        let (found, remedy) = told();
        assert!(
            found.contains(&copy.display().to_string()) && found.contains("of whom codes-R1.csv has codes"),
            "{found}"
        );
        assert!(remedy.contains("one file for each rater"), "{remedy}");
        // Without the original, it is the rater's only file, and must not be lost.
        fs::rename(&own, out.join("aside.csv")).expect("moved");
        let (found, remedy) = told();
        assert!(found.contains("codes of R1, in a file with another name"), "{found}");
        assert!(remedy.contains("the name codes-R1.csv"), "{remedy}");
        fs::rename(out.join("aside.csv"), &own).expect("moved");
        fs::remove_file(copy).expect("removed");
    }
    for renamed in ["codes_R1.csv", "codes R1.csv", "R1.csv"] {
        fs::rename(&own, recording.join(renamed)).expect("renamed");
        let (found, remedy) = told();
        assert!(found.contains("codes of R1, in a file with another name"), "{renamed}: {found}");
        assert!(remedy.contains("the name codes-R1.csv"), "{remedy}");
        fs::rename(recording.join(renamed), &own).expect("renamed");
    }
    fs::write(recording.join("codes-R1.xlsx"), "PK").expect("written");
    assert!(told().0.contains("codes-R1.xlsx: found what looks like the codes of a rater in a spreadsheet's file"));
    fs::remove_file(recording.join("codes-R1.xlsx")).expect("removed");
    // An export is nobody's codes, and German spreadsheets separate by semicolons.
    fs::write(recording.join("codes.csv"), "recording,rater,press,cause,aspect\n").expect("written");
    let comma = fs::read_to_string(&own).expect("codes");
    let spread: Vec<String> = comma.lines().map(|line| format!("{};\r\n", line.replace(',', ";"))).collect();
    fs::write(&own, spread.concat()).expect("written");
    assert_eq!(coded().codes["R1"], slips);
    fs::write(&own, spread.concat().replacen(";;\r\n", ";;x\r\n", 1)).expect("written");
    assert!(told().0.contains("found \"x\" beyond the last column"), "{:?}", told());
    fs::write(&own, comma).expect("written");
    let mixed = recording.join("codes-R2.csv");
    let press = *slips.0.keys().next().expect("an error");
    fs::write(&mixed, format!("rater,press,cause,aspect\nR2,{press},slip,\nR3,{press},slip,\n")).expect("written");
    let (found, remedy) = told();
    assert!(
        found.contains("codes-R2.csv:3: found codes of R3, after codes of R2") && remedy.contains("--import"),
        "{found}"
    );
    fs::write(&mixed, "rater,press,cause,aspect\n").expect("written");
    assert_eq!(coded().codes.len(), 1, "a file without codes is nobody's");
    fs::write(recording.join("codes-r1.csv"), format!("rater,press,cause,aspect\nr1,{press},slip,\n"))
        .expect("written");
    assert!(told().0.contains("codes of r1, beside codes of R1"), "{:?}", told());
    fs::remove_file(recording.join("codes-r1.csv")).expect("removed");
    fs::write(recording.join("consensus (1).csv"), "").expect("written");
    assert!(told().0.contains("what looks like a copy of consensus.csv"), "{:?}", told());
    fs::remove_file(recording.join("consensus (1).csv")).expect("removed");

    // Two raters who gave the same codes to all errors are told: one may be a copy of the other.
    let mut other = slips.clone();
    other.0.insert(press, ErrorCauseCode::Race);
    write(&recording, "R2", &other).expect("written");
    let words = "R1 and R2 gave the same codes to all";
    assert!(!describe(&InterRaterSummary::from_recordings(&[coded()])).contains(words));
    write(&recording, "R2", &slips).expect("written");
    let figures = InterRaterSummary::from_recordings(&[coded()]);
    assert!(describe(&figures).contains(words), "{}", describe(&figures));
    assert_eq!(figures.recordings[0].identical[0].errors, slips.0.len() as u64);
}

#[test]
fn new_raters_in_a_table_are_known_before_it_is_imported() {
    let out = folder("new-raters");
    let made = run(&paper(304), 1, SimulationShard::WHOLE, &out);
    let recording = PathBuf::from(&made.recordings[0]);
    let mut coded = vec![CodedRecording::open(&recording).expect("a recording")];
    let (name, press) = (coded[0].name(), coded[0].codable.errors[0]);
    let table = out.join("codes.csv");
    let put = |raters: &[&str]| {
        let rows: Vec<String> = raters.iter().map(|rater| format!("{name},{rater},{press},slip,\n")).collect();
        fs::write(&table, format!("recording,rater,press,cause,aspect\n{}", rows.concat())).expect("written");
    };
    // Neither has coded: there is nothing to settle.
    put(&["R1+R2"]);
    let told = import(&mut coded, &table).expect_err("refused").to_string();
    assert!(told.contains("a consensus of R1 and R2, while R1 has coded nothing"), "{told}");
    put(&["R1", "R1+R2"]);
    let told = import(&mut coded, &table).expect_err("refused").to_string();
    assert!(told.contains("while R2 has coded nothing"), "{told}");
    assert_eq!(read_all(&recording, &coded[0].codable).expect("readable").len(), 0, "nothing was imported");
    put(&["R1"]);
    assert_eq!(import(&mut coded, &table).expect("imported"), 1);
    coded = vec![CodedRecording::open(&recording).expect("a recording")];
    put(&["R1", "R2", "R1+R2"]);
    let codes = codes::read(&coded, &table).expect("readable");
    assert_eq!((codes.new_raters.join(" "), codes.known_raters.join(" ")), ("R2".to_string(), "R1".to_string()));
    codes.import(&mut coded).expect("imported");
    assert!(codes.changed.is_empty(), "{:?}", codes.changed);
    // Codes that the table changes are counted before.
    let rows = [("R1", "race"), ("R1+R2", "slip"), ("R2", "slip")]
        .map(|(rater, cause)| format!("{name},{rater},{press},{cause},\n"));
    fs::write(&table, format!("recording,rater,press,cause,aspect\n{}", rows.concat())).expect("written");
    let codes = codes::read(&coded, &table).expect("readable");
    assert_eq!(codes.changed, [("R1".to_string(), 1)].into());
    // A file that is no export is not replaced, and the message is about that file.
    fs::write(&table, "mine").expect("written");
    let told = export(&coded, &table).expect_err("refused").to_string();
    assert!(told.contains("codes.csv: cannot be written: a file is there that is not an export"), "{told}");
    put(&["r2"]);
    let told = codes::read(&[CodedRecording::open(&recording).expect("a recording")], &table);
    let told = told.expect_err("refused").to_string();
    assert!(told.contains("codes.csv:2:") && told.contains("the rater \"r2\", beside the rater R2"), "{told}");
}
