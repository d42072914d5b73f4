//! Fused primitives. The lowering creates them from two primitives if the result of the first is used only by the
//! second. This saves one dispatch and one store. Each operation rounds separately, so results are bit-identical to the
//! unfused form (no fused multiply-add).

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
    /// `inFirst * inSecond + inThird`, with the product rounded. Created by the compiler.
    PRODUCT_PLUS = "Rpi::FusedProductPlus";
    in { inFirst: f64; inSecond: f64; inThird: f64 }
    out { outValue: f64 }
    presence strict work 2;
    c Value("inFirst * inSecond + inThird");
    pure |(a, b, c)| (a * b + c,)
}

primitive! {
    /// `inFirst + inSecond * inThird`, with the product rounded. Created by the compiler.
    PLUS_PRODUCT = "Rpi::FusedPlusProduct";
    in { inFirst: f64; inSecond: f64; inThird: f64 }
    out { outValue: f64 }
    presence strict work 2;
    c Value("inFirst + inSecond * inThird");
    pure |(a, b, c)| (a + b * c,)
}

primitive! {
    /// `inFirst * inSecond - inThird`, with the product rounded. Created by the compiler.
    PRODUCT_MINUS = "Rpi::FusedProductMinus";
    in { inFirst: f64; inSecond: f64; inThird: f64 }
    out { outValue: f64 }
    presence strict work 2;
    c Value("inFirst * inSecond - inThird");
    pure |(a, b, c)| (a * b - c,)
}

primitive! {
    /// `inFirst - inSecond * inThird`, with the product rounded. Created by the compiler.
    MINUS_PRODUCT = "Rpi::FusedMinusProduct";
    in { inFirst: f64; inSecond: f64; inThird: f64 }
    out { outValue: f64 }
    presence strict work 2;
    c Value("inFirst - inSecond * inThird");
    pure |(a, b, c)| (a - b * c,)
}

primitive! {
    /// `(inFirst + inSecond) * inThird`, with the sum rounded. Created by the compiler.
    SUM_TIMES = "Rpi::FusedSumTimes";
    in { inFirst: f64; inSecond: f64; inThird: f64 }
    out { outValue: f64 }
    presence strict work 2;
    c Value("(inFirst + inSecond) * inThird");
    pure |(a, b, c)| ((a + b) * c,)
}

primitive! {
    /// `inFirst * (inSecond + inThird)`, with the sum rounded. Created by the compiler.
    TIMES_SUM = "Rpi::FusedTimesSum";
    in { inFirst: f64; inSecond: f64; inThird: f64 }
    out { outValue: f64 }
    presence strict work 2;
    c Value("inFirst * (inSecond + inThird)");
    pure |(a, b, c)| (a * (b + c),)
}

primitive! {
    /// `inThird` if `inFirst` is greater than `inSecond`, else `inFourth`. Created by the compiler.
    GREATER_CHOICE = "Rpi::FusedGreaterChoice";
    in { inFirst: f64; inSecond: f64; inThird: f64; inFourth: f64 }
    out { outValue: f64 }
    presence strict work 2;
    c Value("inFirst > inSecond ? inThird : inFourth");
    pure |(a, b, c, d)| (if a > b { c } else { d },)
}
