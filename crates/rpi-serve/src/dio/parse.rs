//! Parser of DirectIO messages.

use super::message::{Arg, Message};

/// Maximum length of a tag and of the name of a request in bytes. Subscriptions and requests that are answered later keep
/// the tag.
const MAX_IDENTIFIER: usize = 256;

/// Maximum nesting depth of lists and maps in a message; the DirectIO protocol needs three levels.
const MAX_DEPTH: usize = 16;

/// Syntax error of a DirectIO message.
#[derive(Clone, PartialEq, Eq, Debug)]
pub(crate) struct ParseError {
    /// Byte offset of the error in the text of the message.
    pub(crate) offset: usize,
    /// Description of the syntax that was expected at the offset.
    pub(crate) expected: &'static str,
}

/// Parses the text form `tag=name(arguments)` of a DirectIO message.
///
/// # Errors
/// If the text is not a DirectIO message.
pub(crate) fn parse(text: &str) -> Result<Message, ParseError> {
    let mut reader = Parser { text, offset: 0 };
    let tag = reader.identifier()?;
    reader.expect('=', "'='")?;
    let name = reader.identifier()?;
    reader.expect('(', "'('")?;
    let args = reader.separated(')', |reader| reader.arg(MAX_DEPTH))?;
    reader.skip_blanks();
    match reader.rest().is_empty() {
        true => Ok(Message { tag, name, args }),
        false => Err(reader.expected("the end")),
    }
}

struct Parser<'a> {
    text: &'a str,
    offset: usize,
}

impl<'a> Parser<'a> {
    fn rest(&self) -> &'a str {
        &self.text[self.offset..]
    }

    fn expected(&self, expected: &'static str) -> ParseError {
        let at = self.offset;
        ParseError {
            offset: at,
            expected,
        }
    }

    fn skip_blanks(&mut self) {
        let rest = self.rest();
        self.offset += rest.len() - rest.trim_start().len();
    }

    fn accept(&mut self, sign: char) -> bool {
        self.skip_blanks();
        let found = self.rest().starts_with(sign);
        self.offset += if found { sign.len_utf8() } else { 0 };
        found
    }

    fn expect(&mut self, sign: char, expected: &'static str) -> Result<(), ParseError> {
        match self.accept(sign) {
            true => Ok(()),
            false => Err(self.expected(expected)),
        }
    }

    /// Skips blanks, and consumes and returns the longest prefix of characters that satisfy `accepts`. The result may
    /// be empty.
    fn word(&mut self, accepts: fn(char) -> bool) -> &'a str {
        self.skip_blanks();
        let rest = self.rest();
        let word = &rest[..rest.find(|c| !accepts(c)).unwrap_or(rest.len())];
        self.offset += word.len();
        word
    }

    fn identifier(&mut self) -> Result<String, ParseError> {
        let word = self.word(|c| c.is_ascii_alphanumeric() || c == '_');
        match word.starts_with(|c: char| !c.is_ascii_digit()) {
            true if word.len() > MAX_IDENTIFIER => {
                Err(self.expected("a name of at most 256 characters"))
            }
            true => Ok(word.to_owned()),
            false => Err(self.expected("a name")),
        }
    }

    /// Parses items separated by commas, up to and including the character `end`. `each` parses one item.
    fn separated<T>(
        &mut self,
        end: char,
        mut each: impl FnMut(&mut Self) -> Result<T, ParseError>,
    ) -> Result<Vec<T>, ParseError> {
        let mut items = Vec::new();
        if self.accept(end) {
            return Ok(items);
        }
        loop {
            items.push(each(self)?);
            if self.accept(end) {
                return Ok(items);
            }
            self.expect(',', "',' or the closing bracket")?;
        }
    }

    fn arg(&mut self, depth: usize) -> Result<Arg, ParseError> {
        if depth == 0 {
            return Err(self.expected("less nesting"));
        }
        self.skip_blanks();
        match self.rest().chars().next() {
            Some('"') => self.string().map(Arg::Text),
            Some('[') => {
                self.offset += 1;
                self.separated(']', |reader| reader.arg(depth - 1))
                    .map(Arg::List)
            }
            Some('{') => {
                self.offset += 1;
                self.separated('}', |reader| reader.entry(depth - 1))
                    .map(Arg::Map)
            }
            _ => self.number(),
        }
    }

    fn entry(&mut self, depth: usize) -> Result<(String, Arg), ParseError> {
        self.skip_blanks();
        let key = match self.rest().starts_with('"') {
            true => self.string()?,
            false => self.identifier()?,
        };
        self.expect(':', "':'")?;
        Ok((key, self.arg(depth)?))
    }

    fn number(&mut self) -> Result<Arg, ParseError> {
        let start = self.offset;
        let word = self.word(|c| c.is_ascii_alphanumeric() || "+-.".contains(c));
        let number = word.starts_with(|c: char| "+-.".contains(c) || c.is_ascii_digit());
        let read = word.parse().ok().filter(|_| number);
        read.map(Arg::Number).ok_or(ParseError {
            offset: start,
            expected: "a value",
        })
    }

    fn string(&mut self) -> Result<String, ParseError> {
        let start = self.offset;
        self.offset += 1;
        let mut plain = String::new();
        loop {
            let rest = self.rest();
            let Some(stop) = rest.find(['"', '\\']) else {
                self.offset = start;
                return Err(self.expected("a closing quote"));
            };
            plain.push_str(&rest[..stop]);
            self.offset += stop + 1;
            if rest.as_bytes()[stop] == b'"' {
                return Ok(plain);
            }
            let escaped = self.rest().chars().next();
            plain.extend(escaped);
            self.offset += escaped.map_or(0, char::len_utf8);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn back(text: &str) -> String {
        parse(text).map_or_else(
            |e| format!("{} at {}", e.expected, e.offset),
            |m| m.to_string(),
        )
    }

    #[test]
    fn what_is_read_is_written_the_same() {
        for text in [
            r#"c0=ver("2.0")"#,
            "c1=quit()",
            r#"c2=nesc("t",[],["n1","n2"],["n3"])"#,
            r#"c3=snc({"n1":{"inspeed":"0.5"}})"#,
            r#"c4=nene("{a=Core::BooleanValue(Value='true')}","s1","say \"a\\b\"",0.05,0.0)"#,
        ] {
            assert_eq!(back(text), text);
        }
    }

    #[test]
    fn blanks_bare_keys_and_integers_are_understood() {
        assert_eq!(back(r#" c5 = gne ( "n1" , 1 ) "#), r#"c5=gne("n1",1.0)"#);
        assert_eq!(back(r#"c6=snc({n1:{}})"#), r#"c6=snc({"n1":{}})"#);
    }

    #[test]
    fn what_is_no_message_is_told_with_its_place() {
        assert_eq!(back(""), "a name at 0");
        assert_eq!(back("c1=ver(\"2.0"), "a closing quote at 7");
        assert_eq!(back("c1=ver(x)"), "a value at 7");
        assert_eq!(back("c1=ver()x"), "the end at 8");
        assert_eq!(back("c1=ver(1 2)"), "',' or the closing bracket at 9");
        let long = format!("{}=ver()", "c".repeat(257));
        assert_eq!(back(&long), "a name of at most 256 characters at 257");
        let deep = format!("c1=a({})", "[".repeat(100_000));
        assert!(back(&deep).starts_with("less nesting"));
    }

    #[test]
    fn every_prefix_of_a_message_is_refused() {
        let text = r#"c4=snc({"n1":{"in":"0.5"}},[1.5,"a\"b"])"#;
        for end in 0..text.len() {
            assert!(parse(&text[..end]).is_err(), "{}", &text[..end]);
        }
    }
}
