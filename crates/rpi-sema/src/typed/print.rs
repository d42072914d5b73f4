//! Prints the typed program as text, for tests and debugging.

use crate::typed::Kind;
use crate::typed::{Block, BlockId, Equation, ExprId, Optional, Place, Unit};
use std::fmt::Write;

/// Formats a unit: its flows with types, and its equations with every operator as a primitive.
#[must_use]
pub fn print(unit: &Unit) -> String {
    let mut out = format!("{:?} {}\n", unit.kind, unit.name).to_lowercase();
    for flow in &unit.flows {
        let mark = match flow.optional {
            Optional::Declared(true) => "?",
            Optional::Declared(false) => "",
            Optional::Inferred => " (inferred)",
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
    let target = |place: &Place| match place {
        Place::Flow { flow, at: 0 } => unit.flow(*flow).name.to_string(),
        Place::Flow { flow, at } => format!("{}@{at}", unit.flow(*flow).name),
        Place::Port { device, port } => format!("{}.port{port}", unit.flow(*device).name),
        Place::Nowhere => "_".to_owned(),
    };
    let targets: Vec<String> = equation.targets.iter().map(|t| target(&t.place)).collect();
    format!("{} = {}", targets.join(", "), expr(unit, equation.value))
}

/// Formats an expression in prefix form.
fn expr(unit: &Unit, id: ExprId) -> String {
    let kind = &unit.expr(id).kind;
    let head = match kind {
        Kind::Fault => "fault".to_owned(),
        Kind::Const(leaves) => format!("const{}", leaves.len()),
        Kind::Literal(leaf) => literal(leaf),
        Kind::None => "none".to_owned(),
        Kind::Outside => "any".to_owned(),
        Kind::Flow(flow) => unit.flow(*flow).name.to_string(),
        Kind::Sensor { port, .. } => format!("sensor{port}"),
        Kind::Part { at, .. } => format!("part@{at}"),
        Kind::Slice { from, step, .. } => format!("slice{from}by{step}"),
        Kind::Select { .. } => "select".to_owned(),
        Kind::Build(_) => "build".to_owned(),
        Kind::Repeat(_) => "repeat".to_owned(),
        Kind::Replace { at, .. } => format!("replace@{at}"),
        Kind::Each(each, _) => format!("{each:?}").to_lowercase(),
        Kind::Equal { negated, .. } => if *negated { "differ" } else { "equal" }.to_owned(),
        Kind::Present(_) => "present".to_owned(),
        Kind::Prim(call) => call.prim.desc().name.to_owned(),
        Kind::Call(call) => format!("unit{}", call.unit.0),
        Kind::When { clock, .. } => format!("when {}={}", unit.flow(clock.flow).name, clock.value),
        Kind::Merge { .. } => "merge".to_owned(),
        Kind::Current(_) => "current".to_owned(),
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
    known.unwrap_or_else(|| format!("{:x?}", leaf.cells()))
}
