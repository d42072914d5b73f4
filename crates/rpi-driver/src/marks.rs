//! What a program has that its tests can reach: what is declared, and the fragments, branches and transitions in it.

use rpi_diag::Span;
use rpi_syntax::ast::{
    Automaton, Expr, ExprKind, FragmentDecl, Ident, Item, ItemKind, NodeDef, NodeKind, Visit, Walk,
};

use crate::modules::Modules;

/// A node, function or fragment, and what is in it, all by their places in the text.
#[derive(Clone, PartialEq, Debug)]
pub struct Marks {
    /// What it is and its name: `node Gate`.
    pub what: String,
    /// Its name.
    pub span: Span,
    /// Whether it stands in the program itself, not in a module that it uses.
    pub is_own: bool,
    /// How many fragments and states it has.
    pub fragments: usize,
    /// Each `if` in text order.
    pub choices: Vec<Span>,
    /// Each transition in text order.
    pub transitions: Vec<Span>,
}

/// What can be reached in a program and in the modules that it uses.
pub(crate) fn of_modules(modules: &Modules) -> Vec<Marks> {
    let own = modules.own_items().count();
    let items = modules.items().enumerate();
    items
        .filter_map(|(k, item)| of_item(item, k < own))
        .collect()
}

fn of_item(item: &Item, is_own: bool) -> Option<Marks> {
    match &item.kind {
        ItemKind::Node(node) if matches!(node.definition, NodeDef::Body(_)) => {
            let what = match node.kind {
                NodeKind::Node => "node",
                NodeKind::Function => "function",
                NodeKind::Contract => return None,
            };
            let mut marks = named(what, &node.signature.name, is_own);
            Walk::new(&mut marks).node(node);
            Some(marks)
        }
        ItemKind::Fragment(fragment) => {
            let mut marks = named("fragment", &fragment.signature.name, is_own);
            marks.fragments = 1;
            Walk::new(&mut marks).fragment(fragment);
            Some(marks)
        }
        _ => None,
    }
}

fn named(what: &str, name: &Ident, is_own: bool) -> Marks {
    Marks {
        what: format!("{what} {}", name.name),
        span: name.span,
        is_own,
        fragments: 0,
        choices: Vec::new(),
        transitions: Vec::new(),
    }
}

impl<'a> Visit<'a> for Marks {
    fn flow(&mut self, expr: &'a Expr) {
        match &expr.kind {
            ExprKind::If(choice) if !choice.is_static => self.choices.push(expr.span),
            _ => {}
        }
    }

    fn fragment(&mut self, _: &'a FragmentDecl) {
        self.fragments += 1;
    }

    fn automaton(&mut self, automaton: &'a Automaton) {
        self.fragments += automaton.states.len();
        for state in &automaton.states {
            let transitions = state.unless.iter().chain(&state.until);
            self.transitions.extend(transitions.map(|one| one.span));
        }
    }
}
