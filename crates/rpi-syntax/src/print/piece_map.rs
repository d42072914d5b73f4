//! Pieces of a printed document, with the positions of its words, line breaks and enclosures.

use super::flat_doc::{DocPiece, Enclosure};
use super::trivia::is_closer;
use std::ops::Range;

/// Pieces of a flattened document, with indices for the insertion of comments. A word is a token other than `,` and
/// `;`.
pub(super) struct PieceMap {
    pub(super) pieces: Vec<DocPiece>,
    /// Indices of the pieces that are words.
    pub(super) words: Vec<usize>,
    /// For each piece, whether its innermost indentation is [`Enclosure::Hang`].
    pub(super) is_hanging: Vec<bool>,
    /// Ranges of pieces that are always printed on one line, in ascending order.
    flat_ranges: Vec<Range<usize>>,
    /// For each piece, the index after its closing piece; its own index if it opens nothing.
    pub(super) closing_ends: Vec<usize>,
}

/// Pieces between two adjacent words of the document.
pub(super) struct GapPieces {
    /// Range of piece indices from the first word, or the separator after it, to the second word.
    pub(super) range: Range<usize>,
    /// Index of the first line break in the range; `None` if there is none.
    pub(super) line_break: Option<usize>,
    /// Whether the second word closes a bracket or block.
    pub(super) closes: bool,
    /// Whether a separator follows the first word.
    pub(super) has_separator: bool,
}

impl PieceMap {
    pub(super) fn new(pieces: Vec<DocPiece>) -> PieceMap {
        PieceMap {
            words: (0..pieces.len()).filter(|i| is_word(&pieces[*i])).collect(),
            is_hanging: hanging_pieces(&pieces),
            flat_ranges: flat_ranges(&pieces),
            closing_ends: closing_ends(&pieces),
            pieces,
        }
    }

    /// Returns the start of the one-line range whose first word is at piece `word`; `word` itself if there is none.
    // Other comments of the flat range are also inserted there, after this one.
    pub(super) fn flat_start(&self, word: usize) -> usize {
        let next = self.flat_ranges.partition_point(|flat| flat.end < word);
        let around = self.flat_ranges.get(next).filter(|flat| flat.start < word);
        let is_first = |flat: &&Range<usize>| {
            let between = &self.pieces[flat.start..word];
            !between.iter().any(|p| matches!(p, DocPiece::Token(_)))
        };
        around.filter(is_first).map_or(word, |flat| flat.start)
    }

    /// Returns whether a line break is possible between the piece at index `after` and the next token.
    pub(super) fn ends_line(&self, after: usize) -> bool {
        let mut rest = self.pieces[after..].iter();
        let next = rest.find(|p| p.is_break() || matches!(p, DocPiece::Token(_)));
        next.is_none_or(DocPiece::is_break)
    }

    /// Returns the index after the separators at piece `after`; `after` itself if there are none.
    pub(super) fn after_separator(&self, after: usize) -> usize {
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

    /// Returns the index after the groups that close at piece `after`. A comment at that index does not break their
    /// lines.
    pub(super) fn after_closing(&self, after: usize) -> usize {
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

    /// Returns the index before the groups that open at the end of the range. A line break at that index does not break
    /// their lines.
    pub(super) fn before_opening(&self, range: &Range<usize>) -> usize {
        let begins =
            |piece: &&DocPiece| matches!(piece, DocPiece::Open(_) | DocPiece::SourceOffset(_));
        let begun = self.pieces[range.clone()].iter().rev().take_while(begins);
        range.end - begun.count()
    }

    /// Returns the pieces between the word with the index `word` and the word before it; for `None`, the pieces after
    /// the last word.
    pub(super) fn gap_pieces(&self, word: Option<usize>) -> GapPieces {
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

    /// Returns whether the word with the index `word` closes a bracket or block; false for `None`.
    pub(super) fn closes(&self, word: Option<usize>) -> bool {
        let at = word.and_then(|word| self.words.get(word));
        let piece = at.and_then(|at| self.pieces.get(*at));
        matches!(piece, Some(DocPiece::Token(text)) if is_closer(text))
    }

    /// Returns the start of the one-line range that contains both piece indices; `None` if there is none.
    pub(super) fn flat_around(&self, from: usize, to: usize) -> Option<usize> {
        let next = self.flat_ranges.partition_point(|flat| flat.end < to);
        let flat = self.flat_ranges.get(next)?;
        (flat.start < from).then_some(flat.start)
    }

    /// Returns the end of the innermost range of pieces to be printed on one line that contains the piece with index
    /// `from` but not the one with index `to`; `from` itself if there is none.
    // No comment may end a line within a flat range.
    pub(super) fn flat_end(&self, from: usize, to: usize) -> usize {
        let next = self.flat_ranges.partition_point(|flat| flat.end < from);
        let around = self.flat_ranges.get(next);
        let around = around.filter(|flat| flat.start < from && flat.end < to);
        around.map_or(from, |flat| flat.end)
    }

    /// Returns the index of the last piece in the range that closes an indentation, as the piece before the closing
    /// keyword of a block does; `None` if there is none.
    pub(super) fn block_end(&self, mut range: Range<usize>) -> Option<usize> {
        range.rfind(|i| matches!(self.pieces[*i], DocPiece::Close(Enclosure::Indent(_))))
    }
}

/// Returns whether a piece is a word: a token other than `,` and `;`.
fn is_word(piece: &DocPiece) -> bool {
    matches!(piece, DocPiece::Token(_)) && !piece.is_separator()
}

/// Returns for each piece whether its innermost indentation is [`Enclosure::Hang`].
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

/// Returns the ranges of pieces that are always printed on one line.
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
