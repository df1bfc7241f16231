//! One word for one thing: names of types, the glossary, and the size of the pages that everybody reads first.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use syn::{Item, UseTree, Visibility};

/// Types of one name in two files, of which a build has only one.
const ALTERNATIVES: [(&str, &str); 1] = [("SteppedArm", "the arm of a build with physics, and of one without")];
/// Sizes that a page has at most, in bytes.
const PAGES: [(&str, usize); 2] = [("README.md", 8 << 10), ("ARCHITECTURE.md", 12 << 10)];

/// The public types that a file declares itself, and the names that it hands on.
fn public_names(path: &Path) -> (Vec<String>, Vec<String>) {
    let text = std::fs::read_to_string(path).expect("a source file");
    let parsed = syn::parse_file(&text).unwrap_or_else(|error| panic!("{}: {error}", path.display()));
    let (mut declared, mut handed_on) = (Vec::new(), Vec::new());
    for item in parsed.items {
        let (is_public, name) = match item {
            Item::Struct(item) => (is_public(&item.vis), item.ident.to_string()),
            Item::Enum(item) => (is_public(&item.vis), item.ident.to_string()),
            Item::Trait(item) => (is_public(&item.vis), item.ident.to_string()),
            Item::Type(item) => (is_public(&item.vis), item.ident.to_string()),
            Item::Use(item) if is_public(&item.vis) => {
                last_names(&item.tree, &mut handed_on);
                continue;
            }
            _ => continue,
        };
        if is_public {
            declared.push(name);
        }
    }
    (declared, handed_on)
}

fn is_public(visibility: &Visibility) -> bool {
    matches!(visibility, Visibility::Public(_))
}

fn last_names(tree: &UseTree, into: &mut Vec<String>) {
    match tree {
        UseTree::Path(path) => last_names(&path.tree, into),
        UseTree::Name(name) => into.push(name.ident.to_string()),
        UseTree::Rename(name) => into.push(name.rename.to_string()),
        UseTree::Group(group) => group.items.iter().for_each(|tree| last_names(tree, into)),
        UseTree::Glob(_) => {}
    }
}

#[test]
fn no_two_public_types_have_one_name() {
    let mut files: BTreeMap<String, Vec<PathBuf>> = BTreeMap::new();
    for source in super::sources() {
        for name in public_names(&source.path).0 {
            files.entry(name).or_default().push(source.path.clone());
        }
    }
    files.retain(|name, files| files.len() > 1 && ALTERNATIVES.iter().all(|(alternative, _)| alternative != name));
    assert!(files.is_empty(), "public types of one name: {files:?}");
}

#[test]
fn no_function_is_named_of() {
    for source in super::sources() {
        assert!(!source.code.contains("fn of("), "{}: name what the function gives", source.path.display());
    }
}

#[test]
fn every_type_of_the_glossary_exists() {
    let glossary = std::fs::read_to_string("docs/glossary.md").expect("docs/glossary.md");
    let paths: Vec<&str> = glossary.split('`').filter(|text| text.starts_with("tomcom::")).collect();
    assert!(paths.len() >= 60, "the glossary has only {} types", paths.len());
    for path in paths {
        let parts: Vec<&str> = path.split("::").collect();
        let [_, modules @ .., name] = parts.as_slice() else { panic!("{path} is no path of a type") };
        let folder = Path::new("src").join(modules.join("/"));
        let candidates = [folder.with_extension("rs"), folder.join("mod.rs")];
        let file = candidates.iter().find(|file| file.is_file()).unwrap_or_else(|| panic!("{path}: no such module"));
        let (declared, handed_on) = public_names(file);
        let has_it = declared.iter().chain(&handed_on).any(|found| found == name);
        assert!(has_it, "docs/glossary.md: {path} is not in {}", file.display());
    }
}

#[test]
fn pages_that_everybody_reads_first_are_short() {
    for (page, most) in PAGES {
        let size = std::fs::metadata(page).expect("a page").len() as usize;
        assert!(size <= most, "{page} has {size} bytes; at most {most}");
    }
}
