//! One finding: a code, a sentence, the places involved, and what to do about it.

use crate::{Code, FileId, Severity, Span};

/// Something that a check found out about a program.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct Finding {
    /// What kind it is; severity, title and page follow from it.
    pub code: Code,
    /// What is wrong here, in words for the writer of the program: lower case, no full stop.
    pub message: String,
    /// The places involved; the primary ones are where the fault is.
    pub labels: Vec<Label>,
    /// What the writer can do.
    pub help: Vec<String>,
    /// What helps to understand.
    pub notes: Vec<String>,
    /// Edits that mend it.
    pub fixes: Vec<Fix>,
}

/// A place with a remark.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct Label {
    /// Where.
    pub span: Span,
    /// What is to be seen there; may be empty.
    pub text: String,
    /// Whether the fault itself is here.
    pub primary: bool,
}

/// A change of the text that mends a finding.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct Fix {
    /// What the change does, as an imperative: "insert `pre`".
    pub title: String,
    /// The edits; they do not overlap.
    pub edits: Vec<Edit>,
    /// Whether a tool may apply it unasked.
    pub applicability: Applicability,
}

/// The text of a place, replaced.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct Edit {
    /// What is replaced; empty to insert.
    pub span: Span,
    /// By what; empty to delete.
    pub text: String,
}

impl Edit {
    /// Whether it deletes whole lines of a text, with their ends.
    pub(crate) fn takes_lines(&self, text: &str) -> bool {
        let (start, end) = (self.span.start as usize, self.span.end as usize);
        let is_start = |at: usize| at == 0 || text.as_bytes().get(at - 1) == Some(&b'\n');
        self.text.is_empty() && start < end && is_start(start) && is_start(end)
    }

    /// Deletes whole lines instead of leaving them empty.
    pub fn take_lines(&mut self, text: &str) {
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

/// How sure a fix is.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Applicability {
    /// It is what the writer meant; a tool may apply it unasked.
    Sure,
    /// It is one way out; the writer decides.
    Maybe,
}

impl Finding {
    /// A finding without places; add them with [`Finding::at`].
    pub fn new(code: Code, message: impl Into<String>) -> Finding {
        Finding {
            code,
            message: message.into(),
            labels: Vec::new(),
            help: Vec::new(),
            notes: Vec::new(),
            fixes: Vec::new(),
        }
    }

    /// A fault of the compiler itself, seen while it worked on what stands at a place.
    #[must_use]
    pub fn of_compiler(message: impl Into<String>, place: Span) -> Finding {
        Finding::new(Code::RPI9901, message)
            .at(place, "made from this")
            .note("this is a fault of the compiler, not of the program: please report it")
            .help("until it is mended, try to write it in another way")
    }

    /// Adds a place where the fault is.
    #[must_use]
    pub fn at(self, span: Span, text: impl Into<String>) -> Finding {
        self.label(span, text, true)
    }

    /// Adds a place that has to do with it.
    #[must_use]
    pub fn also(self, span: Span, text: impl Into<String>) -> Finding {
        self.label(span, text, false)
    }

    /// The same where the fault is another one, that of a text from which this follows.
    #[must_use]
    pub fn because_of(mut self, span: Span, text: impl Into<String>) -> Finding {
        for label in &mut self.labels {
            label.primary = false;
        }
        let mut finding = self.at(span, text);
        finding.labels.rotate_right(1);
        finding.fixes.clear();
        finding
    }

    /// Adds what the writer can do.
    #[must_use]
    pub fn help(mut self, text: impl Into<String>) -> Finding {
        self.help.push(text.into());
        self
    }

    /// Adds what helps to understand.
    #[must_use]
    pub fn note(mut self, text: impl Into<String>) -> Finding {
        self.notes.push(text.into());
        self
    }

    /// Adds a change that mends it.
    #[must_use]
    pub fn fix(mut self, fix: Fix) -> Finding {
        self.fixes.push(fix);
        self
    }

    /// Adds the name that may have been meant at a place, if there is one near enough.
    #[must_use]
    pub fn did_you_mean(self, span: Span, near: Option<impl Into<String>>) -> Finding {
        match near.map(Into::into) {
            Some(near) => self
                .help(format!("did you mean `{near}`?"))
                .fix(Fix::maybe(format!("write `{near}`")).replace(span, near)),
            None => self,
        }
    }

    /// How much it weighs; the table of codes says so.
    pub fn severity(&self) -> Severity {
        self.code.severity()
    }

    /// Where the fault is: the first primary place, else the first place, else [`Span::NONE`].
    pub fn span(&self) -> Span {
        let primary = self.labels.iter().find(|label| label.primary);
        primary
            .or(self.labels.first())
            .map_or(Span::NONE, |label| label.span)
    }

    /// The same finding where the files have other numbers: `files` tells them by the old ones.
    #[must_use]
    pub fn renumbered(mut self, files: &[FileId]) -> Finding {
        let renumber = |span: &mut Span| {
            if let Some(file) = files.get(span.file.0 as usize) {
                span.file = *file;
            }
        };
        self.labels
            .iter_mut()
            .for_each(|label| renumber(&mut label.span));
        let edits = self.fixes.iter_mut().flat_map(|fix| &mut fix.edits);
        edits.for_each(|edit| renumber(&mut edit.span));
        self
    }

    fn label(mut self, span: Span, text: impl Into<String>, primary: bool) -> Finding {
        self.labels.push(Label {
            span,
            text: text.into(),
            primary,
        });
        self
    }
}

impl Fix {
    /// The same, not to be applied unasked.
    #[must_use]
    pub fn doubted(self) -> Fix {
        Fix {
            applicability: Applicability::Maybe,
            ..self
        }
    }

    /// A change that is what the writer meant.
    pub fn sure(title: impl Into<String>) -> Fix {
        Fix::new(title, Applicability::Sure)
    }

    /// A change that is one way out.
    pub fn maybe(title: impl Into<String>) -> Fix {
        Fix::new(title, Applicability::Maybe)
    }

    /// Its edits in the order of the text, without those of what has no text.
    pub(crate) fn in_order(&self) -> Vec<&Edit> {
        let mut edits: Vec<&Edit> = self.edits.iter().collect();
        edits.retain(|edit| !edit.span.is_none());
        edits.sort_by_key(|edit| edit.span);
        edits
    }

    /// Adds: replace the text at `span` by `text`.
    #[must_use]
    pub fn replace(mut self, span: Span, text: impl Into<String>) -> Fix {
        self.edits.push(Edit {
            span,
            text: text.into(),
        });
        self
    }

    /// Adds: insert `text` where `span` starts.
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

    /// Adds: insert `text` where `span` ends.
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
