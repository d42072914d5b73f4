//! Stages of the compilation of a program, from parsed modules to checked units with facts about their flows.

use std::path::Path;
use std::rc::Rc;

use rpi_diag::suppression::{self, Cause, suppress, suppress_from};
use rpi_diag::{Diagnostic, Severity, SourceMap};
use rpi_net::passes::MachineProfile;
use rpi_sema::elab::SizeBudget;
use rpi_sema::facts::{self, Facts};
use rpi_sema::program::Program;
use rpi_sema::reuse::versions_with_callees;
use rpi_sema::typed::UnitId;
use rpi_sema::{CheckedProgram, check, check_reusing};
use rpi_syntax::with_large_stack;

use crate::analysis_summary::RequestedReports;
use crate::file_loader::{DiskLoader, FileLoader};
use crate::file_parser::WholeFiles;
use crate::modules::Modules;
use crate::program_memo::{NetMemo, ProgramMemo};
use crate::unused_outputs::OutPorts;

/// Program text with the name of its module and its file.
pub(crate) struct SourceText<'t> {
    /// Name of the module, without an extension.
    pub(crate) name: &'t str,
    /// Path of the file, for messages.
    pub(crate) path: &'t str,
    /// Source text of the module.
    pub(crate) text: &'t str,
    /// Folder in which included files and other modules are searched for; `None` if they must not be read from files.
    pub(crate) folder: Option<&'t Path>,
}

impl SourceText<'_> {
    /// Parses the text and all modules that it needs, which are read through `files`.
    pub(crate) fn modules_from(&self, files: &dyn FileLoader) -> Modules {
        Modules::load_with(&mut WholeFiles, self, files, &mut SourceMap::new())
    }

    /// Parses the text and all modules that it needs, and adds their texts to `sources`.
    pub(crate) fn modules(&self, sources: &mut SourceMap) -> Modules {
        Modules::load(
            self.name,
            self.path,
            self.text,
            self.folder,
            &DiskLoader,
            sources,
        )
    }
}

/// Program after type checking, with the data that the compilation to nets needs: source texts, facts about the
/// presence of flows, machine and limits.
pub(crate) struct AnalysedProgram<'p> {
    pub(crate) program: &'p Program<'p>,
    pub(crate) checked: &'p CheckedProgram,
    pub(crate) sources: &'p SourceMap,
    pub(crate) facts: &'p [Rc<Facts>],
    /// For each unit (node, command, test or task), whether the unit and everything it depends on have no errors so
    /// far.
    pub(crate) error_free: &'p [bool],
    pub(crate) machine: MachineProfile,
    /// Maximum number of nodes in all nets of the program together, and the number used so far.
    pub(crate) node_budget: SizeBudget,
    /// Reports about the compiled nets that the user requested, filled in during the compilation.
    pub(crate) reports: RequestedReports,
    /// Results of an earlier check that may be reused instead of compiling units to nets; `None` if the nets are needed.
    pub(crate) net_memo: Option<NetMemo<'p>>,
    /// Locations that define out-ports, for warnings about unused text.
    pub(crate) out_ports: OutPorts,
}

/// Checks parsed modules and calls `back`, which compiles the units without errors to nets. Returns the result of
/// `back`, the diagnostics of all stages, and the result of the checker.
pub(crate) fn with_checked_program<T>(
    modules: &Modules,
    sources: &SourceMap,
    back: impl FnOnce(&AnalysedProgram<'_>, &mut Vec<Diagnostic>) -> T,
) -> (T, Vec<Diagnostic>, CheckedProgram) {
    with_reused_program(modules, sources, None, back)
}

/// Checks parsed modules and calls `back` like [`with_checked_program`], and reuses the results of an earlier check.
pub(crate) fn with_reused_program<T>(
    modules: &Modules,
    sources: &SourceMap,
    memo: Option<&mut ProgramMemo>,
    back: impl FnOnce(&AnalysedProgram<'_>, &mut Vec<Diagnostic>) -> T,
) -> (T, Vec<Diagnostic>, CheckedProgram) {
    with_large_stack(|| check_and_build(modules, sources, memo, back))
}

fn check_and_build<T>(
    modules: &Modules,
    sources: &SourceMap,
    memo: Option<&mut ProgramMemo>,
    back: impl FnOnce(&AnalysedProgram<'_>, &mut Vec<Diagnostic>) -> T,
) -> (T, Vec<Diagnostic>, CheckedProgram) {
    let texts = modules.sources();
    let (mut program, mut diagnostics) =
        Program::collect_with_library(&texts, crate::library::LIBRARY_NAMES);
    program.arm_axes = modules.arm_axes;
    program.first_parts.clone_from(&modules.first_parts);
    diagnostics.splice(0..0, modules.diagnostics.iter().cloned());
    let mut unused = ProgramMemo::default();
    let reuses = memo.is_some();
    let memo = memo.unwrap_or(&mut unused);
    let mut checked = match &modules.hashes {
        Some(hashes) if reuses => check_reusing(&program, &mut memo.units, hashes.clone()),
        _ => check(&program),
    };
    diagnostics.append(&mut checked.diagnostics);
    let mut diagnostics =
        rpi_sema::without_undefined_flows_in_unclosed_bodies(&program, diagnostics);
    let sound = rpi_sema::sound_units(&program, &checked.units, &diagnostics);
    let versions = versions_with_callees(&checked.units, &checked.versions);
    let (facts, mut found) =
        facts::analyse_reusing(&checked.units, &sound, &versions, &mut memo.facts);
    diagnostics.append(&mut found);
    let known_facts = known_facts(&facts, &sound);
    let sound = rpi_sema::sound_units(&program, &checked.units, &diagnostics);
    let front = AnalysedProgram {
        program: &program,
        checked: &checked,
        sources,
        facts: &facts,
        error_free: &sound,
        machine: modules.machine,
        node_budget: SizeBudget::for_program(&program, &checked.units),
        reports: RequestedReports::default(),
        out_ports: OutPorts::default(),
        net_memo: reuses.then(|| NetMemo::new(std::mem::take(&mut memo.nets), &versions)),
    };
    let (is_faulty, before) = (has_errors(&diagnostics), diagnostics.len());
    let made = back(&front, &mut diagnostics);
    let known = front.net_memo.map(NetMemo::into_memo);
    memo.nets = known.unwrap_or_default();
    if is_faulty {
        suppress_from(&mut diagnostics, before, Cause::HiddenUse);
    }
    if !has_errors(&diagnostics) {
        let unused = rpi_sema::unused_warnings(&program, &checked.units);
        suppression::add_new(&mut diagnostics, unused);
    }
    crate::fixes::type_initial_values(&mut diagnostics, &checked);
    remove_consequences(&mut diagnostics, modules);
    rpi_diag::fill_quotes(&mut diagnostics, sources);
    checked.facts = known_facts;
    (made, diagnostics, checked)
}

/// Returns the facts about the units that have been analysed, which are those for which `sound` is true.
fn known_facts(facts: &[Rc<Facts>], sound: &[bool]) -> Vec<Option<Rc<Facts>>> {
    let known = facts.iter().zip(sound);
    known
        .map(|(facts, sound)| sound.then(|| facts.clone()))
        .collect()
}

/// Removes diagnostics that only follow from others, and warnings about libraries.
fn remove_consequences(diagnostics: &mut Vec<Diagnostic>, modules: &Modules) {
    let libraries = Cause::LibraryFiles(modules.first_library_file);
    suppress(diagnostics, libraries);
    suppression::suppress_in_syntax_errors(diagnostics);
    suppression::remove_repeated(diagnostics);
    suppression::merge_by_subject(diagnostics);
}

impl AnalysedProgram<'_> {
    /// Returns whether a unit (node, command, test or task) and everything it depends on have no errors so far.
    pub(crate) fn is_error_free(&self, unit: UnitId) -> bool {
        self.error_free[unit.0 as usize]
    }
}

pub(crate) fn has_errors(diagnostics: &[Diagnostic]) -> bool {
    diagnostics
        .iter()
        .any(|diagnostic| diagnostic.severity() == Severity::Error)
}
