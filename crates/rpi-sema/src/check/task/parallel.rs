//! Branches of `parallel` run at the same time, so no two of them may drive the same device.
//!
//! Devices are tracked by name, through the arguments of commands and of the tasks that steps run. Two names are two
//! devices, unless a task gets one device for two of its parameters, which is checked where the task is run.

use crate::check::diagnostics::report;
use std::collections::{BTreeMap, BTreeSet};
use std::rc::Rc;

use crate::check::bodies::body::Body;
use crate::check::exprs::names::plain_name;
use crate::check::task::takeover::driven;
use crate::elab::MAX_TASKS_IN_A_ROW;
use crate::hash::Map;
use crate::program::{DeclId, DeclKind, Lookup, ModuleId, Program};
use rpi_diag::{Code, Finding, Span};
use rpi_syntax::Name;
use rpi_syntax::ast::{Arg, Run, Step, StepKind, TaskDecl, VarDecl};

/// Devices that steps drive, by their names in the task of these steps.
#[derive(Clone, Default)]
pub(crate) struct Uses {
    /// Driven devices, each with the location of its first use.
    drives: BTreeMap<Name, Span>,
    /// Pairs of names that are driven at the same time.
    apart: BTreeSet<(Name, Name)>,
    /// Devices that two branches drive at the same time.
    clashes: Vec<Clash>,
}

/// A device that two parallel branches drive, with both locations.
#[derive(Clone)]
struct Clash {
    device: Name,
    first: Span,
    second: Span,
    /// For branches of an inner task: its name, and its two names for the device.
    within: Option<(Name, Name, Name)>,
}

/// Checks that parallel branches drive different devices.
pub(super) fn check_parallel_devices(cx: &mut Body<'_, '_>, task: &TaskDecl) {
    let mut looked = Looked {
        program: cx.checker.program,
        known: &mut cx.checker.task_uses,
        open: Vec::new(),
    };
    let uses = looked.steps(&task.steps, cx.module);
    uses.clashes
        .iter()
        .for_each(|clash| report::report_diagnostic(cx, clash.finding()));
}

/// Analysis of the devices that tasks drive; each task is analysed once.
struct Looked<'c, 'p> {
    program: &'p Program<'p>,
    /// Devices of each analysed task, by the names in that task.
    known: &'c mut Map<DeclId, Rc<Uses>>,
    /// Tasks in progress. A task that runs itself is reported elsewhere.
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

    /// Returns the devices that a step drives, by the names in its task.
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

    /// Returns the devices that a task drives, by its own names.
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
    /// Adds the devices of steps that run before or after.
    fn add(&mut self, other: Uses) {
        for (device, span) in other.drives {
            self.drives.entry(device).or_insert(span);
        }
        self.apart.extend(other.apart);
        self.clashes.extend(other.clashes);
    }

    /// Adds the devices of steps that run at the same time.
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

    /// Returns the devices of a command or task with these parameters, by the names in the task that runs it. Clashes
    /// inside of a task are reported in that task.
    fn passed(&self, run: &Run, params: &[VarDecl]) -> Uses {
        let names: Vec<&Name> = params
            .iter()
            .flat_map(|p| &p.names)
            .map(|n| &n.name)
            .collect();
        let span = run.callee.span;
        // A device that is not a parameter is a device of the cell, under its own name.
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

/// Returns the name that a step passes for a parameter.
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
        let help = "parallel branches need different devices: run one after the other, or move the device in a single command";
        match &self.within {
            None => Finding::new(
                Code::RPI8005,
                format!("two branches of `parallel` drive `{device}`"),
            )
            .at(self.second, format!("this drives `{device}`"))
            .also(self.first, "and so does this, at the same time"),
            Some((task, a, b)) => Finding::new(
                Code::RPI8005,
                format!("two parallel branches of `{task}` drive `{device}`"),
            )
            .at(
                self.second,
                format!("`{a}` and `{b}` of `{task}` are driven at the same time, and both are `{device}`"),
            ),
        }
        .help(help)
    }
}
