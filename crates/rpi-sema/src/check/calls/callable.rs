//! Callables: declarations with their static arguments, primitives, operators, and iterators.

use crate::check::Constant;
use crate::check::calls::intrinsics::Intrinsic;
use crate::check::calls::iterate::IteratorCall;
use crate::check::calls::predefined_ops::PredefinedOp;
use crate::check::signatures::header::Header;
use crate::check::signatures::instance::instance_key;
use crate::check::signatures::instance::instance_name;
use crate::check::signatures::static_args::StaticBindings;
use crate::check::signatures::static_params::static_params_of;
use crate::program::{DeclId, Program};
use crate::typed::ExprId;
use rpi_prims::PrimId;
use rpi_syntax::Name;
use rpi_syntax::ast::StaticOp;
use std::rc::Rc;

/// Callable: what a call or an iterator applies, such as a node, a primitive or an operator.
#[derive(Clone, Debug)]
pub(crate) enum Callable {
    /// Declaration with the static arguments given so far and the values of fixed ports.
    Unit(DeclId, Rc<StaticBindings>, Rc<[(Name, FixedPortValue)]>),
    /// Registered primitive.
    Prim(PrimId),
    /// Operator.
    Op(StaticOp),
    /// Operator called by name, such as `Lustre::iplus`.
    Predefined(&'static PredefinedOp),
    /// Predeclared operator with its own checks.
    Intrinsic(Intrinsic),
    /// Iterator with its callee and size.
    Iteration(Rc<IteratorCall>),
    /// Node parameter without a value: only its ports are known.
    NodeParam(Rc<Header>),
}

/// Value of a port that a static argument fixes.
#[derive(Clone, Debug)]
pub(crate) enum FixedPortValue {
    /// Value known at compile time.
    Constant(Constant),
    /// Value known when the command is loaded: an expression of the body that contains the callable.
    LoadTime(ExprId),
}

impl Callable {
    /// Returns a fixed value that is only known in the body that contains the callable.
    pub(crate) fn load_time_value(&self) -> Option<ExprId> {
        match self {
            Callable::Unit(_, _, fixed) => fixed.iter().find_map(|(_, fixed)| match fixed {
                FixedPortValue::LoadTime(value) => Some(*value),
                FixedPortValue::Constant(_) => None,
            }),
            Callable::Iteration(iteration) => iteration.resolve_callee()?.load_time_value(),
            _ => None,
        }
    }

    /// Returns the name for messages.
    pub(crate) fn name(&self, program: &Program<'_>) -> String {
        match self {
            Callable::Unit(id, statics, _) => {
                let decl = program.decl(*id);
                instance_name(program, &decl.name, &static_params_of(decl.kind), statics)
                    .to_string()
            }
            Callable::Iteration(iteration) => iteration.name(program),
            other => other.source_text(),
        }
    }

    /// Returns the source text of a callable that has no declaration; empty for declarations and iterators.
    pub(crate) fn source_text(&self) -> String {
        match self {
            Callable::Prim(prim) => prim.desc().name.to_owned(),
            Callable::Op(StaticOp::Unary(op)) => op.spelling().to_owned(),
            Callable::Op(StaticOp::Binary(op)) => op.spelling().to_owned(),
            Callable::Op(StaticOp::If) => "if".to_owned(),
            Callable::Predefined(predef) => predef.name(),
            Callable::Intrinsic(special) => special.name().to_owned(),
            Callable::NodeParam(header) => header.name.to_string(),
            Callable::Unit(..) | Callable::Iteration(_) => String::new(),
        }
    }

    /// Appends the text that distinguishes this callable from others in keys of instances.
    pub(crate) fn write_key(&self, out: &mut String) {
        match self {
            Callable::Unit(id, statics, fixed) => {
                out.push_str(&instance_key(*id, statics));
                for (name, fixed) in &**fixed {
                    out.push_str(&format!(",{name}={fixed:?}"));
                }
            }
            Callable::Iteration(iteration) => iteration.write_key(out),
            other => out.push_str(&other.source_text()),
        }
    }
}
