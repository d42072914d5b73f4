//! Fenced code blocks of Markdown (CommonMark 0.31, section 4.5), as far as our documents use them.

/// One fenced block.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct Fence {
    /// The info string after the opening fence: the language and what follows it.
    pub info: String,
    /// The line of the first line of code, from 1.
    pub line: usize,
    /// The code, each line ended.
    pub code: String,
}

/// The fenced blocks of a document, in order. A block without closing fence ends with the document.
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
