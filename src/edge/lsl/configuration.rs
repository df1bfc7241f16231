//! Configuration of liblsl: the file that the lab has for it, without messages on the terminal, which is the console's.

use std::path::PathBuf;

/// The variable of the environment that names the file.
const VARIABLE: &str = "LSLAPICFG";
/// Where liblsl looks for it besides.
const NAME: &str = "lsl_api.cfg";
/// The table of the file that is about messages.
const LOG: &str = "log";
/// Only what ends the program is printed.
const QUIET: &str = "\n[log]\nlevel = -3\n";

/// The text of the lab's configuration file, if there is one, with the library's messages off.
pub(super) fn configuration() -> String {
    let named = std::env::var_os(VARIABLE).map(PathBuf::from);
    let home = std::env::home_dir().map(|home| home.join("lsl_api").join(NAME));
    let system = PathBuf::from("/etc/lsl_api").join(NAME);
    let places = named.into_iter().chain([PathBuf::from(NAME)]).chain(home).chain([system]);
    let text = places.filter_map(|place| std::fs::read_to_string(place).ok()).next().unwrap_or_default();
    quiet(&text)
}

/// A configuration file without its table about messages, and with our own.
fn quiet(text: &str) -> String {
    let mut is_about_messages = false;
    let kept = text.lines().filter(|line| {
        let line = line.trim();
        if let Some(table) = line.strip_prefix('[') {
            is_about_messages = table.trim_end_matches(']').trim() == LOG;
        }
        !is_about_messages
    });
    let kept: String = kept.map(|line| format!("{line}\n")).collect();
    kept + QUIET
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_labs_configuration_stays_but_for_messages() {
        let text = "[lab]\nKnownPeers = {10.0.0.2}\n[log]\nlevel = 5\nfile = x\n[multicast]\nResolveScope = link\n";
        let wanted = "[lab]\nKnownPeers = {10.0.0.2}\n[multicast]\nResolveScope = link\n\n[log]\nlevel = -3\n";
        assert_eq!(quiet(text), wanted);
        assert_eq!(quiet(""), QUIET);
    }
}
