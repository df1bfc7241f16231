//! README and docs/: every console block is run, every snippet of settings is read by the reader that it is for, every link
//! and path leads somewhere. Blocks that build, or need a person, are marked; their options are looked up.
//!
//! `snapbox` compares what is printed. `trycmd`, which would also read the pages, runs no shell (pipes, loops, `>`), and starts
//! from a folder beside each page; settings, logs, Python and links on a page are none of its business.

mod markdown;
mod settings;

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use rayon::prelude::*;
use snapbox::Assert;
use tomcom_session::event::TimestampedEvent;

use self::markdown::{Block, Page};
use crate::program::{self, TOMCOM};

/// Why a block may be left out.
const REASONS: [&str; 7] = [
    "builds",
    "needs a person",
    "needs the network",
    "takes minutes",
    "needs GNU parallel",
    "needs a cluster",
    // Its tests run these.
    "needs tomcom-research",
];
/// What stands in blocks; of the last two nothing is looked at.
const LANGUAGES: [&str; 8] = ["console", "sh", "toml", "json", "python", "rust", "text", "r"];

/// README, the other pages at the top, and docs/.
fn pages() -> Vec<Page> {
    let docs = fs::read_dir("docs").expect("docs").map(|entry| entry.expect("an entry").path());
    let mut paths: Vec<PathBuf> = docs.filter(|path| path.extension().is_some_and(|kind| kind == "md")).collect();
    paths.sort();
    let top = ["README.md", "ARCHITECTURE.md", "CONTRIBUTING.md", "CHANGELOG.md", "SUPPORT.md", "CODE_OF_CONDUCT.md"]
        .map(PathBuf::from);
    top.iter().filter(|path| path.exists()).chain(&paths).map(|path| Page::read(path)).collect()
}

/// A lab's folder, in which the blocks of a page find what they name.
fn scratch(kind: &str, page: &Page) -> PathBuf {
    let folder = program::folder(&format!("{kind}/{}", page.path.with_extension("").display()));
    let done = Command::new(TOMCOM).arg("new").arg(&folder).stdout(Stdio::null()).status();
    assert!(done.expect("tomcom runs").success());
    folder
}

/// Where commands are found: first the program.
fn path_with_program() -> String {
    let program = Path::new(TOMCOM).parent().expect("a folder");
    format!("{}:{}", program.display(), std::env::var("PATH").unwrap_or_default())
}

/// Runs a line in a shell, with the program in its path; what it printed.
fn run(line: &str, folder: &Path, place: &str) -> String {
    let mut shell = Command::new("sh");
    shell.args(["-c", line]).current_dir(folder).env("PATH", path_with_program()).stdin(Stdio::null());
    let output = shell.output().expect("a shell");
    let told = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{place}: {line}\n{told}");
    String::from_utf8_lossy(&output.stdout).into_owned()
}

/// A line `…` stands for any lines, `…` within a line for any text.
fn in_snapbox(line: &str) -> String {
    match line.trim() {
        "…" => "...\n".to_string(),
        _ => format!("{}\n", line.replace('…', "[..]")),
    }
}

/// Runs and reads the blocks of a page, in their order.
fn hold(page: &Page, folder: &Path, python: impl Fn(&Block, &str)) {
    settings::write(page, folder);
    for block in page.blocks.iter().filter(|block| block.not_run.is_none()) {
        let place = page.at(block.line);
        match block.language.as_str() {
            "console" | "sh" => {
                for (command, expected) in block.commands() {
                    let output = run(command, folder, &place);
                    let Some(expected) = expected else { continue };
                    let expected: String = expected.lines().map(in_snapbox).collect();
                    if let Err(differs) = Assert::new().try_eq(Some(&place), output.into(), expected.into()) {
                        panic!("{place}: {command}\n{differs}");
                    }
                }
            }
            "toml" => settings::check(block, folder, &place),
            "json" => {
                for line in block.text.lines() {
                    let event: Result<TimestampedEvent, _> = serde_json::from_str(line);
                    assert!(event.is_ok(), "{place}: {event:?}");
                }
            }
            "python" => python(block, &place),
            _ => {}
        }
    }
}

#[test]
fn what_the_pages_show_is_what_the_program_does() {
    pages().par_iter().for_each(|page| hold(page, &scratch("docs", page), |_, _| ()));
}

/// What is about the program's own package and files runs; what is about other packages and devices is compiled.
#[test]
#[ignore = "needs Python with pandas and rerun-sdk, which TOMCOM_PYTHON names"]
fn python_on_the_pages_runs() {
    let python = std::env::var("TOMCOM_PYTHON").unwrap_or_else(|_| "python3".to_string());
    let has_python = |page: &&Page| page.blocks.iter().any(|block| block.language == "python");
    pages().par_iter().filter(has_python).for_each(|page| {
        let folder = scratch("docs-python", page);
        hold(page, &folder, |block, place| {
            let code = match block.text.contains("import tomcom") || block.text.contains("from rerun") {
                true => block.text.clone(),
                false => format!("compile({:?}, 'snippet', 'exec')", block.text),
            };
            let mut python = Command::new(&python);
            let package = Path::new(env!("CARGO_MANIFEST_DIR")).join("packaging/python");
            python.args(["-c", &code]).current_dir(&folder).env("PATH", path_with_program()).env("PYTHONPATH", package);
            let done = python.output().expect("Python");
            assert!(done.status.success(), "{place}: {}", String::from_utf8_lossy(&done.stderr));
        });
    });
}

#[test]
fn marks_and_languages_are_known_ones() {
    for page in pages() {
        for block in &page.blocks {
            let place = page.at(block.line);
            assert!(LANGUAGES.contains(&block.language.as_str()), "{place}: a block of \"{}\"", block.language);
            if let Some(reason) = &block.not_run {
                assert!(REASONS.contains(&reason.as_str()), "{place}: not run: {reason}");
                assert!(matches!(block.language.as_str(), "console" | "sh"), "{place}: only commands are not run");
            }
        }
    }
}

/// Commands, options and features in blocks that are not run exist all the same.
#[test]
fn what_is_not_run_names_commands_that_exist() {
    let manifest: toml::Table = fs::read_to_string("Cargo.toml").expect("Cargo.toml").parse().expect("a manifest");
    let features = manifest.get("features").and_then(|features| features.as_table()).cloned().unwrap_or_default();
    let mut known: BTreeMap<String, String> = BTreeMap::new();
    let mut help = |command: &str| {
        let line = format!("tomcom {command} --help");
        known.entry(command.to_string()).or_insert_with(|| run(&line, Path::new("."), &line)).clone()
    };
    for page in pages() {
        for block in page.blocks.iter().filter(|block| block.not_run.is_some()) {
            let place = page.at(block.line);
            for (command, _) in block.commands() {
                let words: Vec<&str> = command.split('#').next().unwrap_or_default().split_whitespace().collect();
                if words.first() == Some(&"cargo") {
                    let named = words.iter().skip_while(|word| **word != "--features").nth(1);
                    for feature in named.iter().flat_map(|names| names.split(',')) {
                        assert!(
                            features.is_empty() || features.contains_key(feature),
                            "{place}: there is no feature {feature}"
                        );
                    }
                }
                let Some(("tomcom", rest)) = words.split_first().map(|(first, rest)| (*first, rest)) else { continue };
                let named = rest.first().filter(|word| !word.starts_with('-')).copied().unwrap_or_default();
                let told = help(named);
                let options = rest.iter().filter(|word| word.starts_with("--"));
                for option in options.map(|word| word.split('=').next().unwrap_or_default()) {
                    let is_there = told.split(|c: char| !c.is_alphanumeric() && c != '-').any(|word| word == option);
                    assert!(is_there, "{place}: tomcom {named} has no {option}");
                }
            }
        }
    }
}

#[test]
fn links_and_paths_lead_somewhere_and_the_index_knows_every_page() {
    let pages = pages();
    for page in &pages {
        let folder = page.path.parent().unwrap_or(Path::new(""));
        for link in &page.links {
            let place = page.at(link.line);
            let (path, heading) = link.target.split_once('#').unwrap_or((&link.target, ""));
            let target = if path.is_empty() { page.path.clone() } else { folder.join(path) };
            assert!(target.exists(), "{place} leads to {}, which is not there", link.target);
            if !heading.is_empty() {
                let headings = Page::read(&target).headings;
                assert!(headings.iter().any(|known| known == heading), "{place}: {} has no such heading", link.target);
            }
        }
    }
    for page in pages.iter().filter(|page| page.path != Path::new("CHANGELOG.md")) {
        for (line, path) in &page.paths {
            let is_there = Path::new(path).exists() || path.contains(['*', '<']);
            assert!(is_there, "{}: {path} is not there", page.at(*line));
        }
    }
    for index in ["docs/index.md", "docs/SUMMARY.md"] {
        let index = Page::read(Path::new(index));
        for page in of_the_manual(&pages).filter(|page| page.path != Path::new("docs/index.md")) {
            let name = page.path.file_name().unwrap_or_default().to_string_lossy();
            let is_named = index.links.iter().any(|link| link.target == name);
            assert!(is_named, "{} does not name {name}", index.path.display());
        }
    }
}

/// The pages of the manual, without its table of contents.
fn of_the_manual(pages: &[Page]) -> impl Iterator<Item = &Page> {
    pages.iter().filter(|page| page.path.starts_with("docs") && page.path != Path::new("docs/SUMMARY.md"))
}

#[test]
fn a_page_begins_with_what_it_is_for_and_for_whom() {
    for page in of_the_manual(&pages()) {
        let text = fs::read_to_string(&page.path).expect("a page");
        let mut lines = text.lines().filter(|line| !line.is_empty());
        let place = page.path.display();
        assert!(lines.next().is_some_and(|title| title.starts_with("# ")), "{place} begins with no title");
        let second = lines.next().unwrap_or_default();
        assert!(second.starts_with("For "), "{place} does not begin with whom it is for: {second}");
    }
}

/// The Journal of Open Source Software asks for these sections, and for at most 1,000 words.
#[test]
fn the_paper_has_its_sections_and_no_more_words_than_the_journal_takes() {
    let text = fs::read_to_string("docs/paper/paper.md").expect("the paper");
    let body = text.splitn(3, "---\n").nth(2).expect("what follows the front matter");
    let sections =
        ["Summary", "Statement of need", "State of the field", "Software design", "Research impact statement"];
    let found: Vec<&str> = body.lines().filter_map(|line| line.strip_prefix("# ")).collect();
    assert_eq!(found, [&sections[..], &["AI usage disclosure", "References"]].concat());
    let words = body.split_whitespace().count();
    assert!(words <= 1000, "{words} words");
    let keys = body.split('@').skip(1).filter_map(|rest| rest.split(|c: char| !c.is_alphanumeric()).next());
    let sources = fs::read_to_string("docs/paper/paper.bib").expect("the sources");
    for key in keys {
        assert!(sources.contains(&format!("{{{key},")), "{key} is not among the sources");
    }
}

#[test]
fn help_leads_to_pages_that_are_there_and_breaks_no_example_at_80_columns() {
    let help = |command: &str| run(&format!("COLUMNS=80 tomcom {command} --help"), Path::new("."), "help");
    let overview = help("");
    let commands = overview.lines().skip_while(|line| *line != "Commands:").skip(1).take_while(|line| !line.is_empty());
    let names = commands.filter_map(|line| line.strip_prefix("  ")?.split(' ').next().filter(|name| !name.is_empty()));
    let without_page = ["completions", "man", "help"];
    for command in names.filter(|name| !without_page.contains(name)).chain([""]) {
        let told = help(command);
        let is_broken = |line: &&str| line.chars().count() > 80 || line.starts_with("--");
        assert_eq!(told.lines().find(is_broken), None, "tomcom {command} --help");
        let words = told.split(|c: char| c.is_whitespace() || c == ',');
        let pages: Vec<&str> = words.filter(|word| word.starts_with("docs/")).collect();
        assert!(!pages.is_empty(), "tomcom {command} --help names no page");
        for page in pages {
            assert!(Path::new(page).exists(), "tomcom {command} --help leads to {page}, which is not there");
        }
    }
}
