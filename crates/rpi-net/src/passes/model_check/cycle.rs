//! Computes one cycle of a net over a [`Domain`]: activity, flows and the next state of the registers.

use super::cone::{Cone, RegisterKind};
use super::domain::{Domain, Flow, Source};
use super::gates::{Gate, always_present};
use crate::net::{AbsentPolicy, Activation, FragmentId, Input, Node, NodeId, PortRef, Restart};
use crate::passes::fact_prover::Event;
use rpi_image::{DevicePortNames, Presence, Role, Type, Value};
use rustc_hash::FxHashMap;

/// Contents of all state elements (registers) of a cone at the start of a cycle, in the order of the registers.
pub(super) type State<D> = Vec<Flow<D>>;

/// Evaluation of one cycle of a net over concrete or symbolic values.
pub(super) struct Cycle<'a, D: Domain> {
    pub(super) domain: &'a mut D,
    cone: &'a Cone<'a>,
    state: &'a State<D>,
    flows: FxHashMap<PortRef, Flow<D>>,
    active: FxHashMap<FragmentId, D::Bool>,
    reset: FxHashMap<FragmentId, D::Bool>,
    /// Contents of memory slots at the end of the cycle, by index of their register.
    cells: FxHashMap<usize, D::Value>,
}

/// Returns the contents of all registers at the start of the first cycle.
pub(super) fn first_state<D: Domain>(domain: &mut D, cone: &Cone<'_>) -> State<D> {
    let registers = cone.registers.iter();
    registers
        .map(|register| first(domain, register.ty, register.initial.as_ref()))
        .collect()
}

fn first<D: Domain>(domain: &mut D, ty: Type, content: Option<&Value>) -> Flow<D> {
    let present = domain.bit(content.is_some());
    let value = match content {
        Some(value) => domain.constant(value),
        None => domain.constant(&Value::neutral(ty)),
    };
    Flow { present, value }
}

impl<'a, D: Domain> Cycle<'a, D> {
    /// Evaluates the nodes of the cone in a cycle, whose registers have the contents `state` at its start.
    pub(super) fn new(domain: &'a mut D, cone: &'a Cone<'a>, state: &'a State<D>) -> Self {
        let yes = domain.bit(true);
        let no = domain.bit(false);
        let mut cycle = Cycle {
            domain,
            cone,
            state,
            flows: FxHashMap::default(),
            active: FxHashMap::from_iter([(FragmentId::ROOT, yes)]),
            reset: FxHashMap::from_iter([(FragmentId::ROOT, no)]),
            cells: FxHashMap::default(),
        };
        for id in &cone.nodes {
            cycle.node(*id);
        }
        cycle
    }

    /// Returns whether an event occurs in the cycle: its fragment is active and its flows are present.
    pub(super) fn occurs(&mut self, event: &Event) -> D::Bool {
        let active = self.activity(event.fragment);
        let mut all = active;
        for port in &event.present {
            let present = self.flow(*port).present;
            all = self.domain.and(all, present);
        }
        all
    }

    /// Returns whether a Boolean flow is present and true in the cycle.
    pub(super) fn is_true(&mut self, port: PortRef) -> D::Bool {
        let flow = self.flow(port);
        self.domain.is_true(&flow)
    }

    /// Returns the value and presence of a flow in the cycle. A flow is absent while its fragment is inactive.
    pub(super) fn flow(&mut self, port: PortRef) -> Flow<D> {
        if let Some(flow) = self.flows.get(&port) {
            return flow.clone();
        }
        // The node is outside the cone, so its outputs are unconstrained.
        let node = self.cone.net.node(port.node);
        let (no, yes) = (self.domain.bit(false), self.domain.bit(true));
        let flow = self.domain.unknown((port, node), None, no, yes);
        self.flows.insert(port, flow.clone());
        flow
    }

    /// Returns the contents of all registers at the start of the next cycle.
    pub(super) fn next_state(mut self) -> State<D> {
        let cone = self.cone;
        let places = 0..cone.registers.len();
        places.map(|place| self.next_of(place)).collect()
    }

    fn next_of(&mut self, place: usize) -> Flow<D> {
        let register = &self.cone.registers[place];
        let kept = self.register_content(place);
        let active = self.activity(register.owner);
        let new = match register.memory {
            RegisterKind::Delayed(id) => match self.cone.net.node(id).inputs.first() {
                Some(input) => self.input(input),
                None => return kept,
            },
            RegisterKind::Slot(..) => match self.cells.get(&place).cloned() {
                Some(value) => Flow {
                    present: self.domain.bit(true),
                    value,
                },
                None => return kept,
            },
            RegisterKind::Started(_) => {
                let yes = self.domain.bit(true);
                always_present(self.domain, yes)
            }
            RegisterKind::WasActive(id) => {
                let active = self.activity(id);
                always_present(self.domain, active)
            }
        };
        self.domain.choose_flow(active, &new, &kept)
    }

    /// Returns the content of the register with the index `place` at the start of the cycle; its initial content if the
    /// fragment that owns the register is reset.
    fn register_content(&mut self, place: usize) -> Flow<D> {
        let register = &self.cone.registers[place];
        let fresh = self.is_reset(register.owner);
        let first = first(self.domain, register.ty, register.initial.as_ref());
        self.domain.choose_flow(fresh, &first, &self.state[place])
    }

    fn register(&mut self, memory: &RegisterKind) -> Option<Flow<D>> {
        let place = self.cone.index_of(memory)?;
        Some(self.register_content(place))
    }

    /// Returns whether a fragment is active in the cycle, which requires that all enclosing fragments are.
    fn activity(&mut self, id: FragmentId) -> D::Bool {
        if let Some(known) = self.active.get(&id) {
            return *known;
        }
        let fragment = self.cone.net.fragment(id);
        let parent = fragment.parent.unwrap_or(FragmentId::ROOT);
        let outer = self.activity(parent);
        let active = match fragment.activation {
            Activation::Always => outer,
            Activation::When {
                condition,
                if_absent,
            } => {
                let holds = self.condition_holds(condition, if_absent);
                self.domain.and(outer, holds)
            }
        };
        self.active.insert(id, active);
        active
    }

    /// Returns whether the condition of a fragment holds in the cycle. `if_absent` is the meaning of an absent
    /// condition.
    fn condition_holds(&mut self, condition: PortRef, if_absent: AbsentPolicy) -> D::Bool {
        let flow = self.flow(condition);
        match if_absent {
            AbsentPolicy::Inactive => self.domain.is_true(&flow),
            AbsentPolicy::Active => {
                let truth = self.domain.truth(&flow.value);
                let wrong = self.domain.not(truth);
                let refuted = self.domain.and(flow.present, wrong);
                self.domain.not(refuted)
            }
        }
    }

    /// Returns whether the state of a fragment is reset in the cycle, by the fragment itself or an enclosing one.
    fn is_reset(&mut self, id: FragmentId) -> D::Bool {
        if let Some(known) = self.reset.get(&id) {
            return *known;
        }
        let fragment = self.cone.net.fragment(id);
        let outer = self.is_reset(fragment.parent.unwrap_or(FragmentId::ROOT));
        let requested = match fragment.restart {
            Restart::Never => None,
            Restart::OnActivation => {
                let was = self.register(&RegisterKind::WasActive(id));
                was.map(|was| {
                    let was = self.domain.truth(&was.value);
                    self.domain.not(was)
                })
            }
            Restart::Every(condition) => Some(self.is_true(condition)),
        };
        let fresh = match requested {
            None => outer,
            Some(requested) => {
                let active = self.activity(id);
                let own = self.domain.and(active, requested);
                self.domain.or(outer, own)
            }
        };
        self.reset.insert(id, fresh);
        fresh
    }

    fn input(&mut self, input: &Input) -> Flow<D> {
        match input {
            Input::Port(port) => self.flow(*port),
            Input::Const(value) => Flow {
                present: self.domain.bit(true),
                value: self.domain.constant(value),
            },
            Input::Unconnected => Flow {
                present: self.domain.bit(false),
                value: {
                    let no = self.domain.bit(false);
                    self.domain.boolean(no)
                },
            },
        }
    }

    fn node(&mut self, id: NodeId) {
        let node = self.cone.net.node(id);
        if node.outputs.is_empty() {
            return;
        }
        let active = self.activity(node.fragment);
        let flows = self.evaluate(id, node, active);
        for (k, flow) in (0..).zip(flows) {
            let present = self.domain.and(flow.present, active);
            let port = PortRef { node: id, port: k };
            self.flows.insert(
                port,
                Flow {
                    present,
                    value: flow.value,
                },
            );
        }
    }

    /// Returns the outputs of a node in the cycle, provided that its fragment is active (`active`).
    fn evaluate(&mut self, id: NodeId, node: &Node, active: D::Bool) -> Vec<Flow<D>> {
        match node.desc().role {
            Role::Constant => {
                let value = node.params.first().map(|value| self.domain.constant(value));
                value.into_iter().map(|value| self.present(value)).collect()
            }
            Role::Delay => self
                .register(&RegisterKind::Delayed(id))
                .into_iter()
                .collect(),
            Role::First => {
                let started = self.register(&RegisterKind::Started(node.fragment));
                let started = started.map(|flow| self.domain.truth(&flow.value));
                let first = started.map(|started| self.domain.not(started));
                first
                    .into_iter()
                    .map(|first| always_present(self.domain, first))
                    .collect()
            }
            Role::Flow(_) | Role::Sensor(_) | Role::Input => (0..)
                .zip(node.desc().outputs)
                .map(|(k, output)| {
                    let source = source(id, node, k);
                    let ty = node.outputs[usize::from(k)];
                    self.domain
                        .source(source, ty, output.presence == Presence::Maybe)
                })
                .collect(),
            Role::Compute | Role::IsAbsent => {
                let inputs: Vec<Flow<D>> =
                    node.inputs.iter().map(|input| self.input(input)).collect();
                self.primitive(id, node, &inputs, active)
            }
            _ => self.unknown(id, node, None, active),
        }
    }

    fn present(&mut self, value: D::Value) -> Flow<D> {
        Flow {
            present: self.domain.bit(true),
            value,
        }
    }

    fn primitive(
        &mut self,
        id: NodeId,
        node: &Node,
        inputs: &[Flow<D>],
        active: D::Bool,
    ) -> Vec<Flow<D>> {
        let desc = node.desc();
        if let Some(gate) = Gate::from_node(node) {
            if let Some(output) = gate.output(self.domain, inputs) {
                return vec![output];
            }
            let places = (0..).map_while(|k| self.cone.index_of(&RegisterKind::Slot(id, k)));
            let places: Vec<usize> = places.collect();
            let kept: Vec<D::Value> = places
                .iter()
                .map(|at| self.register_content(*at).value)
                .collect();
            if let Some((output, memory)) = gate.step(self.domain, node, inputs, &kept) {
                self.cells.extend(places.into_iter().zip(memory));
                return vec![output];
            }
        }
        let is_pure = matches!(desc.state, rpi_image::StateSize::None);
        let is_strict = desc.outputs.iter().all(|o| o.presence == Presence::Strict);
        if !is_pure || !is_strict {
            return self.unknown(id, node, is_pure.then_some(inputs), active);
        }
        let connected = node.inputs.iter().zip(inputs);
        let connected = connected.filter(|(input, _)| !matches!(input, Input::Unconnected));
        let present = connected.map(|(_, flow)| flow.present).collect::<Vec<_>>();
        let present = self.domain.all(present);
        let runs = self.domain.and(active, present);
        let values: Vec<D::Value> = inputs.iter().map(|flow| flow.value.clone()).collect();
        let outputs = self.domain.apply(node, &values, runs);
        let outputs = outputs.into_iter();
        outputs.map(|value| Flow { present, value }).collect()
    }

    /// Returns unconstrained values for the outputs of a primitive that is not modelled. Only its presence rule is
    /// known. `inputs` are its inputs; `None` if it has state.
    fn unknown(
        &mut self,
        id: NodeId,
        node: &Node,
        inputs: Option<&[Flow<D>]>,
        active: D::Bool,
    ) -> Vec<Flow<D>> {
        let flows: Vec<Flow<D>> = node.inputs.iter().map(|input| self.input(input)).collect();
        let connected = node.inputs.iter().zip(&flows);
        let connected = connected.filter(|(input, _)| !matches!(input, Input::Unconnected));
        let present: Vec<D::Bool> = connected.map(|(_, flow)| flow.present).collect();
        let all = self.domain.all(present.iter().copied());
        let any = present
            .iter()
            .fold(self.domain.bit(false), |any, p| self.domain.or(any, *p));
        let (no, yes) = (self.domain.bit(false), self.domain.bit(true));
        let mut outputs = Vec::new();
        for (k, output) in (0..).zip(node.desc().outputs) {
            let (surely, may) = match output.presence {
                Presence::Strict => (all, all),
                Presence::Always => (yes, yes),
                Presence::IfAll => (all, yes),
                Presence::IfAny => (any, yes),
                Presence::Maybe => (no, yes),
            };
            let runs = self.domain.and(active, may);
            let surely = self.domain.and(active, surely);
            let port = (PortRef { node: id, port: k }, node);
            outputs.push(self.domain.unknown(port, inputs, surely, runs));
        }
        outputs
    }
}

/// Returns the external source from which an out-port of a node gets its value.
fn source(id: NodeId, node: &Node, port: u8) -> Source {
    let text = |name: &str| {
        let value = node.desc().param(name).and_then(|at| node.params.get(at));
        value.and_then(Value::as_str).unwrap_or("").to_owned()
    };
    match node.desc().role {
        Role::Flow(flow) => Source::Core(flow),
        Role::Sensor(device) => {
            let name = match device.ports {
                DevicePortNames::Fixed(names) => {
                    names.get(usize::from(port)).map(ToString::to_string)
                }
                DevicePortNames::Param(name) => Some(text(name)),
            };
            let index = device.index.and_then(|name| node.desc().param(name));
            let index = index.and_then(|at| node.params.get(at)?.as_int());
            Source::Sensor {
                device: text(device.device),
                port: name.unwrap_or_default(),
                index: index.unwrap_or(0),
            }
        }
        Role::Input if port == 0 && !text("Key").is_empty() => Source::Outside(text("Key")),
        _ => Source::Port(PortRef { node: id, port }),
    }
}
