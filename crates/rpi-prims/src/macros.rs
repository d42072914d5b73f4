//! `primitive!`: the one place in which a primitive is declared.
//!
//! ```text
//! primitive! {
//!     /// Sum of two reals.
//!     DOUBLE_ADD = "Core::DoubleAdd";
//!     in { inFirst: f64 = First(Real(0.0)); inSecond: f64 = Second(Real(0.0)) }
//!     out { outValue: f64 }
//!     presence strict work 1;
//!     pure |(a, b)| (a + b,)
//! }
//! ```
//! In-ports: `name: type` must be connected; `= Param(Default)` names the parameter that stands in for a missing
//! connection; `= absent` counts as absent. `param { Name: type = Default }` and `state { types }` come where they exist.
//!
//! Presence is one of `strict`, `if_all`, `if_any`, `always`, `maybe` (see [`rpi_image::Presence`]). The closure of a
//! strict primitive sees values; of the others it sees and gives options.
//!
//! `pure |inputs| outputs` is for code without state and parameters;
//! `full |cx, place, state, params, inputs| outputs` for the rest: `cx` has clocks and takes faults (`cx.fault(code, place)`).

/// Declares one primitive as a constant of type [`crate::registry::Prim`]; the module text tells the form.
macro_rules! primitive {
    (
        $(#[doc = $doc:literal])+
        $id:ident = $name:expr;
        in { $( $in:ident : $ity:ty $( = $par:ident $( ( $($def:tt)+ ) )? )? );* $(;)? }
        $( param { $( $pn:ident : $pty:ty = $pd:expr );* $(;)? } )?
        out { $( $out:ident : $oty:ty );* $(;)? }
        $( state { $( $sty:ty ),* } )?
        presence $presence:ident work $work:literal $( $faults:ident )?;
        $kind:ident $code:expr
    ) => {
        $(#[doc = $doc])+
        pub(crate) const $id: $crate::registry::Prim = $crate::registry::Prim {
            desc: ::rpi_image::PrimDesc {
                name: $name,
                doc: concat!($($doc, "\n"),+),
                inputs: &[ $( ::rpi_image::InPort {
                    name: stringify!($in),
                    ty: ::rpi_image::PortType::One(<$ity as $crate::operand::Flow>::SCALAR),
                    need: $crate::macros::need!($( $par $( ( $($def)+ ) )? )?),
                } ),* ],
                outputs: &[ $( ::rpi_image::OutPort {
                    name: stringify!($out),
                    ty: ::rpi_image::PortType::One(<$oty as $crate::operand::Flow>::SCALAR),
                    presence: $crate::macros::presence!($presence),
                } ),* ],
                params: &[ $( $( ::rpi_image::Param {
                    name: stringify!($pn),
                    ty: ::rpi_image::ParamType::One(<$pty as $crate::operand::Flow>::SCALAR),
                    default: { #[allow(unused_imports)] use ::rpi_image::PortDefault::*; $pd },
                } ),* )? ],
                state: $crate::macros::state!($( $( $sty ),* )?),
                role: ::rpi_image::Role::Compute,
                work: $work,
                may_fault: $crate::macros::may_fault!($( $faults )?),
            },
            total: $crate::macros::total!($presence $kind, ($($ity,)*), ($( $($pty,)* )?), ($($oty,)*), ($( $($sty,)* )?), $code),
            optional: $crate::macros::optional!($presence $kind, ($($ity,)*), ($( $($pty,)* )?), ($($oty,)*), ($( $($sty,)* )?), $code),
            init: None,
        };
    };
}

macro_rules! need {
    () => {
        ::rpi_image::Need::Required
    };
    (absent) => {
        ::rpi_image::Need::Absent
    };
    ($par:ident ( $($def:tt)+ )) => {
        ::rpi_image::Need::Param(stringify!($par), {
            #[allow(unused_imports)]
            use ::rpi_image::PortDefault::*;
            $($def)+
        })
    };
}

macro_rules! presence {
    (strict) => {
        ::rpi_image::Presence::Strict
    };
    (if_all) => {
        ::rpi_image::Presence::IfAll
    };
    (if_any) => {
        ::rpi_image::Presence::IfAny
    };
    (always) => {
        ::rpi_image::Presence::Always
    };
    (maybe) => {
        ::rpi_image::Presence::Maybe
    };
}

macro_rules! may_fault {
    () => {
        false
    };
    (faults) => {
        true
    };
}

macro_rules! state {
    () => { ::rpi_image::State::None };
    ($($t:ty),+) => { ::rpi_image::State::Cells(0 $( + <$t as $crate::operand::Flow>::SCALAR.cells() )+) };
}

macro_rules! total {
    (maybe $($rest:tt)*) => {
        None
    };
    (strict pure, $i:ty, $p:ty, $o:ty, $s:ty, $code:expr) => {
        Some(|cx, words| $crate::run::pure::<$i, $o>(cx, words, $code))
    };
    (strict full, $i:ty, $p:ty, $o:ty, $s:ty, $code:expr) => {
        Some(|cx, words| $crate::run::full::<$i, $p, $o, $s>(cx, words, $code))
    };
    ($presence:ident pure, $i:ty, $p:ty, $o:ty, $s:ty, $code:expr) => {
        Some(|cx, words| $crate::run::pure_present::<$i, $o>(cx, words, $code))
    };
    ($presence:ident full, $i:ty, $p:ty, $o:ty, $s:ty, $code:expr) => {
        Some(|cx, words| $crate::run::full_present::<$i, $p, $o, $s>(cx, words, $code))
    };
}

macro_rules! optional {
    (strict $($rest:tt)*) => {
        None
    };
    ($presence:ident pure, $i:ty, $p:ty, $o:ty, $s:ty, $code:expr) => {
        Some(|cx, words| {
            $crate::run::pure::<
                <$i as $crate::operand::Row>::Maybe,
                <$o as $crate::operand::Row>::Maybe,
            >(cx, words, $code)
        })
    };
    ($presence:ident full, $i:ty, $p:ty, $o:ty, $s:ty, $code:expr) => {
        Some(|cx, words| {
            $crate::run::full::<
                <$i as $crate::operand::Row>::Maybe,
                $p,
                <$o as $crate::operand::Row>::Maybe,
                $s,
            >(cx, words, $code)
        })
    };
}

pub(crate) use {may_fault, need, optional, presence, primitive, state, total};
