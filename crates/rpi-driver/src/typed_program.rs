//! Typed program, for interpreters that do not use nets.

use std::rc::Rc;

use rpi_diag::{Diagnostic, SourceMap};
use rpi_sema::facts::Facts;
use rpi_sema::typed::{Unit, UnitId};

use crate::compile::{display, program_text};
use crate::input::{Input, InputError};
use crate::program;

/// Program after type checking: its typed units and the results of their analysis.
#[derive(Debug)]
pub struct TypedProgram {
    /// Units of the program, such as nodes and commands, after type checking.
    pub units: Vec<Unit>,
    /// For each unit, in the same order, facts about the presence of its flows: which flows may be absent.
    pub facts: Vec<Facts>,
    /// Name and id of the units that can be run on their own.
    pub runnable: Vec<(String, UnitId)>,
}

impl TypedProgram {
    /// Returns the id of the unit with this name that can be run on its own; `None` if there is none.
    #[must_use]
    pub fn unit(&self, name: &str) -> Option<UnitId> {
        let found = self.runnable.iter().find(|(known, _)| known == name);
        found.map(|(_, unit)| *unit)
    }
}

/// Checks a program and returns its typed units (nodes, commands and others), or its diagnostics if there are errors.
///
/// # Errors
/// If the file is not text.
pub fn check_typed(input: &Input) -> Result<Result<TypedProgram, Vec<Diagnostic>>, InputError> {
    let (stem, path, text) = (input.stem(), display(&input.path), input.text()?);
    let mut sources = SourceMap::new();
    let modules = program_text(input, &stem, &path, text).modules(&mut sources);
    let (known, diagnostics, checked) =
        program::with_checked_program(&modules, &sources, |front, diagnostics| {
            let name = |decl| front.program.decl(decl).name.to_string();
            let runnable = front.checked.runnable.iter();
            let runnable = runnable.map(|(decl, unit)| (name(*decl), *unit)).collect();
            (!program::has_errors(diagnostics)).then(|| (front.facts.to_vec(), runnable))
        });
    Ok(match known {
        None => Err(diagnostics),
        Some((facts, runnable)) => Ok(TypedProgram {
            units: checked.units.into_iter().map(Rc::unwrap_or_clone).collect(),
            facts: facts.into_iter().map(Rc::unwrap_or_clone).collect(),
            runnable,
        }),
    })
}
