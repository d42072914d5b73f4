//! Inserts the comments of a source into the document of its tree.
//!
//! A comment stays between the same two tokens, separators ignored: at the end of the line of the first token, on the
//! line of the second, or on a line of its own. After a comment that ends a line, the line is broken where the document
//! allows a break. Elsewhere, the next line is indented by one step.

use super::align::{Printed, align};
use super::gaps::{Gap, Source, is_closer};
use super::layout::{Doc, STEP};
use super::pieces::{Frame, Piece, pieces, rebuilt};
use crate::comments::{Comment, CommentKind};
use std::collections::BTreeMap;
use std::ops::Range;

/// Returns the document with the comments of the source.
pub(super) fn weave(doc: Doc, source: &Source<'_>) -> Doc {
    if source.comments.is_empty() {
        return doc;
    }
    let pieces = pieces(&doc);
    drop(doc);
    let words: Vec<usize> = (0..pieces.len()).filter(|i| is_word(&pieces[*i])).collect();
    let became = align(&source.words(), &printed(&pieces, &words, source));
    let mut weaver = Weaver {
        source,
        hangs: hangs(&pieces),
        flats: flats(&pieces),
        ends: ends(&pieces),
        pieces,
        words,
        put: BTreeMap::new(),
    };
    for (all, (before, behind)) in together(source, &became) {
        let gap = source.gap(all, weaver.closes(behind));
        weaver.gap(gap, before, behind);
    }
    rebuilt(weaver.pieces, weaver.put)
}

/// Position in the document: indices of the words before and after it.
type Place = (Option<usize>, Option<usize>);

/// Groups the comments by their position in the document.
// Words between two comments may be omitted by the style, so comments from different gaps can meet in one position.
fn together<'a>(source: &Source<'a>, became: &[Option<usize>]) -> Vec<(&'a [Comment], Place)> {
    let place = |comment: &Comment| {
        let next = source.word_at(comment.span.start);
        let before = became[..next].iter().rev().flatten().next();
        let behind = became[next..].iter().flatten().next();
        (before.copied(), behind.copied())
    };
    let mut found: Vec<(Range<usize>, Place)> = Vec::new();
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
fn is_word(piece: &Piece) -> bool {
    matches!(piece, Piece::Token(_)) && !piece.is_separator()
}

/// Returns the words of the document. A word at the beginning of a part has its source token as anchor.
fn printed<'p>(pieces: &'p [Piece], words: &[usize], source: &Source<'_>) -> Vec<Printed<'p>> {
    let mut from = 0;
    let word = |i: &usize| {
        let part = pieces[from..*i].iter().rev().find_map(|piece| match piece {
            Piece::At(offset) => Some(*offset),
            _ => None,
        });
        from = *i;
        Printed {
            text: match &pieces[*i] {
                Piece::Token(text) => text,
                _ => "",
            },
            anchor: part.map(|offset| source.word_at(offset)),
        }
    };
    words.iter().map(word).collect()
}

/// Returns for each piece whether its innermost indenting frame is [`Frame::Hang`].
fn hangs(pieces: &[Piece]) -> Vec<bool> {
    let mut open = vec![false];
    let hang = |piece: &Piece| {
        match piece {
            Piece::Open(Frame::Hang) => open.push(true),
            Piece::Open(Frame::Indent(_)) => open.push(false),
            Piece::Close(Frame::Hang | Frame::Indent(_)) => drop(open.pop()),
            _ => {}
        }
        open.last().copied().unwrap_or_default()
    };
    pieces.iter().map(hang).collect()
}

/// Returns for each piece the index after its closing piece; its own index if it opens nothing.
fn ends(pieces: &[Piece]) -> Vec<usize> {
    let mut ends: Vec<usize> = (0..pieces.len()).collect();
    let mut open = Vec::new();
    for (i, piece) in pieces.iter().enumerate() {
        match piece {
            Piece::Open(_) => open.push(i),
            Piece::Close(_) => open.pop().into_iter().for_each(|begin| ends[begin] = i + 1),
            _ => {}
        }
    }
    ends
}

/// Returns the piece ranges that are always printed on one line.
fn flats(pieces: &[Piece]) -> Vec<Range<usize>> {
    let mut flats: Vec<Range<usize>> = Vec::new();
    for (i, piece) in pieces.iter().enumerate() {
        match piece {
            Piece::Open(Frame::Flat) => flats.push(i..i),
            Piece::Close(Frame::Flat) => flats.iter_mut().rev().take(1).for_each(|f| f.end = i),
            _ => {}
        }
    }
    flats
}

/// State of the insertion of comments.
struct Weaver<'s> {
    source: &'s Source<'s>,
    pieces: Vec<Piece>,
    /// Indices of the pieces that are words.
    words: Vec<usize>,
    /// For each piece, whether its innermost indenting frame is [`Frame::Hang`].
    hangs: Vec<bool>,
    /// Ranges of pieces that are always on one line.
    flats: Vec<Range<usize>>,
    /// For each piece, the index after its closing piece.
    ends: Vec<usize>,
    /// Pieces to insert before a piece, by its index.
    put: BTreeMap<usize, Vec<Piece>>,
}

/// Pieces between two words of the document.
struct Between {
    /// Range from the first word, or the separator after it, to the second word.
    range: Range<usize>,
    /// Index of the first line break in the range.
    line_end: Option<usize>,
    /// Whether the second word closes a bracket or block.
    closes: bool,
    /// Whether a separator follows the first word.
    separated: bool,
}

impl Weaver<'_> {
    /// Inserts the comments between two words.
    fn gap(&mut self, mut gap: Gap<'_>, before: Option<usize>, behind: Option<usize>) {
        let lead = self.between(behind);
        let after = before.map_or(0, |word| self.words[word] + 1);
        let after = self.out_of_flat(after, lead.range.end);
        self.within(&mut gap, after);
        let end = self.behind_frames(self.behind_separator(after));
        if let Some(frame) = self.flat_around(end, lead.range.end) {
            let all = gap.behind.iter().chain(&gap.own).chain(&gap.ahead);
            let lines = all.flat_map(|c| [self.comment(c), Piece::Hard]);
            let lines = lines.collect();
            // Text inserted earlier before the same piece gets a line of its own.
            if let Some(room @ Piece::Other(_)) =
                self.put.get_mut(&frame).and_then(|p| p.last_mut())
            {
                *room = Piece::Hard;
            }
            return self.put(frame, lines);
        }
        self.behind(&mut gap, end, &lead);
        if !gap.own.is_empty() {
            self.own(&lead, &gap, before.is_none());
        }
        let ahead = gap.ahead.iter();
        let ahead = ahead.flat_map(|c| self.inline(lead.range.end, c, false));
        let ahead = ahead.collect();
        self.put(self.before_flat(lead.range.end), ahead);
    }

    /// Returns the start of the flat range that begins with this word, else the word's own index.
    // Other comments of the flat range are also inserted there, after this one.
    fn before_flat(&self, word: usize) -> usize {
        let next = self.flats.partition_point(|flat| flat.end < word);
        let around = self.flats.get(next).filter(|flat| flat.start < word);
        let is_first = |flat: &&Range<usize>| {
            let between = &self.pieces[flat.start..word];
            !between.iter().any(|p| matches!(p, Piece::Token(_)))
        };
        around.filter(is_first).map_or(word, |flat| flat.start)
    }

    /// Inserts comments between a word and its separator or closing bracket.
    fn within(&mut self, gap: &mut Gap<'_>, after: usize) {
        let breaks = !gap.behind.is_empty() || !gap.own.is_empty();
        if self.ends_line(after) || breaks && self.behind_separator(after) == after {
            gap.behind.splice(..0, gap.within.drain(..));
        }
        let within = gap.within.iter().flat_map(|c| self.inline(after, c, true));
        let within: Vec<Piece> = within.collect();
        self.put(after, within);
    }

    /// Inserts comments at the end of a line.
    fn behind(&mut self, gap: &mut Gap<'_>, end: usize, lead: &Between) {
        if gap.behind.is_empty() {
            return;
        }
        let suffixes = gap.behind.iter();
        let suffixes = suffixes.map(|c| Piece::Suffix(self.source.written(c)));
        self.put(end, suffixes.collect());
        let follows = self.words.partition_point(|word| *word < end);
        let follows = self.between(Some(follows));
        let apart = follows.range != lead.range;
        if gap.own.is_empty() || apart {
            self.break_line(&follows, gap);
        }
        if apart {
            // The comments on lines of their own are not directly below these.
            gap.behind.clear();
        }
    }

    /// Inserts pieces before index `at`, after earlier insertions there.
    fn put(&mut self, at: usize, pieces: Vec<Piece>) {
        self.put.entry(at).or_default().extend(pieces);
    }

    fn comment(&self, comment: &Comment) -> Piece {
        Piece::Other(self.source.written(comment))
    }

    /// Returns the pieces of a comment within a line: after a token if `behind`, else before one.
    fn inline(&self, at: usize, comment: &Comment, behind: bool) -> Vec<Piece> {
        let touches = |piece: Option<&Piece>| match piece {
            Some(Piece::Token(text)) => !matches!(text.as_str(), "(" | "[" | "{" | "<<"),
            _ => false,
        };
        let takes_no_room =
            |p: &&Piece| matches!(p, Piece::At(_) | Piece::Open(_) | Piece::Close(_));
        let mut before = self.pieces[..at].iter().rev();
        let apart = touches(before.find(|p| !takes_no_room(p)));
        let mut pieces = Vec::new();
        pieces.extend(apart.then(|| Piece::Other(" ".into())));
        pieces.push(self.comment(comment));
        pieces.extend((!behind).then(|| Piece::Other(" ".into())));
        pieces
    }

    /// Returns whether a line break is possible before the next token.
    fn ends_line(&self, after: usize) -> bool {
        let mut rest = self.pieces[after..].iter();
        let next = rest.find(|p| p.is_break() || matches!(p, Piece::Token(_)));
        next.is_none_or(Piece::is_break)
    }

    /// Returns the index after the separators that directly follow, or `after`.
    fn behind_separator(&self, after: usize) -> usize {
        let mut end = after;
        for (i, piece) in self.pieces.iter().enumerate().skip(after) {
            match piece {
                Piece::Open(_) | Piece::Close(_) | Piece::At(_) => {}
                piece if piece.is_separator() => end = i + 1,
                _ => break,
            }
        }
        end
    }

    /// Returns the index after the frames that close at `after`, so that a comment there does not break them.
    fn behind_frames(&self, after: usize) -> usize {
        let indents = |piece: &&Piece| matches!(piece, Piece::Close(Frame::Indent(_)));
        let ends = |p: &&Piece| matches!(p, Piece::Close(_) | Piece::At(_)) && !indents(p);
        let count = self.pieces[after..].iter().take_while(ends).count();
        // An offset belongs to the piece after it.
        let is_end = |i: &usize| matches!(self.pieces[*i], Piece::Close(_));
        let last = (after..after + count).rfind(is_end);
        last.map_or(after, |last| last + 1)
    }

    /// Returns the index before the frames that open at the end of a range, so that a line break does not break them.
    fn before_frames(&self, range: &Range<usize>) -> usize {
        let begins = |piece: &&Piece| matches!(piece, Piece::Open(_) | Piece::At(_));
        let begun = self.pieces[range.clone()].iter().rev().take_while(begins);
        range.end - begun.count()
    }

    /// Returns the pieces before a word, or after the last word.
    fn between(&self, word: Option<usize>) -> Between {
        let count = self.words.len();
        let word = word.unwrap_or(count);
        let after = word
            .checked_sub(1)
            .map_or(0, |before| self.words[before] + 1);
        let to = self.words.get(word).copied().unwrap_or(self.pieces.len());
        let from = self.behind_separator(after).min(to);
        Between {
            line_end: (from..to).find(|i| self.pieces[*i].is_break()),
            closes: self.closes(Some(word)),
            separated: from > after,
            range: from..to,
        }
    }

    /// Returns whether a word closes a bracket or block.
    fn closes(&self, word: Option<usize>) -> bool {
        let at = word.and_then(|word| self.words.get(word));
        let piece = at.and_then(|at| self.pieces.get(*at));
        matches!(piece, Some(Piece::Token(text)) if is_closer(text))
    }

    /// Returns the start of the flat range that contains both positions.
    fn flat_around(&self, from: usize, to: usize) -> Option<usize> {
        let next = self.flats.partition_point(|flat| flat.end < to);
        let flat = self.flats.get(next)?;
        (flat.start < from).then_some(flat.start)
    }

    /// Returns the end of the flat range that contains `from` but not `to`, else `from`.
    // No comment may end a line within a flat range.
    fn out_of_flat(&self, from: usize, to: usize) -> usize {
        let next = self.flats.partition_point(|flat| flat.end < from);
        let around = self.flats.get(next);
        let around = around.filter(|flat| flat.start < from && flat.end < to);
        around.map_or(from, |flat| flat.end)
    }

    /// Breaks the line after a comment at its end.
    fn break_line(&mut self, between: &Between, gap: &Gap<'_>) {
        if between.range.end >= self.pieces.len() {
            return;
        }
        let to = self.before_frames(&between.range);
        match between.line_end {
            Some(at) => self.pieces[at] = Piece::Hard,
            None if between.closes => self.put(to, vec![Piece::Hard]),
            None => self.step(to, vec![Piece::Hard]),
        }
        if let Some(last) = gap.behind.last().filter(|_| gap.own.is_empty())
            && self.ends_documentation(last, self.next_start(gap))
            && !self.pieces[between.range.clone()]
                .iter()
                .any(|p| matches!(p, Piece::Empty))
        {
            self.put(to, vec![Piece::Empty]);
        }
    }

    fn next_start(&self, gap: &Gap<'_>) -> u32 {
        let ahead = gap.ahead.first().map(|c| c.span.start);
        ahead.unwrap_or(gap.next)
    }

    /// Returns whether a comment is a doc comment that does not continue at offset `next`.
    fn ends_documentation(&self, comment: &Comment, next: u32) -> bool {
        comment.kind == CommentKind::Doc && !self.source.documents(comment.span.end, next)
    }

    /// Inserts pieces before index `at` and indents them, with the frame that opens there, by one step.
    fn step(&mut self, at: usize, pieces: Vec<Piece>) {
        let hangs = self.hangs.get(at).copied().unwrap_or_default();
        let frame = Frame::Indent(if hangs { 2 * STEP } else { STEP });
        let put = self.put.get(&at).and_then(|put| put.last());
        if matches!(
            (put, pieces.first()),
            (Some(Piece::Hard), Some(Piece::Hard))
        ) {
            // An earlier comment has already broken the line there.
            return self.put(at, pieces.into_iter().skip(1).collect());
        }
        self.put(at, vec![Piece::Open(frame)]);
        self.put(at, pieces);
        let places = self.pieces[at..].iter();
        let begins = at + places.take_while(|p| matches!(p, Piece::At(_))).count();
        let end = self.ends.get(begins).copied().unwrap_or(begins);
        self.put(end, vec![Piece::Close(frame)]);
    }

    /// Inserts comments on lines of their own.
    fn own(&mut self, between: &Between, gap: &Gap<'_>, first: bool) {
        let Between {
            range, line_end, ..
        } = between;
        let blanks = self.blanks(between, gap, first);
        let mut lines = Vec::new();
        for (comment, blank) in gap.own.iter().zip(&blanks) {
            lines.push((*blank, self.comment(comment)));
        }
        let last = blanks.last().is_some_and(|blank| *blank);
        let next = self.before_frames(range);
        match *line_end {
            _ if first && range.end < self.pieces.len() => self.put(0, below(lines, last)),
            _ if range.end >= self.pieces.len() => {
                // A file with nothing but comments begins with the first comment, not with a line break.
                let lines = above(lines).into_iter().skip(usize::from(first));
                self.put(range.end, lines.collect());
            }
            Some(at) if between.closes => {
                let end = self.block_end(range.start..at);
                match end {
                    Some(end) => self.put(end, above(lines)),
                    None => self.step(self.behind_frames(range.start), above(lines)),
                }
                self.pieces[at] = Piece::Hard;
            }
            Some(at) => {
                self.pieces[at] = Piece::Hard;
                for i in at + 1..range.end {
                    if matches!(self.pieces[i], Piece::Empty) {
                        self.pieces[i] = Piece::Other(String::new());
                    }
                }
                self.put(at + 1, below(lines, last));
            }
            None if between.closes => {
                self.step(self.behind_frames(range.start), above(lines));
                self.put(next, vec![Piece::Hard]);
            }
            None => {
                let mut pieces = vec![Piece::Hard];
                pieces.extend(below(lines, last));
                self.step(next, pieces);
            }
        }
    }

    /// Returns the index of the piece that ends the indentation of a block, before its closing keyword.
    fn block_end(&self, mut range: Range<usize>) -> Option<usize> {
        range.rfind(|i| matches!(self.pieces[*i], Piece::Close(Frame::Indent(_))))
    }

    /// Returns whether an empty line precedes each comment, and the piece after the last comment.
    fn blanks(&self, between: &Between, gap: &Gap<'_>, first: bool) -> Vec<bool> {
        let source = self.source;
        let pieces = &self.pieces[between.range.clone()];
        let line_end = between.line_end.map(|at| &self.pieces[at]);
        let in_block = first || matches!(line_end, Some(Piece::Hard));
        let head = &pieces[..between.line_end.map_or(0, |at| at - between.range.start)];
        let begins = head
            .iter()
            .any(|p| matches!(p, Piece::Open(Frame::Indent(_))));
        let kept = line_end.is_some() && (in_block || between.separated || begins) || first;
        let mut blanks = Vec::new();
        let mut previous: Option<&Comment> = gap.behind.last().copied();
        for comment in &gap.own {
            let blank = source.is_blank(source.reached(comment), comment.span.start);
            let opens = previous.is_none() && (begins || first);
            let ends = previous.is_some_and(|p| self.ends_documentation(p, comment.span.start));
            blanks.push(blank && kept && !opens || ends);
            previous = Some(comment);
        }
        if let Some(last) = previous {
            let next = self.next_start(gap);
            let blank = source.is_blank(last.span.end, next);
            blanks.push(blank && kept || self.ends_documentation(last, next));
        }
        let apart = pieces.iter().any(|p| matches!(p, Piece::Empty));
        if apart && !blanks.contains(&true) {
            blanks[0] = true;
        }
        blanks
    }
}

/// Returns comment lines for a position after a line break: each line is followed by a line break.
fn below(lines: Vec<(bool, Piece)>, last: bool) -> Vec<Piece> {
    let mut pieces = Vec::new();
    for (blank, line) in lines {
        pieces.extend(blank.then_some(Piece::Empty));
        pieces.extend([line, Piece::Hard]);
    }
    pieces.extend(last.then_some(Piece::Empty));
    pieces
}

/// Returns comment lines for a position before a line break: each line is preceded by a line break.
fn above(lines: Vec<(bool, Piece)>) -> Vec<Piece> {
    let lines = lines.into_iter().flat_map(|(blank, line)| {
        let empty = blank.then_some(Piece::Empty);
        std::iter::once(Piece::Hard).chain(empty).chain([line])
    });
    lines.collect()
}
