//! Projects: a folder of programs, optionally described by `rpi.toml`.
//!
//! ```toml
//! name = "pick cell"
//! description = "Two arms and a belt."
//! sources = ["src"]     # folders or files; default: everything below the folder
//! ```

use std::path::{Path, PathBuf};

use serde::Deserialize;

use crate::input::{InputError, InputKind};

/// File name of the project description.
pub const MANIFEST: &str = "rpi.toml";

/// Project: a folder of programs with an optional `rpi.toml`.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct Project {
    /// Name of the project: that in `rpi.toml`, otherwise that of the folder or file.
    pub name: String,
    /// Description of the project in Markdown; empty if there is none.
    pub description: String,
    /// Folder of the project.
    pub root: PathBuf,
    /// Paths of the programs of the project, sorted.
    pub files: Vec<PathBuf>,
}

/// Content of `rpi.toml`, the file that describes a project.
#[derive(Deserialize, Default)]
#[serde(deny_unknown_fields)]
struct Manifest {
    name: Option<String>,
    #[serde(default)]
    description: String,
    sources: Option<Vec<PathBuf>>,
}

impl Project {
    /// Opens a project by its folder, its `rpi.toml`, or a single program.
    ///
    /// # Errors
    /// If the path does not exist, `rpi.toml` is invalid, or there is no program.
    pub fn open(path: &Path) -> Result<Project, InputError> {
        if path.is_dir() {
            return Project::folder(path);
        }
        if path.file_name().is_some_and(|name| name == MANIFEST) {
            let parent = path.parent().filter(|p| !p.as_os_str().is_empty());
            return Project::folder(parent.unwrap_or(Path::new(".")));
        }
        let input = crate::input::read(path)?;
        match input.kind {
            InputKind::Rpi | InputKind::Lustre => Ok(Project {
                name: input.stem(),
                description: String::new(),
                root: path.parent().unwrap_or(Path::new("")).to_owned(),
                files: vec![path.to_owned()],
            }),
            _ => Err(InputError::new(path, "not a program (.rpi, .lus)")),
        }
    }

    fn folder(root: &Path) -> Result<Project, InputError> {
        let manifest = manifest(&root.join(MANIFEST))?;
        let sources = manifest.sources.unwrap_or_else(|| vec![PathBuf::new()]);
        let mut files = Vec::new();
        for source in sources {
            let path = root.join(&source);
            if !path.exists() {
                let message = format!("no {}, which `sources` lists", source.display());
                return Err(InputError::new(&root.join(MANIFEST), message));
            }
            programs(&path, &mut files);
        }
        files.sort();
        files.dedup();
        match files.is_empty() {
            true => Err(InputError::new(root, "no program in this folder")),
            false => Ok(Project {
                name: manifest.name.unwrap_or_else(|| folder_name(root)),
                description: manifest.description,
                root: root.to_owned(),
                files,
            }),
        }
    }
}

/// Expands paths to program files: a folder, or its `rpi.toml`, stands for the programs of the project; any other path
/// stands for itself.
///
/// # Errors
/// If a folder has no program, or its `rpi.toml` is invalid.
pub fn files_of(paths: &[PathBuf]) -> Result<Vec<PathBuf>, InputError> {
    let mut files = Vec::new();
    for path in paths {
        match path.is_dir() || path.ends_with(MANIFEST) {
            true => files.extend(
                Project::open(path)?
                    .files
                    .iter()
                    .map(|file| without_dot(file)),
            ),
            false => files.push(path.clone()),
        }
    }
    Ok(files)
}

/// Returns a path without a leading `./`.
fn without_dot(path: &Path) -> PathBuf {
    path.strip_prefix(".").unwrap_or(path).to_owned()
}

fn manifest(path: &Path) -> Result<Manifest, InputError> {
    match rpi_files::read_text(path, rpi_files::MAX_DESCRIPTION) {
        Ok(text) => toml::from_str(&text)
            .map_err(|error| InputError::new(path, error.to_string().trim_end())),
        Err(_) => Ok(Manifest::default()),
    }
}

fn folder_name(root: &Path) -> String {
    let absolute = root.canonicalize().unwrap_or_else(|_| root.to_owned());
    let name = absolute
        .file_name()
        .map(|n| n.to_string_lossy().into_owned());
    name.unwrap_or_else(|| "programs".to_owned())
}

/// Adds to `files` the programs at or below a path. Hidden folders and build outputs (`target`) are skipped. Symbolic
/// links are followed to files but not to folders, which may form a loop or lie outside the project.
fn programs(path: &Path, files: &mut Vec<PathBuf>) {
    if path.is_file() {
        let kind = InputKind::from_path(path);
        if matches!(kind, Some(InputKind::Rpi | InputKind::Lustre)) {
            files.push(path.to_owned());
        }
        return;
    }
    let Ok(entries) = std::fs::read_dir(path) else {
        return;
    };
    for entry in entries.flatten() {
        let name = entry.file_name();
        let name = name.to_string_lossy();
        let path = entry.path();
        let is_link = entry.file_type().is_ok_and(|kind| kind.is_symlink());
        if !name.starts_with('.') && name != "target" && !(is_link && path.is_dir()) {
            programs(&path, files);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_folder_is_a_project_with_or_without_a_description() {
        let dir = tempfile::tempdir().unwrap();
        let put = |name: &str, text: &str| std::fs::write(dir.path().join(name), text).unwrap();
        put("b.rpi", "");
        put("a.lus", "");
        put("notes.md", "");
        let project = Project::open(dir.path()).unwrap();
        let names: Vec<_> = project
            .files
            .iter()
            .map(|f| f.file_name().unwrap())
            .collect();
        assert_eq!(names, ["a.lus", "b.rpi"]);
        put(MANIFEST, "name = \"cell\"\nsources = [\"b.rpi\"]\n");
        let project = Project::open(&dir.path().join(MANIFEST)).unwrap();
        assert_eq!((project.name.as_str(), project.files.len()), ("cell", 1));
    }

    #[cfg(unix)]
    #[test]
    fn a_folder_that_holds_a_link_to_itself_is_looked_at_once() {
        let dir = tempfile::tempdir().unwrap();
        std::fs::write(dir.path().join("a.rpi"), "").unwrap();
        std::os::unix::fs::symlink(dir.path(), dir.path().join("again")).unwrap();
        assert_eq!(Project::open(dir.path()).unwrap().files.len(), 1);
    }

    #[test]
    fn faults_are_told_with_the_file() {
        let dir = tempfile::tempdir().unwrap();
        let none = Project::open(dir.path()).unwrap_err();
        assert!(none.message.contains("no program"));
        std::fs::write(dir.path().join(MANIFEST), "nmae = \"cell\"").unwrap();
        let unknown = Project::open(dir.path()).unwrap_err();
        assert!(unknown.message.contains("nmae"), "{unknown}");
        std::fs::write(dir.path().join(MANIFEST), "sources = [\"src\"]").unwrap();
        let missing = Project::open(dir.path()).unwrap_err();
        assert!(missing.message.contains("no src"), "{missing}");
    }
}
