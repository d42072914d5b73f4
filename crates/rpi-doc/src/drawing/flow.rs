//! Conversion of a body to a scene: equations, results, fragments and automata become boxes.

use rpi_diag::Span;
use rpi_sema::query::{DefId, DefKind};
use rpi_syntax::ast::{
    Automaton, Body, End as Ending, EndKind, Equation, Expr, ExprKind, FragmentDecl, Meaning,
    State, Statement, StatementKind, Target, Transition,
};

use super::links::Traffic;
use super::reads::{self, Key, Read};
use super::scene::{Drawing, End, Link, Place, Role, SceneId, Shape, ShapeId};
use crate::declaration::Shown;
use crate::parts::one_line;

/// Largest number of characters in a line of a box.
const LINE: usize = 34;

/// Returns the drawing of the body of a declaration.
pub(super) fn drawing(shown: &Shown<'_>, id: DefId, body: &Body) -> Drawing {
    let mut builder = Builder {
        shown,
        drawing: Drawing::default(),
        traffic: Traffic::default(),
    };
    let root = builder.drawing.scene(None);
    builder.inputs(root, id);
    builder.body(root, body);
    builder.enters_root(root);
    let Builder {
        mut drawing,
        traffic,
        ..
    } = builder;
    traffic.draw(&mut drawing, &|key| name(shown, key));
    drawing
}

fn name(shown: &Shown<'_>, key: &Key) -> String {
    let of = |id: &DefId| shown.seen.index().def(*id).name.to_string();
    match key {
        Key::Flow(id) => of(id),
        Key::Port(device, port) => format!("{}.{}", of(device), of(port)),
        Key::Predeclared(name) => name.clone(),
    }
}

struct Builder<'b> {
    shown: &'b Shown<'b>,
    drawing: Drawing,
    traffic: Traffic,
}

impl Builder<'_> {
    /// Adds the in-ports of a declaration. Devices are shown by the ports that are read.
    fn inputs(&mut self, root: SceneId, id: DefId) {
        let index = self.shown.seen.index();
        let file = index.def(id).span.file;
        for (input, def) in index
            .defs_in(file)
            .filter(|(_, def)| def.parent == Some(id))
        {
            let shape = def.shape.map(|shape| index.def(shape).kind);
            let is_input = matches!(def.kind, DefKind::Input | DefKind::Given | DefKind::Param);
            if is_input && shape != Some(DefKind::Device) {
                let mut shape = Shape::new(Role::Input, def.name.to_string());
                shape.tooltip = self.whole(def.whole);
                let place = self.drawing.shape(root, shape);
                self.traffic.defines(place, Key::Flow(input));
            }
        }
    }

    /// Adds boxes for values that come from devices or from the execution of the command.
    fn enters_root(&mut self, root: SceneId) {
        for key in self.traffic.undefined() {
            if matches!(key, Key::Flow(_)) {
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
                let place = self.boxed(scene, Role::Equation, "", call, statement.span);
                self.reads(place, [&**call]);
            }
            StatementKind::End(end) => self.result(scene, end, statement.span),
            StatementKind::Export(flows) => {
                for flow in flows {
                    let title = format!("export {}", one_line(self.text(flow.span)));
                    let place = self.drawing.shape(scene, Shape::new(Role::Result, title));
                    let index = self.shown.seen.index();
                    let key = reads::key(self.shown.seen, index.references_in(flow.span));
                    self.traffic.reads(place, key.map(now));
                }
            }
            StatementKind::Fragment(fragment) => self.fragment(scene, fragment, statement.span),
            StatementKind::Automaton(automaton) => {
                self.automaton(scene, automaton, statement.span);
            }
            StatementKind::Choice(choice) => self.meaning(scene, &choice.means),
            StatementKind::Keep(keep) => self.meaning(scene, &keep.means),
            StatementKind::Claim(_) | StatementKind::Broken(_) => {}
        }
    }

    /// Adds the equations to which a block is desugared.
    fn meaning(&mut self, scene: SceneId, means: &Meaning) {
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
        let keys: Vec<(Key, bool)> = equation
            .targets
            .iter()
            .filter_map(|t| self.key(t))
            .collect();
        let role = match keys.iter().any(|(_, leaves)| *leaves) {
            true => Role::Defined,
            false => Role::Equation,
        };
        let place = self.boxed(scene, role, &titles.join(", "), &equation.value, whole);
        self.reads(place, [&equation.value]);
        for (key, _) in keys {
            self.traffic.defines(place, key);
        }
    }

    /// Returns what an equation defines, and whether it is an output of the declaration.
    fn key(&self, target: &Target) -> Option<(Key, bool)> {
        let index = self.shown.seen.index();
        let def = index.references_in(target.name.span).first()?.def;
        let kind = index.def(def).kind;
        let leaves = matches!(kind, DefKind::Output | DefKind::Param);
        Some((Key::Flow(def), leaves))
    }

    /// Adds a box for an expression.
    fn boxed(
        &mut self,
        scene: SceneId,
        role: Role,
        title: &str,
        value: &Expr,
        whole: Span,
    ) -> Place {
        let text = one_line(self.text(value.span));
        let mut shape = Shape::new(role, short(title));
        shape.detail = short(&text);
        shape.tooltip = self.whole(whole);
        shape.href = self.callee(value);
        if title.is_empty() {
            shape.title = std::mem::take(&mut shape.detail);
        }
        self.drawing.shape(scene, shape)
    }

    /// Returns the link to the declaration called by an expression.
    fn callee(&self, value: &Expr) -> Option<String> {
        let ExprKind::Call(call) = &value.unparen().kind else {
            return None;
        };
        let seen = self.shown.seen;
        let callee = seen.index().references_in(call.callee.name.span).first()?;
        self.shown.places.href_of_top(seen, callee.def)
    }

    fn result(&mut self, scene: SceneId, end: &Ending, whole: Span) {
        let word = match end.kind {
            EndKind::Finish => "finish",
            EndKind::Yield => "yield",
            EndKind::Fail => "fail",
        };
        let title = format!("{word} {}", end.result.name);
        let place = self.boxed(scene, Role::Result, &title, &end.condition, whole);
        self.reads(place, [&end.condition]);
    }

    fn fragment(&mut self, scene: SceneId, fragment: &FragmentDecl, whole: Span) {
        let mut shape = Shape::new(Role::Fragment, fragment.signature.name.name.to_string());
        if let Some(when) = &fragment.when {
            let restart = if when.restart { " restart" } else { "" };
            let condition = one_line(self.text(when.condition.span));
            shape.tooltip = format!("when {condition}{restart}");
            shape.detail = short(&shape.tooltip);
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
        let states: Vec<Place> = automaton
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

    fn state(&mut self, scene: SceneId, state: &State) -> Place {
        let mut shape = Shape::new(Role::State, state.name.name.to_string());
        if state.initial {
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
        states: &[Place],
        from: Place,
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
            label: short(&label),
        };
        self.drawing.link(from.0, link);
    }

    fn reads<'e>(&mut self, place: Place, exprs: impl IntoIterator<Item = &'e Expr>) {
        self.traffic
            .reads(place, reads::reads(self.shown.seen, exprs));
    }

    fn text(&self, span: Span) -> &str {
        self.shown.seen.sources.slice(span)
    }

    fn whole(&self, span: Span) -> String {
        self.text(span).trim_end_matches(';').to_owned()
    }
}

fn now(key: Key) -> Read {
    Read {
        key,
        delayed: false,
        optional: false,
    }
}

/// Shortens a text to the width of a box.
pub(super) fn short(text: &str) -> String {
    match text.chars().count() > LINE {
        true => text.chars().take(LINE - 1).chain(['\u{2026}']).collect(),
        false => text.to_owned(),
    }
}
