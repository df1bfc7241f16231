//! Which codes people have: participants, raters and wizards.

use tomcom_session::person_code::{differing_in_case, fault, without_seed};

/// What pandas 2.3 and R 4 read as missing, as a truth value or as a number, of what has the signs of a code.
const CHANGED: [&str; 24] = [
    "NA", "NaN", "nan", "null", "NULL", "None", "none", "nil", "TRUE", "FALSE", "true", "false", "True", "T", "F",
    "inf", "Inf", "Infinity", "007", "01", "1", "1e5", "0x1F", "-7",
];

#[test]
fn a_code_is_read_as_it_is_by_every_program() {
    for code in CHANGED {
        assert!(fault(code).is_some(), "{code}");
    }
    for code in ["", "_a", "Jane Doe", "é", "P07+", "P.07", "a23456789012345678", "p\u{661}"] {
        assert!(fault(code).is_some(), "{code}");
    }
    for code in ["P07", "S001", "A-1", "b_7", "trial7", "nobody", "human", "NAN1", "a234567890123456", "P", "x"] {
        assert_eq!(fault(code), None, "{code}");
    }
}

#[test]
fn codes_that_differ_in_capital_letters_only_are_found() {
    let others = ["P01", "P07", "R1"];
    assert_eq!(differing_in_case("p07", others), Some("P07"));
    assert_eq!(differing_in_case("P07", others), None);
    assert_eq!(differing_in_case("P08", others), None);
}

#[test]
fn the_seed_before_a_code_is_told_apart() {
    assert_eq!(without_seed("seed7-S001"), Some("S001"));
    assert_eq!(without_seed("seed-S001"), None);
    assert_eq!(without_seed("seedling-7"), None);
}
