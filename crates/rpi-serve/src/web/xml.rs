//! XML writer.

/// An XML document being written, with the stack of open elements.
pub(crate) struct XmlWriter {
    text: String,
    open: Vec<&'static str>,
}

impl XmlWriter {
    /// Creates a document with this root element.
    pub(crate) fn new(root: &'static str) -> XmlWriter {
        let mut xml = XmlWriter {
            text: "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n".to_owned(),
            open: Vec::new(),
        };
        xml.begin(root, &[]);
        xml
    }

    /// Opens an element with these attributes.
    pub(crate) fn begin(&mut self, name: &'static str, attributes: &[(&str, &str)]) {
        self.tag(name, attributes);
        self.text.push_str(">\n");
        self.open.push(name);
    }

    /// Closes the innermost open element; does nothing if none is open.
    pub(crate) fn end(&mut self) {
        if let Some(name) = self.open.pop() {
            self.text
                .push_str(&format!("{}</{name}>\n", indent(self.open.len())));
        }
    }

    /// Writes an element without child elements; `text` may be empty.
    pub(crate) fn leaf(&mut self, name: &'static str, attributes: &[(&str, &str)], text: &str) {
        self.tag(name, attributes);
        self.text.push_str(&match text {
            "" => "/>\n".to_owned(),
            text => format!(">{}</{name}>\n", escaped(text)),
        });
    }

    fn tag(&mut self, name: &str, attributes: &[(&str, &str)]) {
        self.text
            .push_str(&format!("{}<{name}", indent(self.open.len())));
        for (key, value) in attributes {
            self.text
                .push_str(&format!(" {key}=\"{}\"", escaped(value)));
        }
    }

    /// Closes all open elements and returns the text of the document.
    pub(crate) fn finish(mut self) -> String {
        while !self.open.is_empty() {
            self.end();
        }
        self.text
    }
}

fn indent(depth: usize) -> String {
    "  ".repeat(depth)
}

/// Escapes a text for use in XML content and attributes. Control characters that XML 1.0 does not allow are left out.
fn escaped(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    for sign in text.chars() {
        match sign {
            '<' => out.push_str("&lt;"),
            '>' => out.push_str("&gt;"),
            '&' => out.push_str("&amp;"),
            '"' => out.push_str("&quot;"),
            '\n' | '\t' => out.push(sign),
            sign if sign.is_control() => {}
            sign => out.push(sign),
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn elements_nest_and_texts_are_escaped() {
        let mut xml = XmlWriter::new("a");
        xml.begin("b", &[("k", "<\"&\u{1}>")]);
        xml.leaf("c", &[], "x & y");
        xml.leaf("d", &[], "");
        let expected = "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<a>\n  <b k=\"&lt;&quot;&amp;&gt;\">\n    \
                        <c>x &amp; y</c>\n    <d/>\n  </b>\n</a>\n";
        assert_eq!(xml.finish(), expected);
    }
}
