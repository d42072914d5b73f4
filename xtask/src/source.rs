//! Files of the project, and the functions in Rust source texts, found by the layout of rustfmt.

use std::path::{Path, PathBuf};
use std::process::Command;

use rpi_testkit::{files_below, workspace_root};

use crate::packages::packages;

/// Returns the paths of all files that git tracks or would track, relative to the root of the workspace and sorted.
/// Without git (in an unpacked archive), returns every file that is not build output.
pub fn tracked_files() -> Vec<PathBuf> {
    let listed = Command::new("git")
        .args(["ls-files", "--cached", "--others", "--exclude-standard"])
        .current_dir(workspace_root())
        .output();
    let mut files: Vec<PathBuf> = match listed {
        Ok(output) if output.status.success() => String::from_utf8_lossy(&output.stdout)
            .lines()
            .map(PathBuf::from)
            .collect(),
        _ => files_below("", &[""])
            .iter()
            .filter_map(|path| relative(path))
            .collect(),
    };
    files.retain(|path| workspace_root().join(path).is_file());
    files.sort();
    files
}

/// Rust source file of the product, with its crate.
#[derive(Clone, Debug)]
pub struct SourceFile {
    /// Path relative to the root of the workspace.
    pub path: PathBuf,
    /// Name of the crate that contains the file.
    pub owner: String,
    /// Content of the file.
    pub text: String,
}

impl SourceFile {
    fn read(path: PathBuf, owner: &str) -> Option<SourceFile> {
        let text = std::fs::read_to_string(workspace_root().join(&path)).ok()?;
        let of_tests = path
            .iter()
            .any(|part| part == "tests" || part == "tests.rs");
        let owner = owner.to_owned();
        (!of_tests).then_some(SourceFile { path, owner, text })
    }

    /// Returns the text before the module of unit tests, which is always at the end of a file.
    pub fn without_tests(&self) -> &str {
        without_tests(&self.text)
    }
}

/// Returns the Rust files in the folders `src` of all crates of the workspace, without files of unit tests, sorted by
/// path.
pub fn source_files() -> Vec<SourceFile> {
    let mut files = Vec::new();
    for package in packages() {
        let folder = relative(&package.dir).unwrap_or_default().join("src");
        let paths = files_below(&folder.to_string_lossy(), &[".rs"]);
        let paths = paths.iter().filter_map(|path| relative(path));
        files.extend(paths.filter_map(|path| SourceFile::read(path, &package.name)));
    }
    files.sort_by(|a, b| a.path.cmp(&b.path));
    files
}

fn relative(path: &Path) -> Option<PathBuf> {
    path.strip_prefix(workspace_root()).ok().map(Into::into)
}

fn without_tests(text: &str) -> &str {
    text.find("#[cfg(test)]\nmod tests {")
        .map_or(text, |at| &text[..at])
}

/// Function in a Rust source text, with its size.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct Function<'a> {
    /// Name of the function.
    pub name: &'a str,
    /// Number of the line with the `fn` of the function, from 1.
    pub line: usize,
    /// Number of lines from the `fn` to the closing brace, both included.
    pub lines: usize,
    /// Number of lines from the opening brace to the closing brace, both included: the lines that a reader must follow.
    /// The lines of the signature do not count, because parameters with long names make a function easier to read.
    pub body_lines: usize,
}

/// Returns the functions with bodies in a text that rustfmt has formatted, including nested functions, in the order of
/// their lines.
pub fn functions(text: &str) -> Vec<Function<'_>> {
    let lines: Vec<&str> = text.lines().collect();
    let starts = lines
        .iter()
        .enumerate()
        .filter_map(|(at, line)| Some((at, function_name(line)?)));
    starts
        .filter_map(|(at, name)| {
            let end = body_end_line(&lines[at..])?;
            let mut own = lines[at..=at + end].iter();
            let signature = own.position(|line| line.ends_with('{')).unwrap_or(0);
            Some(Function {
                name,
                line: at + 1,
                lines: end + 1,
                body_lines: end + 1 - signature,
            })
        })
        .collect()
}

/// Returns the name of the function that a line declares (qualifiers, then `fn`); `None` for other lines.
fn function_name(line: &str) -> Option<&str> {
    let mut words = line.trim_start();
    while let Some((word, rest)) = words.split_once(' ') {
        match word {
            "fn" => return Some(&rest[..rest.find(['(', '<'])?]),
            "pub" | "pub(crate)" | "pub(super)" | "const" | "async" | "unsafe" | "extern" => {
                words = rest
            }
            _ => return None,
        }
    }
    None
}

/// Returns the index of the line that closes the body of the function declared in the first line: the next line with
/// the same indentation that is a closing brace. Returns `None` for a declaration without a body.
fn body_end_line(lines: &[&str]) -> Option<usize> {
    let first = lines.first()?;
    if first.ends_with('}') {
        return Some(0);
    }
    if first.ends_with(';') {
        return None;
    }
    let indent = first.len() - first.trim_start().len();
    let same =
        |line: &&str| line.len() - line.trim_start().len() == indent && !line.trim().is_empty();
    let mut rest = lines
        .iter()
        .enumerate()
        .skip(1)
        .filter(|(_, line)| same(line));
    let (at, line) = rest.find(|(_, line)| line.trim() == "}" || line.trim_end().ends_with(';'))?;
    (line.trim() == "}").then_some(at)
}

#[cfg(test)]
mod tests {
    use super::*;

    const TEXT: &str = "\
/// Docs.
pub const fn short() -> u8 { 1 }

trait T {
    fn declared(
        &self,
    ) -> u8;
    fn provided<'a>(&self, x: &'a str) -> u8
    where
        Self: Sized,
    {
        if x.is_empty() {
            return 1;
        }
        2
    }
}

fn outer() {
    fn inner() {
        call();
    }
}
";

    #[test]
    fn functions_are_measured_from_fn_to_brace() {
        let found: Vec<(&str, usize, usize)> = functions(TEXT)
            .iter()
            .map(|f| (f.name, f.line, f.lines))
            .collect();
        assert_eq!(
            found,
            [
                ("short", 2, 1),
                ("provided", 8, 9),
                ("outer", 19, 5),
                ("inner", 20, 3)
            ]
        );
    }

    #[test]
    fn unit_tests_are_left_out() {
        assert_eq!(
            without_tests("fn a() {}\n#[cfg(test)]\nmod tests {\n}\n"),
            "fn a() {}\n"
        );
        assert_eq!(without_tests("fn a() {}\n"), "fn a() {}\n");
    }
}
