//! The typed program by itself, for who wants to interpret it in another way than as a net.

use rpi_diag::{Finding, SourceMap};
use rpi_sema::facts::Facts;
use rpi_sema::typed::{Unit, UnitId};

use crate::compile::{display, program_text};
use crate::input::{Input, InputError};
use crate::source;

/// A checked program.
#[derive(Debug)]
pub struct Typed {
    /// Its units.
    pub units: Vec<Unit>,
    /// What was found out about each of them.
    pub facts: Vec<Facts>,
    /// What can be run by itself: name and unit.
    pub runnable: Vec<(String, UnitId)>,
}

impl Typed {
    /// What can be run under a name.
    #[must_use]
    pub fn unit(&self, name: &str) -> Option<UnitId> {
        let found = self.runnable.iter().find(|(known, _)| known == name);
        found.map(|(_, unit)| *unit)
    }
}

/// Checks a program, up to its typed units.
///
/// # Errors
/// If the file is no text.
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
