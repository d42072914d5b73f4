//! Programs in HTML: highlighted tokens, and names with links.

use rpi_syntax::{Dialect, SourceTokenKind, source_tokens};

use crate::html::escape;

/// Returns a program, or a part of one, as HTML with coloured tokens. `mode` is the language of the text. `link`
/// returns the address to which a name is linked, or `None` for a name without a link.
pub(crate) fn code(text: &str, mode: Dialect, link: &dyn Fn(&str) -> Option<String>) -> String {
    let mut out = String::with_capacity(2 * text.len());
    let mut at = 0;
    for piece in source_tokens(text, mode) {
        if piece.range.start < at {
            continue;
        }
        out.push_str(&escape(&text[at..piece.range.start]));
        let word = &text[piece.range.clone()];
        out.push_str(&highlighted(piece.kind, word, link));
        at = piece.range.end;
    }
    out.push_str(&escape(&text[at..]));
    out
}

fn highlighted(kind: SourceTokenKind, word: &str, link: &dyn Fn(&str) -> Option<String>) -> String {
    let class = match kind {
        SourceTokenKind::Name => return linked_name(word, link),
        SourceTokenKind::KeywordOrSymbol if word.starts_with(|c: char| c.is_ascii_alphabetic()) => {
            "k"
        }
        SourceTokenKind::KeywordOrSymbol => return escape(word),
        SourceTokenKind::Number => "n",
        SourceTokenKind::String => "s",
        SourceTokenKind::Comment(_) => "c",
    };
    // A span over several lines would be broken by the line numbers.
    let lines = word.split('\n');
    let lines = lines.map(|line| format!("<span class=\"{class}\">{}</span>", escape(line)));
    lines.collect::<Vec<_>>().join("\n")
}

fn linked_name(word: &str, link: &dyn Fn(&str) -> Option<String>) -> String {
    match link(word) {
        Some(href) => format!("<a href=\"{}\">{}</a>", escape(&href), escape(word)),
        None => escape(word),
    }
}

/// Returns a whole program as an HTML listing with coloured tokens and a number before each line, to which links can
/// refer as `#L12`.
pub(crate) fn listing(text: &str, mode: Dialect) -> String {
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

/// Returns a part of a program as an HTML `pre` element with coloured tokens. `link` returns the address to which a
/// name is linked.
pub(crate) fn block(text: &str, mode: Dialect, link: &dyn Fn(&str) -> Option<String>) -> String {
    let coloured = code(text.trim_end(), mode, link);
    format!("<pre class=\"code\"><code>{coloured}</code></pre>\n")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_are_coloured_and_names_linked() {
        let link = |name: &str| (name == "f").then(|| "m.html#f".to_owned());
        let html = code("y = pre f(3) < x; -- <b>", Dialect::Rpi, &link);
        let expected = "y = <span class=\"k\">pre</span> <a href=\"m.html#f\">f</a>(<span class=\"n\">3</span>) &lt; x; \
                        <span class=\"c\">-- &lt;b&gt;</span>";
        assert_eq!(html, expected);
    }

    #[test]
    fn comments_over_lines_keep_lines_whole() {
        let html = listing("(* a\nb *)", Dialect::Rpi);
        assert_eq!(html.matches("<span class=\"c\">").count(), 2);
        assert!(html.contains("id=\"L2\""));
    }
}
