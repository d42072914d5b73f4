//! `cargo xtask draw --seed N`: draws doc comments and diagnostics at random.
//!
//! Whoever judges the texts sees what a newcomer sees: a comment with the name and signature of its item, or a rendered
//! diagnostic. A comment that cannot be understood from these alone needs a better text. The same seed draws the same
//! texts, as long as the sources do not change.

use xtask::{source_files, tracked_files};

use crate::fuzz::root;
use crate::task_error::TaskError;

/// Seed of the random draw without the option `--seed`.
const SEED: u64 = 1;
/// Number of drawn doc comments without the option `--comments`.
const COMMENTS: usize = 100;
/// Number of drawn diagnostics without the option `--diagnostics`.
const DIAGNOSTICS: usize = 60;

const USAGE: &str = "usage: cargo xtask draw [--seed N] [--comments N] [--diagnostics N]";

/// Carries out `cargo xtask draw`: prints doc comments and diagnostics of the project that are drawn at random.
pub(crate) fn draw(args: &[String]) -> Result<(), TaskError> {
    let options = Options::parse(args)?;
    let mut random = Random(options.seed);
    let all = source_files();
    let comments = all.iter().flat_map(|file| {
        let found = comments(file.without_tests());
        found.into_iter().map(|comment| (&file.path, comment))
    });
    for (n, (path, comment)) in random
        .sample(comments.collect(), options.comments)
        .iter()
        .enumerate()
    {
        println!("{:>3}. {}: {}", n + 1, path.display(), comment.signature);
        println!("{}", comment.text);
    }
    for text in random.sample(diagnostics()?, options.diagnostics) {
        println!("-----\n{text}");
    }
    Ok(())
}

/// Returns the diagnostics that the tests of the compiler expect, one text for each test program that has any.
fn diagnostics() -> Result<Vec<String>, TaskError> {
    let mut texts = Vec::new();
    for path in tracked_files() {
        if path.starts_with("tests/ui") && path.extension().is_some_and(|e| e == "stderr") {
            let text =
                std::fs::read_to_string(root().join(path)).map_err(|error| error.to_string())?;
            texts.push(text);
        }
    }
    // A program without any diagnostic has an empty file.
    texts.retain(|text| !text.trim().is_empty());
    Ok(texts)
}

struct Options {
    seed: u64,
    comments: usize,
    diagnostics: usize,
}

impl Options {
    fn parse(args: &[String]) -> Result<Options, TaskError> {
        let mut options = Options {
            seed: SEED,
            comments: COMMENTS,
            diagnostics: DIAGNOSTICS,
        };
        for pair in args.chunks(2) {
            let [flag, value] = pair else {
                return Err(USAGE.into());
            };
            let number: usize = value.parse().map_err(|_| USAGE.to_owned())?;
            match flag.as_str() {
                "--seed" => options.seed = number as u64,
                "--comments" => options.comments = number,
                "--diagnostics" => options.diagnostics = number,
                _ => return Err(USAGE.into()),
            }
        }
        Ok(options)
    }
}

/// Doc comment of a source file, with the signature of the item that it describes.
#[derive(Clone, PartialEq, Eq, Debug)]
struct Comment {
    /// Signature of the item on one line. For a member of a type, the name of the type precedes it in brackets.
    signature: String,
    /// Text of the comment without `///`, each line indented.
    text: String,
}

/// Returns the doc comments of a Rust source text that rustfmt has formatted, in order.
fn comments(text: &str) -> Vec<Comment> {
    let mut found = Vec::new();
    let mut owner = "";
    let mut variant = "";
    let mut lines = text.lines().peekable();
    while let Some(line) = lines.next() {
        if is_owner(line) {
            owner = line.trim_end_matches('{').trim();
        } else if line == "}" {
            owner = "";
        } else if let Some(name) = opened_variant(line) {
            variant = name;
        } else if line == "    }," {
            variant = "";
        }
        let Some(first) = line.trim_start().strip_prefix("///") else {
            continue;
        };
        let is_member = line.starts_with(' ');
        let mut doc = format!("       {}", first.trim());
        while let Some(next) = lines
            .peek()
            .and_then(|l| l.trim_start().strip_prefix("///"))
        {
            doc.push_str(&format!("\n       {}", next.trim()));
            lines.next();
        }
        while lines
            .peek()
            .is_some_and(|l| l.trim_start().starts_with(['#', '/']))
        {
            lines.next();
        }
        let mut item = String::new();
        // The signature ends at the body or at the end of the item. The first line may open the type of later members.
        while let Some(next) = lines.peek() {
            item.push_str(&format!("{} ", next.trim()));
            if next.ends_with(['{', '}', ';', ',']) && is_balanced(&item) {
                break;
            }
            lines.next();
        }
        let item = item.trim().trim_end_matches(['{', ',']).trim();
        let is_field_of_variant = line.starts_with("        ") && !variant.is_empty();
        let signature = match is_member && !owner.is_empty() {
            true if is_field_of_variant => format!("[{owner}::{variant}] {item}"),
            true => format!("[{owner}] {item}"),
            false => item.to_owned(),
        };
        found.push(Comment {
            signature,
            text: doc,
        });
    }
    found
}

/// Returns true if a line is the first one of a type, trait or implementation, whose members follow.
fn is_owner(line: &str) -> bool {
    let line = match line.strip_prefix("pub(") {
        Some(rest) => rest.split_once(") ").map_or("", |(_, item)| item),
        None => line.strip_prefix("pub ").unwrap_or(line),
    };
    let words = ["struct ", "enum ", "trait ", "impl ", "impl<"];
    line.ends_with('{') && words.iter().any(|word| line.starts_with(word))
}

/// Returns the name of the enum variant with named fields whose declaration begins in this line; `None` for other
/// lines.
fn opened_variant(line: &str) -> Option<&str> {
    let name = line.strip_prefix("    ")?.strip_suffix(" {")?;
    let is_name = name.starts_with(|c: char| c.is_ascii_uppercase())
        && name.chars().all(|c| c.is_ascii_alphanumeric());
    is_name.then_some(name)
}

/// Returns true if every parenthesis and bracket in the text of an item is closed. A brace at the end opens the body
/// and does not count.
fn is_balanced(item: &str) -> bool {
    let count = |c: char| item.matches(c).count();
    count('(') == count(')') && count('[') == count(']')
}

/// Pseudo-random number generator SplitMix64 (G. Steele, D. Lea and C. Flood, 2014): good enough for a draw, and the
/// same on every machine. The field is the state.
struct Random(u64);

impl Random {
    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    /// Returns `count` items that are drawn at random without replacement, or all if there are fewer.
    fn sample<T>(&mut self, mut items: Vec<T>, count: usize) -> Vec<T> {
        let mut drawn = Vec::new();
        while drawn.len() < count && !items.is_empty() {
            let at = (self.next() % items.len() as u64) as usize;
            drawn.push(items.swap_remove(at));
        }
        drawn
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const TEXT: &str = "\
/// A wheel.
#[derive(Debug)]
pub struct Wheel {
    /// Radius in
    /// metres.
    pub radius: f64,
}

impl Wheel {
    /// Turns it.
    pub fn turn(
        &mut self,
        angle: f64,
    ) -> f64 {
        0.0
    }
}

/// Number of wheels.
const WHEELS: [usize; 2] = [1, 2];

/// Kind of drive.
enum Drive {
    /// Driven by a motor.
    Motor {
        /// Power in watts.
        power: f64,
    },
    /// Not driven.
    Free,
}

trait Brake {
    /// Stops the wheel.
    fn stop(&mut self) {}

    /// Lets the wheel go.
    fn release(&mut self);
}
";

    #[test]
    fn comments_come_with_their_signatures() {
        let found = comments(TEXT);
        let signatures: Vec<&str> = found.iter().map(|c| c.signature.as_str()).collect();
        let expected = [
            "pub struct Wheel",
            "[pub struct Wheel] pub radius: f64",
            "[impl Wheel] pub fn turn( &mut self, angle: f64, ) -> f64",
            "const WHEELS: [usize; 2] = [1, 2];",
            "enum Drive",
            "[enum Drive] Motor",
            "[enum Drive::Motor] power: f64",
            "[enum Drive] Free",
            "[trait Brake] fn stop(&mut self) {}",
            "[trait Brake] fn release(&mut self);",
        ];
        assert_eq!(signatures, expected);
        assert_eq!(found[1].text, "       Radius in\n       metres.");
    }

    #[test]
    fn drawn_diagnostics_have_a_text() {
        let found = diagnostics().expect("the tests of the compiler can be read");
        assert!(found.len() > 100);
        assert!(found.iter().all(|text| text.contains("RPI")));
    }

    #[test]
    fn a_seed_draws_each_item_once() {
        let mut drawn = Random(7).sample((0..50).collect(), 60);
        assert_ne!(drawn, (0..50).collect::<Vec<_>>());
        assert_eq!(drawn, Random(7).sample((0..50).collect(), 60));
        drawn.sort_unstable();
        assert_eq!(drawn, (0..50).collect::<Vec<_>>());
    }
}
