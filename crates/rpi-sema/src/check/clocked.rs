//! Operators on clocks: `when`, `merge`, `current`; and `last` in automata.

use super::body::Body;
use super::locals::Local;
use super::report::{Wanted, listed, not_a, unknown};
use crate::hash::{Map, Set};
use crate::ty::{EnumTy, Ty, join};
use crate::typed::{ClockOn, Each, ExprId, FlowId, Kind};
use rpi_diag::{Code, Finding, Span};
use rpi_syntax::ast::{self, Clock, Ident, Merge, Tick, When};
use std::rc::Rc;

impl<'a> Body<'_, 'a> {
    /// Checks `x when c`.
    pub(super) fn when(&mut self, when: &'a When, span: Span) -> ExprId {
        let value = self.expr(&when.value);
        let ty = self.ty_of(value).clone();
        match self.clock_on(&when.clock) {
            Some(clock) => self.add(Kind::When { value, clock }, ty, span),
            None => self.add(Kind::Fault, ty, span),
        }
    }

    /// Resolves a clock: the flow that decides, and the value for which the clock is present.
    pub(super) fn clock_on(&mut self, clock: &Clock) -> Option<ClockOn> {
        self.unit.has_clocks = true;
        let flow = self.clock_flow(&clock.flow)?;
        let value = match &clock.tick {
            Tick::True => 1,
            Tick::False => 0,
            Tick::Value(value) => return self.clock_value(flow, value),
        };
        let ty = self.unit.flow(flow).ty.clone();
        if !matches!(ty, Ty::Bool | Ty::Unknown) {
            if !self.no_clocks.tell(&flow, self.findings.len()) {
                return None;
            }
            let finding = Finding::new(Code::RPI2001, format!("expected `bool`, found `{ty}`"))
                .at(
                    clock.flow.span,
                    "a clock must be a Boolean or one value of an enum",
                )
                .help(match ty {
                    Ty::Enum(_) => format!("give the enum value: `A({})`", clock.flow.name),
                    _ => "define a Boolean flow first: `c = x > 0; y = e when c;`".to_owned(),
                });
            self.report(finding);
            return None;
        }
        Some(ClockOn { flow, value })
    }

    /// Resolves the flow of a clock.
    fn clock_flow(&mut self, name: &Ident) -> Option<FlowId> {
        match self.find_local(&name.name) {
            Some(Local::Flow(flow)) => {
                if self.inferring {
                    self.is_missing(flow, name.span);
                }
                Some(flow)
            }
            Some(_) => {
                let finding = not_a("a flow", &name.name, "a constant", name.span, name.span);
                self.report(finding);
                None
            }
            None => {
                if self.is_new_unknown(&name.name) {
                    let near = self.c.suggest(&name.name, self.local_names());
                    self.report(unknown("flow", &name.name, name.span, near));
                }
                None
            }
        }
    }

    /// Resolves a clock that is present for one value of an enum or Boolean.
    fn clock_value(&mut self, flow: FlowId, value: &Ident) -> Option<ClockOn> {
        let ty = self.unit.flow(flow).ty.clone();
        let value = self.case_value(&ty, value)?;
        Some(ClockOn { flow, value })
    }

    /// Returns the number of a Boolean or enum value.
    fn case_value(&mut self, ty: &Ty, value: &Ident) -> Option<u32> {
        let name = value.name.as_str();
        match ty {
            Ty::Bool if name == "true" => Some(1),
            Ty::Bool if name == "false" => Some(0),
            Ty::Enum(e) => self.enum_value(e, value),
            Ty::Unknown => None,
            _ => {
                let finding =
                    Finding::new(Code::RPI2006, format!("`{name}` is not a value of `{ty}`")).at(
                        value.span,
                        "a clock must be a Boolean or one value of an enum",
                    );
                self.report(finding);
                None
            }
        }
    }

    fn enum_value(&mut self, e: &Rc<EnumTy>, value: &Ident) -> Option<u32> {
        let last = value.name.rsplit("::").next().unwrap_or_default();
        let index = e.place_of(last);
        if index.is_none() {
            let near = rpi_diag::suggest(last, e.values.iter().map(|v| v.as_str()));
            let of = format!("the enum `{}`", e.name);
            let finding = super::report::no_member(&of, last, value.span, near);
            self.report(finding);
        }
        index
    }

    /// Checks `merge c (A -> x) (B -> y)`.
    pub(super) fn merge(&mut self, merge: &'a Merge, span: Span) -> ExprId {
        self.unit.has_clocks = true;
        let on = self.expr(&merge.on);
        let of = self.chosen_by(on);
        let mut cases: Vec<(u32, ExprId)> = Vec::new();
        let mut first: Map<u32, Span> = Map::default();
        let (mut ty, mut known) = (Ty::Unknown, true);
        for case in &merge.cases {
            let mut then = self.expr(&case.then);
            ty = self.case_type(ty, &cases, then);
            let value = self.case_value(&of, &case.value);
            known &= value.is_some();
            if let Some(value) = value {
                then = self.activated_by(on, value, then);
                match first.get(&value) {
                    Some(first) => self.report(case_twice(&case.value, *first)),
                    None => {
                        first.insert(value, self.span_of(then));
                        cases.push((value, then));
                    }
                }
            }
        }
        // Not reported beside an unknown case, which may be the missing one.
        if known {
            self.all_cases(&of, &cases, span);
        }
        let cases = cases.into();
        self.add(Kind::Merge { on, cases }, ty, span)
    }

    /// Returns the type of the condition of a `merge`; `Unknown` after the error about an unsuitable type.
    fn chosen_by(&mut self, on: ExprId) -> Ty {
        let ty = self.ty_of(on).clone();
        if matches!(ty, Ty::Bool | Ty::Enum(_) | Ty::Unknown) {
            return ty;
        }
        if let Kind::Flow(flow) = self.unit.expr(on).kind {
            self.no_clocks.tell(&flow, self.findings.len());
        }
        let message = format!("expected a Boolean or an enum in `merge`, found `{ty}`");
        let finding =
            Finding::new(Code::RPI2006, message).at(self.span_of(on), format!("this is `{ty}`"));
        self.report(finding.help("choose by a number with `if n = 0 then a else b`"));
        Ty::Unknown
    }

    /// Returns the common type of the cases up to this one.
    fn case_type(&mut self, so_far: Ty, cases: &[(u32, ExprId)], then: ExprId) -> Ty {
        let Some((_, first)) = cases.first() else {
            return self.ty_of(then).clone();
        };
        let common = self.common_type(*first, then, "all cases must have the same type");
        join(&so_far, &common).unwrap_or(so_far)
    }

    /// Reports missing cases of a `merge`.
    fn all_cases(&mut self, of: &Ty, cases: &[(u32, ExprId)], span: Span) {
        let names: Vec<&str> = match of {
            Ty::Bool => vec!["false", "true"],
            Ty::Enum(e) => e.values.iter().map(|v| v.as_str()).collect(),
            _ => return,
        };
        let there: Set<usize> = cases.iter().map(|(value, _)| *value as usize).collect();
        let is_there = |k: usize| there.contains(&k);
        let missing: Vec<&str> = names
            .iter()
            .enumerate()
            .filter(|(k, _)| !is_there(*k))
            .map(|(_, n)| *n)
            .collect();
        if !missing.is_empty() {
            let finding = Finding::new(
                Code::RPI2011,
                format!("non-exhaustive `merge`: {} not covered", listed(missing)),
            )
            .at(span, "a `merge` needs a case for every value");
            self.report(finding);
        }
    }

    /// Checks `current x`.
    pub(super) fn current_of(&mut self, operand: &'a ast::Expr, span: Span) -> ExprId {
        self.has_state(span);
        self.unit.has_clocks = true;
        let operand = self.expr(operand);
        let ty = self.ty_of(operand).clone();
        if let (Ty::Tuple(_), true) = (&ty, self.is_rpi()) {
            let finding = Finding::new(Code::RPI2006, format!("`current` cannot take `{ty}`"))
                .at(self.span_of(operand), "it takes one flow")
                .help("use `hold(x, 0)` for an initial value: the latest value of `x`, 0 before the first one");
            return self.fault_with(finding, span);
        }
        self.add(Kind::Current(operand), ty, span)
    }

    /// Checks `last x`. For a flow shared by states, it is the value of the previous cycle in whichever state that was.
    pub(super) fn last(&mut self, operand: &'a ast::Expr, span: Span) -> ExprId {
        self.has_state(span);
        if !is_name_or_field(operand) {
            let finding = Finding::new(Code::RPI2006, "`last` takes a flow or a field of one")
                .at(operand.span, "not a flow")
                .help("write `last` before each flow of the expression");
            return self.fault_with(finding, span);
        }
        self.past += 1;
        let operand = self.last_operand(operand);
        self.past -= 1;
        let ty = self.ty_of(operand).clone();
        self.add(Kind::Each(Each::Last, [operand].into()), ty, span)
    }

    /// Checks the operand of `last`. A flow of a state is replaced by the shared flow outside the automaton.
    fn last_operand(&mut self, operand: &'a ast::Expr) -> ExprId {
        if let ast::ExprKind::Field(field) = &operand.unparen().kind {
            let base = self.last_operand(&field.base);
            return self.member(base, &field.field);
        }
        let id = self.expr(operand);
        if let Kind::Flow(flow) = self.unit.expr(id).kind
            && let Some(outer) = self.defined_around(flow)
        {
            return self.flow_expr(outer, operand.span);
        }
        if !self.ty_of(id).is_unknown() {
            self.expect(id, &Ty::Unknown, &Wanted::Here);
        }
        id
    }

    /// Returns the outermost shared flow that a state's flow contributes to and that is defined in every state on the
    /// way; at least that of its own automaton. A state of an outer automaton that does not define the flow does not
    /// affect those that do.
    fn defined_around(&self, flow: FlowId) -> Option<FlowId> {
        let mut around = self.shared_around(flow);
        let first = around.next()?;
        let whole = around.take_while(|outer| !self.is_left_open(*outer));
        Some(whole.last().unwrap_or(first))
    }

    /// Whether an automaton has a state that leaves this flow absent.
    fn is_left_open(&self, flow: FlowId) -> bool {
        let block = self.unit.block(self.unit.flow(flow).block);
        let mut shared = block
            .automata
            .iter()
            .flat_map(|automaton| &automaton.shared);
        shared.any(|shared| shared.flow == flow && shared.is_left_open())
    }
}

/// Whether an expression reads a flow or a part of one.
fn is_name_or_field(operand: &ast::Expr) -> bool {
    match &operand.unparen().kind {
        ast::ExprKind::Field(field) => is_name_or_field(&field.base),
        ast::ExprKind::Index(index) => is_name_or_field(&index.base),
        ast::ExprKind::Name(_) => true,
        _ => false,
    }
}

/// Returns the diagnostic for a duplicate case.
pub(super) fn case_twice(name: &Ident, first: rpi_diag::Span) -> Finding {
    Finding::new(
        Code::RPI2011,
        format!("the case `{}` is given twice", name.name),
    )
    .at(name.span, "given again here")
    .also(first, "first given here")
}
