//! Distribution of statements over C functions.

use crate::variables::MAX_STATEMENTS;

/// C statement, or block of statements.
#[derive(Clone, Debug)]
pub(crate) enum Node {
    /// Text of a statement, which may have several lines.
    Line(String),
    /// Block with a head such as `if (x)`.
    Block {
        /// Text before the opening brace.
        head: String,
        /// Statements in the block.
        body: Vec<Node>,
    },
}

impl Node {
    fn weight(&self) -> usize {
        match self {
            Node::Line(_) => 1,
            Node::Block { body, .. } => 1 + body.iter().map(Node::weight).sum::<usize>(),
        }
    }
}

/// Appends the text of statements.
pub(crate) fn print(nodes: &[Node], depth: usize, out: &mut String) {
    let indent = "  ".repeat(depth);
    for node in nodes {
        match node {
            Node::Line(text) => {
                for line in text.lines() {
                    // A directive starts in the first column.
                    let indent = if line.starts_with('#') { "" } else { &indent };
                    out.push_str(&format!("{indent}{line}\n"));
                }
            }
            Node::Block { head, body } => {
                out.push_str(&format!("{indent}{head} {{\n"));
                print(body, depth + 1, out);
                out.push_str(&format!("{indent}}}\n"));
            }
        }
    }
}

/// Functions into which statements are moved.
pub(crate) struct Parts {
    /// Statements of each function.
    pub(crate) functions: Vec<Vec<Node>>,
}

impl Parts {
    /// Moves statements to functions of at most [`MAX_STATEMENTS`] statements each. Returns the statements that remain,
    /// which call the functions with `call`.
    pub(crate) fn split(&mut self, nodes: Vec<Node>, call: &dyn Fn(usize) -> String) -> Vec<Node> {
        if nodes.iter().map(Node::weight).sum::<usize>() <= MAX_STATEMENTS {
            return nodes;
        }
        let (mut remaining, mut part, mut weight) = (Vec::new(), Vec::new(), 0);
        for node in nodes {
            let node = match node {
                Node::Block { head, body } => Node::Block {
                    head,
                    body: self.split(body, call),
                },
                line => line,
            };
            weight += node.weight();
            part.push(node);
            if weight >= MAX_STATEMENTS / 2 {
                remaining.push(self.function(std::mem::take(&mut part), call));
                weight = 0;
            }
        }
        if !part.is_empty() {
            remaining.push(self.function(part, call));
        }
        self.split(remaining, call)
    }

    fn function(&mut self, part: Vec<Node>, call: &dyn Fn(usize) -> String) -> Node {
        self.functions.push(part);
        Node::Line(call(self.functions.len() - 1))
    }
}
