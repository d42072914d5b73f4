//! Irregular nets: a random graph of primitives of all kinds, without repetitions that a branch predictor could use.

use super::biquad::{delayed, input};
use crate::net_builder::{NetBuilder, real};
use crate::rng::Rng;
use rpi_net::{FragmentId, Input, Net, NodeId, PortRef};

const ROOT: FragmentId = FragmentId::ROOT;

/// Returns a random net of about `size` primitives: one third sums and differences, one third products, the rest
/// choices, comparisons, logic and delays. Inputs prefer recent outputs, so that chains are long, and every output is
/// used. Values stay bounded for an input `x` between -1 and 1. The sum of the unused outputs is exported as `y`. Equal
/// seeds give equal nets.
#[must_use]
pub fn mixed(size: usize, seed: u64) -> Net {
    let mut net = Mixed::new(seed);
    while net.build.net.nodes.len() < size {
        net.add_random();
    }
    net.close()
}

struct Mixed {
    build: NetBuilder,
    rng: Rng,
    reals: Vec<PortRef>,
    booleans: Vec<PortRef>,
    unused: Vec<PortRef>,
    delays: Vec<NodeId>,
}

impl Mixed {
    fn new(seed: u64) -> Self {
        let mut build = NetBuilder::new("mixed");
        let wave = input(&mut build);
        let first = build.add(ROOT, "Core::DoubleGreater", &[Input::Port(wave), real(0.3)]);
        Mixed {
            build,
            rng: Rng::new(seed),
            reals: vec![wave],
            booleans: vec![first],
            unused: Vec::new(),
            delays: Vec::new(),
        }
    }

    fn add_random(&mut self) {
        match self.rng.below(100) {
            0..28 => self.add_scaled(),
            28..56 => self.product(),
            56..68 => self.choice(),
            68..80 => self.comparison(),
            80..86 => self.logic(),
            86..94 => self.delay(),
            _ => self.largest(),
        }
    }

    /// Returns a random output of type real for a node to read: with probability 1/2 an unused one if there is any,
    /// else one of the last hundred.
    fn real(&mut self) -> PortRef {
        if self.rng.below(2) == 0
            && let Some(port) = self.unused.pop()
        {
            return port;
        }
        let from = self.reals.len().saturating_sub(100);
        self.reals[from + self.rng.below(self.reals.len() - from)]
    }

    fn boolean(&mut self) -> PortRef {
        let from = self.booleans.len().saturating_sub(30);
        self.booleans[from + self.rng.below(self.booleans.len() - from)]
    }

    fn add_output(&mut self, port: PortRef) {
        self.reals.push(port);
        self.unused.push(port);
    }

    /// Adds a sum or a difference of two flows, with a factor on one of them and a factor on the result, so that values
    /// stay bounded.
    fn add_scaled(&mut self) {
        let (a, b) = (self.real(), self.real());
        let factor = self.rng.real(-0.5, 0.5);
        let half = self.build.add(
            ROOT,
            "Core::DoubleMultiply",
            &[Input::Port(a), real(factor)],
        );
        let name = ["Core::DoubleAdd", "Rpi::DoubleSubtract"][self.rng.below(2)];
        let inputs = [Input::Port(half), Input::Port(b)];
        let sum = self.build.add(ROOT, name, &inputs);
        let bounded = self.build.add(
            ROOT,
            "Core::DoubleMultiply",
            &[Input::Port(sum), real(0.66)],
        );
        self.add_output(bounded);
    }

    fn product(&mut self) {
        let (a, factor) = (self.real(), self.rng.real(-1.0, 1.0));
        let inputs = match self.rng.below(2) {
            0 => [Input::Port(a), real(factor)],
            _ => [Input::Port(a), Input::Port(self.real())],
        };
        let product = self.build.add(ROOT, "Core::DoubleMultiply", &inputs);
        self.add_output(product);
    }

    fn choice(&mut self) {
        let inputs = [self.boolean(), self.real(), self.real()].map(Input::Port);
        let choice = self.build.add(ROOT, "Core::DoubleConditional", &inputs);
        self.add_output(choice);
    }

    fn comparison(&mut self) {
        let (a, limit) = (self.real(), self.rng.real(-0.5, 0.5));
        let inputs = [Input::Port(a), real(limit)];
        let greater = self.build.add(ROOT, "Core::DoubleGreater", &inputs);
        self.booleans.push(greater);
    }

    fn logic(&mut self) {
        let (a, b) = (self.boolean(), self.boolean());
        let names = [
            "Core::BooleanAnd",
            "Core::BooleanOr",
            "Core::BooleanNot",
            "Rpi::BooleanXor",
        ];
        let name = names[self.rng.below(4)];
        let inputs = [Input::Port(a), Input::Port(b)];
        let inputs = if name == "Core::BooleanNot" {
            &inputs[..1]
        } else {
            &inputs[..]
        };
        let result = self.build.add(ROOT, name, inputs);
        self.booleans.push(result);
    }

    fn delay(&mut self) {
        let (port, node) = delayed(&mut self.build);
        self.delays.push(node);
        self.add_output(port);
    }

    fn largest(&mut self) {
        let inputs = [self.real(), self.real()].map(Input::Port);
        let name = ["Rpi::DoubleMaximum", "Rpi::DoubleMinimum"][self.rng.below(2)];
        let largest = self.build.add(ROOT, name, &inputs);
        self.add_output(largest);
    }

    fn close(mut self) -> Net {
        for delay in std::mem::take(&mut self.delays) {
            let source = self.reals[self.rng.below(self.reals.len())];
            self.build.wire(delay, 0, source);
        }
        let mut total = self.reals[self.reals.len() - 1];
        for port in std::mem::take(&mut self.unused) {
            let inputs = [Input::Port(total), Input::Port(port)];
            total = self.build.add(ROOT, "Core::DoubleAdd", &inputs);
        }
        self.build.export("y", total);
        self.build.net
    }
}
