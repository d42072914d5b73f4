//! Structural verifier: invariants of every net that passes rely on (indices, tree, arity and types).
//!
//! Elaboration and the `.rpinet` reader must establish them. A violation is a bug in these, not an error in a program.

use crate::net::{
    Activation, Fragment, FragmentId, Input, Net, NodeId, PortRef, Restart, Termination,
};
use crate::verify_error::VerifyError;
use rpi_image::{Fallback, ParamType, PortType, Scalar, Type, Value};

/// Checks that indices, numbers of ports and types in a net are valid.
///
/// # Errors
/// Returns the first violated invariant.
pub fn verify(net: &Net) -> Result<(), VerifyError> {
    let root = net.fragments.first().filter(|f| f.parent.is_none());
    if root.is_none() {
        return Err(VerifyError::new("the first fragment is not a root"));
    }
    for id in net.fragment_ids() {
        verify_fragment(net, id).map_err(|v| v.with_span(net.fragment(id).origin.span))?;
    }
    for id in net.node_ids() {
        verify_node(net, id).map_err(|v| v.with_span(net.node(id).origin.span))?;
    }
    verify_termination(net)?;
    for export in &net.exports {
        let place = export.origin.span;
        ports(net, &export.key, std::iter::once(export.source)).map_err(|v| v.with_span(place))?;
    }
    Ok(())
}

fn verify_fragment(net: &Net, id: FragmentId) -> Result<(), VerifyError> {
    let fragment = net.fragment(id);
    let name = &fragment.name;
    match fragment.parent {
        Some(parent) if parent >= id => {
            return Err(VerifyError::new(format!(
                "fragment `{name}` comes before its parent"
            )));
        }
        None if id != FragmentId::ROOT => {
            return Err(VerifyError::new(format!("fragment `{name}` has no parent")));
        }
        _ => {}
    }
    for condition in conditions(fragment) {
        require_boolean(net, name, condition)?;
    }
    let borders = fragment.inputs.iter().chain(&fragment.outputs);
    ports(net, name, borders.filter_map(|p| p.source.port()))
}

fn conditions(fragment: &Fragment) -> impl Iterator<Item = PortRef> {
    let activation = match fragment.activation {
        Activation::Always => None,
        Activation::When { condition, .. } => Some(condition),
    };
    let restart = match fragment.restart {
        Restart::Never | Restart::OnActivation => None,
        Restart::Every(condition) => Some(condition),
    };
    activation.into_iter().chain(restart)
}

fn verify_node(net: &Net, id: NodeId) -> Result<(), VerifyError> {
    let node = net.node(id);
    let (name, desc) = (&node.name, node.desc());
    if node.fragment.index() >= net.fragments.len() {
        return Err(VerifyError::new(format!(
            "`{name}` is in an undefined fragment"
        )));
    }
    let lengths = [
        (node.inputs.len(), desc.inputs.len()),
        (node.params.len(), desc.params.len()),
        (node.outputs.len(), desc.outputs.len()),
    ];
    if lengths.iter().any(|(is, shall)| is != shall) {
        return Err(VerifyError::new(format!(
            "`{name}` does not have the ports of `{}`",
            desc.name
        )));
    }
    for (input, port) in node.inputs.iter().zip(desc.inputs) {
        let has_right_type = match input_type(net, input)? {
            None => matches!(port.fallback, Fallback::AbsentValue),
            Some(ty) => fits(port.ty, ty),
        };
        if !has_right_type {
            return Err(VerifyError::new(format!(
                "`{}` of `{name}` has the wrong type",
                port.name
            )));
        }
    }
    for (value, param) in node.params.iter().zip(desc.params) {
        if !has_type(param.ty, value) {
            return Err(VerifyError::new(format!(
                "`{}` of `{name}` has the wrong type",
                param.name
            )));
        }
    }
    let outputs = node.outputs.iter().zip(desc.outputs);
    match outputs.clone().find(|(ty, port)| !fits(port.ty, **ty)) {
        Some((_, port)) => Err(VerifyError::new(format!(
            "`{}` of `{name}` has the wrong type",
            port.name
        ))),
        None => Ok(()),
    }
}

fn verify_termination(net: &Net) -> Result<(), VerifyError> {
    match &net.termination {
        Termination::Results(results) => {
            for result in results {
                let place = result.origin.span;
                require_boolean_input(net, &result.name, &result.condition)
                    .map_err(|v| v.with_span(place))?;
            }
            Ok(())
        }
        Termination::Ports { terminate, fail } => {
            if let Some(terminate) = terminate {
                require_boolean_input(net, "outTerminate", terminate)?;
            }
            let fail = fail
                .as_ref()
                .map(|f| input_type(net, f))
                .transpose()?
                .flatten();
            match fail {
                None | Some(Type::Scalar(Scalar::Int)) => Ok(()),
                Some(_) => Err(VerifyError::new("`outFail` is not an integer")),
            }
        }
    }
}

fn require_boolean_input(net: &Net, name: &str, input: &Input) -> Result<(), VerifyError> {
    match input_type(net, input)? {
        Some(Type::Scalar(Scalar::Bool)) => Ok(()),
        _ => Err(VerifyError::new(format!("`{name}` is not a Boolean"))),
    }
}

fn require_boolean(net: &Net, name: &str, port: PortRef) -> Result<(), VerifyError> {
    require_boolean_input(net, name, &Input::Port(port))
}

fn ports(net: &Net, name: &str, mut all: impl Iterator<Item = PortRef>) -> Result<(), VerifyError> {
    match all.find(|p| port_type(net, *p).is_none()) {
        Some(port) => Err(VerifyError::new(format!(
            "`{name}` reads {port:?}, which does not exist"
        ))),
        None => Ok(()),
    }
}

fn input_type(net: &Net, input: &Input) -> Result<Option<Type>, VerifyError> {
    match input {
        Input::Unconnected => Ok(None),
        Input::Const(value) => Ok(value.ty()),
        Input::Port(port) => match port_type(net, *port) {
            Some(ty) => Ok(Some(ty)),
            None => Err(VerifyError::new(format!(
                "{port:?} is read, but does not exist"
            ))),
        },
    }
}

fn port_type(net: &Net, port: PortRef) -> Option<Type> {
    let node = net.nodes.get(port.node.index())?;
    node.outputs.get(usize::from(port.port)).copied()
}

fn fits(port: PortType, ty: Type) -> bool {
    match (port, ty) {
        (PortType::Scalar(a), Type::Scalar(b)) | (PortType::Array(a), Type::Array(b, _)) => a == b,
        (PortType::Matrix, Type::Matrix(..)) => true,
        _ => false,
    }
}

fn has_type(param: ParamType, value: &Value) -> bool {
    match (param, value.ty()) {
        (ParamType::Str, None) => true,
        (ParamType::Scalar(a), Some(Type::Scalar(b))) => a == b,
        (ParamType::Array(a), Some(Type::Array(b, _))) => a == b,
        _ => false,
    }
}
