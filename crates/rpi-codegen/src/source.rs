//! Text of the C source: constants, functions and the cycle.

use crate::Emitted;
use crate::c_type::CType;
use crate::header::{CYCLE, counts_cycles, declarations};
use crate::identifiers::{mentions, variables_in};
use crate::initial::{init_function, resets};
use crate::literals::literal;
use crate::locals::localise;
use crate::order::order;
use crate::parts::{Node, Parts, print};
use crate::ports::{Direction, Meaning};
use crate::statements::{Emitter, declarator, escaped, zero};
use crate::support::needed;
use crate::variables::{Storage, Variable};
use rpi_image::CommandFlow;
use rpi_image::image::{CommandEnd, CommandEndKind, Signal, TRUE};
use std::collections::BTreeSet;

/// Returns the texts of an image.
pub(crate) fn write(mut emitter: Emitter<'_>) -> Emitted {
    let name = emitter.options.name.to_owned();
    let mut nodes = flows(&emitter);
    nodes.extend(emitter.units(&order(emitter.image, emitter.slots), &outputs));
    let mut parts = Parts {
        functions: Vec::new(),
    };
    if emitter.variables.has_struct {
        let call = |k: usize| format!("{name}_part_{k}(cx, s, in, out, v);");
        nodes = parts.split(nodes, &call);
    }
    let mut body = resets(&emitter);
    let step = step_function(&emitter, &nodes);
    let mut bodies: Vec<String> = parts.functions.iter().map(|nodes| text_of(nodes)).collect();
    let variables: Vec<&Variable> = emitter.variables.in_storage(Storage::Cycle).collect();
    let locals = localise(&mut bodies, &step, &variables);
    body += &part_functions(&name, &bodies);
    body += &step;
    let body = init_function(&emitter) + &body + &self_test(&name);
    let functions: String = emitter
        .functions
        .values()
        .map(|f| format!("{}\n", f.text))
        .collect();
    let tables = constants(&emitter) + &places(&emitter) + &value_struct(&emitter, &locals);
    let support = needed(&format!("{functions}{body}{tables}"));
    let parameters = parameters(&emitter, &format!("{support}{functions}"));
    let head = comment(&emitter);
    let declarations = declarations(&emitter);
    let guard = format!("{}_H", name.to_uppercase());
    let header = format!("{head}#ifndef {guard}\n#define {guard}\n{declarations}#endif\n");
    let (header, own) = match emitter.options.header {
        Some(file) => (header, format!("{head}#include \"{file}\"\n{INCLUDES}")),
        None => (String::new(), format!("{head}{INCLUDES}{declarations}")),
    };
    let prelude = include_str!("prelude.c");
    let source = format!("{own}{prelude}{parameters}{support}{functions}{tables}{body}");
    let source = with_discarded_results(&source);
    Emitted {
        header,
        source,
        interface: emitter.interface.clone(),
    }
}

/// Headers of the C library that the text uses, before everything else.
const INCLUDES: &str = "#include <float.h>\n#include <string.h>\n";

/// Marks the unused results of `memcpy` and `memset` as such (MISRA C:2012, rule 17.7).
fn with_discarded_results(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    for line in text.lines() {
        let statement = line.trim_start();
        if ["memcpy(", "memset("]
            .iter()
            .any(|call| statement.starts_with(call))
        {
            out.push_str(&line[..line.len() - statement.len()]);
            out.push_str("(void)");
            out.push_str(statement);
        } else {
            out.push_str(line);
        }
        out.push('\n');
    }
    out
}

fn comment(emitter: &Emitter<'_>) -> String {
    let (image, origin) = (emitter.image, emitter.options.origin.replace("*/", "* /"));
    format!(
        "/* {}: one cycle every {} ns, at most {} elementary operations.\n   {origin} */\n",
        image.name.replace("*/", "* /"),
        image.period_ns,
        emitter.work,
    )
}

/// Returns the constants of the program that its functions use.
fn parameters(emitter: &Emitter<'_>, text: &str) -> String {
    let (dt, tick) = (
        emitter.image.period_ns as f64 / 1e9,
        emitter.image.tick_ns as f64,
    );
    let mut out = String::new();
    if mentions(text, "rpi_dt") {
        out += &format!("/* Period in s. */\nstatic const double rpi_dt = {dt:?};\n");
    }
    if mentions(text, "rpi_tick_ns") {
        out += &format!(
            "/* Length of a tick in ns. */\nstatic const double rpi_tick_ns = {tick:?};\n"
        );
    }
    out
}

/// Returns the statements that compute the flows that depend only on the number of the cycle.
fn flows(emitter: &Emitter<'_>) -> Vec<Node> {
    let image = emitter.image;
    let ticks = image.period_ns / image.tick_ns.max(1);
    let elapsed = format!("rpi_elapsed(s->{CYCLE}, UINT64_C({}))", ticks.max(1));
    let mut lines = Vec::new();
    for flow in &image.flows {
        let (ty, text) = match flow.kind {
            CommandFlow::Time => (CType::Real, format!("rpi_seconds({elapsed})")),
            CommandFlow::Elapsed => (CType::Int, elapsed.clone()),
            CommandFlow::Period => (CType::Real, format!("{:?}", image.period_ns as f64 / 1e9)),
            CommandFlow::PeriodTicks => (CType::Int, format!("INT64_C({ticks})")),
            _ => continue,
        };
        lines.push(Node::Line(emitter.assignment(flow.value.start, ty, &text)));
    }
    lines
}

/// Returns the assignments of the output struct, except the set-points.
fn outputs(emitter: &mut Emitter<'_>) -> Vec<String> {
    let mut lines = Vec::new();
    let image = emitter.image;
    for (k, export) in (0..).zip(&image.exports) {
        let field = |meaning| {
            emitter
                .interface
                .name(Direction::Output, meaning)
                .map(str::to_owned)
        };
        let (value, present) = (field(Meaning::Export(k)), field(Meaning::ExportPresence(k)));
        let ty = CType::of_type(export.value.ty);
        let name = value.unwrap_or_default();
        if let Some(present) = present {
            let text = emitter
                .variables
                .value(emitter.slots, export.value.present, CType::Bool);
            lines.push(format!("out->{present} = {text};"));
        }
        match export.value.ty.slots() {
            1 => {
                let text = emitter
                    .variables
                    .value(emitter.slots, export.value.start, ty);
                lines.push(format!("out->{name} = {text};"));
            }
            n => {
                let source = emitter.array(export.value.start, n, ty);
                lines.push(format!(
                    "memcpy(out->{name}, {source}, sizeof out->{name});"
                ));
            }
        }
    }
    lines.extend(end(emitter));
    lines
}

/// Returns the statements that determine whether the command ends.
fn end(emitter: &Emitter<'_>) -> Vec<String> {
    let (variables, slots) = (emitter.variables, emitter.slots);
    let is_true = |signal: &Signal| {
        let value = variables.value(slots, signal.start, CType::Bool);
        match signal.present {
            TRUE => value,
            present => format!(
                "{} && {value}",
                variables.value(slots, present, CType::Bool)
            ),
        }
    };
    match &emitter.image.end {
        CommandEnd::Results(results) if results.is_empty() => Vec::new(),
        CommandEnd::Results(results) => {
            let mut lines = vec!["out->result = 0;".to_owned()];
            // A failure takes precedence, then the first result: the last assignment counts.
            let numbered = results.iter().enumerate().rev();
            let (failures, others): (Vec<_>, Vec<_>) =
                numbered.partition(|(_, r)| r.kind == CommandEndKind::Fail);
            for (k, result) in others.into_iter().chain(failures) {
                let condition = is_true(&result.condition);
                let condition = match result.kind {
                    CommandEndKind::Yield => format!("in->has_successor && {condition}"),
                    _ => condition,
                };
                lines.push(format!(
                    "if ({condition}) {{\n  out->result = {};\n}}",
                    k + 1
                ));
            }
            lines
        }
        CommandEnd::Ports { terminate, fail } => {
            let terminate = terminate.as_ref().map(is_true);
            let terminate = terminate.map(|ends| format!("out->terminated = {ends};"));
            let fail = fail.as_ref().map(|fail| {
                let value = variables.value(slots, fail.start, CType::Int);
                let number = match fail.present {
                    TRUE => value,
                    present => {
                        let present = variables.value(slots, present, CType::Bool);
                        format!("{present} ? {value} : 0")
                    }
                };
                format!("out->error_number = {number};")
            });
            terminate.into_iter().chain(fail).collect()
        }
    }
}

fn constants(emitter: &Emitter<'_>) -> String {
    let mut out = String::new();
    for ((start, len, ty), name) in &emitter.constants {
        let bits = (*start..start + len).map(|slot| emitter.slots.initial(slot));
        let values: Vec<String> = bits.map(|bits| static_literal(bits, *ty)).collect();
        out += &format!(
            "static const {} {name}[{len}] = {{{}}};\n",
            ty.name(),
            values.join(", ")
        );
    }
    out
}

/// Returns a constant for a static array, in which C allows no function calls.
fn static_literal(bits: u64, ty: CType) -> String {
    match (ty, f64::from_bits(bits)) {
        (CType::Real, value) if value.is_nan() => "(double)(0.0F / 0.0F)".to_owned(),
        (CType::Real, value) if value.is_infinite() && value > 0.0 => "(DBL_MAX * 2.0)".to_owned(),
        (CType::Real, value) if value.is_infinite() => "(-DBL_MAX * 2.0)".to_owned(),
        _ => literal(bits, ty),
    }
}

fn places(emitter: &Emitter<'_>) -> String {
    if emitter.places.is_empty() {
        return String::new();
    }
    let mut rows = Vec::new();
    for place in &emitter.places {
        let location = emitter.image.debug.locations.get(*place as usize);
        let source = location.and_then(|l| (emitter.options.locate)(l));
        let flow = location.map_or("", |l| l.flow.as_deref().unwrap_or(&l.path));
        let (file, line, column) =
            source.map_or((String::new(), 0, 0), |s| (s.file, s.line, s.column));
        rows.push(format!(
            "  {{0, {line}U, {column}U, \"{}\", \"{}\"}}",
            escaped(&file),
            escaped(flow)
        ));
    }
    format!(
        "/* Places of the operations that may fault. */\nstatic const rpi_fault_report rpi_places[{}] = {{\n{}\n}};\n\n",
        rows.len(),
        rows.join(",\n")
    )
}

/// Returns the struct of the values of a cycle, if they are no local variables.
fn value_struct(emitter: &Emitter<'_>, locals: &BTreeSet<String>) -> String {
    if !emitter.variables.has_struct {
        return String::new();
    }
    let variables = emitter.variables.in_storage(Storage::Cycle);
    let variables = variables.filter(|v| !locals.contains(&v.name));
    let fields = variables.map(|v| format!("  {};\n", declarator(v.ty, &v.name, v.slots.len)));
    let fields: String = fields.collect();
    let name = emitter.options.name;
    format!(
        "/* Values of a cycle, on the stack. */\ntypedef struct {name}_values {{\n{fields}  char unused;\n}} {name}_values;\n\n"
    )
}

fn text_of(nodes: &[Node]) -> String {
    let mut text = String::new();
    print(nodes, 1, &mut text);
    text
}

fn part_functions(name: &str, bodies: &[String]) -> String {
    let mut out = String::new();
    for (k, body) in bodies.iter().enumerate() {
        let unused = ["cx", "s", "in", "out", "v"]
            .iter()
            .filter(|p| !mentions(body, p));
        let unused: String = unused.map(|p| format!("  (void){p};\n")).collect();
        out += &format!(
            "static void {name}_part_{k}(rpi_context *cx, {name}_state *s, const {name}_in *in, {name}_out *out,\n    {name}_values *v) {{\n{unused}{body}}}\n\n"
        );
    }
    out
}

fn step_function(emitter: &Emitter<'_>, nodes: &[Node]) -> String {
    let name = emitter.options.name;
    let text = text_of(nodes);
    let mut head =
        format!("int32_t {name}_step({name}_state *s, const {name}_in *in, {name}_out *out) {{\n");
    head += "  rpi_context context = {0, 0};\n  rpi_context *const cx = &context;\n";
    if emitter.variables.has_struct {
        head += &format!("  {name}_values values;\n  {name}_values *const v = &values;\n");
    } else {
        let used = variables_in(&text);
        for variable in emitter.variables.in_storage(Storage::Cycle) {
            if used.contains(variable.name.as_str()) {
                let declared = declarator(variable.ty, &variable.name, variable.slots.len);
                head += &format!("  {declared} = {};\n", zero(variable));
            }
        }
    }
    for unused in ["in", "s"] {
        if !mentions(&text, unused) {
            head += &format!("  (void){unused};\n");
        }
    }
    if emitter.variables.has_struct {
        head += "  memset(v, 0, sizeof *v);\n";
    }
    head += &set_points(emitter);
    format!("{head}{text}{}}}\n\n", tail(emitter))
}

/// Returns the statements that mark all set-points as absent.
fn set_points(emitter: &Emitter<'_>) -> String {
    let fields = emitter.interface.of(Direction::Output);
    let present = fields.filter(|f| matches!(f.meaning, Meaning::SetPointPresence(_)));
    present
        .map(|f| format!("  out->{} = false;\n", f.name))
        .collect()
}

/// Returns the end of the cycle: its number, and the report of a fault.
fn tail(emitter: &Emitter<'_>) -> String {
    let mut out = String::new();
    if counts_cycles(emitter) {
        out += &format!("  s->{CYCLE} += 1U;\n");
    }
    if emitter.places.is_empty() {
        out += "  memset(&out->fault, 0, sizeof out->fault);\n  (void)cx;\n  return 0;\n";
        return out;
    }
    let discard: String = set_points(emitter)
        .lines()
        .map(|l| format!("  {l}\n"))
        .collect();
    out += "  memset(&out->fault, 0, sizeof out->fault);\n";
    out += &format!(
        "  if (cx->fault != 0) {{\n    out->fault = rpi_places[cx->place];\n    out->fault.code = cx->fault;\n{discard}  }}\n  return cx->fault;\n"
    );
    out
}

fn self_test(name: &str) -> String {
    format!(
        "bool {name}_self_test(void) {{\n\
         \x20 volatile double factor = 1.0 + DBL_EPSILON;\n\
         \x20 volatile double product = 1.0 + 2.0 * DBL_EPSILON;\n\
         \x20 volatile double large = 9007199254740992.0;\n\
         \x20 const double a = factor;\n\
         \x20 const double b = product;\n\
         \x20 const double c = large;\n\
         \x20 /* The square of a, rounded, is b: a contracted operation would see the rest. */\n\
         \x20 const double contracted = a * a - b;\n\
         \x20 const double reordered = (c + a) - c;\n\
         \x20 return contracted == 0.0 && reordered == 2.0;\n}}\n"
    )
}
