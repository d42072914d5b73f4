//! Forms of expressions, one row per form with its parts. To test another construct of the language, add a row.

use crate::types::Kind::{
    self, Area, Bool, Int, Ints, Length, Mode, Point, Real, Reals, Speed, Time,
};

/// Part of a form, written as `@` in its text.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(crate) enum Part {
    /// Of the type of the result.
    Own,
    /// Of this type; optional if the result may be (strict operators propagate absence).
    Lifted(Kind),
    /// Of this type, always present.
    Total(Kind),
    /// Of the type of the result, always present.
    OwnTotal,
    /// Of the type of the result, possibly absent.
    OwnOptional,
    /// Of this type, possibly absent.
    Optional(Kind),
    /// Delayed flow of the type of the result, possibly defined later.
    Delayed,
    /// Flow of the type of the result that is declared optional.
    DelayedOptional,
}

/// Condition for the use of a form.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(crate) enum Use {
    /// No condition.
    Any,
    /// State is allowed.
    State,
    /// The result may be absent.
    Absent,
    /// State is allowed and the result may be absent.
    StateAbsent,
}

/// Form of an expression.
#[derive(Debug)]
pub(crate) struct Form {
    /// Name of the construct, for the statistics.
    pub(crate) name: &'static str,
    /// Type of the result; `None` for any type.
    pub(crate) kind: Option<Kind>,
    pub(crate) text: &'static str,
    pub(crate) parts: &'static [Part],
    pub(crate) used: Use,
    /// Whether the form can be used on a clock, with all parts on the same clock.
    pub(crate) clocked: bool,
}

const fn form(
    name: &'static str,
    kind: Option<Kind>,
    text: &'static str,
    parts: &'static [Part],
    used: Use,
) -> Form {
    Form {
        name,
        kind,
        text,
        parts,
        used,
        clocked: false,
    }
}

/// Defines a form that can be used on a clock.
const fn ticking(
    name: &'static str,
    kind: Option<Kind>,
    text: &'static str,
    parts: &'static [Part],
    used: Use,
) -> Form {
    Form {
        clocked: true,
        ..form(name, kind, text, parts, used)
    }
}

use Part::{Delayed, DelayedOptional, Lifted, Optional, Own, OwnOptional, OwnTotal, Total};
use Use::{Absent, Any, State, StateAbsent};

const L_BOOL: Part = Lifted(Bool);
const L_INT: Part = Lifted(Int);
const L_REAL: Part = Lifted(Real);

/// All forms.
#[rustfmt::skip]
pub(crate) const FORMS: &[Form] = &[
    ticking("if",            None,         "(if @ then @ else @)",            &[Total(Bool), Own, Own],           Any),
    form("if, absent",       None,         "(if @ then @ else @)",            &[Optional(Bool), Own, Own],        Absent),
    form("none",             None,         "(if @ then @ else none)",         &[Total(Bool), Own],                Absent),
    ticking("->",            None,         "(@ -> @)",                        &[Own, Own],                        State),
    ticking("pre",           None,         "(@ -> pre @)",                    &[OwnTotal, Delayed],               State),
    ticking("fby",           None,         "(@ fby @)",                       &[OwnTotal, Delayed],               State),
    form("pre, optional",    None,         "(pre @)",                         &[DelayedOptional],                 StateAbsent),
    form("none -> pre",      None,         "(none -> pre @)",                 &[Delayed],                         StateAbsent),
    form("??",               None,         "(@ ?? @)",                        &[OwnOptional, Own],                Any),
    form("??, faulting",     Some(Int),    "(@ ?? @ / ((@ mod 3) * (1 -> 2)))", &[OwnOptional, Own, Own],          State),
    form("??, guarded call", Some(Int),    "(@ ?? Quotient(@, @ * (1 -> 2)))", &[OwnOptional, OwnTotal, OwnTotal], State),
    form("??, of a part",    Some(Point),  "((if @ then none else @) ?? Point{x = @; n = @ div ((@ mod 2) * (1 -> 2))})", &[Total(Bool), Own, Total(Real), Total(Int), Total(Int)], State),
    form("and, faulting",    Some(Bool),   "(@ and @ div ((@ mod 3) * (1 -> 2)) > 0)", &[L_BOOL, L_INT, L_INT],    State),
    form("or, faulting",     Some(Bool),   "(@ or @ mod ((@ mod 3) * (1 -> 2)) > 0)", &[L_BOOL, L_INT, L_INT],     State),
    form("=>, faulting",     Some(Bool),   "(@ => @ div ((@ mod 3) * (1 -> 2)) > 0)", &[L_BOOL, L_INT, L_INT],     State),
    form("and, or, guarded call", Some(Bool), "(@ and (@ or Ratio(@, @ * (1 -> 2)) > 1))", &[L_BOOL, L_BOOL, Total(Int), Total(Int)], State),
    form("if, guarded call", Some(Int),    "(if @ then Quotient(@, @ * (1 -> 2)) else @)", &[Total(Bool), Total(Int), Total(Int), Own], State),
    form("if, guarded map",  Some(Ints),   "(if @ then map<<Quotient, 3>>(@, [@ * (1 -> 2), 1 -> 2, @ + (0 -> 1)]) else @)", &[Total(Bool), Total(Ints), Total(Int), Total(Int), Own], State),
    form("subrange, port",   Some(Int),    "Slotted((@ mod 11) + (0 -> 1))",  &[Total(Int)],                      State),
    form("subrange, chosen", Some(Int),    "(if @ then Slotted(@ + (0 -> 1)) else @)", &[Total(Bool), Total(Int), Own], State),
    form("subrange, field",  Some(Int),    "(@ ?? Boxed{slot = @ + (0 -> 1); n = @}.slot)", &[OwnOptional, Total(Int), Total(Int)], State),
    form("hold",             None,         "hold(@, @)",                      &[OwnOptional, OwnTotal],           State),
    ticking("and",           Some(Bool),   "(@ and @)",                       &[L_BOOL, L_BOOL],                  Any),
    ticking("or",            Some(Bool),   "(@ or @)",                        &[L_BOOL, L_BOOL],                  Any),
    form("xor",              Some(Bool),   "(@ xor @)",                       &[L_BOOL, L_BOOL],                  Any),
    form("=>",               Some(Bool),   "(@ => @)",                        &[L_BOOL, L_BOOL],                  Any),
    ticking("not",           Some(Bool),   "(not @)",                         &[L_BOOL],                          Any),
    ticking("<",             Some(Bool),   "(@ < @)",                         &[L_INT, L_INT],                    Any),
    form(">",                Some(Bool),   "(@ > @)",                         &[L_REAL, L_REAL],                  Any),
    form("<=",               Some(Bool),   "(@ <= @)",                        &[Lifted(Length), Lifted(Length)],  Any),
    form(">=",               Some(Bool),   "(@ >= @)",                        &[L_INT, L_INT],                    Any),
    form("= int",            Some(Bool),   "(@ = @)",                         &[L_INT, L_INT],                    Any),
    form("= real",           Some(Bool),   "(@ = @)",                         &[L_REAL, L_REAL],                  Any),
    form("= bool",           Some(Bool),   "(@ = @)",                         &[L_BOOL, L_BOOL],                  Any),
    form("= enum",           Some(Bool),   "(@ = @)",                         &[Lifted(Mode), Lifted(Mode)],      Any),
    form("<> struct",        Some(Bool),   "(@ <> @)",                        &[Total(Point), Total(Point)],      Any),
    form("<> array",         Some(Bool),   "(@ <> @)",                        &[Total(Ints), Total(Ints)],        Any),
    form("present",          Some(Bool),   "present(@)",                      &[Optional(Int)],                   Any),
    form("present, struct",  Some(Bool),   "present(@)",                      &[Optional(Point)],                 Any),
    form("first",            Some(Bool),   "first",                           &[],                                State),
    form("boolred",          Some(Bool),   "boolred<<1, 2, 3>>([@, @, @])",   &[Total(Bool), Total(Bool), Total(Bool)], Any),
    form("crossing",         Some(Bool),   "(false -> @ and not @)",          &[Total(Bool), Total(Bool)],        State),
    ticking("+ int",         Some(Int),    "(@ + @)",                         &[Own, Own],                        Any),
    ticking("- int",         Some(Int),    "(@ - @)",                         &[Own, Own],                        Any),
    form("* int",            Some(Int),    "((@ mod 1000) * (@ mod 100))",    &[Own, Own],                        Any),
    form("- of int",         Some(Int),    "(-@)",                            &[Own],                             Any),
    form("div",              Some(Int),    "(@ div 7)",                       &[Own],                             Any),
    form("/ int, faulting",  Some(Int),    "(@ / (@ + (5 -> 6)))",            &[Own, Own],                        State),
    form("/ int, chosen",    Some(Int),    "(if @ then @ / (@ * (1 -> 2)) else @)", &[Total(Bool), Own, Own, Own], State),
    form("mod",              Some(Int),    "(@ mod 10)",                      &[Own],                             Any),
    form("power",            Some(Int),    "((@ mod 10) ** 3)",               &[Own],                             Any),
    form("int of real",      Some(Int),    "(if @ then int (@ * (1.0 -> 2.0)) else @)", &[Total(Bool), L_REAL, Own], State),
    form("field",            Some(Int),    "(@).n",                           &[Lifted(Point)],                   Any),
    form("element",          Some(Int),    "(@)[1]",                          &[Lifted(Ints)],                    Any),
    form("element, computed", Some(Int),   "(@)[if @ then 2 else 0]",         &[Total(Ints), Total(Bool)],        Any),
    form("element, faulting", Some(Int),   "(@)[(if @ then 1 else 2) + (0 -> 1)]", &[Total(Ints), Total(Bool)], State),
    form("red",              Some(Int),    "red<<+, 3>>(@, @)",               &[Total(Int), Total(Ints)],         Any),
    form("fold",             Some(Int),    "fold<<Step, 3>>(@, @)",           &[Total(Int), Total(Ints)],         Any),
    form("min, max, abs",    Some(Int),    "max(@, min(abs(@), 50))",         &[Total(Int), Total(Int)],          Any),
    form("recursion",        Some(Int),    "Sum<<3>>(@)",                     &[Total(Ints)],                     Any),
    ticking("+ real",        Some(Real),   "(@ + @)",                         &[Own, Own],                        Any),
    form("- real",           Some(Real),   "(@ - @)",                         &[Own, Own],                        Any),
    ticking("* real",        Some(Real),   "(@ * @)",                         &[Own, Own],                        Any),
    form("/ real",           Some(Real),   "(@ / @)",                         &[Own, Own],                        Any),
    form("mod real",         Some(Real),   "(@ mod @)",                       &[Own, Own],                        Any),
    form("- of real",        Some(Real),   "(-@)",                            &[Own],                             Any),
    form("real of int",      Some(Real),   "(real (@))",                        &[L_INT],                           Any),
    form("ratio",            Some(Real),   "(@ / @)",                         &[Lifted(Length), Lifted(Length)],  Any),
    form("percent",          Some(Real),   "(60% * @)",                       &[Own],                             Any),
    form("floor",            Some(Real),   "(floor(@) + ceil(@) - round(@))", &[Total(Real), Total(Real), Total(Real)], Any),
    form("field, real",      Some(Real),   "(@).x",                           &[Lifted(Point)],                   Any),
    form("element, real",    Some(Real),   "(@)[2]",                          &[Lifted(Reals)],                   Any),
    form("red, real",        Some(Real),   "red<<+, 3>>(@, @)",               &[Total(Real), Total(Reals)],       Any),
    form("+ unit",           Some(Length), "(@ + @)",                         &[Own, Own],                        Any),
    form("scaled",           Some(Length), "(@ * @)",                         &[L_REAL, Own],                     Any),
    form("speed * time",     Some(Length), "(@ * @)",                         &[Lifted(Speed), Lifted(Time)],     Any),
    form("area / length",    Some(Length), "(@ / @)",                         &[Lifted(Area), Own],               Any),
    form("sqrt",             Some(Length), "sqrt(@)",                         &[Lifted(Area)],                    Any),
    form("prefix",           Some(Length), "(@ - 250[mm])",                   &[Own],                             Any),
    form("length / speed",   Some(Time),   "(@ / @)",                         &[Lifted(Length), Lifted(Speed)],   Any),
    form("dt",               Some(Time),   "(@ + dt)",                        &[Own],                             Any),
    form("length / time",    Some(Speed),  "(@ / @)",                         &[Lifted(Length), Lifted(Time)],    Any),
    form("length * length",  Some(Area),   "(@ * @)",                         &[Lifted(Length), Lifted(Length)],  Any),
    form("enum",             Some(Mode),   "(if @ = Off then Slow else @)",   &[Lifted(Mode), Own],               Any),
    form("struct",           Some(Point),  "Point{x = @; n = @}",             &[Total(Real), Total(Int)],         Any),
    form("with field",       Some(Point),  "(@ with .n = @)",                 &[Total(Point), Total(Int)],        Any),
    form("array",            Some(Ints),   "[@, @, @]",                       &[Total(Int), Total(Int), Total(Int)], Any),
    form("^",                Some(Ints),   "(@ ^ 3)",                         &[Total(Int)],                      Any),
    form("with element",     Some(Ints),   "(@ with [1] = @)",                &[Total(Ints), Total(Int)],         Any),
    form("slice, |",         Some(Ints),   "((@)[0 .. 1] | [@])",             &[Total(Ints), Total(Int)],         Any),
    form("map",              Some(Ints),   "map<<+, 3>>(@, @)",               &[Total(Ints), Total(Ints)],        Any),
    form("map node",         Some(Ints),   "map<<Count, 3>>(@)",              &[Total(Ints)],                     State),
    form("array, real",      Some(Reals),  "[@, @, @]",                       &[Total(Real), Total(Real), Total(Real)], Any),
    form("^ real",           Some(Reals),  "(@ ^ 3)",                         &[Total(Real)],                     Any),
    form("map real",         Some(Reals),  "map<<*, 3>>(@, @)",               &[Total(Reals), Total(Reals)],      Any),
    form("reverse slice",    Some(Reals),  "(@)[2 .. 0 step -1]",             &[Total(Reals)],                    Any),
    form("nodes' state",     Some(Int),    "Count(@)",                        &[Total(Int)],                      State),
    form("condact",          Some(Int),    "condact(@, Count(@), @)",         &[Total(Bool), Total(Int), Total(Int)], State),
    form("activate",         Some(Int),    "(activate Count every @)(@)",     &[Total(Bool), Total(Int)],         StateAbsent),
    form("activate, default", Some(Int),   "(activate Count every @ initial default @)(@)", &[Total(Bool), Total(Int), Total(Int)], State),
    form("activate, restart", Some(Int),   "(activate Count every @ restart every @ initial default 0)(@)", &[Total(Bool), Total(Bool), Total(Int)], State),
    form("activate, absent", Some(Int),    "(activate Seldom every @)(@)",    &[Total(Bool), Total(Int)],         StateAbsent),
    form("activate, kept",   Some(Int),    "(activate Seldom every @ initial default @)(@)", &[Total(Bool), Total(Int), Total(Int)], StateAbsent),
    form("restart",          Some(Int),    "(restart Count every @)(@)",      &[Total(Bool), Total(Int)],         State),
    form("several outputs",  Some(Int),    "Both(@, @).sum",                  &[Total(Int), Total(Bool)],         State),
    form("named fragment",   Some(Int),    "Above(x: @, limit: @)",           &[Total(Int), Total(Int)],          StateAbsent),
    form("generic size",     Some(Int),    "Total<<3>>(@)",                   &[Total(Ints)],                     Any),
    form("generic type",     Some(Real),   "Same<<type real>>(@)",            &[Total(Real)],                     Any),
];

/// Declarations called by the forms.
pub(crate) const CALLED: &str = "\
node Count (x: int) returns (n: int)\nlet\n  n = (0 -> pre n) mod 1000 + x mod 50;\ntel\n\
type Slot = subrange [-2, 9] of int;\n\
type Boxed = struct { slot: Slot; n: int };\n\
node Slotted (s: Slot) returns (y: Slot)\nlet\n  y = s + 1;\ntel\n\
node Quotient (a, b: int) returns (q: int)\nlet\n  q = a div (b mod 3);\ntel\n\
node Ratio (a, b: int) returns (q: int)\nvar big: bool;\nlet\n  big = b > 0 and a div b > 2;\n  q = if big then Quotient(a, b) else Quotient(a - 1, b + 1) mod 7;\ntel\n\
function Step (so_far, x: int) returns (next: int)\nlet\n  next = (so_far mod 100) * 2 - x;\ntel\n\
function Sum <<const n: int>> (a: int^n) returns (s: int)\nlet\n  s = with n = 1 then a[0] else a[n - 1] + Sum<<n - 1>>(a[0 .. n - 2]);\ntel\n\
node Sampling (c: bool; x: int) returns (often: int; rare: int when c)\nlet\n  often = x mod 1000 + 1;\n  rare = ((x mod 1000) when c) - 2 * (often when c);\ntel\n\
node Both (x: int; on: bool) returns (sum: int; changed: bool)\nlet\n  sum = (if on then x else 0) -> if on then (pre sum) div 2 + x else pre sum;\n  changed = false -> sum <> pre sum;\ntel\n\
node Seldom (x: int) returns (y: int?)\nlet\n  y = if (0 -> pre x) > x then none else x;\ntel\n\
fragment Above (x, limit: int) returns (over: int) when x > limit\nlet\n  over = (0 -> pre over) mod 100 + 1;\ntel\n\
function Total <<const n: int>> (a: int^n) returns (s: int)\nlet\n  s = red<<+, n>>(0, a);\ntel\n\
function Same <<type T>> (x: T) returns (y: T)\nlet\n  y = x;\ntel\n";
