//! HTML escaping, and the frame of every page.

/// Returns a text with the special characters of HTML escaped, for use in elements and attributes. Control characters
/// are replaced by U+FFFD.
pub(crate) fn escape(text: &str) -> String {
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

/// Content of an HTML page of the reference, without the frame that all pages share.
pub(crate) struct Page<'p> {
    /// Title of the page as plain text, whose special characters are escaped later.
    pub(crate) title: &'p str,
    /// Name of the project as plain text, shown in the head of every page.
    pub(crate) project: &'p str,
    /// Relative path from the page to the root folder of the site: empty or `../`.
    pub(crate) up: &'static str,
    /// Page-specific content of the side bar, in HTML.
    pub(crate) side: &'p str,
    /// Main content of the page, in HTML.
    pub(crate) main: &'p str,
}

impl Page<'_> {
    /// Returns the complete HTML document with head, search box, side bar and main content.
    pub(crate) fn html(&self) -> String {
        let Page { up, side, main, .. } = self;
        let (title, project) = (escape(self.title), escape(self.project));
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
             <script defer src=\"{up}search.js\"></script>\n\
             <script defer src=\"{up}search-box.js\"></script>\n</head>\n\
             <body data-up=\"{up}\">\n<a class=\"skip\" href=\"#main\">Skip to content</a>\n\
             <header>\n<a class=\"project\" href=\"{up}index.html\">{project}</a>\n\
             <div class=\"search\" role=\"search\">\n\
             <input id=\"search\" type=\"search\" placeholder=\"Search ( / )\" aria-label=\"Search names and descriptions\" autocomplete=\"off\" role=\"combobox\" \
             aria-expanded=\"false\" aria-controls=\"found\">\n\
             <ul id=\"found\" role=\"listbox\" aria-label=\"Search results\" hidden></ul>\n</div>\n</header>\n\
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
            escape("a < b & \"c\"\u{1}"),
            "a &lt; b &amp; &quot;c&quot;\u{fffd}"
        );
    }
}
