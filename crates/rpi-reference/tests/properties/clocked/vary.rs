//! Equivalent variants of a program (M4): reordered equations, changed declarations, named or inlined values and
//! results, bundled flows, a state around the body, or a call around it.

use std::collections::BTreeMap;

use super::enclose;
use super::exprs::Requirement;
use super::forms::form;
use super::model::{
    Body, Bound, Declared, Equation, Expr, Flow, FlowId, Kind, Model, Node, Statement, Unit,
};
use crate::random::Random;

/// Transformation of a program; returns false if it is not applicable.
type Transformation = fn(&mut Model, &mut Random) -> bool;

/// All transformations, by name.
pub(crate) const TRANSFORMATIONS: &[(&str, Transformation)] = &[
    ("shuffled", shuffled),
    ("declared", declared),
    ("named", named),
    ("inlined", inlined),
    ("bundled", bundled),
    ("results", results),
    ("in a state", enclose::in_a_state),
    ("behind a call", enclose::behind_a_call),
];

fn shuffle<T>(items: &mut [T], random: &mut Random) {
    for k in (1..items.len()).rev() {
        items.swap(k, random.below(k + 1));
    }
}

fn shuffled(model: &mut Model, random: &mut Random) -> bool {
    for unit in &mut model.units {
        unit.body.each_body(&mut |body| {
            shuffle(&mut body.statements, random);
            shuffle(&mut body.locals, random);
        });
    }
    true
}

/// Changes declarations: `T?` added or removed, types and clocks stated or omitted.
fn declared(model: &mut Model, random: &mut Random) -> bool {
    let mut changed = false;
    for flow in model.flows.iter_mut().filter(|flow| flow.is_free) {
        let before = flow.declared;
        flow.declared = match random.below(3) {
            0 => Declared::Not,
            1 if flow.optional => Declared::Optional,
            _ => Declared::Exact,
        };
        changed |= flow.declared != before;
    }
    changed
}

/// Calls `change` with random bodies of the program until one is changed, and all flows.
fn in_some_body(
    model: &mut Model,
    random: &mut Random,
    change: &mut impl FnMut(&mut Body, &mut Vec<Flow>, &mut Random) -> bool,
) -> bool {
    let mut count = 0;
    model
        .units
        .iter_mut()
        .for_each(|unit| unit.body.each_body(&mut |_| count += 1));
    let (first, mut done) = (random.below(count), false);
    // Start with a random body and continue until one can be changed.
    for wanted in (first..count).chain(0..first) {
        let mut k = 0;
        for unit in &mut model.units {
            unit.body.each_body(&mut |body| {
                done = done || k == wanted && change(body, &mut model.flows, random);
                k += 1;
            });
        }
    }
    done
}

/// Names a part of an equation.
fn named(model: &mut Model, random: &mut Random) -> bool {
    let lustre = model.lustre;
    in_some_body(model, random, &mut |body, flows, random| {
        let mut places = Vec::new();
        for (k, statement) in body.statements.iter_mut().enumerate() {
            let Statement::Equation(equation) = statement else {
                continue;
            };
            let mut part = 0;
            equation.value.each_mut(&mut |expr| {
                let has_name =
                    |clock: &super::model::Clock| clock.iter().all(|on| !on.starts_with('?'));
                let has_kind = expr
                    .clock
                    .as_ref()
                    .is_some_and(|clock| !lustre || has_name(clock));
                // A call with several results is not a value on its own.
                let is_value = matches!(&expr.node, Node::Template(text, _) if !text.starts_with("Sub") || text.contains(")."));
                if has_kind && is_value {
                    places.push((k, part));
                }
                part += 1;
            });
        }
        if places.is_empty() {
            return false;
        }
        let (k, wanted) = *random.pick(&places);
        let made = take(&mut body.statements[k], wanted, flows, random, lustre);
        body.locals.push(made.targets[0]);
        body.statements.insert(k, Statement::Equation(made));
        true
    })
}

/// Moves a part of an equation to a new flow.
fn take(
    statement: &mut Statement,
    wanted: usize,
    flows: &mut Vec<Flow>,
    random: &mut Random,
    lustre: bool,
) -> Equation {
    let (mut part, mut taken) = (0, Vec::new());
    let id = flows.len();
    statement.own_exprs_mut(&mut |whole| {
        whole.each_mut(&mut |expr| {
            if part == wanted {
                let node = Node::Flow(id);
                taken.push(Expr {
                    node,
                    ..expr.clone()
                });
                std::mem::swap(expr, &mut taken[0]);
            }
            part += 1;
        });
    });
    let value = taken.remove(0);
    let clock = value.clock.clone().unwrap_or_else(|| [].into());
    let has_name = clock.iter().all(|on| !on.starts_with('?'));
    let is_said = lustre || has_name && random.one_in(2);
    flows.push(Flow {
        name: format!("n{id}"),
        kind: value.kind,
        clock,
        optional: value.optional,
        declared: if is_said {
            Declared::Exact
        } else {
            Declared::Not
        },
        is_free: false,
        is_fixed: false,
    });
    Equation {
        targets: vec![id],
        value,
        bound: Bound::Names,
    }
}

/// Replaces all reads of a flow by its definition.
fn inlined(model: &mut Model, random: &mut Random) -> bool {
    let read_in = reads(model);
    let callees: Vec<Unit> = model.units.clone();
    in_some_body(model, random, &mut |body, flows, random| {
        let mut fit: Vec<usize> = Vec::new();
        for (k, statement) in body.statements.iter().enumerate() {
            if let Statement::Equation(equation) = statement {
                let own = reads_itself(equation);
                let only_here = |flow: &FlowId| {
                    let here = body_reads(body, *flow);
                    !flows[*flow].is_fixed
                        && here == read_in.get(flow).copied().unwrap_or(0)
                        && here < 4
                };
                let clock = &flows[equation.targets[0]].clock;
                let is_call = is_call(equation);
                let has_clock = is_call || equation.value.is_anchored(clock);
                let small = equation.value.size() < 12;
                if !own
                    && has_clock
                    && small
                    && equation.targets.iter().all(only_here)
                    && has_names(equation, flows)
                {
                    fit.push(k);
                }
            }
        }
        if fit.is_empty() {
            return false;
        }
        let Statement::Equation(equation) = body.statements.remove(*random.pick(&fit)) else {
            return false;
        };
        for (place, target) in equation.targets.iter().enumerate() {
            let value = part_of(&equation, place, &callees, flows);
            body.locals.retain(|local| local != target);
            replace(body, *target, &value);
        }
        true
    })
}

fn is_call(equation: &Equation) -> bool {
    matches!(&equation.value.node, Node::Template(text, _) if text.starts_with("Sub"))
}

/// Returns whether all clocks of the flows defined by an equation have names. A clock without a name is a different one
/// at each location.
fn has_names(equation: &Equation, flows: &[Flow]) -> bool {
    let clocks = equation
        .targets
        .iter()
        .flat_map(|flow| flows[*flow].clock.iter());
    equation.targets.len() == 1
        || is_call(equation) && clocks.clone().all(|on| !on.starts_with('?'))
}

fn reads_itself(equation: &Equation) -> bool {
    let mut own = false;
    equation
        .value
        .flows(&mut |flow| own |= equation.targets.contains(&flow));
    own
}

/// Returns the value of one of the flows defined by an equation.
fn part_of(equation: &Equation, place: usize, callees: &[Unit], flows: &[Flow]) -> Expr {
    if equation.targets.len() == 1 {
        return equation.value.clone();
    }
    let target = &flows[equation.targets[place]];
    let want = Requirement {
        kind: target.kind,
        clock: target.clock.clone(),
        optional: target.optional,
    };
    let Node::Template(text, args) = &equation.value.node else {
        return equation.value.clone();
    };
    let callee = callees
        .iter()
        .find(|unit| text.starts_with(&format!("{}(", unit.name)));
    let output = callee.map_or("", |unit| flows[unit.outputs[place]].name.as_str());
    form(
        &format!("{text}.{output}"),
        args.clone(),
        &want,
        Some(target.clock.clone()),
    )
}

/// Returns the number of reads of each flow in all bodies.
fn reads(model: &mut Model) -> BTreeMap<FlowId, usize> {
    let mut read: BTreeMap<FlowId, usize> = BTreeMap::new();
    for unit in &mut model.units {
        unit.body
            .each_expr(&mut |expr| expr.flows(&mut |flow| *read.entry(flow).or_default() += 1));
    }
    read
}

/// Returns the number of reads of a flow by equations directly in a body.
fn body_reads(body: &Body, wanted: FlowId) -> usize {
    let mut count = 0;
    for statement in &body.statements {
        if let Statement::Equation(equation) = statement {
            equation
                .value
                .flows(&mut |flow| count += usize::from(flow == wanted));
        }
    }
    count
}

fn replace(body: &mut Body, target: FlowId, value: &Expr) {
    for statement in &mut body.statements {
        if let Statement::Equation(equation) = statement {
            equation.value.each_mut(&mut |expr| {
                if matches!(expr.node, Node::Flow(flow) if flow == target) {
                    *expr = value.clone();
                }
            });
        }
    }
}

/// Defines two flows as members of one, or by one equation.
fn bundled(model: &mut Model, random: &mut Random) -> bool {
    let lustre = model.lustre;
    in_some_body(model, random, &mut |body, flows, random| {
        let mut fit = Vec::new();
        for (k, statement) in body.statements.iter().enumerate() {
            if let Statement::Equation(equation) = statement {
                let target = &flows[equation.targets[0]];
                if equation.targets.len() == 1
                    && !target.is_fixed
                    && target.kind == Kind::Int
                    && !reads_itself(equation)
                {
                    fit.push(k);
                }
            }
        }
        if fit.len() < 2 {
            return false;
        }
        shuffle(&mut fit, random);
        let (first, second) = (fit[0].min(fit[1]), fit[0].max(fit[1]));
        let (b, a) = (
            body.statements.remove(second),
            body.statements.remove(first),
        );
        let (Statement::Equation(a), Statement::Equation(b)) = (a, b) else {
            return false;
        };
        let targets = vec![a.targets[0], b.targets[0]];
        let whole = format!("q{}", targets[0]);
        let want = Requirement {
            kind: Kind::Pair,
            clock: [].into(),
            optional: false,
        };
        let in_one = !lustre && random.one_in(2);
        let (text, bound) = match in_one {
            true => ("Pair{u = @; v = @}", Bound::Whole(whole.clone())),
            false => ("(@, @)", Bound::Names),
        };
        let value = form(text, vec![a.value, b.value], &want, None);
        if in_one {
            for (flow, part) in targets.iter().zip(["u", "v"]) {
                body.locals.retain(|local| local != flow);
                flows[*flow].name = format!("{whole}.{part}");
                flows[*flow].is_free = false;
            }
        }
        targets.iter().for_each(|flow| flows[*flow].is_fixed = true);
        body.statements.push(Statement::Equation(Equation {
            targets,
            value,
            bound,
        }));
        true
    })
}

/// Changes the results of calls between separate names and members of one name.
fn results(model: &mut Model, _: &mut Random) -> bool {
    let mut changed = false;
    if model.lustre {
        return false;
    }
    let flows = &mut model.flows;
    let mut change = |statement: &mut Statement| {
        let Statement::Equation(equation) = statement else {
            return;
        };
        if !is_call(equation) {
            return;
        }
        let (from, to) = match equation.bound {
            Bound::Names => ('_', '.'),
            Bound::Whole(_) => ('.', '_'),
        };
        let mut whole = String::new();
        for flow in &equation.targets {
            let name = &mut flows[*flow].name;
            if let Some((first, part)) = name.clone().split_once(from) {
                whole = first.to_owned();
                *name = format!("{first}{to}{part}");
            }
        }
        equation.bound = match equation.bound {
            Bound::Names => Bound::Whole(whole),
            Bound::Whole(_) => Bound::Names,
        };
        changed = true;
    };
    for unit in &mut model.units {
        unit.body
            .each_body(&mut |body| body.statements.iter_mut().for_each(&mut change));
    }
    changed
}
