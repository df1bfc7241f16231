//! Translation of error messages about wrong types (by the parser library serde) into words for people who write
//! settings files.

use serde::de::DeserializeOwned;

/// The error message of the TOML parser in words. For a value that is no text, the parser does not list the valid
/// words, but for a wrong text it does; so the value is replaced by a text to get the list.
pub(super) fn message<T: DeserializeOwned>(text: &str, error: &toml::de::Error) -> String {
    let no_word = error.span().filter(|_| error.message() == "wanted string or table");
    let said = no_word.and_then(|span| {
        let with_a_word = [text.get(..span.start)?, "\"\"", text.get(span.end..)?].concat();
        let error = toml::from_str::<T>(&with_a_word).err()?;
        let (_, words) = error.message().split_once(", expected ")?;
        Some(format!("invalid value: {}, expected {words}", &text[span]))
    });
    said.unwrap_or_else(|| error.message().to_string())
}

/// The value that was found, in words, and a description of valid values if serde's message contains one.
pub(super) fn in_words(message: &str) -> (String, Option<String>) {
    let (found, expected) = match message.split_once(", expected ") {
        Some((found, expected)) => (found, Some(expected)),
        None => (message, None),
    };
    let is_setting = found.starts_with("unknown field");
    let right = expected.map(|expected| if is_setting { settings(expected) } else { values(expected) });
    let said = match () {
        () if let Some(what) = found.strip_prefix("invalid type: ").or(found.strip_prefix("invalid value: ")) => {
            value(what)
        }
        () if let Some(name) = found.strip_prefix("unknown variant ") => quoted(name),
        () if let Some(name) = found.strip_prefix("unknown field ") => {
            format!("{}, which is not the name of a setting here", quoted(name))
        }
        () if let Some(name) = found.strip_prefix("missing field ") => {
            return (format!("no {}", quoted(name)), Some(format!("{} = …", name.trim_matches('`'))));
        }
        () if found == "invalid IP address syntax" => {
            let right = "an address of a computer, such as \"192.168.1.20\", without a name or port";
            return ("a text that is no address".to_string(), Some(right.to_string()));
        }
        () if let Some(name) = found.strip_prefix("duplicate key") => format!("a setting twice{name}"),
        () => return (message.to_string(), None),
    };
    (said, right)
}

/// A value in words, from serde's notation: "string "fast"", "integer `5`", "sequence".
fn value(what: &str) -> String {
    let number = |name: &str| what.strip_prefix(name).map(|number| number.trim_matches('`').to_string());
    match what {
        "sequence" => "a list".to_string(),
        "map" => "a table".to_string(),
        _ => number("integer ")
            .or(number("floating point "))
            .or(number("boolean "))
            .or(what.strip_prefix("string ").map(str::to_string))
            .unwrap_or(what.to_string()),
    }
}

/// Description of a setting's valid values in words, from serde's notation.
fn values(expected: &str) -> String {
    let whole = |most: u64| format!("a whole number from 0 to {most}");
    match expected {
        "u8" => whole(u8::MAX.into()),
        "u16" => whole(u16::MAX.into()),
        // Most settings have narrower bounds, which are checked and reported by other code.
        "u32" | "u64" | "usize" => "a whole number, not below 0".to_string(),
        "i64" => "a whole number".to_string(),
        "f64" | "f32" => "a number".to_string(),
        "a string" => "a text in quotes".to_string(),
        "a boolean" => "true or false".to_string(),
        "a sequence" => "a list, in [ ]".to_string(),
        "IP address" => "an address in quotes, such as \"127.0.0.1\"".to_string(),
        _ if expected.starts_with("struct ") || expected == "a map" => "a table of settings".to_string(),
        _ => expected.replace('`', "\""),
    }
}

/// The known settings as a list in words, from serde's notation.
fn settings(expected: &str) -> String {
    expected.replace('`', "")
}

fn quoted(name: &str) -> String {
    name.replace('`', "\"")
}

#[cfg(test)]
mod tests {
    use super::in_words;

    fn words(message: &str) -> (String, String) {
        let (found, right) = in_words(message);
        (found, right.unwrap_or_default())
    }

    #[test]
    fn types_are_said_without_their_names_in_rust() {
        let cases = [
            ("invalid value: integer `99999`, expected u16", "99999", "a whole number from 0 to 65535"),
            ("invalid type: string \"fast\", expected f64", "\"fast\"", "a number"),
            ("invalid type: integer `5`, expected a boolean", "5", "true or false"),
            ("unknown variant `all`, expected one of `state`, `belief`", "\"all\"", "one of \"state\", \"belief\""),
            (
                "unknown field `len`, expected `seed` or `trial`",
                "\"len\", which is not the name of a setting here",
                "seed or trial",
            ),
            ("missing field `layout`", "no \"layout\"", "layout = …"),
            (
                "invalid IP address syntax",
                "a text that is no address",
                "an address of a computer, such as \"192.168.1.20\", without a name or port",
            ),
        ];
        for (message, found, right) in cases {
            assert_eq!(words(message), (found.to_string(), right.to_string()));
        }
    }

    #[test]
    fn what_is_no_type_error_is_said_as_it_is() {
        let message = "invalid table header\nexpected `]`";
        assert_eq!(in_words(message), (message.to_string(), None));
    }
}
