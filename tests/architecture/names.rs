//! Names: each stands for one thing, and what is public says what it is.

use std::collections::{BTreeMap, BTreeSet};

use syn::visit::Visit;
use syn::{
    Attribute, Fields, ImplItem, Item, ItemEnum, ItemImpl, ItemMod, ItemStruct, ItemTrait, ItemType, ItemUnion,
    Signature, TraitItem, Visibility,
};

use crate::sources::{Source, is_documentation, is_for_tests, sources, sources_below};

/// Names of files that several rooms have on purpose, and why.
const SHARED_FILE_NAMES: [(&str, &str); 2] =
    [("mod.rs", "the root of a folder"), ("settings.rs", "the settings of each room that has any")];

/// Stands in for a part of the program that a build leaves out, with the same types.
fn is_stand_in(file: &str) -> bool {
    file.starts_with("without_")
}

#[test]
fn public_types_have_names_of_their_own() {
    let mut types: BTreeMap<String, BTreeSet<String>> = BTreeMap::new();
    for source in sources() {
        let file = source.path.file_name().expect("a file").to_string_lossy().into_owned();
        let names: Vec<String> = named_types(&source).into_iter().map(|found| found.name).collect();
        assert!(names.len() == names.iter().collect::<BTreeSet<_>>().len(), "{}", source.path.display());
        for name in names.into_iter().filter(|_| !is_stand_in(&file)) {
            types.entry(name).or_default().insert(source.path.display().to_string());
        }
    }
    for (name, files) in types {
        assert!(files.len() == 1, "several public types are called {name}: {files:?}");
    }
}

/// A type that other files can name.
pub struct NamedType {
    pub name: String,
    /// Other crates can name it, too, where its modules are public.
    pub is_public: bool,
}

/// The types of a file that other files can name, without those of its tests.
pub fn named_types(source: &Source) -> Vec<NamedType> {
    let mut found = NamedTypes(Vec::new());
    found.visit_file(&source.parsed);
    found.0
}

struct NamedTypes(Vec<NamedType>);

impl NamedTypes {
    fn note(&mut self, visibility: &Visibility, name: &syn::Ident) {
        if !matches!(visibility, Visibility::Inherited) {
            self.0.push(NamedType { name: name.to_string(), is_public: matches!(visibility, Visibility::Public(_)) });
        }
    }
}

impl<'ast> Visit<'ast> for NamedTypes {
    fn visit_item_mod(&mut self, item: &'ast ItemMod) {
        if !item.attrs.iter().any(is_for_tests) {
            syn::visit::visit_item_mod(self, item);
        }
    }

    fn visit_item_struct(&mut self, item: &'ast ItemStruct) {
        self.note(&item.vis, &item.ident);
    }

    fn visit_item_enum(&mut self, item: &'ast ItemEnum) {
        self.note(&item.vis, &item.ident);
    }

    fn visit_item_union(&mut self, item: &'ast ItemUnion) {
        self.note(&item.vis, &item.ident);
    }

    fn visit_item_trait(&mut self, item: &'ast ItemTrait) {
        self.note(&item.vis, &item.ident);
    }

    fn visit_item_type(&mut self, item: &'ast ItemType) {
        self.note(&item.vis, &item.ident);
    }
}

/// `of` says nothing of what a function returns: `from_…`, `for_…`, or the noun.
#[test]
fn no_function_is_called_of() {
    struct Functions(BTreeSet<String>);
    impl<'ast> Visit<'ast> for Functions {
        fn visit_signature(&mut self, signature: &'ast Signature) {
            self.0.insert(signature.ident.to_string());
            syn::visit::visit_signature(self, signature);
        }
    }
    for source in sources_below(&["src", "tests", "benches", "examples"]) {
        let mut functions = Functions(BTreeSet::new());
        functions.visit_file(&source.parsed);
        assert!(!functions.0.contains("of"), "{}: a function is called `of`", source.path.display());
    }
}

#[test]
fn files_of_different_rooms_have_names_of_their_own() {
    let mut rooms: BTreeMap<String, BTreeSet<String>> = BTreeMap::new();
    for source in sources() {
        let file = source.path.file_name().expect("a file").to_string_lossy().into_owned();
        rooms.entry(file).or_default().insert(source.room());
    }
    rooms.retain(|file, rooms| {
        let is_shared = SHARED_FILE_NAMES.iter().any(|(name, _)| name == file);
        rooms.len() > 1 && !is_shared && !is_stand_in(file)
    });
    let told = |(file, rooms): (&String, &BTreeSet<String>)| {
        format!("{file}: {}", rooms.iter().cloned().collect::<Vec<_>>().join(", "))
    };
    let twice: Vec<String> = rooms.iter().map(told).collect();
    assert!(twice.is_empty(), "files of different rooms have the same name:\n{}", twice.join("\n"));
}

/// The compiler warns of what can be reached from outside; this holds for everything that is `pub`, and for every file.
#[test]
fn every_public_item_says_what_it_is() {
    let mut missing = Vec::new();
    for source in sources() {
        let path = source.path.display();
        let mut silent = Silent::default();
        silent.note(&source.parsed.attrs, "the file");
        silent.items(&source.parsed.items);
        missing.extend(silent.0.into_iter().map(|name| format!("{path}: {name}")));
    }
    assert!(missing.is_empty(), "without a comment that says what it is:\n{}", missing.join("\n"));
}

#[test]
fn the_compiler_warns_of_public_items_without_a_comment() {
    let sources = sources();
    let root = sources.iter().find(|source| source.path.ends_with("lib.rs")).expect("the crate's root");
    let warns = |attribute: &Attribute| {
        let is_lint = ["warn", "deny", "forbid"].iter().any(|level| attribute.path().is_ident(level));
        is_lint && attribute.parse_args::<syn::Path>().is_ok_and(|lint| lint.is_ident("missing_docs"))
    };
    assert!(root.parsed.attrs.iter().any(warns), "src/lib.rs needs #![warn(missing_docs)]");
}

/// Collects public items without documentation.
#[derive(Default)]
struct Silent(Vec<String>);

impl Silent {
    fn note(&mut self, attributes: &[Attribute], name: &str) {
        if !attributes.iter().any(is_documentation) {
            self.0.push(name.to_string());
        }
    }

    fn items(&mut self, items: &[Item]) {
        for item in items {
            self.item(item);
        }
    }

    fn item(&mut self, item: &Item) {
        let is_public = |visibility: &Visibility| matches!(visibility, Visibility::Public(_));
        match item {
            Item::Struct(item) if is_public(&item.vis) => {
                self.note(&item.attrs, &item.ident.to_string());
                self.fields(&item.fields, &item.ident.to_string(), is_public);
            }
            Item::Enum(item) if is_public(&item.vis) => {
                self.note(&item.attrs, &item.ident.to_string());
                for variant in &item.variants {
                    let name = format!("{}::{}", item.ident, variant.ident);
                    self.note(&variant.attrs, &name);
                    self.fields(&variant.fields, &name, |_| true);
                }
            }
            Item::Trait(item) if is_public(&item.vis) => {
                self.note(&item.attrs, &item.ident.to_string());
                item.items.iter().for_each(|inner| self.trait_item(inner, &item.ident.to_string()));
            }
            Item::Type(item) if is_public(&item.vis) => self.note(&item.attrs, &item.ident.to_string()),
            Item::Const(item) if is_public(&item.vis) => self.note(&item.attrs, &item.ident.to_string()),
            Item::Static(item) if is_public(&item.vis) => self.note(&item.attrs, &item.ident.to_string()),
            Item::Fn(item) if is_public(&item.vis) => self.note(&item.attrs, &item.sig.ident.to_string()),
            Item::Impl(item) if item.trait_.is_none() => self.methods(item, is_public),
            Item::Mod(item) if !item.attrs.iter().any(is_for_tests) => {
                let items = item.content.as_ref().map_or(&[][..], |(_, items)| items);
                self.items(items);
            }
            _ => {}
        }
    }

    fn fields(&mut self, fields: &Fields, owner: &str, is_public: impl Fn(&Visibility) -> bool) {
        for field in fields.iter().filter(|field| is_public(&field.vis)) {
            if let Some(name) = &field.ident {
                self.note(&field.attrs, &format!("{owner}.{name}"));
            }
        }
    }

    fn trait_item(&mut self, item: &TraitItem, owner: &str) {
        match item {
            TraitItem::Fn(function) => self.note(&function.attrs, &format!("{owner}::{}", function.sig.ident)),
            TraitItem::Const(constant) => self.note(&constant.attrs, &format!("{owner}::{}", constant.ident)),
            TraitItem::Type(inner) => self.note(&inner.attrs, &format!("{owner}::{}", inner.ident)),
            _ => {}
        }
    }

    fn methods(&mut self, item: &ItemImpl, is_public: impl Fn(&Visibility) -> bool) {
        for inner in &item.items {
            match inner {
                ImplItem::Fn(method) if is_public(&method.vis) => {
                    self.note(&method.attrs, &method.sig.ident.to_string())
                }
                ImplItem::Const(constant) if is_public(&constant.vis) => {
                    self.note(&constant.attrs, &constant.ident.to_string());
                }
                _ => {}
            }
        }
    }
}
