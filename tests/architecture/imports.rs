//! Which file imports from which, read from parsed `use` items, paths and macro calls.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

use syn::visit::Visit;
use syn::{ItemMod, ItemUse, Macro, UseTree, Visibility};

use crate::sources::{Source, is_for_tests, words};

/// A module's place below the crate's root: `["console", "view"]`.
type ModulePath = Vec<String>;

/// A file of the crate: a module, and what it refers to.
struct Module {
    file: PathBuf,
    /// Paths from the crate's root that it uses itself.
    used: BTreeSet<ModulePath>,
    /// Names that it hands on with `pub use`, and the paths they stand for.
    handed_on: BTreeMap<String, ModulePath>,
}

/// All files of the crate with what they import.
pub struct Imports {
    modules: BTreeMap<ModulePath, Module>,
}

impl Imports {
    /// Reads these files, whose paths begin with `src`.
    pub fn read(sources: &[Source]) -> Imports {
        let places: BTreeSet<ModulePath> = sources.iter().map(|source| module_path(&source.path)).collect();
        let modules = sources.iter().map(|source| {
            let place = module_path(&source.path);
            let mut reader = Reader { place, places: &places, used: BTreeSet::new(), handed_on: BTreeMap::new() };
            reader.visit_file(&source.parsed);
            let Reader { place, used, handed_on, .. } = reader;
            (place, Module { file: source.path.clone(), used, handed_on })
        });
        Imports { modules: modules.collect() }
    }

    /// The files that a file uses names of; a name that a module only hands on comes from the file that defines it.
    pub fn used_by(&self, file: &Path) -> BTreeSet<&Path> {
        let module = &self.modules[&module_path(file)];
        module.used.iter().filter_map(|path| self.definition(path)).filter(|other| *other != file).collect()
    }

    /// The files that a file uses names of or hands names on from.
    pub fn named_by(&self, file: &Path) -> BTreeSet<&Path> {
        let module = &self.modules[&module_path(file)];
        let handed_on = module.handed_on.values().filter_map(|path| self.definition(path));
        self.used_by(file).into_iter().chain(handed_on).collect()
    }

    /// Groups of files each of which reaches all others of its group by imports, in order.
    pub fn circles(&self) -> Vec<Vec<&Path>> {
        let files: Vec<&Path> = self.modules.values().map(|module| module.file.as_path()).collect();
        let next: BTreeMap<&Path, BTreeSet<&Path>> = files.iter().map(|file| (*file, self.used_by(file))).collect();
        let reached: BTreeMap<&Path, BTreeSet<&Path>> = files.iter().map(|file| (*file, reach(file, &next))).collect();
        let mut circles: BTreeSet<Vec<&Path>> = BTreeSet::new();
        for file in files.iter().filter(|file| reached[*file].contains(*file)) {
            let circle = reached[file].iter().filter(|other| reached[*other].contains(file));
            circles.insert(circle.copied().collect());
        }
        circles.into_iter().collect()
    }

    /// The file that defines what stands at this path from the crate's root.
    fn definition(&self, path: &[String]) -> Option<&Path> {
        self.place(path).map(|(file, _)| file)
    }

    /// The file that defines what stands at this path from the crate's root, and what it is called there; no name is the
    /// module itself.
    pub fn place(&self, path: &[String]) -> Option<(&Path, Vec<String>)> {
        let mut path = path.to_vec();
        // A name is handed on a few times at most; a module that hands on itself would go on for ever.
        for _ in 0..8 {
            let depth = (0..=path.len()).rev().find(|&depth| self.modules.contains_key(&path[..depth]))?;
            let module = &self.modules[&path[..depth]];
            let Some(meant) = path.get(depth).and_then(|name| module.handed_on.get(name)) else {
                return Some((&module.file, path[depth..].to_vec()));
            };
            path = [meant.as_slice(), &path[depth + 1..]].concat();
        }
        None
    }
}

/// Every file that can be reached from a file; itself only along a circle.
fn reach<'a>(from: &'a Path, next: &BTreeMap<&'a Path, BTreeSet<&'a Path>>) -> BTreeSet<&'a Path> {
    let (mut reached, mut open) = (BTreeSet::new(), vec![from]);
    while let Some(file) = open.pop() {
        open.extend(next[file].iter().filter(|other| reached.insert(**other)));
    }
    reached
}

/// `src/console/view/mod.rs` and `src/console/view.rs` are `["console", "view"]`.
fn module_path(file: &Path) -> ModulePath {
    let below = file.strip_prefix("src").expect("below src").with_extension("");
    let mut path: ModulePath = below.iter().map(|part| part.to_string_lossy().into_owned()).collect();
    if path.last().is_some_and(|last| last == "mod") || path == ["lib"] {
        path.pop();
    }
    path
}

/// Collects what a file refers to.
struct Reader<'a> {
    place: ModulePath,
    /// All modules of the crate.
    places: &'a BTreeSet<ModulePath>,
    used: BTreeSet<ModulePath>,
    handed_on: BTreeMap<String, ModulePath>,
}

impl Reader<'_> {
    /// A path as it stands in this file, from the crate's root; none for what comes from another crate or a `use`.
    fn path_of_names(&self, names: &[String]) -> Option<ModulePath> {
        let first = names.first()?;
        let ups = names.iter().take_while(|name| *name == "super").count();
        match first.as_str() {
            "crate" | "tomcom" => Some(names[1..].to_vec()),
            "self" => Some([&self.place, &names[1..]].concat()),
            "super" => Some([&self.place[..self.place.len().checked_sub(ups)?], &names[ups..]].concat()),
            child => {
                let inside = [self.place.as_slice(), &[child.to_string()]].concat();
                self.places.contains(&inside).then(|| [self.place.as_slice(), names].concat())
            }
        }
    }
}

/// The paths of a `use` item, with the names that they get here.
pub fn leaves(item: &ItemUse) -> Vec<(String, Vec<String>)> {
    let mut into = Vec::new();
    collect_leaves(&item.tree, &[], &mut into);
    into
}

fn collect_leaves(tree: &UseTree, before: &[String], into: &mut Vec<(String, Vec<String>)>) {
    let with = |name: &syn::Ident| [before, &[name.to_string()]].concat();
    match tree {
        UseTree::Path(path) => collect_leaves(&path.tree, &with(&path.ident), into),
        UseTree::Group(group) => group.items.iter().for_each(|item| collect_leaves(item, before, into)),
        UseTree::Name(name) if name.ident == "self" => {
            into.push((before.last().cloned().unwrap_or_default(), before.to_vec()));
        }
        UseTree::Name(name) => into.push((name.ident.to_string(), with(&name.ident))),
        UseTree::Rename(rename) => into.push((rename.rename.to_string(), with(&rename.ident))),
        UseTree::Glob(_) => into.push(("*".to_string(), before.to_vec())),
    }
}

impl<'ast> Visit<'ast> for Reader<'_> {
    fn visit_item_mod(&mut self, item: &'ast ItemMod) {
        if !item.attrs.iter().any(is_for_tests) {
            syn::visit::visit_item_mod(self, item);
        }
    }

    fn visit_item_use(&mut self, item: &'ast ItemUse) {
        for (name, path) in leaves(item) {
            let Some(path) = self.path_of_names(&path) else { continue };
            match item.vis {
                Visibility::Inherited => drop(self.used.insert(path)),
                _ => drop(self.handed_on.insert(name, path)),
            }
        }
    }

    fn visit_path(&mut self, path: &'ast syn::Path) {
        let names: Vec<String> = path.segments.iter().map(|segment| segment.ident.to_string()).collect();
        if names.len() > 1 {
            self.used.extend(self.path_of_names(&names));
        }
        syn::visit::visit_path(self, path);
    }

    fn visit_macro(&mut self, call: &'ast Macro) {
        let words = words(&call.tokens.to_string());
        for word in words.iter().filter(|word| word.starts_with("crate::") || word.starts_with("super::")) {
            let names: Vec<String> = word.split("::").filter(|name| !name.is_empty()).map(str::to_string).collect();
            self.used.extend(self.path_of_names(&names));
        }
    }
}
