//! Causes of the value of one port in one cycle: the inputs of its node without which it could be another one.

use rpi_image::{CommandFlow, Role};
use rpi_net::{Activation, FragmentId, Input, Net, Node, NodeId, PortRef};

use super::history::History;

/// What a value results from.
#[derive(Clone, PartialEq, Debug)]
pub(super) enum Causes {
    /// Values of other ports: each with its cycle.
    Ports(Vec<(PortRef, u64)>),
    /// The value comes from outside or has no earlier cause; the text says what it is.
    Root(String),
    /// The fragment that contains the node was inactive: its activation condition is the cause.
    Inactive {
        fragment: FragmentId,
        condition: Option<PortRef>,
    },
}

/// Returns the causes of the value, or of the absence, of a port in a cycle.
pub(super) fn causes(net: &Net, history: &History, port: PortRef, cycle: u64) -> Causes {
    let node = net.node(port.node);
    if let Some(inactive) = inactive_fragment(net, history, node.fragment, cycle) {
        return inactive;
    }
    let view = View {
        net,
        history,
        node,
        cycle,
    };
    match node.desc().role {
        Role::Constant => Causes::Root("a constant".to_owned()),
        Role::Delay => view.delay(port.node),
        Role::First => Causes::Root("whether this is the first cycle of its fragment".to_owned()),
        Role::Sensor(_) => {
            let is_absent = history.value(port, cycle).is_none();
            let state = if is_absent { " has no sample" } else { "" };
            Causes::Root(format!("the sensor {}{state}", view.device_port()))
        }
        Role::Input => Causes::Root(format!("the input {}", view.text_parameter("Key"))),
        Role::Flow(flow) => Causes::Root(flow_text(flow).to_owned()),
        Role::DeviceFunction(_) => view.all_or(|| format!("the answer of {}", view.device_port())),
        Role::ExternalFunction(_) => {
            view.all_or(|| "the result of an external function".to_owned())
        }
        Role::Actuator(_) | Role::Export | Role::IsAbsent => view.all(),
        Role::Compute => view.compute(port),
    }
}

/// Returns the outermost inactive fragment around a node, with its condition; `None` if all are active.
fn inactive_fragment(
    net: &Net,
    history: &History,
    fragment: FragmentId,
    cycle: u64,
) -> Option<Causes> {
    let mut outermost = None;
    let mut next = Some(fragment);
    while let Some(id) = next {
        if !history.is_active(id.0, cycle) {
            outermost = Some(id);
        }
        next = net.fragment(id).parent;
    }
    let fragment = outermost?;
    let condition = match net.fragment(fragment).activation {
        Activation::When { condition, .. } => Some(condition),
        Activation::Always => None,
    };
    Some(Causes::Inactive {
        fragment,
        condition,
    })
}

/// A node in a cycle in which its fragment is active.
struct View<'a> {
    net: &'a Net,
    history: &'a History,
    node: &'a Node,
    cycle: u64,
}

impl View<'_> {
    /// Returns the ports that are connected to the in-ports with these numbers.
    fn ports(&self, numbers: impl IntoIterator<Item = usize>) -> Causes {
        let ports = numbers
            .into_iter()
            .filter_map(|k| self.node.inputs.get(k)?.port());
        Causes::Ports(ports.map(|port| (port, self.cycle)).collect())
    }

    fn all(&self) -> Causes {
        self.ports(0..self.node.inputs.len())
    }

    /// Returns all inputs as causes; a root with this text if there are none.
    fn all_or(&self, text: impl FnOnce() -> String) -> Causes {
        match self.all() {
            Causes::Ports(ports) if ports.is_empty() => Causes::Root(text()),
            causes => causes,
        }
    }

    /// Value of an in-port as memory words; `None` if it is absent.
    fn input(&self, number: usize) -> Option<Vec<u64>> {
        match self.node.inputs.get(number)? {
            Input::Port(port) => self.history.value(*port, self.cycle).map(<[u64]>::to_vec),
            Input::Const(value) => Some(value.slots().to_vec()),
            Input::Unconnected => None,
        }
    }

    fn boolean(&self, number: usize) -> Option<bool> {
        self.input(number)?.first().map(|word| *word != 0)
    }

    /// A delay has the value that its input had in the cycle before in which its fragment was active.
    fn delay(&self, node: NodeId) -> Causes {
        let Some(source) = self.net.node(node).inputs.first().and_then(Input::port) else {
            return self.all();
        };
        let mut before = self.cycle;
        while before > 0 {
            before -= 1;
            if !self.history.knows(before) {
                return Causes::Root("what happened before the cycles that are known".to_owned());
            }
            if self.history.is_active(self.node.fragment.0, before) {
                return Causes::Ports(vec![(source, before)]);
            }
        }
        Causes::Root("the first cycle: there is no earlier value".to_owned())
    }

    fn compute(&self, port: PortRef) -> Causes {
        let name = self.node.desc().name;
        let value = self.history.value(port, self.cycle);
        if value.is_none() && !name.ends_with("Conditional") && !name.ends_with("Coalesce") {
            let absent = (0..self.node.inputs.len()).filter(|k| self.input(*k).is_none());
            let absent = self.ports(absent);
            // A primitive that is absent although its inputs are present decides so by their values.
            return match absent {
                Causes::Ports(ports) if ports.is_empty() => self.all(),
                causes => causes,
            };
        }
        let holds = value.and_then(<[u64]>::first).map(|word| *word != 0);
        match short_name(name) {
            "Conditional" => self.conditional(),
            "Coalesce" => match self.input(0) {
                Some(_) => self.ports([0]),
                None => self.ports([0, 1]),
            },
            "Hold" => self.held(),
            "And" if holds == Some(false) => self.with_value(false),
            "Or" if holds == Some(true) => self.with_value(true),
            _ => self.all(),
        }
    }

    /// The condition and the chosen branch. Whether this is the first cycle is left out; its effect is shown: the first value,
    /// or the value before.
    fn conditional(&self) -> Causes {
        let Some(holds) = self.boolean(0) else {
            return self.ports([0]);
        };
        let branch = if holds { 1 } else { 2 };
        if !self.is_first_cycle_test(0) {
            return self.ports([0, branch]);
        }
        match self.ports([branch]) {
            Causes::Ports(ports) if ports.is_empty() => Causes::Root("the first value".to_owned()),
            causes => causes,
        }
    }

    fn is_first_cycle_test(&self, number: usize) -> bool {
        let port = self.node.inputs.get(number).and_then(Input::port);
        port.is_some_and(|port| self.net.node(port.node).desc().role == Role::First)
    }

    /// A held value is that of the last cycle in which the input was present.
    fn held(&self) -> Causes {
        let Some(source) = self.node.inputs.first().and_then(Input::port) else {
            return self.all();
        };
        let cycles = (0..=self.cycle)
            .rev()
            .take_while(|cycle| self.history.knows(*cycle));
        let mut present = cycles.filter(|cycle| self.history.value(source, *cycle).is_some());
        match present.next() {
            Some(cycle) => Causes::Ports(vec![(source, cycle)]),
            None => self.all(),
        }
    }

    /// Returns the Boolean inputs with this value: the first one alone decides.
    fn with_value(&self, value: bool) -> Causes {
        let mut deciding = (0..self.node.inputs.len()).filter(|k| self.boolean(*k) == Some(value));
        match deciding.next() {
            Some(first) => self.ports([first]),
            None => self.all(),
        }
    }

    fn text_parameter(&self, name: &str) -> String {
        let params = self.node.desc().params.iter().zip(&self.node.params);
        let mut found = params.filter(|(param, _)| param.name == name);
        let value = found.next().and_then(|(_, value)| value.as_str());
        value.map_or_else(|| self.node.name.clone(), |text| format!("`{text}`"))
    }

    /// Returns the texts among the parameters: the names of a device and its port.
    fn device_port(&self) -> String {
        let texts = self.node.params.iter().filter_map(|value| value.as_str());
        let texts: Vec<&str> = texts.filter(|text| !text.is_empty()).collect();
        format!("`{}`", texts.join("."))
    }
}

/// Returns the part of a primitive's name that names the operation: `And` for `Core::BooleanAnd`.
fn short_name(name: &str) -> &str {
    let general = ["Conditional", "Coalesce", "Hold"]
        .into_iter()
        .find(|operation| name.ends_with(operation));
    general.unwrap_or(match name {
        "Core::BooleanAnd" => "And",
        "Core::BooleanOr" => "Or",
        _ => "",
    })
}

fn flow_text(flow: CommandFlow) -> &'static str {
    match flow {
        CommandFlow::Cancel => "a cancel request",
        _ => "the clock of the command",
    }
}
