//! Operator table: spelling, precedence level and associativity, weakest first.
//!
//! The parser, the printer (for parentheses) and the language reference use this table. The levels are those of Lustre
//! V6. `??` is added below `=>`, so that `a = b ?? false` needs no parentheses.

/// Associativity of a binary operator: how a chain without parentheses is grouped.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Associativity {
    /// Left-associative: `a - b - c` is `(a - b) - c`.
    Left,
    /// Right-associative: `a -> b -> c` is `a -> (b -> c)`.
    Right,
    /// Not associative: `a < b < c` is an error.
    None,
}

/// Precedence level of an operator. A higher level binds more strongly.
pub type Precedence = u8;

/// Precedence level of the prefixes `if c then x else` and `with c then x else`. The operand after `else` extends as
/// far right as possible.
pub const PRECEDENCE_IF: Precedence = 1;
/// Precedence level of `x when c`, which is higher than that of most binary operators.
pub const PRECEDENCE_WHEN: Precedence = 13;
/// Precedence level of expressions that need no parentheses: names, literals, calls, `x.f`, `x[i]`.
pub const PRECEDENCE_PRIMARY: Precedence = 17;

/// Row of the table of binary operators.
#[derive(Debug)]
pub struct BinaryOpInfo {
    /// Operator that the row of the table describes.
    pub op: BinaryOp,
    /// Keyword or symbol of the operator in a program.
    pub spelling: &'static str,
    /// Precedence level: an operator of a higher level binds more strongly.
    pub precedence: Precedence,
    /// Grouping of operators of one precedence level without parentheses: left, right or not allowed.
    pub associativity: Associativity,
    /// Whether the operator exists in `.lus` files only.
    pub only_lustre: bool,
    /// Short description for the language reference and editors.
    pub doc: &'static str,
}

/// Row of the table of unary operators. All are prefix operators.
#[derive(Debug)]
pub struct UnaryOpInfo {
    /// Operator that the row of the table describes.
    pub op: UnaryOp,
    /// Keyword or symbol of the operator in a program.
    pub spelling: &'static str,
    /// Precedence level: an operator of a higher level binds more strongly.
    pub precedence: Precedence,
    /// Whether the operator exists in `.lus` files only.
    pub only_lustre: bool,
    /// Short description for the language reference and editors.
    pub doc: &'static str,
}

macro_rules! only_lustre {
    () => {
        false
    };
    (Lustre) => {
        true
    };
}

macro_rules! binary_ops {
    ($($op:ident $spelling:literal $level:literal $grouping:ident $doc:literal $($mode:ident)?;)*) => {
        /// Operator between two operands, such as `+` or `and`.
        #[derive(Clone, Copy, PartialEq, Eq, Hash, Debug, PartialOrd, Ord)]
        pub enum BinaryOp {
            $(#[doc = concat!("`", $spelling, "`: ", $doc)] $op,)*
        }

        /// All binary operators, weakest first, in the order of [`BinaryOp`].
        pub const BINARY: &[BinaryOpInfo] = &[$(BinaryOpInfo {
            op: BinaryOp::$op,
            spelling: $spelling,
            precedence: $level,
            associativity: Associativity::$grouping,
            only_lustre: only_lustre!($($mode)?),
            doc: $doc,
        },)*];
    };
}

macro_rules! unary_ops {
    ($($op:ident $spelling:literal $level:literal $doc:literal $($mode:ident)?;)*) => {
        /// Operator before its only operand, such as `not` or `pre`.
        #[derive(Clone, Copy, PartialEq, Eq, Hash, Debug, PartialOrd, Ord)]
        pub enum UnaryOp {
            $(#[doc = concat!("`", $spelling, "`: ", $doc)] $op,)*
        }

        /// All unary operators, weakest first, in the order of [`UnaryOp`].
        pub const UNARY: &[UnaryOpInfo] = &[$(UnaryOpInfo {
            op: UnaryOp::$op,
            spelling: $spelling,
            precedence: $level,
            only_lustre: only_lustre!($($mode)?),
            doc: $doc,
        },)*];
    };
}

binary_ops! {
    Concat   "|"   2  Left  "array concatenation";
    Arrow    "->"  3  Right "left operand in the first cycle, right operand afterwards";
    Coalesce "??"  4  Right "left operand where present, else right operand";
    Implies  "=>"  5  Right "implication";
    Or       "or"  6  Left  "disjunction";
    Xor      "xor" 6  Left  "exclusive or";
    And      "and" 7  Left  "conjunction";
    Eq       "="   8  None  "equal";
    Ne       "<>"  8  None  "not equal";
    Lt       "<"   8  None  "less";
    Le       "<="  8  None  "at most";
    Gt       ">"   8  None  "greater";
    Ge       ">="  8  None  "at least";
    In       "in"  8  None  "set membership" Lustre;
    Add      "+"   10 Left  "sum";
    Sub      "-"   10 Left  "difference";
    BitOr    "||"  10 Left  "machine integers: bitwise or" Lustre;
    Append   "++"  10 Left  "machine integers: concatenation of the bits" Lustre;
    Mul      "*"   11 Left  "product";
    Div      "/"   11 Left  "quotient";
    IntDiv   "div" 11 Left  "integer quotient, towards zero";
    Mod      "mod" 11 Left  "remainder, with the sign of the left operand";
    BitAnd   "&&"  11 Left  "machine integers: bitwise and" Lustre;
    Pow      "**"  12 Left  "power";
    ShiftLeft  "lsh" 12 Left "machine integers: shift left" Lustre;
    ShiftRight "rsh" 12 Left "machine integers: shift right" Lustre;
    Repeat   "^"   15 Left  "array that repeats one value";
    Fby      "fby" 16 Right "left operand in the first cycle, then right operand delayed by one cycle";
}

unary_ops! {
    Not     "not"     9  "negation";
    Neg     "-"       14 "arithmetic negation";
    Pre     "pre"     14 "value in the previous cycle";
    Last    "last"    14 "value in the previous cycle, in any state; of a name or field";
    Current "current" 14 "latest value of a sampled flow";
    ToInt   "int"     14 "conversion of a real to an integer";
    ToReal  "real"    14 "conversion of an integer to a real";
    BitNot  "!"       14 "machine integers: bitwise complement" Lustre;
}

impl BinaryOp {
    /// Returns whether the operator is an order comparison: `<`, `<=`, `>` or `>=`.
    pub(crate) fn is_ordering(self) -> bool {
        matches!(
            self,
            BinaryOp::Lt | BinaryOp::Le | BinaryOp::Gt | BinaryOp::Ge
        )
    }

    /// Returns the spelling of the operator in source text.
    pub fn spelling(self) -> &'static str {
        self.info().spelling
    }

    /// Returns the precedence level of the operator.
    pub fn precedence(self) -> Precedence {
        self.info().precedence
    }

    /// Returns how a chain of the operator without parentheses is grouped: from the left, from the right, or rejected.
    pub fn associativity(self) -> Associativity {
        self.info().associativity
    }

    // The rows are in the order of the variants; a test checks this.
    fn info(self) -> &'static BinaryOpInfo {
        &BINARY[self as usize]
    }
}

impl UnaryOp {
    /// Returns the spelling of the operator in source text.
    pub fn spelling(self) -> &'static str {
        self.info().spelling
    }

    /// Returns the precedence level of the operator.
    pub fn precedence(self) -> Precedence {
        self.info().precedence
    }

    fn info(self) -> &'static UnaryOpInfo {
        &UNARY[self as usize]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_stand_in_the_order_of_the_operators() {
        for (i, row) in BINARY.iter().enumerate() {
            assert_eq!(row.op as usize, i);
        }
        for (i, row) in UNARY.iter().enumerate() {
            assert_eq!(row.op as usize, i);
        }
    }

    #[test]
    fn equal_levels_group_alike_and_stand_together() {
        for pair in BINARY.windows(2) {
            assert!(pair[0].precedence <= pair[1].precedence);
            if pair[0].precedence == pair[1].precedence {
                assert_eq!(pair[0].associativity, pair[1].associativity);
            }
        }
    }
}
