//! Snippets of settings: each is written where its first line says, and read by the command that it is for.

use std::fs;
use std::path::Path;

use super::markdown::{Block, Page};
use super::run;

/// Which file a snippet is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Kind {
    Layout,
    Recipes,
    Session,
    Human,
    Keys,
    Questionnaire,
}

/// Told by its path, as on the pages.
fn kind(path: &str) -> Option<Kind> {
    let kinds = [
        ("layouts/", Kind::Layout),
        ("recipes/", Kind::Recipes),
        ("sessions/questionnaires/", Kind::Questionnaire),
        ("sessions/human", Kind::Human),
        ("sessions/keys", Kind::Keys),
        ("sessions/", Kind::Session),
    ];
    kinds.into_iter().find(|(folder, _)| path.starts_with(folder)).map(|(_, kind)| kind)
}

/// Writes all snippets of a page: those of one page may name each other.
pub fn write(page: &Page, folder: &Path) {
    for block in page.blocks.iter().filter(|block| block.language == "toml") {
        let place = page.at(block.line);
        let path = block.settings_path().unwrap_or_else(|| panic!("{place}: the first line names no file"));
        let kind = kind(path).unwrap_or_else(|| panic!("{place}: nothing is known of {path}"));
        let names_layout = block.text.lines().any(|line| line.starts_with("layout = "));
        let head = if kind == Kind::Session && !names_layout { "layout = \"../layouts/sushi.toml\"\n" } else { "" };
        fs::write(folder.join(path), format!("{head}{}", block.text)).expect("a snippet can be written");
    }
}

/// Reads a snippet with the program.
pub fn check(block: &Block, folder: &Path, place: &str) {
    let path = block.settings_path().unwrap_or_default();
    let name = path.rsplit_once('/').map_or(path, |(_, name)| name);
    let has_plan = block.text.contains("[plan]");
    let with = |settings: &str| {
        let session = format!("layout = \"../layouts/sushi.toml\"\n{settings}");
        fs::write(folder.join("sessions/that-names-it.toml"), session).expect("a session file can be written");
    };
    let command = match kind(path) {
        Some(Kind::Layout) => format!("tomcom kitchen {path}"),
        Some(Kind::Recipes) => {
            let from = format!("recipes = \"../{path}\"");
            let layouts = fs::read_dir(folder.join("layouts")).expect("layouts").filter_map(Result::ok);
            let text = |entry: fs::DirEntry| Some((entry.file_name(), fs::read_to_string(entry.path()).ok()?));
            let named = layouts.filter_map(text).find(|(_, text)| text.contains(&from));
            let (layout, _) = named.unwrap_or_else(|| panic!("{place}: no layout names {path}"));
            format!("tomcom kitchen layouts/{}", layout.to_string_lossy())
        }
        Some(Kind::Session) if has_plan => format!("tomcom plan {path}"),
        Some(Kind::Session) | None => format!("tomcom keys {path}"),
        Some(Kind::Human) => {
            with(&format!("human_model = \"{name}\"\n"));
            "tomcom keys sessions/that-names-it.toml".to_string()
        }
        Some(Kind::Keys) => {
            with(&format!("[console]\nkeys = \"{name}\"\n"));
            "tomcom keys sessions/that-names-it.toml".to_string()
        }
        Some(Kind::Questionnaire) => {
            let plan = "[plan]\nname = \"asked\"\nparticipants = 2\nconditions = [\"none\", \"tom-com\"]\n";
            with(&format!("{plan}[[plan.questionnaire]]\nfile = \"questionnaires/{name}\"\n"));
            "tomcom plan sessions/that-names-it.toml".to_string()
        }
    };
    run(&command, folder, place);
}
