//! Variants of a program with its body in a state of an automaton, or behind a call.

use super::exprs::Requirement;
use super::forms::form;
use super::model::{Body, Bound, Declared, Equation, FlowId, Kind, Model, State, Statement, Unit};
use crate::random::Random;

/// Moves the body of a node into the only state of an automaton.
pub(crate) fn in_a_state(model: &mut Model, random: &mut Random) -> bool {
    if model.lustre {
        return false;
    }
    let k = random.below(model.units.len());
    // An out-port shared by states and without a declared clock is read in all cycles, present or not (M14.4).
    let is_open = |flow: &FlowId| model.flows[*flow].declared == Declared::Optional;
    if model.units[k].outputs.iter().any(is_open) {
        return false;
    }
    let body = std::mem::take(&mut model.units[k].body);
    model.units[k]
        .body
        .statements
        .push(Statement::Automaton(vec![State {
            name: format!("Only{k}"),
            body,
            unless: Vec::new(),
            until: Vec::new(),
        }]));
    true
}

/// Moves `main` behind a call.
pub(crate) fn behind_a_call(model: &mut Model, random: &mut Random) -> bool {
    let Some(main) = model.units.iter_mut().find(|unit| unit.name == "main") else {
        return false;
    };
    "inner".clone_into(&mut main.name);
    let inner = main.clone();
    let name = |flow: &FlowId| model.flows[*flow].name.clone();
    let given: Vec<String> = inner.inputs.iter().map(name).collect();
    let results: Vec<String> = inner.outputs.iter().map(name).collect();
    let want = Requirement {
        kind: Kind::Int,
        clock: [].into(),
        optional: false,
    };
    let call = format!("inner({})", given.join(", "));
    let equation = |targets: Vec<FlowId>, text: &str, bound| {
        let value = form(text, Vec::new(), &want, None);
        Statement::Equation(Equation {
            targets,
            value,
            bound,
        })
    };
    let mut body = Body::default();
    match model.lustre || random.one_in(2) || results.len() == 1 {
        true => body
            .statements
            .push(equation(inner.outputs.clone(), &call, Bound::Names)),
        false => {
            body.statements
                .push(equation(Vec::new(), &call, Bound::Whole("all".to_owned())));
            for (flow, result) in inner.outputs.iter().zip(&results) {
                body.statements.push(equation(
                    vec![*flow],
                    &format!("all.{result}"),
                    Bound::Names,
                ));
            }
        }
    }
    model.units.push(Unit {
        name: "main".to_owned(),
        body,
        ..inner
    });
    true
}
