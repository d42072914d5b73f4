//! `rpic doc`: generates the HTML reference of a project.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

use rpi_diag::Format;
use rpi_doc::{Module, Site};
use rpi_driver::{
    DiskLoader, FileLoader, Inspection, Project, inspect, library_modules, library_text,
};

use crate::args::DocArgs;
use crate::check::{has_errors, print_diagnostics};
use crate::outcome::{CommandResult, Exit};

/// Introduction of the reference of the standard library, in Markdown.
const LIBRARY: &str = "Fragments, nodes and device types that come with the language. `use filters;` brings in a module; \
                       `math` and `geometry` are always available.";

/// Carries out `rpic doc`: checks the modules, writes the pages of the reference and prints the path of the start page.
pub(crate) fn doc(args: &DocArgs) -> CommandResult {
    let (title, about, own) = match args.std {
        true => ("Standard library".to_owned(), LIBRARY.to_owned(), library()),
        false => {
            let project = Project::open(&args.path)?;
            let modules = programs(&project)?;
            (project.name, project.description, modules)
        }
    };
    let mut faulty = false;
    for module in &own {
        print_diagnostics(
            Format::Human,
            &module.inspected.diagnostics,
            &module.inspected.sources,
        )?;
        faulty |= has_errors(&module.inspected.diagnostics);
    }
    let modules = add_used_library_modules(own);
    let site = Site::new(&title, &about, &modules);
    write(&args.out, &site)?;
    let index = args.out.join("index.html");
    let pages = rpi_diag::with_noun(modules.len() + 1, "page");
    rpi_diag::println_stderr!("wrote {pages}: {}", index.display());
    if args.open {
        open(&index)?;
    }
    Ok(if faulty {
        Exit::ErrorsReported
    } else {
        Exit::Success
    })
}

/// Reads and checks all programs of a project, and returns them as modules of the reference.
fn programs(project: &Project) -> Result<Vec<Module>, Box<dyn std::error::Error>> {
    let mut modules = Vec::new();
    for path in &project.files {
        let input = rpi_driver::read(path)?;
        let below = path.strip_prefix(&project.root).unwrap_or(path);
        let name = below
            .with_extension("")
            .to_string_lossy()
            .replace('\\', "/");
        modules.push(Module {
            name,
            is_library: false,
            inspected: inspect(path, input.text()?, &DiskLoader),
        });
    }
    Ok(modules)
}

/// File loader that finds no files, so that no file on disk can replace a module of the standard library.
struct NoFiles;

impl FileLoader for NoFiles {
    fn text(&self, _: &Path) -> Option<String> {
        None
    }
}

fn library() -> Vec<Module> {
    library_modules().filter_map(library_module).collect()
}

fn library_module(name: &str) -> Option<Module> {
    let path = PathBuf::from(format!("stdlib/{name}.rpi"));
    Some(Module {
        name: name.to_owned(),
        is_library: true,
        inspected: inspect(&path, library_text(name)?, &NoFiles),
    })
}

/// Returns `modules` and the modules of the standard library that they use, so that links to these have a target.
fn add_used_library_modules(mut modules: Vec<Module>) -> Vec<Module> {
    let sources = |seen: &Inspection| {
        let all = seen
            .sources
            .files()
            .map(|file| seen.sources.name(file).to_owned());
        all.collect::<Vec<_>>()
    };
    let there: BTreeSet<String> = modules
        .iter()
        .flat_map(|m| sources(&m.inspected).into_iter().take(1))
        .collect();
    let used: BTreeSet<String> = modules.iter().flat_map(|m| sources(&m.inspected)).collect();
    let missing = library_modules().filter(|name| {
        let path = format!("stdlib/{name}.rpi");
        used.contains(&path) && !there.contains(&path)
    });
    let missing: Vec<Module> = missing.filter_map(library_module).collect();
    modules.extend(missing);
    modules
}

fn write(folder: &Path, site: &Site) -> Result<(), String> {
    for (name, text) in &site.files {
        let path = folder.join(name);
        let parent = path.parent().unwrap_or(folder);
        let written = std::fs::create_dir_all(parent).and_then(|()| std::fs::write(&path, text));
        written.map_err(|e| format!("{}: {e}", path.display()))?;
    }
    Ok(())
}

/// Names of the programs that open a file in the browser on the current operating system; the first that starts is
/// used.
const OPENERS: &[&str] = if cfg!(target_os = "macos") {
    &["open"]
} else if cfg!(windows) {
    &["explorer"]
} else {
    &["xdg-open"]
};

fn open(page: &Path) -> Result<(), String> {
    let opened = OPENERS.iter().any(|opener| {
        let started = std::process::Command::new(opener).arg(page).spawn();
        started.is_ok()
    });
    match opened {
        true => Ok(()),
        false => Err(format!(
            "cannot open the page: {} not found",
            OPENERS.join(", ")
        )),
    }
}
