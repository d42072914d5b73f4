//! Instances of commands for the arguments given by tasks.

use rpi_diag::Span;
use rpi_sema::elab::{self, Argument};
use rpi_sema::program::ModuleId;
use rpi_sema::typed::{TaskStep, Unit, UnitId};
use rpi_syntax::Name;
use rpi_syntax::ast::{Expr, Run};
use std::collections::BTreeMap;

use crate::program::AnalysedProgram;

/// Instance of a command: the command with the argument values with which a task calls it. Each distinct list of values
/// gives a net of its own.
#[derive(Clone, PartialEq, Debug)]
pub(crate) struct Instance {
    /// Name of the instance's net, such as `MoveTo(arm, home)`.
    pub(crate) name: String,
    /// Command that is called.
    pub(crate) unit: UnitId,
    /// Argument for each parameter of the command, in the order of declaration.
    pub(crate) args: Vec<Argument>,
    /// Location of the first call in a task.
    pub(crate) span: Span,
}

/// Argument for a parameter of a command or task: its value, and the text of the value in the names of nets.
#[derive(Clone, PartialEq, Debug)]
pub(super) struct TaskArgument {
    pub(super) param: Name,
    pub(super) value: Argument,
    pub(super) name: String,
}

/// Returns the arguments with which a command or task runs on its own: devices and constants with the names of the
/// parameters, or declared defaults.
pub(super) fn default_arguments(front: &AnalysedProgram<'_>, unit: &Unit) -> Vec<TaskArgument> {
    let params = elab::parameters(unit).into_iter().map(|id| unit.flow(id));
    let given = params.map(|flow| TaskArgument {
        param: flow.name.clone(),
        value: front.checked.root_argument(front.program, flow),
        name: flow.name.to_string(),
    });
    given.collect()
}

/// Returns the arguments for all parameters of the command or task that a step calls. The step belongs to the task
/// `unit`, whose own parameters have the values `known`.
///
/// # Errors
/// A noun phrase for the argument that has no value before the task runs.
pub(super) fn step_arguments(
    front: &AnalysedProgram<'_>,
    unit: &Unit,
    known: &[TaskArgument],
    (step, run): (&TaskStep, &Run),
) -> Result<Vec<TaskArgument>, String> {
    let callee = front.checked.unit(step.unit);
    let values: Vec<Argument> = known.iter().map(|given| given.value.clone()).collect();
    let mut all = Vec::new();
    for (flow, arg) in callee.inputs.iter().zip(&step.args) {
        let param = &callee.flow(*flow).name;
        let Some(id) = *arg else {
            // A value taken over from the predecessor (`given`) is not a parameter.
            if elab::parameters(callee).contains(flow) {
                all.push(TaskArgument {
                    param: param.clone(),
                    value: Argument::Default,
                    name: param.to_string(),
                });
            }
            continue;
        };
        let value = elab::evaluate_argument(&front.checked.units, unit, id, &values);
        let passed = argument_name(run, unit.expr(id).span).map(|name| argument_text(known, name));
        let name = match (&value, passed) {
            (Argument::Unknown, Some(name)) => {
                return Err(format!(
                    "`{name}`, which has no value here: declare `const {name} = ...`"
                ));
            }
            (Argument::Unknown, None) => {
                return Err(format!(
                    "`{param}` of `{}`, which has no value before the task runs",
                    callee.name
                ));
            }
            (_, Some(name)) => name,
            (_, None) => source_text(front, unit.expr(id).span),
        };
        let param = param.clone();
        all.push(TaskArgument { param, value, name });
    }
    Ok(all)
}

/// Returns the name that is the argument of a step at the location `at`; `None` if that argument is not a single name.
fn argument_name(run: &Run, at: Span) -> Option<&Name> {
    let values = run.args.iter().map(|arg| arg.value.unparen());
    let at_place = |value: &&Expr| value.span == at;
    values.filter(at_place).find_map(Expr::as_name)
}

/// Returns the text of the argument for the parameter `name` of the task; any other name is returned unchanged.
fn argument_text(known: &[TaskArgument], name: &Name) -> String {
    let param = known.iter().find(|given| given.param == *name);
    param.map_or(name.to_string(), |given| given.name.clone())
}

/// Returns the source text of an argument, joined to one line.
fn source_text(front: &AnalysedProgram<'_>, span: Span) -> String {
    let words: Vec<&str> = front.sources.slice(span).split_whitespace().collect();
    words.join(" ")
}

/// Instances of commands (commands with given arguments) that the tasks compiled so far need.
#[derive(Default)]
pub(super) struct Instances {
    pub(super) all: Vec<Instance>,
    /// Names of the instances, first by the text of the call, such as `MoveTo(arm, home)`, then by command and argument
    /// values.
    by_text: BTreeMap<String, BTreeMap<String, String>>,
    /// Number of plan nodes of all tasks so far, for the size limit.
    pub(super) planned: usize,
}

impl Instances {
    /// Returns the name of the net for the command that a step calls with the arguments `given`. The instance is added
    /// if it is new. A command of the program itself with its default arguments needs no instance.
    pub(super) fn name(
        &mut self,
        front: &AnalysedProgram<'_>,
        step: &TaskStep,
        given: Vec<TaskArgument>,
    ) -> String {
        let unit = front.checked.unit(step.unit);
        let module = front.program.decl(step.decl).module;
        let alone = default_arguments(front, unit);
        let names: Vec<&str> = given.iter().map(|given| given.name.as_str()).collect();
        let as_declared = alone
            .iter()
            .map(|given| given.name.as_str())
            .eq(names.iter().copied());
        let is_own = module == ModuleId(0);
        let mut name = match is_own {
            true => unit.name.to_string(),
            false => format!("{}.{}", front.program.module(module).name, unit.name),
        };
        if is_own && given == alone {
            return name;
        }
        if !as_declared {
            let is_given = |given: &&TaskArgument| given.value != Argument::Default;
            let names = given.iter().filter(is_given).map(|given| &*given.name);
            name = format!("{name}({})", names.collect::<Vec<_>>().join(", "));
        }
        let args = given.into_iter().map(|given| given.value).collect();
        self.unique_name(name, step, args)
    }

    /// Returns a unique name for the instance of a step's command with the arguments `args`, and adds the instance if
    /// it is new. The same `text` of a call may denote different values if tasks with parameters call one another; such
    /// instances are numbered.
    fn unique_name(&mut self, text: String, step: &TaskStep, args: Vec<Argument>) -> String {
        let unit = step.unit;
        let same = self.by_text.entry(text.clone()).or_default();
        // `Argument` is not `Ord`, so its debug text is the key.
        let key = format!("{unit:?} {args:?}");
        if let Some(name) = same.get(&key) {
            return name.clone();
        }
        let name = match same.len() {
            0 => text,
            others => format!("{text} #{}", others + 1),
        };
        same.insert(key, name.clone());
        self.all.push(Instance {
            name: name.clone(),
            unit,
            args,
            span: step.span,
        });
        name
    }
}
