//! Callables: declarations with their static arguments, primitives, operators, and iterators.

use crate::check::Constant;
use crate::check::calls::intrinsics::Special;
use crate::check::calls::iterate::Iteration;
use crate::check::calls::predefined_ops::Predef;
use crate::check::signatures::header::Header;
use crate::check::signatures::instance::display;
use crate::check::signatures::instance::key;
use crate::check::signatures::static_args::Statics;
use crate::check::signatures::static_params::params_of;
use crate::program::{DeclId, Program};
use crate::typed::ExprId;
use rpi_prims::PrimId;
use rpi_syntax::Name;
use rpi_syntax::ast::StaticOp;
use std::rc::Rc;

/// Callable: the target of a call, or an argument of an iterator.
#[derive(Clone, Debug)]
pub(crate) enum Callable {
    /// Declaration with its static arguments so far and the values of fixed ports.
    Unit(DeclId, Rc<Statics>, Rc<[(Name, Fixed)]>),
    /// Registered primitive.
    Prim(PrimId),
    /// Operator.
    Op(StaticOp),
    /// Operator called by name, such as `Lustre::iplus`.
    Predef(&'static Predef),
    /// Predeclared operator with its own checks.
    Special(Special),
    /// Iterator with its callee and size.
    Iteration(Rc<Iteration>),
    /// Node parameter without a value: only its ports are known.
    Open(Rc<Header>),
}

/// Value of a port that a static argument fixes.
#[derive(Clone, Debug)]
pub(crate) enum Fixed {
    /// Value known at compile time.
    Constant(Constant),
    /// Value known when the command is loaded: an expression of the body that contains the callable.
    Loaded(ExprId),
}

impl Callable {
    /// Returns a fixed value that is only known in the body that contains the callable.
    pub(crate) fn loaded(&self) -> Option<ExprId> {
        match self {
            Callable::Unit(_, _, fixed) => fixed.iter().find_map(|(_, fixed)| match fixed {
                Fixed::Loaded(value) => Some(*value),
                Fixed::Constant(_) => None,
            }),
            Callable::Iteration(iteration) => iteration.callee()?.loaded(),
            _ => None,
        }
    }

    /// Returns the name for messages.
    pub(crate) fn name(&self, program: &Program<'_>) -> String {
        match self {
            Callable::Unit(id, statics, _) => {
                let decl = program.decl(*id);
                display(program, &decl.name, &params_of(decl.kind), statics).to_string()
            }
            Callable::Iteration(iteration) => iteration.name(program),
            other => other.spelling(),
        }
    }

    /// Returns the source text of a callable that has no declaration; empty for declarations and iterators.
    pub(crate) fn spelling(&self) -> String {
        match self {
            Callable::Prim(prim) => prim.desc().name.to_owned(),
            Callable::Op(StaticOp::Unary(op)) => op.spelling().to_owned(),
            Callable::Op(StaticOp::Binary(op)) => op.spelling().to_owned(),
            Callable::Op(StaticOp::If) => "if".to_owned(),
            Callable::Predef(predef) => predef.name(),
            Callable::Special(special) => special.name().to_owned(),
            Callable::Open(header) => header.name.to_string(),
            Callable::Unit(..) | Callable::Iteration(_) => String::new(),
        }
    }

    /// Appends the text that distinguishes this callable from others in keys of instances.
    pub(crate) fn write_key(&self, out: &mut String) {
        match self {
            Callable::Unit(id, statics, fixed) => {
                out.push_str(&key(*id, statics));
                for (name, fixed) in &**fixed {
                    out.push_str(&format!(",{name}={fixed:?}"));
                }
            }
            Callable::Iteration(iteration) => iteration.write_key(out),
            other => out.push_str(&other.spelling()),
        }
    }
}
