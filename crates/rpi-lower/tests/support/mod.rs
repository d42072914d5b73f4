//! Builds small nets and runs them.
#![allow(dead_code, unreachable_pub)]

use rpi_core::{CycleContext, Instance};
pub use rpi_device::NoDevices;
use rpi_diag::Span;
use rpi_image::{Fallback, Image, Type, Value, desc::ShapeArgs};
use rpi_lower::LowerOptions;
use rpi_net::{
    AbsentPolicy, Activation, Fragment, FragmentId, Input, Net, Node, NodeId, Origin, PortRef,
    Restart,
};
use rpi_prims::PrimId;

/// A net under construction.
pub struct NetBuilder {
    pub net: Net,
}

const NOWHERE: Origin = Origin {
    span: Span::NONE,
    flow: None,
};

impl NetBuilder {
    pub fn new() -> Self {
        NetBuilder {
            net: Net::new("test"),
        }
    }

    /// Adds a node. Ports and parameters that are not listed take their defaults.
    pub fn node(
        &mut self,
        fragment: FragmentId,
        name: &str,
        prim: &str,
        inputs: &[(&str, Input)],
        params: &[(&str, Value)],
    ) -> PortRef {
        let prim = PrimId::from_name(prim).unwrap_or_else(|| panic!("no primitive {prim}"));
        let desc = prim.desc();
        let given = |name: &str| params.iter().find(|p| p.0 == name).map(|p| p.1.clone());
        let params: Vec<Value> = desc
            .params
            .iter()
            .map(|p| {
                let ty = match p.ty {
                    rpi_image::ParamType::Scalar(s) => Type::Scalar(s),
                    _ => Type::Scalar(rpi_image::Scalar::Bool),
                };
                given(p.name).unwrap_or_else(|| p.default.value(ty).expect("a default"))
            })
            .collect();
        let inputs: rpi_net::Inputs = desc
            .inputs
            .iter()
            .map(|p| {
                let wired = inputs.iter().find(|i| i.0 == p.name).map(|i| i.1.clone());
                wired.unwrap_or_else(|| match p.fallback {
                    Fallback::Param(_, default) => {
                        let rpi_image::PortType::Scalar(s) = p.ty else {
                            return Input::Unconnected;
                        };
                        Input::constant(default.value(Type::Scalar(s)).expect("a default"))
                    }
                    _ => Input::Unconnected,
                })
            })
            .collect();
        let types: Vec<Option<Type>> = inputs.iter().map(|i| self.ty(i)).collect();
        let args = ShapeArgs {
            inputs: &types,
            params: &params,
        };
        let outputs = (0..desc.outputs.len())
            .map(|k| desc.out_type(k, &args).expect("sizes fit"))
            .collect();
        let node = self.net.add_node(Node {
            name: name.into(),
            prim,
            fragment,
            inputs,
            params,
            outputs,
            origin: NOWHERE,
        });
        PortRef { node, port: 0 }
    }

    fn ty(&self, input: &Input) -> Option<Type> {
        match input {
            Input::Unconnected => None,
            Input::Const(value) => value.ty(),
            Input::Port(p) => Some(self.net.node(p.node).outputs[usize::from(p.port)]),
        }
    }

    /// Adds a fragment inside `parent` that is active while `when` is true.
    pub fn fragment(
        &mut self,
        parent: FragmentId,
        name: &str,
        when: PortRef,
        restart: Restart,
    ) -> FragmentId {
        self.net.add_fragment(Fragment {
            name: name.into(),
            parent: Some(parent),
            activation: Activation::When {
                condition: when,
                if_absent: AbsentPolicy::Inactive,
            },
            restart,
            is_clock: false,
            inputs: Vec::new(),
            outputs: Vec::new(),
            budget_ns: None,
            origin: NOWHERE,
        })
    }

    /// Connects an in-port later, for feedback.
    pub fn wire(&mut self, node: NodeId, port: usize, source: PortRef) {
        self.net.nodes[node.index()].inputs[port] = Input::Port(source);
    }
}

pub fn image(net: &Net, options: &LowerOptions<'_>) -> Image {
    let image = rpi_bench::image_compare::lower_net(net, options).expect("it can be lowered");
    if let Err(errors) = rpi_image::verify(&image, &rpi_core::prim_desc) {
        let text: Vec<String> = errors.iter().map(ToString::to_string).collect();
        let print = rpi_image::text::print(&image, &rpi_core::prim_desc);
        panic!("{}\n{print}", text.join("\n"));
    }
    image
}

/// Runs one cycle up to the commit phase.
pub fn cycle(machine: &mut Instance) {
    machine.read(&mut NoDevices, &CycleContext::default());
    machine.evaluate(&mut NoDevices);
}

pub fn finish(machine: &mut Instance) {
    machine.commit();
    assert!(machine.hand_over(&mut NoDevices));
}

/// The value of the probe `path.port` in this cycle; `None` if it is absent.
pub fn probe(machine: &Instance, name: &str) -> Option<Vec<u64>> {
    let image = machine.image();
    let probe = image
        .debug
        .probes
        .iter()
        .find(|p| image.probe_name(p) == name);
    let probe = probe.unwrap_or_else(|| panic!("no probe {name}"));
    let active = machine.is_active(probe.fragment);
    machine
        .value(probe.value)
        .filter(|_| active)
        .map(<[u64]>::to_vec)
}
