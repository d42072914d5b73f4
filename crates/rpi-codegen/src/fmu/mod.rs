//! Functional Mock-up Units (FMI 3.0, co-simulation) from translated images: the texts of their files.

mod description;

use crate::c_type::CType;
use crate::ports::{Direction, Field, Meaning};
use crate::{Emitted, Options};
use rpi_image::hash::Fnv1a;
use rpi_image::image::Image;
use std::fmt::{self, Write};

/// Texts of the files of a unit.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct Fmu {
    /// Name of the model, of its library and of its source without the ending; a C identifier.
    pub name: String,
    /// Text of `modelDescription.xml`.
    pub model_description: String,
    /// Text of `sources/buildDescription.xml`.
    pub build_description: String,
    /// Text of `sources/NAME.c`.
    pub source: String,
}

/// Error: an image cannot be a unit, because it calls functions of devices.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct FmuError {
    /// Names of the functions, such as `arm.move_line`.
    pub functions: Vec<String>,
}

impl fmt::Display for FmuError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "the program calls functions of devices, which an FMU cannot contain: {}; `--emit c` declares them for your own code",
            self.functions.join(", ")
        )
    }
}

impl std::error::Error for FmuError {}

/// Translates a verified image to the files of a unit.
///
/// # Errors
/// If the image calls functions of devices.
pub fn fmu(image: &Image, options: &Options<'_>) -> Result<Fmu, FmuError> {
    let functions = image.functions.iter();
    let functions: Vec<String> = functions
        .map(|f| format!("{}.{}", f.port.device, f.port.port))
        .collect();
    if !functions.is_empty() {
        return Err(FmuError { functions });
    }
    let single = Options {
        header: None,
        ..*options
    };
    let emitted = crate::emit(image, &single);
    // The token distinguishes this version of the program from others.
    let token = &format!(
        "{{{:016x}}}",
        Fnv1a::new().with_bytes(&image.to_bytes()).finish()
    );
    let mut source = emitted.source.clone();
    // Writing to a string cannot fail.
    let _ = bindings(image, options.name, &emitted, token, &mut source);
    source.push_str(include_str!("fmu.c"));
    Ok(Fmu {
        name: options.name.to_owned(),
        model_description: description::model(image, options.name, &emitted.interface, token),
        build_description: description::build(options.name),
        source,
    })
}

/// Appends the names that the common text uses: types, functions and variables of the program.
fn bindings(
    image: &Image,
    name: &str,
    emitted: &Emitted,
    token: &str,
    out: &mut String,
) -> fmt::Result {
    writeln!(
        out,
        "\ntypedef {name}_in fmu_in;\ntypedef {name}_out fmu_out;\ntypedef {name}_state fmu_program_state;"
    )?;
    for function in ["init", "reset", "step", "self_test"] {
        writeln!(out, "#define fmu_program_{function} {name}_{function}")?;
    }
    let period = image.period_ns as f64 / 1e9;
    writeln!(out, "static const double fmu_period = {period:?};")?;
    writeln!(out, "static const char fmu_token[] = \"{token}\";\n")?;
    out.push_str(
        "typedef enum { FMU_NONE, FMU_BOOLEAN, FMU_INTEGER, FMU_REAL, FMU_WORD } fmu_type;\n\n\
         typedef struct fmu_variable {\n  fmu_type type;\n  bool is_input;\n  size_t offset;\n  size_t length;\n} fmu_variable;\n\n\
         static const fmu_variable fmu_variables[] = {\n",
    );
    for field in fields(emitted) {
        let (is_input, part) = match field.direction {
            Direction::Input => (true, "in"),
            Direction::Output => (false, "out"),
        };
        let (ty, field, len) = (type_name(field.ty), &field.name, field.len);
        writeln!(
            out,
            "  {{{ty}, {is_input}, offsetof(fmu_{part}, {field}), {len}U}},"
        )?;
    }
    // A program without ports still has a row, because C has no empty arrays.
    writeln!(out, "  {{FMU_NONE, false, 0U, 0U}}\n}};\n")?;
    let end = emitted.interface.fields.iter().find_map(end_condition);
    let end = end.map_or_else(
        || "  (void)out;\n  return false;\n".to_owned(),
        |end| format!("  return {end};\n"),
    );
    writeln!(
        out,
        "static bool fmu_has_ended(const fmu_out *out) {{\n{end}}}"
    )
}

/// Returns the fields of both structs, in the order of their value references from 1 on.
fn fields(emitted: &Emitted) -> impl Iterator<Item = &Field> {
    emitted.interface.fields.iter()
}

fn type_name(ty: CType) -> &'static str {
    match ty {
        CType::Bool => "FMU_BOOLEAN",
        CType::Int => "FMU_INTEGER",
        CType::Real => "FMU_REAL",
        CType::Word => "FMU_WORD",
    }
}

fn end_condition(field: &Field) -> Option<String> {
    match field.meaning {
        Meaning::Result => Some(format!("out->{} != 0", field.name)),
        Meaning::Terminated => Some(format!("out->{}", field.name)),
        _ => None,
    }
}
