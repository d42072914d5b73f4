//! Nested lists (S-expressions), each on one line if it fits.

/// S-expression: an atom, a list in parentheses, or nothing.
pub(super) enum Sexp {
    Atom(String),
    List(Vec<Sexp>),
    /// Placeholder for an absent part, which is not printed.
    Empty,
}

/// Maximum line width in characters; longer lists are printed on several lines.
const WIDTH: usize = 100;

impl Sexp {
    pub(super) fn atom(text: impl Into<String>) -> Sexp {
        Sexp::Atom(text.into())
    }

    /// Creates an atom whose text is printed in quotes, with escapes.
    pub(super) fn quoted(text: &str) -> Sexp {
        Sexp::Atom(format!("{text:?}"))
    }

    pub(super) fn write(&self, out: &mut String) {
        self.write_at(out, 0);
    }

    fn write_at(&self, out: &mut String, margin: usize) {
        match self {
            Sexp::Atom(atom) => out.push_str(atom),
            Sexp::Empty => {}
            Sexp::List(parts) if margin + self.width(WIDTH) <= WIDTH => write_flat(parts, out),
            Sexp::List(parts) => write_broken(parts, out, margin),
        }
    }

    /// Returns the width in characters of the S-expression on one line. Stops counting once `limit` is exceeded.
    fn width(&self, limit: usize) -> usize {
        match self {
            Sexp::Atom(atom) => atom.chars().count(),
            Sexp::Empty => 0,
            Sexp::List(parts) => {
                let mut width = 1;
                for part in parts {
                    width += 1 + part.width(limit.saturating_sub(width));
                    if width > limit {
                        break;
                    }
                }
                width
            }
        }
    }
}

fn visible(parts: &[Sexp]) -> impl Iterator<Item = &Sexp> {
    parts.iter().filter(|part| !matches!(part, Sexp::Empty))
}

fn write_flat(parts: &[Sexp], out: &mut String) {
    out.push('(');
    for (i, part) in visible(parts).enumerate() {
        out.push_str(if i == 0 { "" } else { " " });
        part.write_at(out, 0);
    }
    out.push(')');
}

fn write_broken(parts: &[Sexp], out: &mut String, margin: usize) {
    out.push('(');
    for (i, part) in visible(parts).enumerate() {
        if i > 0 {
            out.push('\n');
            out.extend(std::iter::repeat_n(' ', margin + 2));
        }
        part.write_at(out, margin + 2);
    }
    out.push(')');
}
