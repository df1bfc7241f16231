//! Tests that run the program share terminals, ports and a disk with each other: they run one after another.

use syn::visit::Visit;
use syn::{Attribute, ItemFn};

use crate::sources::sources_below;

/// Looks for tests that are not `#[serial]`.
#[derive(Default)]
struct ParallelTests(Vec<String>);

impl<'ast> Visit<'ast> for ParallelTests {
    fn visit_item_fn(&mut self, function: &'ast ItemFn) {
        let has = |name: &str| function.attrs.iter().any(|attribute: &Attribute| attribute.path().is_ident(name));
        if has("test") && !has("serial") {
            self.0.push(function.sig.ident.to_string());
        }
        syn::visit::visit_item_fn(self, function);
    }
}

#[test]
fn tests_of_the_program_run_one_after_another() {
    for source in sources_below(&["tests/program"]) {
        let mut tests = ParallelTests::default();
        tests.visit_file(&source.parsed);
        assert!(tests.0.is_empty(), "{}: not #[serial]: {}", source.path.display(), tests.0.join(", "));
    }
}
