//! Blocks of equations (`if`, `when`, `cond`, `frame` of Kind 2): what they stand for, and what is wrong with them.

use super::body::Body;
use rpi_diag::{Code, Finding};
use rpi_syntax::ast::{BlockFault, Meaning};

impl<'a> Body<'_, 'a> {
    /// Declares the equations that a block stands for.
    pub(super) fn declare_meaning(&mut self, means: &'a Meaning) {
        for fault in &means.faults {
            self.report(fault_of(fault));
        }
        let names = means.faults.iter().filter_map(|fault| match fault {
            BlockFault::MissingIn(name, _) | BlockFault::NotNamed(name) => Some(&name.name),
            _ => None,
        });
        let faulty: Vec<_> = names.collect();
        for (equation, span) in &means.equations {
            let is_faulty = equation
                .targets
                .iter()
                .any(|target| faulty.contains(&&target.name.name));
            match is_faulty {
                true => {
                    let flows = equation.targets.iter();
                    let flows: Vec<_> = flows
                        .filter_map(|t| self.local_flow(&t.name.name))
                        .collect();
                    self.broken.extend(flows);
                }
                false => self.declare_equation(equation, *span),
            }
        }
    }
}

fn fault_of(fault: &BlockFault) -> Finding {
    match fault {
        BlockFault::MissingIn(name, branch) => Finding::new(
            Code::RPI1009,
            format!("`{}` is not defined in every case", name.name),
        )
        .at(name.span, "has an equation here")
        .also(*branch, "and none in a case of this condition")
        .help("add the equation; or let a `frame` keep the value of the cycle before"),
        BlockFault::NoEquation(span, what) => Finding::new(
            Code::RPI1014,
            format!("{what} can not stand in a block of equations"),
        )
        .at(*span, "only equations and blocks of equations")
        .help("write it outside of the block"),
        BlockFault::NotNamed(name) => Finding::new(
            Code::RPI1014,
            format!("the `frame` does not name `{}`", name.name),
        )
        .at(name.span, "defined inside of it")
        .help("name it in the brackets after `frame`, or define it outside"),
        BlockFault::Twice(name, first) => {
            Finding::new(Code::RPI1008, format!("`{}` is defined twice", name.name))
                .at(name.span, "defined again here")
                .also(*first, "first defined here")
        }
    }
}
