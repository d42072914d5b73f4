//! Keywords by place, and the snippets of blocks.

use rpi_syntax::Dialect;

use super::place::Place;

/// Keywords at the start of a declaration.
const DECLARATION: &[&str] = &[
    "use",
    "include",
    "const",
    "type",
    "node",
    "function",
    "fragment",
    "command",
    "task",
    "test",
    "device",
    "frame",
    "primitive",
    "extern",
    "unsafe",
    "contract",
    "datatype",
    "actuator",
    "sensor",
    "status",
];

/// Keywords in the header of a declaration.
const HEADER: &[&str] = &[
    "returns", "given", "when", "restart", "budget", "var", "const", "let", "con",
];

/// Keywords at the start of a statement.
const STATEMENT: &[&str] = &[
    "automaton",
    "fragment",
    "assert",
    "check",
    "if",
    "tel",
    "finish",
    "yield",
    "fail",
    "export",
];

/// Keywords of statements that only commands and tests have.
const RESULT_WORDS: &[&str] = &["finish", "yield", "fail", "export"];

/// Keywords at the start of a value.
const VALUE: &[&str] = &[
    "true", "false", "if", "not", "pre", "last", "current", "int", "real", "merge", "with", "nor",
    "activate", "restart", "match", "forall", "exists",
];

/// Keywords after an operand.
const OPERATOR: &[&str] = &[
    "and", "or", "xor", "div", "mod", "fby", "when", "then", "else", "in", "with", "restart",
    "budget", "continue", "step", "every", "default", "provided", "lsh", "rsh",
];

/// Returns the keywords that can stand at a place, in the language `mode`. `declaration` is the keyword of the
/// declaration around the cursor.
pub(super) fn keywords(
    place: &Place,
    declaration: Option<&str>,
    mode: Dialect,
) -> Vec<&'static str> {
    let has_results = matches!(declaration, Some("command" | "test"));
    match place {
        Place::Declaration => DECLARATION.to_vec(),
        Place::Header => HEADER.to_vec(),
        Place::Statement => {
            let is_allowed = |word: &&&str| {
                (has_results || !RESULT_WORDS.contains(word))
                    && (**word != "if" || mode == Dialect::Lustre)
            };
            STATEMENT.iter().filter(is_allowed).copied().collect()
        }
        Place::Value(_) => VALUE.to_vec(),
        Place::Operator => OPERATOR.to_vec(),
        Place::Step => vec!["parallel", "repeat", "start", "tel"],
        Place::AfterStep => vec!["on", "then", "times", "let"],
        Place::State => vec!["initial", "state", "unless", "until", "var", "let", "end"],
        Place::Result(_) => vec!["any", "fail"],
        Place::NextStep => vec!["end"],
        Place::ResultCondition => vec!["when"],
        Place::Type => vec!["bool", "int", "real"],
        Place::Member(..)
        | Place::Unit
        | Place::Module
        | Place::Run
        | Place::NextState
        | Place::Field(..) => Vec::new(),
    }
}

/// Snippets of blocks: the keyword that begins the block, and the text with places for the cursor.
const SNIPPETS: &[(&str, &str)] = &[
    (
        "node",
        "node ${1:Name} (${2:x: real}) returns (${3:y: real})\nlet\n  $0\ntel",
    ),
    (
        "function",
        "function ${1:Name} (${2:x: real}) returns (${3:y: real})\nlet\n  $0\ntel",
    ),
    (
        "command",
        "command ${1:Name} (${2:arm: Arm})\nlet\n  $0\n  finish ${3:done} when ${4:true};\ntel",
    ),
    ("task", "task ${1:Name} (${2:arm: Arm})\nlet\n  $0\ntel"),
    (
        "test",
        "test \"${1:title}\"\nlet\n  $0\n  finish done when time >= 10[ms];\ntel",
    ),
    (
        "automaton",
        "automaton\n  initial state ${1:First}\n    let\n      $0\n    tel\n    until ${2:true} then ${1:First};\nend",
    ),
    ("if", "if ${1:condition} then $2 else $0"),
    ("parallel", "parallel\nlet\n  $1\ntel\nlet\n  $2\ntel$0"),
    ("repeat", "repeat ${1:2} times let\n  $0\ntel"),
    (
        "state",
        "state ${1:Name}\n  let\n    $0\n  tel\n  until ${2:true} then ${3:Next};",
    ),
];

/// Snippet of a fragment inside of a body.
const FRAGMENT: &str = "fragment ${1:Name} when ${2:true}\nlet\n  $0\ntel";

/// Snippet of a fragment at the top level.
const TOP_FRAGMENT: &str =
    "fragment ${1:Name} (${2:x: real}) returns (${3:y: real})\nlet\n  $0\ntel";

/// Returns the snippet of the block that a keyword begins at a place; `None` if it begins no block.
pub(super) fn snippet(place: &Place, keyword: &str) -> Option<&'static str> {
    match (keyword, place) {
        ("fragment", Place::Statement) => Some(FRAGMENT),
        ("fragment", _) => Some(TOP_FRAGMENT),
        _ => {
            let row = SNIPPETS.iter().find(|(word, _)| *word == keyword);
            row.map(|(_, text)| *text)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rpi_syntax::KEYWORDS;

    #[test]
    fn every_word_is_a_keyword_of_the_table() {
        let lists = [DECLARATION, HEADER, STATEMENT, VALUE, OPERATOR];
        for word in lists.concat() {
            assert!(
                KEYWORDS.iter().any(|keyword| keyword.text == word),
                "{word}"
            );
        }
        for (word, _) in SNIPPETS {
            assert!(
                lists.concat().contains(word) || ["parallel", "repeat", "state"].contains(word)
            );
        }
    }
}
