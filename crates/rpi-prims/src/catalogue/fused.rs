//! Two primitives in one, as the lowering makes them where one feeds only the other: one dispatch, one value less to
//! store. Each rounds as its two parts do, so that not a bit differs.

use crate::macros::primitive;
use crate::registry::Prim;

pub(super) const ALL: &[Prim] = &[
    PRODUCT_PLUS,
    PLUS_PRODUCT,
    PRODUCT_MINUS,
    MINUS_PRODUCT,
    SUM_TIMES,
    TIMES_SUM,
    GREATER_CHOICE,
];

primitive! {
    /// First times second, rounded, plus third. Made by the compiler.
    PRODUCT_PLUS = "Rpi::FusedProductPlus";
    in { inFirst: f64; inSecond: f64; inThird: f64 }
    out { outValue: f64 }
    presence strict work 2;
    pure |(a, b, c)| (a * b + c,)
}

primitive! {
    /// First plus the rounded product of second and third. Made by the compiler.
    PLUS_PRODUCT = "Rpi::FusedPlusProduct";
    in { inFirst: f64; inSecond: f64; inThird: f64 }
    out { outValue: f64 }
    presence strict work 2;
    pure |(a, b, c)| (a + b * c,)
}

primitive! {
    /// First times second, rounded, minus third. Made by the compiler.
    PRODUCT_MINUS = "Rpi::FusedProductMinus";
    in { inFirst: f64; inSecond: f64; inThird: f64 }
    out { outValue: f64 }
    presence strict work 2;
    pure |(a, b, c)| (a * b - c,)
}

primitive! {
    /// First minus the rounded product of second and third. Made by the compiler.
    MINUS_PRODUCT = "Rpi::FusedMinusProduct";
    in { inFirst: f64; inSecond: f64; inThird: f64 }
    out { outValue: f64 }
    presence strict work 2;
    pure |(a, b, c)| (a - b * c,)
}

primitive! {
    /// The rounded sum of first and second, times third. Made by the compiler.
    SUM_TIMES = "Rpi::FusedSumTimes";
    in { inFirst: f64; inSecond: f64; inThird: f64 }
    out { outValue: f64 }
    presence strict work 2;
    pure |(a, b, c)| ((a + b) * c,)
}

primitive! {
    /// First times the rounded sum of second and third. Made by the compiler.
    TIMES_SUM = "Rpi::FusedTimesSum";
    in { inFirst: f64; inSecond: f64; inThird: f64 }
    out { outValue: f64 }
    presence strict work 2;
    pure |(a, b, c)| (a * (b + c),)
}

primitive! {
    /// Third if first is greater than second, else fourth. Made by the compiler.
    GREATER_CHOICE = "Rpi::FusedGreaterChoice";
    in { inFirst: f64; inSecond: f64; inThird: f64; inFourth: f64 }
    out { outValue: f64 }
    presence strict work 2;
    pure |(a, b, c, d)| (if a > b { c } else { d },)
}
