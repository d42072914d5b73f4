//! XML writer.

use std::borrow::Cow;

use quick_xml::Writer;
use quick_xml::events::{BytesDecl, BytesEnd, BytesStart, BytesText, Event};

/// An XML document being written, with the stack of open elements.
pub(crate) struct XmlWriter {
    writer: Writer<Vec<u8>>,
    open: Vec<&'static str>,
}

impl XmlWriter {
    /// Creates a document with this root element.
    pub(crate) fn new(root: &'static str) -> XmlWriter {
        let mut xml = XmlWriter {
            writer: Writer::new_with_indent(Vec::new(), b' ', 2),
            open: Vec::new(),
        };
        xml.write(Event::Decl(BytesDecl::new("1.0", Some("UTF-8"), None)));
        xml.begin(root, &[]);
        xml
    }

    /// Opens an element with these attributes.
    pub(crate) fn begin(&mut self, name: &'static str, attributes: &[(&str, &str)]) {
        self.write(Event::Start(tag(name, attributes)));
        self.open.push(name);
    }

    /// Closes the innermost open element; does nothing if none is open.
    pub(crate) fn end(&mut self) {
        if let Some(name) = self.open.pop() {
            self.write(Event::End(BytesEnd::new(name)));
        }
    }

    /// Writes an element without child elements; `text` may be empty.
    pub(crate) fn leaf(&mut self, name: &'static str, attributes: &[(&str, &str)], text: &str) {
        if text.is_empty() {
            return self.write(Event::Empty(tag(name, attributes)));
        }
        self.write(Event::Start(tag(name, attributes)));
        self.write(Event::Text(BytesText::new(&valid(text))));
        self.write(Event::End(BytesEnd::new(name)));
    }

    /// Closes all open elements and returns the text of the document.
    pub(crate) fn finish(mut self) -> String {
        while !self.open.is_empty() {
            self.end();
        }
        let mut text = String::from_utf8(self.writer.into_inner()).unwrap_or_default();
        text.push('\n');
        text
    }

    fn write(&mut self, event: Event<'_>) {
        // Writing to memory does not fail.
        let _ = self.writer.write_event(event);
    }
}

fn tag(name: &'static str, attributes: &[(&str, &str)]) -> BytesStart<'static> {
    let mut tag = BytesStart::new(name);
    for (key, value) in attributes {
        tag.push_attribute((*key, &*valid(value)));
    }
    tag
}

/// Replaces characters that XML 1.0 cannot represent, not even escaped (section 2.2), by U+FFFD. The library escapes the
/// others.
fn valid(text: &str) -> Cow<'_, str> {
    let is_invalid = |sign: char| matches!(sign, '\0'..='\u{8}' | '\u{b}' | '\u{c}' | '\u{e}'..='\u{1f}' | '\u{fffe}' | '\u{ffff}');
    match text.contains(is_invalid) {
        true => text.replace(is_invalid, "\u{fffd}").into(),
        false => text.into(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn elements_nest_and_texts_are_escaped() {
        let mut xml = XmlWriter::new("a");
        xml.begin("b", &[("k", "<\"&\u{1}>\n\t")]);
        xml.leaf("c", &[], "x & y\r\u{ffff}\u{7f}\u{85}");
        xml.leaf("d", &[], "");
        let expected = "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<a>\n  <b k=\"&lt;&quot;&amp;\u{fffd}&gt;&#10;&#9;\">\n    \
                        <c>x &amp; y&#13;\u{fffd}\u{7f}\u{85}</c>\n    <d/>\n  </b>\n</a>\n";
        assert_eq!(xml.finish(), expected);
    }
}
