//! Structural verifier: invariants of every net that passes rely on (indices, tree, arity and types).
//!
//! Elaboration and the `.rpinet` reader must establish them. A violation is a bug in these, not an error in a program.

use crate::net::{Activation, Driver, Fragment, FragmentId, Input, Net, NodeId, PortRef, Restart};
use crate::violation::Violation;
use rpi_image::{Need, ParamType, PortType, Scalar, Type, Value};

/// Checks the structure of a net.
///
/// # Errors
/// Returns the first violated invariant.
pub fn verify(net: &Net) -> Result<(), Violation> {
    let root = net.fragments.first().filter(|f| f.parent.is_none());
    if root.is_none() {
        return Err(Violation::new("the first fragment is not a root"));
    }
    for id in net.fragment_ids() {
        fragment(net, id).map_err(|v| v.at(net.fragment(id).origin.span))?;
    }
    for id in net.node_ids() {
        node(net, id).map_err(|v| v.at(net.node(id).origin.span))?;
    }
    driver(net)?;
    for export in &net.exports {
        let place = export.origin.span;
        ports(net, &export.key, std::iter::once(export.source)).map_err(|v| v.at(place))?;
    }
    Ok(())
}

fn fragment(net: &Net, id: FragmentId) -> Result<(), Violation> {
    let fragment = net.fragment(id);
    let name = &fragment.name;
    match fragment.parent {
        Some(parent) if parent >= id => {
            return Err(Violation::new(format!(
                "fragment `{name}` comes before its parent"
            )));
        }
        None if id != FragmentId::ROOT => {
            return Err(Violation::new(format!("fragment `{name}` has no parent")));
        }
        _ => {}
    }
    for condition in conditions(fragment) {
        boolean(net, name, condition)?;
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

fn node(net: &Net, id: NodeId) -> Result<(), Violation> {
    let node = net.node(id);
    let (name, desc) = (&node.name, node.desc());
    if node.fragment.index() >= net.fragments.len() {
        return Err(Violation::new(format!(
            "`{name}` is in an undefined fragment"
        )));
    }
    let lengths = [
        (node.inputs.len(), desc.inputs.len()),
        (node.params.len(), desc.params.len()),
        (node.outputs.len(), desc.outputs.len()),
    ];
    if lengths.iter().any(|(is, shall)| is != shall) {
        return Err(Violation::new(format!(
            "`{name}` does not have the ports of `{}`",
            desc.name
        )));
    }
    for (input, port) in node.inputs.iter().zip(desc.inputs) {
        let fits = match input_type(net, input)? {
            None => matches!(port.need, Need::Absent),
            Some(ty) => fits(port.ty, ty),
        };
        if !fits {
            return Err(Violation::new(format!(
                "`{}` of `{name}` has the wrong type",
                port.name
            )));
        }
    }
    for (value, param) in node.params.iter().zip(desc.params) {
        if !is_of(param.ty, value) {
            return Err(Violation::new(format!(
                "`{}` of `{name}` has the wrong type",
                param.name
            )));
        }
    }
    let outputs = node.outputs.iter().zip(desc.outputs);
    match outputs.clone().find(|(ty, port)| !fits(port.ty, **ty)) {
        Some((_, port)) => Err(Violation::new(format!(
            "`{}` of `{name}` has the wrong type",
            port.name
        ))),
        None => Ok(()),
    }
}

fn driver(net: &Net) -> Result<(), Violation> {
    match &net.driver {
        Driver::Results(results) => {
            for result in results {
                let place = result.origin.span;
                is_boolean(net, &result.name, &result.condition).map_err(|v| v.at(place))?;
            }
            Ok(())
        }
        Driver::Ports { terminate, fail } => {
            if let Some(terminate) = terminate {
                is_boolean(net, "outTerminate", terminate)?;
            }
            let fail = fail
                .as_ref()
                .map(|f| input_type(net, f))
                .transpose()?
                .flatten();
            match fail {
                None | Some(Type::One(Scalar::Int)) => Ok(()),
                Some(_) => Err(Violation::new("`outFail` is not an integer")),
            }
        }
    }
}

fn is_boolean(net: &Net, name: &str, input: &Input) -> Result<(), Violation> {
    match input_type(net, input)? {
        Some(Type::One(Scalar::Bool)) => Ok(()),
        _ => Err(Violation::new(format!("`{name}` is not a Boolean"))),
    }
}

fn boolean(net: &Net, name: &str, port: PortRef) -> Result<(), Violation> {
    is_boolean(net, name, &Input::Port(port))
}

fn ports(net: &Net, name: &str, mut all: impl Iterator<Item = PortRef>) -> Result<(), Violation> {
    match all.find(|p| port_type(net, *p).is_none()) {
        Some(port) => Err(Violation::new(format!(
            "`{name}` reads {port:?}, which does not exist"
        ))),
        None => Ok(()),
    }
}

fn input_type(net: &Net, input: &Input) -> Result<Option<Type>, Violation> {
    match input {
        Input::Open => Ok(None),
        Input::Const(value) => Ok(value.ty()),
        Input::Port(port) => match port_type(net, *port) {
            Some(ty) => Ok(Some(ty)),
            None => Err(Violation::new(format!(
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
        (PortType::One(a), Type::One(b)) | (PortType::Array(a), Type::Array(b, _)) => a == b,
        (PortType::Matrix, Type::Matrix(..)) => true,
        _ => false,
    }
}

fn is_of(param: ParamType, value: &Value) -> bool {
    match (param, value.ty()) {
        (ParamType::Str, None) => true,
        (ParamType::One(a), Some(Type::One(b))) => a == b,
        (ParamType::Array(a), Some(Type::Array(b, _))) => a == b,
        _ => false,
    }
}
