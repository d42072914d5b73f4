//! Results of the analyses of nets by an earlier check of the same program.

use std::cell::RefCell;
use std::hash::{DefaultHasher, Hash, Hasher};
use std::rc::Rc;

use rpi_diag::Diagnostic;
use rpi_net::passes::MachineProfile;
use rpi_sema::elab::Argument;
use rpi_sema::facts::FactsMemo;
use rpi_sema::reuse::{Memo, UnitMemo};
use rpi_sema::typed::UnitId;

/// Diagnostics of the net of one unit.
#[derive(Debug, Default)]
pub(crate) struct NetDiagnostics {
    pub(crate) diagnostics: Vec<Diagnostic>,
    /// Number of nodes of the net.
    pub(crate) node_count: usize,
}

/// Results of the last checks of a program, for the next one.
#[derive(Debug, Default)]
pub(crate) struct ProgramMemo {
    pub(crate) units: UnitMemo,
    pub(crate) facts: FactsMemo,
    pub(crate) nets: Memo<Rc<NetDiagnostics>>,
}

/// Results of earlier analyses of the nets of a program.
pub(crate) struct NetMemo<'p> {
    memo: RefCell<Memo<Rc<NetDiagnostics>>>,
    /// For each unit, a number that is the same if the unit and all that it calls are the same; 0 if it has none.
    versions: &'p [u64],
}

impl<'p> NetMemo<'p> {
    pub(crate) fn new(memo: Memo<Rc<NetDiagnostics>>, versions: &'p [u64]) -> NetMemo<'p> {
        NetMemo {
            memo: RefCell::new(memo),
            versions,
        }
    }

    /// Returns the results for the next check, without those that were not used for some checks.
    pub(crate) fn into_memo(self) -> Memo<Rc<NetDiagnostics>> {
        let mut memo = self.memo.into_inner();
        memo.end_round();
        memo
    }

    /// Returns the known results for the net of a unit with these arguments on this machine, or computes them.
    pub(crate) fn get_or_compute(
        &self,
        unit: UnitId,
        args: &[Argument],
        machine: MachineProfile,
        compute: impl FnOnce() -> NetDiagnostics,
    ) -> Rc<NetDiagnostics> {
        let version = self.versions.get(unit.0 as usize).copied().unwrap_or(0);
        let key = match version {
            0 => 0,
            _ => {
                let mut hasher = DefaultHasher::new();
                (version, format!("{args:?} {machine:?}")).hash(&mut hasher);
                hasher.finish().max(1)
            }
        };
        let mut memo = self.memo.borrow_mut();
        memo.get_or_compute(key, || Rc::new(compute()))
    }
}
