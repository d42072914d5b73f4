//! What is found against each net of a unit, and what of it is true of the unit.

use std::collections::BTreeMap;

use rpi_diag::{Code, Finding, Span};
use rpi_net::passes::is_unreachable;
use rpi_sema::typed::UnitId;

/// What was found against nets: a unit has one by itself, and one for each list of arguments that tasks give it.
#[derive(Default)]
pub(crate) struct Found(Vec<(UnitId, Vec<Finding>)>);

impl Found {
    /// Where findings against one more net of a unit belong.
    pub(crate) fn net_of(&mut self, unit: UnitId) -> &mut Vec<Finding> {
        self.0.push((unit, Vec::new()));
        let at = self.0.len() - 1;
        &mut self.0[at].1
    }

    /// All of it, but what denies the text any use only where all nets of the unit agree: what is needless for some
    /// arguments is there for others.
    pub(crate) fn agreed(self) -> Vec<Finding> {
        let mut nets: BTreeMap<UnitId, usize> = BTreeMap::new();
        let mut denied: BTreeMap<(UnitId, Code, Span), usize> = BTreeMap::new();
        for (unit, found) in &self.0 {
            *nets.entry(*unit).or_default() += 1;
            let denying = found.iter().filter(|f| denies(f));
            let mut places: Vec<(Code, Span)> = denying.map(|f| (f.code, f.span())).collect();
            places.sort_unstable();
            places.dedup();
            for (code, span) in places {
                *denied.entry((*unit, code, span)).or_default() += 1;
            }
        }
        let all = self.0.into_iter();
        let all = all.flat_map(|(unit, found)| found.into_iter().map(move |f| (unit, f)));
        all.filter(|(unit, f)| !denies(f) || denied[&(*unit, f.code, f.span())] == nets[unit])
            .map(|(_, finding)| finding)
            .collect()
    }
}

/// Whether it says that text is good for nothing.
fn denies(finding: &Finding) -> bool {
    is_unreachable(finding) || finding.code.is_about_needless_text()
}
