//! Which settings a kind of file has. The file's own parser is asked: it refuses a setting that no file has, and names
//! those that the table could have.

use serde::de::DeserializeOwned;

/// A name that no setting has.
const NOBODY: &str = "no_setting_has_this_name";
/// Number of tables within tables that are looked into.
const DEEPEST: usize = 3;
/// A setting that more tables have than these has no place of its own, such as a name.
const MOST_PLACES: usize = 3;

/// Where files that are parsed into `T` have a setting of this name, in words: "under [human.decision]". `None` if no
/// table has it, or too many have it.
pub(super) fn places_of<T: DeserializeOwned>(setting: &str) -> Option<String> {
    let mut tables = Vec::new();
    collect::<T>("", setting, DEEPEST, &mut tables);
    if tables.is_empty() || tables.len() > MOST_PLACES {
        return None;
    }
    let place = |table: &String| match (table.as_str(), settings_of::<T>(&joined(table, setting))) {
        (_, Some(_)) => format!("as [{}]", joined(table, setting)),
        ("", None) => "above the first table".to_string(),
        (table, None) => format!("under [{table}]"),
    };
    Some(tables.iter().map(place).collect::<Vec<_>>().join(", or "))
}

/// Collects the tables from this one on, up to a depth, that have a setting of this name.
fn collect<T: DeserializeOwned>(table: &str, setting: &str, depth: usize, tables: &mut Vec<String>) {
    let Some(names) = settings_of::<T>(table) else { return };
    if names.iter().any(|name| name == setting) {
        tables.push(table.to_string());
    }
    if depth > 0 {
        names.iter().for_each(|name| collect::<T>(&joined(table, name), setting, depth - 1, tables));
    }
}

fn joined(table: &str, name: &str) -> String {
    if table.is_empty() { name.to_string() } else { format!("{table}.{name}") }
}

/// Names of the settings in this table; `None` if it is no table.
fn settings_of<T: DeserializeOwned>(table: &str) -> Option<Vec<String>> {
    let header = if table.is_empty() { String::new() } else { format!("[{table}]\n") };
    let error = toml::from_str::<T>(&format!("{header}{NOBODY} = 0\n")).err()?;
    let expected = error.message().strip_prefix(&format!("unknown field `{NOBODY}`, expected "))?;
    Some(expected.split('`').skip(1).step_by(2).map(str::to_string).collect())
}
