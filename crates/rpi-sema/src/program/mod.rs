//! The declarations of all modules of a program, and how names find them.
//!
//! A module is one file, with the files that it includes. Its own names come before those of the modules that it uses, which come in the order of their `use`,
//! and these before the
//! modules that are there without being used. This part knows which declarations there are; it must not know what they mean.

mod collect;
mod lookup;

pub(crate) use collect::twice;

pub use lookup::Lookup;

use crate::hash::Map;
use rpi_diag::Span;
use rpi_syntax::ast::{
    CommandDecl, ConstDef, DeclaredKind, DeviceDecl, Doc, File, FragmentDecl, FrameDecl, Item,
    ItemKind, NodeDecl, NodeKind, PrimitiveDecl, TaskDecl, TestDecl, TypeDef,
};
use rpi_syntax::{Mode, Name};
use std::cell::{Cell, RefCell};
use std::collections::BTreeMap;

/// The texts of one module, parsed.
#[derive(Clone, Debug)]
pub struct Source<'a> {
    /// The name by which `use` finds it.
    pub name: Name,
    /// Which words its file knows; one that is included may know others.
    pub mode: Mode,
    /// The file, then those that it includes.
    pub files: Vec<&'a File>,
    /// Whether every `.rpi` module uses it without saying so.
    pub implicit: bool,
}

/// Index of a module in [`Program::modules`].
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Debug)]
pub struct ModuleId(pub u32);

/// Index of a declaration in [`Program::decls`].
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Debug)]
pub struct DeclId(pub u32);

/// A declaration with a name.
#[derive(Clone, Debug)]
pub struct Decl<'a> {
    /// Its name.
    pub name: Name,
    /// Where the name stands.
    pub span: Span,
    /// What was written above it.
    pub doc: Option<&'a Doc>,
    /// The module it stands in.
    pub module: ModuleId,
    /// Which words its file knows.
    pub mode: Mode,
    /// What it is.
    pub kind: DeclKind<'a>,
}

/// The kinds of declarations.
#[derive(Clone, Copy, Debug)]
pub enum DeclKind<'a> {
    /// A constant.
    Const(&'a ConstDef),
    /// A type.
    Type(&'a TypeDef),
    /// A value of an enum.
    EnumValue {
        /// The enum.
        ty: DeclId,
        /// Its place among the values.
        index: u32,
    },
    /// An alternative of a `datatype`.
    Constructor {
        /// The type.
        ty: DeclId,
        /// Its place among the alternatives.
        index: u32,
    },
    /// A node or function.
    Node(&'a NodeDecl),
    /// A fragment.
    Fragment(&'a FragmentDecl),
    /// The signature of a registered primitive, with units and frames.
    Primitive(&'a PrimitiveDecl),
    /// A device type.
    Device(&'a DeviceDecl),
    /// A coordinate frame.
    Frame(&'a FrameDecl),
    /// A command.
    Command(&'a CommandDecl),
    /// A task.
    Task(&'a TaskDecl),
    /// A test; its title is no name that others could use.
    Test(&'a TestDecl),
    /// Something that did not parse: its name is known, so that nobody complains about it.
    Broken(DeclaredKind),
}

impl DeclKind<'_> {
    /// What it is, in words, with its article.
    #[must_use]
    pub fn what(&self) -> &'static str {
        match self {
            DeclKind::Const(_) | DeclKind::Broken(DeclaredKind::Const) => "a constant",
            DeclKind::Type(_) | DeclKind::Broken(DeclaredKind::Type) => "a type",
            DeclKind::EnumValue { .. } => "a value of an enum",
            DeclKind::Constructor { .. } => "an alternative of a datatype",
            DeclKind::Node(_) | DeclKind::Broken(DeclaredKind::Callable) => "a node",
            DeclKind::Fragment(_) => "a fragment",
            DeclKind::Primitive(_) => "a primitive",
            DeclKind::Device(_) | DeclKind::Broken(DeclaredKind::Device) => "a device type",
            DeclKind::Frame(_) | DeclKind::Broken(DeclaredKind::Frame) => "a frame",
            DeclKind::Command(_) | DeclKind::Broken(DeclaredKind::Command) => "a command",
            DeclKind::Task(_) | DeclKind::Broken(DeclaredKind::Task) => "a task",
            DeclKind::Test(_) => "a test",
        }
    }
}

/// A module that another one says to use.
#[derive(Debug)]
struct Use {
    module: ModuleId,
    /// Where its name stands, and the whole phrase.
    name: Span,
    phrase: Span,
    /// Whether a name has been found in it.
    found: Cell<bool>,
}

/// A module.
#[derive(Debug)]
pub struct Module {
    /// Its name.
    pub name: Name,
    /// Which words its files know.
    pub mode: Mode,
    /// Its declarations in text order.
    pub decls: Vec<DeclId>,
    /// The modules that it uses, in text order.
    uses: Vec<Use>,
    /// Whether it says to use a module that is not there, so that names may be missing for that alone.
    pub lacks_use: bool,
    names: Map<Name, DeclId>,
    /// In Lustre, what each kind of place looks for: a type and a node may have one name.
    spaces: [Map<Name, DeclId>; Space::COUNT],
}

/// What a place in a program looks for. In Lustre each has names of its own.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Space {
    /// Constants and values of enums.
    Value,
    /// Types.
    Type,
    /// Nodes and functions.
    Callable,
    /// Contracts.
    Contract,
}

impl Space {
    const COUNT: usize = 4;

    /// Where a declaration is looked for.
    fn of(kind: &DeclKind<'_>) -> Space {
        match kind {
            DeclKind::Type(_) | DeclKind::Device(_) | DeclKind::Broken(DeclaredKind::Type) => {
                Space::Type
            }
            DeclKind::Node(node) if node.kind == NodeKind::Contract => Space::Contract,
            DeclKind::Node(_) | DeclKind::Broken(DeclaredKind::Callable) => Space::Callable,
            _ => Space::Value,
        }
    }
}

/// All declarations of a program.
#[derive(Debug)]
pub struct Program<'a> {
    /// The modules; the first is the one that was asked for.
    pub modules: Vec<Module>,
    /// The declarations of all modules.
    pub decls: Vec<Decl<'a>>,
    /// The modules that every `.rpi` module uses without saying so.
    implicit: Vec<ModuleId>,
    /// What has been found in two modules: where the first one is named and what it is, and where the other is named.
    clashes: RefCell<BTreeMap<(Span, Name), Span>>,
    /// What could be used, for what it would have declared.
    pub library: Library,
    /// Where its declarations stand, whole, in the order of the files.
    pub extents: Vec<Extent>,
}

/// Where a declaration stands.
#[derive(Clone, Copy, Debug)]
pub struct Extent {
    /// All of it.
    pub span: Span,
    /// Whether it is of something that becomes units, so that what is wrong in it is wrong in these alone.
    pub is_of_units: bool,
}

impl Extent {
    fn of(item: &Item) -> Extent {
        use ItemKind::{Broken, Command, Fragment, Node, Primitive, Task, Test};
        let is_of_units = matches!(
            item.kind,
            Broken(_) | Command(_) | Fragment(_) | Node(_) | Primitive(_) | Task(_) | Test(_)
        );
        Extent {
            span: item.span,
            is_of_units,
        }
    }
}

/// The modules that a program could use, whether it does or not.
#[derive(Clone, Copy, Debug)]
pub struct Library {
    /// Their names.
    pub modules: fn() -> Vec<&'static str>,
    /// The module that declares a name.
    pub declaring: fn(&str) -> Option<&'static str>,
}

impl Library {
    /// No modules.
    pub const EMPTY: Library = Library {
        modules: Vec::new,
        declaring: |_| None,
    };
}

impl<'a> Program<'a> {
    /// The declaration of this index.
    #[must_use]
    pub fn decl(&self, id: DeclId) -> &Decl<'a> {
        &self.decls[id.0 as usize]
    }

    /// The module of this index.
    #[must_use]
    pub fn module(&self, id: ModuleId) -> &Module {
        &self.modules[id.0 as usize]
    }

    /// Whether a module of the program has the name of this one of the library, without declaring what that does: then to
    /// use it does not bring that.
    #[must_use]
    pub fn is_hidden(&self, module: &str, name: &str) -> bool {
        let same = self.modules.iter().find(|other| other.name == *module);
        same.is_some_and(|other| !other.names.contains_key(name))
    }

    /// How many bytes its declarations are long: what it may ask for grows with that.
    #[must_use]
    pub fn length(&self) -> usize {
        let lengths = self.extents.iter().map(|extent| extent.span);
        lengths.map(|span| (span.end - span.start) as usize).sum()
    }

    /// The module that was asked for.
    #[must_use]
    pub fn root(&self) -> &Module {
        &self.modules[0]
    }
}
