//! Functions of doubles: the operations of real terms, and monotone functions of one argument.

/// Operation on one real number that the model checker knows.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
pub(super) enum Unary {
    Negate,
    Absolute,
    Floor,
    Ceiling,
    Round,
}

/// Operation on two real numbers that the model checker knows.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
pub(super) enum Binary {
    Add,
    Subtract,
    Multiply,
    Divide,
    Minimum,
    Maximum,
}

/// Monotone function of one double, such as `x + 1.0`. A comparison of its result is reduced to a comparison of its
/// argument.
#[derive(Clone, Copy)]
pub(super) struct Monotone {
    op: Result<Unary, Binary>,
    constant: f64,
    constant_first: bool,
    /// Whether the function rises with its argument; otherwise it falls.
    pub(super) rises: bool,
}

impl Monotone {
    pub(super) fn unary(op: Unary) -> Monotone {
        Monotone {
            op: Ok(op),
            constant: 0.0,
            constant_first: false,
            rises: op != Unary::Negate,
        }
    }

    pub(super) fn binary(op: Binary, constant: f64, constant_first: bool) -> Monotone {
        let is_factor = matches!(op, Binary::Multiply | Binary::Divide);
        let is_subtracted = op == Binary::Subtract && constant_first;
        Monotone {
            op: Err(op),
            constant,
            constant_first,
            rises: !(is_subtracted || is_factor && constant < 0.0),
        }
    }

    pub(super) fn value(self, x: f64) -> f64 {
        match (self.op, self.constant_first) {
            (Ok(op), _) => apply_unary(op, x),
            (Err(op), true) => apply_binary(op, self.constant, x),
            (Err(op), false) => apply_binary(op, x, self.constant),
        }
    }
}

pub(super) fn apply_unary(op: Unary, a: f64) -> f64 {
    match op {
        Unary::Negate => -a,
        Unary::Absolute => a.abs(),
        Unary::Floor => a.floor(),
        Unary::Ceiling => a.ceil(),
        Unary::Round => a.round(),
    }
}

pub(super) fn apply_binary(op: Binary, a: f64, b: f64) -> f64 {
    match op {
        Binary::Add => a + b,
        Binary::Subtract => a - b,
        Binary::Multiply => a * b,
        Binary::Divide => a / b,
        // If one operand is NaN, the other is returned, as in C's `fmin`.
        Binary::Minimum => a.min(b),
        Binary::Maximum => a.max(b),
    }
}
