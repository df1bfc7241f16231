//! The source files of the crate, read and parsed.

use std::path::{Path, PathBuf};

use syn::{Attribute, File};

/// A source file.
pub struct Source {
    pub path: PathBuf,
    pub text: String,
    pub parsed: File,
}

impl Source {
    /// The folder or file directly below `src` that it belongs to.
    pub fn room(&self) -> String {
        room(&self.path)
    }
}

/// All source files below `src`, in order.
pub fn sources() -> Vec<Source> {
    sources_below(&["src"])
}

/// All source files below these folders, in order.
pub fn sources_below(folders: &[&str]) -> Vec<Source> {
    let mut paths = Vec::new();
    folders.iter().for_each(|folder| collect(Path::new(folder), &mut paths));
    paths.sort();
    let read = |path: PathBuf| {
        let text = std::fs::read_to_string(&path).expect("a source file");
        let parsed = syn::parse_file(&text).unwrap_or_else(|error| panic!("{}: {error}", path.display()));
        Source { path, text, parsed }
    };
    paths.into_iter().map(read).collect()
}

fn collect(folder: &Path, into: &mut Vec<PathBuf>) {
    for entry in std::fs::read_dir(folder).expect("a folder") {
        let path = entry.expect("an entry").path();
        match path.is_dir() {
            true => collect(&path, into),
            false if path.extension().is_some_and(|extension| extension == "rs") => into.push(path),
            false => {}
        }
    }
}

pub fn room(path: &Path) -> String {
    path.components().nth(1).expect("below src").as_os_str().to_string_lossy().replace(".rs", "")
}

/// `#[cfg(test)]`.
pub fn is_for_tests(attribute: &Attribute) -> bool {
    attribute.path().is_ident("cfg") && attribute.parse_args::<syn::Ident>().is_ok_and(|name| name == "test")
}

/// The names and paths in the tokens of a macro call, which are no syntax yet; what stands in strings is none. A macro that is
/// called inside keeps its `!`.
pub fn words(tokens: &str) -> Vec<String> {
    let (mut code, mut in_string, mut escaped) = (String::new(), false, false);
    for sign in tokens.chars() {
        let ends = sign == '"' && !escaped;
        escaped = sign == '\\' && !escaped;
        if ends {
            in_string = !in_string;
        }
        if ends || !in_string {
            code.push(sign);
        }
    }
    let code = code.replace(" :: ", "::").replace(" !", "!");
    let words = code.split(|sign: char| !(sign.is_alphanumeric() || matches!(sign, '_' | ':' | '!')));
    words
        .filter(|word| word.starts_with(|sign: char| sign.is_alphabetic() || sign == '_'))
        .map(str::to_string)
        .collect()
}
