//! Finds the position of a setting in a TOML text, for error messages.

use std::ops::Range;

use toml::de::{DeTable, DeValue};

/// Byte range of the `nth` setting (from 0) with this dotted path in a TOML text, outermost table first:
/// "rerun.address". Inner tables may be left out: "human.tau". `None` if the text has no such setting.
pub fn place_of(text: &str, path: &str, nth: usize) -> Option<Range<usize>> {
    let document = DeTable::parse(text).ok()?;
    let names: Vec<&str> = path.split('.').collect();
    let mut places = Vec::new();
    collect(document.get_ref(), &names, &mut places);
    places.sort_by_key(|place| place.start);
    places.into_iter().nth(nth)
}

/// Collects the byte ranges of all settings with this dotted path in a TOML table.
fn collect(table: &DeTable, names: &[&str], places: &mut Vec<Range<usize>>) {
    let Some((first, rest)) = names.split_first() else { return };
    for (name, value) in table {
        let is_it = name.get_ref() == first;
        if is_it && rest.is_empty() {
            places.push(name.span().start..name.span().end.max(value.span().end));
            continue;
        }
        within(value.get_ref(), if is_it { rest } else { names }, places);
    }
}

fn within(value: &DeValue, names: &[&str], places: &mut Vec<Range<usize>>) {
    match value {
        DeValue::Table(table) => collect(table, names, places),
        DeValue::Array(values) => values.iter().for_each(|value| within(value.get_ref(), names, places)),
        _ => {}
    }
}

#[cfg(test)]
mod tests {
    use super::place_of;

    const TEXT: &str = "name = \"a\"\n[tracker]\naddress = \"b\"\n[rerun]\naddress = \"c\"\n[human.decision]\ntau = 1\n\
                        [[item]]\nid = \"d\"\n[[item]]\nid = \"e\"\n[plan]\nform = { after = [2] }\n";

    fn line(path: &str, nth: usize) -> Option<&str> {
        place_of(TEXT, path, nth).map(|place| &TEXT[place])
    }

    #[test]
    fn a_setting_is_found_in_its_own_table() {
        assert_eq!(line("rerun.address", 0), Some("address = \"c\""));
        assert_eq!(line("tracker.address", 0), Some("address = \"b\""));
        assert_eq!(line("human.tau", 0), Some("tau = 1"));
        assert_eq!(line("item.id", 1), Some("id = \"e\""));
        assert_eq!(line("form.after", 0), Some("after = [2]"));
        assert_eq!(line("name", 0), Some("name = \"a\""));
        assert_eq!(line("display.address", 0), None);
    }
}
