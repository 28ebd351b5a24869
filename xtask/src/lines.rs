// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Counts lines of code: those of Rust with a token that is no documentation and in no
//! `#[cfg(test)]` item, and those of the page that tokei calls code.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::process::Command;

use proc_macro2::{Delimiter, TokenStream, TokenTree};
use syn::spanned::Spanned;
use tokei::{Config, Languages};

use crate::command::{Failure, failed, output, root, target};

/// The page, and what in it comes from elsewhere.
const PAGE: &str = "crates/palpate-live/web";
const VENDOR: &str = "vendor";

/// Prints the lines of each crate and of the page; beside those of `revision`, if there is one.
pub(crate) fn print(revision: Option<&str>) -> Result<(), Failure> {
    let here = count(&root())?;
    let Some(revision) = revision else {
        here.iter().for_each(|(part, lines)| println!("{part:<32} {lines:>7}"));
        println!("{:<32} {:>7}", "all", here.values().sum::<usize>());
        return Ok(());
    };
    let there = count(&checked_out(revision)?)?;
    let parts: BTreeMap<&String, (usize, usize)> = (here.keys().chain(there.keys()))
        .map(|part| {
            let of = |counts: &BTreeMap<String, usize>| counts.get(part).copied();
            (part, (of(&here).unwrap_or(0), of(&there).unwrap_or(0)))
        })
        .collect();
    println!("{:<32} {:>7} {revision:>12}", "", "now");
    for (part, (now, then)) in &parts {
        println!("{part:<32} {now:>7} {then:>12}");
    }
    let (now, then) = (here.values().sum::<usize>(), there.values().sum::<usize>());
    println!("{:<32} {now:>7} {then:>12}  {:.3}", "all", now as f64 / then as f64);
    Ok(())
}

/// The files of a revision, in a work tree under `target/`.
fn checked_out(revision: &str) -> Result<PathBuf, Failure> {
    let git =
        |arguments: &[&str]| output(Command::new("git").args(arguments).current_dir(root()));
    let commit = git(&["rev-parse", "--verify", &format!("{revision}^{{commit}}")])?;
    let tree = target().join("lines").join(commit.trim());
    if !tree.exists() {
        // Those whose folders were removed are forgotten first.
        git(&["worktree", "prune"])?;
        let place = tree.to_string_lossy();
        git(&["worktree", "add", "--detach", &place, commit.trim()])?;
    }
    Ok(tree)
}

/// The lines of each crate below a root, and of its page.
fn count(root: &Path) -> Result<BTreeMap<String, usize>, Failure> {
    let mut counts = BTreeMap::new();
    for group in ["crates", "bindings"] {
        let folder = root.join(group);
        for entry in std::fs::read_dir(&folder).map_err(|error| failed(&folder, &error))? {
            let source = entry.map_err(|error| failed(&folder, &error))?.path();
            if !source.join("src").is_dir() {
                continue;
            }
            let lines = of_crate(&source.join("src"))?;
            counts.insert(name(root, &source), lines);
        }
    }
    counts.insert(PAGE.to_owned(), of_page(&root.join(PAGE)));
    Ok(counts)
}

fn name(root: &Path, path: &Path) -> String {
    path.strip_prefix(root).unwrap_or(path).to_string_lossy().replace('\\', "/")
}

/// The lines of the page but for what comes from elsewhere.
fn of_page(folder: &Path) -> usize {
    let mut languages = Languages::new();
    languages.get_statistics(&[folder], &[VENDOR], &Config::default());
    languages.total().code
}

/// The lines of the files below a crate's `src`, but for files of modules that are tests.
fn of_crate(folder: &Path) -> Result<usize, Failure> {
    let mut files = Vec::new();
    rust_files(folder, &mut files)?;
    let (mut counts, mut tests) = (Vec::new(), Vec::new());
    for path in files {
        let text = std::fs::read_to_string(&path).map_err(|error| failed(&path, &error))?;
        let counted =
            of_text(&text).map_err(|error| Failure(format!("{}: {error}", path.display())))?;
        tests.extend(counted.test_modules.iter().map(|module| beside(&path).join(module)));
        counts.push((path, counted.lines));
    }
    let is_test = |path: &Path| {
        tests.iter().any(|test| path.with_extension("") == *test || path.starts_with(test))
    };
    Ok(counts.iter().filter(|(path, _)| !is_test(path)).map(|(_, lines)| lines).sum())
}

/// Where the files of a file's modules are.
fn beside(path: &Path) -> PathBuf {
    let stem = path.file_stem().unwrap_or_default();
    let is_own = ["mod", "lib", "main"].iter().any(|own| stem == *own);
    if is_own { path.with_file_name("") } else { path.with_extension("") }
}

fn rust_files(folder: &Path, files: &mut Vec<PathBuf>) -> Result<(), Failure> {
    for entry in std::fs::read_dir(folder).map_err(|error| failed(folder, &error))? {
        let path = entry.map_err(|error| failed(folder, &error))?.path();
        if path.is_dir() {
            rust_files(&path, files)?;
        } else if path.extension().is_some_and(|ending| ending == "rs") {
            files.push(path);
        }
    }
    Ok(())
}

/// What a file of Rust has.
#[derive(Debug, PartialEq)]
struct Counted {
    lines: usize,
    /// The modules in files of their own that are `#[cfg(test)]`.
    test_modules: Vec<String>,
}

fn of_text(text: &str) -> syn::Result<Counted> {
    let file = syn::parse_file(text)?;
    // Whether each line has code.
    let mut has_code = vec![false; text.lines().count() + 1];
    mark(text.parse()?, &mut has_code);
    let mut test_modules = Vec::new();
    exclude_tests(&file.items, &mut has_code, &mut test_modules);
    let lines = has_code.iter().filter(|has_code| **has_code).count();
    Ok(Counted { lines, test_modules })
}

/// Marks the lines of all tokens but those of documentation.
fn mark(tokens: TokenStream, has_code: &mut [bool]) {
    let tokens: Vec<TokenTree> = tokens.into_iter().collect();
    let mut i = 0;
    while i < tokens.len() {
        if let Some(length) = documentation(&tokens[i..]) {
            i += length;
            continue;
        }
        let mut put = |first: usize, last: usize| {
            (first..=last).for_each(|line| has_code[line - 1] = true);
        };
        match &tokens[i] {
            TokenTree::Group(group) => {
                if group.delimiter() != Delimiter::None {
                    let (open, close) = (group.span_open().start(), group.span_close().end());
                    put(open.line, open.line);
                    put(close.line, close.line);
                }
                mark(group.stream(), has_code);
            }
            token => put(token.span().start().line, token.span().end().line),
        }
        i += 1;
    }
}

/// How many tokens a documentation comment is, if the tokens begin with one.
fn documentation(tokens: &[TokenTree]) -> Option<usize> {
    let is_punct = |token: Option<&TokenTree>, sign| matches!(token, Some(TokenTree::Punct(punct)) if punct.as_char() == sign);
    if !is_punct(tokens.first(), '#') {
        return None;
    }
    let inner = usize::from(is_punct(tokens.get(1), '!'));
    let Some(TokenTree::Group(group)) = tokens.get(1 + inner) else { return None };
    let first = group.stream().into_iter().next();
    matches!(first, Some(TokenTree::Ident(ident)) if ident == "doc").then_some(2 + inner)
}

/// Takes the marks of `#[cfg(test)]` items away, and names those that are files.
fn exclude_tests(items: &[syn::Item], has_code: &mut [bool], modules: &mut Vec<String>) {
    for item in items {
        let Some(attributes) = attributes(item) else { continue };
        if attributes.iter().any(is_for_tests) {
            let first = attributes.iter().map(|attribute| attribute.span().start().line).min();
            let first = first.unwrap_or_else(|| item.span().start().line);
            (first..=item.span().end().line).for_each(|line| has_code[line - 1] = false);
            if let syn::Item::Mod(syn::ItemMod { content: None, ident, .. }) = item {
                modules.push(ident.to_string());
            }
        } else if let syn::Item::Mod(syn::ItemMod { content: Some((_, items)), .. }) = item {
            exclude_tests(items, has_code, modules);
        }
    }
}

fn is_for_tests(attribute: &syn::Attribute) -> bool {
    let syn::Meta::List(list) = &attribute.meta else { return false };
    list.path.is_ident("cfg") && list.tokens.to_string() == "test"
}

fn attributes(item: &syn::Item) -> Option<&[syn::Attribute]> {
    Some(match item {
        syn::Item::Const(item) => &item.attrs,
        syn::Item::Enum(item) => &item.attrs,
        syn::Item::ExternCrate(item) => &item.attrs,
        syn::Item::Fn(item) => &item.attrs,
        syn::Item::Impl(item) => &item.attrs,
        syn::Item::Macro(item) => &item.attrs,
        syn::Item::Mod(item) => &item.attrs,
        syn::Item::Static(item) => &item.attrs,
        syn::Item::Struct(item) => &item.attrs,
        syn::Item::Trait(item) => &item.attrs,
        syn::Item::Type(item) => &item.attrs,
        syn::Item::Use(item) => &item.attrs,
        _ => return None,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn comments_documentation_blanks_and_tests_do_not_count() {
        let text = "//! A crate.\n\n/// A function.\n#[inline]\nfn f() -> u32 {\n    // Two.\n    2 // two\n}\n\n#[cfg(test)]\nmod tests {\n    fn g() {}\n}\n\n#[cfg(test)]\nmod more;\n\nmod other {\n    #[cfg(test)]\n    use super::f;\n    #[cfg(not(test))]\n    use super::f;\n}\n";
        let counted = of_text(text).unwrap();
        // `#[inline]`, the function's three lines, and four lines of `other`.
        assert_eq!(counted, Counted { lines: 8, test_modules: vec!["more".into()] });
    }

    #[test]
    fn a_text_of_several_lines_counts_whole() {
        let counted = of_text("const A: &str = \"one\n\ntwo\";\n").unwrap();
        assert_eq!(counted.lines, 3);
    }

    #[test]
    fn modules_are_beside_or_below_their_file() {
        assert_eq!(beside(Path::new("src/lib.rs")), Path::new("src/"));
        assert_eq!(beside(Path::new("src/a/mod.rs")), Path::new("src/a/"));
        assert_eq!(beside(Path::new("src/a/b.rs")), Path::new("src/a/b"));
    }
}
