//! Definitions: everything that has a name in a program.

use rpi_diag::Span;
use rpi_syntax::Name;
use rpi_syntax::ast::Doc;

/// Number of a definition in the index of all definitions of a program.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Debug)]
pub struct DefId(pub u32);

/// Definition of a name in a program, as editors and generated documentation see it.
#[derive(Clone, Debug)]
pub struct Def {
    /// Name as the declaration writes it.
    pub name: Name,
    /// Kind of the definition, such as node, flow or type.
    pub kind: DefKind,
    /// Span of the name in the declaration.
    pub span: Span,
    /// Span of the whole declaration, including its body.
    pub full_span: Span,
    /// Doc comment above the declaration, if there is one.
    pub doc: Option<Doc>,
    /// Definition that contains this one; `None` for a module.
    pub parent: Option<DefId>,
    /// Span of the declared type; `None` if the declaration has none.
    pub ty: Option<Span>,
    /// Definition whose members this definition has, such as its struct or device type, or the callee of its equation;
    /// `None` if there is none.
    pub shape: Option<DefId>,
}

/// Kinds of definitions that editors distinguish by colour and icon.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Debug)]
pub enum DefKind {
    /// Module: a source file, as named by `use`.
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
    /// Fragment declared at the top level of a module, by `fragment`.
    Fragment,
    /// Primitive, declared by `primitive`.
    Primitive,
    /// Device type, declared by `device`.
    Device,
    /// Actuator or sensor port of a device.
    Port,
    /// Coordinate frame, declared by `frame`.
    Frame,
    /// Command, declared by `command`.
    Command,
    /// Named result with which a command can end.
    Result,
    /// Task, declared by `task`.
    Task,
    /// Named step of a task.
    Step,
    /// Test, declared by `test`.
    Test,
    /// Static parameter, declared in `<<...>>`.
    StaticParam,
    /// Parameter of a command or task.
    Param,
    /// In-port of a node, function, fragment or primitive.
    Input,
    /// Value that a command takes over from the preceding command, declared by `given`.
    TakenOver,
    /// Out-port of a node, function, fragment or primitive.
    Output,
    /// Local flow inside of a body.
    Local,
    /// Fragment that is written inside of a body.
    Block,
    /// State of an automaton.
    State,
}

/// Names of the kinds of definitions in words, in the order of the variants.
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
    /// Returns the name of the kind in words, such as "device type".
    #[must_use]
    pub fn description(self) -> &'static str {
        KIND_NAMES[self as usize].1
    }

    /// Returns whether definitions of this kind can be called, such as nodes and primitives.
    #[must_use]
    pub fn is_callable(self) -> bool {
        use DefKind::{Fragment, Function, Node, Primitive};
        matches!(self, Node | Function | Fragment | Primitive)
    }

    /// Returns whether definitions of this kind have a value, in each cycle or from the time when a command is loaded.
    #[must_use]
    pub fn is_declared_value(self) -> bool {
        use DefKind::{Const, Field, Input, Local, Output, Param, Port, StaticParam, TakenOver};
        matches!(
            self,
            Const | Field | Port | StaticParam | Param | Input | TakenOver | Output | Local
        )
    }

    /// Returns whether definitions of this kind can be passed by name in a call: static parameters, parameters and
    /// in-ports.
    #[must_use]
    pub fn is_parameter(self) -> bool {
        use DefKind::{Input, Param, StaticParam, TakenOver};
        matches!(self, StaticParam | Param | Input | TakenOver)
    }

    /// Returns whether definitions of this kind are members of a definition of the kind `parent`, read as
    /// `parent.name`.
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
