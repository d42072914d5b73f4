//! Macros `primitive!` and `interface!`, which declare primitives.
//!
//! ```text
//! primitive! {
//!     /// Sum of two reals.
//!     DOUBLE_ADD = "Core::DoubleAdd";
//!     in { inFirst: f64 = First(Real(0.0)); inSecond: f64 = Second(Real(0.0)) }
//!     out { outValue: f64 }
//!     presence strict work 1;
//!     c Value("inFirst + inSecond");
//!     pure |(a, b)| (a + b,)
//! }
//! ```
//! In-ports: `name: type` must be connected. `= Param(Default)` names the parameter that replaces a missing connection.
//! `= absent` means that a missing connection counts as absent. `= [NEED]` is an explicit `Need` (a value from several
//! parameters). The optional clauses are `param { Name: type = Default }`, `state { types }`, `ring { size function }`,
//! `init function;` and `shape EXPR;` (lengths of array outputs, see [`rpi_image::Shape`]). Types are those of
//! [`crate::flow`], [`crate::bulk::Array`] and [`crate::bulk::Matrix`]; parameters may also be `Text`.
//!
//! Presence is one of `strict`, `if_all`, `if_any`, `always`, `maybe` (see [`rpi_image::Presence`]). The closure of a
//! strict primitive has values as arguments and results; other closures have options. `faults` after `work N` means
//! that a cycle may fault.
//!
//! The clause `c` is the same code as C text, see [`crate::c_code::CForm`]. A primitive without it does not compile.
//!
//! - `pure |inputs| outputs`: no state, no parameters.
//! - `full |cx, place, state, params, inputs| outputs`: `cx` provides slots and clocks and records faults
//!   (`cx.fault(code, place)`). The state is a tuple, or the `Region` of a `ring`.
//! - `bulk |cx, place, params, inputs, outputs| ()`: outputs are arrays or matrices, which the code writes itself. With
//!   presence `maybe`, it returns whether they are present.
//! - `mixed |cx, place, params, inputs, outputs| outputs`: as `bulk`, with single values among the outputs.
//!
//! `interface!` declares a primitive without code, which the core implements: devices, keys, delays, constants. A
//! `role` replaces the code. An out-port may have its own presence after its type (`outValue: f64 maybe`).

/// Declares a primitive with code as a constant of type [`crate::registry::Prim`]. The head of `macros.rs` describes
/// the syntax.
macro_rules! primitive {
    (
        $(#[doc = $doc:expr])+
        $id:ident = $name:expr;
        in { $( $in:ident : $ity:ty $( = $need:tt $( ( $($def:tt)+ ) )? )? );* $(;)? }
        $( param { $( $pn:ident : $pty:ty = $pd:expr );* $(;)? } )?
        out { $( $out:ident : $oty:ty );* $(;)? }
        $( state { $( $sty:ty ),* } )?
        $( ring { $ring:expr } )?
        $( init $init:expr; )?
        $( shape $shape:expr; )?
        presence $presence:ident work $work:literal $( $faults:ident )?;
        c $c:expr;
        $kind:ident $code:expr
    ) => {
        $(#[doc = $doc])+
        pub(crate) const $id: $crate::registry::Prim = $crate::registry::Prim {
            desc: ::rpi_image::PrimDesc {
                name: $name,
                doc: concat!($($doc, "\n"),+),
                inputs: &[ $( ::rpi_image::InPort {
                    name: stringify!($in),
                    ty: <$ity as $crate::operand::Port>::TYPE,
                    fallback: $crate::macros::need!($( $need $( ( $($def)+ ) )? )?),
                } ),* ],
                outputs: &[ $( ::rpi_image::OutPort {
                    name: stringify!($out),
                    ty: <$oty as $crate::operand::Port>::TYPE,
                    presence: $crate::macros::presence!($presence),
                } ),* ],
                params: $crate::macros::params!($( $( $pn : $pty = $pd );* )?),
                shape: $crate::macros::shape!($( $shape )?),
                state: $crate::macros::state!([$( $( $sty ),* )?] [$( $ring )?]),
                role: ::rpi_image::Role::Compute,
                work: $work,
                may_fault: $crate::macros::may_fault!($( $faults )?),
            },
            total: $crate::macros::total!($presence $kind, ($($ity,)*), ($( $($pty,)* )?), ($($oty,)*),
                $crate::macros::memory!([$( $( $sty ),* )?] [$( $ring )?]), $code),
            optional: $crate::macros::optional!($presence $kind, ($($ity,)*), ($( $($pty,)* )?), ($($oty,)*),
                $crate::macros::memory!([$( $( $sty ),* )?] [$( $ring )?]), $code),
            init: $crate::macros::init!($( $init )?),
            c: Some($crate::c_code::CCode {
                form: {
                    #[allow(unused_imports)]
                    use $crate::c_code::CForm::*;
                    $c
                },
                state: &[ $( $( <$sty as $crate::value_types::FlowType>::SCALAR ),* )? ],
            }),
        };
    };
}

/// Declares a primitive without code as a constant of type [`crate::registry::Prim`]: the core implements it according
/// to its role.
macro_rules! interface {
    (
        $(#[doc = $doc:expr])+
        $id:ident = $name:expr;
        in { $( $in:ident : $ity:ty $( = $need:tt $( ( $($def:tt)+ ) )? )? );* $(;)? }
        $( param { $( $pn:ident : $pty:ty = $pd:expr );* $(;)? } )?
        out { $( $out:ident : $oty:tt $( < $arg:ty > )? $( $own:ident )? );* $(;)? }
        $( shape $shape:expr; )?
        presence $presence:ident work $work:literal $( $faults:ident )?;
        role $role:expr
    ) => {
        $(#[doc = $doc])+
        pub(crate) const $id: $crate::registry::Prim = $crate::registry::Prim {
            desc: ::rpi_image::PrimDesc {
                name: $name,
                doc: concat!($($doc, "\n"),+),
                inputs: &[ $( ::rpi_image::InPort {
                    name: stringify!($in),
                    ty: <$ity as $crate::operand::Port>::TYPE,
                    fallback: $crate::macros::need!($( $need $( ( $($def)+ ) )? )?),
                } ),* ],
                outputs: &[ $( ::rpi_image::OutPort {
                    name: stringify!($out),
                    ty: <$oty $( < $arg > )? as $crate::operand::Port>::TYPE,
                    presence: $crate::macros::presence!($( $own )? $presence),
                } ),* ],
                params: $crate::macros::params!($( $( $pn : $pty = $pd );* )?),
                shape: $crate::macros::shape!($( $shape )?),
                state: ::rpi_image::StateSize::None,
                role: $role,
                work: $work,
                may_fault: $crate::macros::may_fault!($( $faults )?),
            },
            total: None,
            optional: None,
            init: None,
            c: None,
        };
    };
}

macro_rules! need {
    () => {
        ::rpi_image::Fallback::Required
    };
    (absent) => {
        ::rpi_image::Fallback::AbsentValue
    };
    ([ $composed:expr ]) => {
        $composed
    };
    ($par:ident ( $($def:tt)+ )) => {
        ::rpi_image::Fallback::Param(stringify!($par), {
            #[allow(unused_imports)]
            use ::rpi_image::PortDefault::*;
            $($def)+
        })
    };
}

macro_rules! params {
    ($( $pn:ident : $pty:ty = $pd:expr );*) => {
        &[ $( ::rpi_image::Param {
            name: stringify!($pn),
            ty: <$pty as $crate::operand::Parameter>::TYPE,
            default: {
                #[allow(unused_imports)]
                use ::rpi_image::PortDefault::*;
                $pd
            },
        } ),* ]
    };
}

macro_rules! presence {
    (strict $($rest:ident)?) => {
        ::rpi_image::Presence::Strict
    };
    (if_all $($rest:ident)?) => {
        ::rpi_image::Presence::IfAll
    };
    (if_any $($rest:ident)?) => {
        ::rpi_image::Presence::IfAny
    };
    (always $($rest:ident)?) => {
        ::rpi_image::Presence::Always
    };
    (maybe $($rest:ident)?) => {
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

macro_rules! shape {
    () => {
        ::rpi_image::ShapeRule::Fixed
    };
    ($shape:expr) => {
        $shape
    };
}

macro_rules! init {
    () => {
        None
    };
    ($init:expr) => {
        Some($init)
    };
}

macro_rules! state {
    ([] []) => {
        ::rpi_image::StateSize::None
    };
    ([ $($t:ty),+ ] []) => {
        ::rpi_image::StateSize::Fixed(<($($t,)+) as $crate::operand::PrimState>::SLOTS)
    };
    ([] [ $ring:expr ]) => {
        ::rpi_image::StateSize::Computed($ring)
    };
}

macro_rules! memory {
    ([ $($t:ty),* ] []) => { ($($t,)*) };
    ([] [ $ring:expr ]) => { $crate::aggregates::StateRange };
}

macro_rules! total {
    (maybe $($rest:tt)*) => {
        None
    };
    (strict pure, $i:ty, $p:ty, $o:ty, $s:ty, $code:expr) => {
        Some(|cx, words| $crate::dispatch::pure::<$i, $o>(cx, words, $code))
    };
    (strict full, $i:ty, $p:ty, $o:ty, $s:ty, $code:expr) => {
        Some(|cx, words| $crate::dispatch::with_context::<$i, $p, $o, $s>(cx, words, $code))
    };
    (strict bulk, $i:ty, $p:ty, $o:ty, $s:ty, $code:expr) => {
        Some(|cx, words| $crate::dispatch::bulk::<$i, $p, $o>(cx, words, $code))
    };
    (strict mixed, $i:ty, $p:ty, $o:ty, $s:ty, $code:expr) => {
        Some(|cx, words| $crate::dispatch::mixed::<$i, $p, $o>(cx, words, $code))
    };
    ($presence:ident pure, $i:ty, $p:ty, $o:ty, $s:ty, $code:expr) => {
        Some(|cx, words| $crate::dispatch::pure_present::<$i, $o>(cx, words, $code))
    };
    ($presence:ident full, $i:ty, $p:ty, $o:ty, $s:ty, $code:expr) => {
        Some(|cx, words| $crate::dispatch::full_present::<$i, $p, $o, $s>(cx, words, $code))
    };
}

macro_rules! optional {
    (strict $($rest:tt)*) => {
        None
    };
    (maybe bulk, $i:ty, $p:ty, $o:ty, $s:ty, $code:expr) => {
        Some(|cx, words| {
            $crate::dispatch::bulk_maybe::<<$i as $crate::operand::PortTuple>::Options, $p, $o>(
                cx, words, $code,
            )
        })
    };
    ($presence:ident pure, $i:ty, $p:ty, $o:ty, $s:ty, $code:expr) => {
        Some(|cx, words| {
            $crate::dispatch::pure::<
                <$i as $crate::operand::PortTuple>::Options,
                <$o as $crate::operand::PortTuple>::Options,
            >(cx, words, $code)
        })
    };
    ($presence:ident full, $i:ty, $p:ty, $o:ty, $s:ty, $code:expr) => {
        Some(|cx, words| {
            $crate::dispatch::with_context::<
                <$i as $crate::operand::PortTuple>::Options,
                $p,
                <$o as $crate::operand::PortTuple>::Options,
                $s,
            >(cx, words, $code)
        })
    };
}

pub(crate) use {
    init, interface, may_fault, memory, need, optional, params, presence, primitive, shape, state,
    total,
};
