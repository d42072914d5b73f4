//! The open texts, what is known of each, and what has been shown of it.
//!
//! Each open text is the root of a program of its own, and a part of the programs that use it. What is found about a file
//! by several roots is shown together, each finding once.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::rc::Rc;
use std::time::{Duration, Instant};

use lsp_types::{Diagnostic, TextDocumentContentChangeEvent, Uri};
use rpi_driver::{Disk, Files, Inspected, inspect};

use crate::client::Client;
use crate::lines::Lines;
use crate::places::Places;
use crate::{diagnostics, uri};

/// The longest pause that is waited for, however long it takes to look at a program.
const LONGEST_PAUSE: Duration = Duration::from_millis(200);

/// A writer who never pauses sees findings that old.
const LONGEST_WAIT: Duration = Duration::from_millis(500);

/// An open text.
#[derive(Debug)]
pub(crate) struct Document {
    pub(crate) uri: Uri,
    pub(crate) version: i32,
    pub(crate) text: String,
    seen: Option<Rc<Inspected>>,
    /// When to look at it again, and since when it is to be.
    due: Option<(Instant, Instant)>,
    /// How long it took to look at it.
    cost: Duration,
    /// What was found, by file.
    found: BTreeMap<PathBuf, Vec<Diagnostic>>,
}

impl Document {
    fn new(uri: Uri, version: i32, text: String) -> Document {
        Document {
            uri,
            version,
            text,
            seen: None,
            due: None,
            cost: Duration::ZERO,
            found: BTreeMap::new(),
        }
    }

    /// Looks at it again when the writer pauses for as long as that took last time.
    fn wait(&mut self, now: Instant) {
        let since = self.due.map_or(now, |(_, since)| since);
        let pause = self.cost.min(LONGEST_PAUSE);
        self.due = Some(((now + pause).min(since + LONGEST_WAIT), since));
    }

    fn uses(&self, path: &Path) -> bool {
        let names = |seen: &Rc<Inspected>| {
            let mut files = seen.sources.files();
            files.any(|id| Path::new(seen.sources.name(id)) == path)
        };
        self.seen.as_ref().is_some_and(names)
    }
}

/// What is found about a file, for the client.
pub(crate) struct Shown {
    pub(crate) uri: Uri,
    pub(crate) version: Option<i32>,
    pub(crate) diagnostics: Vec<Diagnostic>,
}

/// All that the server knows.
pub(crate) struct World {
    pub(crate) client: Client,
    documents: BTreeMap<PathBuf, Document>,
    /// What is to be shown.
    shown: Vec<Shown>,
    /// What was shown last of each file, for which version: the same is not shown again.
    last_shown: BTreeMap<PathBuf, (Option<i32>, Vec<Diagnostic>)>,
}

/// Texts as they are in the editor, others as they are on disk.
struct Overlay<'w>(&'w BTreeMap<PathBuf, Document>);

impl Files for Overlay<'_> {
    fn text(&self, path: &Path) -> Option<String> {
        match self.0.get(path) {
            Some(document) => Some(document.text.clone()),
            None => Disk.text(path),
        }
    }
}

impl World {
    pub(crate) fn new(client: Client) -> World {
        World {
            client,
            documents: BTreeMap::new(),
            shown: Vec::new(),
            last_shown: BTreeMap::new(),
        }
    }

    pub(crate) fn open(&mut self, uri: Uri, version: i32, text: String) {
        let path = uri::path_of(&uri);
        self.documents
            .insert(path, Document::new(uri, version, text));
        // What others use may be there only now.
        self.all_changed();
    }

    /// Applies changes one after the other, as the protocol has it.
    pub(crate) fn change(
        &mut self,
        uri: &Uri,
        version: i32,
        changes: Vec<TextDocumentContentChangeEvent>,
    ) {
        let path = uri::path_of(uri);
        let encoding = self.client.encoding;
        let Some(document) = self.documents.get_mut(&path) else {
            return;
        };
        document.version = version;
        for change in changes {
            let Some(range) = change.range else {
                document.text = change.text;
                continue;
            };
            let lines = Lines::new(&document.text);
            let start = lines.offset(&document.text, range.start, encoding);
            let end = lines.offset(&document.text, range.end, encoding).max(start);
            document.text.replace_range(start..end, &change.text);
        }
        self.changed(&path);
    }

    pub(crate) fn close(&mut self, uri: &Uri) {
        let path = uri::path_of(uri);
        if let Some(document) = self.documents.remove(&path) {
            let files: Vec<PathBuf> = document.found.into_keys().collect();
            files.iter().for_each(|file| self.show(file));
            self.all_changed();
        }
    }

    /// A file is not what it was: whatever uses it is looked at again.
    pub(crate) fn changed(&mut self, path: &Path) {
        let now = Instant::now();
        for (own, document) in &mut self.documents {
            if own == path || document.uses(path) {
                document.wait(now);
            }
        }
    }

    /// Files on disk came, went or changed, which may be found now or not any more.
    pub(crate) fn all_changed(&mut self) {
        let now = Instant::now();
        self.documents
            .values_mut()
            .for_each(|document| document.wait(now));
    }

    pub(crate) fn document(&self, uri: &Uri) -> Option<&Document> {
        self.documents.get(&uri::path_of(uri))
    }

    /// The addresses of the open texts.
    pub(crate) fn open_texts(&self) -> Vec<Uri> {
        let documents = self.documents.values();
        documents.map(|document| document.uri.clone()).collect()
    }

    /// The address of a file: as the client writes it, if it is open.
    pub(crate) fn uri_of(&self, path: &Path) -> Option<Uri> {
        match self.documents.get(path) {
            Some(document) => Some(document.uri.clone()),
            None => uri::uri_of(path),
        }
    }

    /// The version of a file that is open.
    pub(crate) fn version_of(&self, path: &Path) -> Option<i32> {
        self.documents.get(path).map(|document| document.version)
    }

    /// What is known of an open text as it is now.
    pub(crate) fn see(&mut self, uri: &Uri) -> Option<Rc<Inspected>> {
        let path = uri::path_of(uri);
        if self.documents.get(&path)?.due.is_some() {
            self.look(&path);
        }
        self.documents.get(&path)?.seen.clone()
    }

    /// When the next text is to be looked at.
    pub(crate) fn next_due(&self) -> Option<Instant> {
        let dues = self.documents.values().filter_map(|document| document.due);
        dues.map(|(due, _)| due).min()
    }

    /// Looks at every text whose writer has paused.
    pub(crate) fn look_at_due(&mut self) {
        let now = Instant::now();
        let is_due = |document: &Document| document.due.is_some_and(|(due, _)| due <= now);
        let due = self
            .documents
            .iter()
            .filter(|(_, document)| is_due(document));
        let due: Vec<PathBuf> = due.map(|(path, _)| path.clone()).collect();
        due.iter().for_each(|path| self.look(path));
    }

    /// Leaves alone what could not be looked at until it changes.
    pub(crate) fn give_up_due(&mut self) {
        let now = Instant::now();
        for document in self.documents.values_mut() {
            document.due = document.due.filter(|(due, _)| *due > now);
        }
    }

    fn look(&mut self, path: &Path) {
        let Some(document) = self.documents.get(path) else {
            return;
        };
        let begun = Instant::now();
        let seen = Rc::new(inspect(path, &document.text, &Overlay(&self.documents)));
        let found = diagnostics::by_file(self, &seen, path);
        let Some(document) = self.documents.get_mut(path) else {
            return;
        };
        document.due = None;
        document.seen = Some(seen);
        document.cost = begun.elapsed();
        let old = std::mem::replace(&mut document.found, found);
        let new = document.found.keys().cloned();
        let files: std::collections::BTreeSet<PathBuf> = new.chain(old.into_keys()).collect();
        files.iter().for_each(|file| self.show(file));
    }

    /// All that is found about a file, by whatever root.
    fn show(&mut self, file: &Path) {
        let mut diagnostics: Vec<Diagnostic> = Vec::new();
        for found in self.documents.values().filter_map(|d| d.found.get(file)) {
            for one in found {
                if !diagnostics.contains(one) {
                    diagnostics.push(one.clone());
                }
            }
        }
        let version = self.version_of(file);
        let news = (version, diagnostics.clone());
        if self.last_shown.get(file) == Some(&news) {
            return;
        }
        if let Some(uri) = self.uri_of(file) {
            self.last_shown.insert(file.to_owned(), news);
            self.shown.push(Shown {
                uri,
                version,
                diagnostics,
            });
        }
    }

    /// What is to be shown since this was asked last.
    pub(crate) fn take_shown(&mut self) -> Vec<Shown> {
        std::mem::take(&mut self.shown)
    }

    /// Places of a program as the client counts.
    pub(crate) fn places<'s>(&self, seen: &'s Inspected) -> Places<'s> {
        Places::new(seen, self.client.encoding)
    }
}
