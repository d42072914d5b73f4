//! Open documents, their analyses and published diagnostics.
//!
//! Each open document is the root file of a program, and may be part of other programs. The diagnostics about a file
//! from all these programs are published together, without duplicates.

use std::collections::{BTreeMap, BTreeSet};
use std::ops::Range as ByteRange;
use std::path::{Path, PathBuf};
use std::rc::Rc;
use std::time::{Duration, Instant};

use lsp_server::RequestId;
use lsp_types::{Diagnostic, Range, TextDocumentContentChangeEvent, Uri};
use rpi_driver::{CheckSession, DiskLoader, FileLoader, Inspection};
use serde_json::Value;

use crate::cancellation::Cancellations;
use crate::capabilities::ClientFeatures;
use crate::line_index::LineIndex;
use crate::locations::LocationMap;
use crate::progress::Progress;
use crate::semantic_tokens::SentTokens;
use crate::settings::Settings;
use crate::{diagnostics, uri};

/// Maximum pause in typing for which the server waits before it analyses a document: 200 ms.
const MAX_PAUSE: Duration = Duration::from_millis(200);

/// Maximum time from a change to its analysis if the user types without a pause: 500 ms.
const MAX_DELAY: Duration = Duration::from_millis(500);

/// Duration of an analysis that ends before a fast typist presses the next key (35 ms at 140 words per minute), so that
/// waiting for a pause would only delay the diagnostics.
const FAST_ANALYSIS: Duration = Duration::from_millis(30);

/// Document that is open in the editor, with its unsaved text.
#[derive(Debug)]
pub(crate) struct Document {
    pub(crate) uri: Uri,
    pub(crate) version: i32,
    pub(crate) text: String,
    /// Result of the last analysis of the document; `None` before the first one.
    analysis: Option<Rc<Inspection>>,
    /// Results of the last analysis that the next one can reuse.
    session: CheckSession,
    /// Time at which the next analysis is due, and time of the first change since the last analysis; `None` if the last
    /// analysis is of the current text.
    due: Option<(Instant, Instant)>,
    /// Duration of the last analysis. The next one waits for a pause in typing of this length.
    analysis_time: Duration,
    /// Diagnostics of the last analysis, by the path of the file that they are about.
    diagnostics: BTreeMap<PathBuf, Vec<Diagnostic>>,
}

impl Document {
    fn new(uri: Uri, version: i32, text: String) -> Document {
        Document {
            uri,
            version,
            text,
            analysis: None,
            session: CheckSession::default(),
            due: None,
            analysis_time: Duration::ZERO,
            diagnostics: BTreeMap::new(),
        }
    }

    /// Schedules an analysis: at once if the last one was fast, else after a pause in typing that is as long as the last
    /// analysis took, but at most [`MAX_PAUSE`] long and at most [`MAX_DELAY`] after the first change.
    fn schedule(&mut self, now: Instant) {
        let since = self.due.map_or(now, |(_, since)| since);
        // The slower the analysis, the longer the pause: fast typing then never queues up analyses.
        let pause = match self.analysis_time < FAST_ANALYSIS {
            true => Duration::ZERO,
            false => self.analysis_time.min(MAX_PAUSE),
        };
        self.due = Some(((now + pause).min(since + MAX_DELAY), since));
    }

    /// Returns whether the program of the document includes the file, according to the last analysis.
    fn includes_file(&self, path: &Path) -> bool {
        let names = |seen: &Rc<Inspection>| {
            let mut files = seen.sources.files();
            files.any(|id| Path::new(seen.sources.name(id)) == path)
        };
        self.analysis.as_ref().is_some_and(names)
    }
}

/// All diagnostics about one file, as the editor receives them. They replace the earlier ones; an empty list clears
/// them.
pub(crate) struct FileDiagnostics {
    pub(crate) uri: Uri,
    pub(crate) version: Option<i32>,
    pub(crate) diagnostics: Vec<Diagnostic>,
}

/// State of the server: client, open documents, published diagnostics.
pub(crate) struct Workspace {
    pub(crate) client: ClientFeatures,
    pub(crate) settings: Settings,
    /// Semantic tokens that the client has received, by document, for later requests of changes.
    pub(crate) sent_tokens: BTreeMap<PathBuf, SentTokens>,
    /// Document of the last completion, to which requests for the documentation of items refer.
    pub(crate) completed: Option<Uri>,
    /// Folders that are open in the editor.
    folders: Vec<PathBuf>,
    cancellations: Cancellations,
    /// Request that is being handled.
    request: Option<RequestId>,
    progress: Progress,
    documents: BTreeMap<PathBuf, Document>,
    /// Diagnostics of files that the client has not received so far, in the order of the analyses.
    unpublished: Vec<FileDiagnostics>,
    /// Document version and diagnostics that were last published for each file. Unchanged diagnostics are not published
    /// again.
    last_published: BTreeMap<PathBuf, (Option<i32>, Vec<Diagnostic>)>,
}

/// File loader that returns the text in the editor for open documents, and the text on disk for other files.
pub(crate) struct Overlay<'w>(&'w BTreeMap<PathBuf, Document>);

impl FileLoader for Overlay<'_> {
    fn text(&self, path: &Path) -> Option<String> {
        match self.0.get(path) {
            Some(document) => Some(document.text.clone()),
            None => DiskLoader.text(path),
        }
    }
}

impl Workspace {
    pub(crate) fn new(
        client: ClientFeatures,
        settings: Settings,
        folders: Vec<PathBuf>,
        cancellations: Cancellations,
        progress: Progress,
    ) -> Workspace {
        Workspace {
            client,
            settings,
            sent_tokens: BTreeMap::new(),
            completed: None,
            folders,
            cancellations,
            progress,
            request: None,
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

    /// Applies changes of the client to a document and schedules its analysis. Each change refers to the text after the
    /// previous change; a change without a range replaces the whole text.
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
        self.sent_tokens.remove(&path);
        if let Some(document) = self.documents.remove(&path) {
            let files: Vec<PathBuf> = document.diagnostics.into_keys().collect();
            files.iter().for_each(|file| self.collect_diagnostics(file));
            self.files_changed();
        }
    }

    /// Schedules the analysis of all open documents whose program includes the file `path`.
    pub(crate) fn file_changed(&mut self, path: &Path) {
        let now = Instant::now();
        for (own, document) in &mut self.documents {
            if own == path || document.includes_file(path) {
                document.schedule(now);
            }
        }
    }

    /// Schedules the analysis of all open documents, because files on disk have been created, deleted or changed.
    pub(crate) fn files_changed(&mut self) {
        let now = Instant::now();
        self.documents
            .values_mut()
            .for_each(|document| document.schedule(now));
    }

    /// Begins to handle a request.
    pub(crate) fn begin_request(&mut self, request: RequestId, method: &str, params: &Value) {
        self.request = Some(request);
        self.progress.start(method, params);
    }

    /// Ends the request that is being handled.
    pub(crate) fn end_request(&mut self) {
        self.request = None;
        self.progress.end();
    }

    /// Reports that a request has looked through `done` of `all` programs. Returns whether it goes on: false if the client
    /// has cancelled it.
    pub(crate) fn goes_on(&self, done: usize, all: usize) -> bool {
        self.progress.report(done, all);
        !self.is_cancelled()
    }

    /// Returns whether the client has cancelled the request that is being handled.
    pub(crate) fn is_cancelled(&self) -> bool {
        let request = self.request.as_ref();
        request.is_some_and(|id| self.cancellations.contains(id))
    }

    /// Returns the folders that are open in the editor.
    pub(crate) fn folders(&self) -> &[PathBuf] {
        &self.folders
    }

    /// Changes the folders that are open in the editor.
    pub(crate) fn change_folders(&mut self, removed: &[PathBuf], added: Vec<PathBuf>) {
        self.folders.retain(|folder| !removed.contains(folder));
        self.folders.extend(added);
    }

    /// Returns the paths of the documents that are open in the editor.
    pub(crate) fn open_paths(&self) -> BTreeSet<PathBuf> {
        self.documents.keys().cloned().collect()
    }

    /// Returns the URI of the document that is open at a path; `None` if there is none.
    pub(crate) fn open_uri(&self, path: &Path) -> Option<Uri> {
        self.documents
            .get(path)
            .map(|document| document.uri.clone())
    }

    /// Returns a file loader that prefers the texts in the editor.
    pub(crate) fn overlay(&self) -> Overlay<'_> {
        Overlay(&self.documents)
    }

    /// Converts a range of bytes in a file to a range of lines and columns.
    pub(crate) fn range_in(&self, path: &Path, bytes: ByteRange<u32>) -> Range {
        let text = self.overlay().text(path).unwrap_or_default();
        let lines = LineIndex::new(&text);
        let at = |offset: u32| lines.position(&text, offset as usize, self.client.encoding);
        Range::new(at(bytes.start), at(bytes.end))
    }

    pub(crate) fn document(&self, uri: &Uri) -> Option<&Document> {
        self.documents.get(&uri::to_path(uri))
    }

    /// Returns the URI of a file: for an open document the URI that the client uses, else one made from the path.
    /// Returns `None` for a relative path of a file that is not open.
    pub(crate) fn uri_of(&self, path: &Path) -> Option<Uri> {
        match self.documents.get(path) {
            Some(document) => Some(document.uri.clone()),
            None => uri::from_path(path),
        }
    }

    /// Returns the version of the open document at `path`; `None` if it is not open.
    pub(crate) fn version_of(&self, path: &Path) -> Option<i32> {
        self.documents.get(path).map(|document| document.version)
    }

    /// Returns the analysis of the current text of a document, which is computed if the text has changed since the last
    /// analysis. Returns `None` if the document is not open.
    pub(crate) fn analysis(&mut self, uri: &Uri) -> Option<Rc<Inspection>> {
        let path = uri::to_path(uri);
        if self.documents.get(&path)?.due.is_some() {
            self.analyse(&path);
        }
        self.documents.get(&path)?.analysis.clone()
    }

    /// Returns the earliest time at which the analysis of a document is due; `None` if no analysis is scheduled.
    pub(crate) fn next_due(&self) -> Option<Instant> {
        let dues = self.documents.values().filter_map(|document| document.due);
        dues.map(|(due, _)| due).min()
    }

    /// Returns whether a document has waited for its analysis for [`MAX_DELAY`], so that further messages must wait.
    pub(crate) fn is_overdue(&self) -> bool {
        let now = Instant::now();
        let mut dues = self.documents.values().filter_map(|document| document.due);
        dues.any(|(_, since)| since + MAX_DELAY <= now)
    }

    /// Analyses every open document whose analysis is due now.
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
        let Some(document) = self.documents.get_mut(path) else {
            return;
        };
        let begun = Instant::now();
        // After a panic, the next analysis begins from nothing.
        let mut session = std::mem::take(&mut document.session);
        let text = document.text.clone();
        let seen = Rc::new(session.inspect(path, &text, &Overlay(&self.documents)));
        let found = diagnostics::by_file(self, &seen, path);
        let Some(document) = self.documents.get_mut(path) else {
            return;
        };
        document.due = None;
        document.session = session;
        document.analysis = Some(seen);
        document.analysis_time = begun.elapsed();
        let old = std::mem::replace(&mut document.diagnostics, found);
        let new = document.diagnostics.keys().cloned();
        let files: BTreeSet<PathBuf> = new.chain(old.into_keys()).collect();
        files.iter().for_each(|file| self.collect_diagnostics(file));
    }

    /// Collects the diagnostics about a file from the programs of all open documents for publication, unless they are
    /// the same as those last published.
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

    /// Returns the diagnostics to publish, and removes them from the list of unpublished ones. There are none if the
    /// client requests diagnostics itself.
    pub(crate) fn take_unpublished(&mut self) -> Vec<FileDiagnostics> {
        let all = std::mem::take(&mut self.unpublished);
        match self.settings.pull_diagnostics {
            true => Vec::new(),
            false => all,
        }
    }

    /// Returns a converter from byte ranges in the files of a program to positions in the encoding of the client.
    pub(crate) fn locations<'s>(&self, seen: &'s Inspection) -> LocationMap<'s> {
        LocationMap::new(seen, self.client.encoding)
    }
}
