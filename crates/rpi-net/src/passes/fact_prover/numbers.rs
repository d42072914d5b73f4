//! Contradictions between comparisons of a number with constants, such as `x = 1` and `x = 2` or `x > 3` and `x <= 2`,
//! and integers for which all possible values are excluded.

use super::contradiction::ContradictionError;
use super::truth_tables::ValueSet;
use super::values;
use crate::net::{Input, Net, Node, PortRef};
use rpi_image::{Role, Scalar, Type, Value};
use std::collections::{BTreeMap, BTreeSet};

/// Interval of the values that comparisons allow for one number.
#[derive(Clone, Copy)]
struct Bounds {
    lower: f64,
    upper: f64,
    /// Whether the lower and the upper bound themselves are excluded.
    excluded: (bool, bool),
    /// Whether some comparison of the number holds, so that it is not NaN.
    is_number: bool,
    /// Whether the bounds are durations in seconds that the net rounds up to ticks. Different bounds may then be the
    /// same tick.
    in_ticks: bool,
}

impl Bounds {
    const ALL: Bounds = Bounds {
        lower: f64::NEG_INFINITY,
        upper: f64::INFINITY,
        excluded: (false, false),
        is_number: false,
        in_ticks: false,
    };

    fn from(above: f64, open: bool) -> Bounds {
        Bounds {
            lower: above,
            excluded: (open, false),
            ..Bounds::ALL
        }
    }

    fn up_to(below: f64, open: bool) -> Bounds {
        Bounds {
            upper: below,
            excluded: (false, open),
            ..Bounds::ALL
        }
    }

    fn and(self, other: Bounds) -> Bounds {
        let lower = if (other.lower, other.excluded.0) > (self.lower, self.excluded.0) {
            other
        } else {
            self
        };
        let upper_first =
            other.upper < self.upper || (other.upper == self.upper && other.excluded.1);
        let upper = if upper_first { other } else { self };
        Bounds {
            lower: lower.lower,
            upper: upper.upper,
            excluded: (lower.excluded.0, upper.excluded.1),
            is_number: self.is_number || other.is_number,
            in_ticks: self.in_ticks || other.in_ticks,
        }
    }

    /// Returns whether the lower and the upper bound are both this value.
    fn contains_only(self, value: i64) -> bool {
        let value = as_number(&Value::int(value));
        value == Some(self.lower) && value == Some(self.upper)
    }

    fn is_empty(self) -> bool {
        let is_open = self.excluded.0 || self.excluded.1;
        let is_crossed = self.lower > self.upper;
        match self.in_ticks {
            true => is_open && self.lower >= self.upper,
            false => is_crossed || (is_open && self.lower == self.upper),
        }
    }
}

/// Returns an error if the facts about comparisons of some number with constants contradict each other. `known` are the
/// possible values of Boolean flows.
pub(super) fn check(
    net: &Net,
    known: &BTreeMap<PortRef, ValueSet>,
) -> Result<(), ContradictionError> {
    let mut ranges: BTreeMap<PortRef, Bounds> = BTreeMap::new();
    for (port, set) in known {
        let holds = match *set {
            ValueSet::TRUE => true,
            ValueSet::FALSE => false,
            _ => continue,
        };
        let node = net.node(port.node);
        let output = range(node, holds).or_else(|| range_in_ticks(net, node, holds));
        let Some((number, range)) = output else {
            continue;
        };
        let range = Bounds {
            is_number: holds || is_always_number(net, number),
            ..range
        };
        let all = ranges.entry(number).or_insert(Bounds::ALL);
        *all = all.and(range);
        if all.is_number && all.is_empty() {
            return Err(ContradictionError);
        }
    }
    check_excluded(net, known, &ranges)
}

/// Returns whether a flow is never NaN. All comparisons of NaN are false.
fn is_always_number(net: &Net, number: PortRef) -> bool {
    let node = net.node(number.node);
    let is_integer = node.outputs.get(usize::from(number.port)) == Some(&Type::Scalar(Scalar::Int));
    is_integer || matches!(node.desc().role, Role::Flow(_))
}

/// Returns an error if the facts exclude all possible values of some integer. `ranges` are the intervals that other
/// comparisons allow.
fn check_excluded(
    net: &Net,
    known: &BTreeMap<PortRef, ValueSet>,
    ranges: &BTreeMap<PortRef, Bounds>,
) -> Result<(), ContradictionError> {
    let mut excluded: BTreeMap<PortRef, BTreeSet<i64>> = BTreeMap::new();
    for port in known.iter().filter(|(_, set)| **set == ValueSet::FALSE) {
        if let Some((number, value)) = equals(net.node(port.0.node)) {
            excluded.entry(number).or_default().insert(value);
            let is_it = |range: &Bounds| range.is_number && range.contains_only(value);
            if ranges.get(&number).is_some_and(is_it) {
                return Err(ContradictionError);
            }
        }
    }
    let is_nothing = |(number, excluded): (&PortRef, &BTreeSet<i64>)| {
        values::possible_values(net, *number).is_some_and(|all| all.is_subset(excluded))
    };
    match excluded
        .iter()
        .filter(|(_, values)| values.len() > 1)
        .any(is_nothing)
    {
        true => Err(ContradictionError),
        false => Ok(()),
    }
}

/// Returns the integer flow and the constant that a node compares for exact equality; `None` for other nodes.
fn equals(node: &Node) -> Option<(PortRef, i64)> {
    let exact = node
        .params
        .first()
        .is_none_or(|slack| as_number(slack) == Some(0.0));
    match (node.desc().name, node.inputs.first()?, node.inputs.get(1)?) {
        ("Core::IntEquals", Input::Port(port), Input::Const(value))
        | ("Core::IntEquals", Input::Const(value), Input::Port(port))
            if exact =>
        {
            Some((*port, value.as_int()?))
        }
        _ => None,
    }
}

/// Returns the number that a node compares with a constant, and the interval of the number if the comparison has the
/// truth value `holds`; `None` for other nodes.
fn range(node: &Node, holds: bool) -> Option<(PortRef, Bounds)> {
    let name = node.desc().name;
    let (first, second) = (node.inputs.first()?, node.inputs.get(1)?);
    let (number, constant, is_first) = match (first, second) {
        (Input::Port(port), Input::Const(value)) => (*port, as_number(value)?, true),
        (Input::Const(value), Input::Port(port)) => (*port, as_number(value)?, false),
        _ => return None,
    };
    let compared = |op: &str| {
        [format!("Core::Int{op}"), format!("Core::Double{op}")].contains(&name.to_owned())
    };
    if compared("Equals") {
        let slack = node.params.first().and_then(as_number)?;
        let equal =
            Bounds::from(constant - slack, false).and(Bounds::up_to(constant + slack, false));
        return holds.then_some((number, equal));
    }
    let or_equal = OR_EQUAL.contains(&name);
    (or_equal || compared("Greater"))
        .then(|| (number, compared_with(constant, or_equal, is_first, holds)))
}

/// Returns the number of ticks that a node compares with a constant duration, and its interval in seconds if the
/// comparison has the truth value `holds`; `None` for other nodes.
///
/// The tick length is unknown, and durations are rounded up to ticks. So the longer of two durations has at least as
/// many ticks.
fn range_in_ticks(net: &Net, node: &Node, holds: bool) -> Option<(PortRef, Bounds)> {
    let or_equal = match node.desc().name {
        "Core::IntGreater" => false,
        "Rpi::IntGreaterOrEqual" => true,
        _ => return None,
    };
    let [Input::Port(first), Input::Port(second)] = node.inputs[..] else {
        return None;
    };
    let (number, seconds, is_first) = match (duration(net, first), duration(net, second)) {
        (None, Some(seconds)) => (first, seconds, true),
        (Some(seconds), None) => (second, seconds, false),
        _ => return None,
    };
    let range = Bounds {
        in_ticks: true,
        ..compared_with(seconds, or_equal, is_first, holds)
    };
    Some((number, range))
}

/// Returns the interval of a number for which a comparison with a constant (`>=` if `or_equal`, else `>`) has the truth
/// value `holds`. `is_first` is true if the number is the left operand.
fn compared_with(constant: f64, or_equal: bool, is_first: bool, holds: bool) -> Bounds {
    match (is_first, holds) {
        (true, true) => Bounds::from(constant, !or_equal),
        (true, false) => Bounds::up_to(constant, or_equal),
        (false, true) => Bounds::up_to(constant, !or_equal),
        (false, false) => Bounds::from(constant, or_equal),
    }
}

/// Returns the duration in seconds of a flow that is a constant number of ticks; `None` for other flows.
fn duration(net: &Net, port: PortRef) -> Option<f64> {
    let node = net.node(port.node);
    match (node.desc().name, node.inputs.first()?) {
        ("Rpi::WholeTicks", Input::Const(value)) => as_number(value),
        _ => None,
    }
}

/// Names of the primitives that compute `a >= b`.
const OR_EQUAL: [&str; 2] = ["Rpi::IntGreaterOrEqual", "Rpi::DoubleGreaterOrEqual"];

/// Returns a number as a double; `None` for NaN, for integers that a double cannot represent, and for other types.
fn as_number(value: &Value) -> Option<f64> {
    // Integers up to 2^53 are exact in a double.
    const EXACT: i64 = 1 << 53;
    let int = || {
        value
            .as_int()
            .filter(|i| i.abs() <= EXACT)
            .map(|i| i as f64)
    };
    value.as_real().filter(|r| !r.is_nan()).or_else(int)
}
