//! Typed program, for interpreters that do not use nets.

use rpi_diag::{Finding, SourceMap};
use rpi_sema::facts::Facts;
use rpi_sema::typed::{Unit, UnitId};

use crate::compile::{display, program_text};
use crate::input::{Input, InputError};
use crate::source;

/// Checked program.
#[derive(Debug)]
pub struct Typed {
    /// Units of the program.
    pub units: Vec<Unit>,
    /// Presence facts of each unit.
    pub facts: Vec<Facts>,
    /// Units that can be run on their own, by name.
    pub runnable: Vec<(String, UnitId)>,
}

impl Typed {
    /// Returns the runnable unit of this name.
    #[must_use]
    pub fn unit(&self, name: &str) -> Option<UnitId> {
        let found = self.runnable.iter().find(|(known, _)| known == name);
        found.map(|(_, unit)| *unit)
    }
}

/// Checks a program and returns its typed units, or its diagnostics if there are errors.
///
/// # Errors
/// If the file is not text.
pub fn typed(input: &Input) -> Result<Result<Typed, Vec<Finding>>, InputError> {
    let (stem, path, text) = (input.stem(), display(&input.path), input.text()?);
    let mut sources = SourceMap::new();
    let modules = program_text(input, &stem, &path, text).modules(&mut sources);
    let (known, findings, checked) = source::with_front(&modules, &sources, |front, findings| {
        let name = |decl| front.program.decl(decl).name.to_string();
        let runnable = front.checked.runnable.iter();
        let runnable = runnable.map(|(decl, unit)| (name(*decl), *unit)).collect();
        (!source::has_errors(findings)).then(|| (front.facts.to_vec(), runnable))
    });
    Ok(match known {
        None => Err(findings),
        Some((facts, runnable)) => Ok(Typed {
            units: checked.units,
            facts,
            runnable,
        }),
    })
}
