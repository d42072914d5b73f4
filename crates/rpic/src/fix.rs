//! `rpic check --fix`: applies the fixes that are certain.
//!
//! Each round applies the fixes that do not overlap and compiles again, because one error may hide another. A file is
//! replaced atomically, so that a concurrent reader sees either the old or the new text.

use std::fs;
use std::path::Path;

use rpi_diag::{Edit, FileId, Fix, SourceMap, apply, sure_fixes};
use rpi_driver::Compiled;

use crate::check::compile;
use crate::outcome::file_equals;

/// Maximum number of rounds of fixes, each followed by a compilation. Fixes that are offered after that do not
/// converge.
const ROUNDS: usize = 10;

type BoxError = Box<dyn std::error::Error>;

/// Fixes a program and the files that it uses, prints the applied fixes, and returns the result of the last
/// compilation.
pub(crate) fn fix_file(path: &Path, with_summaries: bool) -> Result<Compiled, BoxError> {
    let mut compiled = compile(path, with_summaries)?;
    for _ in 0..ROUNDS {
        if !apply_round(&compiled)? {
            break;
        }
        compiled = compile(path, with_summaries)?;
    }
    Ok(compiled)
}

/// Applies the sure fixes of a compilation that do not overlap, and writes the changed files. Returns false if there
/// was nothing to fix.
fn apply_round(compiled: &Compiled) -> Result<bool, BoxError> {
    let sources = &compiled.sources;
    let on_disk = |fix: &&Fix| {
        fix.edits
            .iter()
            .all(|edit| is_on_disk(sources, edit.span.file))
    };
    let fixes: Vec<&Fix> = sure_fixes(&compiled.diagnostics)
        .into_iter()
        .filter(on_disk)
        .collect();
    let mut written = Vec::new();
    for file in sources.files() {
        let edits: Vec<&Edit> = fixes
            .iter()
            .flat_map(|fix| &fix.edits)
            .filter(|edit| edit.span.file == file)
            .collect();
        if !edits.is_empty() {
            let path = Path::new(sources.name(file));
            let text = apply(sources.text(file), edits.into_iter());
            written.push((path, write_beside(path, &text)?));
        }
    }
    // All new files exist before the first one replaces its original, so a failed write changes nothing.
    for (path, new) in &written {
        fs::rename(new, path).map_err(|e| format!("{}: {e}", path.display()))?;
    }
    print_fixes(&fixes, sources);
    Ok(!written.is_empty())
}

/// Returns whether the text of a source is the content of a file on disk. The standard library is not: it is embedded
/// in the compiler and cannot be fixed.
fn is_on_disk(sources: &SourceMap, file: FileId) -> bool {
    file_equals(Path::new(sources.name(file)), sources.text(file))
}

/// Writes the new text of the file `path` to a temporary file in the same folder, with the same permissions. Returns
/// the path of the temporary file.
fn write_beside(path: &Path, text: &str) -> Result<std::path::PathBuf, BoxError> {
    // In the same folder, because a rename is atomic only within a file system.
    let mut name = path.file_name().unwrap_or_default().to_owned();
    name.push(".mending");
    let new = path.with_file_name(name);
    let written = fs::write(&new, text).and_then(|()| {
        let permissions = fs::metadata(path)?.permissions();
        fs::set_permissions(&new, permissions)
    });
    written.map_err(|e| format!("{}: {e}", new.display()))?;
    Ok(new)
}

/// Prints one line for each applied fix.
fn print_fixes(fixes: &[&Fix], sources: &SourceMap) {
    for fix in fixes {
        if let Some(edit) = fix.edits.first() {
            let name = sources.name(edit.span.file);
            let at = sources.line_col(edit.span);
            rpi_diag::println_stderr!("{name}:{at}: fixed: {}", fix.title);
        }
    }
}
