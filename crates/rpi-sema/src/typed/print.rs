//! Prints the typed program as text, for tests and debugging.

use crate::typed::TypedKind;
use crate::typed::{Block, BlockId, Equation, ExprId, FlowPresence, TargetPlace, Unit};
use std::fmt::Write;

/// Returns a unit as text for tests and debugging: its flows with their types, and its equations with every operator as
/// a primitive.
#[must_use]
pub fn format_unit(unit: &Unit) -> String {
    let mut out = format!("{:?} {}\n", unit.kind, unit.name).to_lowercase();
    for flow in &unit.flows {
        let mark = match flow.optional {
            FlowPresence::Declared(true) => "?",
            FlowPresence::Declared(false) => "",
            FlowPresence::Inferred => " (inferred)",
        };
        let _ = writeln!(out, "  {:?} {}: {}{mark}", flow.role, flow.name, flow.ty);
    }
    for (id, block) in (0..).map(BlockId).zip(&unit.blocks) {
        print_block(unit, id, block, &mut out);
    }
    out
}

fn print_block(unit: &Unit, id: BlockId, block: &Block, out: &mut String) {
    if id != BlockId::ROOT {
        let when = block.when.map(|when| format!(" when {}", expr(unit, when)));
        let _ = writeln!(out, "  block {}{}", block.name, when.unwrap_or_default());
    }
    for equation in &block.equations {
        let _ = writeln!(out, "    {}", print_equation(unit, equation));
    }
    for claim in &block.claims {
        let kind = format!("{:?}", claim.kind).to_lowercase();
        let mode = claim.mode.as_ref().map(|mode| format!(" of {mode}"));
        let mode = mode.unwrap_or_default();
        let _ = writeln!(out, "    {kind}{mode} {}", expr(unit, claim.condition));
    }
    for end in &block.ends {
        let kind = format!("{:?}", end.kind).to_lowercase();
        let _ = writeln!(
            out,
            "    {kind} {} when {}",
            end.result,
            expr(unit, end.condition)
        );
    }
}

fn print_equation(unit: &Unit, equation: &Equation) -> String {
    let target = |place: &TargetPlace| match place {
        TargetPlace::Flow { flow, at: 0 } => unit.flow(*flow).name.to_string(),
        TargetPlace::Flow { flow, at } => format!("{}@{at}", unit.flow(*flow).name),
        TargetPlace::Port { device, port } => format!("{}.port{port}", unit.flow(*device).name),
        TargetPlace::Nowhere => "_".to_owned(),
    };
    let targets: Vec<String> = equation.targets.iter().map(|t| target(&t.place)).collect();
    format!("{} = {}", targets.join(", "), expr(unit, equation.value))
}

/// Returns an expression as text in prefix form, such as `Core::IntAdd(x, 1)`.
fn expr(unit: &Unit, id: ExprId) -> String {
    let kind = &unit.expr(id).kind;
    let head = match kind {
        TypedKind::Error => "fault".to_owned(),
        TypedKind::Const(leaves) => format!("const{}", leaves.len()),
        TypedKind::Literal(leaf) => literal(leaf),
        TypedKind::None => "none".to_owned(),
        TypedKind::Arbitrary => "any".to_owned(),
        TypedKind::Flow(flow) => unit.flow(*flow).name.to_string(),
        TypedKind::Sensor { port, .. } => format!("sensor{port}"),
        TypedKind::Part { at, .. } => format!("part@{at}"),
        TypedKind::Slice { from, step, .. } => format!("slice{from}by{step}"),
        TypedKind::Select { .. } => "select".to_owned(),
        TypedKind::Build(_) => "build".to_owned(),
        TypedKind::Repeat(_) => "repeat".to_owned(),
        TypedKind::Replace { at, .. } => format!("replace@{at}"),
        TypedKind::Each(each, _) => format!("{each:?}").to_lowercase(),
        TypedKind::Equal { negated, .. } => if *negated { "differ" } else { "equal" }.to_owned(),
        TypedKind::Present(_) => "present".to_owned(),
        TypedKind::Prim(call) => call.prim.desc().name.to_owned(),
        TypedKind::Call(call) => format!("unit{}", call.unit.0),
        TypedKind::When { clock, .. } => {
            format!("when {}={}", unit.flow(clock.flow).name, clock.value)
        }
        TypedKind::Merge { .. } => "merge".to_owned(),
        TypedKind::Current(_) => "current".to_owned(),
    };
    let mut operands = Vec::new();
    kind.operands(&mut |operand| operands.push(expr(unit, operand)));
    match operands.is_empty() {
        true => head,
        false => format!("{head}({})", operands.join(", ")),
    }
}

fn literal(leaf: &crate::typed::Leaf) -> String {
    let as_real = leaf.as_real().map(|v| format!("{v:?}"));
    let as_int = || leaf.as_int().map(|v| v.to_string());
    let as_bool = || leaf.as_bool().map(|v| v.to_string());
    let as_text = || leaf.as_str().map(|v| format!("{v:?}"));
    let known = as_real.or_else(as_int).or_else(as_bool).or_else(as_text);
    known.unwrap_or_else(|| format!("{:x?}", leaf.slots()))
}
