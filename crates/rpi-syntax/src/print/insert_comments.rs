//! Inserts the comments of a source into the document of its tree.
//!
//! A comment stays between the same two tokens, separators ignored: at the end of the line of the first token, on the
//! line of the second, or on a line of its own. After a comment that ends a line, the line is broken where the document
//! allows a break. Elsewhere, the next line is indented by one step.

use super::align::{DocWord, align};
use super::flat_doc::{DocPiece, Enclosure, flatten, rebuild};
use super::layout::{Doc, INDENT};
use super::piece_map::{GapPieces, PieceMap};
use super::trivia::{GapComments, Source};
use crate::comments::{Comment, CommentKind};
use std::collections::BTreeMap;
use std::ops::Range;

/// Returns the document with the comments of the source inserted.
pub(super) fn insert_comments(doc: Doc, source: &Source<'_>) -> Doc {
    if source.comments.is_empty() {
        return doc;
    }
    let pieces = flatten(&doc);
    drop(doc);
    let map = PieceMap::new(pieces);
    let became = align(&source.significant_texts(), &doc_words(&map, source));
    let mut inserter = CommentInserter {
        source,
        map,
        insertions: BTreeMap::new(),
    };
    for (all, (before, behind)) in group_by_gap(source, &became) {
        let gap = source.classify(all, inserter.map.closes(behind));
        inserter.insert_gap(gap, before, behind);
    }
    rebuild(inserter.map.pieces, inserter.insertions)
}

/// Gap in the document: the indices of the words before and after it; `None` at the start or end of the document.
type WordGap = (Option<usize>, Option<usize>);

/// Returns the comments in text order, grouped by the gap of the document into which they belong. `became` holds the
/// index of the printed word for each source word.
// Words between two comments may be omitted by the style, so comments from different gaps can meet in one position.
fn group_by_gap<'a>(
    source: &Source<'a>,
    became: &[Option<usize>],
) -> Vec<(&'a [Comment], WordGap)> {
    let place = |comment: &Comment| {
        let next = source.word_at(comment.span.start);
        let before = became[..next].iter().rev().flatten().next();
        let behind = became[next..].iter().flatten().next();
        (before.copied(), behind.copied())
    };
    let mut found: Vec<(Range<usize>, WordGap)> = Vec::new();
    for (i, comment) in source.comments.iter().enumerate() {
        let at = place(comment);
        match found.last_mut() {
            Some((range, last)) if *last == at => range.end = i + 1,
            _ => found.push((i..i + 1, at)),
        }
    }
    let all = found.into_iter();
    all.map(|(range, at)| (&source.comments[range], at))
        .collect()
}

/// Returns the words of the document. A word at the start of a node with a known source offset has the index of its
/// source word.
fn doc_words<'p>(map: &'p PieceMap, source: &Source<'_>) -> Vec<DocWord<'p>> {
    let pieces = &map.pieces;
    let mut from = 0;
    let word = |i: &usize| {
        let part = pieces[from..*i].iter().rev().find_map(|piece| match piece {
            DocPiece::SourceOffset(offset) => Some(*offset),
            _ => None,
        });
        from = *i;
        DocWord {
            text: match &pieces[*i] {
                DocPiece::Token(text) => text,
                _ => "",
            },
            anchor: part.map(|offset| source.word_at(offset)),
        }
    };
    map.words.iter().map(word).collect()
}

/// State of the insertion of comments into a flattened document.
struct CommentInserter<'s> {
    source: &'s Source<'s>,
    map: PieceMap,
    /// Pieces to insert, by the index of the piece before which they are inserted.
    insertions: BTreeMap<usize, Vec<DocPiece>>,
}

impl CommentInserter<'_> {
    /// Inserts the comments of one gap between the words with the indices `before` and `behind`; `None` at the start or
    /// end of the document.
    fn insert_gap(
        &mut self,
        mut gap: GapComments<'_>,
        before: Option<usize>,
        behind: Option<usize>,
    ) {
        let lead = self.map.gap_pieces(behind);
        let after = before.map_or(0, |word| self.map.words[word] + 1);
        let after = self.map.flat_end(after, lead.range.end);
        self.insert_before_separator(&mut gap, after);
        let end = self.map.after_closing(self.map.after_separator(after));
        if let Some(frame) = self.map.flat_around(end, lead.range.end) {
            let all = gap.trailing.iter().chain(&gap.own_line).chain(&gap.leading);
            let lines = all.flat_map(|c| [self.comment(c), DocPiece::Hard]);
            let lines = lines.collect();
            // Text inserted earlier before the same piece gets a line of its own.
            if let Some(room @ DocPiece::Text(_)) =
                self.insertions.get_mut(&frame).and_then(|p| p.last_mut())
            {
                *room = DocPiece::Hard;
            }
            return self.insert_before(frame, lines);
        }
        self.insert_suffixes(&mut gap, end, &lead);
        if !gap.own_line.is_empty() {
            self.insert_own_lines(&lead, &gap, before.is_none());
        }
        let ahead = gap.leading.iter();
        let ahead = ahead.flat_map(|c| self.inline_pieces(lead.range.end, c, false));
        let ahead = ahead.collect();
        self.insert_before(self.map.flat_start(lead.range.end), ahead);
    }

    /// Inserts the comments between a word and the separator or closing bracket after it. `after` is the index of the
    /// piece after the word.
    fn insert_before_separator(&mut self, gap: &mut GapComments<'_>, after: usize) {
        let breaks = !gap.trailing.is_empty() || !gap.own_line.is_empty();
        if self.map.ends_line(after) || breaks && self.map.after_separator(after) == after {
            gap.trailing.splice(..0, gap.before_separator.drain(..));
        }
        let within = gap
            .before_separator
            .iter()
            .flat_map(|c| self.inline_pieces(after, c, true));
        let within: Vec<DocPiece> = within.collect();
        self.insert_before(after, within);
    }

    /// Inserts the comments of the gap that follow code on its line, as suffixes of the line. They are inserted before
    /// piece `end`; `lead` are the pieces of the gap.
    fn insert_suffixes(&mut self, gap: &mut GapComments<'_>, end: usize, lead: &GapPieces) {
        if gap.trailing.is_empty() {
            return;
        }
        let suffixes = gap.trailing.iter();
        let suffixes = suffixes.map(|c| DocPiece::Suffix(self.source.comment_text(c)));
        self.insert_before(end, suffixes.collect());
        let follows = self.map.words.partition_point(|word| *word < end);
        let follows = self.map.gap_pieces(Some(follows));
        let apart = follows.range != lead.range;
        if gap.own_line.is_empty() || apart {
            self.break_line(&follows, gap);
        }
        if apart {
            // The comments on lines of their own are not directly below these.
            gap.trailing.clear();
        }
    }

    /// Records pieces to insert before the piece at index `at`, after those already recorded there.
    fn insert_before(&mut self, at: usize, pieces: Vec<DocPiece>) {
        self.insertions.entry(at).or_default().extend(pieces);
    }

    fn comment(&self, comment: &Comment) -> DocPiece {
        DocPiece::Text(self.source.comment_text(comment))
    }

    /// Returns the pieces of a comment within a line, with the spaces around it. The comment belongs to the word before
    /// it if `behind` is true, else to the word after it. `at` is the index of the piece after the comment.
    fn inline_pieces(&self, at: usize, comment: &Comment, behind: bool) -> Vec<DocPiece> {
        let touches = |piece: Option<&DocPiece>| match piece {
            Some(DocPiece::Token(text)) => !matches!(text.as_str(), "(" | "[" | "{" | "<<"),
            _ => false,
        };
        let takes_no_room = |p: &&DocPiece| {
            matches!(
                p,
                DocPiece::SourceOffset(_) | DocPiece::Open(_) | DocPiece::Close(_)
            )
        };
        let mut before = self.map.pieces[..at].iter().rev();
        let apart = touches(before.find(|p| !takes_no_room(p)));
        let mut pieces = Vec::new();
        pieces.extend(apart.then(|| DocPiece::Text(" ".into())));
        pieces.push(self.comment(comment));
        pieces.extend((!behind).then(|| DocPiece::Text(" ".into())));
        pieces
    }

    /// Inserts or forces a line break after a comment that ends its line. `between` are the pieces of the gap of the
    /// comment.
    fn break_line(&mut self, between: &GapPieces, gap: &GapComments<'_>) {
        if between.range.end >= self.map.pieces.len() {
            return;
        }
        let to = self.map.before_opening(&between.range);
        match between.line_break {
            Some(at) => self.map.pieces[at] = DocPiece::Hard,
            None if between.closes => self.insert_before(to, vec![DocPiece::Hard]),
            None => self.insert_indented(to, vec![DocPiece::Hard]),
        }
        if let Some(last) = gap.trailing.last().filter(|_| gap.own_line.is_empty())
            && self.ends_documentation(last, self.next_start(gap))
            && !self.map.pieces[between.range.clone()]
                .iter()
                .any(|p| matches!(p, DocPiece::Empty))
        {
            self.insert_before(to, vec![DocPiece::Empty]);
        }
    }

    fn next_start(&self, gap: &GapComments<'_>) -> u32 {
        let ahead = gap.leading.first().map(|c| c.span.start);
        ahead.unwrap_or(gap.next)
    }

    /// Returns whether the comment is documentation that neither the declaration nor the doc comment at source offset
    /// `next` continues.
    fn ends_documentation(&self, comment: &Comment, next: u32) -> bool {
        comment.kind == CommentKind::Doc && !self.source.documents(comment.span.end, next)
    }

    /// Inserts pieces before the piece at index `at`, and indents them by one step together with the node of the
    /// document that opens there.
    fn insert_indented(&mut self, at: usize, pieces: Vec<DocPiece>) {
        let hangs = self.map.is_hanging.get(at).copied().unwrap_or_default();
        let frame = Enclosure::Indent(if hangs { 2 * INDENT } else { INDENT });
        let put = self.insertions.get(&at).and_then(|put| put.last());
        if matches!(
            (put, pieces.first()),
            (Some(DocPiece::Hard), Some(DocPiece::Hard))
        ) {
            // An earlier comment has already broken the line there.
            return self.insert_before(at, pieces.into_iter().skip(1).collect());
        }
        self.insert_before(at, vec![DocPiece::Open(frame)]);
        self.insert_before(at, pieces);
        let places = self.map.pieces[at..].iter();
        let begins = at
            + places
                .take_while(|p| matches!(p, DocPiece::SourceOffset(_)))
                .count();
        let end = self.map.closing_ends.get(begins).copied().unwrap_or(begins);
        self.insert_before(end, vec![DocPiece::Close(frame)]);
    }

    /// Inserts the comments of a gap that share their line with no code, with the empty lines around them. `first` is
    /// true at the start of the document.
    fn insert_own_lines(&mut self, between: &GapPieces, gap: &GapComments<'_>, first: bool) {
        let GapPieces {
            range,
            line_break: line_end,
            ..
        } = between;
        let blanks = self.blank_lines(between, gap, first);
        let mut lines = Vec::new();
        for (comment, blank) in gap.own_line.iter().zip(&blanks) {
            lines.push((*blank, self.comment(comment)));
        }
        let last = blanks.last().is_some_and(|blank| *blank);
        let next = self.map.before_opening(range);
        match *line_end {
            _ if first && range.end < self.map.pieces.len() => {
                self.insert_before(0, lines_after_break(lines, last))
            }
            _ if range.end >= self.map.pieces.len() => {
                // A file with nothing but comments begins with the first comment, not with a line break.
                let lines = lines_before_break(lines)
                    .into_iter()
                    .skip(usize::from(first));
                self.insert_before(range.end, lines.collect());
            }
            Some(at) if between.closes => {
                let end = self.map.block_end(range.start..at);
                match end {
                    Some(end) => self.insert_before(end, lines_before_break(lines)),
                    None => self.insert_indented(
                        self.map.after_closing(range.start),
                        lines_before_break(lines),
                    ),
                }
                self.map.pieces[at] = DocPiece::Hard;
            }
            Some(at) => {
                self.map.pieces[at] = DocPiece::Hard;
                for i in at + 1..range.end {
                    if matches!(self.map.pieces[i], DocPiece::Empty) {
                        self.map.pieces[i] = DocPiece::Text(String::new());
                    }
                }
                self.insert_before(at + 1, lines_after_break(lines, last));
            }
            None if between.closes => {
                self.insert_indented(
                    self.map.after_closing(range.start),
                    lines_before_break(lines),
                );
                self.insert_before(next, vec![DocPiece::Hard]);
            }
            None => {
                let mut pieces = vec![DocPiece::Hard];
                pieces.extend(lines_after_break(lines, last));
                self.insert_indented(next, pieces);
            }
        }
    }

    /// Returns for each comment on its own line whether an empty line precedes it, and last, whether one follows the
    /// last comment. `first` is true at the start of the document.
    fn blank_lines(&self, between: &GapPieces, gap: &GapComments<'_>, first: bool) -> Vec<bool> {
        let source = self.source;
        let pieces = &self.map.pieces[between.range.clone()];
        let line_end = between.line_break.map(|at| &self.map.pieces[at]);
        let in_block = first || matches!(line_end, Some(DocPiece::Hard));
        let head = &pieces[..between.line_break.map_or(0, |at| at - between.range.start)];
        let begins = head
            .iter()
            .any(|p| matches!(p, DocPiece::Open(Enclosure::Indent(_))));
        let kept = line_end.is_some() && (in_block || between.has_separator || begins) || first;
        let mut blanks = Vec::new();
        let mut previous: Option<&Comment> = gap.trailing.last().copied();
        for comment in &gap.own_line {
            let blank = source.has_blank_line(source.previous_end(comment), comment.span.start);
            let opens = previous.is_none() && (begins || first);
            let ends = previous.is_some_and(|p| self.ends_documentation(p, comment.span.start));
            blanks.push(blank && kept && !opens || ends);
            previous = Some(comment);
        }
        if let Some(last) = previous {
            let next = self.next_start(gap);
            let blank = source.has_blank_line(last.span.end, next);
            blanks.push(blank && kept || self.ends_documentation(last, next));
        }
        let apart = pieces.iter().any(|p| matches!(p, DocPiece::Empty));
        if apart && !blanks.contains(&true) {
            blanks[0] = true;
        }
        blanks
    }
}

/// Returns the pieces of comment lines for a position after a line break. Each line is a flag for an empty line before
/// it and its comment; `last` asks for an empty line at the end.
fn lines_after_break(lines: Vec<(bool, DocPiece)>, last: bool) -> Vec<DocPiece> {
    let mut pieces = Vec::new();
    for (blank, line) in lines {
        pieces.extend(blank.then_some(DocPiece::Empty));
        pieces.extend([line, DocPiece::Hard]);
    }
    pieces.extend(last.then_some(DocPiece::Empty));
    pieces
}

/// Returns the pieces of comment lines for a position before a line break. Each line is a flag for an empty line before
/// it and its comment.
fn lines_before_break(lines: Vec<(bool, DocPiece)>) -> Vec<DocPiece> {
    let lines = lines.into_iter().flat_map(|(blank, line)| {
        let empty = blank.then_some(DocPiece::Empty);
        std::iter::once(DocPiece::Hard).chain(empty).chain([line])
    });
    lines.collect()
}
