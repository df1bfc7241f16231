//! What may be named where: the outside, time and chance only at the edge, and some crates only in their rooms.

use std::collections::BTreeSet;
use std::path::Path;

use syn::visit::Visit;
use syn::{ExprAsync, ExprAwait, ItemStatic, ItemUse, Macro, Signature, StaticMutability};

use crate::imports::leaves;
use crate::sources::{Source, sources, words};
use crate::{EDGE, floor_of};

/// Names that stand for the outside, for time or chance that no seed decides, or for an order that is not fixed. The maps of
/// rustc-hash have no random seed: their order is the same in every run. How `rand` shuffles and samples may change with its
/// version; `base::rng::shuffle` is ours.
const BANNED_BELOW_EDGE: [&str; 22] = [
    "std::fs",
    "std::net",
    "std::env",
    "std::thread",
    "std::process",
    "std::io",
    "SystemTime",
    "Instant",
    "async",
    "await",
    "println!",
    "eprintln!",
    "print!",
    "eprint!",
    "dbg!",
    "HashMap",
    "HashSet",
    "rand::rng",
    "rand::random",
    "thread_rng",
    "rand::seq",
    "static mut",
];

/// Crates that only some rooms may name; a file name stands for that file alone.
const ONLY_IN: [(&str, &[&str]); 18] = [
    ("ratatui", &["src/console", "src/edge"]),
    ("crossterm", &["src/console", "src/edge"]),
    ("tokio", &["src/edge", "src/run", "src/main.rs", "src/cli.rs"]),
    ("re_sdk", &["src/edge/rerun.rs", "src/edge/rerun"]),
    ("re_sdk_types", &["src/edge/rerun.rs", "src/edge/rerun"]),
    ("re_protos", &["src/edge/rerun"]),
    ("tonic", &["src/edge/rerun"]),
    ("tonic_web", &["src/edge/rerun"]),
    ("tower_layer", &["src/edge/rerun"]),
    ("zeromq", &["src/edge"]),
    (
        "nalgebra",
        &[
            "src/analysis/fitting",
            "src/arm",
            "src/scene",
            "src/edge/rerun.rs",
            "src/study/linear_mixed_model.rs",
            "src/study/negative_binomial_model.rs",
        ],
    ),
    ("urdf_rs", &["src/arm"]),
    ("rapier3d", &["src/arm"]),
    ("maud", &["src/study"]),
    ("flate2", &["src/edge/bids_tree.rs"]),
    ("mcap", &["src/edge/mcap_file.rs"]),
    ("libloading", &["src/edge/lsl/library.rs"]),
    ("sha2", &["src/edge/frozen_file.rs", "src/edge/list_cache.rs", "src/edge/log/same_log.rs"]),
];

/// Collects the paths, macros and kinds of code that a file names.
#[derive(Default)]
struct Mentions(BTreeSet<String>);

impl Mentions {
    fn in_source(source: &Source) -> Mentions {
        let mut mentions = Mentions::default();
        mentions.visit_file(&source.parsed);
        mentions
    }

    /// The first path that holds this name or these names in a row.
    fn find(&self, name: &str) -> Option<&str> {
        let names: Vec<&str> = name.split("::").collect();
        let holds = |path: &str| path.split("::").collect::<Vec<_>>().windows(names.len()).any(|part| part == names);
        self.0.iter().map(String::as_str).find(|path| holds(path))
    }

    /// The first path that begins with this crate. A path of our own (`crate::edge::rerun::…`) names a module.
    fn find_crate(&self, name: &str) -> Option<&str> {
        self.0.iter().map(String::as_str).find(|path| path.split("::").next() == Some(name))
    }

    fn note(&mut self, mention: &str) {
        self.0.insert(mention.to_string());
    }
}

impl<'ast> Visit<'ast> for Mentions {
    fn visit_item_use(&mut self, item: &'ast ItemUse) {
        self.0.extend(leaves(item).into_iter().map(|(_, path)| path.join("::")));
    }

    fn visit_path(&mut self, path: &'ast syn::Path) {
        let names: Vec<String> = path.segments.iter().map(|segment| segment.ident.to_string()).collect();
        self.note(&names.join("::"));
        syn::visit::visit_path(self, path);
    }

    fn visit_macro(&mut self, call: &'ast Macro) {
        if let Some(name) = call.path.segments.last() {
            self.note(&format!("{}!", name.ident));
        }
        self.0.extend(words(&call.tokens.to_string()));
        syn::visit::visit_macro(self, call);
    }

    fn visit_expr_await(&mut self, expression: &'ast ExprAwait) {
        self.note("await");
        syn::visit::visit_expr_await(self, expression);
    }

    fn visit_expr_async(&mut self, expression: &'ast ExprAsync) {
        self.note("async");
        syn::visit::visit_expr_async(self, expression);
    }

    fn visit_signature(&mut self, signature: &'ast Signature) {
        if signature.asyncness.is_some() {
            self.note("async");
        }
        syn::visit::visit_signature(self, signature);
    }

    fn visit_item_static(&mut self, item: &'ast ItemStatic) {
        if matches!(item.mutability, StaticMutability::Mut(_)) {
            self.note("static mut");
        }
        syn::visit::visit_item_static(self, item);
    }
}

#[test]
fn nothing_left_of_the_edge_touches_the_outside() {
    for source in sources().iter().filter(|source| floor_of(source) < EDGE) {
        let mentions = Mentions::in_source(source);
        for name in BANNED_BELOW_EDGE {
            let found = mentions.find(name);
            assert!(found.is_none(), "{}: {name}, as {found:?}", source.path.display());
        }
    }
}

#[test]
fn outside_crates_are_named_only_where_they_belong() {
    for source in sources() {
        let mentions = Mentions::in_source(&source);
        for (name, places) in ONLY_IN {
            let is_allowed = places.iter().any(|place| source.path.starts_with(place));
            let found = mentions.find_crate(name);
            assert!(is_allowed || found.is_none(), "{} names {found:?}", source.path.display());
        }
    }
}

/// A clock that can be set is no measure of time: what has to be measured is measured with the monotonic one.
#[test]
fn the_wall_clock_is_named_in_one_file() {
    for source in sources() {
        let is_clock = source.path == Path::new("src/edge/clock.rs");
        let found = Mentions::in_source(&source).find("SystemTime").map(str::to_string);
        assert!(is_clock || found.is_none(), "{}: {found:?}", source.path.display());
    }
}

/// Fields that name a path, of types that are written as JSON or TOML.
#[derive(Default)]
struct WrittenPaths {
    found: Vec<String>,
    /// The field that is being visited.
    field: Option<String>,
}

/// Whether a list such as `#[derive(...)]` or `#[serde(...)]` has this word.
fn has(attributes: &[syn::Attribute], list: &str, word: &str) -> bool {
    attributes.iter().filter(|attribute| attribute.path().is_ident(list)).any(|attribute| {
        let list = attribute.meta.require_list().map(|list| list.tokens.to_string()).unwrap_or_default();
        words(&list).iter().any(|found| found == word)
    })
}

impl<'ast> Visit<'ast> for WrittenPaths {
    fn visit_item_struct(&mut self, item: &'ast syn::ItemStruct) {
        if !has(&item.attrs, "derive", "Serialize") {
            return;
        }
        for field in item.fields.iter().filter(|field| !has(&field.attrs, "serde", "skip")) {
            let name = field.ident.as_ref().map_or(String::new(), ToString::to_string);
            self.field = Some(format!("{}.{name}", item.ident));
            self.visit_type(&field.ty);
            self.field = None;
        }
    }

    fn visit_path(&mut self, path: &'ast syn::Path) {
        let is_path = path.segments.last().is_some_and(|last| last.ident == "PathBuf" || last.ident == "Path");
        self.found.extend(self.field.clone().filter(|_| is_path));
        syn::visit::visit_path(self, path);
    }
}

/// serde refuses to write a path that is not UTF-8, and the macro `json!` panics: written paths are `PathText`.
#[test]
fn no_type_that_is_written_has_a_path_that_may_be_no_text() {
    for source in sources().iter().filter(|source| !source.path.ends_with("base/path_text.rs")) {
        let mut paths = WrittenPaths::default();
        paths.visit_file(&source.parsed);
        assert!(paths.found.is_empty(), "{}: {:?}: use PathText", source.path.display(), paths.found);
    }
}
