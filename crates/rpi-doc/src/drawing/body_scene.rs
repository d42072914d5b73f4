//! Conversion of a body to a scene: equations, results, fragments and automata become boxes.

use rpi_diag::Span;
use rpi_sema::query::{DefId, DefKind};
use rpi_syntax::ast::{
    Automaton, Body, CommandEnd as Ending, CommandEndKind, Desugared, Equation, Expr, ExprKind,
    FragmentDecl, State, Statement, StatementKind, Target, Transition,
};

use super::links::DefUse;
use super::reads::{self, Read, Source};
use super::scene::{BoxId, Drawing, End, Link, Role, SceneId, Shape, ShapeId};
use crate::declaration::PageContext;
use crate::members::one_line;

/// Maximum number of characters in a line of text in a box.
const MAX_LINE_CHARS: usize = 34;

/// Returns the drawing of the body of a declaration: boxes for its inputs, equations, fragments and automata, and lines
/// for the data flow. `id` is the declaration.
pub(super) fn drawing(shown: &PageContext<'_>, id: DefId, body: &Body) -> Drawing {
    let mut builder = Builder {
        shown,
        drawing: Drawing::default(),
        traffic: DefUse::default(),
    };
    let root = builder.drawing.scene(None);
    builder.inputs(root, id);
    builder.body(root, body);
    builder.external_inputs(root);
    let Builder {
        mut drawing,
        traffic,
        ..
    } = builder;
    traffic.draw(&mut drawing, &|key| name(shown, key));
    drawing
}

fn name(shown: &PageContext<'_>, key: &Source) -> String {
    let of = |id: &DefId| shown.inspected.index().def(*id).name.to_string();
    match key {
        Source::Flow(id) => of(id),
        Source::Port(device, port) => format!("{}.{}", of(device), of(port)),
        Source::Predeclared(name) => name.clone(),
    }
}

struct Builder<'b> {
    shown: &'b PageContext<'b>,
    drawing: Drawing,
    traffic: DefUse,
}

impl Builder<'_> {
    /// Adds a box for each in-port of the declaration `id`. An in-port for a device gets no box, because the ports of
    /// the device that the body reads are shown instead.
    fn inputs(&mut self, root: SceneId, id: DefId) {
        let index = self.shown.inspected.index();
        let file = index.def(id).span.file;
        for (input, def) in index
            .defs_in(file)
            .filter(|(_, def)| def.parent == Some(id))
        {
            let shape = def.shape.map(|shape| index.def(shape).kind);
            let is_input = matches!(
                def.kind,
                DefKind::Input | DefKind::TakenOver | DefKind::Param
            );
            if is_input && shape != Some(DefKind::Device) {
                let mut shape = Shape::new(Role::Input, def.name.to_string());
                shape.tooltip = self.whole(def.full_span);
                let place = self.drawing.shape(root, shape);
                self.traffic.defines(place, Source::Flow(input));
            }
        }
    }

    /// Adds boxes for values that are read but not defined in the body: ports of devices, and predeclared flows such as
    /// `cancel`.
    fn external_inputs(&mut self, root: SceneId) {
        for key in self.traffic.undefined() {
            if matches!(key, Source::Flow(_)) {
                continue;
            }
            let shape = Shape::new(Role::Input, name(self.shown, &key));
            let place = self.drawing.shape(root, shape);
            self.traffic.defines(place, key);
        }
    }

    fn body(&mut self, scene: SceneId, body: &Body) {
        for statement in &body.statements {
            self.statement(scene, statement);
        }
    }

    fn statement(&mut self, scene: SceneId, statement: &Statement) {
        match &statement.kind {
            StatementKind::Equation(equation) => self.equation(scene, equation, statement.span),
            StatementKind::Call(call) => {
                let place = self.add_expr_box(scene, Role::Equation, "", call, statement.span);
                self.reads(place, [&**call]);
            }
            StatementKind::CommandEnd(end) => self.result(scene, end, statement.span),
            StatementKind::Export(flows) => {
                for flow in flows {
                    let title = format!("export {}", one_line(self.text(flow.span)));
                    let place = self.drawing.shape(scene, Shape::new(Role::Result, title));
                    let index = self.shown.inspected.index();
                    let key = reads::key(self.shown.inspected, index.references_in(flow.span));
                    self.traffic.reads(place, key.map(undelayed_read));
                }
            }
            StatementKind::Fragment(fragment) => self.fragment(scene, fragment, statement.span),
            StatementKind::Automaton(automaton) => {
                self.automaton(scene, automaton, statement.span);
            }
            StatementKind::Conditional(choice) => self.meaning(scene, &choice.desugared),
            StatementKind::FrameBlock(keep) => self.meaning(scene, &keep.desugared),
            StatementKind::Claim(_) | StatementKind::Error(_) => {}
        }
    }

    /// Adds boxes for the equations to which a conditional block or a frame block is desugared.
    fn meaning(&mut self, scene: SceneId, means: &Desugared) {
        for (equation, span) in &means.equations {
            self.equation(scene, equation, *span);
        }
    }

    fn equation(&mut self, scene: SceneId, equation: &Equation, whole: Span) {
        let titles: Vec<String> = equation
            .targets
            .iter()
            .map(|target| one_line(self.text(target.span)))
            .collect();
        let keys: Vec<(Source, bool)> = equation
            .targets
            .iter()
            .filter_map(|t| self.key(t))
            .collect();
        let role = match keys.iter().any(|(_, leaves)| *leaves) {
            true => Role::OutputEquation,
            false => Role::Equation,
        };
        let place = self.add_expr_box(scene, role, &titles.join(", "), &equation.value, whole);
        self.reads(place, [&equation.value]);
        for (key, _) in keys {
            self.traffic.defines(place, key);
        }
    }

    /// Returns the flow that a target of an equation defines, and true if the flow is an out-port or parameter of the
    /// declaration, so that its value leaves the body. Returns `None` for an undefined name.
    fn key(&self, target: &Target) -> Option<(Source, bool)> {
        let index = self.shown.inspected.index();
        let def = index.references_in(target.name.span).first()?.def;
        let kind = index.def(def).kind;
        let leaves = matches!(kind, DefKind::Output | DefKind::Param);
        Some((Source::Flow(def), leaves))
    }

    /// Adds a box with the text of an expression and its title. `whole` is the range of source text that the tooltip
    /// shows. The box is linked to the declaration that the expression calls.
    fn add_expr_box(
        &mut self,
        scene: SceneId,
        role: Role,
        title: &str,
        value: &Expr,
        whole: Span,
    ) -> BoxId {
        let text = one_line(self.text(value.span));
        let mut shape = Shape::new(role, truncated(title));
        shape.detail = truncated(&text);
        shape.tooltip = self.whole(whole);
        shape.href = self.callee(value);
        if title.is_empty() {
            shape.title = std::mem::take(&mut shape.detail);
        }
        self.drawing.shape(scene, shape)
    }

    /// Returns the address of the declaration that an expression calls; `None` if the expression is not a call or the
    /// callee has no page.
    fn callee(&self, value: &Expr) -> Option<String> {
        let ExprKind::Call(call) = &value.unparen().kind else {
            return None;
        };
        let seen = self.shown.inspected;
        let callee = seen.index().references_in(call.callee.name.span).first()?;
        self.shown.links.href_of_top(seen, callee.def)
    }

    fn result(&mut self, scene: SceneId, end: &Ending, whole: Span) {
        let word = match end.kind {
            CommandEndKind::Finish => "finish",
            CommandEndKind::Yield => "yield",
            CommandEndKind::Fail => "fail",
        };
        let title = format!("{word} {}", end.result.name);
        let place = self.add_expr_box(scene, Role::Result, &title, &end.condition, whole);
        self.reads(place, [&end.condition]);
    }

    fn fragment(&mut self, scene: SceneId, fragment: &FragmentDecl, whole: Span) {
        let mut shape = Shape::new(Role::Fragment, fragment.signature.name.name.to_string());
        if let Some(when) = &fragment.when {
            let restart = if when.resets { " restart" } else { "" };
            let condition = one_line(self.text(when.condition.span));
            shape.tooltip = format!("when {condition}{restart}");
            shape.detail = truncated(&shape.tooltip);
        }
        let _ = whole;
        let place = self.drawing.shape(scene, shape);
        self.reads(place, fragment.when.iter().map(|when| &when.condition));
        let inner = self.drawing.scene(Some(place));
        self.body(inner, &fragment.body);
    }

    fn automaton(&mut self, scene: SceneId, automaton: &Automaton, whole: Span) {
        let _ = whole;
        let place = self
            .drawing
            .shape(scene, Shape::new(Role::Automaton, "automaton"));
        let inner = self.drawing.scene(Some(place));
        let states: Vec<BoxId> = automaton
            .states
            .iter()
            .map(|state| self.state(inner, state))
            .collect();
        for (state, from) in automaton.states.iter().zip(&states) {
            for transition in state.unless.iter().chain(&state.until) {
                self.transition(automaton, &states, *from, transition);
            }
        }
    }

    fn state(&mut self, scene: SceneId, state: &State) -> BoxId {
        let mut shape = Shape::new(Role::State, state.name.name.to_string());
        if state.is_initial {
            shape.detail = "initial".to_owned();
        }
        let place = self.drawing.shape(scene, shape);
        if !state.body.statements.is_empty() {
            let inner = self.drawing.scene(Some(place));
            self.body(inner, &state.body);
        }
        place
    }

    fn transition(
        &mut self,
        automaton: &Automaton,
        states: &[BoxId],
        from: BoxId,
        transition: &Transition,
    ) {
        self.reads(from, &transition.condition);
        let is_target = |state: &State| state.name.name == transition.target.name;
        let Some(to) = automaton.states.iter().position(is_target) else {
            return;
        };
        let condition = transition.condition.as_ref();
        let label = condition.map_or("otherwise".to_owned(), |c| one_line(self.text(c.span)));
        let end = |shape: ShapeId| End { shape, port: None };
        let link = Link {
            from: end(from.1),
            to: end(states[to].1),
            delayed: to <= from.1,
            optional: false,
            label: truncated(&label),
        };
        self.drawing.link(from.0, link);
    }

    fn reads<'e>(&mut self, place: BoxId, exprs: impl IntoIterator<Item = &'e Expr>) {
        self.traffic
            .reads(place, reads::reads(self.shown.inspected, exprs));
    }

    fn text(&self, span: Span) -> &str {
        self.shown.inspected.sources.slice(span)
    }

    fn whole(&self, span: Span) -> String {
        self.text(span).trim_end_matches(';').to_owned()
    }
}

fn undelayed_read(key: Source) -> Read {
    Read {
        key,
        delayed: false,
        optional: false,
    }
}

/// Returns a text shortened to the maximum number of characters in a line of a box, with an ellipsis at the end.
pub(super) fn truncated(text: &str) -> String {
    match text.chars().count() > MAX_LINE_CHARS {
        true => text
            .chars()
            .take(MAX_LINE_CHARS - 1)
            .chain(['\u{2026}'])
            .collect(),
        false => text.to_owned(),
    }
}
