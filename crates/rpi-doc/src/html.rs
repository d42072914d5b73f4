//! Text in HTML, and the frame around every page.

/// Text as HTML shows it, in elements and in attributes.
pub(crate) fn escaped(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    for c in text.chars() {
        match c {
            '&' => out.push_str("&amp;"),
            '<' => out.push_str("&lt;"),
            '>' => out.push_str("&gt;"),
            '"' => out.push_str("&quot;"),
            // Control characters are not allowed in HTML.
            c if c.is_control() && c != '\n' && c != '\t' => out.push('\u{fffd}'),
            c => out.push(c),
        }
    }
    out
}

/// What differs from page to page.
pub(crate) struct Page<'p> {
    /// Its title.
    pub(crate) title: &'p str,
    /// The name of the project.
    pub(crate) project: &'p str,
    /// From the page to the folder of the pages: empty or `../`.
    pub(crate) up: &'static str,
    /// What stands at its side.
    pub(crate) side: &'p str,
    /// What it holds.
    pub(crate) main: &'p str,
}

impl Page<'_> {
    /// The whole page.
    pub(crate) fn html(&self) -> String {
        let Page { up, side, main, .. } = self;
        let (title, project) = (escaped(self.title), escaped(self.project));
        let whole = match title == project {
            true => title,
            false => format!("{title} - {project}"),
        };
        format!(
            "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n\
             <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n\
             <meta name=\"color-scheme\" content=\"light dark\">\n<title>{whole}</title>\n\
             <link rel=\"stylesheet\" href=\"{up}style.css\">\n\
             <script defer src=\"{up}names.js\"></script>\n\
             <script defer src=\"{up}search.js\"></script>\n</head>\n\
             <body data-up=\"{up}\">\n<a class=\"skip\" href=\"#main\">To the content</a>\n\
             <header>\n<a class=\"project\" href=\"{up}index.html\">{project}</a>\n\
             <div class=\"search\" role=\"search\">\n\
             <input id=\"search\" type=\"search\" placeholder=\"Search ( / )\" aria-label=\"Search names\" autocomplete=\"off\" role=\"combobox\" \
             aria-expanded=\"false\" aria-controls=\"found\">\n\
             <ul id=\"found\" role=\"listbox\" aria-label=\"Found\" hidden></ul>\n</div>\n</header>\n\
             <div class=\"columns\">\n<nav aria-label=\"Contents\">\n{side}</nav>\n<main id=\"main\">\n{main}</main>\n</div>\n\
             </body>\n</html>\n"
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nothing_in_a_text_is_markup() {
        assert_eq!(
            escaped("a < b & \"c\"\u{1}"),
            "a &lt; b &amp; &quot;c&quot;\u{fffd}"
        );
    }
}
