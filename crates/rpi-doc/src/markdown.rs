//! Rendering of doc comments: Markdown (CommonMark with tables), with links to declarations and highlighted examples.
//! HTML in them is shown as text.

use pulldown_cmark::{
    BrokenLink, CodeBlockKind, CowStr, Event, HeadingLevel, Options, Parser, Tag, TagEnd,
};
use rpi_syntax::Dialect;

use crate::code;
use crate::html::escape;

/// Function that returns the address to which a name in a text is linked, or `None` for a name without a link.
pub(crate) type Link<'l> = &'l dyn Fn(&str) -> Option<String>;

/// Converts a doc comment from Markdown to HTML. Names in square brackets or backquotes are linked to the declarations
/// for which `link` returns an address.
pub(crate) fn to_html(text: &str, link: Link<'_>) -> String {
    let resolved = |broken: BrokenLink<'_>| {
        let href = link(broken.reference.trim_matches('`'))?;
        Some((CowStr::from(href), CowStr::from("")))
    };
    let parser =
        Parser::new_with_broken_link_callback(text, Options::ENABLE_TABLES, Some(resolved));
    let mut writer = Writer {
        link,
        links: Vec::new(),
        block: None,
    };
    let events = parser.filter_map(|event| writer.event(event));
    let mut out = String::new();
    pulldown_cmark::html::push_html(&mut out, events);
    out
}

/// Returns the first sentence of a doc comment in HTML, with code spans but without paragraphs and links.
pub(crate) fn summary(text: &str) -> String {
    let first = text.split("\n\n").next().unwrap_or_default();
    let joined = first.lines().map(str::trim).collect::<Vec<_>>().join(" ");
    let plain = joined.replace("[`", "`").replace("`]", "`");
    let parts = plain[..first_sentence_len(&plain)].split('`').enumerate();
    let parts = parts.map(|(k, part)| match k % 2 {
        1 => format!("<code>{}</code>", escape(part)),
        _ => escape(part),
    });
    parts.collect()
}

/// Returns the first sentence of a doc comment and the text after it, both without markup and without code blocks.
pub(crate) fn plain_text(text: &str) -> (String, String) {
    let mut in_code = false;
    let prose = text.lines().map(str::trim).filter(|line| {
        let is_fence = line.starts_with("```");
        in_code ^= is_fence;
        !in_code && !is_fence
    });
    let joined = prose.collect::<Vec<_>>().join(" ");
    let plain = joined.replace("[`", "`").replace("`]", "`");
    let (first, rest) = plain.split_at(first_sentence_len(&plain));
    (first.trim().to_owned(), rest.trim().to_owned())
}

/// Returns the length in bytes of the first sentence of a text. A sentence ends with a full stop outside of
/// parentheses, followed by a space and an upper-case letter or a backquote.
fn first_sentence_len(text: &str) -> usize {
    let is_end = |at: &usize| {
        let (before, next) = (&text[..*at], text[at + 2..].chars().next());
        let inside = before.matches('(').count() > before.matches(')').count();
        !inside && next.is_some_and(|c| c.is_uppercase() || c == '`')
    };
    let mut points = text.match_indices(". ").map(|(at, _)| at);
    points.find(is_end).map_or(text.len(), |at| at + 1)
}

struct Writer<'w> {
    link: Link<'w>,
    /// For each open link, the innermost last, true if the link is written to the output. Links to unsafe addresses are
    /// not.
    links: Vec<bool>,
    /// Language and text so far of the code block that the parser is in; `None` outside of code blocks.
    block: Option<(String, String)>,
}

impl Writer<'_> {
    fn event<'e>(&mut self, event: Event<'e>) -> Option<Event<'e>> {
        match event {
            Event::Start(Tag::CodeBlock(kind)) => {
                self.block = Some((language(&kind), String::new()));
                None
            }
            Event::End(TagEnd::CodeBlock) => self.block.take().map(|(language, text)| {
                Event::Html(code_block(&language, &text, self.link).into())
            }),
            Event::Text(text) => self.text(text),
            Event::Html(text) | Event::InlineHtml(text) => Some(Event::Text(text)),
            Event::Code(text) => Some(self.quoted(text)),
            // Pages must not load external content, so images are replaced by their alternative text.
            Event::Start(Tag::Image { .. }) | Event::End(TagEnd::Image) => None,
            Event::Start(Tag::Link { ref dest_url, .. }) => {
                let leads = is_safe(dest_url);
                self.links.push(leads);
                leads.then_some(event)
            }
            Event::End(TagEnd::Link) => self.links.pop()?.then_some(event),
            other => Some(lower_heading(other)),
        }
    }

    fn text<'e>(&mut self, text: CowStr<'e>) -> Option<Event<'e>> {
        match &mut self.block {
            Some((_, block)) => {
                block.push_str(&text);
                None
            }
            None => Some(Event::Text(text)),
        }
    }

    /// Converts an inline code span to HTML. If the text names a declaration, it becomes a link to the declaration.
    fn quoted<'e>(&self, text: CowStr<'e>) -> Event<'e> {
        match (self.link)(&text).filter(|_| self.links.is_empty()) {
            Some(href) => {
                let (href, text) = (escape(&href), escape(&text));
                Event::InlineHtml(format!("<a href=\"{href}\"><code>{text}</code></a>").into())
            }
            None => Event::Code(text),
        }
    }
}

/// Lowers the level of a heading by three, because the page has its own headings above those of a doc comment.
fn lower_heading(event: Event<'_>) -> Event<'_> {
    let below = |level: HeadingLevel| {
        HeadingLevel::try_from((level as usize + 3).min(6)).unwrap_or(HeadingLevel::H6)
    };
    match event {
        Event::Start(Tag::Heading { level, .. }) => Event::Start(Tag::Heading {
            level: below(level),
            id: None,
            classes: Vec::new(),
            attrs: Vec::new(),
        }),
        Event::End(TagEnd::Heading(level)) => Event::End(TagEnd::Heading(below(level))),
        other => other,
    }
}

fn language(kind: &CodeBlockKind<'_>) -> String {
    match kind {
        CodeBlockKind::Fenced(info) => info.split(' ').next().unwrap_or_default().to_owned(),
        CodeBlockKind::Indented => String::new(),
    }
}

fn code_block(language: &str, text: &str, link: Link<'_>) -> String {
    match language {
        "rpi" => code::block(text, Dialect::Rpi, link),
        "lus" => code::block(text, Dialect::Lustre, link),
        _ => format!("<pre><code>{}</code></pre>\n", escape(text)),
    }
}

/// Returns whether a page may link to a URL: to the web, to a mail address or within the site, but not to a script.
fn is_safe(url: &str) -> bool {
    let scheme = url.split(['/', '#', '?']).next().unwrap_or_default();
    match scheme.split_once(':') {
        Some((scheme, _)) => ["http", "https", "mailto"].contains(&scheme),
        None => true,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn html(text: &str) -> String {
        to_html(text, &|name| (name == "f").then(|| "m.html#f".to_owned()))
    }

    #[test]
    fn names_are_links_and_markup_is_text() {
        assert_eq!(
            html("See [`f`], `f` and `g`."),
            "<p>See <a href=\"m.html#f\"><code>f</code></a>, <a href=\"m.html#f\"><code>f</code></a> and <code>g</code>.</p>\n"
        );
        assert_eq!(html("a <b>c</b>"), "<p>a &lt;b&gt;c&lt;/b&gt;</p>\n");
        assert!(!html("<script>alert(1)</script>").contains("<script"));
        assert_eq!(html("[x](javascript:alert(1))"), "<p>x</p>\n");
        assert_eq!(html("![map](a.png)"), "<p>map</p>\n");
    }

    #[test]
    fn examples_are_coloured_and_headings_lowered() {
        assert!(html("```rpi\nconst a: int = f;\n```").contains("<span class=\"k\">const</span>"));
        assert_eq!(html("# A\n"), "<h4>A</h4>\n");
    }

    #[test]
    fn a_summary_is_the_first_sentence() {
        assert_eq!(
            summary("Follows `x`, e.g. slowly. Then\nmore."),
            "Follows <code>x</code>, e.g. slowly."
        );
        assert_eq!(summary("Fig. 6: on to C. Then D."), "Fig. 6: on to C.");
        assert_eq!(
            summary("The transform (R. Jones, Book). More."),
            "The transform (R. Jones, Book)."
        );
        assert_eq!(summary("One\ntwo\n\nthree"), "One two");
        assert_eq!(summary("As [`f`] does."), "As <code>f</code> does.");
    }
}
