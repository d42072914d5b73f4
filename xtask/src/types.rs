//! Types of a Rust source text with the number of their fields and inherent methods, found by the layout of rustfmt.

/// Part of a type in a Rust source text: its declaration, or an inherent `impl` block.
#[derive(Clone, PartialEq, Eq, Debug)]
pub enum TypePart<'a> {
    /// Declaration of a struct or an enum.
    Declaration {
        /// Name of the declared type.
        name: &'a str,
        /// Number of fields of a struct with named fields; 0 for an enum and for other structs.
        fields: usize,
    },
    /// Inherent `impl` block of a type (not one of a trait).
    Methods {
        /// Name of the type of the block, without path and generic arguments.
        name: &'a str,
        /// Number of functions in the block.
        methods: usize,
    },
}

/// Returns the declarations of types and the inherent `impl` blocks of a text that rustfmt has formatted, in the order
/// of their lines.
pub fn type_parts(text: &str) -> Vec<TypePart<'_>> {
    let lines: Vec<&str> = text.lines().collect();
    let found =
        (0..lines.len()).filter_map(|at| declaration(&lines[at..]).or_else(|| block(&lines[at..])));
    found.collect()
}

fn declaration<'a>(lines: &[&'a str]) -> Option<TypePart<'a>> {
    let words = without_visibility(lines[0].trim_start());
    let is_enum = words.starts_with("enum ");
    let rest = words
        .strip_prefix("struct ")
        .or(words.strip_prefix("enum "))?;
    let name = identifier(rest);
    let is_field = |line: &str| {
        let line = without_visibility(line);
        let name = identifier(line.strip_prefix("r#").unwrap_or(line));
        !name.is_empty() && line.contains(": ")
    };
    let fields = match is_enum {
        true => 0,
        false => items(lines).filter(|line| is_field(line)).count(),
    };
    (!name.is_empty()).then_some(TypePart::Declaration { name, fields })
}

fn block<'a>(lines: &[&'a str]) -> Option<TypePart<'a>> {
    let head = lines[0].trim_start().strip_prefix("impl")?;
    let starts = head.starts_with(['<', ' ']);
    let subject = after_generics(head).trim_start();
    let in_head = lines.iter().take_while(|line| !line.ends_with('{'));
    let of_trait = in_head.chain(lines.iter().find(|line| line.ends_with('{')));
    if !starts || of_trait.take(12).any(|line| line.contains(" for ")) {
        return None;
    }
    let path = &subject[..subject.find(['<', ' ']).unwrap_or(subject.len())];
    let name = identifier(path.rsplit("::").next()?);
    let methods = items(lines).filter(|line| is_function(line)).count();
    (!name.is_empty()).then_some(TypePart::Methods { name, methods })
}

/// Returns the lines directly inside the block that starts with the first line (one step of indentation deeper),
/// without their indentation.
fn items<'a>(lines: &[&'a str]) -> impl Iterator<Item = &'a str> {
    let indent = indentation(lines[0]);
    let single = lines[0].ends_with(['}', ';']);
    let inside = lines.iter().skip(1).take_while(move |line| {
        let closing = indentation(line) == indent && line.trim_start().starts_with(['}', ')']);
        !single && !closing
    });
    let direct = inside.filter(move |line| indentation(line) == indent + 4);
    direct.map(|line| line.trim_start())
}

fn is_function(line: &str) -> bool {
    let mut rest = without_visibility(line);
    for qualifier in ["const ", "async ", "unsafe "] {
        rest = rest.strip_prefix(qualifier).unwrap_or(rest);
    }
    rest.starts_with("fn ")
}

fn indentation(line: &str) -> usize {
    line.len() - line.trim_start().len()
}

fn without_visibility(line: &str) -> &str {
    let Some(rest) = line.strip_prefix("pub") else {
        return line;
    };
    let rest = match rest.starts_with('(') {
        true => rest.find(')').map_or(rest, |at| &rest[at + 1..]),
        false => rest,
    };
    rest.strip_prefix(' ').unwrap_or(line)
}

fn identifier(text: &str) -> &str {
    let end = text.find(|c: char| !c.is_alphanumeric() && c != '_');
    &text[..end.unwrap_or(text.len())]
}

/// Returns the text after the generic parameters at its start, such as `<'a, T>`; the whole text if there are none.
fn after_generics(text: &str) -> &str {
    let mut depth = 0_usize;
    for (at, c) in text.char_indices() {
        match c {
            '<' => depth += 1,
            '>' if depth > 0 => depth -= 1,
            _ if depth == 0 => return &text[at..],
            _ => {}
        }
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    const TEXT: &str = "\
pub(crate) struct Point<T> {
    /// Position: in m.
    pub x: T,
    y: T,
}

struct Pair(u8, u8);

impl<T: Clone> Point<T> {
    pub const fn x(&self) -> T {
        fn inner() {}
        self.x
    }

    fn y(&self) -> T {
        self.y
    }
}

impl<T> fmt::Display for Point<T> {
    fn fmt(&self) {}
}

impl super::Pair {
    fn first(self) -> u8 {
        self.0
    }
}
";

    #[test]
    fn fields_and_methods_are_counted_by_type() {
        let [point, pair] = ["Point", "Pair"];
        let declared = |name, fields| TypePart::Declaration { name, fields };
        let block = |name, methods| TypePart::Methods { name, methods };
        let expected = [
            declared(point, 2),
            declared(pair, 0),
            block(point, 2),
            block(pair, 1),
        ];
        assert_eq!(type_parts(TEXT), expected);
    }
}
