//! Diagnostic: a code, a message, labelled locations, and fixes.

use crate::{Code, FileId, Severity, Span};

/// Error, warning or note about a program.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct Diagnostic {
    /// Code of the diagnostic. It determines the severity, the title and the explanation page.
    pub code: Code,
    /// Description of the problem for the author of the program: lower case, no full stop.
    pub message: String,
    /// Labelled locations in the source text. The primary ones mark the error itself.
    pub labels: Vec<Label>,
    /// Suggestions for the author of the program, one text for each.
    pub help: Vec<String>,
    /// Background information for the author of the program, such as the reason why a type is expected; one text for
    /// each.
    pub notes: Vec<String>,
    /// Possible fixes, the most probable one first; empty if none is known.
    pub fixes: Vec<Fix>,
    /// Undefined name or unsupported construct of which one diagnostic is enough, although the program uses it in
    /// several places; `None` for other diagnostics. It is not part of the output.
    pub subject: Option<Subject>,
}

/// Undefined name or unsupported construct that several diagnostics of a program are about. Only the first of them is
/// reported.
#[derive(Clone, PartialEq, Eq, PartialOrd, Ord, Debug)]
pub enum Subject {
    /// Undefined global name with the kind of declaration that is missing, such as `type Celsius`. The diagnostic also
    /// shows some of its other uses.
    UndefinedName(String),
    /// Construct that the compiler does not support, by its name in messages.
    Construct(String),
}

/// Location in a source text with a text that explains it.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct Label {
    /// Range of the source text that the label marks.
    pub span: Span,
    /// Role of the location in the error, such as "defined here"; may be empty.
    pub text: String,
    /// True if the label marks the error itself, false if it marks a related location.
    pub primary: bool,
}

/// Change of the source text that fixes a diagnostic.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct Fix {
    /// Description of the change in the imperative: "insert `pre`".
    pub title: String,
    /// Edits of the source text, which do not overlap.
    pub edits: Vec<Edit>,
    /// Whether a tool may apply the fix without asking the author.
    pub applicability: Applicability,
}

/// Replacement of a range of source text.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct Edit {
    /// Range of the source text that is replaced; empty for an insertion.
    pub span: Span,
    /// Text that replaces the range; empty for a deletion.
    pub text: String,
}

impl Edit {
    /// Returns whether the edit deletes whole lines of `text`, including their line ends.
    pub(crate) fn deletes_whole_lines(&self, text: &str) -> bool {
        let (start, end) = (self.span.start as usize, self.span.end as usize);
        let is_start = |at: usize| at == 0 || text.as_bytes().get(at - 1) == Some(&b'\n');
        self.text.is_empty() && start < end && is_start(start) && is_start(end)
    }

    /// Extends a deletion to the whole lines of `text` that contain it, if the deletion would otherwise leave only
    /// blanks in them. Other edits are unchanged.
    pub fn extend_to_whole_lines(&mut self, text: &str) {
        let (start, end) = (self.span.start as usize, self.span.end as usize);
        let (Some(before), Some(after)) = (text.get(..start), text.get(end..)) else {
            return;
        };
        let lead = before.rfind('\n').map_or(0, |at| at + 1);
        let Some(rest) = after.find('\n') else {
            return;
        };
        let is_blank = |text: &str| text.trim().is_empty();
        let leaves_nothing = is_blank(&before[lead..]) && is_blank(&after[..rest]);
        if self.text.is_empty() && start < end && leaves_nothing {
            self.span.start = lead as u32;
            self.span.end = (end + rest + 1) as u32;
        }
    }
}

/// Confidence in a fix: tools apply sure fixes without a question, and offer the others.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Applicability {
    /// The fix is certainly what the author meant; a tool may apply it without asking.
    Sure,
    /// The fix is one of several possibilities, of which the author chooses.
    Maybe,
}

impl Diagnostic {
    /// Creates a diagnostic without locations, help and fixes. [`Diagnostic::primary`] adds a location.
    pub fn new(code: Code, message: impl Into<String>) -> Diagnostic {
        Diagnostic {
            code,
            message: message.into(),
            labels: Vec::new(),
            help: Vec::new(),
            notes: Vec::new(),
            fixes: Vec::new(),
            subject: None,
        }
    }

    /// Sets the subject of the diagnostic: an undefined name or an unsupported construct. Of several diagnostics about
    /// one subject only the first is reported ([`merge_by_subject`](crate::suppression::merge_by_subject)).
    #[must_use]
    pub fn about(mut self, subject: Subject) -> Diagnostic {
        self.subject = Some(subject);
        self
    }

    /// Removes the fixes for which `is_right` returns false. `is_right` may also change a fix.
    pub fn keep_fixes(&mut self, is_right: impl FnMut(&mut Fix) -> bool) {
        self.fixes.retain_mut(is_right);
    }

    /// Creates a diagnostic for an internal error of the compiler (RPI9901). `place` is the source text that is being
    /// compiled.
    #[must_use]
    pub fn internal_error(message: impl Into<String>, place: Span) -> Diagnostic {
        Diagnostic::new(Code::RPI9901, message)
            .primary(place, "made from this")
            .note("this is a bug in the compiler, not an error in the program: please report it")
            .help("until it is fixed, try to write the expression in another way")
    }

    /// Adds a primary label: it marks `span` as a location of the error itself, with an explaining text.
    #[must_use]
    pub fn primary(self, span: Span, text: impl Into<String>) -> Diagnostic {
        self.label(span, text, true)
    }

    /// Adds a secondary label: it marks `span` as a location related to the error, with an explaining text.
    #[must_use]
    pub fn secondary(self, span: Span, text: impl Into<String>) -> Diagnostic {
        self.label(span, text, false)
    }

    /// Adds a secondary label to a diagnostic that has already been reported.
    pub fn add_secondary(&mut self, span: Span, text: impl Into<String>) {
        self.add_label(span, text, false);
    }

    /// Returns the diagnostic with `span` as its primary location: an earlier text that causes the error. The previous
    /// primary labels become secondary. The fixes are removed because they would edit the wrong location.
    #[must_use]
    pub fn with_cause(mut self, span: Span, text: impl Into<String>) -> Diagnostic {
        for label in &mut self.labels {
            label.primary = false;
        }
        let mut diagnostic = self.primary(span, text);
        diagnostic.labels.rotate_right(1);
        diagnostic.fixes.clear();
        diagnostic.subject = None;
        diagnostic
    }

    /// Adds a suggestion for the author of the program.
    #[must_use]
    pub fn help(mut self, text: impl Into<String>) -> Diagnostic {
        self.help.push(text.into());
        self
    }

    /// Adds background information for the author of the program.
    #[must_use]
    pub fn note(mut self, text: impl Into<String>) -> Diagnostic {
        self.notes.push(text.into());
        self
    }

    /// Adds a possible fix after the fixes that the diagnostic has.
    #[must_use]
    pub fn fix(mut self, fix: Fix) -> Diagnostic {
        self.fixes.push(fix);
        self
    }

    /// Adds the suggestion "did you mean `near`?" and a fix that writes `near` at `span`. Does nothing if `near`, the
    /// most similar known name, is `None`.
    #[must_use]
    pub fn did_you_mean(self, span: Span, near: Option<impl Into<String>>) -> Diagnostic {
        match near.map(Into::into) {
            Some(near) => self
                .help(format!("did you mean `{near}`?"))
                .fix(Fix::maybe(format!("write `{near}`")).replace(span, near)),
            None => self,
        }
    }

    /// Returns the severity of the diagnostic, which its code determines.
    pub fn severity(&self) -> Severity {
        self.code.severity()
    }

    /// Returns the location of the error: the first primary label, else the first label, else [`Span::NONE`].
    pub fn span(&self) -> Span {
        let primary = self.labels.iter().find(|label| label.primary);
        primary
            .or(self.labels.first())
            .map_or(Span::NONE, |label| label.span)
    }

    /// Replaces the file identifiers in all locations: `files[old]` is the new identifier of file number `old`.
    #[must_use]
    pub fn renumbered(mut self, files: &[FileId]) -> Diagnostic {
        self.change_spans(|span| match files.get(span.file.0 as usize) {
            Some(file) => Span {
                file: *file,
                ..span
            },
            None => span,
        });
        self
    }

    /// Replaces the locations of all labels and edits by the results of `change`.
    pub fn change_spans(&mut self, change: impl Fn(Span) -> Span) {
        let labels = self.labels.iter_mut().map(|label| &mut label.span);
        let edits = self.fixes.iter_mut().flat_map(|fix| &mut fix.edits);
        let spans = labels.chain(edits.map(|edit| &mut edit.span));
        spans.for_each(|span| *span = change(*span));
    }

    fn label(mut self, span: Span, text: impl Into<String>, primary: bool) -> Diagnostic {
        self.add_label(span, text, primary);
        self
    }

    fn add_label(&mut self, span: Span, text: impl Into<String>, primary: bool) {
        self.labels.push(Label {
            span,
            text: text.into(),
            primary,
        });
    }
}

impl Fix {
    /// Returns the fix as one of several possibilities ([`Applicability::Maybe`]), which no tool applies without
    /// asking.
    #[must_use]
    pub fn into_maybe(self) -> Fix {
        Fix {
            applicability: Applicability::Maybe,
            ..self
        }
    }

    /// Creates a fix without edits that is certainly what the author meant ([`Applicability::Sure`]).
    pub fn sure(title: impl Into<String>) -> Fix {
        Fix::new(title, Applicability::Sure)
    }

    /// Creates a fix without edits that is one of several possibilities ([`Applicability::Maybe`]).
    pub fn maybe(title: impl Into<String>) -> Fix {
        Fix::new(title, Applicability::Maybe)
    }

    /// Returns the edits in the order of their locations, without edits at [`Span::NONE`].
    pub(crate) fn in_order(&self) -> Vec<&Edit> {
        let mut edits: Vec<&Edit> = self.edits.iter().collect();
        edits.retain(|edit| !edit.span.is_none());
        edits.sort_by_key(|edit| edit.span);
        edits
    }

    /// Adds an edit that replaces the source text of `span` by `text`.
    #[must_use]
    pub fn replace(mut self, span: Span, text: impl Into<String>) -> Fix {
        self.edits.push(Edit {
            span,
            text: text.into(),
        });
        self
    }

    /// Adds an edit that inserts `text` into the source text before `span`.
    #[must_use]
    pub fn insert_before(self, span: Span, text: impl Into<String>) -> Fix {
        self.replace(
            Span {
                end: span.start,
                ..span
            },
            text,
        )
    }

    /// Adds an edit that inserts `text` into the source text after `span`.
    #[must_use]
    pub fn insert_after(self, span: Span, text: impl Into<String>) -> Fix {
        self.replace(
            Span {
                start: span.end,
                ..span
            },
            text,
        )
    }

    fn new(title: impl Into<String>, applicability: Applicability) -> Fix {
        Fix {
            title: title.into(),
            edits: Vec::new(),
            applicability,
        }
    }
}
