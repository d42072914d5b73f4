//! Layout of the primitives of a net in memory slots. Inputs are the recorded values of their sources.

use crate::graph::{connect_reads, in_order, origins};
use crate::net;
use crate::params::{check_len, check_names, parameter, params, port_param};
use crate::trace::Trace;
use rpi_image::{Fallback, PortType, Role, ShapeArgs, SizeArgs, StateSize, Type, Value};
use rpi_prims::{Prim, PrimId};
use std::collections::HashMap;

/// Period of all recorded nets, s.
pub(crate) const PERIOD: f64 = 0.025;

/// Location of a value: value slots, then a presence slot, then a slot that marks a recorded text of another type.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Slot {
    pub(crate) ty: Type,
    pub(crate) at: usize,
    pub(crate) presence: usize,
}

impl Slot {
    pub(crate) fn range(self) -> std::ops::Range<usize> {
        self.at..self.at + self.ty.slots() as usize
    }
}

/// Out-port: computed value and recorded value.
#[derive(Debug)]
pub(crate) struct Out {
    pub(crate) port: &'static str,
    pub(crate) ours: Slot,
    pub(crate) recorded: Slot,
    /// Name in the trace.
    pub(crate) name: String,
}

/// Primitive of a net, ready to run.
#[derive(Debug)]
pub(crate) struct Node {
    pub(crate) prim: &'static Prim,
    pub(crate) inputs: Vec<Slot>,
    pub(crate) sources: Vec<Option<String>>,
    pub(crate) params: Vec<Value>,
    pub(crate) outs: Vec<Out>,
    pub(crate) gates: Vec<Slot>,
    /// Index of the node that each in-port reads.
    pub(crate) reads: Vec<Option<usize>>,
    /// Recorded out-ports that the first in-port reads, directly or through nodes that pass objects on.
    pub(crate) origins: Vec<Slot>,
    /// Operand words of the total and of the optional form. Each form has its own state.
    pub(crate) total: Vec<u32>,
    pub(crate) optional: Vec<u32>,
}

/// All nodes in dependency order, in one memory.
pub(crate) struct Bench {
    pub(crate) cells: Vec<u64>,
    pub(crate) nodes: Vec<Node>,
}

/// Lays out a net. A name that is not in the registry is an error.
pub(crate) fn build(prims: &[net::Prim], trace: &Trace) -> Result<Bench, String> {
    let mut builder = Builder {
        bench: Bench {
            cells: vec![0],
            nodes: Vec::new(),
        },
        recorded: HashMap::new(),
        gates: Vec::new(),
    };
    for prim in in_order(prims) {
        builder
            .node(prim, trace)
            .map_err(|e| format!("{}: {e}", prim.path))?;
    }
    builder.connect_delays();
    let mut bench = builder.bench;
    connect_reads(&mut bench.nodes);
    for k in 0..bench.nodes.len() {
        bench.nodes[k].origins = origins(&bench.nodes, k);
    }
    Ok(bench)
}

struct Builder {
    bench: Bench,
    recorded: HashMap<String, Slot>,
    gates: Vec<(usize, Vec<String>)>,
}

impl Builder {
    fn node(&mut self, net: &net::Prim, trace: &Trace) -> Result<(), String> {
        let prim = PrimId::from_name(&net.ty)
            .ok_or_else(|| format!("unknown type {}", net.ty))?
            .prim();
        check_names(prim, net)?;
        let (inputs, sources) = self.inputs(prim, net)?;
        let params = params(prim, net)?;
        let types: Vec<_> = inputs.iter().map(|slot| slot.map(|s| s.ty)).collect();
        let args = ShapeArgs {
            inputs: &types,
            params: &params,
        };
        let outs = self.outs(prim, net, trace, &args)?;
        let inputs: Vec<Slot> = inputs
            .into_iter()
            .zip(prim.desc.inputs)
            .map(|(slot, port)| slot.unwrap_or_else(|| self.absent(port.ty)))
            .collect();
        let total = self.words(prim, &inputs, &params, &outs, false);
        let optional = self.words(prim, &inputs, &params, &outs, true);
        self.gates.push((self.bench.nodes.len(), net.gates.clone()));
        self.bench.nodes.push(Node {
            prim,
            inputs,
            sources,
            params,
            outs,
            gates: Vec::new(),
            reads: Vec::new(),
            origins: Vec::new(),
            total,
            optional,
        });
        Ok(())
    }

    fn slot(&mut self, ty: Type) -> Slot {
        let at = self.bench.cells.len();
        let presence = at + ty.slots() as usize;
        self.bench.cells.resize(presence + 2, 0);
        Slot { ty, at, presence }
    }

    fn constant(&mut self, value: &Value) -> Slot {
        let slot = self.slot(value.ty().expect("no text"));
        self.bench.cells[slot.range()].copy_from_slice(value.slots());
        self.bench.cells[slot.presence] = 1;
        slot
    }

    /// Returns a slot for an in-port without a source: never present.
    fn absent(&mut self, ty: PortType) -> Slot {
        self.slot(match ty {
            PortType::Scalar(s) => Type::Scalar(s),
            PortType::Array(s) => Type::Array(s, 0),
            PortType::Matrix => Type::Matrix(0, 0),
        })
    }

    #[allow(clippy::type_complexity)]
    fn inputs(
        &mut self,
        prim: &Prim,
        net: &net::Prim,
    ) -> Result<(Vec<Option<Slot>>, Vec<Option<String>>), String> {
        let (mut slots, mut sources) = (Vec::new(), Vec::new());
        for port in prim.desc.inputs {
            let connected = net.inputs.iter().find(|(name, _)| name == port.name);
            slots.push(match connected {
                Some((_, source)) => Some(self.source(prim, port.ty, source)?),
                None => self.fallback(port, net)?,
            });
            sources.push(connected.map(|(_, source)| source.clone()));
        }
        Ok((slots, sources))
    }

    fn source(&mut self, prim: &Prim, ty: PortType, source: &str) -> Result<Slot, String> {
        if let Some(slot) = self.recorded.get(source) {
            return Ok(*slot);
        }
        let PortType::Scalar(scalar) = ty else {
            return Err(format!("no source {source}"));
        };
        // Only a delay may precede its source.
        if prim.desc.role != Role::Delay {
            return Err(format!("no source {source}"));
        }
        Ok(self.slot(Type::Scalar(scalar)))
    }

    fn fallback(
        &mut self,
        port: &rpi_image::InPort,
        net: &net::Prim,
    ) -> Result<Option<Slot>, String> {
        let given = |name: &str| {
            net.params
                .iter()
                .find(|(n, _)| n == name)
                .map(|(_, text)| text.as_str())
        };
        let value = match port.fallback {
            Fallback::Required => return Err(format!("{} is not connected", port.name)),
            Fallback::AbsentValue => return Ok(None),
            Fallback::Param(name, default) => parameter(port_param(port.ty), given(name), default)?,
            Fallback::ComposedOfParams(names, make) => {
                let real = |(name, default): &(&str, f64)| {
                    given(name).map_or(*default, |t| t.parse().expect("a real"))
                };
                make(&names.iter().map(real).collect::<Vec<_>>())
            }
        };
        Ok(Some(self.constant(&value)))
    }

    fn outs(
        &mut self,
        prim: &'static Prim,
        net: &net::Prim,
        trace: &Trace,
        args: &ShapeArgs<'_>,
    ) -> Result<Vec<Out>, String> {
        let mut outs = Vec::new();
        for (k, port) in prim.desc.outputs.iter().enumerate() {
            let name = format!("{}.{}", net.path, port.name);
            let ty = prim
                .desc
                .out_type(k, args)
                .ok_or_else(|| format!("sizes of {name} do not fit"))?;
            check_len(ty, &name, trace)?;
            let (ours, recorded) = (self.slot(ty), self.slot(ty));
            self.recorded.insert(name.clone(), recorded);
            outs.push(Out {
                port: port.name,
                ours,
                recorded,
                name,
            });
        }
        Ok(outs)
    }

    fn words(
        &mut self,
        prim: &Prim,
        inputs: &[Slot],
        params: &[Value],
        outs: &[Out],
        optional: bool,
    ) -> Vec<u32> {
        let mut words = Vec::new();
        for slot in inputs {
            port_words(&mut words, *slot, optional);
        }
        for value in params {
            if value.ty().is_some() {
                let slot = self.constant(value);
                port_words(&mut words, slot, false);
            }
        }
        for out in outs {
            port_words(&mut words, out.ours, optional);
        }
        self.state(prim, params, &mut words);
        words
    }

    fn state(&mut self, prim: &Prim, params: &[Value], words: &mut Vec<u32>) {
        let args = SizeArgs { params, dt: PERIOD };
        let len = match prim.desc.state {
            StateSize::None => return,
            StateSize::Fixed(n) => n,
            StateSize::Computed(size) => size(&args),
        };
        let at = self.bench.cells.len();
        self.bench.cells.resize(at + len as usize, 0);
        if let Some(init) = prim.init {
            init(&args, &mut self.bench.cells[at..]);
        }
        words.push(at as u32);
        if matches!(prim.desc.state, StateSize::Computed(_)) {
            words.push(len);
        }
    }

    /// Connects delays and gates after the layout, when all their sources are known.
    fn connect_delays(&mut self) {
        for node in &mut self.bench.nodes {
            if let (Role::Delay, Some(Some(source))) = (node.prim.desc.role, node.sources.first()) {
                node.inputs[0] = self.recorded[source];
            }
        }
        for (node, gates) in &self.gates {
            self.bench.nodes[*node].gates = gates.iter().map(|gate| self.recorded[gate]).collect();
        }
    }
}

fn port_words(words: &mut Vec<u32>, slot: Slot, optional: bool) {
    words.push(slot.at as u32);
    match slot.ty {
        Type::Scalar(_) => {}
        Type::Array(_, n) => words.push(n),
        Type::Matrix(r, c) => words.extend([r, c]),
    }
    if optional {
        words.push(slot.presence as u32);
    }
}
