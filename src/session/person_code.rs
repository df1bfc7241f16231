//! Which codes people have: participants, raters and wizards. A code must be read as it is by every program that reads
//! the tables, and it must be safe in names of folders and files.

use tomcom_core::base::text;

const LONGEST: usize = 16;
/// Words, in small letters, that pandas, R and spreadsheets take for a missing value, a truth value or a number.
const WORDS: [&str; 12] = ["f", "false", "inf", "infinity", "na", "nan", "nil", "no", "none", "null", "t", "true"];
pub const REMEDY: &str = "a code of a letter and up to 15 letters, digits, - and _, such as \"P07\"; never a name";

/// Why a text is no code of a participant, a rater or a wizard.
pub fn fault(code: &str) -> Option<&'static str> {
    let is_sign = |sign: char| sign.is_ascii_alphanumeric() || sign == '-' || sign == '_';
    if code.is_empty() {
        Some("a code has at least one letter")
    } else if !code.starts_with(|first: char| first.is_ascii_alphabetic()) {
        Some("a code begins with a letter, since programs that read tables make numbers of others")
    } else if code.len() > LONGEST || !code.chars().all(is_sign) {
        Some("a code has no other signs than letters, digits, - and _, and at most 16 of them")
    } else if WORDS.contains(&code.to_ascii_lowercase().as_str()) {
        Some("programs that read tables take this word for a missing value, a truth value or a number")
    } else {
        None
    }
}

/// The first of these codes that differs from a code in capital letters only: they would be two people for one program,
/// and one person for another.
pub fn differing_in_case<'a>(code: &str, others: impl IntoIterator<Item = &'a str>) -> Option<&'a str> {
    others.into_iter().find(|other| *other != code && other.eq_ignore_ascii_case(code))
}

/// "; did you mean P07?"; empty if no code is near. The number in a code tells people apart: one with another number is
/// somebody else, however near it is.
pub fn did_you_mean<Code: AsRef<str>>(mistyped: &str, codes: impl IntoIterator<Item = Code>) -> String {
    let digits = |code: &str| code.chars().filter(char::is_ascii_digit).collect::<String>();
    text::did_you_mean(mistyped, codes.into_iter().filter(|code| digits(code.as_ref()) == digits(mistyped)))
}

/// "A1, B2"; of many that are numbered the first and the last, "P01 to P14 (14)", of others some: "A1, B2, … (14)".
pub fn listed(codes: &[String]) -> String {
    const FEW: usize = 6;
    let numbered = |code: &String| {
        let name = code.trim_end_matches(|sign: char| sign.is_ascii_digit());
        Some((name.to_string(), code[name.len()..].parse::<u64>().ok()?))
    };
    let follow = |pair: &[String]| match (numbered(&pair[0]), numbered(&pair[1])) {
        (Some((name, number)), Some(next)) => next == (name, number + 1),
        _ => false,
    };
    match codes {
        [first, .., last] if codes.len() > FEW && codes.windows(2).all(follow) => {
            format!("{first} to {last} ({})", codes.len())
        }
        many if many.len() > FEW => format!("{}, … ({})", many[..FEW].join(", "), many.len()),
        few => few.join(", "),
    }
}

/// The participant's code in a name like `seed7-S001`, which tables give to a participant simulated with seed 7.
pub fn without_seed(name: &str) -> Option<&str> {
    let (seed, code) = name.strip_prefix("seed")?.split_once('-')?;
    (!seed.is_empty() && seed.bytes().all(|digit| digit.is_ascii_digit())).then_some(code)
}
