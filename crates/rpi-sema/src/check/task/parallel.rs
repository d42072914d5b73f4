//! Strands of a `parallel` run at once: what one drives no other drives.
//!
//! Devices are followed by their names: through what steps give to commands, and to the tasks that they run. Two names are two
//! devices, unless a task is given one device for two of its parameters: that is looked at where it is run.

use std::collections::{BTreeMap, BTreeSet};
use std::rc::Rc;

use super::takeover::driven;
use crate::check::body::Body;
use crate::check::names::plain_name;
use crate::elab::MAX_TASKS_IN_A_ROW;
use crate::hash::Map;
use crate::program::{DeclId, DeclKind, Lookup, ModuleId, Program};
use rpi_diag::{Code, Finding, Span};
use rpi_syntax::Name;
use rpi_syntax::ast::{Arg, Run, Step, StepKind, TaskDecl, VarDecl};

/// What steps do with devices, by the names that these have there.
#[derive(Clone, Default)]
pub(in crate::check) struct Uses {
    /// What they drive, and where first.
    drives: BTreeMap<Name, Span>,
    /// Devices that are driven at once.
    apart: BTreeSet<(Name, Name)>,
    /// What is driven twice at once.
    clashes: Vec<Clash>,
}

/// A device that two strands drive, with both places.
#[derive(Clone)]
struct Clash {
    device: Name,
    first: Span,
    second: Span,
    /// The task in which the strands are, and what it calls the device, if it is another one.
    within: Option<(Name, Name, Name)>,
}

impl Body<'_, '_> {
    /// Checks that strands which run at once drive devices of their own.
    pub(super) fn strands_apart(&mut self, task: &TaskDecl) {
        let mut looked = Looked {
            program: self.c.program,
            known: &mut self.c.task_uses,
            open: Vec::new(),
        };
        let uses = looked.steps(&task.steps, self.module);
        uses.clashes
            .iter()
            .for_each(|clash| self.report(clash.finding()));
    }
}

/// Looks through tasks, through each once.
struct Looked<'c, 'p> {
    program: &'p Program<'p>,
    /// What tasks do, by their own names.
    known: &'c mut Map<DeclId, Rc<Uses>>,
    /// Tasks that are being looked at: one that runs itself is another finding.
    open: Vec<DeclId>,
}

impl Looked<'_, '_> {
    fn steps(&mut self, steps: &[Step], module: ModuleId) -> Uses {
        let mut all = Uses::default();
        for step in steps {
            match &step.kind {
                StepKind::Run(run) => all.add(self.run(run, module)),
                StepKind::Repeat { steps, .. } => all.add(self.steps(steps, module)),
                StepKind::Parallel(strands) => {
                    let strands = strands.iter().map(|s| self.steps(&s.steps, module));
                    all.add(strands.reduce(Uses::beside).unwrap_or_default());
                }
                StepKind::Start(_) | StepKind::Broken(_) => {}
            }
        }
        all
    }

    /// What a step does, by the names of the task in which it stands.
    fn run(&mut self, run: &Run, module: ModuleId) -> Uses {
        let name = &run.callee.name.name;
        let Lookup::Found(id) = self.program.lookup(module, name) else {
            return Uses::default();
        };
        let decl = self.program.decl(id);
        match decl.kind {
            DeclKind::Command(command) => {
                let drives = driven(command).into_iter();
                let inner = Uses {
                    drives: drives.map(|name| (name.clone(), run.callee.span)).collect(),
                    ..Uses::default()
                };
                inner.passed(run, &command.params)
            }
            DeclKind::Task(task) => self.task(id, task, decl.module).passed(run, &task.params),
            _ => Uses::default(),
        }
    }

    /// What a task does, by its own names.
    fn task(&mut self, id: DeclId, task: &TaskDecl, module: ModuleId) -> Rc<Uses> {
        if let Some(known) = self.known.get(&id) {
            return known.clone();
        }
        if self.open.contains(&id) || self.open.len() > MAX_TASKS_IN_A_ROW {
            return Rc::default();
        }
        self.open.push(id);
        let uses = Rc::new(self.steps(&task.steps, module));
        self.open.pop();
        self.known.insert(id, uses.clone());
        uses
    }
}

impl Uses {
    /// With what other steps do before or after.
    fn add(&mut self, other: Uses) {
        for (device, span) in other.drives {
            self.drives.entry(device).or_insert(span);
        }
        self.apart.extend(other.apart);
        self.clashes.extend(other.clashes);
    }

    /// With what other steps do at the same time.
    fn beside(mut self, other: Uses) -> Uses {
        for (device, second) in &other.drives {
            for (own, first) in &self.drives {
                if own != device {
                    self.apart.insert((own.clone(), device.clone()));
                    continue;
                }
                self.clashes.push(Clash {
                    device: device.clone(),
                    first: *first,
                    second: *second,
                    within: None,
                });
            }
        }
        self.add(other);
        self
    }

    /// The same by the names of whoever runs a command or task with these parameters. What clashes in a task by itself is found
    /// there.
    fn passed(&self, run: &Run, params: &[VarDecl]) -> Uses {
        let names: Vec<&Name> = params
            .iter()
            .flat_map(|p| &p.names)
            .map(|n| &n.name)
            .collect();
        let span = run.callee.span;
        // What is no parameter is a device of the cell, under its own name.
        let outside = |name: &Name| match names.contains(&name) {
            true => given(run, &names, name),
            false => Some(name.clone()),
        };
        let mut all = Uses::default();
        for device in self.drives.keys().filter_map(outside) {
            all.drives.insert(device, span);
        }
        for (a, b) in &self.apart {
            match (outside(a), outside(b)) {
                (Some(one), Some(other)) if one == other => all.clashes.push(Clash {
                    device: one,
                    first: span,
                    second: span,
                    within: Some((run.callee.name.name.clone(), a.clone(), b.clone())),
                }),
                (Some(one), Some(other)) => {
                    all.apart.insert((one, other));
                }
                _ => {}
            }
        }
        all
    }
}

/// The name that a step gives for a parameter.
fn given(run: &Run, names: &[&Name], param: &Name) -> Option<Name> {
    let is_for = |(k, arg): &(usize, &Arg)| match &arg.name {
        Some(name) => name.name == *param,
        None => names.get(*k) == Some(&param),
    };
    let (_, arg) = run.args.iter().enumerate().find(is_for)?;
    plain_name(&arg.value).cloned()
}

impl Clash {
    fn finding(&self) -> Finding {
        let device = &self.device;
        let help = "strands run at once, each on devices of its own: let one follow the other, or move the device in a command that both are part of";
        match &self.within {
            None => Finding::new(
                Code::RPI8005,
                format!("two strands of `parallel` drive `{device}`"),
            )
            .at(self.second, format!("this drives `{device}`"))
            .also(self.first, "and so does this, at the same time"),
            Some((task, a, b)) => Finding::new(
                Code::RPI8005,
                format!("two strands of `{task}` would drive `{device}`"),
            )
            .at(
                self.second,
                format!("`{a}` and `{b}` of `{task}` are driven at once, and both are `{device}`"),
            ),
        }
        .help(help)
    }
}
