//! What ARCHITECTURE.md and the glossary name exists.

use std::path::Path;

use syn::{Item, Visibility};

use crate::imports::Imports;
use crate::sources::{Source, sources};

fn read(name: &str) -> String {
    std::fs::read_to_string(name).unwrap_or_else(|error| panic!("{name}: {error}"))
}

/// Paths in backticks that begin with a folder or file of the repository.
#[test]
fn every_path_in_the_architecture_exists() {
    let text = read("ARCHITECTURE.md");
    let roots = ["src/", "tests/", "layouts/", "recipes/", "sessions/", "benches/", "docs/", "examples/", ".ci/"];
    let is_path = |path: &&str| roots.iter().any(|root| path.starts_with(root)) && !path.contains(' ');
    let paths: Vec<&str> = quoted(&text).filter(is_path).collect();
    assert!(!paths.is_empty(), "ARCHITECTURE.md names no path");
    for path in paths.into_iter().flat_map(braced) {
        let is_there = match path.split_once('*') {
            Some((folder, _)) => Path::new(folder.rsplit_once('/').map_or(folder, |(folder, _)| folder)).exists(),
            None => Path::new(path.split(':').next().unwrap_or(&path)).exists(),
        };
        assert!(is_there, "ARCHITECTURE.md names {path}");
    }
}

/// What stands between backticks.
fn quoted(text: &str) -> impl Iterator<Item = &str> {
    text.split('`').skip(1).step_by(2)
}

/// `src/{a,b}` stands for `src/a` and `src/b`.
fn braced(path: &str) -> Vec<String> {
    match (path.split_once('{'), path.split_once('}')) {
        (Some((before, rest)), Some((_, after))) => {
            let list = rest.split('}').next().unwrap_or_default();
            list.split(',').map(|name| format!("{before}{}{after}", name.trim())).collect()
        }
        _ => vec![path.to_string()],
    }
}

/// Types that the glossary gives with their path, as another crate would write it.
#[test]
fn every_type_of_the_glossary_exists() {
    let (text, sources) = (read("docs/glossary.md"), sources());
    let imports = Imports::read(&sources);
    let paths: Vec<&str> = quoted(&text).filter_map(|path| path.strip_prefix("tomcom::")).collect();
    assert!(paths.len() >= 60, "the glossary names {} types", paths.len());
    let missing: Vec<&str> = paths.into_iter().filter(|path| !exists(path, &sources, &imports)).collect();
    assert!(missing.is_empty(), "docs/glossary.md names types that do not exist:\n{}", missing.join("\n"));
}

/// Whether there is a public type at this path from the crate's root.
fn exists(path: &str, sources: &[Source], imports: &Imports) -> bool {
    let names: Vec<String> = path.split("::").map(str::to_string).collect();
    let Some((file, rest)) = imports.place(&names) else { return false };
    let source = sources.iter().find(|source| source.path == file).expect("a source file");
    matches!(&rest[..], [name] if source.parsed.items.iter().any(|item| is_public_type(item, name)))
}

fn is_public_type(item: &Item, name: &str) -> bool {
    let (visibility, found) = match item {
        Item::Struct(item) => (&item.vis, &item.ident),
        Item::Enum(item) => (&item.vis, &item.ident),
        Item::Union(item) => (&item.vis, &item.ident),
        Item::Trait(item) => (&item.vis, &item.ident),
        Item::Type(item) => (&item.vis, &item.ident),
        _ => return false,
    };
    matches!(visibility, Visibility::Public(_)) && found == name
}
