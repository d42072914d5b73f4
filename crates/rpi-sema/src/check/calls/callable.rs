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

/// Anything that a call or an iterator can apply to arguments, such as a node, a primitive or an operator.
#[derive(Clone, Debug)]
pub(crate) enum Callable {
    /// Declaration, with the static arguments given so far and the values of those ports that static arguments fix.
    Unit(DeclId, Rc<StaticBindings>, Rc<[(Name, FixedPortValue)]>),
    /// Primitive (basic operation) of the registry.
    Prim(PrimId),
    /// Operator of the expression syntax, such as `+`, or `if`.
    Op(StaticOp),
    /// Operator that is called by its Lustre V6 name, such as `Lustre::iplus`.
    Predefined(&'static PredefinedOp),
    /// Predeclared operator whose arguments have rules of their own, such as `hold`.
    Intrinsic(Intrinsic),
    /// Iterator over arrays, such as `map`, with the node that it applies and the size of the arrays.
    Iteration(Rc<IteratorCall>),
    /// Static parameter that stands for a node and has no value yet, so that only its declared ports are known.
    NodeParam(Rc<Header>),
}

/// Value that a static argument gives to an in-port of a callable.
#[derive(Clone, Debug)]
pub(crate) enum FixedPortValue {
    /// Value known at compile time.
    Constant(Constant),
    /// Value known when the command is loaded: an expression of the body that contains the callable.
    LoadTime(ExprId),
}

impl Callable {
    /// Returns the value of a port that is fixed only when the command is loaded; `None` if the callable has no such
    /// port. The value is an expression of the body that contains the callable.
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

    /// Returns the name of the callable with its static arguments, for messages.
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

    /// Returns the source text of a callable that has no declaration, such as `+` for an operator; empty for
    /// declarations and iterators.
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

    /// Appends text that distinguishes this callable from all others, for the keys under which checked instances are
    /// stored.
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
