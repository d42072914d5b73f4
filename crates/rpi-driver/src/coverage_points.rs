//! Coverage points of a program: units, and the fragments, branches and transitions in them.

use rpi_diag::Span;
use rpi_syntax::ast::{
    Automaton, Expr, ExprKind, FragmentDecl, Ident, Item, ItemKind, NodeDef, NodeKind, Visitor,
    Walker,
};

use crate::modules::Modules;

/// Coverage points of a node, function or top-level fragment: the parts that a coverage measurement counts, by source
/// location.
#[derive(Clone, PartialEq, Debug)]
pub struct CoveragePoints {
    /// Kind and name of the declaration, such as `node Gate`.
    pub label: String,
    /// Location of the name in the declaration of the node, function or fragment.
    pub span: Span,
    /// Whether the declaration is in the program itself, not in an imported module.
    pub is_own: bool,
    /// Number of fragments and automaton states in the declaration.
    pub fragments: usize,
    /// Locations of the `if` expressions in the declaration, in source order.
    pub choices: Vec<Span>,
    /// Locations of the automaton transitions in the declaration, in source order.
    pub transitions: Vec<Span>,
}

/// Returns the coverage points of each node, function and fragment of a program and of the modules that it imports.
pub(crate) fn coverage_points(modules: &Modules) -> Vec<CoveragePoints> {
    let own = modules.own_items().count();
    let items = modules.items().enumerate();
    items
        .filter_map(|(k, item)| item_coverage_points(item, k < own))
        .collect()
}

fn item_coverage_points(item: &Item, is_own: bool) -> Option<CoveragePoints> {
    match &item.kind {
        ItemKind::Node(node) if matches!(node.definition, NodeDef::Body(_)) => {
            let what = match node.kind {
                NodeKind::Node => "node",
                NodeKind::Function => "function",
                NodeKind::Contract => return None,
            };
            let mut marks = new_coverage_points(what, &node.signature.name, is_own);
            Walker::new(&mut marks).node(node);
            Some(marks)
        }
        ItemKind::Fragment(fragment) => {
            let mut marks = new_coverage_points("fragment", &fragment.signature.name, is_own);
            marks.fragments = 1;
            Walker::new(&mut marks).fragment(fragment);
            Some(marks)
        }
        _ => None,
    }
}

fn new_coverage_points(what: &str, name: &Ident, is_own: bool) -> CoveragePoints {
    CoveragePoints {
        label: format!("{what} {}", name.name),
        span: name.span,
        is_own,
        fragments: 0,
        choices: Vec::new(),
        transitions: Vec::new(),
    }
}

impl<'a> Visitor<'a> for CoveragePoints {
    fn visit_flow(&mut self, expr: &'a Expr) {
        match &expr.kind {
            ExprKind::If(choice) if !choice.is_static => self.choices.push(expr.span),
            _ => {}
        }
    }

    fn visit_fragment(&mut self, _: &'a FragmentDecl) {
        self.fragments += 1;
    }

    fn visit_automaton(&mut self, automaton: &'a Automaton) {
        self.fragments += automaton.states.len();
        for state in &automaton.states {
            let transitions = state.unless.iter().chain(&state.until);
            self.transitions.extend(transitions.map(|one| one.span));
        }
    }
}
