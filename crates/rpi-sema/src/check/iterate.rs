//! Iterators over arrays. They are expanded to one call per element.

use super::access::leaves;
use super::args::Given;
use super::body::Body;
use super::callable::Callable;
use super::report::Wanted;
use crate::program::Program;
use crate::ty::{Member, Ty};
use crate::typed::{Activation, ExprId, Kind, Leaf};
use rpi_diag::{Code, Finding, Span};
use rpi_net::prim;
use rpi_syntax::ast::{StaticArg, StaticValue};
use rpi_syntax::ops::BinaryOp;
use std::rc::Rc;

/// Names of the iterators.
pub(super) const NAMES: &[&str] = &[
    "map", "red", "fold", "fill", "fillred", "mapfold", "boolred", "condact",
];

/// Kind of an iterator.
#[derive(Clone, Copy, PartialEq, Debug)]
enum Way {
    /// Applies the callee to each element.
    Map,
    /// Passes an accumulator through the calls; each call may also read an element and produce an element.
    Fill,
    /// Tests whether the number of true elements is in a range, given by its two bounds.
    Count(i64, i64),
}

/// Iterator with its static arguments.
#[derive(Clone, Debug)]
pub(super) struct Iteration {
    name: &'static str,
    way: Way,
    callee: Option<Callable>,
    size: u32,
}

impl Iteration {
    /// Returns the name for messages: `map<<f; 3>>`.
    pub(super) fn name(&self, program: &Program<'_>) -> String {
        let size = self.size;
        match (&self.callee, self.way) {
            (Some(callee), _) => format!("{}<<{}; {size}>>", self.name, callee.name(program)),
            (None, Way::Count(least, most)) => format!("{}<<{least}; {most}; {size}>>", self.name),
            (None, _) => format!("{}<<{size}>>", self.name),
        }
    }

    /// Appends the text that distinguishes this iterator from others in keys of instances.
    pub(super) fn write_key(&self, key: &mut String) {
        key.push_str(self.name);
        key.push_str("<<");
        if let Some(callee) = &self.callee {
            callee.write_key(key);
        }
        key.push_str(&format!("; {}; {:?}>>", self.size, self.way));
    }

    /// Returns the callable that is applied to each element.
    pub(super) fn callee(&self) -> Option<&Callable> {
        self.callee.as_ref()
    }

    /// Returns the type of the port at this place, from that of the callee's port at the same place.
    pub(super) fn port_type(&self, place: usize, of_callee: &Ty) -> Ty {
        match self.way {
            Way::Fill if place == 0 => of_callee.clone(),
            _ => Ty::Array(Rc::new(of_callee.clone()), self.size),
        }
    }
}

impl<'a> Body<'_, 'a> {
    /// Checks an iterator with its static arguments.
    pub(super) fn iteration(
        &mut self,
        name: &'static str,
        statics: &'a [StaticArg],
        span: Span,
    ) -> Option<Iteration> {
        match (name, statics) {
            ("boolred", [least, most, size]) => {
                let bounds = (self.static_int(least)?, self.static_int(most)?);
                let n = self.static_size(size)?;
                self.can_count(bounds, n, [least, most])?;
                Some(Iteration {
                    name,
                    way: Way::Count(bounds.0, bounds.1),
                    callee: None,
                    size: n,
                })
            }
            ("map" | "red" | "fold" | "fill" | "fillred" | "mapfold", [callee, size]) => {
                let way = if name == "map" { Way::Map } else { Way::Fill };
                Some(Iteration {
                    name,
                    way,
                    callee: Some(self.static_callee(callee)?),
                    size: self.static_size(size)?,
                })
            }
            _ => {
                let form = match name {
                    "boolred" => "boolred<<least; most; size>>(array)".to_owned(),
                    _ => format!("{name}<<node; size>>(...)"),
                };
                let finding = Finding::new(
                    Code::RPI1010,
                    format!("wrong number of static arguments of `{name}`"),
                )
                .at(span, "wrong number of arguments")
                .help(format!("write `{form}`"));
                self.report(finding);
                None
            }
        }
    }

    /// Checks the bounds of `boolred`, as Lustre V6 does; `None` after an error.
    fn can_count(
        &mut self,
        (least, most): (i64, i64),
        n: u32,
        args: [&StaticArg; 2],
    ) -> Option<()> {
        let (arg, text) = match (least, most) {
            _ if least < 0 => (args[0], format!("{least} is less than 0")),
            _ if most > n.into() => (args[1], format!("{most} is greater than the size {n}")),
            _ if least > most => (args[0], format!("{least} is greater than {most}")),
            _ => return Some(()),
        };
        let message = "`boolred<<least; most; size>>` requires 0 <= least <= most <= size";
        self.report(Finding::new(Code::RPI2009, message).at(arg.span, text));
        None
    }

    fn static_int(&mut self, arg: &'a StaticArg) -> Option<i64> {
        match &arg.value {
            StaticValue::Expr(expr) => self.integer(expr),
            _ => {
                let finding = Finding::new(Code::RPI1010, "an integer is expected here")
                    .at(arg.span, "not an integer");
                self.report(finding);
                None
            }
        }
    }

    fn static_size(&mut self, arg: &'a StaticArg) -> Option<u32> {
        match &arg.value {
            StaticValue::Expr(expr) => self.size(expr),
            _ => self.static_int(arg).and_then(|n| u32::try_from(n).ok()),
        }
    }

    /// Applies an iterator to checked arguments.
    pub(super) fn iterate(
        &mut self,
        iteration: &Iteration,
        given: &[Given<'a>],
        span: Span,
    ) -> ExprId {
        let given = self.spread_tuples(given.to_vec());
        let values: Vec<ExprId> = given.iter().map(|arg| arg.value).collect();
        match (iteration.way, &iteration.callee) {
            (Way::Map, Some(callee)) => self.map(callee, &values, iteration.size, span),
            (Way::Fill, Some(callee)) => self.fill_array(callee, &values, iteration.size, span),
            (Way::Count(least, most), _) => self.count(least, most, &values, iteration.size, span),
            _ => self.fault(span),
        }
    }

    /// Returns element `k` of each array; reports arrays whose size is not `n`.
    fn elements(&mut self, arrays: &[ExprId], k: u32, n: u32) -> Option<Vec<ExprId>> {
        let place = arrays
            .first()
            .map_or(Span::NONE, |array| self.span_of(*array));
        if !self.may_go_on(place) {
            return None;
        }
        let mut elements = Vec::with_capacity(arrays.len());
        for array in arrays {
            let span = self.span_of(*array);
            match self.ty_of(*array).clone() {
                Ty::Array(element, m) if m == n => {
                    let at = k * leaves(&element);
                    elements.push(self.add(
                        Kind::Part { base: *array, at },
                        (*element).clone(),
                        span,
                    ));
                }
                Ty::Unknown => return None,
                ty => {
                    let finding = Finding::new(
                        Code::RPI2009,
                        format!(
                            "expected an array of {}, found `{ty}`",
                            rpi_diag::counted(n, "element")
                        ),
                    )
                    .at(span, format!("this is `{ty}`"));
                    self.report(finding);
                    return None;
                }
            }
        }
        Some(elements)
    }

    /// Calls the callee for one element and returns its outputs.
    fn call_element(&mut self, callee: &Callable, args: Vec<ExprId>, span: Span) -> Vec<ExprId> {
        let given = args.into_iter().map(Given::plain).collect();
        let result = self.apply(callee, given, Activation::Always, span);
        match self.ty_of(result) {
            Ty::Tuple(_) => self.parts_of(result),
            _ => vec![result],
        }
    }

    /// Checks `map`.
    fn map(&mut self, callee: &Callable, arrays: &[ExprId], n: u32, span: Span) -> ExprId {
        let mut columns: Vec<Vec<ExprId>> = Vec::new();
        for k in 0..n {
            let Some(elements) = self.elements(arrays, k, n) else {
                return self.fault(span);
            };
            let results = self.call_element(callee, elements, span);
            push_row(&mut columns, &results);
        }
        let arrays: Vec<ExprId> = columns.into_iter().map(|c| self.column(&c, span)).collect();
        self.one_or_tuple(arrays, span)
    }

    /// Checks `fill`, `red` (`fold`) and `fillred` (`mapfold`). They differ only in the ports of the callee.
    fn fill_array(&mut self, callee: &Callable, values: &[ExprId], n: u32, span: Span) -> ExprId {
        let Some((first, arrays)) = values.split_first() else {
            let finding = Finding::new(Code::RPI1010, "missing initial value of the accumulator")
                .at(span, "expected an argument");
            return self.fault_with(finding, span);
        };
        let mut accumulator = *first;
        let mut columns: Vec<Vec<ExprId>> = Vec::new();
        for k in 0..n {
            let Some(elements) = self.elements(arrays, k, n) else {
                return self.fault(span);
            };
            let args = std::iter::once(accumulator).chain(elements).collect();
            let results = self.call_element(callee, args, span);
            let Some((next, rest)) = results.split_first() else {
                return self.fault(span);
            };
            accumulator = *next;
            push_row(&mut columns, rest);
        }
        let columns: Vec<ExprId> = columns.into_iter().map(|c| self.column(&c, span)).collect();
        self.one_or_tuple(std::iter::once(accumulator).chain(columns).collect(), span)
    }

    /// Adds an array of the values of one output for all elements.
    fn column(&mut self, elements: &[ExprId], span: Span) -> ExprId {
        let n = u32::try_from(elements.len()).unwrap_or(u32::MAX);
        let element = elements
            .first()
            .map_or(Ty::Unknown, |id| self.ty_of(*id).clone());
        self.add_array(Kind::Build(elements.into()), Rc::new(element), n, span)
    }

    /// Returns the only value, or a tuple of several.
    fn one_or_tuple(&mut self, values: Vec<ExprId>, span: Span) -> ExprId {
        if let [one] = values[..] {
            return one;
        }
        let member = |ty| Member { name: None, ty };
        let members = values
            .iter()
            .map(|id| member(self.ty_of(*id).clone()))
            .collect();
        self.add(Kind::Build(values.into()), Ty::Tuple(members), span)
    }

    /// Checks `boolred<<least; most; n>>(a)`: whether the number of true elements is between the bounds.
    fn count(&mut self, least: i64, most: i64, values: &[ExprId], n: u32, span: Span) -> ExprId {
        let [array] = values else {
            let finding = Finding::new(Code::RPI1010, "`boolred` takes one array")
                .at(span, "wrong number of arguments");
            return self.fault_with(finding, span);
        };
        let mut total = self.add(Kind::Literal(Leaf::int(0)), Ty::Int, span);
        for k in 0..n {
            let Some(element) = self.elements(&[*array], k, n) else {
                return self.fault(span);
            };
            self.expect(element[0], &Ty::Bool, &Wanted::Here);
            total = self.one_more_if(element[0], total, span);
        }
        let bounds = [(BinaryOp::Ge, least), (BinaryOp::Le, most)];
        let [at_least, at_most] = bounds.map(|(op, bound)| {
            let bound = self.add(Kind::Literal(Leaf::int(bound)), Ty::Int, span);
            self.binary_prim(op, total, bound, span)
        });
        self.logic(prim!("Core::BooleanAnd"), &[at_least, at_most], span)
    }

    /// Adds the sum of `total` and 1 if the condition holds, else `total`.
    fn one_more_if(&mut self, condition: ExprId, total: ExprId, span: Span) -> ExprId {
        let [one, zero] = [1, 0].map(|v| self.add(Kind::Literal(Leaf::int(v)), Ty::Int, span));
        let more = Kind::Each(crate::typed::Each::If, [condition, one, zero].into());
        let more = self.add(more, Ty::Int, span);
        self.binary_prim(BinaryOp::Add, total, more, span)
    }
}

/// Appends the outputs of one call to the columns.
fn push_row(columns: &mut Vec<Vec<ExprId>>, row: &[ExprId]) {
    columns.resize_with(columns.len().max(row.len()), Vec::new);
    for (column, value) in columns.iter_mut().zip(row) {
        column.push(*value);
    }
}
