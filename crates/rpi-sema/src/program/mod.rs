//! Declarations of all modules of a program, and name lookup.
//!
//! A module is one file with the files that it includes. Names are looked up in the module itself, then in the modules
//! that it uses, in the order of their `use`, then in the modules that are used implicitly. This module knows which
//! declarations exist and must not know what they mean.

mod collect;
mod lookup;
mod used_modules;

pub(crate) use collect::duplicate_name_error;

pub use lookup::Lookup;
pub(crate) use used_modules::UsedModules;

use crate::hash::FastMap;
use rpi_diag::{FileId, Span};
use rpi_syntax::ast::{
    CommandDecl, ConstDef, DeclaredKind, DeviceDecl, Doc, File, FragmentDecl, FrameDecl, Item,
    ItemKind, NodeDecl, NodeKind, PrimitiveDecl, TaskDecl, TestDecl, TypeDef,
};
use rpi_syntax::{Dialect, Name};
use std::cell::{Cell, RefCell};
use std::collections::BTreeMap;

/// Parsed files of one module, from which its declarations are collected.
#[derive(Clone, Debug)]
pub struct Source<'a> {
    /// Name of the module, by which `use` clauses refer to it.
    pub name: Name,
    /// Language of the module's own file: RPI or Lustre. A file that it includes may be in the other language.
    pub mode: Dialect,
    /// File of the module, then the files that it includes.
    pub files: Vec<&'a File>,
    /// Whether every RPI module uses this module without a `use` clause.
    pub implicit: bool,
}

/// Index of a module in [`Program::modules`].
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Debug)]
pub struct ModuleId(pub u32);

/// Index of a declaration in [`Program::decls`].
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Debug)]
pub struct DeclId(pub u32);

/// Declaration of a name: its kind, location and syntax tree.
#[derive(Clone, Debug)]
pub struct Decl<'a> {
    /// Name of the declaration.
    pub name: Name,
    /// Location of the declared name.
    pub span: Span,
    /// Doc comment above the declaration, if there is one.
    pub doc: Option<&'a Doc>,
    /// Module that contains the declaration.
    pub module: ModuleId,
    /// Language of the file that contains the declaration: RPI or Lustre.
    pub mode: Dialect,
    /// Index of the top-level declaration that declares the name, in the order of [`Program::extents`].
    pub item: u32,
    /// Kind and syntax tree of the declaration.
    pub kind: DeclKind<'a>,
}

/// Kind of a declaration, with its syntax tree.
#[derive(Clone, Copy, Debug)]
pub enum DeclKind<'a> {
    /// Constant, declared by `const`.
    Const(&'a ConstDef),
    /// Type, such as `type Speed = real[m/s];`.
    Type(&'a TypeDef),
    /// One of the named values of an enum, which is a constant of its type.
    EnumValue {
        /// Declaration of the enum that has this value.
        ty: DeclId,
        /// Index of this value among the values of the enum, in text order.
        index: u32,
    },
    /// Alternative of a `datatype`, which is called to construct a value of the type.
    Constructor {
        /// Declaration of the `datatype`.
        ty: DeclId,
        /// Index of this alternative among the alternatives of the type, in text order.
        index: u32,
    },
    /// Node, function or contract.
    Node(&'a NodeDecl),
    /// Fragment: a net that may be inactive as a whole.
    Fragment(&'a FragmentDecl),
    /// Declared ports, with units and frames, of a primitive (basic operation) of the registry.
    Primitive(&'a PrimitiveDecl),
    /// Device type, with its actuator and sensor ports.
    Device(&'a DeviceDecl),
    /// Coordinate frame, possibly placed in another frame.
    Frame(&'a FrameDecl),
    /// Command: the unit that the control core runs.
    Command(&'a CommandDecl),
    /// Task: a program of commands.
    Task(&'a TaskDecl),
    /// Test. Its title is not a name that can be looked up.
    Test(&'a TestDecl),
    /// Declaration with a syntax error. Its name is declared so that uses of the name are not reported as undefined.
    Broken(DeclaredKind),
}

impl DeclKind<'_> {
    /// Returns the kind of the declaration in words with an article, such as "a node".
    #[must_use]
    pub fn description(&self) -> &'static str {
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

/// Use of a module by another one, as written in a `use` clause.
#[derive(Debug)]
struct ModuleUse {
    module: ModuleId,
    /// Location of the module's name in the `use` clause.
    name: Span,
    clause_span: Span,
    /// Whether a name has been found in the used module so far.
    is_used: Cell<bool>,
}

/// Module: a source file of a program or of the library, with the names that it declares.
#[derive(Debug)]
pub struct Module {
    /// Name of the module, by which `use` clauses refer to it.
    pub name: Name,
    /// Language of the module's file: RPI or Lustre.
    pub mode: Dialect,
    /// Declarations of the module in text order.
    pub decls: Vec<DeclId>,
    /// Modules that `use` clauses of this module name, in text order.
    uses: Vec<ModuleUse>,
    /// Whether a `use` clause names a module that does not exist. Undefined names in the module may then be a
    /// consequence.
    pub lacks_use: bool,
    names: FastMap<Name, DeclId>,
    /// Declarations by name for each name space, because in Lustre a type and a node may have the same name. Empty for
    /// RPI modules.
    spaces: [FastMap<Name, DeclId>; NameSpace::COUNT],
}

/// Name space in which a name is looked up. In Lustre, each name space has separate names.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum NameSpace {
    /// Name space of constants and values of enums.
    Value,
    /// Name space of types.
    Type,
    /// Name space of nodes and functions.
    Callable,
    /// Name space of contracts.
    Contract,
}

impl NameSpace {
    const COUNT: usize = 4;

    /// Returns the name space to which a declaration of this kind belongs.
    fn of_decl(kind: &DeclKind<'_>) -> NameSpace {
        match kind {
            DeclKind::Type(_) | DeclKind::Device(_) | DeclKind::Broken(DeclaredKind::Type) => {
                NameSpace::Type
            }
            DeclKind::Node(node) if node.kind == NodeKind::Contract => NameSpace::Contract,
            DeclKind::Node(_) | DeclKind::Broken(DeclaredKind::Callable) => NameSpace::Callable,
            _ => NameSpace::Value,
        }
    }
}

/// All declarations of a program, with its modules. Other passes look up names in it.
#[derive(Debug)]
pub struct Program<'a> {
    /// Modules of the program. The first one is the root module, the module of the compiled file.
    pub modules: Vec<Module>,
    /// Declarations of all modules.
    pub decls: Vec<Decl<'a>>,
    /// Modules that every RPI module uses without a `use` clause.
    implicit: Vec<ModuleId>,
    /// Names that were looked up and that two used modules declare: the location of the module's name in the first
    /// `use` and the name, with the location in the second `use`.
    ambiguous_names: RefCell<BTreeMap<(Span, Name), Span>>,
    /// Modules that the program could use, whether it does or not, for suggestions.
    pub library: Library,
    /// Number of axes of an `Arm` without a static argument: that of the arms of the cell. `None` for the default that the
    /// library declares.
    pub arm_axes: Option<u32>,
    /// Locations of all declarations as a whole, in the order of the files.
    pub extents: Vec<Extent>,
    /// For files that are parsed in parts, the identifiers of their first parts, in ascending order; empty otherwise.
    pub first_parts: Vec<FileId>,
}

/// Location of a declaration as a whole, including its body.
#[derive(Clone, Copy, Debug)]
pub struct Extent {
    /// Span of the whole declaration, including its body.
    pub span: Span,
    /// Whether the declaration is compiled to units (nodes, commands and the like). An error inside of it then affects
    /// only these units.
    pub is_of_units: bool,
}

impl Extent {
    fn from_item(item: &Item) -> Extent {
        use ItemKind::{Command, Error, Fragment, Node, Primitive, Task, Test};
        let is_of_units = matches!(
            item.kind,
            Error(_) | Command(_) | Fragment(_) | Node(_) | Primitive(_) | Task(_) | Test(_)
        );
        Extent {
            span: item.span,
            is_of_units,
        }
    }
}

/// Library modules that a program could use, whether it does or not.
#[derive(Clone, Copy, Debug)]
pub struct Library {
    /// Returns the names of all library modules.
    pub modules: fn() -> Vec<&'static str>,
    /// Returns the library module that declares a name; `None` if none does.
    pub declaring: fn(&str) -> Option<&'static str>,
}

impl Library {
    /// Library without any modules.
    pub const EMPTY: Library = Library {
        modules: Vec::new,
        declaring: |_| None,
    };
}

impl<'a> Program<'a> {
    /// Returns the declaration with this index.
    #[must_use]
    pub fn decl(&self, id: DeclId) -> &Decl<'a> {
        &self.decls[id.0 as usize]
    }

    /// Returns the module with this index.
    #[must_use]
    pub fn module(&self, id: ModuleId) -> &Module {
        &self.modules[id.0 as usize]
    }

    /// Returns whether a module of the program hides the library module with the same name and does not declare `name`.
    /// A `use` of the module would then not make the name available.
    #[must_use]
    pub fn is_hidden(&self, module: &str, name: &str) -> bool {
        let same = self.modules.iter().find(|other| other.name == *module);
        same.is_some_and(|other| !other.names.contains_key(name))
    }

    /// Returns the total length of the declarations in bytes of source text. Size limits grow with it.
    #[must_use]
    pub fn text_len(&self) -> usize {
        let lengths = self.extents.iter().map(|extent| extent.span);
        lengths.map(|span| (span.end - span.start) as usize).sum()
    }

    /// Returns the location of the start of the file that contains `place`.
    #[must_use]
    pub(crate) fn start_of_file(&self, place: Span) -> Span {
        let next = self
            .first_parts
            .partition_point(|first| *first <= place.file);
        let first = next.checked_sub(1).map(|at| self.first_parts[at]);
        Span::new(first.unwrap_or(place.file), 0, 0)
    }

    /// Returns the root module, the module of the file that was compiled. The other modules are those that it uses.
    #[must_use]
    pub fn root(&self) -> &Module {
        &self.modules[0]
    }
}
