//! The table of operators: spelling, level and grouping, weakest first.
//!
//! The parser builds trees by it, the printer sets parentheses by it, the language reference shows
//! it. The levels are those of Lustre V6; `??` is added below `=>`, so that `a = b ?? false` needs no
//! parentheses.

/// Which of two equal operators in a row is applied first.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Grouping {
    /// `a - b - c` is `(a - b) - c`.
    Left,
    /// `a -> b -> c` is `a -> (b -> c)`.
    Right,
    /// `a < b < c` is an error.
    None,
}

/// How strongly an operator binds; a larger level binds more strongly.
pub type Level = u8;

/// The level of `if c then x else` and `with c then x else`, whose last branch extends as far right as possible.
pub const LEVEL_IF: Level = 1;
/// The level of `x when c`.
pub const LEVEL_WHEN: Level = 13;
/// The level of what needs no parentheses: names, literals, calls, `x.f`, `x[i]`.
pub const LEVEL_PRIMARY: Level = 17;

/// One row of the table of binary operators.
#[derive(Debug)]
pub struct BinaryRow {
    /// The operator.
    pub op: BinaryOp,
    /// How it is written.
    pub spelling: &'static str,
    /// How strongly it binds.
    pub level: Level,
    /// How equals group.
    pub grouping: Grouping,
    /// Whether it is only an operator in `.lus` files.
    pub only_lustre: bool,
    /// What it does, in a few words.
    pub doc: &'static str,
}

/// One row of the table of unary operators; all stand before their operand.
#[derive(Debug)]
pub struct UnaryRow {
    /// The operator.
    pub op: UnaryOp,
    /// How it is written.
    pub spelling: &'static str,
    /// How strongly it binds.
    pub level: Level,
    /// Whether it is only an operator in `.lus` files.
    pub only_lustre: bool,
    /// What it does, in a few words.
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
        /// An operator between two operands.
        #[derive(Clone, Copy, PartialEq, Eq, Hash, Debug, PartialOrd, Ord)]
        pub enum BinaryOp {
            $(#[doc = concat!("`", $spelling, "`: ", $doc)] $op,)*
        }

        /// Every binary operator, weakest first, in the order of [`BinaryOp`].
        pub const BINARY: &[BinaryRow] = &[$(BinaryRow {
            op: BinaryOp::$op,
            spelling: $spelling,
            level: $level,
            grouping: Grouping::$grouping,
            only_lustre: only_lustre!($($mode)?),
            doc: $doc,
        },)*];
    };
}

macro_rules! unary_ops {
    ($($op:ident $spelling:literal $level:literal $doc:literal $($mode:ident)?;)*) => {
        /// An operator before its operand.
        #[derive(Clone, Copy, PartialEq, Eq, Hash, Debug, PartialOrd, Ord)]
        pub enum UnaryOp {
            $(#[doc = concat!("`", $spelling, "`: ", $doc)] $op,)*
        }

        /// Every unary operator, weakest first, in the order of [`UnaryOp`].
        pub const UNARY: &[UnaryRow] = &[$(UnaryRow {
            op: UnaryOp::$op,
            spelling: $spelling,
            level: $level,
            only_lustre: only_lustre!($($mode)?),
            doc: $doc,
        },)*];
    };
}

binary_ops! {
    Concat   "|"   2  Left  "one array after the other";
    Arrow    "->"  3  Right "left in the first cycle, right afterwards";
    Coalesce "??"  4  Right "left where present, else right";
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
    In       "in"  8  None  "whether a set holds a value" Lustre;
    Add      "+"   10 Left  "sum";
    Sub      "-"   10 Left  "difference";
    BitOr    "||"  10 Left  "machine integers: bits of either" Lustre;
    Append   "++"  10 Left  "machine integers: the bits of one above those of the other" Lustre;
    Mul      "*"   11 Left  "product";
    Div      "/"   11 Left  "quotient";
    IntDiv   "div" 11 Left  "integer quotient, towards zero";
    Mod      "mod" 11 Left  "remainder, with the sign of the left operand";
    BitAnd   "&&"  11 Left  "machine integers: bits of both" Lustre;
    Pow      "**"  12 Left  "power";
    ShiftLeft  "lsh" 12 Left "machine integers: bits moved to the left" Lustre;
    ShiftRight "rsh" 12 Left "machine integers: bits moved to the right" Lustre;
    Repeat   "^"   15 Left  "array of so many equal elements";
    Fby      "fby" 16 Right "left in the first cycle, then right one cycle late";
}

unary_ops! {
    Not     "not"     9  "negation";
    Neg     "-"       14 "opposite";
    Pre     "pre"     14 "value at the previous cycle";
    Last    "last"    14 "value at the previous cycle, whatever the state; of a name or field";
    Current "current" 14 "latest value of a sampled flow";
    ToInt   "int"     14 "real to integer";
    ToReal  "real"    14 "integer to real";
    BitNot  "!"       14 "machine integers: bits turned over" Lustre;
}

impl BinaryOp {
    /// Whether it asks which of two is the larger one.
    pub(crate) fn is_order(self) -> bool {
        matches!(
            self,
            BinaryOp::Lt | BinaryOp::Le | BinaryOp::Gt | BinaryOp::Ge
        )
    }

    /// How it is written.
    pub fn spelling(self) -> &'static str {
        self.row().spelling
    }

    /// How strongly it binds.
    pub fn level(self) -> Level {
        self.row().level
    }

    /// How equals group.
    pub fn grouping(self) -> Grouping {
        self.row().grouping
    }

    fn row(self) -> &'static BinaryRow {
        &BINARY[self as usize]
    }
}

impl UnaryOp {
    /// How it is written.
    pub fn spelling(self) -> &'static str {
        self.row().spelling
    }

    /// How strongly it binds.
    pub fn level(self) -> Level {
        self.row().level
    }

    fn row(self) -> &'static UnaryRow {
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
            assert!(pair[0].level <= pair[1].level);
            if pair[0].level == pair[1].level {
                assert_eq!(pair[0].grouping, pair[1].grouping);
            }
        }
    }
}
