//! Open documents, their analyses and published diagnostics.
//!
//! Each open document is the root file of a program, and may be part of other programs. The diagnostics about a file
//! from all these programs are published together, without duplicates.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::rc::Rc;
use std::time::{Duration, Instant};

use lsp_types::{Diagnostic, TextDocumentContentChangeEvent, Uri};
use rpi_driver::{DiskLoader, FileLoader, Inspection, inspect};

use crate::capabilities::ClientFeatures;
use crate::line_index::LineIndex;
use crate::locations::LocationMap;
use crate::{diagnostics, uri};

/// Longest pause in typing that the server waits for before it analyses a document.
const MAX_PAUSE: Duration = Duration::from_millis(200);

/// Maximum time from a change to its analysis if the user never pauses.
const MAX_DELAY: Duration = Duration::from_millis(500);

/// Document that is open in the editor, with its unsaved text.
#[derive(Debug)]
pub(crate) struct Document {
    pub(crate) uri: Uri,
    pub(crate) version: i32,
    pub(crate) text: String,
    /// Result of the last analysis; `None` before the first.
    analysis: Option<Rc<Inspection>>,
    /// Due time of the next analysis, and the time of the first change since the last one.
    due: Option<(Instant, Instant)>,
    /// Duration of the last analysis.
    analysis_time: Duration,
    /// Diagnostics of the last analysis, by file.
    diagnostics: BTreeMap<PathBuf, Vec<Diagnostic>>,
}

impl Document {
    fn new(uri: Uri, version: i32, text: String) -> Document {
        Document {
            uri,
            version,
            text,
            analysis: None,
            due: None,
            analysis_time: Duration::ZERO,
            diagnostics: BTreeMap::new(),
        }
    }

    /// Schedules an analysis after a pause in typing as long as the last analysis took, within the limits.
    fn schedule(&mut self, now: Instant) {
        let since = self.due.map_or(now, |(_, since)| since);
        // The slower the analysis, the longer the pause: fast typing then never queues up analyses.
        let pause = self.analysis_time.min(MAX_PAUSE);
        self.due = Some(((now + pause).min(since + MAX_DELAY), since));
    }

    /// Returns whether the program of the document includes the file.
    fn includes_file(&self, path: &Path) -> bool {
        let names = |seen: &Rc<Inspection>| {
            let mut files = seen.sources.files();
            files.any(|id| Path::new(seen.sources.name(id)) == path)
        };
        self.analysis.as_ref().is_some_and(names)
    }
}

/// All diagnostics of one file, as the editor receives them. An empty list clears the earlier ones.
pub(crate) struct FileDiagnostics {
    pub(crate) uri: Uri,
    pub(crate) version: Option<i32>,
    pub(crate) diagnostics: Vec<Diagnostic>,
}

/// State of the server: client, open documents, published diagnostics.
pub(crate) struct Workspace {
    pub(crate) client: ClientFeatures,
    documents: BTreeMap<PathBuf, Document>,
    /// Diagnostics of a file that the client has not received yet.
    unpublished: Vec<FileDiagnostics>,
    /// Version and diagnostics last published for each file. Unchanged diagnostics are not published again.
    last_published: BTreeMap<PathBuf, (Option<i32>, Vec<Diagnostic>)>,
}

/// File loader that returns open documents as in the editor, and other files from disk.
struct Overlay<'w>(&'w BTreeMap<PathBuf, Document>);

impl FileLoader for Overlay<'_> {
    fn text(&self, path: &Path) -> Option<String> {
        match self.0.get(path) {
            Some(document) => Some(document.text.clone()),
            None => DiskLoader.text(path),
        }
    }
}

impl Workspace {
    pub(crate) fn new(client: ClientFeatures) -> Workspace {
        Workspace {
            client,
            documents: BTreeMap::new(),
            unpublished: Vec::new(),
            last_published: BTreeMap::new(),
        }
    }

    pub(crate) fn open(&mut self, uri: Uri, version: i32, text: String) {
        let path = uri::to_path(&uri);
        self.documents
            .insert(path, Document::new(uri, version, text));
        // Other documents may use this one, and may not have found it so far.
        self.files_changed();
    }

    /// Applies changes to a document. Each change refers to the text after the previous one.
    pub(crate) fn change(
        &mut self,
        uri: &Uri,
        version: i32,
        changes: Vec<TextDocumentContentChangeEvent>,
    ) {
        let path = uri::to_path(uri);
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
            let lines = LineIndex::new(&document.text);
            let start = lines.offset(&document.text, range.start, encoding);
            let end = lines.offset(&document.text, range.end, encoding).max(start);
            document.text.replace_range(start..end, &change.text);
        }
        self.file_changed(&path);
    }

    pub(crate) fn close(&mut self, uri: &Uri) {
        let path = uri::to_path(uri);
        if let Some(document) = self.documents.remove(&path) {
            let files: Vec<PathBuf> = document.diagnostics.into_keys().collect();
            files.iter().for_each(|file| self.collect_diagnostics(file));
            self.files_changed();
        }
    }

    /// Schedules the analysis of all documents that use a changed file.
    pub(crate) fn file_changed(&mut self, path: &Path) {
        let now = Instant::now();
        for (own, document) in &mut self.documents {
            if own == path || document.includes_file(path) {
                document.schedule(now);
            }
        }
    }

    /// Schedules the analysis of all documents. Called after files on disk were created, deleted or changed.
    pub(crate) fn files_changed(&mut self) {
        let now = Instant::now();
        self.documents
            .values_mut()
            .for_each(|document| document.schedule(now));
    }

    pub(crate) fn document(&self, uri: &Uri) -> Option<&Document> {
        self.documents.get(&uri::to_path(uri))
    }

    /// Returns the URIs of the documents that the editor has open, whose text comes from the editor and not from the
    /// file.
    pub(crate) fn open_documents(&self) -> Vec<Uri> {
        let documents = self.documents.values();
        documents.map(|document| document.uri.clone()).collect()
    }

    /// Returns the URI of a file: the one that the client uses, if the file is open.
    pub(crate) fn uri_of(&self, path: &Path) -> Option<Uri> {
        match self.documents.get(path) {
            Some(document) => Some(document.uri.clone()),
            None => uri::from_path(path),
        }
    }

    /// Returns the version of a file, if it is open.
    pub(crate) fn version_of(&self, path: &Path) -> Option<i32> {
        self.documents.get(path).map(|document| document.version)
    }

    /// Returns the analysis of the current text of an open document. Analyses it if it has changed.
    pub(crate) fn analysis(&mut self, uri: &Uri) -> Option<Rc<Inspection>> {
        let path = uri::to_path(uri);
        if self.documents.get(&path)?.due.is_some() {
            self.analyse(&path);
        }
        self.documents.get(&path)?.analysis.clone()
    }

    /// Returns the due time of the next analysis.
    pub(crate) fn next_due(&self) -> Option<Instant> {
        let dues = self.documents.values().filter_map(|document| document.due);
        dues.map(|(due, _)| due).min()
    }

    /// Analyses every document whose analysis is due.
    pub(crate) fn analyse_due(&mut self) {
        let now = Instant::now();
        let is_due = |document: &Document| document.due.is_some_and(|(due, _)| due <= now);
        let due = self
            .documents
            .iter()
            .filter(|(_, document)| is_due(document));
        let due: Vec<PathBuf> = due.map(|(path, _)| path.clone()).collect();
        due.iter().for_each(|path| self.analyse(path));
    }

    /// Cancels the analyses that are due, after one has panicked. The documents are analysed again when they change.
    pub(crate) fn cancel_due(&mut self) {
        let now = Instant::now();
        for document in self.documents.values_mut() {
            document.due = document.due.filter(|(due, _)| *due > now);
        }
    }

    fn analyse(&mut self, path: &Path) {
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
        document.analysis = Some(seen);
        document.analysis_time = begun.elapsed();
        let old = std::mem::replace(&mut document.diagnostics, found);
        let new = document.diagnostics.keys().cloned();
        let files: std::collections::BTreeSet<PathBuf> = new.chain(old.into_keys()).collect();
        files.iter().for_each(|file| self.collect_diagnostics(file));
    }

    /// Collects the diagnostics about a file from all programs, for publication.
    fn collect_diagnostics(&mut self, file: &Path) {
        let mut diagnostics: Vec<Diagnostic> = Vec::new();
        for found in self
            .documents
            .values()
            .filter_map(|d| d.diagnostics.get(file))
        {
            for one in found {
                if !diagnostics.contains(one) {
                    diagnostics.push(one.clone());
                }
            }
        }
        let version = self.version_of(file);
        let news = (version, diagnostics.clone());
        if self.last_published.get(file) == Some(&news) {
            return;
        }
        if let Some(uri) = self.uri_of(file) {
            self.last_published.insert(file.to_owned(), news);
            self.unpublished.push(FileDiagnostics {
                uri,
                version,
                diagnostics,
            });
        }
    }

    /// Returns the diagnostics to be published since the last call.
    pub(crate) fn take_unpublished(&mut self) -> Vec<FileDiagnostics> {
        std::mem::take(&mut self.unpublished)
    }

    /// Creates a span converter for a program, in the position encoding of the client.
    pub(crate) fn locations<'s>(&self, seen: &'s Inspection) -> LocationMap<'s> {
        LocationMap::new(seen, self.client.encoding)
    }
}
