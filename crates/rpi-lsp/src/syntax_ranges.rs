//! Source ranges of the constructs of a document: declarations, statements, states, steps and expressions.

use rpi_diag::{FileId, Span};
use rpi_driver::Inspection;
use rpi_syntax::ast::{
    Automaton, Expr, Item, Statement, StatementKind, Step, StepKind, Visitor, Walker,
};

/// Source ranges of the constructs of a document, collected from its syntax tree.
#[derive(Default)]
pub(crate) struct SyntaxRanges {
    /// Ranges of constructs that can have several lines: declarations, statements, states, steps, branches.
    pub(crate) blocks: Vec<Span>,
    /// Ranges of expressions.
    pub(crate) expressions: Vec<Span>,
}

impl SyntaxRanges {
    /// Collects the ranges of the root file of a program.
    pub(crate) fn new(seen: &Inspection) -> SyntaxRanges {
        let mut ranges = SyntaxRanges::default();
        for item in seen.own_items() {
            ranges.item(item);
        }
        let is_here = |span: &Span| !span.is_none() && span.file == FileId(0);
        ranges.blocks.retain(is_here);
        ranges.expressions.retain(is_here);
        ranges
    }

    fn item(&mut self, item: &Item) {
        self.blocks.push(item.span);
        Walker::new(self).item(item);
    }
}

impl<'a> Visitor<'a> for SyntaxRanges {
    fn visit_flow(&mut self, expr: &'a Expr) {
        self.expressions.push(expr.span);
    }

    fn visit_automaton(&mut self, automaton: &'a Automaton) {
        self.blocks
            .extend(automaton.states.iter().map(|state| state.span));
    }

    fn visit_statement(&mut self, statement: &'a Statement) {
        self.blocks.push(statement.span);
        if let StatementKind::Equation(equation) = &statement.kind {
            self.expressions
                .extend(equation.targets.iter().map(|target| target.span));
        }
    }

    fn visit_step(&mut self, step: &'a Step) {
        self.blocks.push(step.span);
        if let StepKind::Parallel(branches) = &step.kind {
            self.blocks
                .extend(branches.iter().map(|branch| branch.span));
        }
    }
}
