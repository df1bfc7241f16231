//! Which codes people have: participants, raters and wizards. A code must be read as it is by every program that reads
//! the tables, and it must be safe in names of folders and files.

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

/// The participant's code in a name like `seed7-S001`, which tables give to a participant simulated with seed 7.
pub fn without_seed(name: &str) -> Option<&str> {
    let (seed, code) = name.strip_prefix("seed")?.split_once('-')?;
    (!seed.is_empty() && seed.bytes().all(|digit| digit.is_ascii_digit())).then_some(code)
}
