//! Pages of documentation: their fenced blocks, marks, headings and links.

use std::fs;
use std::path::{Path, PathBuf};

/// A page.
pub struct Page {
    pub path: PathBuf,
    pub blocks: Vec<Block>,
    pub headings: Vec<String>,
    pub links: Vec<Link>,
    /// The project's files and folders that it names, with the lines where it does.
    pub paths: Vec<(usize, String)>,
}

/// A fenced block.
pub struct Block {
    /// The line of its opening fence, from 1.
    pub line: usize,
    pub language: String,
    pub text: String,
    /// Why it is not run: the mark `<!-- not run: REASON -->` on the line before the fence.
    pub not_run: Option<String>,
}

/// A link that is no address on the web.
pub struct Link {
    pub line: usize,
    pub target: String,
}

impl Page {
    pub fn read(path: &Path) -> Page {
        let text = fs::read_to_string(path).unwrap_or_else(|error| panic!("{}: {error}", path.display()));
        let (mut blocks, mut headings, mut links, mut paths) = (Vec::new(), Vec::new(), Vec::new(), Vec::new());
        let (mut open, mut before): (Option<Block>, &str) = (None, "");
        for (line, text) in (1..).zip(text.lines()) {
            match (open.take(), text.strip_prefix("```")) {
                (Some(block), Some(_)) => blocks.push(block),
                (Some(mut block), None) => {
                    block.text += text;
                    block.text += "\n";
                    open = Some(block);
                }
                (None, Some(language)) => {
                    let mark = before.strip_prefix("<!-- not run: ").and_then(|rest| rest.strip_suffix(" -->"));
                    let (language, not_run) = (language.trim().to_string(), mark.map(str::to_string));
                    open = Some(Block { line, language, text: String::new(), not_run });
                }
                (None, None) => {
                    headings.extend(text.strip_prefix('#').map(|rest| slug(rest.trim_start_matches('#'))));
                    paths.extend(paths_in(text).map(|path| (line, path.to_string())));
                    links.extend(links_in(text).map(|target| Link { line, target: target.to_string() }));
                }
            }
            before = text;
        }
        assert!(open.is_none(), "{}: a block is not closed", path.display());
        Page { path: path.to_path_buf(), blocks, headings, links, paths }
    }

    /// Where a block is, for messages.
    pub fn at(&self, line: usize) -> String {
        format!("{}:{line}", self.path.display())
    }
}

impl Block {
    /// The commands in it with the output that each is said to have; nothing is said of the output in `sh` blocks.
    pub fn commands(&self) -> Vec<(&str, Option<String>)> {
        let mut commands: Vec<(&str, Option<String>)> = Vec::new();
        for line in self.text.lines() {
            match (self.language.as_str(), line.strip_prefix("$ "), commands.last_mut()) {
                ("console", Some(command), _) => commands.push((command, Some(String::new()))),
                ("console", None, Some((_, Some(output)))) => *output += &format!("{line}\n"),
                ("sh", ..) if !line.trim().is_empty() && !line.starts_with('#') => commands.push((line, None)),
                _ => {}
            }
        }
        commands
    }

    /// Where a settings file would stand: its first line is a comment with the path.
    pub fn settings_path(&self) -> Option<&str> {
        self.text.lines().next()?.strip_prefix("# ").filter(|path| path.ends_with(".toml"))
    }
}

/// The targets of the links in a line of text.
fn links_in(text: &str) -> impl Iterator<Item = &str> {
    let targets = text.split("](").skip(1).filter_map(|rest| rest.split(')').next());
    targets.filter(|target| !target.contains("://"))
}

/// What stands between backquotes in a line of text and begins like a path of the project.
fn paths_in(text: &str) -> impl Iterator<Item = &str> {
    let is_path =
        |word: &&str| ["src/", "tests/", "benches/", "examples/"].iter().any(|folder| word.starts_with(folder));
    text.split('`').skip(1).step_by(2).map(|code| code.split(' ').next().unwrap_or(code)).filter(is_path)
}

/// The name of a heading in links, as GitHub makes it.
fn slug(heading: &str) -> String {
    let kept = heading.trim().chars().filter(|c| c.is_alphanumeric() || matches!(c, ' ' | '-' | '_'));
    kept.map(|c| if c == ' ' { '-' } else { c }).collect::<String>().to_lowercase()
}
