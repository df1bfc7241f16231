//! How long files and functions may be.

use syn::visit::Visit;
use syn::{ImplItemFn, ItemFn, TraitItemFn};

use crate::sources::{Source, sources, sources_below};

/// Files stay under about 400 lines.
const MAX_LINES: usize = 420;
/// Functions stay under about 60 lines, with their signature.
const MAX_FUNCTION_LINES: usize = 65;

/// Functions that may be longer, each with its reason.
const LONG_FUNCTIONS: [(&str, &str, &str); 7] = [
    ("src/session/apply.rs", "apply", "one arm for each kind of event, each of few lines"),
    ("src/analysis/event_lines.rs", "line", "one arm for each kind of event, each of one line"),
    ("src/console/console_actions.rs", "act", "one arm for each kind of key action, each of few lines"),
    ("src/console/table.rs", "live", "the table of keys, an entry for each"),
    ("src/kitchen/cost_to_go/goal.rs", "new", "every table of a goal, in the order in which one needs another"),
    ("src/run/study/reading.rs", "read", "one pass over a recording that fills every table"),
    ("src/run/study/tell.rs", "describe", "the printed page, from its first line to its last"),
];

#[test]
fn files_stay_short() {
    for source in sources() {
        assert!(source.lines() <= MAX_LINES, "{}: {} lines", source.path.display(), source.lines());
    }
}

#[test]
fn test_files_stay_short() {
    for source in sources_of_tests() {
        let lines = source.lines();
        assert!(lines <= MAX_LINES, "{}: {lines} lines: split it by theme", source.path.display());
    }
}

#[test]
fn functions_stay_short() {
    let mut long = Vec::new();
    for source in sources().into_iter().chain(sources_of_tests()) {
        let path = source.path.display().to_string();
        let lengths = lengths(&source).into_iter().filter(|(_, lines)| *lines > MAX_FUNCTION_LINES);
        long.extend(lengths.map(|(name, lines)| (path.clone(), name, lines)));
    }
    let is_listed = |path: &str, name: &str| LONG_FUNCTIONS.iter().any(|long| (long.0, long.1) == (path, name));
    let new: Vec<String> = long
        .iter()
        .filter(|(path, name, _)| !is_listed(path, name))
        .map(|(path, name, lines)| format!("{path}: {name} has {lines} lines"))
        .collect();
    assert!(new.is_empty(), "functions are longer than {MAX_FUNCTION_LINES} lines:\n{}", new.join("\n"));
    for (path, name, _) in LONG_FUNCTIONS {
        let is_long = long.iter().any(|one| (one.0.as_str(), one.1.as_str()) == (path, name));
        assert!(is_long, "{path}: {name} is short by now: take it off the list");
    }
}

fn sources_of_tests() -> Vec<Source> {
    let mut sources = sources_below(&["tests", "benches", "examples"]);
    sources.retain(|source| !source.path.starts_with("tests/fuzz"));
    sources
}

/// The names of a file's functions that have a body, in the order in which they stand there.
#[derive(Default)]
struct Functions(Vec<String>);

impl<'ast> Visit<'ast> for Functions {
    fn visit_item_fn(&mut self, function: &'ast ItemFn) {
        self.0.push(function.sig.ident.to_string());
        syn::visit::visit_item_fn(self, function);
    }

    fn visit_impl_item_fn(&mut self, function: &'ast ImplItemFn) {
        self.0.push(function.sig.ident.to_string());
        syn::visit::visit_impl_item_fn(self, function);
    }

    fn visit_trait_item_fn(&mut self, function: &'ast TraitItemFn) {
        if function.default.is_some() {
            self.0.push(function.sig.ident.to_string());
        }
        syn::visit::visit_trait_item_fn(self, function);
    }
}

/// The functions of a file with their numbers of lines. Syntax does not say on which line it stands: a function begins where
/// its name follows `fn`, and ends, as rustfmt writes it, with the next brace that stands as far to the right.
fn lengths(source: &Source) -> Vec<(String, usize)> {
    let mut functions = Functions::default();
    functions.visit_file(&source.parsed);
    let lines: Vec<&str> = source.text.lines().collect();
    let (mut lengths, mut from) = (Vec::new(), 0);
    for name in functions.0 {
        let begins = |line: &&str| {
            let after = line.split_once(&format!("fn {name}")).map(|(_, after)| after);
            !line.trim_start().starts_with("//") && after.is_some_and(|after| after.starts_with(['(', '<']))
        };
        let at = from + lines[from..].iter().position(begins).expect("the function");
        let indentation = lines[at].len() - lines[at].trim_start().len();
        let end = format!("{}}}", " ".repeat(indentation));
        let ends = |line: &&str| **line == end;
        let is_one_line = lines[at].ends_with('}');
        let length = if is_one_line { 1 } else { lines[at..].iter().position(ends).expect("the function's end") + 1 };
        lengths.push((name, length));
        from = at + 1;
    }
    lengths
}
