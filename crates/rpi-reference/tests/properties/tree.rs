//! Program as a tree of texts, which can be written and reduced.

use std::collections::BTreeSet;

use crate::types::{Kind, Ty};

/// Element of a tree.
#[derive(Clone, Debug)]
pub(crate) enum Piece {
    /// Text.
    Text(String),
    /// Subtree.
    Tree(Tree),
}

/// Part of a program.
#[derive(Clone, Debug)]
pub(crate) struct Tree {
    /// Role, which determines the allowed replacements.
    pub(crate) role: Role,
    pub(crate) pieces: Vec<Piece>,
}

/// Role of a part.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(crate) enum Role {
    /// Expression of a type.
    Expr(Ty),
    /// Statement or declaration that can be removed. All items of the same number, unless 0, are removed together.
    Item(usize),
    /// Any other part.
    Rest,
}

impl Tree {
    pub(crate) fn new(role: Role) -> Tree {
        Tree {
            role,
            pieces: Vec::new(),
        }
    }

    /// Creates a tree from a text in which each `@` stands for the next part.
    pub(crate) fn form(role: Role, form: &str, parts: Vec<Tree>) -> Tree {
        let mut tree = Tree::new(role);
        let mut parts = parts.into_iter();
        for (k, text) in form.split('@').enumerate() {
            if k > 0 {
                tree.pieces.extend(parts.next().map(Piece::Tree));
            }
            tree.pieces.push(Piece::Text(text.to_owned()));
        }
        tree
    }

    pub(crate) fn expr(ty: Ty, form: &str, parts: Vec<Tree>) -> Tree {
        Tree::form(Role::Expr(ty), form, parts)
    }

    pub(crate) fn push(&mut self, tree: Tree) {
        self.pieces.push(Piece::Tree(tree));
    }

    pub(crate) fn text(&mut self, text: &str) {
        self.pieces.push(Piece::Text(text.to_owned()));
    }

    pub(crate) fn render(&self) -> String {
        let mut out = String::new();
        self.write(&mut out);
        out
    }

    fn write(&self, out: &mut String) {
        for piece in &self.pieces {
            match piece {
                Piece::Text(text) => out.push_str(text),
                Piece::Tree(tree) => tree.write(out),
            }
        }
    }

    fn parts(&self) -> impl DoubleEndedIterator<Item = &Tree> {
        self.pieces.iter().filter_map(|piece| match piece {
            Piece::Tree(tree) => Some(tree),
            Piece::Text(_) => None,
        })
    }

    /// Returns the number of nodes of the tree.
    fn size(&self) -> usize {
        1 + self.parts().map(Tree::size).sum::<usize>()
    }

    /// Returns the replacements of a part: nothing, a literal, or one of its own parts of the same type.
    fn smaller(&self) -> Vec<Tree> {
        match self.role {
            Role::Item(0) => vec![Tree::new(Role::Rest)],
            Role::Item(_) => Vec::new(),
            Role::Rest => Vec::new(),
            Role::Expr(_) if self.parts().next().is_none() => Vec::new(),
            Role::Expr(ty) => {
                let mut found = vec![Tree::expr(ty, ty.literal(), Vec::new())];
                self.below(ty, &mut found);
                found
            }
        }
    }

    fn below(&self, ty: Ty, found: &mut Vec<Tree>) {
        for part in self.parts() {
            match part.role {
                Role::Expr(own) if own.fits(ty) => found.push(part.clone()),
                _ => part.below(ty, found),
            }
        }
    }

    /// Returns the tree without the items of a number.
    fn without(&self, number: usize) -> Tree {
        let piece = |piece: &Piece| match piece {
            Piece::Tree(part) => Piece::Tree(part.without(number)),
            text => text.clone(),
        };
        match self.role {
            Role::Item(own) if own == number => Tree::new(Role::Rest),
            role => Tree {
                role,
                pieces: self.pieces.iter().map(piece).collect(),
            },
        }
    }

    fn numbers(&self, found: &mut BTreeSet<usize>) {
        if let Role::Item(number @ 1..) = self.role {
            found.insert(number);
        }
        self.parts().for_each(|part| part.numbers(found));
    }

    /// Returns all trees in which one part is smaller.
    fn candidates(&self) -> Vec<Tree> {
        let mut all: Vec<Tree> = self.smaller();
        for (k, piece) in self.pieces.iter().enumerate() {
            let Piece::Tree(part) = piece else { continue };
            for smaller in part.candidates() {
                let mut copy = self.clone();
                copy.pieces[k] = Piece::Tree(smaller);
                all.push(copy);
            }
        }
        all
    }
}

/// Largest number of attempts.
const ATTEMPTS: usize = 3000;

/// Returns the smallest program found that is still `bad`.
pub(crate) fn shrink(mut tree: Tree, bad: impl Fn(&str) -> bool) -> String {
    let mut left = ATTEMPTS;
    'again: loop {
        let mut numbers = BTreeSet::new();
        tree.numbers(&mut numbers);
        let mut candidates: Vec<Tree> = numbers.into_iter().map(|n| tree.without(n)).collect();
        candidates.extend(tree.candidates());
        candidates.sort_by_key(Tree::size);
        for candidate in candidates {
            if left == 0 {
                break 'again;
            }
            left -= 1;
            if candidate.size() < tree.size() && bad(&candidate.render()) {
                tree = candidate;
                continue 'again;
            }
        }
        break;
    }
    tree.render()
}

impl Ty {
    /// Returns whether an expression of this type may be used where another type is expected.
    fn fits(self, wanted: Ty) -> bool {
        self.kind == wanted.kind
            && self.ticking == wanted.ticking
            && (wanted.optional || !self.optional)
    }

    /// Returns the simplest expression of the type.
    pub(crate) fn literal(self) -> &'static str {
        match self.kind {
            Kind::Bool => "false",
            Kind::Int => "1",
            Kind::Real => "1.0",
            Kind::Length => "1.0[m]",
            Kind::Time => "1.0[s]",
            Kind::Speed => "1.0[m/s]",
            Kind::Area => "1.0[m^2]",
            Kind::Mode => "Off",
            Kind::Point => "Point{x = 1.0; n = 1}",
            Kind::Ints => "[1, 1, 1]",
            Kind::Reals => "[1.0, 1.0, 1.0]",
        }
    }
}
