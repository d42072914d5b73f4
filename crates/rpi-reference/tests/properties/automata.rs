//! Random automata, as statements of random programs.

use crate::exprs::{Flow, Scope};
use crate::program::ProgramGenerator;
use crate::tree::{Role, Tree};
use crate::types::{KINDS, Kind};

impl ProgramGenerator<'_> {
    /// Generates `automaton initial state A ... end`. Its states define the same flows, or some of them.
    pub(crate) fn automaton(
        &mut self,
        scope: &Scope,
        known: &mut Vec<Flow>,
        nesting: usize,
    ) -> Tree {
        self.exprs.counts.add("automaton");
        let count = 2 + self.exprs.random.below(2);
        let states: Vec<String> = (0..count).map(|_| self.name("S")).collect();
        let kind = *self.exprs.random.pick(KINDS);
        let total = Flow {
            name: self.name("s"),
            ty: kind.total(),
        };
        let partial = Flow {
            name: self.name("t"),
            ty: Kind::Int.optional(),
        };
        let mut tree = Tree::new(Role::Item(0));
        tree.text("  automaton\n");
        for (k, state) in states.iter().enumerate() {
            let initial = if k == 0 { "initial " } else { "" };
            tree.text(&format!("    {initial}state {state}\n"));
            tree.push(self.strong(scope, &states));
            let known = [&scope.known[..], std::slice::from_ref(&total)].concat();
            let inner = Scope {
                delayed: known.clone(),
                known,
                ..scope.clone()
            };
            tree.push(self.state(scope, &total, (&partial, k == 1), nesting));
            tree.push(self.weak(&inner, &states));
        }
        tree.text("  end\n");
        self.exprs.counts.add("automaton, partial");
        known.push(total);
        known.push(partial);
        tree
    }

    fn state(
        &mut self,
        scope: &Scope,
        total: &Flow,
        (partial, is_there): (&Flow, bool),
        nesting: usize,
    ) -> Tree {
        let there = is_there.then_some(partial);
        let wanted: Vec<Flow> = std::iter::once(total).chain(there).cloned().collect();
        let wanted: Vec<Flow> = wanted
            .into_iter()
            .map(|flow| Flow {
                ty: flow.ty.kind.total(),
                ..flow
            })
            .collect();
        let mut body = self.body(scope.known.clone(), wanted, nesting - 1, 2);
        if self.exprs.random.one_in(2) {
            self.exprs.counts.add("last");
            let name = self.name("z");
            let form = format!("  {name} = @ -> last {};\n", total.name);
            let start = Tree::expr(total.ty, total.ty.literal(), Vec::new());
            body.statements
                .push(Tree::form(Role::Item(0), &form, vec![start]));
        }
        if !is_there {
            // Flows defined after the automaton would cause a dependency cycle through it.
            let scope = Scope {
                delayed: scope.known.clone(),
                ..scope.clone()
            };
            body.statements.push(self.partial(&scope, partial));
        }
        Tree::form(
            Role::Rest,
            "    @let\n@    tel\n",
            vec![body.declared, body.statements],
        )
    }

    /// Generates the definition of a flow that another state defines: nothing, `none`, or a value that may be absent.
    fn partial(&mut self, scope: &Scope, flow: &Flow) -> Tree {
        let value = match self.exprs.random.below(3) {
            0 => return Tree::new(Role::Rest),
            1 => {
                self.exprs.counts.add("none in a state");
                Tree::form(Role::Rest, "none", Vec::new())
            }
            // The value must be absent in some cycles; otherwise the flow shared by the states would not be optional.
            _ => {
                let condition = self.exprs.expr(scope, Kind::Bool.total(), 1);
                let value = self.exprs.expr(scope, flow.ty, 2);
                let form = "if @ then @ else none";
                Tree::form(Role::Rest, form, vec![condition, value])
            }
        };
        let form = format!("  {} = @;\n", flow.name);
        Tree::form(Role::Item(0), &form, vec![value])
    }

    fn strong(&mut self, scope: &Scope, states: &[String]) -> Tree {
        if !self.exprs.random.one_in(3) {
            return Tree::new(Role::Rest);
        }
        self.exprs.counts.add("automaton, strong");
        let condition = self.exprs.expr(scope, Kind::Bool.total(), 2);
        let target = self.exprs.random.pick(states).clone();
        Tree::form(
            Role::Item(0),
            &format!("      unless @ then {target};\n"),
            vec![condition],
        )
    }

    fn weak(&mut self, scope: &Scope, states: &[String]) -> Tree {
        let condition = self.exprs.expr(scope, Kind::Bool.total(), 2);
        let target = self.exprs.random.pick(states).clone();
        let how = match self.exprs.random.one_in(2) {
            true => "then",
            false => {
                self.exprs.counts.add("automaton, continue");
                "continue"
            }
        };
        Tree::form(
            Role::Item(0),
            &format!("      until @ {how} {target};\n"),
            vec![condition],
        )
    }
}
