//! Definitions: everything that a program gives a name.

use rpi_diag::Span;
use rpi_syntax::Name;
use rpi_syntax::ast::Doc;

/// Index of a definition.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Debug)]
pub struct DefId(pub u32);

/// A name that a program gives a meaning.
#[derive(Clone, Debug)]
pub struct Def {
    /// The name.
    pub name: Name,
    /// What it is.
    pub kind: DefKind,
    /// Where the name is declared.
    pub span: Span,
    /// The whole declaration.
    pub whole: Span,
    /// What was written above it.
    pub doc: Option<Doc>,
    /// What it stands in.
    pub parent: Option<DefId>,
    /// Where its type is written, if it is.
    pub ty: Option<Span>,
    /// The definition whose members it has: a device's type, a struct, what an equation calls.
    pub shape: Option<DefId>,
}

/// What a definition is.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Debug)]
pub enum DefKind {
    /// A file, as `use` names it.
    Module,
    /// `const`
    Const,
    /// `type`
    Type,
    /// A value of an enum.
    EnumValue,
    /// A field of a struct.
    Field,
    /// `node`
    Node,
    /// `function`
    Function,
    /// `fragment`, declared by itself.
    Fragment,
    /// `primitive`
    Primitive,
    /// `device`
    Device,
    /// A port of a device.
    Port,
    /// `frame`
    Frame,
    /// `command`
    Command,
    /// A result by which a command ends.
    Result,
    /// `task`
    Task,
    /// A named step of a task.
    Step,
    /// `test`
    Test,
    /// A static parameter.
    Static,
    /// A parameter of a command or task.
    Param,
    /// An in-port.
    Input,
    /// Taken over from the predecessor.
    Given,
    /// An out-port.
    Output,
    /// A flow inside a body.
    Local,
    /// A fragment in place.
    Block,
    /// A state of an automaton.
    State,
}

/// The table of kinds: what each is called.
const WORDS: &[(DefKind, &str)] = &[
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
    (DefKind::Static, "static parameter"),
    (DefKind::Param, "parameter"),
    (DefKind::Input, "in-port"),
    (DefKind::Given, "given value"),
    (DefKind::Output, "out-port"),
    (DefKind::Local, "flow"),
    (DefKind::Block, "fragment in place"),
    (DefKind::State, "state"),
];

impl DefKind {
    /// What it is called.
    #[must_use]
    pub fn word(self) -> &'static str {
        WORDS[self as usize].1
    }

    /// Whether it can be called.
    #[must_use]
    pub fn is_callable(self) -> bool {
        use DefKind::{Fragment, Function, Node, Primitive};
        matches!(self, Node | Function | Fragment | Primitive)
    }

    /// Whether it has a value in a cycle or when a command is loaded.
    #[must_use]
    pub fn is_value(self) -> bool {
        use DefKind::{Const, Field, Given, Input, Local, Output, Param, Port, Static};
        matches!(
            self,
            Const | Field | Port | Static | Param | Input | Given | Output | Local
        )
    }

    /// Whether a call may give it by its name.
    #[must_use]
    pub fn is_parameter(self) -> bool {
        use DefKind::{Given, Input, Param, Static};
        matches!(self, Static | Param | Input | Given)
    }

    /// Whether it is read as `parent.name`.
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
        for (k, (kind, _)) in WORDS.iter().enumerate() {
            assert_eq!(*kind as usize, k);
        }
        assert_eq!(DefKind::State.word(), "state");
    }
}
