//! What can be called: declarations with what is fixed of them, primitives, operators, iterators.

use super::Constant;
use super::header::Header;
use super::instance::{display, key};
use super::iterate::Iteration;
use super::predef::Predef;
use super::special::Special;
use super::statics::{Statics, params_of};
use crate::program::{DeclId, Program};
use crate::typed::ExprId;
use rpi_prims::PrimId;
use rpi_syntax::Name;
use rpi_syntax::ast::StaticOp;
use std::rc::Rc;

/// Something that can be called, or passed to an iterator.
#[derive(Clone, Debug)]
pub(super) enum Callable {
    /// A declaration, with the static arguments given so far and values for its ports.
    Unit(DeclId, Rc<Statics>, Rc<[(Name, Fixed)]>),
    /// A registered primitive.
    Prim(PrimId),
    /// An operator.
    Op(StaticOp),
    /// An operator by name.
    Predef(&'static Predef),
    /// A predeclared operator.
    Special(Special),
    /// An iterator with what it iterates.
    Iteration(Rc<Iteration>),
    /// A node that nobody has given yet: only its ports are known.
    Open(Rc<Header>),
}

/// What a port of something to call is given with its static arguments.
#[derive(Clone, Debug)]
pub(super) enum Fixed {
    /// A value that is known when the program is checked.
    Constant(Constant),
    /// One that is known when the command is loaded: an expression of the body in which this stands.
    Loaded(ExprId),
}

impl Callable {
    /// A value that it is given and that only the body knows in which it stands.
    pub(super) fn loaded(&self) -> Option<ExprId> {
        match self {
            Callable::Unit(_, _, fixed) => fixed.iter().find_map(|(_, fixed)| match fixed {
                Fixed::Loaded(value) => Some(*value),
                Fixed::Constant(_) => None,
            }),
            Callable::Iteration(iteration) => iteration.callee()?.loaded(),
            _ => None,
        }
    }

    /// What it is called in messages.
    pub(super) fn name(&self, program: &Program<'_>) -> String {
        match self {
            Callable::Unit(id, statics, _) => {
                let decl = program.decl(*id);
                display(program, &decl.name, &params_of(decl.kind), statics).to_string()
            }
            Callable::Iteration(iteration) => iteration.name(program),
            other => other.spelling(),
        }
    }

    /// How something that is there without a declaration is written.
    pub(super) fn spelling(&self) -> String {
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

    pub(super) fn write_key(&self, out: &mut String) {
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
