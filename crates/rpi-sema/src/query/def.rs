//! Definitions: everything that has a name in a program.

use rpi_diag::Span;
use rpi_syntax::Name;
use rpi_syntax::ast::Doc;

/// Identifies a definition of the program by its index.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Debug)]
pub struct DefId(pub u32);

/// Declaration or definition of a name, as editors and the reference see it.
#[derive(Clone, Debug)]
pub struct Def {
    /// Name as the declaration writes it.
    pub name: Name,
    /// Whether the definition is a node, a flow, a type or something else.
    pub kind: DefKind,
    /// Span of the name in the declaration.
    pub span: Span,
    /// Span of the whole declaration, with its body.
    pub full_span: Span,
    /// Doc comment above the declaration.
    pub doc: Option<Doc>,
    /// Enclosing definition.
    pub parent: Option<DefId>,
    /// Span of the declared type, if there is one.
    pub ty: Option<Span>,
    /// Definition whose members this one has: a device type, a struct, or the callee of an equation.
    pub shape: Option<DefId>,
}

/// Kinds of definitions that editors distinguish by colour and icon.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Debug)]
pub enum DefKind {
    /// Module: a file, as named by `use`.
    Module,
    /// Constant, declared by `const`.
    Const,
    /// Type, declared by `type`.
    Type,
    /// One of the named values of an enum.
    EnumValue,
    /// Field of a struct.
    Field,
    /// Node, declared by `node`.
    Node,
    /// Function, declared by `function`.
    Function,
    /// `fragment` declared at the top level.
    Fragment,
    /// Primitive, declared by `primitive`.
    Primitive,
    /// Device type, declared by `device`.
    Device,
    /// Port of a device.
    Port,
    /// Coordinate frame, declared by `frame`.
    Frame,
    /// Command, declared by `command`.
    Command,
    /// Result with which a command ends.
    Result,
    /// Task, declared by `task`.
    Task,
    /// Named step of a task.
    Step,
    /// Test, declared by `test`.
    Test,
    /// Static parameter, in `<<...>>`.
    StaticParam,
    /// Parameter of a command or task.
    Param,
    /// In-port.
    Input,
    /// Value taken over from the preceding command.
    TakenOver,
    /// Out-port.
    Output,
    /// Flow inside a body.
    Local,
    /// Fragment declared inside a body.
    Block,
    /// State of an automaton.
    State,
}

/// Names of the kinds, in the order of the variants.
const KIND_NAMES: &[(DefKind, &str)] = &[
    (DefKind::Module, "module"),
    (DefKind::Const, "constant"),
    (DefKind::Type, "type"),
    (DefKind::EnumValue, "value of an enum"),
    (DefKind::Field, "field"),
    (DefKind::Node, "node"),
    (DefKind::Function, "function"),
    (DefKind::Fragment, "fragment"),
    (DefKind::Primitive, "primitive"),
    (DefKind::Device, "device type"),
    (DefKind::Port, "port"),
    (DefKind::Frame, "frame"),
    (DefKind::Command, "command"),
    (DefKind::Result, "result"),
    (DefKind::Task, "task"),
    (DefKind::Step, "step"),
    (DefKind::Test, "test"),
    (DefKind::StaticParam, "static parameter"),
    (DefKind::Param, "parameter"),
    (DefKind::Input, "in-port"),
    (DefKind::TakenOver, "given value"),
    (DefKind::Output, "out-port"),
    (DefKind::Local, "flow"),
    (DefKind::Block, "fragment in place"),
    (DefKind::State, "state"),
];

impl DefKind {
    /// Returns the kind in words.
    #[must_use]
    pub fn description(self) -> &'static str {
        KIND_NAMES[self as usize].1
    }

    /// Returns whether definitions of this kind can be called.
    #[must_use]
    pub fn is_callable(self) -> bool {
        use DefKind::{Fragment, Function, Node, Primitive};
        matches!(self, Node | Function | Fragment | Primitive)
    }

    /// Returns whether definitions of this kind have a value, in a cycle or when a command is loaded.
    #[must_use]
    pub fn is_declared_value(self) -> bool {
        use DefKind::{Const, Field, Input, Local, Output, Param, Port, StaticParam, TakenOver};
        matches!(
            self,
            Const | Field | Port | StaticParam | Param | Input | TakenOver | Output | Local
        )
    }

    /// Returns whether definitions of this kind can be named arguments of a call.
    #[must_use]
    pub fn is_parameter(self) -> bool {
        use DefKind::{Input, Param, StaticParam, TakenOver};
        matches!(self, StaticParam | Param | Input | TakenOver)
    }

    /// Returns whether definitions of this kind can be read as `parent.name`.
    #[must_use]
    pub fn is_member_of(self, parent: DefKind) -> bool {
        use DefKind::{Block, Command, Device, Field, Local, Output, Port, Result, State, Type};
        match parent {
            Block | State => matches!(self, Local | Output | Block | State),
            Type => self == Field,
            Device => self == Port,
            Command => self == Result,
            parent => parent.is_callable() && self == Output,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_stand_in_the_order_of_the_kinds() {
        for (k, (kind, _)) in KIND_NAMES.iter().enumerate() {
            assert_eq!(*kind as usize, k);
        }
        assert_eq!(DefKind::State.description(), "state");
    }
}
