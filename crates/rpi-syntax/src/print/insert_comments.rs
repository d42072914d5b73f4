//! Inserts the comments of a source into the document of its tree.
//!
//! A comment stays between the same two tokens, separators ignored: at the end of the line of the first token, on the
//! line of the second, or on a line of its own. After a comment that ends a line, the line is broken where the document
//! allows a break. Elsewhere, the next line is indented by one step.

use super::align::{DocWord, align};
use super::flat_doc::{DocPiece, Enclosure, flatten, rebuild};
use super::layout::{Doc, INDENT};
use super::trivia::{GapComments, Source, is_closer};
use crate::comments::{Comment, CommentKind};
use std::collections::BTreeMap;
use std::ops::Range;

/// Returns the document with the comments of the source.
pub(super) fn insert_comments(doc: Doc, source: &Source<'_>) -> Doc {
    if source.comments.is_empty() {
        return doc;
    }
    let pieces = flatten(&doc);
    drop(doc);
    let words: Vec<usize> = (0..pieces.len()).filter(|i| is_word(&pieces[*i])).collect();
    let became = align(
        &source.significant_texts(),
        &doc_words(&pieces, &words, source),
    );
    let mut weaver = CommentInserter {
        source,
        is_hanging: hanging_pieces(&pieces),
        flat_ranges: flat_ranges(&pieces),
        closing_ends: closing_ends(&pieces),
        pieces,
        words,
        insertions: BTreeMap::new(),
    };
    for (all, (before, behind)) in group_by_gap(source, &became) {
        let gap = source.classify(all, weaver.closes(behind));
        weaver.insert_gap(gap, before, behind);
    }
    rebuild(weaver.pieces, weaver.insertions)
}

/// Position in the document: indices of the words before and after it.
type WordGap = (Option<usize>, Option<usize>);

/// Groups the comments by their position in the document.
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

/// Returns whether a piece is a word: a token that is not a separator.
fn is_word(piece: &DocPiece) -> bool {
    matches!(piece, DocPiece::Token(_)) && !piece.is_separator()
}

/// Returns the words of the document. A word at the beginning of a part has its source token as anchor.
fn doc_words<'p>(pieces: &'p [DocPiece], words: &[usize], source: &Source<'_>) -> Vec<DocWord<'p>> {
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
    words.iter().map(word).collect()
}

/// Returns for each piece whether its innermost indenting frame is [`Frame::Hang`].
fn hanging_pieces(pieces: &[DocPiece]) -> Vec<bool> {
    let mut open = vec![false];
    let hang = |piece: &DocPiece| {
        match piece {
            DocPiece::Open(Enclosure::Hang) => open.push(true),
            DocPiece::Open(Enclosure::Indent(_)) => open.push(false),
            DocPiece::Close(Enclosure::Hang | Enclosure::Indent(_)) => drop(open.pop()),
            _ => {}
        }
        open.last().copied().unwrap_or_default()
    };
    pieces.iter().map(hang).collect()
}

/// Returns for each piece the index after its closing piece; its own index if it opens nothing.
fn closing_ends(pieces: &[DocPiece]) -> Vec<usize> {
    let mut ends: Vec<usize> = (0..pieces.len()).collect();
    let mut open = Vec::new();
    for (i, piece) in pieces.iter().enumerate() {
        match piece {
            DocPiece::Open(_) => open.push(i),
            DocPiece::Close(_) => open.pop().into_iter().for_each(|begin| ends[begin] = i + 1),
            _ => {}
        }
    }
    ends
}

/// Returns the piece ranges that are always printed on one line.
fn flat_ranges(pieces: &[DocPiece]) -> Vec<Range<usize>> {
    let mut flats: Vec<Range<usize>> = Vec::new();
    for (i, piece) in pieces.iter().enumerate() {
        match piece {
            DocPiece::Open(Enclosure::Flat) => flats.push(i..i),
            DocPiece::Close(Enclosure::Flat) => {
                flats.iter_mut().rev().take(1).for_each(|f| f.end = i)
            }
            _ => {}
        }
    }
    flats
}

/// State of the insertion of comments.
struct CommentInserter<'s> {
    source: &'s Source<'s>,
    pieces: Vec<DocPiece>,
    /// Indices of the pieces that are words.
    words: Vec<usize>,
    /// For each piece, whether its innermost indenting frame is [`Frame::Hang`].
    is_hanging: Vec<bool>,
    /// Ranges of pieces that are always on one line.
    flat_ranges: Vec<Range<usize>>,
    /// For each piece, the index after its closing piece.
    closing_ends: Vec<usize>,
    /// Pieces to insert before a piece, by its index.
    insertions: BTreeMap<usize, Vec<DocPiece>>,
}

/// Pieces between two words of the document.
struct GapPieces {
    /// Range from the first word, or the separator after it, to the second word.
    range: Range<usize>,
    /// Index of the first line break in the range.
    line_break: Option<usize>,
    /// Whether the second word closes a bracket or block.
    closes: bool,
    /// Whether a separator follows the first word.
    has_separator: bool,
}

impl CommentInserter<'_> {
    /// Inserts the comments between two words.
    fn insert_gap(
        &mut self,
        mut gap: GapComments<'_>,
        before: Option<usize>,
        behind: Option<usize>,
    ) {
        let lead = self.gap_pieces(behind);
        let after = before.map_or(0, |word| self.words[word] + 1);
        let after = self.flat_end(after, lead.range.end);
        self.insert_before_separator(&mut gap, after);
        let end = self.after_closing(self.after_separator(after));
        if let Some(frame) = self.flat_around(end, lead.range.end) {
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
        self.insert_before(self.flat_start(lead.range.end), ahead);
    }

    /// Returns the start of the flat range that begins with this word, else the word's own index.
    // Other comments of the flat range are also inserted there, after this one.
    fn flat_start(&self, word: usize) -> usize {
        let next = self.flat_ranges.partition_point(|flat| flat.end < word);
        let around = self.flat_ranges.get(next).filter(|flat| flat.start < word);
        let is_first = |flat: &&Range<usize>| {
            let between = &self.pieces[flat.start..word];
            !between.iter().any(|p| matches!(p, DocPiece::Token(_)))
        };
        around.filter(is_first).map_or(word, |flat| flat.start)
    }

    /// Inserts comments between a word and its separator or closing bracket.
    fn insert_before_separator(&mut self, gap: &mut GapComments<'_>, after: usize) {
        let breaks = !gap.trailing.is_empty() || !gap.own_line.is_empty();
        if self.ends_line(after) || breaks && self.after_separator(after) == after {
            gap.trailing.splice(..0, gap.before_separator.drain(..));
        }
        let within = gap
            .before_separator
            .iter()
            .flat_map(|c| self.inline_pieces(after, c, true));
        let within: Vec<DocPiece> = within.collect();
        self.insert_before(after, within);
    }

    /// Inserts comments at the end of a line.
    fn insert_suffixes(&mut self, gap: &mut GapComments<'_>, end: usize, lead: &GapPieces) {
        if gap.trailing.is_empty() {
            return;
        }
        let suffixes = gap.trailing.iter();
        let suffixes = suffixes.map(|c| DocPiece::Suffix(self.source.comment_text(c)));
        self.insert_before(end, suffixes.collect());
        let follows = self.words.partition_point(|word| *word < end);
        let follows = self.gap_pieces(Some(follows));
        let apart = follows.range != lead.range;
        if gap.own_line.is_empty() || apart {
            self.break_line(&follows, gap);
        }
        if apart {
            // The comments on lines of their own are not directly below these.
            gap.trailing.clear();
        }
    }

    /// Inserts pieces before index `at`, after earlier insertions there.
    fn insert_before(&mut self, at: usize, pieces: Vec<DocPiece>) {
        self.insertions.entry(at).or_default().extend(pieces);
    }

    fn comment(&self, comment: &Comment) -> DocPiece {
        DocPiece::Text(self.source.comment_text(comment))
    }

    /// Returns the pieces of a comment within a line: after a token if `behind`, else before one.
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
        let mut before = self.pieces[..at].iter().rev();
        let apart = touches(before.find(|p| !takes_no_room(p)));
        let mut pieces = Vec::new();
        pieces.extend(apart.then(|| DocPiece::Text(" ".into())));
        pieces.push(self.comment(comment));
        pieces.extend((!behind).then(|| DocPiece::Text(" ".into())));
        pieces
    }

    /// Returns whether a line break is possible before the next token.
    fn ends_line(&self, after: usize) -> bool {
        let mut rest = self.pieces[after..].iter();
        let next = rest.find(|p| p.is_break() || matches!(p, DocPiece::Token(_)));
        next.is_none_or(DocPiece::is_break)
    }

    /// Returns the index after the separators that directly follow, or `after`.
    fn after_separator(&self, after: usize) -> usize {
        let mut end = after;
        for (i, piece) in self.pieces.iter().enumerate().skip(after) {
            match piece {
                DocPiece::Open(_) | DocPiece::Close(_) | DocPiece::SourceOffset(_) => {}
                piece if piece.is_separator() => end = i + 1,
                _ => break,
            }
        }
        end
    }

    /// Returns the index after the frames that close at `after`, so that a comment there does not break them.
    fn after_closing(&self, after: usize) -> usize {
        let indents = |piece: &&DocPiece| matches!(piece, DocPiece::Close(Enclosure::Indent(_)));
        let ends = |p: &&DocPiece| {
            matches!(p, DocPiece::Close(_) | DocPiece::SourceOffset(_)) && !indents(p)
        };
        let count = self.pieces[after..].iter().take_while(ends).count();
        // An offset belongs to the piece after it.
        let is_end = |i: &usize| matches!(self.pieces[*i], DocPiece::Close(_));
        let last = (after..after + count).rfind(is_end);
        last.map_or(after, |last| last + 1)
    }

    /// Returns the index before the frames that open at the end of a range, so that a line break does not break them.
    fn before_opening(&self, range: &Range<usize>) -> usize {
        let begins =
            |piece: &&DocPiece| matches!(piece, DocPiece::Open(_) | DocPiece::SourceOffset(_));
        let begun = self.pieces[range.clone()].iter().rev().take_while(begins);
        range.end - begun.count()
    }

    /// Returns the pieces before a word, or after the last word.
    fn gap_pieces(&self, word: Option<usize>) -> GapPieces {
        let count = self.words.len();
        let word = word.unwrap_or(count);
        let after = word
            .checked_sub(1)
            .map_or(0, |before| self.words[before] + 1);
        let to = self.words.get(word).copied().unwrap_or(self.pieces.len());
        let from = self.after_separator(after).min(to);
        GapPieces {
            line_break: (from..to).find(|i| self.pieces[*i].is_break()),
            closes: self.closes(Some(word)),
            has_separator: from > after,
            range: from..to,
        }
    }

    /// Returns whether a word closes a bracket or block.
    fn closes(&self, word: Option<usize>) -> bool {
        let at = word.and_then(|word| self.words.get(word));
        let piece = at.and_then(|at| self.pieces.get(*at));
        matches!(piece, Some(DocPiece::Token(text)) if is_closer(text))
    }

    /// Returns the start of the flat range that contains both positions.
    fn flat_around(&self, from: usize, to: usize) -> Option<usize> {
        let next = self.flat_ranges.partition_point(|flat| flat.end < to);
        let flat = self.flat_ranges.get(next)?;
        (flat.start < from).then_some(flat.start)
    }

    /// Returns the end of the flat range that contains `from` but not `to`, else `from`.
    // No comment may end a line within a flat range.
    fn flat_end(&self, from: usize, to: usize) -> usize {
        let next = self.flat_ranges.partition_point(|flat| flat.end < from);
        let around = self.flat_ranges.get(next);
        let around = around.filter(|flat| flat.start < from && flat.end < to);
        around.map_or(from, |flat| flat.end)
    }

    /// Breaks the line after a comment at its end.
    fn break_line(&mut self, between: &GapPieces, gap: &GapComments<'_>) {
        if between.range.end >= self.pieces.len() {
            return;
        }
        let to = self.before_opening(&between.range);
        match between.line_break {
            Some(at) => self.pieces[at] = DocPiece::Hard,
            None if between.closes => self.insert_before(to, vec![DocPiece::Hard]),
            None => self.insert_indented(to, vec![DocPiece::Hard]),
        }
        if let Some(last) = gap.trailing.last().filter(|_| gap.own_line.is_empty())
            && self.ends_documentation(last, self.next_start(gap))
            && !self.pieces[between.range.clone()]
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

    /// Returns whether a comment is a doc comment that does not continue at offset `next`.
    fn ends_documentation(&self, comment: &Comment, next: u32) -> bool {
        comment.kind == CommentKind::Doc && !self.source.documents(comment.span.end, next)
    }

    /// Inserts pieces before index `at` and indents them, with the frame that opens there, by one step.
    fn insert_indented(&mut self, at: usize, pieces: Vec<DocPiece>) {
        let hangs = self.is_hanging.get(at).copied().unwrap_or_default();
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
        let places = self.pieces[at..].iter();
        let begins = at
            + places
                .take_while(|p| matches!(p, DocPiece::SourceOffset(_)))
                .count();
        let end = self.closing_ends.get(begins).copied().unwrap_or(begins);
        self.insert_before(end, vec![DocPiece::Close(frame)]);
    }

    /// Inserts comments on lines of their own.
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
        let next = self.before_opening(range);
        match *line_end {
            _ if first && range.end < self.pieces.len() => {
                self.insert_before(0, lines_after_break(lines, last))
            }
            _ if range.end >= self.pieces.len() => {
                // A file with nothing but comments begins with the first comment, not with a line break.
                let lines = lines_before_break(lines)
                    .into_iter()
                    .skip(usize::from(first));
                self.insert_before(range.end, lines.collect());
            }
            Some(at) if between.closes => {
                let end = self.block_end(range.start..at);
                match end {
                    Some(end) => self.insert_before(end, lines_before_break(lines)),
                    None => self.insert_indented(
                        self.after_closing(range.start),
                        lines_before_break(lines),
                    ),
                }
                self.pieces[at] = DocPiece::Hard;
            }
            Some(at) => {
                self.pieces[at] = DocPiece::Hard;
                for i in at + 1..range.end {
                    if matches!(self.pieces[i], DocPiece::Empty) {
                        self.pieces[i] = DocPiece::Text(String::new());
                    }
                }
                self.insert_before(at + 1, lines_after_break(lines, last));
            }
            None if between.closes => {
                self.insert_indented(self.after_closing(range.start), lines_before_break(lines));
                self.insert_before(next, vec![DocPiece::Hard]);
            }
            None => {
                let mut pieces = vec![DocPiece::Hard];
                pieces.extend(lines_after_break(lines, last));
                self.insert_indented(next, pieces);
            }
        }
    }

    /// Returns the index of the piece that ends the indentation of a block, before its closing keyword.
    fn block_end(&self, mut range: Range<usize>) -> Option<usize> {
        range.rfind(|i| matches!(self.pieces[*i], DocPiece::Close(Enclosure::Indent(_))))
    }

    /// Returns whether an empty line precedes each comment, and the piece after the last comment.
    fn blank_lines(&self, between: &GapPieces, gap: &GapComments<'_>, first: bool) -> Vec<bool> {
        let source = self.source;
        let pieces = &self.pieces[between.range.clone()];
        let line_end = between.line_break.map(|at| &self.pieces[at]);
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

/// Returns comment lines for a position after a line break: each line is followed by a line break.
fn lines_after_break(lines: Vec<(bool, DocPiece)>, last: bool) -> Vec<DocPiece> {
    let mut pieces = Vec::new();
    for (blank, line) in lines {
        pieces.extend(blank.then_some(DocPiece::Empty));
        pieces.extend([line, DocPiece::Hard]);
    }
    pieces.extend(last.then_some(DocPiece::Empty));
    pieces
}

/// Returns comment lines for a position before a line break: each line is preceded by a line break.
fn lines_before_break(lines: Vec<(bool, DocPiece)>) -> Vec<DocPiece> {
    let lines = lines.into_iter().flat_map(|(blank, line)| {
        let empty = blank.then_some(DocPiece::Empty);
        std::iter::once(DocPiece::Hard).chain(empty).chain([line])
    });
    lines.collect()
}
