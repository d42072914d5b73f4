//! A contextual keyword is a valid name in every position of an expression.

use rpi_diag::FileId;
use rpi_syntax::{Dialect, KEYWORDS, parse};

/// Positions of a flow `@` in a body.
const PLACES: &[&str] = &[
    "y = @;",
    "y = @ * 2.0;",
    "y = 2.0 * @;",
    "y = F(@);",
    "y = F(@ * 2.0);",
    "y = F(@ = 1.0);",
    "y = F(@ and z);",
    "y = F(2.0, @ * 2.0);",
    "y = F(x: @ * 2.0);",
    "y = F(x: 1.0, y: @ + 1.0);",
    "y = F<<@ * 2>>(z);",
    "y = F<<1; @ * 2>>(z);",
    "y = F<<n: @ - 1>>(z);",
    "y = (@ * 2.0);",
    "y = (1.0, @ * 2.0);",
    "y = [@ * 2.0, @ / 2.0];",
    "y = a[@ - 1];",
    "y = a[@ .. 3];",
    "y = @[1];",
    "y = @.x;",
    "y = p.@ * 2.0;",
    "y = if @ > 1.0 then @ * 2.0 else @ - 1.0;",
    "y = if @ then @ else @;",
    "y = @ -> @ * 2.0;",
    "y = @ fby @;",
    "y = @ ?? @ ?? 0.0;",
    "y = @ => @ or @;",
    "y = @ | @ | z;",
    "y = @ ^ 3;",
    "y = @ when c;",
    "y = z when @;",
    "y = z when not @;",
    "y = merge (c; @ * 2.0; @ / 2.0);",
    "y = merge c (true -> @ * 2.0) (false -> @);",
    "y = pre @ * 2.0;",
    "y = not @ and c;",
    "y = - @ * 2.0;",
    "y = int @ + 1;",
    "y = real @ / 2.0;",
    "y = (a with [@ + 1] = @ * 2.0; [0] = @);",
    "y = (p with .x = @ * 2.0; .y = @ + 1.0);",
    "y = P {x = @ * 2.0; y = @ + 1.0};",
    "y = #(@, z, @);",
    "y = nor(@, z);",
    "assert @ > 1.0;",
    "@ = 1.0;",
    "@, z = F(y);",
    "(@, z) = F(y);",
    "(z, @) = F(@ + 1.0);",
    "arm.@ = z;",
    "finish done when @ > 1.0;",
    "fragment G when @ > 1.0 let z = @ * 2.0; tel",
    "automaton initial state S unless @ * 2.0 > 1.0 then S; let z = @ * 2.0; tel until @ > 1.0 then S; end",
];

/// Returns whether `current` or `last` is an operator, not a name, in a position.
fn is_operator(word: &str, place: &str) -> bool {
    let operand = ["@ - ", "@ (", "@[", "@, z,", "@ -> @"];
    matches!(word, "current" | "last") && operand.iter().any(|form| place.contains(form))
}

/// Returns the first diagnostic message of a position with a given word, if any.
fn first_message(word: &str, place: &str, mode: Dialect) -> Option<String> {
    let head = match mode {
        Dialect::Rpi => "command T ()",
        Dialect::Lustre => "node T () returns ()",
    };
    let text = format!("{head}\nlet\n  {}\ntel\n", place.replace('@', word));
    let diagnostics = parse(FileId(0), &text, mode).diagnostics;
    diagnostics
        .first()
        .map(|diagnostic| diagnostic.message.clone())
}

#[test]
fn words_by_place_are_names_in_every_place_of_an_expression() {
    let mut wrong = Vec::new();
    for mode in [Dialect::Rpi, Dialect::Lustre] {
        let is_plain = |place: &&&str| first_message("other", place, mode).is_none();
        let places: Vec<&&str> = PLACES.iter().filter(is_plain).collect();
        assert!(places.len() > 40, "{} places", places.len());
        let words = KEYWORDS
            .iter()
            .filter(|word| word.is_in(mode) && !word.is_reserved_in(mode));
        for word in words.map(|word| word.text) {
            let names = places.iter().filter(|place| !is_operator(word, place));
            let faults = names.filter_map(|place| Some((place, first_message(word, place, mode)?)));
            wrong.extend(faults.map(|(place, why)| format!("{word}: {place}: {why}")));
        }
    }
    assert!(wrong.is_empty(), "{}\n{}", wrong.len(), wrong.join("\n"));
}
