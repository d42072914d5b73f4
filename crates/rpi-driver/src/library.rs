//! Standard library, which is embedded in the compiler.

use std::collections::{BTreeMap, BTreeSet};
use std::sync::OnceLock;

use rpi_diag::FileId;
use rpi_sema::program::{Program, Source};
use rpi_syntax::{Dialect, Name, parse};

/// Module of the standard library: its name and its source text.
pub(crate) struct Library {
    /// Name of the module.
    pub(crate) name: &'static str,
    /// Source text of the module.
    pub(crate) text: &'static str,
    /// Whether every program imports the module without a `use`.
    pub(crate) implicit: bool,
}

macro_rules! library {
    ($name:literal, $implicit:literal) => {
        Library {
            name: $name,
            text: include_str!(concat!("../../../stdlib/", $name, ".rpi")),
            implicit: $implicit,
        }
    };
}

/// Modules of the standard library. A test checks that every file of the library is listed.
pub(crate) const LIBRARY: &[Library] = &[
    library!("commands", false),
    library!("control", false),
    library!("devices", false),
    library!("filters", false),
    library!("geometry", true),
    library!("io", false),
    library!("logic", false),
    library!("math", true),
    library!("motion", false),
    library!("process", false),
    library!("timers", false),
];

/// Returns the path by which messages refer to the module of the standard library with this name.
pub(crate) fn library_path(name: &str) -> String {
    format!("stdlib/{name}.rpi")
}

/// Returns whether a path in messages refers to a module of the standard library.
pub(crate) fn is_library_path(path: &str) -> bool {
    let name = path.strip_prefix("stdlib/");
    let name = name.and_then(|name| name.strip_suffix(".rpi"));
    name.is_some_and(|name| library_text(name).is_some())
}

/// Returns the source text of the module of the standard library with this name; `None` if there is none.
#[must_use]
pub fn library_text(name: &str) -> Option<&'static str> {
    let found = LIBRARY.iter().find(|library| library.name == name);
    found.map(|library| library.text)
}

/// Access of the checker to the names in the standard library, for suggestions about missing imports.
pub(crate) const LIBRARY_NAMES: rpi_sema::program::Library = rpi_sema::program::Library {
    modules: || library_modules().collect(),
    declaring: declaring_module,
};

/// Returns the module of the standard library that declares a name, among the modules that are not imported implicitly;
/// `None` if no module does.
fn declaring_module(name: &str) -> Option<&'static str> {
    static NAMES: OnceLock<BTreeMap<String, &'static str>> = OnceLock::new();
    NAMES.get_or_init(library_names).get(name).copied()
}

/// Returns the names that the modules declare that every program imports implicitly.
pub(crate) fn implicit_names() -> &'static BTreeSet<String> {
    static NAMES: OnceLock<BTreeSet<String>> = OnceLock::new();
    NAMES.get_or_init(|| {
        names_where(|library| library.implicit)
            .into_keys()
            .collect()
    })
}

/// Returns every name that a module of the standard library declares, with the module. Only modules that are not
/// imported implicitly count.
fn library_names() -> BTreeMap<String, &'static str> {
    names_where(|library| !library.implicit)
}

/// Returns every name that one of the modules `of` of the standard library declares, with the module.
fn names_where(of: fn(&Library) -> bool) -> BTreeMap<String, &'static str> {
    let mut names = BTreeMap::new();
    for library in LIBRARY.iter().filter(|library| of(library)) {
        let file = parse(FileId(0), library.text, Dialect::Rpi).file;
        let source = Source {
            name: Name::from(library.name),
            mode: Dialect::Rpi,
            files: vec![&file],
            implicit: false,
        };
        let (program, _) = Program::collect(&[source]);
        for decl in &program.decls {
            names.entry(decl.name.to_string()).or_insert(library.name);
        }
    }
    names
}

/// Returns the names of the modules of the standard library.
pub fn library_modules() -> impl Iterator<Item = &'static str> {
    LIBRARY.iter().map(|library| library.name)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_file_of_the_library_is_listed() {
        let root = rpi_testkit::workspace_root();
        let mut files: Vec<String> = std::fs::read_dir(root.join("stdlib"))
            .unwrap()
            .filter_map(|entry| {
                let name = entry.unwrap().file_name().to_string_lossy().into_owned();
                name.strip_suffix(".rpi").map(str::to_owned)
            })
            .collect();
        files.sort();
        assert_eq!(files, library_modules().collect::<Vec<_>>());
    }
}
