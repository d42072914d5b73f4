//! Test bench of one primitive: sets inputs, runs a cycle and returns outputs.

// Each test binary uses only a part of this module.
#![allow(dead_code)]

pub(crate) mod golden;

use rpi_image::{
    ParamType, PortType, Presence, Scalar, ShapeArgs, SizeArgs, StateSize, Type, Value,
};
use rpi_prims::operand::FlowType;
use rpi_prims::{Context, CycleTime, FaultCode, NoDevices, Prim, PrimId};

/// Period of the test bench, s.
pub(crate) const DT: f64 = 0.01;

/// Form of the code to run if both exist.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(crate) enum Form {
    Total,
    Optional,
}

/// Primitive with its memory.
pub(crate) struct TestBench {
    prim: &'static Prim,
    form: Form,
    cells: Vec<u64>,
    words: Vec<u32>,
    inputs: Vec<Slot>,
    outputs: Vec<Slot>,
    cycle: u64,
    /// First fault of the last cycle.
    pub(crate) fault: Option<FaultCode>,
}

#[derive(Clone, Copy)]
struct Slot {
    ty: Type,
    at: usize,
    presence: usize,
}

impl TestBench {
    /// Creates a bench for a primitive with parameters by name, arrays of length 3 and matrices of 3 by 3.
    pub(crate) fn new(name: &str, params: &[(&str, Value)]) -> TestBench {
        TestBench::with_form(name, params, Form::Optional)
    }

    pub(crate) fn with_form(name: &str, params: &[(&str, Value)], form: Form) -> TestBench {
        let prim = PrimId::from_name(name)
            .unwrap_or_else(|| panic!("{name} is registered"))
            .prim();
        let params = values(prim, params);
        let mut rig = TestBench {
            prim,
            form: if prim.optional.is_none() {
                Form::Total
            } else {
                form
            },
            cells: vec![0],
            words: Vec::new(),
            inputs: Vec::new(),
            outputs: Vec::new(),
            cycle: 0,
            fault: None,
        };
        rig.lay_out(&params);
        rig
    }

    fn lay_out(&mut self, params: &[Value]) {
        let desc = &self.prim.desc;
        self.inputs = desc.inputs.iter().map(|p| self.slot(sized(p.ty))).collect();
        let types: Vec<_> = self.inputs.iter().map(|s| Some(s.ty)).collect();
        let args = ShapeArgs {
            inputs: &types,
            params,
        };
        let types = (0..desc.outputs.len()).map(|k| desc.out_type(k, &args).expect("sizes fit"));
        let types: Vec<_> = types.collect();
        self.outputs = types.into_iter().map(|ty| self.slot(ty)).collect();
        let with_presence = self.form == Form::Optional;
        for slot in self.inputs.clone() {
            self.port(slot, with_presence);
        }
        for value in params.iter().filter(|v| v.ty().is_some()) {
            let slot = self.slot(value.ty().expect("no text"));
            self.cells[slot.at..slot.presence].copy_from_slice(value.slots());
            self.port(slot, false);
        }
        for slot in self.outputs.clone() {
            self.port(slot, with_presence);
        }
        self.state(params);
    }

    fn slot(&mut self, ty: Type) -> Slot {
        let at = self.cells.len();
        let presence = at + ty.slots() as usize;
        self.cells.resize(presence + 1, 0);
        Slot { ty, at, presence }
    }

    fn port(&mut self, slot: Slot, with_presence: bool) {
        self.words.push(slot.at as u32);
        match slot.ty {
            Type::Scalar(_) => {}
            Type::Array(_, n) => self.words.push(n),
            Type::Matrix(r, c) => self.words.extend([r, c]),
        }
        if with_presence {
            self.words.push(slot.presence as u32);
        }
    }

    fn state(&mut self, params: &[Value]) {
        let args = SizeArgs { params, dt: DT };
        let len = match self.prim.desc.state {
            StateSize::None => return,
            StateSize::Fixed(n) => n,
            StateSize::Computed(size) => size(&args),
        };
        let at = self.cells.len();
        self.cells.resize(at + len as usize, 0);
        if let Some(init) = self.prim.init {
            init(&args, &mut self.cells[at..]);
        }
        self.words.push(at as u32);
        if matches!(self.prim.desc.state, StateSize::Computed(_)) {
            self.words.push(len);
        }
    }

    /// Returns the types of the in-ports.
    pub(crate) fn types(&self) -> Vec<Type> {
        self.inputs.iter().map(|s| s.ty).collect()
    }

    /// Runs one cycle. As in the core, a strict primitive does not run if an input is absent.
    pub(crate) fn step(&mut self, inputs: &[Option<Value>]) -> Vec<Option<Value>> {
        assert_eq!(inputs.len(), self.inputs.len(), "{}", self.prim.desc.name);
        for (slot, value) in self.inputs.iter().zip(inputs) {
            self.cells[slot.presence] = u64::from(value.is_some());
            if let Some(value) = value {
                self.cells[slot.at..slot.presence].copy_from_slice(value.slots());
            }
        }
        let total = self.form == Form::Total;
        if total && inputs.contains(&None) {
            assert!(self.is_strict(), "the total form takes present inputs");
            return vec![None; self.outputs.len()];
        }
        self.run();
        self.outputs
            .iter()
            .map(|slot| self.output(*slot, total))
            .collect()
    }

    /// Runs one cycle with all inputs present. All outputs must be present.
    pub(crate) fn step_present(&mut self, inputs: &[Value]) -> Vec<Value> {
        let inputs: Vec<_> = inputs.iter().cloned().map(Some).collect();
        self.step(&inputs)
            .into_iter()
            .map(|v| v.expect("present"))
            .collect()
    }

    fn is_strict(&self) -> bool {
        self.prim
            .desc
            .outputs
            .iter()
            .all(|o| o.presence == Presence::Strict)
    }

    fn run(&mut self) {
        let code = if self.form == Form::Total {
            self.prim.total
        } else {
            self.prim.optional
        };
        let time = (self.cycle as i64) * 10_000_000;
        let clock = CycleTime {
            dt: DT,
            tick_ns: 10_000_000,
            period_ticks: 1,
            cycle_index: self.cycle,
            net_ns: time,
            wall_ns: time,
        };
        let mut cx = Context {
            slots: &mut self.cells,
            time: clock,
            devices: &mut NoDevices,
            fault: None,
        };
        let code = code.expect("code of this form");
        rpi_testkit::no_alloc(|| code(&mut cx, &self.words));
        self.fault = cx.fault.map(|f| f.code);
        self.cycle += 1;
    }

    fn output(&self, slot: Slot, sure: bool) -> Option<Value> {
        let cells = self.cells[slot.at..slot.presence].into();
        (sure || self.cells[slot.presence] != 0).then_some(Value::Slots { ty: slot.ty, cells })
    }
}

fn sized(ty: PortType) -> Type {
    match ty {
        PortType::Scalar(s) => Type::Scalar(s),
        PortType::Array(s) => Type::Array(s, 3),
        PortType::Matrix => Type::Matrix(3, 3),
    }
}

fn values(prim: &Prim, given: &[(&str, Value)]) -> Vec<Value> {
    let one = |p: &rpi_image::Param| {
        let given = given
            .iter()
            .find(|(name, _)| *name == p.name)
            .map(|(_, v)| v.clone());
        given.unwrap_or_else(|| match p.ty {
            ParamType::Str => Value::Str(String::new()),
            ParamType::Scalar(s) => p.default.value(s.into()).expect("a default"),
            ParamType::Array(s) => Value::neutral(Type::Array(s, 0)),
        })
    };
    prim.desc.params.iter().map(one).collect()
}

/// Creates a value of a flow type.
pub(crate) fn value_of<T: FlowType>(value: T) -> Value {
    let mut cells = vec![0; T::SLOTS];
    value.store(&mut cells, 0);
    Value::Slots {
        ty: Type::Scalar(T::SCALAR),
        cells: cells.into(),
    }
}

/// Returns the Rust value of a value.
pub(crate) fn get<T: FlowType>(value: &Value) -> T {
    assert_eq!(value.ty(), Some(Type::Scalar(T::SCALAR)));
    T::load(value.slots(), 0)
}

/// Creates an array.
pub(crate) fn array<T: FlowType>(values: &[T]) -> Value {
    let cells = values
        .iter()
        .flat_map(|v| value_of(*v).slots().to_vec())
        .collect();
    Value::Slots {
        ty: Type::Array(T::SCALAR, values.len() as u32),
        cells,
    }
}

/// Creates a matrix, row by row.
pub(crate) fn matrix<const R: usize, const C: usize>(rows: [[f64; C]; R]) -> Value {
    let cells = rows.iter().flatten().map(|v| v.to_bits()).collect();
    Value::Slots {
        ty: Type::Matrix(R as u32, C as u32),
        cells,
    }
}

/// Returns the reals of a value.
pub(crate) fn reals(value: &Value) -> Vec<f64> {
    value.slots().iter().map(|c| f64::from_bits(*c)).collect()
}

/// Asserts that two lists of reals are equal within 1e-12.
#[track_caller]
pub(crate) fn near(a: &[f64], b: &[f64]) {
    let close = a.len() == b.len()
        && a.iter()
            .zip(b)
            .all(|(a, b)| (a - b).abs() <= 1e-12 * (1.0 + b.abs()));
    assert!(close, "{a:?} is not {b:?}");
}

/// Scalar types of the reference system, each with the prefix of its operations.
pub(crate) const TYPES: [(&str, Scalar); 8] = [
    ("Core::Boolean", Scalar::Bool),
    ("Core::Int", Scalar::Int),
    ("Core::Double", Scalar::Real),
    ("World::Vector", Scalar::Vector),
    ("World::Rotation", Scalar::Rotation),
    ("World::Frame", Scalar::Pose),
    ("World::Twist", Scalar::Twist),
    ("World::Wrench", Scalar::Wrench),
];
