//! Branches of `parallel` run at the same time, so no two of them may drive the same device.
//!
//! Devices are tracked by name, through the arguments of commands and of the tasks that steps run. Two names are two
//! devices, unless a task gets one device for two of its parameters, which is checked where the task is run.

use crate::check::diagnostics::report;
use std::collections::{BTreeMap, BTreeSet};
use std::rc::Rc;

use crate::check::bodies::body::Body;
use crate::check::exprs::names::plain_name;
use crate::check::task::takeover::driven_params;
use crate::elab::MAX_TASK_DEPTH;
use crate::hash::FastMap;
use crate::program::{DeclId, DeclKind, Lookup, ModuleId, Program};
use rpi_diag::{Code, Diagnostic, Span};
use rpi_syntax::Name;
use rpi_syntax::ast::{Arg, Run, Step, StepKind, TaskDecl, VarDecl};

/// Devices that some steps of a task drive. The devices are given by their names in that task.
#[derive(Clone, Default)]
pub(crate) struct DeviceUses {
    /// Names of the driven devices, each with the location of its first use.
    drives: BTreeMap<Name, Span>,
    /// Pairs of names of devices that are driven at the same time, so that they must not name the same device.
    must_differ: BTreeSet<(Name, Name)>,
    /// Conflicts: devices that two parallel branches drive at the same time.
    conflicts: Vec<DeviceConflict>,
}

/// Device that two parallel branches drive, with the locations of the steps that drive it.
#[derive(Clone)]
struct DeviceConflict {
    device: Name,
    first: Span,
    second: Span,
    /// If the parallel branches are in a task that the step runs: the name of that task, and the two names of the
    /// device in it. `None` otherwise.
    inner_task: Option<(Name, Name, Name)>,
}

/// Reports each device that two parallel branches of a task drive at the same time.
pub(super) fn check_parallel_devices(cx: &mut Body<'_, '_>, task: &TaskDecl) {
    let mut looked = DeviceAnalysis {
        program: cx.checker.program,
        results: &mut cx.checker.task_uses,
        in_progress: Vec::new(),
    };
    let uses = looked.steps(&task.steps, cx.module);
    uses.conflicts
        .iter()
        .for_each(|clash| report::report_diagnostic(cx, clash.diagnostic()));
}

/// Analysis of the devices that tasks drive; each task is analysed once.
struct DeviceAnalysis<'c, 'p> {
    program: &'p Program<'p>,
    /// Devices of each task that has been analysed, by their names in that task.
    results: &'c mut FastMap<DeclId, Rc<DeviceUses>>,
    /// Tasks whose analysis is in progress. A task that runs itself is reported by another check.
    in_progress: Vec<DeclId>,
}

impl DeviceAnalysis<'_, '_> {
    fn steps(&mut self, steps: &[Step], module: ModuleId) -> DeviceUses {
        let mut all = DeviceUses::default();
        for step in steps {
            match &step.kind {
                StepKind::Run(run) => all.merge_sequential(self.run(run, module)),
                StepKind::Repeat { steps, .. } => all.merge_sequential(self.steps(steps, module)),
                StepKind::Parallel(strands) => {
                    let strands = strands.iter().map(|s| self.steps(&s.steps, module));
                    all.merge_sequential(
                        strands
                            .reduce(DeviceUses::merge_parallel)
                            .unwrap_or_default(),
                    );
                }
                StepKind::Start(_) | StepKind::Error(_) => {}
            }
        }
        all
    }

    /// Returns the devices that a step drives, by their names in the task of the step. `module` is the module of that
    /// task.
    fn run(&mut self, run: &Run, module: ModuleId) -> DeviceUses {
        let name = &run.callee.name.name;
        let Lookup::Found(id) = self.program.lookup(module, name) else {
            return DeviceUses::default();
        };
        let decl = self.program.decl(id);
        match decl.kind {
            DeclKind::Command(command) => {
                let drives = driven_params(command).into_iter();
                let inner = DeviceUses {
                    drives: drives.map(|name| (name.clone(), run.callee.span)).collect(),
                    ..DeviceUses::default()
                };
                inner.renamed_for_caller(run, &command.params)
            }
            DeclKind::Task(task) => self
                .task(id, task, decl.module)
                .renamed_for_caller(run, &task.params),
            _ => DeviceUses::default(),
        }
    }

    /// Returns the devices that the task `id` drives, by their names in that task.
    fn task(&mut self, id: DeclId, task: &TaskDecl, module: ModuleId) -> Rc<DeviceUses> {
        if let Some(known) = self.results.get(&id) {
            return known.clone();
        }
        if self.in_progress.contains(&id) || self.in_progress.len() > MAX_TASK_DEPTH {
            return Rc::default();
        }
        self.in_progress.push(id);
        let uses = Rc::new(self.steps(&task.steps, module));
        self.in_progress.pop();
        self.results.insert(id, uses.clone());
        uses
    }
}

impl DeviceUses {
    /// Adds the devices of steps that run before or after these steps, not at the same time.
    fn merge_sequential(&mut self, other: DeviceUses) {
        for (device, span) in other.drives {
            self.drives.entry(device).or_insert(span);
        }
        self.must_differ.extend(other.must_differ);
        self.conflicts.extend(other.conflicts);
    }

    /// Adds the devices of steps that run at the same time as these steps. A device that both drive is a conflict.
    fn merge_parallel(mut self, other: DeviceUses) -> DeviceUses {
        for (device, second) in &other.drives {
            for (own, first) in &self.drives {
                if own != device {
                    self.must_differ.insert((own.clone(), device.clone()));
                    continue;
                }
                self.conflicts.push(DeviceConflict {
                    device: device.clone(),
                    first: *first,
                    second: *second,
                    inner_task: None,
                });
            }
        }
        self.merge_sequential(other);
        self
    }

    /// Returns the devices of a command or task with the parameters `params`, by their names in the task whose step
    /// `run` runs it. Conflicts that are inside of the task itself are left out, because they are reported there.
    fn renamed_for_caller(&self, run: &Run, params: &[VarDecl]) -> DeviceUses {
        let names: Vec<&Name> = params
            .iter()
            .flat_map(|p| &p.names)
            .map(|n| &n.name)
            .collect();
        let span = run.callee.span;
        // A device that is not a parameter is a device of the cell, under its own name.
        let outside = |name: &Name| match names.contains(&name) {
            true => argument_name(run, &names, name),
            false => Some(name.clone()),
        };
        let mut all = DeviceUses::default();
        for device in self.drives.keys().filter_map(outside) {
            all.drives.insert(device, span);
        }
        for (a, b) in &self.must_differ {
            match (outside(a), outside(b)) {
                (Some(one), Some(other)) if one == other => all.conflicts.push(DeviceConflict {
                    device: one,
                    first: span,
                    second: span,
                    inner_task: Some((run.callee.name.name.clone(), a.clone(), b.clone())),
                }),
                (Some(one), Some(other)) => {
                    all.must_differ.insert((one, other));
                }
                _ => {}
            }
        }
        all
    }
}

/// Returns the name of the flow or device that a step passes for the parameter `param`; `None` if the argument is
/// missing or not a plain name. `names` are the parameters in their order.
fn argument_name(run: &Run, names: &[&Name], param: &Name) -> Option<Name> {
    let is_for = |(k, arg): &(usize, &Arg)| match &arg.name {
        Some(name) => name.name == *param,
        None => names.get(*k) == Some(&param),
    };
    let (_, arg) = run.args.iter().enumerate().find(is_for)?;
    plain_name(&arg.value).cloned()
}

impl DeviceConflict {
    fn diagnostic(&self) -> Diagnostic {
        let device = &self.device;
        let help = "parallel branches need different devices: run one after the other, or drive the device in a single command";
        match &self.inner_task {
            None => Diagnostic::new(
                Code::RPI8005,
                format!("two branches of `parallel` drive `{device}`"),
            )
            .primary(
                self.second,
                format!("this drives `{device}` at the same time"),
            )
            .secondary(self.first, format!("this drives `{device}`")),
            Some((task, a, b)) => Diagnostic::new(
                Code::RPI8005,
                format!("two parallel branches of `{task}` drive `{device}`"),
            )
            .primary(
                self.second,
                format!("`{a}` and `{b}` of `{task}` are driven at the same time, and both are `{device}`"),
            ),
        }
        .help(help)
    }
}
