//! Test bench that runs one primitive, for tests that compare a truth table with the code.

use super::*;
use crate::net::{FragmentId, Input, Inputs, Origin};
use rpi_diag::Span;
use rpi_image::{PrimDesc, StateSize};
use rpi_prims::{Context, CycleTime, NoDevices, Prim, PrimId};

/// Test bench of a primitive with its own memory for inputs, parameters, output and state. The presence flag of a port
/// follows its value.
pub(crate) struct Bench {
    prim: &'static Prim,
    slots: Vec<u64>,
    words: Vec<u32>,
    output: usize,
    total: bool,
}

impl Bench {
    pub(crate) fn new(prim: &'static Prim, params: &[Value]) -> Bench {
        let desc: &PrimDesc = &prim.desc;
        let total = prim.optional.is_none();
        let mut bench = Bench {
            prim,
            slots: Vec::new(),
            words: Vec::new(),
            output: 0,
            total,
        };
        for _ in desc.inputs {
            bench.port();
        }
        for param in params {
            bench.words.push(bench.slots.len() as u32);
            bench.slots.extend(param.slots());
        }
        bench.output = bench.slots.len();
        bench.port();
        if let StateSize::Fixed(count) = desc.state {
            bench.words.push(bench.slots.len() as u32);
            bench.slots.extend(std::iter::repeat_n(0, count as usize));
        }
        bench
    }

    fn port(&mut self) {
        let at = self.slots.len() as u32;
        self.words.push(at);
        if !self.total {
            self.words.push(at + 1);
        }
        self.slots.extend([0, 1]);
    }

    /// Runs the primitive for one cycle and returns its output. A strict primitive is not run while an input is absent.
    pub(crate) fn run(&mut self, inputs: &[ValueSet]) -> ValueSet {
        if self.total && inputs.contains(&ValueSet::ABSENT) {
            return ValueSet::ABSENT;
        }
        for (k, input) in inputs.iter().enumerate() {
            self.slots[2 * k] = u64::from(*input == ValueSet::TRUE);
            self.slots[2 * k + 1] = u64::from(*input != ValueSet::ABSENT);
        }

        let code = self.prim.optional.or(self.prim.total).expect("it has code");
        let mut cx = Context {
            slots: &mut self.slots,
            time: CycleTime::FIRST,
            devices: &mut NoDevices,
            fault: None,
        };
        code(&mut cx, &self.words);
        match self.total || self.slots[self.output + 1] != 0 {
            true => ValueSet::from_bool(self.slots[self.output] != 0),
            false => ValueSet::ABSENT,
        }
    }
}

/// Creates a node with one Boolean out-port.
pub(crate) fn node(prim: PrimId, params: Vec<Value>) -> Node {
    Node {
        name: String::new(),
        prim,
        fragment: FragmentId::ROOT,
        inputs: Inputs::from_elem(Input::Unconnected, prim.desc().inputs.len()),
        params,
        outputs: [Type::Scalar(Scalar::Bool)].into_iter().collect(),
        origin: Origin {
            span: Span::NONE,
            flow: None,
        },
    }
}

/// All combinations of `count` inputs, each true, false or absent.
pub(crate) fn all_inputs(count: usize) -> Vec<Vec<ValueSet>> {
    let members = [ValueSet::TRUE, ValueSet::FALSE, ValueSet::ABSENT];
    (0..count).fold(vec![Vec::new()], |done, _| {
        let longer = |so_far: &Vec<ValueSet>| members.map(|m| [so_far.as_slice(), &[m]].concat());
        done.iter().flat_map(longer).collect()
    })
}
