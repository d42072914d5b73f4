//! Parser of fenced code blocks in Markdown (CommonMark 0.31, section 4.5), limited to the forms that the documents
//! use.

/// Code block of a Markdown document that is enclosed in lines of three backquotes.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct Fence {
    /// Text after the opening backquotes: the language, and optional further words.
    pub info: String,
    /// Number of the first line of code in the document, from 1.
    pub line: usize,
    /// Text of the code, in which every line ends with a newline.
    pub code: String,
}

/// Returns the fenced code blocks of a Markdown document, in order. A block without a closing fence ends with the
/// document.
pub fn fences(markdown: &str) -> Vec<Fence> {
    let mut found = Vec::new();
    let mut open: Option<Fence> = None;
    for (number, line) in markdown.lines().enumerate() {
        let marker = line.trim_start().strip_prefix("```");
        match (&mut open, marker) {
            (None, Some(info)) => {
                open = Some(Fence {
                    info: info.trim().to_owned(),
                    line: number + 2,
                    code: String::new(),
                });
            }
            (Some(_), Some("")) => found.extend(open.take()),
            (Some(fence), _) => fence.code.extend([line, "\n"]),
            (None, None) => {}
        }
    }
    found.extend(open);
    found
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn blocks_come_with_language_line_and_text() {
        let found = fences("a\n```rpi\nx = 1;\n\n```\nb\n```\nplain\n```\n```sh\nls");
        let seen: Vec<(&str, usize, &str)> = found
            .iter()
            .map(|f| (f.info.as_str(), f.line, f.code.as_str()))
            .collect();
        assert_eq!(
            seen,
            [
                ("rpi", 3, "x = 1;\n\n"),
                ("", 8, "plain\n"),
                ("sh", 11, "ls\n")
            ]
        );
    }
}
