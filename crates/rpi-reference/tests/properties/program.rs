//! Random programs: declarations, a node `main` with equations, fragments and automata, and a command.

use std::collections::BTreeMap;

use crate::exprs::{Exprs, Flow, Scope};
use crate::forms::CALLED;
use crate::random::Random;
use crate::tree::{Role, Tree};
use crate::types::{KINDS, Kind, PRELUDE, Ty};

/// Number of occurrences of each construct.
#[derive(Clone, Default, Debug)]
pub(crate) struct Counts(pub(crate) BTreeMap<&'static str, usize>);

impl Counts {
    pub(crate) fn add(&mut self, construct: &'static str) {
        *self.0.entry(construct).or_default() += 1;
    }
}

/// Constructs generated in this module and not by a form of expressions.
pub(crate) const STATEMENTS: &[&str] = &[
    "merge",
    "current",
    "when",
    "delayed flow",
    "fragment",
    "fragment, restart",
    "automaton",
    "automaton, strong",
    "automaton, continue",
    "automaton, partial",
    "none in a state",
    "clocked output",
    "last",
    "tuple",
    "instance",
    "assert",
    "export",
    "finish",
    "fail",
    "time",
];

/// In-ports of every `main`.
pub(crate) const INPUTS: &[(&str, Kind)] = &[
    ("a", Kind::Int),
    ("b", Kind::Int),
    ("p", Kind::Bool),
    ("q", Kind::Bool),
    ("u", Kind::Real),
    ("l", Kind::Length),
    ("m", Kind::Mode),
];

/// ProgramGenerator of the parts of one program.
pub(crate) struct ProgramGenerator<'r> {
    pub(crate) exprs: Exprs<'r>,
    serial: usize,
}

/// Generates a program: its tree, and the out-ports of its `main`.
pub(crate) fn program(seed: u64, counts: &mut Counts) -> (Tree, Vec<Flow>) {
    let mut random = Random::new(seed);
    let mut writer = ProgramGenerator {
        exprs: Exprs {
            random: &mut random,
            counts,
        },
        serial: 0,
    };
    let mut tree = Tree::new(Role::Rest);
    tree.text(PRELUDE);
    tree.text(CALLED);
    let (main, outputs) = writer.main();
    tree.push(main);
    tree.push(writer.command());
    (tree, outputs)
}

/// Content of a block: declarations and statements.
pub(crate) struct Body {
    pub(crate) declared: Tree,
    pub(crate) statements: Tree,
}

impl ProgramGenerator<'_> {
    pub(crate) fn name(&mut self, start: &str) -> String {
        self.serial += 1;
        format!("{start}{}", self.serial)
    }

    fn ty(&mut self) -> Ty {
        let kind = *self.exprs.random.pick(KINDS);
        match kind.is_scalar() && self.exprs.random.one_in(3) {
            true => kind.optional(),
            false => kind.total(),
        }
    }

    fn main(&mut self) -> (Tree, Vec<Flow>) {
        let known = INPUTS.iter().map(|(name, kind)| Flow {
            name: (*name).to_owned(),
            ty: kind.total(),
        });
        let known: Vec<Flow> = known.collect();
        let count = 2 + self.exprs.random.below(3);
        let outputs: Vec<Flow> = (0..count).map(|_| self.fresh("y")).collect();
        let body = self.body(known, outputs.clone(), 2, 3);
        let mut tree = Tree::new(Role::Rest);
        let ports = INPUTS
            .iter()
            .map(|(name, kind)| format!("{name}: {}", kind.text()));
        let ports: Vec<String> = ports.collect();
        let results: Vec<String> = outputs.iter().map(declaration).collect();
        let (ports, results) = (ports.join("; "), results.join("; "));
        tree.text(&format!("node main ({ports}) returns ({results})\n"));
        tree.push(body.declared);
        tree.text("let\n");
        tree.push(body.statements);
        tree.text("tel\n");
        (tree, outputs)
    }

    fn fresh(&mut self, start: &str) -> Flow {
        Flow {
            name: self.name(start),
            ty: self.ty(),
        }
    }

    /// Generates a command with a counter, results and exports.
    fn command(&mut self) -> Tree {
        let mut known = Vec::new();
        let mut tree = Tree::new(Role::Item(0));
        tree.text("command Run ()\nlet\n  n = 0 -> pre n + 1;\n  late = time > 5[ms];\n");
        for (name, kind) in [("n", Kind::Int), ("late", Kind::Bool), ("time", Kind::Time)] {
            known.push(Flow {
                name: name.to_owned(),
                ty: kind.total(),
            });
        }
        self.exprs.counts.add("time");
        let flows: Vec<Flow> = (0..2).map(|_| self.fresh("e")).collect();
        let scope = Scope {
            delayed: known.clone(),
            known,
            state: true,
            clock: None,
        };
        for flow in &flows {
            let value = self.exprs.expr(&scope, flow.ty.kind.total(), 3);
            tree.push(Tree::form(
                Role::Item(0),
                &format!("  {0} = @;\n  export {0};\n", flow.name),
                vec![value],
            ));
            self.exprs.counts.add("export");
        }
        let fail = self.exprs.expr(&scope, Kind::Bool.total(), 2);
        let finish = self.exprs.expr(&scope, Kind::Bool.total(), 2);
        self.exprs.counts.add("finish");
        self.exprs.counts.add("fail");
        tree.push(Tree::form(
            Role::Item(0),
            "  fail bad when @ and n > 3 and n < 9;\n",
            vec![fail],
        ));
        tree.push(Tree::form(
            Role::Rest,
            "  finish done when @ or n > 9;\n",
            vec![finish],
        ));
        tree.text("tel\n");
        tree
    }

    /// Generates equations for the required flows and for some local ones.
    pub(crate) fn body(
        &mut self,
        mut known: Vec<Flow>,
        wanted: Vec<Flow>,
        nesting: usize,
        depth: usize,
    ) -> Body {
        let locals: Vec<Flow> = (0..1 + self.exprs.random.below(4))
            .map(|_| self.fresh("x"))
            .collect();
        let mut declared = Tree::new(Role::Rest);
        for local in &locals {
            declared.text(if std::ptr::eq(local, &locals[0]) {
                "var\n"
            } else {
                ""
            });
            let form = format!("  {};\n", declaration(local));
            declared.push(Tree::form(Role::Item(number(local)), &form, Vec::new()));
        }
        let mut delayed = known.clone();
        delayed.retain(|flow| !flow.name.contains('.'));
        delayed.extend(locals.iter().chain(&wanted).cloned());
        let mut statements = Tree::new(Role::Rest);
        for (flow, is_local) in locals
            .iter()
            .map(|f| (f, true))
            .chain(wanted.iter().map(|f| (f, false)))
        {
            let scope = Scope {
                known: known.clone(),
                delayed: delayed.clone(),
                state: true,
                clock: None,
            };
            if nesting > 0 && self.exprs.random.one_in(3) {
                statements.push(self.statement(&scope, &mut known, nesting));
            }
            let value = self.exprs.expr(&scope, flow.ty, depth);
            let role = if is_local {
                Role::Item(number(flow))
            } else {
                Role::Rest
            };
            statements.push(Tree::form(
                role,
                &format!("  {} = @;\n", flow.name),
                vec![value],
            ));
            known.push(flow.clone());
        }
        Body {
            declared,
            statements,
        }
    }

    /// Generates a statement other than an equation; adds the flows that it defines to `known`.
    fn statement(&mut self, scope: &Scope, known: &mut Vec<Flow>, nesting: usize) -> Tree {
        match self.exprs.random.below(6) {
            0 | 1 => self.fragment(scope, known, nesting),
            2 | 3 => self.automaton(scope, known, nesting),
            4 => self.several(scope, known),
            _ => {
                self.exprs.counts.add("assert");
                let claim = self.exprs.expr(scope, Kind::Bool.total(), 2);
                Tree::form(Role::Item(0), "  assert (@ or true);\n", vec![claim])
            }
        }
    }

    /// Generates `fragment F when c let ... tel`.
    fn fragment(&mut self, scope: &Scope, known: &mut Vec<Flow>, nesting: usize) -> Tree {
        let name = self.name("F");
        let restart = self.exprs.random.one_in(2);
        self.exprs.counts.add(if restart {
            "fragment, restart"
        } else {
            "fragment"
        });
        let when = self.exprs.expr(scope, Kind::Bool.total(), 2);
        let wanted: Vec<Flow> = (0..2).map(|_| self.fresh("f")).collect();
        let mut body = self.body(scope.known.clone(), wanted.clone(), nesting - 1, 2);
        for flow in &wanted {
            body.declared.text(&format!("  {};\n", declaration(flow)));
        }
        let restart = if restart { " restart" } else { "" };
        let form = format!("  fragment {name} when @{restart}\n  @let\n@  tel\n");
        for flow in wanted {
            known.push(Flow {
                name: format!("{name}.{}", flow.name),
                ty: flow.ty.kind.optional(),
            });
        }
        Tree::form(
            Role::Item(0),
            &form,
            vec![when, body.declared, body.statements],
        )
    }

    /// Generates a call with several out-ports, bound to several names or to one.
    fn several(&mut self, scope: &Scope, known: &mut Vec<Flow>) -> Tree {
        if self.exprs.random.one_in(3)
            && let Some(tree) = self.clocked(scope, known)
        {
            return tree;
        }
        let x = self.exprs.expr(scope, Kind::Int.total(), 2);
        let on = self.exprs.expr(scope, Kind::Bool.total(), 2);
        let (one, two) = (self.name("v"), self.name("w"));
        let (form, names) = match self.exprs.random.one_in(2) {
            true => {
                self.exprs.counts.add("tuple");
                (format!("  ({one}, {two}) = Both(@, @);\n"), [one, two])
            }
            false => {
                self.exprs.counts.add("instance");
                let names = [format!("{one}.sum"), format!("{one}.changed")];
                (format!("  {one} = Both(@, @);\n"), names)
            }
        };
        for (name, kind) in names.into_iter().zip([Kind::Int, Kind::Bool]) {
            known.push(Flow {
                name,
                ty: kind.total(),
            });
        }
        Tree::form(Role::Item(0), &form, vec![x, on])
    }

    /// Generates a call with out-ports of different clocks, bound to one name.
    fn clocked(&mut self, scope: &Scope, known: &mut Vec<Flow>) -> Option<Tree> {
        let deciding = self.exprs.deciding(scope)?;
        self.exprs.counts.add("clocked output");
        let x = self.exprs.expr(scope, Kind::Int.total(), 2);
        let name = self.name("v");
        for (port, ty) in [("often", Kind::Int.total()), ("rare", Kind::Int.optional())] {
            let name = format!("{name}.{port}");
            known.push(Flow { name, ty });
        }
        let form = format!("  {name} = Sampling({deciding}, @);\n");
        Some(Tree::form(Role::Item(0), &form, vec![x]))
    }
}

/// Returns the number in the name of a flow, which links its declaration and its equation.
pub(crate) fn number(flow: &Flow) -> usize {
    flow.name[1..].parse().unwrap_or(0)
}

pub(crate) fn declaration(flow: &Flow) -> String {
    let mark = if flow.ty.optional { "?" } else { "" };
    format!("{}: {}{mark}", flow.name, flow.ty.kind.text())
}
