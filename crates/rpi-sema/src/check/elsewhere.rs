//! Functions of other languages for what is no function here: what is written in their place.

use super::args::Given;
use super::body::Body;
use super::foreign;
use crate::ty::Ty;
use crate::units::Dim;
use rpi_diag::{Code, Fix, Span};
use rpi_syntax::ast;

impl<'a> Body<'_, 'a> {
    /// Says in what has been reported of `len(a)` how the same is written here; `given` are its arguments.
    pub(super) fn meant_elsewhere(&mut self, call: &'a ast::Call, given: &[Given], span: Span) {
        self.meant_as_power(call, span);
        let ty = given
            .first()
            .map_or(Ty::Unknown, |first| self.ty_of(first.value).clone());
        let name = &call.callee.name;
        let Some((help, fix)) = here(&name.name.to_lowercase(), call, &ty) else {
            return;
        };
        // What else is strange in such a call is of the other language, too.
        self.findings.retain(|finding| {
            let place = finding.span();
            let inside = span.start <= place.start && place.end <= span.end && place != name.span;
            !(inside && place.file == span.file && finding.code == Code::RPI1001)
        });
        if let Some(finding) = self.finding_at(name.span, Code::RPI1001) {
            finding.help = vec![help];
            finding.fixes = fix.into_iter().collect();
        }
    }
}

/// What is written in the place of a call, in words and, where that is plain, as a change.
fn here(name: &str, call: &ast::Call, ty: &Ty) -> Option<(String, Option<Fix>)> {
    let place = call.callee.name.span;
    match name {
        "prev" | "previous" | "old" => {
            let fix = Fix::maybe("write `pre`").replace(place, "pre ");
            let help = "the value of the cycle before is `pre x`, with a first value `0 -> pre x`";
            Some((help.to_owned(), (call.args.len() == 1).then_some(fix)))
        }
        "len" | "length" | "numel" | "sizeof" => {
            let help = match ty {
                Ty::Array(_, n) => {
                    format!("the size belongs to the type of an array: here it is {n}")
                }
                _ => {
                    "the size belongs to the type of an array: `const n: int = 3;`, then `a: int^n`"
                        .to_owned()
                }
            };
            Some((help, None))
        }
        "sum" | "prod" | "all" | "reduce" | "foldl" | "accumulate" => Some(folded(name, call, ty)),
        _ if converts_to(name).is_some() => {
            let word = converts_to(name)?;
            let fix = Fix::maybe(format!("write `{word}`")).replace(place, format!("{word} "));
            let help = format!("a conversion is a word before its value: `{word} x`");
            Some((help, (call.args.len() == 1).then_some(fix)))
        }
        "delay" => {
            let help = "one cycle late is `0 -> pre x`; whether `c` has held for a second is `on_delay<<delay: 1.0[s]>>(c)`";
            Some((help.to_owned(), None))
        }
        "wait" | "sleep" | "usleep" | "pause" | "waittime" | "waituntil" | "wait_sec" | "dwell" => {
            let help = "nothing waits within a cycle; whether `c` has held for a second is `on_delay<<delay: 1.0[s]>>(c)`";
            Some((help.to_owned(), None))
        }
        "print" | "printf" | "println" | "puts" | "echo" | "fprintf" | "disp" | "display"
        | "log" | "write" | "writeln" | "tpwrite" | "msg" | "cout" | "debug" => {
            let help = "a node shows nothing by itself: who runs it sees its out-ports, and what a command exports: `export x;`";
            Some((help.to_owned(), None))
        }
        _ => super::phrases::of_call(name).map(|help| (help.to_owned(), None)),
    }
}

/// The type into which a function of another language converts: `float`, `INT_TO_REAL`, `toInt`.
fn converts_to(name: &str) -> Option<&'static str> {
    let target = match name.rsplit_once("_to_").or_else(|| name.rsplit_once("to")) {
        Some((from, target)) if from.is_empty() || foreign::type_here(from).is_some() => target,
        Some((_, target)) if name.contains("_to_") => target,
        _ => name,
    };
    let target = target.trim_start_matches('_');
    let known = |word: &'static str| {
        (target == word || foreign::type_here(target) == Some(word)).then_some(word)
    };
    known("real").or_else(|| known("int"))
}

/// `red` in the place of `sum(a)`.
fn folded(name: &str, call: &ast::Call, ty: &Ty) -> (String, Option<Fix>) {
    let (op, with) = match name {
        "prod" => ("*", "1"),
        "all" => ("and", "true"),
        _ => ("+", "0"),
    };
    let Ty::Array(element, n) = ty else {
        let help = format!("along an array of 3 works `red<<{op}, 3>>({with}, a)`");
        return (help, None);
    };
    let with = match (&**element, name) {
        (Ty::Real(_), "prod") => "1.0",
        (Ty::Real(_), _) => "0.0",
        _ => with,
    };
    let is_plain = match (&**element, name) {
        (Ty::Bool, "all") | (Ty::Int, "sum" | "prod") => true,
        (Ty::Real(dim), "sum" | "prod") => *dim == Dim::ONE,
        _ => false,
    };
    let callee = format!("red<<{op}, {n}>>");
    let help = format!("along this array works `{callee}({with}, a)`");
    let fix = match &call.args[..] {
        [only] if is_plain => Some(
            Fix::maybe(format!("write `{callee}`"))
                .replace(call.callee.name.span, callee)
                .insert_before(only.value.span, format!("{with}, ")),
        ),
        _ => None,
    };
    (help, fix)
}
