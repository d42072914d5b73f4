//! Iteration over all links of a net.

use rpi_net::{Activation, FragmentId, Input, Net, PortRef, Restart, Termination};

/// Calls `f` with each link of a net: the port that is read, which `f` may replace, and the fragment of its reader.
pub(super) fn for_each_link(net: &mut Net, f: &mut impl FnMut(&mut PortRef, FragmentId)) {
    for node in &mut net.nodes {
        let at = node.fragment;
        node.inputs.iter_mut().for_each(|input| link(input, at, f));
    }
    for k in 0..net.fragments.len() {
        let fragment = &mut net.fragments[k];
        let around = fragment.parent.unwrap_or(FragmentId::ROOT);
        if let Activation::When { condition, .. } = &mut fragment.activation {
            f(condition, around);
        }
        if let Restart::Every(condition) = &mut fragment.restart {
            f(condition, around);
        }
        let inside = FragmentId(u32::try_from(k).unwrap_or(u32::MAX));
        let (inputs, outputs) = (&mut fragment.inputs, &mut fragment.outputs);
        inputs
            .iter_mut()
            .for_each(|p| link(&mut p.source, around, f));
        outputs
            .iter_mut()
            .for_each(|p| link(&mut p.source, inside, f));
    }
    match &mut net.termination {
        Termination::Ports { terminate, fail } => {
            let ports = terminate.iter_mut().chain(fail);
            ports.for_each(|input| link(input, FragmentId::ROOT, f));
        }
        Termination::Results(results) => {
            let conditions = results.iter_mut().map(|result| &mut result.condition);
            conditions.for_each(|input| link(input, FragmentId::ROOT, f));
        }
    }
    net.exports
        .iter_mut()
        .for_each(|export| f(&mut export.source, FragmentId::ROOT));
}

fn link(input: &mut Input, at: FragmentId, f: &mut impl FnMut(&mut PortRef, FragmentId)) {
    if let Input::Port(port) = input {
        f(port, at);
    }
}
