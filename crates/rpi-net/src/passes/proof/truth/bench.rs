//! Test bench that runs one primitive, for tests that compare a truth table with the code.

use super::*;
use crate::net::{FragmentId, Input, Inputs, Origin};
use rpi_diag::Span;
use rpi_image::{PrimDesc, State};
use rpi_prims::{Clock, Cx, NoDevices, Prim, PrimId};

/// Primitive with its own memory: inputs, parameters, output and state. The presence flag of a port follows its value.
pub(crate) struct Bench {
    prim: &'static Prim,
    cells: Vec<u64>,
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
            cells: Vec::new(),
            words: Vec::new(),
            output: 0,
            total,
        };
        for _ in desc.inputs {
            bench.port();
        }
        for param in params {
            bench.words.push(bench.cells.len() as u32);
            bench.cells.extend(param.cells());
        }
        bench.output = bench.cells.len();
        bench.port();
        if let State::Cells(count) = desc.state {
            bench.words.push(bench.cells.len() as u32);
            bench.cells.extend(std::iter::repeat_n(0, count as usize));
        }
        bench
    }

    fn port(&mut self) {
        let at = self.cells.len() as u32;
        self.words.push(at);
        if !self.total {
            self.words.push(at + 1);
        }
        self.cells.extend([0, 1]);
    }

    /// Runs one cycle. A strict primitive is not run while an input is absent.
    pub(crate) fn run(&mut self, inputs: &[Set]) -> Set {
        if self.total && inputs.contains(&Set::ABSENT) {
            return Set::ABSENT;
        }
        for (k, input) in inputs.iter().enumerate() {
            self.cells[2 * k] = u64::from(*input == Set::TRUE);
            self.cells[2 * k + 1] = u64::from(*input != Set::ABSENT);
        }
        let clock = Clock {
            dt: 0.001,
            tick_ns: 1_000_000,
            ticks: 1,
            cycle: 0,
            net_ns: 0,
            wall_ns: 0,
        };
        let code = self.prim.optional.or(self.prim.total).expect("it has code");
        let mut cx = Cx {
            cells: &mut self.cells,
            clock,
            devices: &mut NoDevices,
            fault: None,
        };
        code(&mut cx, &self.words);
        match self.total || self.cells[self.output + 1] != 0 {
            true => Set::of(self.cells[self.output] != 0),
            false => Set::ABSENT,
        }
    }
}

/// Creates a node with one Boolean out-port.
pub(crate) fn node(prim: PrimId, params: Vec<Value>) -> Node {
    Node {
        name: String::new(),
        prim,
        fragment: FragmentId::ROOT,
        inputs: Inputs::from_elem(Input::Open, prim.desc().inputs.len()),
        params,
        outputs: [Type::One(Scalar::Bool)].into_iter().collect(),
        origin: Origin {
            span: Span::NONE,
            flow: None,
        },
    }
}

/// All combinations of `count` inputs, each true, false or absent.
pub(crate) fn all_inputs(count: usize) -> Vec<Vec<Set>> {
    let members = [Set::TRUE, Set::FALSE, Set::ABSENT];
    (0..count).fold(vec![Vec::new()], |done, _| {
        let longer = |so_far: &Vec<Set>| members.map(|m| [so_far.as_slice(), &[m]].concat());
        done.iter().flat_map(longer).collect()
    })
}
