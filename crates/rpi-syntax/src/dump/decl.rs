//! Dumps of declarations, bodies and tasks.

use super::expr::{clock, dotted, flag, name, option};
use super::sexp::Sexp;
use super::{Dumper, list_node, nodes};
use crate::ast::*;

pub(super) fn doc(doc: Option<&Doc>) -> Sexp {
    option("doc", doc, |doc| Sexp::quoted(doc))
}

/// Creates an atom whose text is the name of an enum variant in lower case.
fn word(variant: impl std::fmt::Debug) -> Sexp {
    Sexp::atom(format!("{variant:?}").to_lowercase())
}

impl Dumper {
    pub(super) fn item(&self, item: &Item) -> Sexp {
        let declared = match &item.kind {
            ItemKind::Use(modules) => nodes("use", modules, name),
            ItemKind::Include(file) => list_node("include", [Sexp::quoted(&file.name)]),
            ItemKind::Const(defs) => nodes("const", defs, |def| self.const_def(def)),
            ItemKind::Type(defs) => nodes("type", defs, |def| self.type_def(def)),
            ItemKind::Node(decl) => self.node_decl(decl),
            ItemKind::Fragment(fragment) => self.fragment(fragment),
            ItemKind::Primitive(primitive) => {
                let budget = self.budget(primitive.budget.as_ref());
                list_node("primitive", [self.signature(&primitive.signature), budget])
            }
            ItemKind::Device(device) => self.device(device),
            ItemKind::Frame(frame) => {
                let parent = frame.parent.as_ref().map_or(Sexp::Empty, dotted);
                let pose = option("pose", frame.pose.as_ref(), |pose| self.expr(pose));
                list_node("frame", [nodes("names", &frame.names, name), parent, pose])
            }
            ItemKind::Command(command) => self.command(command),
            ItemKind::Task(task) => self.task(task),
            ItemKind::Test(test) => list_node(
                "test",
                [Sexp::quoted(&test.title.name), self.body(&test.body)],
            ),
            ItemKind::Error(declared) => nodes("broken", declared, |d| {
                list_node("declares", [word(d.kind), name(&d.name)])
            }),
        };
        with_doc(item.doc.as_ref(), declared)
    }

    fn const_def(&self, def: &ConstDef) -> Sexp {
        let ty = option("type", def.ty.as_ref(), |ty| self.ty(ty));
        let value = option("value", def.value.as_ref(), |value| self.expr(value));
        with_doc(
            def.doc.as_ref(),
            list_node("def", [nodes("names", &def.names, name), ty, value]),
        )
    }

    fn type_def(&self, def: &TypeDef) -> Sexp {
        let ty = def.ty.as_ref().map_or(Sexp::Empty, |ty| self.ty(ty));
        with_doc(
            def.doc.as_ref(),
            list_node("def", [name(&def.name), self.statics(&def.statics), ty]),
        )
    }

    pub(super) fn var(&self, var: &VarDecl) -> Sexp {
        let parts = [
            flag("const", var.is_const),
            nodes("names", &var.names, name),
            self.ty(&var.ty),
            var.clock.as_ref().map_or(Sexp::Empty, clock),
            option("default", var.default.as_ref(), |value| self.expr(value)),
        ];
        with_doc(var.doc.as_ref(), list_node("var", parts))
    }

    fn vars(&self, tag: &str, vars: &[VarDecl]) -> Sexp {
        nodes(tag, vars, |var| self.var(var))
    }

    fn signature(&self, signature: &Signature) -> Sexp {
        let ports = |tag: &str, ports: &Option<Vec<VarDecl>>| match ports {
            Some(ports) => self.vars(tag, ports),
            None => Sexp::Empty,
        };
        let (inputs, outputs) = (
            ports("in", &signature.inputs),
            ports("out", &signature.outputs),
        );
        list_node(
            "signature",
            [
                name(&signature.name),
                self.statics(&signature.statics),
                inputs,
                outputs,
            ],
        )
    }

    fn statics(&self, params: &[StaticParam]) -> Sexp {
        if params.is_empty() {
            return Sexp::Empty;
        }
        nodes("statics", params, |param| {
            let declared = match &param.kind {
                StaticParamKind::Type(ident, constraint) => {
                    list_node("type", [ident].into_iter().chain(constraint).map(name))
                }
                StaticParamKind::Value(def) => self.const_def(def),
                StaticParamKind::Node(kind, signature) => {
                    list_node("node", [word(kind), self.signature(signature)])
                }
            };
            with_doc(param.doc.as_ref(), declared)
        })
    }

    fn node_decl(&self, decl: &NodeDecl) -> Sexp {
        let definition = match &decl.definition {
            NodeDef::Body(body) => self.body(body),
            NodeDef::Alias(callee) => list_node("alias", [self.callee(callee)]),
            NodeDef::Extern => list_node(
                "extern",
                std::iter::once(word(decl.external_form)).chain(decl.c_name.iter().map(name)),
            ),
        };
        let head = [
            word(decl.kind),
            decl.modifier.keyword().map_or(Sexp::Empty, Sexp::atom),
            self.signature(&decl.signature),
        ];
        let contract = self.contract(decl.contract.as_ref());
        list_node("node", head.into_iter().chain([contract, definition]))
    }

    fn fragment(&self, fragment: &FragmentDecl) -> Sexp {
        let when = option("when", fragment.when.as_ref(), |when| {
            self.expr(&when.condition)
        });
        let restart = flag(
            "restart",
            fragment.when.as_ref().is_some_and(|when| when.resets),
        );
        let head = [
            self.signature(&fragment.signature),
            when,
            restart,
            self.budget(fragment.budget.as_ref()),
        ];
        let rest = [
            self.contract(fragment.contract.as_ref()),
            self.body(&fragment.body),
        ];
        list_node("fragment", head.into_iter().chain(rest))
    }

    fn budget(&self, budget: Option<&Expr>) -> Sexp {
        option("budget", budget, |budget| self.expr(budget))
    }

    fn device(&self, device: &DeviceDecl) -> Sexp {
        let port = |port: &DevicePort| self.vars("port", &port.alternatives);
        let section = |s: &DeviceSection| {
            list_node(
                "section",
                std::iter::once(word(s.kind)).chain(s.ports.iter().map(port)),
            )
        };
        let sections = device.sections.iter().map(section);
        list_node(
            "device",
            [name(&device.name), self.statics(&device.statics)]
                .into_iter()
                .chain(sections),
        )
    }

    fn command(&self, command: &CommandDecl) -> Sexp {
        let head = [
            name(&command.name),
            self.statics(&command.statics),
            self.vars("params", &command.params),
            self.vars("given", &command.given),
        ];
        let rest = [
            self.budget(command.budget.as_ref()),
            self.contract(command.contract.as_ref()),
            self.body(&command.body),
        ];
        list_node("command", head.into_iter().chain(rest))
    }

    fn body(&self, body: &Body) -> Sexp {
        let locals = body.locals.iter().map(|locals| self.locals(locals));
        let statements = body
            .statements
            .iter()
            .map(|statement| self.statement(statement));
        list_node("body", locals.chain(statements))
    }

    fn locals(&self, locals: &Locals) -> Sexp {
        match locals {
            Locals::Var(vars) => self.vars("vars", vars),
            Locals::Const(defs) => nodes("consts", defs, |def| self.const_def(def)),
        }
    }

    fn statement(&self, statement: &Statement) -> Sexp {
        let written = match &statement.kind {
            StatementKind::Equation(equation) => {
                let target = |t: &Target| match &t.path[..] {
                    [] => name(&t.name),
                    path => list_node("target", [name(&t.name), self.path(path)]),
                };
                list_node(
                    "let",
                    [
                        nodes("targets", &equation.targets, target),
                        self.expr(&equation.value),
                    ],
                )
            }
            StatementKind::Call(call) => list_node("do", [self.expr(call)]),
            StatementKind::Claim(claim) => self.claim(claim),
            StatementKind::CommandEnd(end) => list_node(
                "end",
                [word(end.kind), name(&end.result), self.expr(&end.condition)],
            ),
            StatementKind::Export(flows) => nodes("export", flows, dotted),
            StatementKind::Fragment(fragment) => self.fragment(fragment),
            StatementKind::Automaton(automaton) => {
                nodes("automaton", &automaton.states, |s| self.state(s))
            }
            StatementKind::Conditional(choice) => self.choice(choice),
            StatementKind::FrameBlock(keep) => list_node(
                "frame",
                [
                    nodes("names", &keep.names, name),
                    self.block("initial", &keep.initial),
                    self.block("then", &keep.statements),
                ],
            ),
            StatementKind::Error(names) => nodes("broken", names, name),
        };
        with_doc(statement.doc.as_ref(), written)
    }

    fn block(&self, tag: &str, statements: &[Statement]) -> Sexp {
        nodes(tag, statements, |statement| self.statement(statement))
    }

    fn choice(&self, choice: &ConditionalBlock) -> Sexp {
        let branches = choice.branches.iter().map(|branch| {
            let condition = self.expr(&branch.condition);
            list_node(
                "branch",
                [condition, self.block("then", &branch.statements)],
            )
        });
        let otherwise = choice.else_statements.as_ref();
        let otherwise = otherwise.map_or(Sexp::Empty, |all| self.block("otherwise", all));
        let head = Sexp::atom(choice.keyword.open_keyword().trim_end());
        list_node(
            "choice",
            [head].into_iter().chain(branches).chain([otherwise]),
        )
    }

    fn claim(&self, claim: &Claim) -> Sexp {
        let label = option("label", claim.label.as_ref(), |label| {
            Sexp::quoted(&label.name)
        });
        list_node(
            "claim",
            [
                word(claim.kind),
                label,
                self.expr(&claim.condition),
                option("provided", claim.provided.as_ref(), |when| self.expr(when)),
            ],
        )
    }

    fn state(&self, state: &State) -> Sexp {
        let transitions = |tag: &str, list: &[Transition]| nodes(tag, list, |t| self.transition(t));
        let parts = [
            flag("initial", state.is_initial),
            name(&state.name),
            transitions("unless", &state.unless),
            self.body(&state.body),
            transitions("until", &state.until),
        ];
        with_doc(state.doc.as_ref(), list_node("state", parts))
    }

    fn transition(&self, transition: &Transition) -> Sexp {
        let condition = option("if", transition.condition.as_ref(), |c| self.expr(c));
        let then = if transition.resumes {
            "continue"
        } else {
            "then"
        };
        list_node(then, [condition, name(&transition.target)])
    }

    fn contract(&self, contract: Option<&Contract>) -> Sexp {
        let Some(contract) = contract else {
            return Sexp::Empty;
        };
        let mode = |mode: &ContractMode| {
            let claims = mode.requires.iter().chain(&mode.ensures);
            list_node(
                "mode",
                std::iter::once(name(&mode.name)).chain(claims.map(|claim| self.claim(claim))),
            )
        };
        let locals = contract.locals.iter().map(|locals| self.locals(locals));
        let together = contract.ghost_tuples.iter().map(|together| {
            let value = self.expr(&together.equation.value);
            list_node("together", [self.vars("vars", &together.vars), value])
        });
        let claims = contract.claims.iter().map(|claim| self.claim(claim));
        let imports = contract.imports.iter();
        let imports = imports.map(|import| list_node("import", [self.expr(&import.call)]));
        list_node(
            "contract",
            locals
                .chain(together)
                .chain(imports)
                .chain(claims)
                .chain(contract.modes.iter().map(mode)),
        )
    }

    fn task(&self, task: &TaskDecl) -> Sexp {
        let head = [
            name(&task.name),
            self.statics(&task.statics),
            self.vars("params", &task.params),
        ];
        list_node(
            "task",
            head.into_iter()
                .chain(task.steps.iter().map(|step| self.step(step))),
        )
    }

    fn step(&self, step: &Step) -> Sexp {
        let written = match &step.kind {
            StepKind::Run(run) => self.run(run),
            StepKind::Repeat { count, steps } => {
                let count = option("times", count.as_ref(), |count| self.expr(count));
                list_node(
                    "repeat",
                    std::iter::once(count).chain(steps.iter().map(|step| self.step(step))),
                )
            }
            StepKind::Parallel(strands) => nodes("parallel", strands, |strand| {
                nodes("strand", &strand.steps, |step| self.step(step))
            }),
            StepKind::Start(label) => list_node("start", [name(label)]),
            StepKind::Error(names) => nodes("broken", names, name),
        };
        with_doc(step.doc.as_ref(), written)
    }

    fn run(&self, run: &Run) -> Sexp {
        let head = [
            option("label", run.label.as_ref(), name),
            self.callee(&run.callee),
            self.args(&run.args),
        ];
        list_node(
            "run",
            head.into_iter().chain(run.branches.iter().map(branch)),
        )
    }
}

fn branch(branch: &Branch) -> Sexp {
    let on = nodes("on", &branch.results, |result| match result {
        ResultPattern::Named(result) => name(result),
        ResultPattern::Fail(_) => Sexp::atom("fail"),
        ResultPattern::Any(_) => Sexp::atom("any"),
    });
    let then = match &branch.next {
        NextStep::Step(label) => name(label),
        NextStep::End(_) => Sexp::atom("end"),
    };
    list_node("branch", [on, then])
}

fn with_doc(text: Option<&Doc>, declared: Sexp) -> Sexp {
    match text {
        Some(_) => list_node("documented", [doc(text), declared]),
        None => declared,
    }
}
