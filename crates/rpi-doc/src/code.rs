//! Programs in HTML: highlighted tokens, and names with links.

use rpi_syntax::{Mode, PieceKind, pieces};

use crate::html::escaped;

/// Returns a program or a part of one in HTML. `link` returns the target of a name, if it has one.
pub(crate) fn code(text: &str, mode: Mode, link: &dyn Fn(&str) -> Option<String>) -> String {
    let mut out = String::with_capacity(2 * text.len());
    let mut at = 0;
    for piece in pieces(text, mode) {
        if piece.range.start < at {
            continue;
        }
        out.push_str(&escaped(&text[at..piece.range.start]));
        let word = &text[piece.range.clone()];
        out.push_str(&coloured(piece.kind, word, link));
        at = piece.range.end;
    }
    out.push_str(&escaped(&text[at..]));
    out
}

fn coloured(kind: PieceKind, word: &str, link: &dyn Fn(&str) -> Option<String>) -> String {
    let class = match kind {
        PieceKind::Name => return named(word, link),
        PieceKind::Fixed if word.starts_with(|c: char| c.is_ascii_alphabetic()) => "k",
        PieceKind::Fixed => return escaped(word),
        PieceKind::Number => "n",
        PieceKind::Text => "s",
        PieceKind::Comment(_) => "c",
    };
    // A span over several lines would be broken by the line numbers.
    let lines = word.split('\n');
    let lines = lines.map(|line| format!("<span class=\"{class}\">{}</span>", escaped(line)));
    lines.collect::<Vec<_>>().join("\n")
}

fn named(word: &str, link: &dyn Fn(&str) -> Option<String>) -> String {
    match link(word) {
        Some(href) => format!("<a href=\"{}\">{}</a>", escaped(&href), escaped(word)),
        None => escaped(word),
    }
}

/// Returns a whole text in HTML, with a linkable number before each line.
pub(crate) fn listing(text: &str, mode: Mode) -> String {
    let coloured = code(text, mode, &|_| None);
    let mut out = String::from("<pre class=\"listing\"><code>");
    for (k, line) in coloured.trim_end().split('\n').enumerate() {
        let n = k + 1;
        out.push_str(&format!(
            "<span class=\"line\" id=\"L{n}\"><a href=\"#L{n}\" aria-label=\"line {n}\" data-n=\"{n}\"></a>{line}\n</span>"
        ));
    }
    out.push_str("</code></pre>\n");
    out
}

/// Returns a block of code in HTML.
pub(crate) fn block(text: &str, mode: Mode, link: &dyn Fn(&str) -> Option<String>) -> String {
    let coloured = code(text.trim_end(), mode, link);
    format!("<pre class=\"code\"><code>{coloured}</code></pre>\n")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_are_coloured_and_names_linked() {
        let link = |name: &str| (name == "f").then(|| "m.html#f".to_owned());
        let html = code("y = pre f(3) < x; -- <b>", Mode::Rpi, &link);
        let expected = "y = <span class=\"k\">pre</span> <a href=\"m.html#f\">f</a>(<span class=\"n\">3</span>) &lt; x; \
                        <span class=\"c\">-- &lt;b&gt;</span>";
        assert_eq!(html, expected);
    }

    #[test]
    fn comments_over_lines_keep_lines_whole() {
        let html = listing("(* a\nb *)", Mode::Rpi);
        assert_eq!(html.matches("<span class=\"c\">").count(), 2);
        assert!(html.contains("id=\"L2\""));
    }
}
