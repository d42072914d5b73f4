//! `rpic check --fix`: applies the fixes that are sure.
//!
//! Each round takes the fixes that do not touch each other and looks again, as one fault may hide another. A file
//! changes from its old text to its new one at once: whoever reads it meanwhile sees the one or the other.

use std::fs;
use std::path::Path;

use rpi_diag::{Edit, FileId, Fix, SourceMap, apply, sure_fixes};
use rpi_driver::Compiled;

use crate::check::compile;
use crate::outcome::holds;

/// Rounds at most: what still has sure fixes then mends nothing.
const ROUNDS: usize = 10;

type Failure = Box<dyn std::error::Error>;

/// Mends a file and those of its project that it uses, tells what was done, and checks what is left.
pub(crate) fn mend(path: &Path, told: bool) -> Result<Compiled, Failure> {
    let mut compiled = compile(path, told)?;
    for _ in 0..ROUNDS {
        if !round(&compiled)? {
            break;
        }
        compiled = compile(path, told)?;
    }
    Ok(compiled)
}

/// Applies what can be applied together; false if there was nothing.
fn round(compiled: &Compiled) -> Result<bool, Failure> {
    let sources = &compiled.sources;
    let on_disk = |fix: &&Fix| {
        fix.edits
            .iter()
            .all(|edit| is_on_disk(sources, edit.span.file))
    };
    let fixes: Vec<&Fix> = sure_fixes(&compiled.findings)
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
    for (path, new) in &written {
        fs::rename(new, path).map_err(|e| format!("{}: {e}", path.display()))?;
    }
    tell(&fixes, sources);
    Ok(!written.is_empty())
}

/// Whether a text is that of a file; the standard library is part of the compiler.
fn is_on_disk(sources: &SourceMap, file: FileId) -> bool {
    holds(Path::new(sources.name(file)), sources.text(file))
}

/// Writes the new text beside the old one, with its permissions.
fn write_beside(path: &Path, text: &str) -> Result<std::path::PathBuf, Failure> {
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

/// One line for each fix.
fn tell(fixes: &[&Fix], sources: &SourceMap) {
    for fix in fixes {
        if let Some(edit) = fix.edits.first() {
            let name = sources.name(edit.span.file);
            let at = sources.line_col(edit.span);
            rpi_diag::tell_line!("{name}:{at}: fixed: {}", fix.title);
        }
    }
}
