//! Headers of declarations, as shown when hovering over a name.

use super::print;
use crate::Dialect;
use crate::ast::{Body, File, Item, ItemKind, NodeDef};

/// Returns the text of a declaration without its body, contract and doc comments, and without a line break at its end.
pub fn header(item: &Item, mode: Dialect) -> String {
    let mut item = Item {
        doc: None,
        ..item.clone()
    };
    match &mut item.kind {
        ItemKind::Node(node) => {
            node.contract = None;
            if let NodeDef::Body(body) = &mut node.definition {
                *body = Body::default();
            }
        }
        ItemKind::Fragment(fragment) => {
            fragment.contract = None;
            fragment.body = Body::default();
        }
        ItemKind::Command(command) => {
            command.contract = None;
            command.body = Body::default();
        }
        ItemKind::Task(task) => task.steps.clear(),
        ItemKind::Test(test) => test.body = Body::default(),
        _ => {}
    }
    let items = vec![item];
    let text = print(
        &File {
            items,
            dialect: mode,
        },
        mode,
    );
    without_body(&text)
        .trim_end()
        .trim_end_matches(';')
        .to_owned()
}

/// Returns the text before the empty body `let tel` at its end; the whole text if there is no such body.
fn without_body(text: &str) -> &str {
    let trimmed = text.trim_end().trim_end_matches(['.', ';']);
    let Some(before_tel) = trimmed.strip_suffix("tel") else {
        return text;
    };
    before_tel.trim_end().strip_suffix("let").unwrap_or(text)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::parse;
    use rpi_diag::FileId;

    fn heads(text: &str, mode: Dialect) -> Vec<String> {
        let parsed = parse(FileId(0), text, mode);
        parsed
            .file
            .items
            .iter()
            .map(|item| header(item, mode))
            .collect()
    }

    #[test]
    fn bodies_are_left_out() {
        let text = "--| Twice.\nfunction twice (x: int) returns (y: int) let y = x + x; tel\n\
                    command C (io: Io) given (x: real) let finish done when true; tel\n\
                    fragment F (x: int) returns (y: int) when x > 0 let y = x; tel\n";
        let expected = [
            "function twice (x: int) returns (y: int)",
            "command C (io: Io) given (x: real)",
            "fragment F (x: int) returns (y: int) when x > 0",
        ];
        assert_eq!(heads(text, Dialect::Rpi), expected);
    }

    #[test]
    fn documentation_of_parameters_is_shown_once() {
        let text = "fragment F <<\n  --| Speed.\n  v: real\n>> (\n  --| Start.\n  x: int\n) returns (y: int) let y = x; tel\n";
        let [shown] = &heads(text, Dialect::Rpi)[..] else {
            panic!("one declaration");
        };
        assert_eq!(shown.matches("--| Speed.").count(), 1, "{shown}");
        assert_eq!(shown.matches("--| Start.").count(), 1, "{shown}");
    }

    #[test]
    fn what_has_no_body_is_shown_whole() {
        let text = "const n: int = 3;\nprimitive Core::Clock () returns (outValue: real);\n";
        let expected = [
            "const n: int = 3",
            "primitive Core::Clock () returns (outValue: real)",
        ];
        assert_eq!(heads(text, Dialect::Rpi), expected);
        let lustre = heads(
            "node f(x: int) returns (y: int); let y = x; tel",
            Dialect::Lustre,
        );
        assert_eq!(lustre, ["node f (x: int) returns (y: int)"]);
    }
}
