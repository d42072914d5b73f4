//! Translation of images to C.
//!
//! The C text is derived from the flat image that the core runs, step by step, so that both have the same meaning. The
//! C code of a primitive is in its declaration ([`rpi_prims::c_code`]). This crate is independent of nets, sources and
//! devices: the ports of devices become fields of structs, and device functions become `extern` functions.
//!
//! | file | subject |
//! |---|---|
//! | `slots.rs` | types of the slots, ranges of slots that form arrays, and slots that need memory between cycles |
//! | `scopes.rs` | order of writers and readers: which values are local variables |
//! | `variables.rs`, `identifiers.rs` | C variables of the slots and their names |
//! | `ports.rs` | fields of the input and output structs |
//! | `expansion.rs`, `functions.rs` | C functions of the primitives |
//! | `order.rs` | order of the statements |
//! | `statements.rs`, `parts.rs`, `locals.rs` | C statements of the steps, their distribution over functions, and local variables |
//! | `devices.rs` | set-points and device functions |
//! | `external.rs`, `external_host.rs` | functions in C that the program calls |
//! | `support.rs` | common functions that the text uses |
//! | `fmu/` | files of Functional Mock-up Units |
//! | `driver.rs` | program that runs the cycles for another process |
//! | `initial.rs` | initial values and restarts |
//! | `header.rs`, `source.rs` | the two files |

mod access;
mod c_type;
mod devices;
mod driver;
mod expansion;
mod external;
mod external_host;
mod fmu;
mod functions;
mod header;
mod identifiers;
mod initial;
mod literals;
mod locals;
mod order;
mod parts;
mod ports;
mod scopes;
mod slots;
mod source;
mod statements;
mod support;
mod variables;

pub use c_type::CType;
pub use devices::function_name;
pub use driver::driver;
pub use external::{external_functions, shared_function};
pub use external_host::external_host;
pub use fmu::{Fmu, FmuError, fmu};
pub use ports::{Direction, Field, Interface, Meaning};

use rpi_image::image::{Image, SourceLocation};

/// Choices of the caller for the translation of an image to C.
#[derive(Clone, Copy)]
pub struct Options<'a> {
    /// Start of the names of all types and functions, a C identifier.
    pub name: &'a str,
    /// Name of the header that the source includes; `None` writes one file, which contains the declarations.
    pub header: Option<&'a str>,
    /// Function that returns the place of a node in the source text; `None` if it is not known.
    pub locate: &'a dyn Fn(&SourceLocation) -> Option<SourcePlace>,
    /// Whether the text contains `#line` directives that refer to the source text.
    pub line_directives: bool,
    /// Text for the first comment, such as the version of the compiler and a hash of the source.
    pub origin: &'a str,
}

/// Place in a source text.
#[derive(Clone, PartialEq, Eq, PartialOrd, Ord, Debug)]
pub struct SourcePlace {
    /// Path of the file, as the messages of the compiler show it.
    pub file: String,
    /// Line, counted from 1.
    pub line: u32,
    /// Column in characters, counted from 1.
    pub column: u32,
}

/// Translated image: texts of the files, and description of the structs.
#[derive(Clone, PartialEq, Debug)]
pub struct Emitted {
    /// Text of the header; empty if the source contains the declarations.
    pub header: String,
    /// Text of the source.
    pub source: String,
    /// Fields of the structs, for programs that call the functions.
    pub interface: Interface,
}

/// Returns the name of a command or node as a C identifier, for [`Options::name`].
#[must_use]
pub fn program_name(name: &str) -> String {
    identifiers::identifier(name)
}

/// Translates a verified image to C.
#[must_use]
pub fn emit(image: &Image, options: &Options<'_>) -> Emitted {
    let slots = slots::Slots::new(image);
    let interface = Interface::new(image, &slots);
    let variables = variables::Variables::new(image, &slots, &interface);
    let emitter = statements::Emitter::new(image, &slots, &variables, &interface, options);
    source::write(emitter)
}
