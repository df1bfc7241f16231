//! Which codes people of new sessions may have.

use std::collections::BTreeSet;

use tomcom::session::participant_code::{FILE_WORDS, TABLE_WORDS, is_participant_code, without_seed};
use tomcom::study::column::CsvTable;
use tomcom::study::dictionary::dictionary;

#[test]
fn the_words_of_the_studys_tables_are_those_of_its_dictionary() {
    let columns = dictionary().map(|row| row.column.into_owned());
    let words: BTreeSet<String> = columns.chain(CsvTable::ALL.map(|table| table.name().to_string())).collect();
    let words: Vec<&str> = words.iter().map(String::as_str).collect();
    assert_eq!(TABLE_WORDS, words, "the names of tables and columns, in the order of the alphabet");
    assert!(FILE_WORDS.iter().all(|word| !words.contains(word)), "a word stands in one of the lists");
    for word in TABLE_WORDS.iter().chain(FILE_WORDS) {
        assert!(!is_participant_code(word) && !is_participant_code(&word.to_uppercase()), "{word}");
    }
}

/// The kinds of events stand in the first column of the tables in docs/recordings.md, between backticks.
#[test]
fn the_kinds_of_events_are_no_codes() {
    let page = std::fs::read_to_string("docs/recordings.md").expect("docs/recordings.md");
    let (_, events) = page.split_once("### Events").expect("the events");
    let (events, _) = events.split_once("\n## ").expect("the next section");
    let cells = events.lines().filter_map(|line| line.strip_prefix("| `")?.split(" |").next());
    let kinds: Vec<&str> = cells.flat_map(|cell| cell.split(|c: char| !(c.is_ascii_lowercase() || c == '_'))).collect();
    let kinds: Vec<&str> = kinds.into_iter().filter(|kind| kind.len() > 1 && *kind != "kind").collect();
    assert!(kinds.len() > 35 && kinds.contains(&"session_ended"), "{kinds:?}");
    for kind in kinds {
        assert!(!is_participant_code(kind), "{kind}");
    }
}

#[test]
fn a_code_begins_with_a_letter_or_digit_and_is_no_name_of_a_simulated_participant() {
    for code in ["P07", "1", "S001", "A-1", "7_b", "trial7", "nobody"] {
        assert!(is_participant_code(code), "{code}");
    }
    for code in ["", "-", "-7", "_a", "seed7-S001", "Seed7-x", "Jane Doe", "none", "None", "trials", "human", "é"] {
        assert!(!is_participant_code(code), "{code}");
    }
    assert_eq!(without_seed("seed7-S001"), Some("S001"));
    assert_eq!(without_seed("seed-S001"), None);
    assert_eq!(without_seed("seedling-7"), None);
}
