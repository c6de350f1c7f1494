//! Imports between the modules of each crate, read from the sources: circles are not allowed.
//!
//! An import is a path that starts with `crate`, `super`, `self`, a child module or an imported name, in a `use` or in
//! an expression. It counts for the module that defines the item, not for one that re-exports it. In every folder,
//! whole files and folders are compared. A file and the folder of its name (`motion.rs`, `motion/`) are one layer.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::Path;

/// Path from the crate root to a module or item.
type Name = Vec<String>;
type Sources = BTreeMap<Name, String>;
/// For each folder: which child imports which, and the places.
type Imports = BTreeMap<Name, BTreeMap<String, BTreeMap<String, BTreeSet<String>>>>;

/// Limit on the length of a chain of re-exports.
const PASSED_ON: usize = 16;

#[test]
fn unit_imports_run_in_no_circle() {
    let crates = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    let mut found = Vec::new();
    let mut read = 0;
    for folder in fs::read_dir(crates).unwrap() {
        let folder = folder.unwrap();
        let source = folder.path().join("src");
        if !source.is_dir() {
            continue;
        }
        let sources = sources_in(&source);
        read += sources.len();
        for (parent, children, lines) in circles(&imports(&sources)) {
            let name = folder.file_name().into_string().unwrap();
            found.push((name, parent, children, lines));
        }
    }
    assert!(read > 400, "only {read} modules found");
    let mut message = String::new();
    for (name, folder, members, lines) in &found {
        message += &format!("{name} {folder}: {members:?}\n{}\n", lines.join("\n"));
    }
    assert!(
        message.is_empty(),
        "modules import each other in a circle:\n{message}"
    );
}

#[test]
fn unit_a_planted_circle_is_found() {
    let text = [
        ("", "mod a; mod b; mod c; pub use b::Shown;"),
        (
            "a",
            "use crate::{c::{self, Held}, b::deep::Thing};\nfn f() { super::b::g() } // crate::d::x",
        ),
        (
            "b",
            "mod deep; pub use deep::Thing; const TEXT: &str = \"crate::a::f\";",
        ),
        ("b::deep", "use super::Own; pub struct Thing;"),
        ("c", "fn h() -> crate::Shown { todo!() }"),
    ];
    let mut sources: Sources = text.iter().map(|(m, t)| (name(m), plain(t))).collect();
    assert!(circles(&imports(&sources)).is_empty());
    sources.insert(
        name("b::deep"),
        plain("use crate::c as x;\nfn f() { x::h() }"),
    );
    let found = circles(&imports(&sources));
    assert_eq!(found.len(), 1);
    assert_eq!(
        (found[0].0.as_str(), found[0].1.join(" ")),
        ("", "b c".into())
    );
    assert!(
        found[0].2.contains(&"  b -> c: b::deep 1 -> c".to_owned()),
        "{:?}",
        found[0].2
    );
}

fn name(text: &str) -> Name {
    text.split("::")
        .filter(|part| !part.is_empty())
        .map(str::to_owned)
        .collect()
}

/// The modules below a `src`, without tests.
fn sources_in(folder: &Path) -> Sources {
    let mut sources = Sources::new();
    let mut tests = Vec::new();
    let mut folders = vec![(folder.to_path_buf(), Name::new())];
    while let Some((folder, inside)) = folders.pop() {
        for entry in fs::read_dir(folder).unwrap() {
            let path = entry.unwrap().path();
            let mut module = inside.clone();
            let stem = path.file_stem().unwrap().to_str().unwrap();
            if !["lib", "main", "mod"].contains(&stem) {
                module.push(stem.to_owned());
            }
            if path.is_dir() {
                folders.push((path, module));
            } else if path.extension().is_some_and(|end| end == "rs") {
                let text = without_tests(&fs::read_to_string(&path).unwrap(), &module, &mut tests);
                sources.insert(module, plain(&text));
            }
        }
    }
    sources.retain(|module, _| !tests.iter().any(|test| module.starts_with(test)));
    sources
}

/// The text before `#[cfg(test)] mod name {`; test modules in separate files are added to `tests`.
fn without_tests(text: &str, module: &Name, tests: &mut Vec<Name>) -> String {
    let mut kept = String::new();
    let mut is_test = false;
    for line in text.lines() {
        let words: Vec<_> = line.split_whitespace().collect();
        if let Some(at) = words
            .iter()
            .position(|word| *word == "mod")
            .filter(|_| is_test)
        {
            match words[at + 1].strip_suffix(';') {
                Some(name) => tests.push([module.as_slice(), &[name.to_owned()]].concat()),
                None => break,
            }
        }
        is_test = line == "#[cfg(test)]" || is_test && line.starts_with("#[");
        kept.push_str(line);
        kept.push('\n');
    }
    kept
}

/// The source without comments, strings and characters; lines are kept.
fn plain(source: &str) -> String {
    let mut kept = String::new();
    let mut rest = source;
    while let Some(first) = rest.chars().next() {
        let upto = |mark: &str, from: usize| {
            let found = rest.get(from..).and_then(|after| after.find(mark));
            found.map_or(rest.len(), |at| from + at + mark.len())
        };
        let hashes = rest[1..].len() - rest[1..].trim_start_matches('#').len();
        let in_word = kept.ends_with(|c: char| c.is_alphanumeric() || c == '_');
        let length = if rest.starts_with("//") {
            upto("\n", 0) - 1
        } else if rest.starts_with("/*") {
            upto("*/", 2)
        } else if first == 'r' && !in_word && rest[1 + hashes..].starts_with('"') {
            upto(&format!("\"{}", "#".repeat(hashes)), 2 + hashes)
        } else if first == '"' {
            end_of_text(rest)
        } else if rest.starts_with("'\\") {
            upto("'", 3)
        } else if first == '\'' && rest.chars().nth(2) == Some('\'') {
            upto("'", 2)
        } else {
            kept.push(first);
            rest = &rest[first.len_utf8()..];
            continue;
        };
        kept.push(' ');
        kept.extend(rest[..length].chars().filter(|c| *c == '\n'));
        rest = &rest[length..];
    }
    kept
}

/// Position after the closing quote of a string.
fn end_of_text(text: &str) -> usize {
    let mut is_escaped = false;
    for (at, c) in text.char_indices().skip(1) {
        if c == '"' && !is_escaped {
            return at + 1;
        }
        is_escaped = c == '\\' && !is_escaped;
    }
    text.len()
}

/// A path as written, with its line.
struct Written {
    path: Name,
    line: usize,
}

/// Paths and imported names of a module.
#[derive(Default)]
struct Named {
    paths: Vec<Written>,
    brought: BTreeMap<String, Vec<Name>>,
}

type Token<'a> = (&'a str, usize);

fn tokens(text: &str) -> Vec<Token<'_>> {
    let mut found = Vec::new();
    for (line, text) in text.lines().enumerate() {
        let mut rest = text.trim_start();
        while let Some(first) = rest.chars().next() {
            let word = rest
                .find(|c: char| !c.is_alphanumeric() && c != '_')
                .unwrap_or(rest.len());
            let length = match word {
                0 if rest.starts_with("::") => 2,
                0 => first.len_utf8(),
                word => word,
            };
            found.push((&rest[..length], line + 1));
            rest = rest[length..].trim_start();
        }
    }
    found
}

fn is_name(token: &str) -> bool {
    token.starts_with(|c: char| c.is_alphabetic() || c == '_')
}

fn named_in(text: &str) -> Named {
    let tokens = tokens(text);
    let token = |at: usize| tokens.get(at).map_or("", |token| token.0);
    let mut named = Named::default();
    let mut at = 0;
    while at < tokens.len() {
        if token(at) == "use" {
            at = brought(&tokens, at + 1, &Name::new(), &mut named);
        } else if is_name(token(at)) && token(at + 1) == "::" && (at == 0 || token(at - 1) != "::")
        {
            let line = tokens[at].1;
            let mut path = vec![token(at).to_owned()];
            while token(at + 1) == "::" && is_name(token(at + 2)) {
                path.push(token(at + 2).to_owned());
                at += 2;
            }
            named.paths.push(Written { path, line });
            at += 1;
        } else {
            at += 1;
        }
    }
    named
}

/// One branch of a `use` tree; returns its end.
fn brought(tokens: &[Token<'_>], mut at: usize, before: &Name, named: &mut Named) -> usize {
    let token = |at: usize| tokens.get(at).map_or("", |token| token.0);
    if token(at) == "{" {
        at += 1;
        while !["}", ""].contains(&token(at)) {
            at = brought(tokens, at, before, named);
            at += usize::from(token(at) == ",");
        }
        return at + 1;
    }
    if !is_name(token(at)) {
        return at + 1;
    }
    let mut path = before.clone();
    if token(at) != "self" || before.is_empty() {
        path.push(token(at).to_owned());
    }
    if token(at + 1) == "::" {
        if token(at + 2) == "*" {
            named.paths.push(Written {
                path,
                line: tokens[at].1,
            });
            return at + 3;
        }
        return brought(tokens, at + 2, &path, named);
    }
    let line = tokens[at].1;
    let renamed = token(at + 1) == "as";
    let shown = if renamed {
        token(at + 2)
    } else {
        path.last().map_or("", String::as_str)
    };
    named
        .brought
        .entry(shown.to_owned())
        .or_default()
        .push(path.clone());
    named.paths.push(Written { path, line });
    at + 1 + 2 * usize::from(renamed)
}

/// The module that defines `path` seen from `module`, and whether the path ends at an item.
fn defined_in(
    all: &BTreeMap<Name, Named>,
    module: &Name,
    path: &[String],
    depth: usize,
) -> Option<(Name, bool)> {
    let first = path.first().filter(|_| depth < PASSED_ON)?;
    let child = [module.as_slice(), std::slice::from_ref(first)].concat();
    let is_known = ["crate", "self", "super"].contains(&first.as_str())
        || all.contains_key(&child)
        || all.get(module)?.brought.contains_key(first);
    if !is_known {
        return None;
    }
    let mut at = module.clone();
    for (done, part) in path.iter().enumerate() {
        let child = [at.as_slice(), std::slice::from_ref(part)].concat();
        match part.as_str() {
            "crate" => at.clear(),
            "self" => {}
            "super" => drop(at.pop()),
            _ if all.contains_key(&child) => at = child,
            _ => {
                let brought = all.get(&at)?.brought.get(part).into_iter().flatten();
                let mut found = brought.filter_map(|path| defined_in(all, &at, path, depth + 1));
                return match found.next() {
                    Some((module, true)) => Some((module, true)),
                    Some((module, false)) => {
                        let rest = [&["self".to_owned()], &path[done + 1..]].concat();
                        defined_in(all, &module, &rest, depth + 1)
                    }
                    None => Some((at, true)),
                };
            }
        }
    }
    Some((at, false))
}

fn imports(sources: &Sources) -> Imports {
    let all: BTreeMap<_, _> = sources
        .iter()
        .map(|(m, text)| (m.clone(), named_in(text)))
        .collect();
    let mut imports = Imports::new();
    for (module, named) in &all {
        for Written { path, line } in &named.paths {
            let Some((target, _)) = defined_in(&all, module, path, 0) else {
                continue;
            };
            let shared = module
                .iter()
                .zip(&target)
                .take_while(|(a, b)| a == b)
                .count();
            if shared < module.len().min(target.len()) {
                let place = format!("{} {line} -> {}", module.join("::"), target.join("::"));
                let folder = imports.entry(module[..shared].to_vec()).or_default();
                let from = folder.entry(module[shared].clone()).or_default();
                from.entry(target[shared].clone())
                    .or_default()
                    .insert(place);
            }
        }
    }
    imports
}

/// Each circle: folder, members, and the imports between them.
fn circles(imports: &Imports) -> Vec<(String, Vec<String>, Vec<String>)> {
    let mut found = Vec::new();
    for (folder, edges) in imports {
        let reach: BTreeMap<_, _> = edges
            .keys()
            .map(|from| (from, reached(edges, from)))
            .collect();
        let mut seen = BTreeSet::new();
        for from in edges.keys().filter(|from| reach[from].contains(*from)) {
            let both = |to: &&String| reach.get(*to).is_some_and(|back| back.contains(from));
            let members: Vec<_> = reach[from].iter().filter(both).cloned().collect();
            if !seen.insert(members.clone()) {
                continue;
            }
            let mut lines = Vec::new();
            for a in &members {
                for (b, places) in edges[a].iter().filter(|(b, _)| members.contains(b)) {
                    lines.extend(places.iter().map(|place| format!("  {a} -> {b}: {place}")));
                }
            }
            found.push((folder.join("::"), members, lines));
        }
    }
    found
}

/// All children reachable from one along imports.
fn reached(
    edges: &BTreeMap<String, BTreeMap<String, BTreeSet<String>>>,
    from: &str,
) -> BTreeSet<String> {
    let mut reached = BTreeSet::new();
    let mut next = vec![from.to_owned()];
    while let Some(child) = next.pop() {
        for to in edges.get(&child).into_iter().flat_map(BTreeMap::keys) {
            if reached.insert(to.clone()) {
                next.push(to.clone());
            }
        }
    }
    reached
}
